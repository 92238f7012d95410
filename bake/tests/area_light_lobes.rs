//! Closed forms and fits for lobes of normals, against integrals in f64.

use glint_bake_core::area_light::eval;
use glint_bake_core::area_light::eval::alpha_of_code;
use glint_bake_core::area_light::reference::{convolved_alpha, deficit, lobe_density};
use glint_bake_core::area_light::spread::convolve_alpha;
use glint_bake_core::area_light::spread::{AlphaOf, KAPPA, axis_concentration, code_of, concentration};
use glint_bake_core::area_light::spread::{MAX_DEFICIT, alpha_from_deficit, deficit_from_alpha};

/// Roughness from 1e-3 to 1, evenly in the logarithm.
fn alphas(count: u32) -> impl Iterator<Item = f64> {
    (0..=count).map(move |k| 10f64.powf(-3.0 * (1.0 - f64::from(k) / f64::from(count))))
}

#[test]
fn the_closed_form_is_the_integral() {
    for alpha in alphas(40) {
        let relative = deficit_from_alpha(alpha) / deficit(alpha, 4000) - 1.0;
        assert!(relative.abs() < 1e-9, "α {alpha}: {relative:e}");
    }
    assert_eq!((deficit_from_alpha(0.0), deficit_from_alpha(1.0)), (0.0, MAX_DEFICIT));
}

#[test]
fn roughness_and_deficit_go_both_ways() {
    for alpha in alphas(500) {
        let there = deficit_from_alpha(alpha);
        assert!((alpha_from_deficit(there) / alpha - 1.0).abs() < 1e-12, "α {alpha}");
        // The run time's, in f32.
        let there32 = there as f32;
        let back = f64::from(eval::alpha_from_deficit(there32)) / alpha_from_deficit(f64::from(there32)) - 1.0;
        assert!(back.abs() < 1e-5, "α {alpha}: {back:e}");
    }
    for nothing in [0.0, -1.0, f64::NAN] {
        assert_eq!((alpha_from_deficit(nothing), eval::alpha_from_deficit(nothing as f32)), (0.0, 0.0));
    }
    for all in [MAX_DEFICIT, 0.5, 1.0, f64::INFINITY] {
        assert_eq!((alpha_from_deficit(all), eval::alpha_from_deficit(all as f32)), (1.0, 1.0));
    }
    assert!((deficit_from_alpha(alpha_from_deficit(1e-12)) / 1e-12 - 1.0).abs() < 1e-12);
}

#[test]
fn the_length_itself_would_not_do_in_f32() {
    // Half a unit in the last place of R = 1 − 6.6e-6 moves α = 1e-3 by tenths of a per cent; the deficit by 1e-7.
    let deficit = deficit_from_alpha(1e-3);
    let rounded = 1.0 - f64::from((1.0 - deficit) as f32);
    assert!((alpha_from_deficit(rounded) / 1e-3 - 1.0).abs() > 1e-4);
    let rounded = f64::from(deficit as f32);
    assert!((alpha_from_deficit(rounded) / 1e-3 - 1.0).abs() < 1e-7);
}

#[test]
fn convolution_is_within_one_per_cent() {
    let grid = [0.01, 0.05, 0.12, 0.22, 0.35, 0.5, 0.65, 0.8, 0.9, 0.99];
    let mut worst: f64 = 0.0;
    for (i, &a) in grid.iter().enumerate() {
        for &b in &grid[..=i] {
            let relative = convolve_alpha(a, b) / convolved_alpha(a, b) - 1.0;
            worst = worst.max(relative.abs());
            assert!(relative.abs() < 0.01, "{a} and {b}: {relative}");
        }
    }
    assert!(worst > 1e-4, "no fit is exact: {worst}");
}

#[test]
fn convolution_is_symmetric_exact_at_0_and_never_leaves_its_range() {
    for i in 0..=100 {
        let a = f64::from(i) / 100.0;
        assert_eq!((convolve_alpha(a, 0.0), convolve_alpha(0.0, a)), (a, a));
        assert_eq!(eval::convolve_alpha(a as f32, 0.0), a as f32);
        let mut before = 0.0;
        for j in 0..=100 {
            let b = f64::from(j) / 100.0;
            let c = convolve_alpha(a, b);
            assert_eq!(c, convolve_alpha(b, a));
            assert!((0.0..=1.0).contains(&c) && c >= before, "{a} and {b}: {c} after {before}");
            before = c;
            let single = eval::convolve_alpha(a as f32, b as f32);
            assert_eq!(single, eval::convolve_alpha(b as f32, a as f32));
            assert!((f64::from(single) - c).abs() < 2e-6, "{a} and {b}");
        }
    }
}

#[test]
fn concentrations_are_integrals_over_the_lobe() {
    for alpha in alphas(24) {
        let (mut all, mut axis) = (0.0, 0.0);
        let (rings, spokes) = (4000, 64);
        for i in 0..rings {
            let u = (f64::from(i) + 0.5) / f64::from(rings);
            let r2 = alpha * alpha * u / (1.0 - u);
            all += KAPPA * KAPPA / (KAPPA * KAPPA + r2) / f64::from(rings);
            for j in 0..spokes {
                let c = (std::f64::consts::PI * (f64::from(j) + 0.5) / f64::from(spokes)).cos();
                axis += KAPPA * KAPPA / (KAPPA * KAPPA + r2 * c * c) / f64::from(rings * spokes);
            }
        }
        assert!((concentration(alpha) - all).abs() < 1e-4, "α {alpha}: {} {all}", concentration(alpha));
        assert!((axis_concentration(alpha) - axis).abs() < 3e-4, "α {alpha}: {} {axis}", axis_concentration(alpha));
    }
    for (inverse, of_alpha) in [
        (AlphaOf::new(concentration), concentration as fn(f64) -> f64),
        (AlphaOf::new(axis_concentration), axis_concentration),
    ] {
        for alpha in alphas(100) {
            assert!((inverse.get(of_alpha(alpha)) / alpha - 1.0).abs() < 1e-5, "α {alpha}");
        }
        assert_eq!((inverse.get(1.0), inverse.get(0.0)), (0.0, 1.0));
    }
}

#[test]
fn codes_follow_concentrations_and_are_inverted() {
    for alpha in alphas(100) {
        let code = code_of(alpha);
        assert!((code - (1.0 - concentration(alpha))).abs() < 0.02, "α {alpha}");
        assert!((f64::from(alpha_of_code(code as f32)) / alpha - 1.0).abs() < 1e-4, "α {alpha}");
    }
    assert_eq!((alpha_of_code(0.0), alpha_of_code(1.0), alpha_of_code(-1.0)), (0.0, 1.0, 0.0));
}

#[test]
fn the_lobe_integrates_to_one() {
    for alpha in [0.05, 0.3, 1.0] {
        let n = 20_000;
        let mut sum = 0.0;
        for k in 0..n {
            let theta = std::f64::consts::FRAC_PI_2 * (f64::from(k) + 0.5) / f64::from(n);
            sum += lobe_density(alpha, theta.cos(), theta.sin()) * 2.0 * std::f64::consts::PI * theta.sin();
        }
        assert!((sum * std::f64::consts::FRAC_PI_2 / f64::from(n) - 1.0).abs() < 1e-6);
    }
}
