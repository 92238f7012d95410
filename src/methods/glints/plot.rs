//! What a material of counted facets looks like from afar and near, as an SVG: how many facets of a pixel reflect a sun, and the contrast
//! that follows.

use crate::exit::{Exit, Failure};
use crate::methods::plots::{WritePlot, stems};
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use glam::{Vec2, Vec3};
use glint_bake_core::glints::CountedFacets;
use glint_bake_core::glints::eval::{ConeLight, cone_light, counted_surface};
use glint_bake_core::glints::sections;
use glint_formats::Pack;
use glint_formats::glints::PARAMS;

/// Solid angle of the sun, in steradians.
const SUN_SR: f32 = 6.8e-5;
/// Powers of ten of a pixel's edge that are shown, and steps between two of them.
const DECADES: i32 = 6;
const STEPS: i32 = 4;

/// Pixels from 1e-5 to 10 units wide, seen from ahead and from 60°, in the mirror image of the eye.
fn svg(name: &str, facets: &CountedFacets) -> String {
    let curve = |angle: f32, value: fn(f64, f64) -> f64| -> Vec<(f64, f64)> {
        let point = |step: i32| {
            let edge = 10f64.powf(f64::from(step) / f64::from(STEPS) - 5.0);
            let (hits, chance) = expected(facets, edge as f32, angle);
            (edge, value(hits, chance))
        };
        (0..=DECADES * STEPS).map(point).collect()
    };
    let panel = |title: &str, label: &str, value| {
        let (ahead, aside) = (curve(0.0, value), curve(60.0, value));
        let values = ahead.iter().chain(&aside).map(|(_, value)| *value);
        Panel {
            title: title.to_owned(),
            x: Axis::logarithmic("edge of a pixel, units", (1e-5, 10.0)),
            y: Axis::powers_around(label, values),
            series: vec![Series::line("ahead", Colour::Sky, ahead), Series::line("60°", Colour::Vermilion, aside)],
        }
    };
    let hits = |hits: f64, _: f64| hits;
    let contrast = |hits: f64, chance: f64| ((1.0 - chance) / hits).sqrt();
    Figure {
        title: format!("{name}: facets that reflect a sun in a pixel, and their contrast"),
        panels: vec![panel("facets lit", "facets", hits), panel("standard deviation over mean", "contrast", contrast)],
        columns: 2,
        panel_size: (320, 220),
    }
    .to_svg()
}

/// Expected hits of a pixel that is `edge` units wide, and the chance of a facet, at an angle in degrees.
fn expected(facets: &CountedFacets, edge: f32, angle: f32) -> (f64, f64) {
    let (sine, cosine) = angle.to_radians().sin_cos();
    let view = Vec3::new(sine, 0.0, cosine);
    let along = Vec2::new(edge / cosine, 0.0);
    let surface = counted_surface(facets.material(), Vec2::ZERO, along, Vec2::new(0.0, edge), view);
    let direction = Vec3::new(-sine, 0.0, cosine);
    let chance = cone_light(surface, ConeLight { direction, irradiance: Vec3::ONE, solid_angle_sr: SUN_SR }).chance;
    (f64::from(surface.facets) * f64::from(chance), f64::from(chance))
}

/// A picture of every material of counted facets.
///
/// # Errors
/// Bad input, when a material cannot be used; those of `write`.
pub fn write_all(pack: &Pack, write: &mut WritePlot<'_>) -> Result<(), Failure> {
    for (stem, name) in stems(pack, PARAMS) {
        let facets = sections::from_pack(pack, name)
            .map_err(|e| Failure::new(Exit::BadInput, format!("counted facets {name}: {e}")))?;
        write(format!("{stem}-facets.svg"), svg(name, &facets).into_bytes())?;
    }
    Ok(())
}
