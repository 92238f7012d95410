//! Patch synthesis where it is hard: flat and tiny samples, odd sizes, no overlap, limits; and what a surface promises.

use glint_bake_core::error::BakeError;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_bake_core::synthesis::quality::{feature_ends, repetition, seam_ratio, whole_share};
use glint_bake_core::synthesis::sections::{from_pack, surfaces, to_sections};
use glint_bake_core::synthesis::{Synthesis, SynthesisOptions, Target, assemble, bake};
use glint_formats::Wrap;
use glint_formats::synthesis::Layout;
use glint_formats::{Codec, Limits, Pack, PackBuilder};
use std::collections::BTreeSet;

fn noise(width: u32, height: u32, wrap: Wrap) -> NormalMap {
    let mut rng = ItemRng::new(5, Purpose::Test(0), 0);
    let mut number = || (rng.unit() - 0.5) as f32;
    NormalMap { width, height, wrap, projected: (0..width * height).map(|_| [number(), number()]).collect() }
}

fn flat(width: u32, height: u32, wrap: Wrap) -> NormalMap {
    NormalMap { width, height, wrap, projected: vec![[0.1, -0.2]; (width * height) as usize] }
}

fn options(target: Target) -> SynthesisOptions {
    SynthesisOptions { target, patch: 16, overlap: 4, ..SynthesisOptions::default() }
}

fn patches(width: u32, height: u32) -> SynthesisOptions {
    options(Target::Patches { width, height })
}

const UNBOUNDED: Target = Target::Unbounded { colours: 2, variants: 2 };

fn baked(map: &NormalMap, options: &SynthesisOptions) -> Synthesis {
    bake(map, options, &Silent).unwrap()
}

fn packed(surface: &Synthesis, codec: Codec) -> Pack {
    let mut builder = PackBuilder::new();
    for section in to_sections("gold", surface, codec) {
        builder.push(section).unwrap();
    }
    Pack::from_bytes(builder.finish().unwrap(), &Limits::default()).unwrap()
}

#[test]
fn every_surface_is_a_sound_pack_and_read_back() {
    let maps = [noise(40, 37, Wrap::Repeat), noise(37, 40, Wrap::Clamp), flat(40, 40, Wrap::Clamp)];
    for map in &maps {
        for overlap in [0, 1, 2, 3, 8] {
            for target in [Target::Patches { width: 70, height: 33 }, Target::Patches { width: 1, height: 1 }] {
                let surface = baked(map, &SynthesisOptions { overlap, ..options(target) });
                let pack = packed(&surface, Codec::None);
                assert_eq!(pack.verify(), []);
                assert_eq!(surfaces(&pack), ["gold"]);
                assert_eq!(from_pack(&pack, "gold").unwrap(), surface);
            }
            let tiles = SynthesisOptions { overlap, patch: 40, alignment: 1, ..options(UNBOUNDED) };
            if map.wrap == Wrap::Clamp || overlap == 8 {
                continue;
            }
            let map = noise(48, 48, map.wrap);
            let surface = baked(&map, &tiles);
            let pack = packed(&surface, Codec::Zstd);
            assert_eq!(pack.verify(), []);
            assert_eq!(from_pack(&pack, "gold").unwrap(), surface);
        }
    }
    let pack = packed(&baked(&maps[0], &patches(32, 32)), Codec::None);
    assert!(matches!(from_pack(&pack, "none"), Err(BakeError::BadInput(_))));
}

#[test]
fn a_flat_map_stays_flat() {
    for (map, target) in [
        (flat(40, 24, Wrap::Repeat), Target::Patches { width: 100, height: 50 }),
        (flat(48, 48, Wrap::Clamp), UNBOUNDED),
    ] {
        let patch = if target == UNBOUNDED { 40 } else { 16 };
        let surface = baked(&map, &SynthesisOptions { patch, ..options(target) });
        assert_eq!(surface.params.measured.seam_ratio, 0.0);
        let piece = assemble(&surface, &map, (-30, -30), (120, 120)).unwrap();
        assert!(piece.projected.iter().all(|normal| *normal == [0.1, -0.2]));
    }
}

#[test]
fn equal_candidates_are_used_alike() {
    // 100 offsets, more than are looked at for one patch, that fit each other alike; 1024 patches.
    let surface = baked(&flat(80, 80, Wrap::Repeat), &patches(512, 512));
    assert_eq!(surface.params.measured.distinct_offsets, 100);
}

#[test]
fn lines_that_no_patch_continues_are_counted_as_ends() {
    // Lines along rows, every eighth texel; a little more or less of a slope along them.
    let texel =
        |k: u32| [if k.is_multiple_of(2) { 0.01 } else { -0.01 }, if (k / 16).is_multiple_of(8) { 0.5 } else { 0.0 }];
    let map = NormalMap { width: 16, height: 16, wrap: Wrap::Repeat, projected: (0..256).map(texel).collect() };
    let mut surface = baked(&map, &SynthesisOptions { overlap: 0, ..patches(32, 16) });
    // Neighbours in the sample as well, but for the sides: there, two lines of the sixteen rows end on either side.
    surface.offsets = vec![[0, 0], [0, 4]];
    assert_eq!(feature_ends(&surface, &map), 1000.0 * 4.0 / 16.0);
    surface.offsets = vec![[0, 0], [2, 8]];
    assert_eq!(feature_ends(&surface, &map), 0.0);
    surface.offsets = vec![[0, 0], [0, 0]];
    assert_eq!(feature_ends(&surface, &map), 0.0);
    let level = flat(16, 16, Wrap::Repeat);
    assert_eq!(feature_ends(&baked(&level, &patches(64, 64)), &level), 0.0);
}

#[test]
fn samples_too_small_are_refused_and_just_large_enough_ones_work() {
    let refused = |map: &NormalMap, options: &SynthesisOptions| match bake(map, options, &Silent) {
        Err(BakeError::BadInput(message)) => assert!(message.contains("patch"), "{message}"),
        other => panic!("{other:?}"),
    };
    refused(&flat(1, 1, Wrap::Repeat), &patches(64, 64));
    refused(&noise(16, 15, Wrap::Repeat), &patches(64, 64));
    refused(&noise(19, 40, Wrap::Clamp), &patches(64, 64));
    // The first aligned offset is 8, for the overlap of 4.
    refused(&noise(23, 24, Wrap::Clamp), &patches(64, 64));
    for map in [noise(16, 16, Wrap::Repeat), noise(24, 24, Wrap::Clamp)] {
        let surface = baked(&map, &patches(64, 48));
        assert!(surface.params.measured.distinct_offsets >= 1);
        assert!(surface.params.measured.seam_ratio.is_finite());
    }
}

#[test]
fn patches_of_a_sample_that_does_not_repeat_never_cross_its_edge() {
    let map = noise(45, 51, Wrap::Clamp);
    for target in [Target::Patches { width: 200, height: 180 }, UNBOUNDED] {
        let patch = if target == UNBOUNDED { 36 } else { 16 };
        let surface = baked(&map, &SynthesisOptions { patch, alignment: 1, ..options(target) });
        let reach = |offset: u16| u32::from(offset) - 4..u32::from(offset) + patch;
        for (x, y) in (0..180).flat_map(|y| (0..200).map(move |x| (x, y))) {
            let (sx, sy) = surface.source_texel(x, y);
            let [ox, oy] = surface.offsets[surface.place(x, y).patch_index as usize];
            assert!(reach(ox).contains(&sx) && reach(oy).contains(&sy), "({x}, {y})");
        }
    }
}

#[test]
fn whole_blocks_show_a_block_of_the_sample_and_nominal_ones_most_of_it() {
    let map = noise(104, 104, Wrap::Repeat);
    let mut coarse = 0;
    for (target, patch, overlap) in [
        (Target::Patches { width: 256, height: 224 }, 32, 8),
        (Target::Patches { width: 256, height: 224 }, 32, 3),
        (UNBOUNDED, 48, 4),
    ] {
        let surface = baked(&map, &SynthesisOptions { patch, overlap, ..options(target) });
        let mut whole = [0; 3];
        for (log2_size, count) in whole.iter_mut().enumerate() {
            let size = 8 << log2_size;
            for (bx, by) in (-9..9).flat_map(|by| (-9..9).map(move |bx| (bx, by))) {
                let block = surface.block_source(bx * size, by * size, size, size as u32);
                let nominal = surface.nominal_block(bx * size, by * size, size, size as u32);
                let texels = (0..size).flat_map(|y| (0..size).map(move |x| (x, y)));
                let matching = |(sx, sy): (u32, u32)| {
                    texels
                        .clone()
                        .filter(|&(x, y)| {
                            surface.source_texel(bx * size + x, by * size + y) == (sx + x as u32, sy + y as u32)
                        })
                        .count() as i32
                };
                if let Some(source) = block {
                    *count += 1;
                    assert_eq!((source.0 % size as u32, source.1 % size as u32), (0, 0));
                    assert_eq!(matching(source), size * size, "block ({bx}, {by}) of {size}");
                    assert_eq!(nominal, block);
                }
                if let Some(source) = nominal {
                    assert!(matching(source) > 0);
                }
            }
        }
        assert!(whole[0] > 100, "{whole:?}");
        coarse += whole[1];
        assert_eq!(surface.block_source(0, 0, 8 << 16, 8 << 16), None);
    }
    assert!(coarse > 10, "{coarse}");
}

#[test]
fn shares_of_whole_blocks_follow_from_patch_and_overlap() {
    let map = noise(64, 64, Wrap::Repeat);
    let surface = baked(&map, &SynthesisOptions { patch: 32, overlap: 8, ..patches(256, 256) });
    // Three of four blocks of 8 texels along each axis lie before the overlap of the next patch; one of two of 16.
    assert_eq!(whole_share(&surface, 32, 0, true), 9.0 / 16.0);
    assert_eq!(whole_share(&surface, 16, 1, false), 1.0 / 4.0);
    assert!(whole_share(&surface, 16, 1, true) < 1.0 / 4.0);
}

#[test]
fn neighbours_do_not_repeat_and_all_of_the_sample_is_used() {
    let map = noise(128, 128, Wrap::Repeat);
    let surface = baked(&map, &patches(512, 512));
    let distinct: BTreeSet<[u16; 2]> = surface.offsets.iter().copied().collect();
    assert_eq!(distinct.len() as u32, surface.params.measured.distinct_offsets);
    assert!(distinct.len() > 200, "{}", distinct.len());
    assert!(repetition(&surface, 32, 8) < 0.05, "{}", repetition(&surface, 32, 8));
    let unbounded = SynthesisOptions { patch: 32, ..options(Target::Unbounded { colours: 4, variants: 2 }) };
    assert!(repetition(&baked(&map, &unbounded), 32, 8) < 0.1);
    // Seams of noise are as rough as noise.
    assert!((seam_ratio(&surface, &map) - 1.0).abs() < 0.15, "{}", seam_ratio(&surface, &map));
}

#[test]
fn the_seed_decides_and_threads_do_not() {
    let map = noise(64, 64, Wrap::Repeat);
    for target in [Target::Patches { width: 200, height: 200 }, UNBOUNDED] {
        let options = SynthesisOptions { patch: 32, ..options(target) };
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| baked(&map, &options))
        };
        let one = with(1);
        assert_eq!(one, with(2));
        assert_eq!(one, with(7));
        assert_ne!(one.offsets, baked(&map, &SynthesisOptions { seed: 1, ..options }).offsets);
    }
}

#[test]
fn look_ups_hold_at_the_ends_of_the_integers() {
    let map = noise(48, 48, Wrap::Repeat);
    for target in [Target::Patches { width: 100, height: 60 }, UNBOUNDED] {
        let surface = baked(&map, &SynthesisOptions { patch: 32, ..options(target) });
        for x in [i32::MIN, -1, 0, i32::MAX] {
            for y in [i32::MIN, -1, 0, i32::MAX] {
                let (sx, sy) = surface.source_texel(x, y);
                assert!(sx < 48 && sy < 48);
            }
        }
    }
}

#[test]
fn few_candidates_are_a_seeded_choice() {
    let map = noise(64, 64, Wrap::Repeat);
    let few = |seed| baked(&map, &SynthesisOptions { max_candidates: 5, alignment: 1, seed, ..patches(300, 300) });
    assert!(few(0).params.measured.distinct_offsets <= 5);
    assert_ne!(few(0).offsets, few(1).offsets);
}

#[test]
fn options_without_a_meaning_are_named() {
    let map = noise(64, 64, Wrap::Repeat);
    type Edit = fn(&mut SynthesisOptions);
    let edits: [(Edit, &str); 12] = [
        (|o| o.patch = 3, "patch"),
        (|o| o.patch = 2048, "patch"),
        (|o| o.overlap = 9, "overlap"),
        (|o| o.alignment = 0, "alignment"),
        (|o| o.alignment = 5, "alignment"),
        (|o| o.alpha = f64::NAN, "alpha"),
        (|o| o.error_tolerance = f64::NAN, "error_tolerance"),
        (|o| o.max_candidates = 0, "candidates"),
        (|o| o.target = Target::Patches { width: 0, height: 5 }, "synthesize"),
        (|o| o.target = Target::Unbounded { colours: 5, variants: 1 }, "colours"),
        (|o| o.target = Target::Unbounded { colours: 2, variants: 0 }, "variants"),
        (|o| o.target = UNBOUNDED, "patch"),
    ];
    for (edit, named) in edits {
        let mut options = patches(64, 64);
        edit(&mut options);
        match bake(&map, &options, &Silent) {
            Err(BakeError::BadOption(message)) => assert!(message.contains(named), "{message}"),
            other => panic!("{named}: {other:?}"),
        }
    }
    let limits: [SynthesisOptions; 2] = [
        patches(u32::MAX, u32::MAX),
        SynthesisOptions { patch: 1024, overlap: 64, max_candidates: 4096, alignment: 1, ..patches(4096, 4096) },
    ];
    let large = flat(1024, 1024, Wrap::Repeat);
    for options in limits {
        assert!(matches!(bake(&large, &options, &Silent), Err(BakeError::LimitExceeded(_))));
    }
    // Texels are not looked at before the limit is.
    let huge = NormalMap { width: 16_384, height: 16_384, wrap: Wrap::Repeat, projected: Vec::new() };
    assert!(matches!(bake(&huge, &patches(64, 64), &Silent), Err(BakeError::LimitExceeded(_))));
    let wide = NormalMap { width: 16_385, ..huge };
    assert!(matches!(bake(&wide, &patches(64, 64), &Silent), Err(BakeError::LimitExceeded(_))));
}

#[test]
fn a_surface_is_told_from_another_sample() {
    let map = noise(32, 32, Wrap::Repeat);
    let surface = baked(&map, &patches(40, 40));
    assert!(matches!(surface.params.layout, Layout::Patches { columns: 3, rows: 3, .. }));
    let wrong = assemble(&surface, &noise(32, 31, Wrap::Repeat), (0, 0), (4, 4));
    assert!(matches!(wrong, Err(BakeError::BadInput(_))));
    assert!(matches!(assemble(&surface, &map, (0, 0), (0, 4)), Err(BakeError::BadOption(_))));
}

#[test]
fn a_sample_that_repeats_is_not_laid_side_by_side() {
    let map = noise(64, 48, Wrap::Repeat);
    let surface = baked(&map, &patches(512, 512));
    // It would fit without a seam: every patch goes on where its neighbour ends.
    assert!(repetition(&surface, 32, 8) < 0.1, "{}", repetition(&surface, 32, 8));
    assert!(surface.params.measured.distinct_offsets > 40, "{:?}", surface.params.measured);
    let next = |[x, y]: [u16; 2], (dx, dy): (u16, u16)| [(x + dx) % 64, (y + dy) % 48];
    let at = |column: usize, row: usize| surface.offsets[row % 32 * 32 + column % 32];
    for (column, row) in (0..32).flat_map(|row| (0..32).map(move |column| (column, row))) {
        let across = (0..3).all(|k| at(column + k + 1, row) == next(at(column + k, row), (16, 0)));
        let down = (0..2).all(|k| at(column, row + k + 1) == next(at(column, row + k), (0, 16)));
        assert!(!across && !down, "from patch ({column}, {row}) on the surface shows the sample as it is");
    }
}
