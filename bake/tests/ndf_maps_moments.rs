//! What light from all around sees of NDF maps: mean and covariance of the normals under a footprint against the surface's own, and the
//! directions that are sampled by them.

use glam::{DVec2, Vec2, Vec3};
use glint_bake_core::brdf::facet_brdf;
use glint_bake_core::footprint::Footprint;
use glint_bake_core::moments::{Moments, moments_pdf, moments_sample, rough_normal};
use glint_bake_core::ndf_maps::bake::bake_maps;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::eval::{EvalSettings, matrix};
use glint_bake_core::ndf_maps::options::{NdfMapsOptions, PlacementOptions, StochasticOptions, TransformRanges};
use glint_bake_core::ndf_maps::placement::place;
use glint_bake_core::ndf_maps::reference_surface::SurfaceReference;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::quality::sweep::footprints;
use glint_formats::Wrap;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f32::consts::{PI, TAU};

const ROUGHNESS: f64 = 0.05;
const VIEW: Vec3 = Vec3::new(0.36, -0.48, 0.8);

/// Scales along one direction, with a slope of their own.
fn map() -> NormalMap {
    let normal = |k: u32| {
        let (x, y) = ((k % 16) as f32, (k / 16) as f32);
        [0.1 + 0.2 * (TAU * (2.0 * x + y) / 16.0).sin(), 0.1 * (TAU * 3.0 * y / 16.0).cos() - 0.05]
    };
    NormalMap { width: 16, height: 16, wrap: Wrap::Repeat, projected: (0..256).map(normal).collect() }
}

fn material(map: &NormalMap, placement: &PlacementOptions) -> Material {
    let options = NdfMapsOptions { roughness: ROUGHNESS, ..NdfMapsOptions::default() };
    let maps = bake_maps(map, &options, &Silent).unwrap();
    Material { placement: place(map, ROUGHNESS, placement).unwrap(), maps }
}

/// The moments of the surface under a footprint by their definition, over a lattice of places.
fn exact(reference: &SurfaceReference<'_>, map: &NormalMap, footprint: &Footprint) -> Moments {
    let (minor, major, axis) = footprint.principal();
    let (mut total, mut mean, mut second) = (0.0, DVec2::ZERO, [0.0; 3]);
    let lobe = ROUGHNESS * ROUGHNESS;
    for i in -40..=40 {
        for j in -40..=40 {
            let (x, y) = (f64::from(i) / 10.0, f64::from(j) / 10.0);
            let place = footprint.mean + axis * (x * major) + axis.perp() * (y * minor);
            let weight = (-0.5 * (x * x + y * y)).exp();
            for (class, local, part) in reference.shown_at(place) {
                let entry = reference.material().placement.palette[class];
                let m = matrix(entry.normal_to_local).inverse().as_dmat2();
                let n = m * map.bilinear(local).0;
                let spread = m * m.transpose() * lobe;
                let weight = weight * part;
                total += weight;
                mean += weight * n;
                second[0] += weight * (n.x * n.x + spread.x_axis.x);
                second[1] += weight * (n.x * n.y + spread.x_axis.y);
                second[2] += weight * (n.y * n.y + spread.y_axis.y);
            }
        }
    }
    let mean = mean / total;
    let [xx, xy, yy] = second.map(|sum| sum / total);
    let covariance = [xx - mean.x * mean.x, xy - mean.x * mean.y, yy - mean.y * mean.y];
    Moments { mean: mean.as_vec2(), covariance: Vec3::from(covariance.map(|v| v as f32)) }
}

/// Largest and mean distance of means and of standard deviations, over the standard deviation of the normals seen.
fn compare(name: &str, placement: &PlacementOptions) -> ([f32; 2], [f32; 2]) {
    let map = map();
    let material = material(&map, placement);
    let reference = SurfaceReference::new(&map, &material);
    let (mut means, mut deviations) = (Vec::new(), Vec::new());
    for (sigma, anisotropy) in
        [(0.3, 1.0), (0.7, 1.0), (1.5, 1.0), (3.0, 1.0), (6.0, 1.0), (20.0, 1.0), (0.7, 3.0), (3.0, 3.0)]
    {
        let first = means.len();
        for footprint in footprints(sigma, anisotropy, DVec2::splat(500.0), 8, 3) {
            let seen = material.moments(&footprint, EvalSettings::REAL_TIME);
            let exact = exact(&reference, &map, &footprint);
            let deviation = |moments: &Moments| (0.5 * (moments.covariance.x + moments.covariance.z)).sqrt();
            means.push(seen.mean.distance(exact.mean) / deviation(&exact));
            deviations.push((deviation(&seen) / deviation(&exact) - 1.0).abs());
        }
        let worst = |values: &[f32]| values[first..].iter().copied().fold(0.0, f32::max);
        println!("  σ {sigma}, {anisotropy}: worst {:.3}, {:.3}", worst(&means), worst(&deviations));
    }
    let of =
        |values: &[f32]| [values.iter().copied().fold(0.0, f32::max), values.iter().sum::<f32>() / values.len() as f32];
    let found = (of(&means), of(&deviations));
    println!("{name}: worst and mean error of means {:?}, of standard deviations {:?}", found.0, found.1);
    found
}

#[test]
fn moments_are_those_of_the_surface() {
    let (means, deviations) = compare("tiled", &PlacementOptions::Tiled(TransformRanges::default()));
    assert!(means[0] < 0.15 && means[1] < 0.04, "{means:?}");
    assert!(deviations[0] < 0.09 && deviations[1] < 0.015, "{deviations:?}");
    let ranges = TransformRanges { rotate_degrees: (0.0, 360.0), stretch: (0.7, 1.4), ..TransformRanges::default() };
    let random = PlacementOptions::Stochastic(StochasticOptions { ranges, ..StochasticOptions::default() });
    let (means, deviations) = compare("at random", &random);
    assert!(means[0] < 0.175 && means[1] < 0.05, "{means:?}");
    assert!(deviations[0] < 0.15 && deviations[1] < 0.025, "{deviations:?}");
}

#[test]
fn a_rough_normal_has_the_moments() {
    // Upright: the axes of the disk are those of the surface.
    let upright = rough_normal(Moments { mean: Vec2::ZERO, covariance: Vec3::new(0.02, 0.0, 0.005) });
    assert!((upright.alpha - Vec2::new(0.2, 0.1)).length() < 1e-6, "{upright:?}");
    assert!(upright.axis.x.abs() > 0.999_999 && upright.normal == Vec3::Z, "{upright:?}");
    // Tilted by 60 degrees along x: steps along x are twice as long on the surface.
    let mean = Vec2::new((PI / 3.0).sin(), 0.0);
    let tilted = rough_normal(Moments { mean, covariance: Vec3::new(0.005, 0.0, 0.005) });
    assert!((tilted.alpha - Vec2::new(0.2, 0.1)).length() < 1e-6, "{tilted:?}");
    assert!(tilted.axis.dot(tilted.normal).abs() < 1e-6 && (tilted.axis.z.abs() - mean.x).abs() < 1e-6, "{tilted:?}");
    // Hard cases: nothing, everything, the rim.
    for (mean, covariance) in [
        (Vec2::ZERO, Vec3::ZERO),
        (Vec2::new(0.6, 0.8), Vec3::new(0.3, -0.2, 0.4)),
        (Vec2::new(1.0, 0.0), Vec3::new(1e-12, 0.0, 1e-12)),
    ] {
        let rough = rough_normal(Moments { mean, covariance });
        let finite = rough.normal.is_finite() && rough.axis.is_finite() && rough.alpha.is_finite();
        assert!(finite && (rough.normal.length() - 1.0).abs() < 1e-5 && rough.alpha.max_element() <= 1.0, "{rough:?}");
    }
}

const TILTED: Moments = Moments { mean: Vec2::new(0.1, -0.05), covariance: Vec3::new(0.02, 0.008, 0.01) };

/// Counts of sampled directions in bins of cos θ and φ against the integral of their density, and the samples without a direction.
#[test]
fn samples_have_the_density_that_is_said() {
    const SAMPLES: u32 = 400_000;
    const BINS: (usize, usize) = (10, 20);
    const FINE: usize = 24;
    let mut counts = vec![0.0f64; BINS.0 * BINS.1];
    let mut rng = Pcg64::seed_from_u64(7);
    for _ in 0..SAMPLES {
        let light = moments_sample(TILTED, VIEW, Vec3::new(rng.random(), rng.random(), rng.random()));
        if light.z > 0.0 {
            let column = ((light.y.atan2(light.x) / TAU + 0.5) * BINS.1 as f32) as usize % BINS.1;
            counts[((light.z * BINS.0 as f32) as usize).min(BINS.0 - 1) * BINS.1 + column] += 1.0;
        }
    }
    let (mut chi2, mut freedom, mut inside) = (0.0f64, 0.0f64, 0.0f64);
    for (k, count) in counts.iter().enumerate() {
        let mut expected = 0.0;
        for sub in 0..FINE * FINE {
            let z = ((k / BINS.1) as f32 + ((sub / FINE) as f32 + 0.5) / FINE as f32) / BINS.0 as f32;
            let phi = (((k % BINS.1) as f32 + ((sub % FINE) as f32 + 0.5) / FINE as f32) / BINS.1 as f32 - 0.5) * TAU;
            let radius = (1.0 - z * z).sqrt();
            expected += f64::from(moments_pdf(TILTED, VIEW, Vec3::new(radius * phi.cos(), radius * phi.sin(), z)));
        }
        expected *= f64::from(SAMPLES) * f64::from(TAU) / (BINS.0 * BINS.1 * FINE * FINE) as f64;
        inside += expected;
        if expected > 20.0 {
            chi2 += (count - expected).powi(2) / expected;
            freedom += 1.0;
        }
    }
    let sampled: f64 = counts.iter().sum();
    println!("chi² {chi2:.1} of {freedom} bins; {sampled} directions, {inside:.0} expected");
    assert!(freedom > 50.0 && chi2 < freedom + 5.0 * (2.0 * freedom).sqrt(), "chi² {chi2} of {freedom} bins");
    assert!((sampled - inside).abs() < 5.0 * inside.sqrt(), "{sampled} directions, {inside} expected");
}

/// The mean of sampled weights is the albedo: the same integral over the disk of projected half vectors.
#[test]
fn the_mean_of_sampled_weights_is_the_albedo() {
    let map = map();
    let material = material(&map, &PlacementOptions::Tiled(TransformRanges::default()));
    for sigma in [0.4, 2.0, 10.0] {
        let footprint = Footprint::new(DVec2::new(5.3, 9.1), sigma, 1.0, 0.0);
        let settings = EvalSettings::REAL_TIME;
        let terms = material.gather(&footprint, settings);
        let reflected = |light: Vec3| {
            let half = (VIEW + light).normalize();
            let density = Vec3::splat(material.density(&terms, Vec2::new(half.x, half.y)));
            facet_brdf(density, Vec3::ONE, VIEW, light).x * light.z
        };
        const GRID: usize = 500;
        let mut albedo = 0.0;
        for k in 0..GRID * GRID {
            let s = Vec2::new((k % GRID) as f32 + 0.5, (k / GRID) as f32 + 0.5) * (2.0 / GRID as f32) - 1.0;
            if s.length_squared() < 1.0 {
                let half = Vec3::new(s.x, s.y, (1.0 - s.length_squared()).sqrt());
                let light = 2.0 * VIEW.dot(half) * half - VIEW;
                if VIEW.dot(half) > 0.0 && light.z > 0.0 {
                    let solid_angle = 4.0 * VIEW.dot(half) / half.z * (4.0 / (GRID * GRID) as f32);
                    albedo += f64::from(reflected(light) * solid_angle);
                }
            }
        }
        let moments = material.moments(&footprint, settings);
        let mut rng = Pcg64::seed_from_u64(11);
        const SAMPLES: u32 = 200_000;
        let (mut sum, mut square) = (0.0, 0.0);
        for _ in 0..SAMPLES {
            let light = moments_sample(moments, VIEW, Vec3::new(rng.random(), rng.random(), rng.random()));
            let weight =
                if light.z > 0.0 { f64::from(reflected(light) / moments_pdf(moments, VIEW, light)) } else { 0.0 };
            sum += weight;
            square += weight * weight;
        }
        let mean = sum / f64::from(SAMPLES);
        let noise = ((square / f64::from(SAMPLES) - mean * mean) / f64::from(SAMPLES)).sqrt();
        println!(
            "σ {sigma}: albedo {albedo:.4}, sampled {mean:.4} ± {noise:.4}, one sample ± {:.2}",
            noise / mean * f64::from(SAMPLES).sqrt()
        );
        assert!((mean - albedo).abs() < 4.0 * noise + 2e-3, "σ {sigma}: {mean} ± {noise}, albedo {albedo}");
        assert!(noise < 0.002 * mean, "σ {sigma}: noise {noise}");
    }
}
