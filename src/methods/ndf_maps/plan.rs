//! Drafts of NDF maps: which tiles the scene's footprints read, and bytes against E₁ at those footprints.

use crate::exit::{Exit, Failure};
use crate::methods::Draft;
use crate::plan::{Drafts, Found, Point, options, sizes};
use crate::project::scene::{Footprints, Scene, View};
use glam::DVec2;
use glint_bake_core::footprint::Footprint;
use glint_bake_core::ndf_maps::eval::Material;
use glint_bake_core::ndf_maps::measure::ExactNdf;
use glint_bake_core::ndf_maps::reference_surface::SurfaceReference;
use glint_bake_core::ndf_maps::surface::EvalSettings;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::quality::sweep::footprints;
use rayon::prelude::*;

/// Storage and error asked of tiles, from few bytes to many.
const SETTINGS: [(&str, f64); 6] = [("u8", 0.2), ("u8", 0.1), ("u8", 0.05), ("u8", 0.02), ("u8", 0.01), ("f16", 0.003)];
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

/// Footprints that are measured together, and what they should see.
struct Size {
    footprints: Vec<(Footprint, ExactNdf)>,
}

/// Name of the error.
pub const MEASURE: &str = "E₁";

/// What was measured of one pack.
pub fn candidates(drafts: &mut Drafts<'_>, scene: &Scene, view: &View) -> Result<Found, Failure> {
    let first = SETTINGS[0];
    let asked = |(storage, error): (&str, f64), tile: u32| {
        options([("storage", storage.into()), ("max-error", error.to_string()), ("min-tile", tile.to_string())])
    };
    let (made, all_bytes) = ndf(drafts.make(&asked(first, 2))?)?;
    let seen: Vec<Footprints> = made.iter().map(|(map, _)| scene.footprints(view, map.width)).collect();
    let tile =
        made.iter().zip(&seen).map(|((map, material), seen)| finest_tile(map, material, seen)).min().unwrap_or(2);
    let sizes: Vec<Vec<Size>> =
        made.iter().zip(&seen).map(|((map, material), seen)| exact(map, material, seen, PLACES, SEED)).collect();
    drop(made);
    let mut found = Found { measure: MEASURE, seen: line(&seen), dropped: Vec::new(), points: Vec::new() };
    // A preset says both, so that there is nothing to choose but the tiles.
    let settings = if drafts.way.words.says("preset") { &SETTINGS[..1] } else { &SETTINGS[..] };
    for setting in settings {
        let mut chosen = asked(*setting, tile);
        if drafts.way.words.says("preset") {
            chosen.retain(|(key, _)| key == "min-tile");
        }
        chosen.retain(|(key, _)| !drafts.way.words.says(key));
        if found.points.iter().any(|point| point.options == chosen) {
            continue;
        }
        let (made, bytes) = match drafts.make(&chosen) {
            Ok(draft) => ndf(draft)?,
            // A setting that misses the error it asks for is none to choose.
            Err(failure) if failure.exit == Exit::LimitExceeded && !found.points.is_empty() => continue,
            Err(failure) => return Err(failure),
        };
        if found.points.is_empty() && bytes < all_bytes {
            found.dropped.push(format!(
                "tiles finer than {tile} texels: no footprint reads them ({} at this error)",
                crate::quantities::kib(all_bytes - bytes)
            ));
        }
        let error = made.iter().zip(&sizes).map(|((_, material), sizes)| worst(material, sizes)).fold(0.0, f64::max);
        found.points.push(Point { options: chosen, bytes, error });
    }
    Ok(found)
}

fn ndf((draft, bytes): (Draft, u64)) -> Result<(Vec<(NormalMap, Material)>, u64), Failure> {
    match draft {
        Draft::NdfMaps(made) => Ok((made, bytes)),
        _ => Err(Failure::new(Exit::Unexpected, "a draft of NDF maps is something else; please report this")),
    }
}

fn line(seen: &[Footprints]) -> String {
    let part = |seen: &Footprints| {
        let (low, high) = seen.sigma;
        format!("footprints of σ {low:.2} to {high:.2} texels, up to {:.1} times as long", seen.anisotropy)
    };
    seen.iter().map(part).collect::<Vec<_>>().join("; ")
}

/// Footprints wider than this see all of an example.
fn widest(map: &NormalMap) -> f64 {
    WIDEST_EDGES * f64::from(map.width.max(map.height))
}

fn extent(map: &NormalMap) -> DVec2 {
    DVec2::new(f64::from(map.width), f64::from(map.height)) * EXTENT
}

/// Edge of the finest tile that any of many footprints of the scene reads; that of the covering tile where none reads one.
fn finest_tile(map: &NormalMap, material: &Material, seen: &Footprints) -> u32 {
    let levels = &material.maps.params.levels;
    let covering = levels.last().map_or(2, |level| level.tile_texels);
    let (low, high) = (seen.sigma.0.min(widest(map)), seen.sigma.1.min(widest(map)));
    let edge_of = |tile: u32| {
        let level = levels.iter().rev().find(|level| level.first_tile <= tile);
        level.map_or(covering, |level| level.tile_texels)
    };
    let probe = |k: u32| {
        // Both ends are among them, round and long.
        let share = f64::from(k / 2 % 32) / 31.0;
        let anisotropy = if k.is_multiple_of(2) { 1.0 } else { seen.anisotropy };
        let sigma = low * libm::pow(high / low, share);
        let all = footprints(sigma, anisotropy, extent(map), 1, SEED + u64::from(k));
        let terms = material.gather(&all[0], EvalSettings::default());
        terms.tiles.iter().map(|term| edge_of(term.tile)).min().unwrap_or(covering)
    };
    (0..PROBES).map(probe).min().unwrap_or(covering)
}

/// What footprints of each size should see.
fn exact(map: &NormalMap, material: &Material, seen: &Footprints, places: u32, seed: u64) -> Vec<Size> {
    let reference = SurfaceReference::new(map, material);
    let mut all = Vec::new();
    let most = widest(map);
    for sigma in sizes((seen.sigma.0.min(most), seen.sigma.1.min(most)), SIZES) {
        let anisotropies = if seen.anisotropy > 1.1 { vec![1.0, seen.anisotropy] } else { vec![1.0] };
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

/// The error of a baked pack at the scene's footprints, at other places than those that the plan was made at.
pub fn measured(map: &NormalMap, material: &Material, seen: &Footprints, places: u32, seed: u64) -> f64 {
    worst(material, &exact(map, material, seen, places, seed))
}
