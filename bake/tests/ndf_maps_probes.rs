//! What a picture evaluates for a footprint: few terms whatever its shape, and shares that follow it without jumps.

use glam::DVec2;
use glint_bake_core::footprint::Footprint;
use glint_bake_core::ndf_maps::bake::bake_maps;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::eval::{EvalSettings, Terms};
use glint_bake_core::ndf_maps::options::{NdfMapsOptions, PlacementOptions, StochasticOptions, TransformRanges};
use glint_bake_core::ndf_maps::placement::place;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_formats::Wrap;
use std::collections::BTreeMap;

/// Probes of a footprint four times as long as wide.
const PROBES: usize = 9;
/// Patches of a footprint as wide as the finest windows, 0.85 texels, and four times as long, within two and a half standard deviations and
/// half a patch's diagonal: an ellipse of 82 texels, and a few on its rim.
const PATCHES: usize = 90;

/// Facets of a texel each, with no order in them.
fn flakes() -> NormalMap {
    let normal = |k: u32| {
        let turn = f64::from(k) * 2.399_963;
        let tilt = 0.3 * (f64::from(k * 37 % 64) / 64.0).sqrt();
        [(tilt * turn.cos()) as f32, (tilt * turn.sin()) as f32]
    };
    NormalMap { width: 8, height: 8, wrap: Wrap::Repeat, projected: (0..64).map(normal).collect() }
}

/// Surfaces of flakes side by side and at random, and how many examples may show at a place.
fn surfaces() -> [(&'static str, Material, usize); 2] {
    let map = flakes();
    let options = NdfMapsOptions { roughness: 0.03, max_error: 0.1, ..NdfMapsOptions::default() };
    let maps = bake_maps(&map, &options, &Silent).unwrap();
    let tiled = PlacementOptions::Tiled(TransformRanges { rotate_degrees: (20.0, 20.0), ..TransformRanges::default() });
    let stochastic = PlacementOptions::Stochastic(StochasticOptions::default());
    [("tiled", tiled, 1), ("stochastic", stochastic, 4)].map(|(name, placement, owners)| {
        let placement = place(&map, options.roughness, &placement).unwrap();
        (name, Material { placement, maps: maps.clone() }, owners)
    })
}

fn seen(material: &Material, sigma: f64, anisotropy: f64, mean: DVec2) -> Terms {
    material.gather(&Footprint::new(mean, sigma, anisotropy, 0.7), EvalSettings::REAL_TIME)
}

#[test]
fn terms_are_few_whatever_the_footprint() {
    for (name, material, owners) in surfaces() {
        let palette = material.placement.palette.len();
        let (mut most_nodes, mut most_patches) = (0, 0);
        for k in 0..200 {
            let sigma = 1e-3 * 1.1f64.powi(k);
            for anisotropy in [1.0, 1.1, 2.0, 4.0, 1000.0] {
                let terms = seen(&material, sigma, anisotropy, DVec2::new(5.3, -1000.7));
                most_nodes = most_nodes.max(terms.nodes.len());
                most_patches = most_patches.max(terms.patches.len());
                // One probe at most is part of both levels. Wide footprints see the whole example under each transform besides.
                let nodes = owners * 3 * (PROBES + 1) + if owners > 1 { palette } else { 0 };
                assert!(terms.nodes.len() <= nodes, "{name}: {} nodes at σ {sigma}, {anisotropy}", terms.nodes.len());
                assert!(
                    terms.patches.len() <= owners * PATCHES,
                    "{name}: {} patches at σ {sigma}, {anisotropy}",
                    terms.patches.len()
                );
            }
        }
        println!("{name}: at most {most_nodes} nodes, {most_patches} patches");
    }
}

/// Σ|a − b| over the shares of nodes, and of what patches show together.
fn change(a: &Terms, b: &Terms) -> f32 {
    let mut shares = BTreeMap::new();
    for (terms, sign) in [(a, 1.0), (b, -1.0)] {
        for term in &terms.nodes {
            *shares.entry((term.class, term.node)).or_insert(0.0) += sign * term.weight;
        }
    }
    let patches: f32 = shares.values().sum();
    shares.values().map(|share| share.abs()).sum::<f32>() + patches.abs()
}

#[test]
fn shares_follow_the_footprint_without_jumps() {
    let mut worst = 0.0f32;
    for (name, material, _) in surfaces() {
        let mut most = [(0.0, 0.0, 0.0); 3];
        for k in 0..400 {
            let sigma = 0.4 * 1.01f64.powi(k);
            for anisotropy in [1.0, 1.06, 1.1, 1.13, 1.5, 2.0, 3.0, 3.97] {
                let mean = DVec2::new(5.3 + 0.37 * f64::from(k), -100.7);
                let here = seen(&material, sigma, anisotropy, mean);
                let other = [
                    seen(&material, 1.01 * sigma, anisotropy, mean),
                    seen(&material, sigma, 1.01 * anisotropy, mean),
                    seen(&material, sigma, anisotropy, mean + DVec2::new(0.01 * sigma, 0.0)),
                ];
                for (most, other) in most.iter_mut().zip(&other) {
                    let change = change(&here, other);
                    if change > most.0 {
                        *most = (change, sigma, anisotropy);
                    }
                }
            }
        }
        for (what, (change, sigma, anisotropy)) in ["wider", "longer", "moved"].into_iter().zip(most) {
            println!(
                "{name}, 1 % {what}: shares change by {change:.3} at most, at σ {sigma:.2}, anisotropy {anisotropy}"
            );
            worst = worst.max(change);
        }
    }
    // Where another tile or level is switched to, all of a share changes: 2.
    assert!(worst < 0.2, "shares change by {worst}");
}
