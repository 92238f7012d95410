//! Patch synthesis against its definition: every candidate tried, every path tried, patches pasted into an image.

use glint_bake_core::hash::{cell_state, draw_bits};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_bake_core::synthesis::choose::Radii;
use glint_bake_core::synthesis::features::{Features, distance};
use glint_bake_core::synthesis::reference::{self, ReferenceFeatures};
use glint_bake_core::synthesis::seams::{cut, push_path};
use glint_bake_core::synthesis::{Synthesis, SynthesisOptions, Target, assemble, bake};
use glint_formats::Wrap;
use glint_formats::synthesis::{Layout, PathShape};

/// Waves with noise: neighbours are alike, distant texels are not.
fn sample(width: u32, height: u32, wrap: Wrap) -> NormalMap {
    let mut rng = ItemRng::new(7, Purpose::Test(0), 0);
    let projected = (0..width * height)
        .map(|k| {
            let (x, y) = (f64::from(k % width), f64::from(k / width));
            let wave = |a: f64, b: f64| (a * x + b * y).sin() * 0.3;
            [(wave(0.4, 0.1) + 0.1 * rng.unit()) as f32, (wave(-0.2, 0.5) + 0.1 * rng.unit()) as f32]
        })
        .collect();
    NormalMap { width, height, wrap, projected }
}

fn options(target: Target) -> SynthesisOptions {
    SynthesisOptions { target, patch: 12, overlap: 4, alignment: 4, seed: 3, ..SynthesisOptions::default() }
}

fn patches(width: u32, height: u32) -> SynthesisOptions {
    options(Target::Patches { width, height })
}

fn baked(map: &NormalMap, options: &SynthesisOptions) -> Synthesis {
    bake(map, options, &Silent).unwrap()
}

#[test]
fn features_are_those_of_the_definition() {
    for wrap in [Wrap::Repeat, Wrap::Clamp] {
        let map = sample(23, 17, wrap);
        for alpha in [0.0, 0.9, 1.0] {
            let fast = Features::new(&map, alpha);
            let rounded = ReferenceFeatures::new(&map, alpha, true);
            let exact = ReferenceFeatures::new(&map, alpha, false);
            let mut worst = 0.0f64;
            for k in 0..400 {
                let (a, b) = ((k * 7 - 60, k * 3), (k * 5, 90 - k * 11));
                let found = f64::from(distance(fast.at(a.0, a.1), fast.at(b.0, b.1)));
                let wide = |p: (i32, i32)| (i64::from(p.0), i64::from(p.1));
                assert_eq!(found, rounded.distance(wide(a), wide(b)));
                worst = worst.max((found.sqrt() - exact.distance(wide(a), wide(b)).sqrt()).abs());
            }
            // Six numbers, each rounded twice by half a step at most.
            assert!(worst <= 6f64.sqrt(), "{worst}");
            assert_eq!(fast.neighbour_distance(), rounded.units());
        }
    }
}

#[test]
fn chosen_patches_are_those_of_the_exhaustive_search() {
    // Grids of many patches, of one row, one column, one patch; samples that repeat, that do not, that are one patch.
    let cases = [
        (32, 28, Wrap::Repeat, 60, 48, 0.5),
        (64, 56, Wrap::Repeat, 60, 48, 0.0),
        (40, 36, Wrap::Clamp, 72, 60, 0.0),
        (32, 24, Wrap::Repeat, 60, 12, 0.0),
        (32, 24, Wrap::Repeat, 5, 50, 2.0),
        (24, 24, Wrap::Repeat, 12, 12, 0.0),
        (12, 12, Wrap::Repeat, 40, 40, 0.5),
        (16, 16, Wrap::Clamp, 30, 30, 0.5),
    ];
    for (width, height, wrap, across, down, error_tolerance) in cases {
        let map = sample(width, height, wrap);
        let options = SynthesisOptions { error_tolerance, ..patches(across, down) };
        let surface = baked(&map, &options);
        let Layout::Patches { columns, rows, .. } = surface.params.layout else { panic!() };
        let radii = Radii::of(u64::from(width * height), options.patch);
        let expected = reference::choose(&map, &options, (columns, rows), radii);
        assert_eq!(surface.offsets, expected, "{width}×{height} {wrap:?} {across}×{down}");
    }
}

#[test]
fn a_cut_is_the_least_of_all_paths() {
    let mut rng = ItemRng::new(1, Purpose::Test(0), 0);
    for (rows, overlap) in [(1, 1), (1, 4), (6, 2), (7, 3), (7, 5), (5, 1)] {
        for _ in 0..20 {
            let cost: Vec<u32> = (0..rows * overlap).map(|_| rng.below(9)).collect();
            let path = cut(&cost, overlap);
            assert_eq!(path.len(), rows);
            assert!(path.windows(2).all(|pair| pair[0].abs_diff(pair[1]) <= 1));
            let sum: u32 = path.iter().enumerate().map(|(r, &c)| cost[r * overlap + c as usize]).sum();
            assert_eq!(f64::from(sum), reference::least_path(&cost, overlap));
        }
    }
    assert_eq!(cut(&[], 0), Vec::<u32>::new());
    // Large costs do not overflow.
    assert_eq!(cut(&[u32::MAX; 64], 2), vec![0; 32]);
}

#[test]
fn packed_paths_are_read_back() {
    for overlap in [2u32, 3, 4, 8, 9, 64] {
        let path: Vec<u32> = (0..70).map(|k| k % overlap).collect();
        let shape = PathShape::new(70, overlap);
        let mut words = Vec::new();
        push_path(&path, shape, &mut words);
        push_path(&path, shape, &mut words);
        assert_eq!(words.len(), 2 * shape.words as usize);
        let mut surface = baked(&sample(32, 32, Wrap::Repeat), &patches(12, 12));
        surface.seams = words;
        for k in 0..2 {
            assert_eq!(reference::entries(&surface, 0, k, shape), path, "{overlap}");
        }
    }
}

#[test]
fn a_look_up_is_the_pasted_image() {
    let cases =
        [(60, 48, 4, Wrap::Repeat), (50, 41, 6, Wrap::Clamp), (60, 60, 1, Wrap::Repeat), (30, 30, 0, Wrap::Clamp)];
    for (across, down, overlap, wrap) in cases {
        let map = sample(34, 40, wrap);
        let surface = baked(&map, &SynthesisOptions { overlap, ..patches(across, down) });
        let image = reference::pasted(&surface, |_, _, _| ());
        let (width, height) = (image.width, image.texels.len() as i64 / image.width);
        // Three periods each way.
        for y in -height..2 * height {
            for x in -width..2 * width {
                let expected = image.at(x.rem_euclid(width), y.rem_euclid(height));
                assert_eq!(Some(surface.source_texel(x as i32, y as i32)), expected, "({x}, {y}) {across}×{down}");
            }
        }
        let piece = assemble(&surface, &map, (-5, 7), (across, down)).unwrap();
        for (k, normal) in piece.projected.iter().enumerate() {
            let (x, y) = (k as i64 % i64::from(across) - 5, k as i64 / i64::from(across) + 7);
            let (column, row) = image.at(x.rem_euclid(width), y.rem_euclid(height)).unwrap();
            assert_eq!(*normal, map.projected[(row * map.width + column) as usize]);
        }
    }
}

/// Each patch's stored cuts cost, over what is pasted below it, no more than the best that there are.
#[test]
fn stored_seams_are_the_least_over_what_lies_below() {
    let map = sample(40, 36, Wrap::Repeat);
    let options = patches(84, 72);
    let surface = baked(&map, &options);
    let features = ReferenceFeatures::new(&map, options.alpha, true);
    let Layout::Patches { columns, .. } = surface.params.layout else { panic!() };
    let (patch, overlap) = (i64::from(options.patch), i64::from(options.overlap));
    let mut checked = 0;
    reference::pasted(&surface, |below, (column, row), paths| {
        // Neighbours of the first and last columns and of the first row lie across the edge, not in this image.
        if column == 0 || row == 0 || column + 1 >= columns || row >= surface.offsets.len() as u32 / columns {
            return;
        }
        let offset = surface.offsets[(row * columns + column) as usize];
        for (which, path) in paths.into_iter().enumerate() {
            let mut costs = Vec::new();
            for along in -overlap..patch {
                for across in -overlap..0 {
                    let (x, y) = if which == 0 { (across, along) } else { (along, across) };
                    let old = below.at(i64::from(column) * patch + x, i64::from(row) * patch + y).unwrap();
                    let new = (i64::from(offset[0]) + x, i64::from(offset[1]) + y);
                    costs.push(features.distance((i64::from(old.0), i64::from(old.1)), new));
                }
            }
            let row_of = |r: usize| &costs[r * overlap as usize..][..overlap as usize];
            let stored: f64 = path.iter().enumerate().map(|(r, &c)| row_of(r)[c as usize]).sum();
            let mut best = row_of(0).to_vec();
            for r in 1..path.len() {
                let before = |c: usize| best[c.saturating_sub(1)..(c + 2).min(best.len())].iter().copied();
                let step = |c: usize| row_of(r)[c] + before(c).fold(f64::INFINITY, f64::min);
                best = (0..best.len()).map(step).collect();
            }
            assert_eq!(stored, best.into_iter().fold(f64::INFINITY, f64::min), "patch ({column}, {row}), cut {which}");
            checked += 1;
        }
    });
    assert!(checked >= 40, "{checked}");
}

#[test]
fn corner_tiles_are_the_pasted_window() {
    for (colours, variants, overlap, wrap) in [(2, 1, 4, Wrap::Repeat), (3, 2, 6, Wrap::Clamp), (1, 3, 1, Wrap::Repeat)]
    {
        let map = sample(72, 64, wrap);
        let target = Target::Unbounded { colours, variants };
        let surface = baked(&map, &SynthesisOptions { overlap, patch: 40, ..options(target) });
        let Layout::CornerTiles { hash_seed, .. } = surface.params.layout else { panic!() };
        let hashed = |i: i64, j: i64, draw: u32, n: u32| {
            ((draw_bits(cell_state(i as u32, j as u32, hash_seed), draw) >> 16) * n) >> 16
        };
        for first in [(0, 0), (-3, -2), (50_000_000, -50_000_000)] {
            let corner = |i, j| hashed(i, j, 0, colours);
            let image = reference::pasted_tiles(&surface, first, 4, corner, |i, j| hashed(i, j, 1, variants));
            for y in image.origin.1..image.origin.1 + image.width {
                for x in image.origin.0..image.origin.0 + image.width {
                    let found = surface.source_texel(x as i32, y as i32);
                    assert_eq!(Some(found), image.at(x, y), "({x}, {y}) {colours} {overlap}");
                }
            }
        }
    }
}
