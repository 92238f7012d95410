//! Drafts of maps for rectangle lights: which mips the scene's footprints read, and bytes against the error of highlights.

use crate::exit::{Exit, Failure};
use crate::methods::Draft;
use crate::plan::{Drafts, Found, Point, options, sizes};
use crate::project::scene::{Scene, View};
use glint_bake_core::area_light::AreaLightMaterial;
use glint_bake_core::area_light::baked::Maps;
use glint_bake_core::area_light::baked::decode_tables;
use glint_bake_core::area_light::eval::LOBES;
use glint_bake_core::area_light::quality::{Comparison, RadianceGrid, highlight_error, scenes};
use glint_bake_core::area_light::reference::Scene as Light;
use glint_bake_core::normal_map::NormalMap;

/// Formats, and whether roughness has a direction, from few bytes to many.
const SETTINGS: [(&str, bool); 4] = [("snorm8", false), ("f16", false), ("snorm8", true), ("f16", true)];
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
/// Places in the list of methods that are compared: ours, without and with a direction.
const ISOTROPIC: usize = 3;
const ANISOTROPIC: usize = 5;

/// Name of the error.
pub const MEASURE: &str = "RMSE of highlights";

/// What was measured of one pack.
pub fn candidates(drafts: &mut Drafts<'_>, scene: &Scene, view: &View) -> Result<Found, Failure> {
    let (first, all_bytes) = highlights(drafts.make(&options([("format", "snorm8".into())]))?)?;
    let (map, material) = *first;
    let seen = scene.footprints(view, map.width);
    let longest = map.width.max(map.height);
    // A look-up reads the mip whose texels are twice the standard deviation, and the next one.
    let skip = libm::log2(2.0 * seen.sigma.0).floor().clamp(0.0, f64::from(longest.ilog2())) as u32;
    let lights = table(f64::from(material.params.base_roughness));
    let most = f64::from(longest);
    let sigmas = sizes((seen.sigma.0.min(most), seen.sigma.1.min(most)), SIZES);
    let (low, high) = seen.sigma;
    let mut found = Found {
        measure: MEASURE,
        seen: format!("footprints of σ {low:.2} to {high:.2} texels"),
        dropped: Vec::new(),
        points: Vec::new(),
    };
    for (format, anisotropic) in SETTINGS {
        let mut chosen = options([("format", format.into()), ("skip-mips", skip.to_string())]);
        if anisotropic {
            chosen.push(("anisotropic".into(), String::new()));
        }
        chosen.retain(|(key, _)| !drafts.way.words.says(key));
        if found.points.iter().any(|point| point.options == chosen) {
            continue;
        }
        let (made, bytes) = highlights(drafts.make(&chosen)?)?;
        if found.points.is_empty() && skip > 0 && bytes < all_bytes {
            let saved = crate::quantities::kib(all_bytes - bytes);
            found.dropped.push(format!("the {skip} finest mips: no footprint reads them ({saved} in this format)"));
        }
        let error = worst(&made.0, &made.1, &lights, &sigmas, PLACES, SEED);
        found.points.push(Point { options: chosen, bytes, error });
    }
    Ok(found)
}

fn highlights((draft, bytes): (Draft, u64)) -> Result<(Box<(NormalMap, AreaLightMaterial)>, u64), Failure> {
    match draft {
        Draft::AreaLight(made) => Ok((made, bytes)),
        _ => Err(Failure::new(Exit::Unexpected, "a draft for rectangle lights is something else; please report this")),
    }
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

/// The error of a baked pack at the scene's footprints, at other places than those that the plan was made at.
pub fn measured(map: &NormalMap, material: &AreaLightMaterial, sigma: (f64, f64), places: u32, seed: u64) -> f64 {
    let most = f64::from(map.width.max(map.height));
    let lights = table(f64::from(material.params.base_roughness));
    worst(map, material, &lights, &sizes((sigma.0.min(most), sigma.1.min(most)), SIZES), places, seed)
}
