//! Drafts of maps for rectangle lights: which mips the scene's footprints read, and bytes against the error of highlights.

use super::args::{Args, Format};
use super::bake::draft;
use crate::cli::values::name_of;
use crate::exit::Failure;
use crate::methods::bake::Candidates;
use crate::methods::planning::{Request, sizes};
use crate::quantities::kib;
use glint_bake_core::area_light::AreaLightMaterial;
use glint_bake_core::area_light::baked::Maps;
use glint_bake_core::area_light::baked::decode_tables;
use glint_bake_core::area_light::eval::LOBES;
use glint_bake_core::area_light::quality::{Comparison, RadianceGrid, highlight_error, scenes};
use glint_bake_core::area_light::reference::Scene as Light;
use glint_bake_core::area_light::sections;
use glint_bake_core::normal_map::NormalMap;
use glint_formats::Pack;

/// Formats, and whether roughness has a direction, from few bytes to many.
const SETTINGS: [(Format, bool); 4] =
    [(Format::Snorm8, false), (Format::F16, false), (Format::Snorm8, true), (Format::F16, true)];
/// Sizes of footprints that are measured, at most, and places of each.
const SIZES: usize = 3;
const PLACES: u32 = 8;
/// Of the lights that accuracy is reported with, every so many.
const LIGHT_STEP: usize = 3;
/// Points along an edge of the reference's table over normals: so many over α, as lobes are that wide, within bounds.
const GRID_OVER_ALPHA: f64 = 8.0;
const GRID_RANGE: (f64, f64) = (49.0, 201.0);
const TOLERANCE: f64 = 1e-3;
const SEED: u64 = 22;
/// Places of each size that a finished pack is measured at, and their seed.
const MEASURED_PLACES: u32 = 12;
const MEASURED_SEED: u64 = 1021;
/// Places in the list of methods that are compared: ours, without and with a direction.
const ISOTROPIC: usize = 3;
const ANISOTROPIC: usize = 5;

/// What was measured of one pack.
pub fn candidates(args: &Args, request: &Request<'_>) -> Result<Candidates, Failure> {
    let view = request.surface()?;
    let base = Args { output: request.output.to_owned(), ..args.clone() };
    let mut first = request.choice(base.clone());
    first.choose("format", name_of(&Format::Snorm8), |args| args.format = Format::Snorm8);
    let ((map, material), all_bytes) = draft(&first.args)?;
    let (low, high) = request.scene.footprints(view, map.width).sigma;
    let longest = map.width.max(map.height);
    // A look-up reads the mip whose texels are twice the standard deviation, and the next one.
    let skip = libm::log2(2.0 * low).floor().clamp(0.0, f64::from(longest.ilog2())) as u32;
    let lights = table(f64::from(material.params.base_roughness));
    let most = f64::from(longest);
    let sigmas = sizes((low.min(most), high.min(most)), SIZES);
    let mut found = Candidates::new(format!("footprints of σ {low:.2} to {high:.2} texels"));
    for (format, anisotropic) in SETTINGS {
        let mut choice = request.choice(base.clone());
        choice.choose("format", name_of(&format), |args| args.format = format);
        choice.choose("skip-mips", skip, |args| args.skip_mips = skip);
        if anisotropic {
            choice.choose("anisotropic", "", |args| args.anisotropic = true);
        }
        if found.has(&choice.options) {
            continue;
        }
        let ((map, material), bytes) = draft(&choice.args)?;
        if found.drafts.is_empty() && skip > 0 && bytes < all_bytes {
            let saved = kib(all_bytes - bytes);
            found.dropped.push(format!("the {skip} finest mips: no footprint reads them ({saved} in this format)"));
        }
        let error = worst(&map, &material, &lights, &sigmas, PLACES, SEED);
        found.push(choice, bytes, error);
    }
    Ok(found)
}

/// The error of a baked pack at the scene's footprints, at other places than those that the plan was made at.
pub fn measure(args: &Args, pack: &Pack, request: &Request<'_>) -> Result<f64, Failure> {
    let view = request.surface()?;
    // The draft is made for its map; what is measured is the file.
    let ((map, _), _) = draft(args)?;
    let name = sections::materials(pack).first().copied().unwrap_or_default();
    let material = sections::from_pack(pack, name).map_err(|e| Failure::bake(request.output, &e))?;
    let (low, high) = request.scene.footprints(view, map.width).sigma;
    let most = f64::from(map.width.max(map.height));
    let lights = table(f64::from(material.params.base_roughness));
    let sigmas = sizes((low.min(most), high.min(most)), SIZES);
    Ok(worst(&map, &material, &lights, &sigmas, MEASURED_PLACES, MEASURED_SEED))
}

/// The reference of some lights.
fn table(base_roughness: f64) -> Vec<(Light, RadianceGrid)> {
    let lights = scenes(base_roughness).into_iter().step_by(LIGHT_STEP);
    let grid = (GRID_OVER_ALPHA / base_roughness).clamp(GRID_RANGE.0, GRID_RANGE.1) as usize;
    lights.map(|light| (light, RadianceGrid::new(&light, grid, TOLERANCE))).collect()
}

/// Root mean square error of highlights over that of the reference, the largest of all sizes.
fn worst(
    map: &NormalMap,
    material: &AreaLightMaterial,
    lights: &[(Light, RadianceGrid)],
    sigmas: &[f64],
    places: u32,
    seed: u64,
) -> f64 {
    let maps = Maps::new(material);
    let tables = decode_tables(&material.tables);
    let over = Comparison { scenes: lights, places, lobes: LOBES, seed };
    let method = if material.params.anisotropic { ANISOTROPIC } else { ISOTROPIC };
    let error = |sigma: &f64| highlight_error(map, &maps, &tables, 2.0 * sigma, &over).rmse[method];
    sigmas.iter().map(error).fold(0.0, f64::max)
}
