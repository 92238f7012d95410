//! (1 − p)^N, p^N and their complements in f32, with this processor's functions and with the least exact ones of WGSL.

use glint_bake_core::counting::eval::{halved, halvings};
use glint_bake_core::counting::pow1m::{
    Elementary, LeastExact, Native, one_minus_pow1m, one_minus_pow1m_with, pow1m, pow1m_with,
};
use libm::{exp, exp10, expm1, log, log1p};
use std::f64::consts::LN_2;

/// −ln(1 − p) in f64, from whichever of p and q is given exactly.
fn exact_log(p: f32, q: f32) -> f64 {
    if p <= 0.5 { -log1p(f64::from(-p)) } else { -log(f64::from(q)) }
}

/// Arguments (p, q, n): p and q down to 1e-16 on either side, n from 1 to 1e16, thick where the power is neither 0 nor
/// 1.
fn arguments() -> Vec<(f32, f32, f32)> {
    let mut all = Vec::new();
    for i in 0..=400 {
        let small = exp10(-16.0 + f64::from(i) * 0.039_247) as f32;
        for (p, q) in [(small, 1.0 - small), (1.0 - small, small)] {
            for j in 0..=64 {
                all.push((p, q, exp10(0.25 * f64::from(j)) as f32));
            }
            for j in 0..=240 {
                let exponent = exp10(-3.0 + f64::from(j) / 48.0);
                let n = (exponent / exact_log(p, q)) as f32;
                if (1.0..=1e16).contains(&n) {
                    all.push((p, q, n));
                }
            }
        }
    }
    // Small whole n with p all over the middle, where p^n changes fastest.
    for i in 0..=2000 {
        let p = i as f32 / 2000.0;
        for n in [1.0, 1.5, 2.0, 3.0, 4.0, 7.0] {
            all.push((p, 1.0 - p, n));
        }
    }
    all
}

/// Largest |error| of (1 − p)^n and of 1 − (1 − p)^n.
fn worst(math: &impl Elementary) -> [f64; 2] {
    let mut worst = [0.0f64; 2];
    for (p, q, n) in arguments() {
        let x = f64::from(n) * exact_log(p, q);
        worst[0] = worst[0].max((f64::from(pow1m_with(math, p, q, n)) - exp(-x)).abs());
        worst[1] = worst[1].max((f64::from(one_minus_pow1m_with(math, p, q, n)) + expm1(-x)).abs());
    }
    worst
}

#[test]
fn powers_hold_with_this_processor() {
    let [power, complement] = worst(&Native);
    assert!(power < 1.7e-7, "{power:e}");
    assert!(complement < 1.7e-7, "{complement:e}");
}

#[test]
fn powers_hold_with_the_least_exact_wgsl() {
    for math in LeastExact::all() {
        let [power, complement] = worst(&math);
        assert!(power <= 5e-7, "{math:?}: {power:e}");
        assert!(complement <= 5e-7, "{math:?}: {complement:e}");
    }
}

/// The model must be able to fail: with log in the place that WGSL leaves loose, it does.
#[test]
fn the_model_tells_a_loose_logarithm() {
    let math = LeastExact { log: 1.0, exp: 1.0, divide: 0.0 };
    let (mut naive, q) = (0.0f64, 1.0 - 1e-5f32);
    for j in 0..=1000 {
        let n = 1e3 * j as f32;
        naive = naive.max((f64::from(math.exp(n * math.log(q))) - exp(f64::from(n) * log(f64::from(q)))).abs());
    }
    assert!(naive > 1e-2, "{naive:e}");
}

#[test]
fn a_small_complement_keeps_its_digits() {
    for math in LeastExact::all() {
        for (p, q, n) in arguments().into_iter().filter(|a| a.0 > 0.0) {
            let exact = -expm1(-f64::from(n) * exact_log(p, q));
            let relative = f64::from(one_minus_pow1m_with(&math, p, q, n)) / exact - 1.0;
            assert!(relative.abs() < 2e-6, "{math:?} p {p:e} n {n:e}: {relative:e}");
        }
    }
}

/// What draws take, by powers of 2.
#[test]
fn halvings_and_halved_keep_their_digits() {
    let mut worst = [0.0f64; 3];
    for i in 0..=200_000 {
        let p = (0.5 * exp10(-8.0 * f64::from(i) / 200_000.0)) as f32;
        let exact = -log1p(f64::from(-p)) / LN_2;
        worst[0] = worst[0].max((f64::from(halvings(p)) / exact - 1.0).abs());
        let y = (125.0 * exp10(-9.0 * f64::from(i) / 200_000.0)) as f32;
        let [left, lost] = halved(y).map(f64::from);
        worst[1] = worst[1].max((left / exp(-f64::from(y) * LN_2) - 1.0).abs());
        worst[2] = worst[2].max((lost / -expm1(-f64::from(y) * LN_2) - 1.0).abs());
    }
    println!("halvings {:.1e}, halved {:.1e}, lost {:.1e}", worst[0], worst[1], worst[2]);
    assert!(worst[0] < 4e-7 && worst[1] < 6e-7 && worst[2] < 6e-7, "{worst:?}");
}

#[test]
fn ends_are_exact() {
    for n in [0.0, 0.3, 1.0, 2.0, 1e4, 1e16] {
        assert_eq!(pow1m(0.0, 1.0, n), 1.0);
        assert_eq!(one_minus_pow1m(0.0, 1.0, n), 0.0);
        let impossible = pow1m(1.0, 0.0, n);
        assert!(if n >= 1.0 { impossible < 1e-37 } else { impossible > 0.0 }, "{n}: {impossible}");
    }
    for (p, q) in [(1e-16, 1.0), (0.5, 0.5), (1.0, 1e-16), (1.0, 0.0)] {
        assert_eq!(pow1m(p, q, 0.0), 1.0);
        assert_eq!(one_minus_pow1m(p, q, 0.0), 0.0);
    }
    assert_eq!(pow1m(0.5, 0.5, 1.0), 0.5);
}
