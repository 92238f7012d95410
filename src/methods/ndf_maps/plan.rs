//! Drafts of NDF maps: which tiles the scene's footprints read, and bytes against E₁ at those footprints.

use super::args::{Args, Storage};
use super::bake::draft;
use crate::cli::values::name_of;
use crate::exit::{Exit, Failure};
use crate::methods::bake::Candidates;
use crate::methods::planning::{Request, sizes};
use crate::quantities::kib;
use crate::scene::Footprints;
use glam::DVec2;
use glint_bake_core::footprint::Footprint;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::eval::EvalSettings;
use glint_bake_core::ndf_maps::options::FINEST_TILE;
use glint_bake_core::ndf_maps::quality::ExactNdf;
use glint_bake_core::ndf_maps::reference_surface::SurfaceReference;
use glint_bake_core::ndf_maps::sections;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::quality::sweep::footprints;
use glint_formats::Pack;
use rayon::prelude::*;

/// Storage and error asked of tiles, from few bytes to many.
const SETTINGS: [(Storage, f64); 6] = [
    (Storage::U8, 0.2),
    (Storage::U8, 0.1),
    (Storage::U8, 0.05),
    (Storage::U8, 0.02),
    (Storage::U8, 0.01),
    (Storage::F16, 0.003),
];
/// Sizes of footprints that are measured, at most, and places of each.
const SIZES: usize = 3;
const PLACES: u32 = 6;
/// Footprints wider than so many edges of the example see all of it, however wide they are.
const WIDEST_EDGES: f64 = 1.0;
/// Footprints that are asked which tiles they read.
const PROBES: u32 = 512;
/// Examples along the surface that footprints lie on.
const EXTENT: f64 = 32.0;
const SEED: u64 = 21;
/// Places of each size that a finished pack is measured at, and their seed.
const MEASURED_PLACES: u32 = 12;
const MEASURED_SEED: u64 = 1021;

/// Footprints that are measured together, and what they should see.
struct Size {
    footprints: Vec<(Footprint, ExactNdf)>,
}

/// What was measured of one pack.
pub fn candidates(args: &Args, request: &Request<'_>) -> Result<Candidates, Failure> {
    let view = request.surface()?;
    let base = Args { output: request.output.to_owned(), ..args.clone() };
    let asked = |(storage, error): (Storage, f64), tile: u32, settings: bool| {
        let mut choice = request.choice(base.clone());
        if settings {
            choice.choose("storage", name_of(&storage), |args| args.storage = Some(storage));
            choice.choose("max-error", error, |args| args.max_error = Some(error));
        }
        choice.choose("min-tile", tile, |args| args.min_tile = tile);
        choice
    };
    let (made, all_bytes) = draft(&asked(SETTINGS[0], FINEST_TILE, true).args)?;
    let footprints: Vec<Footprints> = made.iter().map(|(map, _)| request.scene.footprints(view, map.width)).collect();
    let covering = made.iter().zip(&footprints);
    let tile = covering.map(|((map, material), footprints)| finest_tile(map, material, footprints)).min();
    let tile = tile.unwrap_or(FINEST_TILE);
    let sizes: Vec<Vec<Size>> = made
        .iter()
        .zip(&footprints)
        .map(|((map, material), footprints)| exact(map, material, footprints, PLACES, SEED))
        .collect();
    drop(made);
    let mut found = Candidates::new(line(&footprints));
    // A preset says both, so that there is nothing to choose but the tiles.
    let preset = request.fixes("preset");
    let settings = if preset { &SETTINGS[..1] } else { &SETTINGS[..] };
    for setting in settings {
        let choice = asked(*setting, tile, !preset);
        if found.has(&choice.options) {
            continue;
        }
        let (made, bytes) = match draft(&choice.args) {
            Ok(draft) => draft,
            // A setting that misses the error it asks for is none to choose.
            Err(failure) if failure.exit == Exit::LimitExceeded && !found.drafts.is_empty() => continue,
            Err(failure) => return Err(failure),
        };
        if found.drafts.is_empty() && bytes < all_bytes {
            found.dropped.push(format!(
                "tiles finer than {tile} texels: no footprint reads them ({} at this error)",
                kib(all_bytes - bytes)
            ));
        }
        let error = made.iter().zip(&sizes).map(|((_, material), sizes)| worst(material, sizes)).fold(0.0, f64::max);
        found.push(choice, bytes, error);
    }
    Ok(found)
}

/// The error of a baked pack at the scene's footprints, at other places than those that the plan was made at.
pub fn measure(args: &Args, pack: &Pack, request: &Request<'_>) -> Result<f64, Failure> {
    let view = request.surface()?;
    // The draft is made for its maps; what is measured is the file.
    let (made, _) = draft(args)?;
    let mut error = 0.0f64;
    for (name, (map, _)) in sections::materials(pack).iter().zip(&made) {
        let material = sections::from_pack(pack, name).map_err(|e| Failure::bake(request.output, &e))?;
        let footprints = request.scene.footprints(view, map.width);
        error = error.max(worst(&material, &exact(map, &material, &footprints, MEASURED_PLACES, MEASURED_SEED)));
    }
    Ok(error)
}

fn line(all: &[Footprints]) -> String {
    let part = |footprints: &Footprints| {
        let (low, high) = footprints.sigma;
        format!("footprints of σ {low:.2} to {high:.2} texels, up to {:.1} times as long", footprints.anisotropy)
    };
    all.iter().map(part).collect::<Vec<_>>().join("; ")
}

/// Footprints wider than this see all of an example.
fn widest(map: &NormalMap) -> f64 {
    WIDEST_EDGES * f64::from(map.width.max(map.height))
}

fn extent(map: &NormalMap) -> DVec2 {
    DVec2::new(f64::from(map.width), f64::from(map.height)) * EXTENT
}

/// Edge of the finest tile that any of many footprints of the scene reads; that of the covering tile where none reads one.
fn finest_tile(map: &NormalMap, material: &Material, visible: &Footprints) -> u32 {
    let levels = &material.maps.params.levels;
    let covering = levels.last().map_or(2, |level| level.tile_texels);
    let (low, high) = (visible.sigma.0.min(widest(map)), visible.sigma.1.min(widest(map)));
    let edge_of = |tile: u32| {
        let level = levels.iter().rev().find(|level| level.first_tile <= tile);
        level.map_or(covering, |level| level.tile_texels)
    };
    let probe = |k: u32| {
        // Both ends are among them, round and long.
        let share = f64::from(k / 2 % 32) / 31.0;
        let anisotropy = if k.is_multiple_of(2) { 1.0 } else { visible.anisotropy };
        let sigma = low * libm::pow(high / low, share);
        let all = footprints(sigma, anisotropy, extent(map), 1, SEED + u64::from(k));
        let terms = material.gather(&all[0], EvalSettings::default());
        terms.tiles.iter().map(|term| edge_of(term.tile)).min().unwrap_or(covering)
    };
    (0..PROBES).map(probe).min().unwrap_or(covering)
}

/// What footprints of each size should see.
fn exact(map: &NormalMap, material: &Material, visible: &Footprints, places: u32, seed: u64) -> Vec<Size> {
    let reference = SurfaceReference::new(map, material);
    let mut all = Vec::new();
    let most = widest(map);
    for sigma in sizes((visible.sigma.0.min(most), visible.sigma.1.min(most)), SIZES) {
        let anisotropies = if visible.anisotropy > 1.1 { vec![1.0, visible.anisotropy] } else { vec![1.0] };
        for anisotropy in anisotropies {
            let places = footprints(sigma, anisotropy, extent(map), places, seed);
            let exact = |footprint: Footprint| (footprint, ExactNdf::new(&reference.ndf(&footprint)));
            all.push(Size { footprints: places.into_par_iter().map(exact).collect() });
        }
    }
    all
}

/// Mean E₁ over the footprints of a size, the largest of all sizes.
fn worst(material: &Material, sizes: &[Size]) -> f64 {
    let of_one = |(footprint, exact): &(Footprint, ExactNdf)| {
        let terms = material.gather(footprint, EvalSettings::default());
        exact.error(|s| material.density(&terms, s)).e1
    };
    let mean = |size: &Size| {
        let errors: Vec<f64> = size.footprints.par_iter().map(of_one).collect();
        errors.iter().sum::<f64>() / errors.len().max(1) as f64
    };
    sizes.iter().map(mean).fold(0.0, f64::max)
}
