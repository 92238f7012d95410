//! Counted facets: chances against quadrature, hits against facets placed one by one, and what a light costs.

use super::document::Document;
use super::settings::Settings;
use super::table::Table;
use crate::exit::Failure;
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use glam::{Vec2, Vec3};
use glint_bake_core::area_light::baked::{Tables, decode_tables};
use glint_bake_core::area_light::rect::RectLight;
use glint_bake_core::glints::eval::{
    ConeLight, CountedMaterial, FacetLight, cone_light, counted_surface, four_lights, hit_ratios, no_light, rect_facets,
};
use glint_bake_core::glints::reference::{ExplicitFacets, ReferenceSurface};
use glint_bake_core::glints::{CountedFacets, GlintsOptions, bake};
use glint_bake_core::microfacet::microfacet_cosine;
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_formats::glints::Slopes;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Instant;

const ALPHAS: [f32; 5] = [0.01, 0.03, 0.1, 0.3, 1.0];
/// Angles of view to the normal, in degrees.
const ANGLES: [f32; 4] = [0.0, 30.0, 60.0, 75.0];
/// The sun's disk.
const SUN_SR: f32 = 6.8e-5;
/// Half angle of the cone that a facet reflects a point into where only the sun's own width counts.
const LEAST_SPREAD: f32 = 1e-4;
/// Widths of rectangles as seen from the surface, in degrees.
const WIDTHS: [f32; 2] = [10.0, 30.0];
/// Roughness, and half angle of the cone of facets that are placed one by one.
const PLACED: (f32, f32) = (0.4, 0.05);
/// Pixels along an edge of the unit square that facets are placed on.
const PIXELS: [u32; 7] = [16, 32, 64, 128, 256, 512, 1024];

/// Measures the report.
pub fn measure(settings: &Settings) -> Result<Document, Failure> {
    let mut document = Document::new("glints", "Counted facets", settings);
    chances(&mut document)?;
    hits(&mut document, settings)?;
    costs(&mut document, settings)?;
    Ok(document)
}

fn baked(slopes: Slopes, alpha: f32, facet_spread: f32) -> Result<(GlintsOptions, CountedFacets, Tables), Failure> {
    let options = GlintsOptions { slopes, alpha: [alpha; 2], facet_spread, ..GlintsOptions::default() };
    let facets = bake(&options, &Silent)?;
    let tables = decode_tables(&facets.tables);
    Ok((options, facets, tables))
}

/// Unit vector at an angle from the normal, in degrees, on the side of +x or of −x.
fn towards(degrees: f32, side: f32) -> Vec3 {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    Vec3::new(side * sine, 0.0, cosine)
}

/// A square of radiance 1 at a distance of 2 that faces the surface.
fn square(direction: Vec3, degrees: f32) -> RectLight {
    let half = 2.0 * (0.5 * degrees).to_radians().tan();
    let x = direction.any_orthonormal_vector() * half;
    let y = direction.cross(x);
    let middle = direction * 2.0;
    RectLight {
        corners: [middle - x - y, middle + x - y, middle + x + y, middle - x + y],
        radiance: 1.0,
        two_sided: true,
    }
}

/// A light without colour.
fn cone(direction: Vec3, solid_angle_sr: f32) -> ConeLight {
    ConeLight { direction, irradiance: Vec3::ONE, solid_angle_sr }
}

/// Mean and worst of errors, in per cent.
fn summary(errors: &[f64]) -> String {
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let worst = errors.iter().copied().fold(0.0, f64::max);
    format!("{:.2} | {:.2}", 100.0 * mean, 100.0 * worst)
}

/// Chance of one facet: what the run time has against the integral over the light's directions (Eq. 8).
fn chances(document: &mut Document) -> Result<(), Failure> {
    document.heading(2, "Chance that a facet reflects a light");
    document.paragraph(format!(
        "Against quadrature over the light in f64, seen from {}° from the normal. The sun is half a degree wide and lies in the mirror \
         direction and half a roughness beside it; rectangles are squares of {}° in the mirror direction. Errors in per cent.",
        ANGLES.map(|angle| angle.to_string()).join("°, "),
        WIDTHS.map(|width| width.to_string()).join("° and "),
    ));
    let mut table = Table::new(1, "slopes | α | sun, mean | worst | rectangle, mean | worst");
    for slopes in [Slopes::Ggx, Slopes::Beckmann] {
        for alpha in ALPHAS {
            let (options, facets, tables) = baked(slopes, alpha, LEAST_SPREAD)?;
            let reference = ReferenceSurface::new(&options);
            let area = reference.facet_area();
            let seen = f64::from(SUN_SR) + PI * f64::from(LEAST_SPREAD).powi(2);
            let pixel = |view| counted_surface(facets.material(), Vec2::ZERO, Vec2::X, Vec2::Y, view);
            let off = |found: f32, exact: f64| (f64::from(found) / exact - 1.0).abs();
            let mut errors = (Vec::new(), Vec::new());
            for angle in ANGLES {
                let view = towards(angle, 1.0);
                for beside in [0.0, 0.5 * alpha.min(0.2)] {
                    let light = towards(angle - beside.to_degrees(), -1.0);
                    let exact = reference.cone_chance(view.as_dvec3(), light.as_dvec3(), seen, area);
                    errors.0.push(off(cone_light(pixel(view), cone(light, SUN_SR)).chance, exact));
                }
                for width in WIDTHS {
                    let light = square(towards(angle, -1.0), width);
                    let corners = light.corners.map(|corner| corner.as_dvec3());
                    let exact = reference.rect_chance(view.as_dvec3(), corners, area);
                    errors.1.push(off(rect_facets(&tables, pixel(view), &light).chance, exact));
                }
            }
            table.row(format!("{slopes:?} | {alpha} | {} | {}", summary(&errors.0), summary(&errors.1)));
        }
    }
    document.table(&table);
    Ok(())
}

/// Mean of values and their variance over its square.
fn moments(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    (mean, variance / (mean * mean))
}

/// Lit facets of each of `pixels`² pixels of the unit square.
fn placed_hits(facets: &ExplicitFacets, lit: &[bool], pixels: u32) -> Vec<f64> {
    let mut hits = vec![0.0; (pixels * pixels) as usize];
    for (place, _) in facets.places.iter().zip(lit).filter(|(_, lit)| **lit) {
        let at = (*place * f64::from(pixels)).as_uvec2().min(glam::UVec2::splat(pixels - 1));
        hits[(at.y * pixels + at.x) as usize] += 1.0;
    }
    hits
}

/// Hits of as many pixels, counted.
fn counted_hits(material: CountedMaterial, view: Vec3, light: Vec3, pixels: u32) -> Vec<f64> {
    let edge = 1.0 / pixels as f32;
    let of = |k: u32| {
        let place = Vec2::new((k % pixels) as f32 + 0.5, (k / pixels) as f32 + 0.5) * edge;
        let surface = counted_surface(material, place, Vec2::X * edge, Vec2::Y * edge, view);
        let found = cone_light(surface, cone(light, 0.0));
        let ratio = hit_ratios(surface, [found, no_light(), no_light(), no_light()])[0];
        f64::from(ratio * surface.facets * found.chance)
    };
    (0..pixels * pixels).into_par_iter().map(of).collect()
}

/// Hits by distance: a pixel on more facets has more of them, and less contrast.
fn hits(document: &mut Document, settings: &Settings) -> Result<(), Failure> {
    let (alpha, spread) = PLACED;
    let count = settings.pick(1usize << 21, 1 << 15);
    let facets = ExplicitFacets::new(count, f64::from(alpha), &mut ItemRng::new(1, Purpose::GlintReport, 0));
    let (options, counted, _) = baked(Slopes::Ggx, alpha, spread)?;
    let reference = ReferenceSurface::new(&options);
    let (view, light) = (towards(30.0, 1.0), towards(30.0, -1.0));
    let cone_sr = PI * f64::from(spread).powi(2);
    let chance = reference.cone_chance(view.as_dvec3(), light.as_dvec3(), cone_sr, reference.facet_area());
    let lit = facets.lit(view.as_dvec3(), light.as_dvec3(), f64::from(spread));
    let material = CountedMaterial { density: count as f32, ..counted.material() };
    document.heading(2, "Hits of a pixel by distance");
    document.paragraph(format!(
        "{count} facets of GGX slopes, α {alpha}, placed one by one on a unit square, against as many that are counted; a light in the \
         mirror direction at 30°, seen by a facet {:.1}° either side. The square is divided in pixels: the more there are, the nearer they are. \
         Relative variance is that over the square of the mean; independent facets have (1 − p) / (N p). Means of few pixels, and variances of \
         pixels with few hits, are noisy themselves.",
        spread.to_degrees()
    ));
    let mut table = Table::new(
        0,
        "pixels | facets a pixel | hits expected | placed, mean | counted, mean | relative variance, exact | placed | counted",
    );
    let mut curves = [Vec::new(), Vec::new(), Vec::new()];
    for pixels in PIXELS {
        let a_pixel = count as f64 / f64::from(pixels).powi(2);
        let expected = a_pixel * chance;
        let (placed, placed_variance) = moments(&placed_hits(&facets, &lit, pixels));
        let (found, found_variance) = moments(&counted_hits(material, view, light, pixels));
        let exact = (1.0 - chance) / expected;
        table.row(format!(
            "{pixels}² | {a_pixel:.4} | {expected:.4} | {placed:.4} | {found:.4} | {exact:.4} | {placed_variance:.4} | {found_variance:.4}"
        ));
        for (curve, variance) in curves.iter_mut().zip([exact, placed_variance, found_variance]) {
            curve.push((expected, variance));
        }
    }
    document.table(&table);
    let [exact, placed, found] = curves;
    let panel = Panel {
        title: "contrast by distance".to_owned(),
        x: Axis::powers_around("hits expected of a pixel", exact.iter().map(|point| point.0)),
        y: Axis::powers_around("relative variance", exact.iter().map(|point| point.1)),
        series: vec![
            Series::line("independent facets", Colour::Green, exact),
            Series::line("placed one by one", Colour::Vermilion, placed),
            Series::line("counted", Colour::Blue, found),
        ],
    };
    let figure = Figure { title: String::new(), panels: vec![panel], columns: 1, panel_size: (480, 320) };
    document.plot("", "relative variance of hits by expected hits", &figure);
    Ok(())
}

/// Nanoseconds of a call, the least of some runs.
fn nanoseconds(calls: u32, mut f: impl FnMut(u32) -> Vec3) -> f64 {
    const RUNS: u32 = 7;
    let mut least = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        let mut sum = Vec3::ZERO;
        for k in 0..calls {
            sum += f(k);
        }
        black_box(sum);
        least = least.min(1e9 * start.elapsed().as_secs_f64() / f64::from(calls));
    }
    least
}

/// Time of a pixel on the CPU by its lights, beside the smooth surface in the same lights.
fn costs(document: &mut Document, settings: &Settings) -> Result<(), Failure> {
    let (options, facets, tables) = baked(Slopes::Ggx, 0.3, 0.004_65)?;
    let (material, smooth) = (facets.material(), options.smooth());
    let calls = settings.pick(400_000, 2_000);
    let view_of = |k: u32| towards((k % 97) as f32 * 0.6, 1.0);
    let suns = [towards(20.0, -1.0), towards(25.0, -1.0), towards(30.0, -1.0), towards(35.0, -1.0)];
    let rect = square(towards(30.0, -1.0), 20.0);
    document.heading(2, "Time of a pixel by its lights");
    document.paragraph(
        "The twins on one core of the CPU, GGX, α 0.3, one pixel after the other; the smooth surface is the BRDF that facets converge to, of a rectangle its \
         linearly transformed cosine. The GPU's frames are rows of `glint-view --bench`.",
    );
    let mut table = Table::new(1, "lights | smooth, ns | counted, ns | ratio | more than one light less, ns");
    let mut before = f64::NAN;
    let surface = |k: u32| {
        let place = Vec2::new((k % 641) as f32, (k / 641) as f32) * 1e-3;
        counted_surface(material, place, Vec2::X * 1e-3, Vec2::Y * 1e-3, view_of(k))
    };
    for count in 1..=4usize {
        let plain = nanoseconds(calls, |k| {
            let view = view_of(k);
            suns[..count].iter().map(|sun| microfacet_cosine(smooth, material.f0, view, *sun)).sum()
        });
        let counted = nanoseconds(calls, |k| {
            let surface = surface(k);
            let mut lights: [FacetLight; 4] = [no_light(); 4];
            for (light, sun) in lights.iter_mut().zip(&suns[..count]) {
                *light = cone_light(surface, cone(*sun, SUN_SR));
            }
            four_lights(surface, &[], lights)
        });
        let more = if count > 1 { format!("{:.0}", counted - before) } else { String::new() };
        let name = if count > 1 { format!("{count} suns") } else { "a sun".to_owned() };
        table.row(format!("{name} | {plain:.0} | {counted:.0} | {:.2} | {more}", counted / plain));
        before = counted;
    }
    let plain = nanoseconds(calls, |k| rect_facets(&tables, surface(k), &rect).radiance);
    let counted = nanoseconds(calls, |k| {
        let surface = surface(k);
        four_lights(surface, &[], [rect_facets(&tables, surface, &rect), no_light(), no_light(), no_light()])
    });
    table.row(format!("a rectangle | {plain:.0} | {counted:.0} | {:.2} | ", counted / plain));
    document.table(&table);
    Ok(())
}
