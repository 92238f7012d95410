//! Drafts of NDF maps: which windows the scene's footprints read, and bytes against E₁ at those footprints, as a shader reads them.

use super::args::Args;
use super::bake::draft;
use crate::exit::{Exit, Failure};
use crate::methods::bake::Candidates;
use crate::methods::planning::{Request, sizes};
use crate::quantities::kib;
use crate::scene::Footprints;
use glam::{DMat2, DVec2};
use glint_bake_core::footprint::Footprint;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::eval::{EvalSettings, matrix};
use glint_bake_core::ndf_maps::options::FINEST_WINDOW_RANGE;
use glint_bake_core::ndf_maps::quality::ExactNdf;
use glint_bake_core::ndf_maps::reference_surface::SurfaceReference;
use glint_bake_core::ndf_maps::sections;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::quality::sweep::footprints;
use glint_formats::Pack;
use rayon::prelude::*;

/// Errors asked of nodes, from few bytes to many.
const ERRORS: [f64; 6] = [0.2, 0.1, 0.05, 0.03, 0.02, 0.01];
/// Sizes of footprints that are measured, at most, and places of each.
const SIZES: usize = 3;
const PLACES: u32 = 6;
/// Footprints wider than so many edges of the example see all of it, however wide they are.
const WIDEST_EDGES: f64 = 1.0;
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
    // A preset says the error, so that there is nothing to choose but the windows.
    let preset = request.fixes("preset");
    let asked = |error: f64, window: Option<f64>| {
        let mut choice = request.choice(base.clone());
        if !preset {
            choice.choose("max-error", error, |args| args.max_error = Some(error));
        }
        if let Some(window) = window {
            choice.choose("finest-window", window, |args| args.finest_window = Some(window));
        }
        choice
    };
    let (made, all_bytes) = draft(&asked(ERRORS[0], None).args)?;
    let footprints: Vec<Footprints> = made.iter().map(|(map, _)| request.scene.footprints(view, map.width)).collect();
    let covering = made.iter().zip(&footprints);
    let windows = covering.map(|((map, material), footprints)| finest_window(map, material, footprints));
    let window = windows.fold(f64::INFINITY, f64::min);
    let window = (window > args.default_window()).then_some(window);
    let sizes: Vec<Vec<Size>> = made
        .iter()
        .zip(&footprints)
        .map(|((map, material), footprints)| exact(map, material, footprints, PLACES, SEED))
        .collect();
    drop(made);
    let mut found = Candidates::new(line(&footprints));
    let errors = if preset { &ERRORS[..1] } else { &ERRORS[..] };
    for error in errors {
        let choice = asked(*error, window);
        if found.has(&choice.options) {
            continue;
        }
        let (made, bytes) = match draft(&choice.args) {
            Ok(draft) => draft,
            // An error that the bake misses is none to choose.
            Err(failure) if failure.exit == Exit::LimitExceeded && !found.drafts.is_empty() => continue,
            Err(failure) => return Err(failure),
        };
        if let Some(window) = window
            && found.drafts.is_empty()
            && bytes < all_bytes
        {
            found.dropped.push(format!(
                "windows narrower than {window} texels: no footprint reads them ({} at this error)",
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

/// The widest finest window, in texels, that no footprint of the scene is narrower than, to three decimals. A footprint is narrowest in
/// the example along the axis that a transform of the palette shrinks most.
fn finest_window(map: &NormalMap, material: &Material, visible: &Footprints) -> f64 {
    let shrinks = |m: DMat2| {
        let (area, squares) = (m.determinant().abs(), m.x_axis.length_squared() + m.y_axis.length_squared());
        // The singular values have this sum and difference.
        0.5 * ((squares + 2.0 * area).sqrt() - (squares - 2.0 * area).max(0.0).sqrt())
    };
    let palette = material.placement.palette.iter();
    let smallest =
        palette.map(|entry| shrinks(matrix(entry.position_to_local).as_dmat2())).fold(f64::INFINITY, f64::min);
    (1e3 * visible.sigma.0.min(widest(map)) * smallest).floor().min(1e3 * FINEST_WINDOW_RANGE.1) / 1e3
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

/// Mean E₁ over the footprints of a size, read as a shader reads them, the largest of all sizes.
fn worst(material: &Material, sizes: &[Size]) -> f64 {
    let of_one = |(footprint, exact): &(Footprint, ExactNdf)| {
        let terms = material.gather(footprint, EvalSettings::REAL_TIME);
        exact.error(|s| material.density(&terms, s)).e1
    };
    let mean = |size: &Size| {
        let errors: Vec<f64> = size.footprints.par_iter().map(of_one).collect();
        errors.iter().sum::<f64>() / errors.len().max(1) as f64
    };
    sizes.iter().map(mean).fold(0.0, f64::max)
}
