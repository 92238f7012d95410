//! The LTC tables: reproducible, no worse than the published ones, and the clipped sphere against a sum over directions.

use glam::{DVec2, DVec3};
use glint_bake_core::area_light::baked::{LtcTables, SIZE, TABLE_MEAN_ERROR, decode_tables};
use glint_bake_core::area_light::fit::{
    alpha_of, brdf_cosine, clipped_sphere, cosine_of, distribution, fit_tables, visible_density, visible_normal,
};
use glint_bake_core::area_light::quality::table_error;
use std::f64::consts::{PI, TAU};

/// Mean relative error of the published 64 × 64 tables (Heitz et al. 2016), as `table_error` measures it on their values.
const PUBLISHED_MEAN_ERROR: f64 = 0.1171;

#[test]
fn the_built_in_tables_are_what_the_fit_gives() {
    assert!(fit_tables() == LtcTables::built_in(), "run the example fit_ltc_tables, which writes them anew");
}

#[test]
fn the_tables_are_nearer_to_ggx_than_the_published_ones() {
    let error = table_error(&LtcTables::built_in());
    assert!((error.mean - TABLE_MEAN_ERROR).abs() < 1e-4, "{error:?}");
    assert!(error.mean < 0.7 * PUBLISHED_MEAN_ERROR, "{error:?}");
}

/// Albedo and Fresnel term by a plain sum over the hemisphere of half vectors, no sampling of visible normals.
#[test]
fn magnitudes_are_integrals_of_ggx() {
    let tables = decode_tables(&LtcTables::built_in());
    for (i, j) in [(20, 0), (20, 30), (40, 10), (40, 55), (63, 5), (63, 40)] {
        let (alpha, cosine) = (alpha_of(i), cosine_of(j));
        let view = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        let (mut magnitude, mut fresnel) = (0.0, 0.0);
        let (rings, spokes) = (600, 600);
        for r in 0..rings {
            // Equal shares of D cosθ.
            let u = (f64::from(r) + 0.5) / f64::from(rings);
            let slope = alpha * (u / (1.0 - u)).sqrt();
            let z = 1.0 / (1.0 + slope * slope).sqrt();
            for s in 0..spokes {
                let phi = TAU * (f64::from(s) + 0.5) / f64::from(spokes);
                let half = DVec3::new(slope * z * phi.cos(), slope * z * phi.sin(), z);
                let c = view.dot(half);
                let light = 2.0 * c * half - view;
                if c <= 0.0 || light.z <= 0.0 {
                    continue;
                }
                let share = brdf_cosine(view, light, alpha) * 4.0 * c
                    / (distribution(half, alpha) * z * f64::from(rings * spokes));
                magnitude += share;
                fresnel += share * (1.0 - c).powi(5);
            }
        }
        let found = tables.terms[j * SIZE + i];
        assert!((f64::from(found.x) - magnitude).abs() < 3e-3, "{i} {j}: {found} {magnitude}");
        assert!((f64::from(found.y) - fresnel).abs() < 3e-3, "{i} {j}: {found} {fresnel}");
    }
}

#[test]
fn visible_normals_have_the_density_they_say() {
    // Mean of any function over samples is its integral against the density: here the half vector's z.
    let (alpha, view) = (0.4, DVec3::new(0.8, 0.0, 0.6));
    let (mut sampled, mut count) = (0.0, 0.0);
    let n = 400;
    for i in 0..n {
        for j in 0..n {
            let radius = ((f64::from(i) + 0.5) / f64::from(n)).sqrt();
            let phi = TAU * (f64::from(j) + 0.5) / f64::from(n);
            sampled += visible_normal(view, alpha, DVec2::new(phi.cos(), phi.sin()) * radius).z;
            count += 1.0;
        }
    }
    let (mut integral, mut total) = (0.0, 0.0);
    for i in 0..n {
        let theta = 0.5 * PI * (f64::from(i) + 0.5) / f64::from(n);
        for j in 0..n {
            let phi = TAU * (f64::from(j) + 0.5) / f64::from(n);
            let half = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            let c = view.dot(half).max(0.0);
            // Over half vectors the density is 4 v·h times that over lights.
            let density = visible_density(view, half, alpha) * 4.0 * c * theta.sin();
            integral += density * half.z;
            total += density;
        }
    }
    let cell = 0.5 * PI * TAU / f64::from(n * n);
    assert!((total * cell - 1.0).abs() < 1e-3, "{}", total * cell);
    assert!((sampled / count - integral / total).abs() < 1e-3);
}

#[test]
fn a_sphere_cut_by_the_horizon_is_a_sum_over_directions() {
    for form_factor in [0.01, 0.2, 0.7, 0.99] {
        let sin = f64::sqrt(form_factor);
        let cos = (1.0 - form_factor).sqrt();
        for z in [-0.99, -0.6, -0.2, 0.0, 0.1, 0.5, 0.9, 1.0] {
            let axis = DVec3::new(f64::sqrt(1.0 - z * z), 0.0, z);
            let (t, b) = axis.any_orthonormal_pair();
            let (mut sum, n) = (0.0, 400);
            for i in 0..n {
                // Equal solid angles of the cap.
                let c = 1.0 - (1.0 - cos) * (f64::from(i) + 0.5) / f64::from(n);
                let s = (1.0 - c * c).sqrt();
                for j in 0..n {
                    let phi = TAU * (f64::from(j) + 0.5) / f64::from(n);
                    sum += (axis * c + (t * phi.cos() + b * phi.sin()) * s).z.max(0.0);
                }
            }
            let exact = sum / f64::from(n * n) * TAU * (1.0 - cos) / PI / (sin * sin);
            let found = clipped_sphere(z, form_factor);
            assert!((found - exact).abs() < 2e-4, "{form_factor} {z}: {found} {exact}");
        }
    }
    for z in [-1.0, 0.0, 1.0, f64::from_bits(1)] {
        for form_factor in [0.0, 1e-30, 1.0, 2.0] {
            assert!((0.0..=1.0).contains(&clipped_sphere(z, form_factor)));
        }
    }
}
