//! Hard maps and hard footprints: every answer is finite, not negative and normalised, every covariance positive definite, or
//! an error says why not.

mod hard_maps;

use glam::DVec2;
use glint_bake_core::error::BakeError;
use glint_bake_core::footprint::Footprint;
use glint_bake_core::lobes::options::LobesOptions;
use glint_bake_core::lobes::query::QuerySettings;
use glint_bake_core::lobes::reference::{GridNdf, Reference};
use glint_bake_core::lobes::{BakedLobes, bake, quality, sections};
use glint_bake_core::progress::Silent;
use glint_bake_core::quality::metrics::DiskGrid;
use glint_formats::Wrap;
use glint_formats::lobes::{Filter, LobeStorage, Merge};
use glint_formats::{Codec, Limits, Pack, PackBuilder, validate};
use hard_maps::{hard_maps, map};

fn options(roughness: f64) -> LobesOptions {
    LobesOptions { roughness, footprints: 1, ..LobesOptions::default() }
}

/// Integral of a footprint's NDF over the disk, as a sum over what it sees; panics when something is not finite.
fn integral(name: &str, baked: &BakedLobes, footprint: &Footprint, roughness: f64) -> f64 {
    let seen = baked.gather(footprint, roughness as f32, &QuerySettings::default());
    assert!(!seen.lobes.is_empty() && seen.lobes.len() < 10_000, "{name}: {footprint:?} sees {}", seen.lobes.len());
    for lobe in &seen.lobes {
        let [a, b, c] = lobe.inverse.map(f64::from);
        let sound = lobe.share >= 0.0 && lobe.share.is_finite() && lobe.peak > 0.0 && lobe.peak.is_finite();
        assert!(sound && lobe.mean.is_finite(), "{name}: {lobe:?} under {footprint:?}");
        assert!(a > 0.0 && c > 0.0 && a * c > b * b, "{name}: {lobe:?} under {footprint:?}");
    }
    let narrowest =
        seen.lobes.iter().fold(1e9f32, |least, lobe| least.min(lobe.inverse[0].max(lobe.inverse[2]).powf(-0.5)));
    // Lobes much narrower than any grid of the disk: shares are all there is to check.
    if narrowest < 4e-3 {
        return seen.lobes.iter().map(|lobe| lobe.share as f64).sum();
    }
    let grid = DiskGrid::over(DVec2::splat(-1.0), DVec2::splat(1.0), (0.5 * narrowest as f64).min(0.05));
    let values = vec![0.0; grid.width * grid.height];
    // Against nothing, the difference is the integral.
    quality::difference(&GridNdf { grid, values }, &seen).1 + 1.0
}

#[test]
fn hard_maps_stay_normalised_under_every_footprint() {
    for (name, map) in hard_maps() {
        for roughness in [1e-4, 0.02, 1.0] {
            let baked = bake(&map, &options(roughness), &Silent).unwrap();
            for (sigma, anisotropy) in [
                (0.01, 1.0),
                (0.5, 4.0),
                (2.0, 1.0),
                (3.0, 1000.0),
                (11.0, 1.0),
                (100.0, 4.0),
                (10_000.0, 1.0),
                (10.0, 1000.0),
            ] {
                for mean in [DVec2::new(0.0, 0.0), DVec2::new(3.3, -7.9), DVec2::new(1e6 + 0.5, 2.0)] {
                    let footprint = Footprint::new(mean, sigma, anisotropy, 0.5);
                    let found = integral(name, &baked, &footprint, roughness);
                    assert!((found - 1.0).abs() < 0.03, "{name}, σ_r {roughness}, {footprint:?}: {found}");
                }
            }
        }
    }
}

#[test]
fn hard_maps_pack_verify_and_come_back() {
    for (name, mut map) in hard_maps() {
        for wrap in [Wrap::Repeat, Wrap::Clamp] {
            map.wrap = wrap;
            for (storage, merge, k) in [
                (LobeStorage::Packed, Merge::Runnalls, 1),
                (LobeStorage::Half, Merge::Moments, 32),
                (LobeStorage::Packed, Merge::KMeans, 256),
            ] {
                let options = LobesOptions { storage, merge, lobes_per_cell: k, footprints: 0, ..options(0.02) };
                let baked = bake(&map, &options, &Silent).unwrap();
                let mut builder = PackBuilder::new();
                for section in sections::to_sections(name, &baked, Codec::Zstd) {
                    builder.push(section).unwrap();
                }
                let bytes = builder.finish().unwrap();
                assert_eq!(validate(&bytes, &Limits::default()), [], "{name}");
                let pack = Pack::from_bytes(bytes, &Limits::default()).unwrap();
                assert_eq!(sections::from_pack(&pack, name).unwrap(), baked, "{name}");
            }
        }
    }
}

#[test]
fn roughness_is_free_at_run_time() {
    let map = map(32, 32, |i, j| [(i as f32 * 0.4).sin() * 0.2, (j as f32 * 0.7 + i as f32 * 0.2).cos() * 0.2]);
    let baked = bake(&map, &options(0.02), &Silent).unwrap();
    for roughness in [0.02, 0.05, 0.3] {
        let reference = Reference::new(&map, Filter::Linear, roughness);
        for sigma in [2.0, 5.0] {
            let footprint = Footprint::new(DVec2::new(9.0, 20.0), sigma, 1.0, 0.0);
            let seen = baked.gather(&footprint, roughness as f32, &QuerySettings::default());
            let (error, _) = quality::difference(&reference.ndf(&footprint, 4), &seen);
            assert!(error < 0.05, "σ_r {roughness}, σ {sigma}: {error}");
        }
    }
}

#[test]
fn seams_of_repeated_and_clamped_maps_are_seen_as_they_are() {
    // A ramp: its edges differ most.
    let mut map = map(24, 20, |i, j| [0.02 * i as f32 - 0.24, 0.01 * j as f32 - 0.1]);
    for wrap in [Wrap::Repeat, Wrap::Clamp] {
        map.wrap = wrap;
        let baked = bake(&map, &options(0.02), &Silent).unwrap();
        // The surface repeats the map as a whole; a clamped one is not filtered across its edge.
        for (sigma, mean) in [(0.4, DVec2::new(0.1, 9.0)), (1.5, DVec2::new(23.9, 0.2)), (4.5, DVec2::new(24.0, 40.0))]
        {
            let footprint = Footprint::new(mean, sigma, 1.0, 0.0);
            let seen = baked.gather(&footprint, 0.02, &QuerySettings::default());
            let (error, _) = quality::difference(&Reference::new(&map, Filter::Linear, 0.02).ndf(&footprint, 4), &seen);
            assert!(error < 0.1, "{wrap:?}, σ {sigma} at {mean}: {error}");
        }
    }
}

#[test]
fn options_out_of_range_are_refused_by_name() {
    let map = map(4, 4, |_, _| [0.0, 0.0]);
    let base = options(0.02);
    for (edited, option) in [
        (LobesOptions { roughness: 0.0, ..base.clone() }, "roughness"),
        (LobesOptions { roughness: f64::NAN, ..base.clone() }, "roughness"),
        (LobesOptions { lobes_per_cell: 0, ..base.clone() }, "k"),
        (LobesOptions { lobes_per_cell: 257, ..base.clone() }, "k"),
        (LobesOptions { cell_texels: 12, ..base.clone() }, "cell"),
        (LobesOptions { cell_texels: 128, ..base.clone() }, "cell"),
        (LobesOptions { seeds: 2, ..base.clone() }, "seeds"),
    ] {
        match bake(&map, &edited, &Silent) {
            Err(BakeError::BadOption(message)) => assert!(message.starts_with(&format!("{option}: ")), "{message}"),
            other => panic!("{option}: {other:?}"),
        }
    }
}
