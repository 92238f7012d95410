//! P-NDFs of synthesised surfaces against the assembled map: exact at the finest level, no worse across seams, energy,
//! bounded work, continuity, packs, threads.

use glam::{DVec2, Vec2};
use glint_bake_core::error::BakeError;
use glint_bake_core::footprint::Footprint;
use glint_bake_core::lobes::LobesOptions;
use glint_bake_core::lobes::query::Detail;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_bake_core::surface::quality::{Exact, Measured, seam_footprints};
use glint_bake_core::surface::sections::{from_pack, surfaces, to_sections};
use glint_bake_core::surface::{Surface, SurfaceOptions, SurfaceSettings, bake};
use glint_bake_core::synthesis::{SynthesisOptions, Target};
use glint_formats::Wrap;
use glint_formats::lobes::Filter;
use glint_formats::{Codec, Limits, Pack, PackBuilder};

/// Waves with noise on them: something smooth, something rough.
fn waves(width: u32, height: u32, wrap: Wrap) -> NormalMap {
    let mut rng = ItemRng::new(5, Purpose::Test(0), 0);
    let texel = |at: u32| {
        let (x, y) = ((at % width) as f64 / width as f64, (at / width) as f64 / height as f64);
        let wave = |k: f64| (std::f64::consts::TAU * k).sin();
        let mut noise = || 0.1 * (rng.unit() - 0.5);
        [
            (0.2 * wave(5.0 * x + 3.0 * y) + noise()) as f32,
            (0.15 * wave(7.0 * y - 2.0 * x) * wave(3.0 * x) + noise()) as f32,
        ]
    };
    NormalMap { width, height, wrap, projected: (0..width * height).map(texel).collect() }
}

const GRID: Target = Target::Patches { width: 500, height: 400 };
const TILES: Target = Target::Unbounded { colours: 2, variants: 1 };

fn synthesis(target: Target) -> SynthesisOptions {
    let (patch, overlap) = if target == GRID { (64, 8) } else { (96, 6) };
    SynthesisOptions { target, patch, overlap, alignment: 16, ..SynthesisOptions::default() }
}

fn lobes() -> LobesOptions {
    LobesOptions { footprints: 0, ..LobesOptions::default() }
}

fn baked_of(sample: &NormalMap, lobes: LobesOptions, synthesis: SynthesisOptions) -> Result<Surface, BakeError> {
    bake(sample, &SurfaceOptions { lobes, synthesis }, &Silent)
}

fn baked(sample: &NormalMap, target: Target) -> Surface {
    baked_of(sample, lobes(), synthesis(target)).unwrap()
}

fn footprint(x: f64, y: f64, sigma: f64, anisotropy: f64, angle: f64) -> Footprint {
    Footprint::new(DVec2::new(x, y), sigma, anisotropy, angle)
}

#[test]
fn a_surface_is_a_sound_pack_and_read_back() {
    // A map that repeats in whole steps, one that repeats in others, one that does not; linear and nearest.
    let maps = [waves(128, 112, Wrap::Repeat), waves(130, 128, Wrap::Repeat), waves(120, 133, Wrap::Clamp)];
    for (map, filter) in maps.iter().zip([Filter::Linear, Filter::Nearest, Filter::Linear]) {
        for target in [GRID, TILES] {
            let surface = baked_of(map, LobesOptions { filter, ..lobes() }, synthesis(target)).unwrap();
            let mut builder = PackBuilder::new();
            for section in to_sections("gold", &surface, Codec::Zstd) {
                builder.push(section).unwrap();
            }
            let pack = Pack::from_bytes(builder.finish().unwrap(), &Limits::default()).unwrap();
            assert_eq!(pack.verify(), []);
            assert_eq!(surfaces(&pack), ["gold"]);
            assert_eq!(from_pack(&pack, "gold").unwrap(), surface);
            assert!(glint_bake_core::lobes::sections::maps(&pack).is_empty());
            let refused = glint_bake_core::lobes::sections::from_pack(&pack, "gold");
            assert!(matches!(refused, Err(BakeError::BadInput(why)) if why.contains("surface of patches")));
        }
    }
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let sample = waves(128, 128, Wrap::Clamp);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = LobesOptions { footprints: 1, ..LobesOptions::default() };
        pool.install(|| baked_of(&sample, options, synthesis(GRID)).unwrap())
    };
    let one = on(1);
    assert!(one == on(2) && one == on(7));
}

#[test]
fn whole_blocks_cells_of_every_level_and_boxes_agree_where_footprints_are_large() {
    // One footprint over many patches: every level, and the surface as a whole, see nearly the same normals.
    let sample = waves(160, 160, Wrap::Clamp);
    for target in [GRID, TILES] {
        let surface = baked(&sample, target);
        let exact = Exact { surface: &surface, sample: &sample, roughness: 0.02, refinement: 1.0 };
        let levels = surface.lobes.params.levels.len();
        let mut ways = vec![Measured::At(Detail::Boxes(1.0), SurfaceSettings::default())];
        ways.extend((0..levels).map(|level| Measured::At(Detail::Cells(level), SurfaceSettings::default())));
        ways.push(Measured::At(Detail::Whole, SurfaceSettings::default()));
        let errors = exact.errors(&ways, &[footprint(210.3, 170.8, 40.0, 1.0, 0.0)], 4);
        for (k, error) in errors.iter().enumerate() {
            let most = if k >= levels { 0.12 } else { 0.04 };
            assert!(error.e1.mean < most && error.energy.worst < 0.01, "{target:?}, level {k}: {error:?}");
        }
    }
}

#[test]
fn the_finest_level_is_the_assembled_map() {
    for (wrap, filter) in [(Wrap::Clamp, Filter::Linear), (Wrap::Repeat, Filter::Nearest)] {
        let sample = waves(128, 128, wrap);
        for target in [GRID, TILES] {
            let surface = baked_of(&sample, LobesOptions { filter, ..lobes() }, synthesis(target)).unwrap();
            let exact = Exact { surface: &surface, sample: &sample, roughness: 0.02, refinement: 1.0 };
            for sigma in [0.5, 1.0, 2.0] {
                let places = seam_footprints(&surface, sigma, 8, 3, false);
                let errors = exact.errors(&[Measured::Chosen(SurfaceSettings::default())], &places, 4);
                assert!(errors[0].e1.worst < 0.03, "{target:?} σ {sigma}: {:?}", errors[0]);
                assert!(errors[0].energy.worst < 0.002, "{target:?} σ {sigma}: {:?}", errors[0]);
            }
        }
    }
}

#[test]
fn seams_are_no_worse_than_the_inside_of_patches() {
    let sample = waves(192, 192, Wrap::Clamp);
    let surface = baked(&sample, GRID);
    let exact = Exact { surface: &surface, sample: &sample, roughness: 0.02, refinement: 1.0 };
    for sigma in [1.0, 2.0, 4.0, 8.0] {
        let mean = |inside| {
            let places = seam_footprints(&surface, sigma, 12, 7, inside);
            exact.errors(&[Measured::Chosen(SurfaceSettings::default())], &places, 4)[0].e1.mean
        };
        let (seams, inside) = (mean(false), mean(true));
        assert!(seams <= 1.3 * inside, "σ {sigma}: {seams} across seams, {inside} inside");
    }
}

#[test]
fn the_density_is_that_of_the_gathered_lobes_and_repeats_with_the_surface() {
    let sample = waves(128, 128, Wrap::Clamp);
    let settings = SurfaceSettings::default();
    let surface = baked(&sample, GRID);
    for sigma in [0.1, 1.0, 5.0, 20.0] {
        // On the surface's own edge: 512 × 448 texels of whole patches.
        let here = footprint(511.5, 447.0, sigma, 2.0, 0.3);
        let there = footprint(511.5 - 5.0 * 512.0, 447.0 + 3.0 * 448.0, sigma, 2.0, 0.3);
        let (gathered, far) = (surface.gather(&here, 0.02, &settings), surface.gather(&there, 0.02, &settings));
        assert_eq!(gathered.lobes.len(), far.lobes.len());
        for s in [Vec2::new(0.05, -0.1), Vec2::new(-0.2, 0.1), Vec2::new(0.9, 0.9)] {
            let density = surface.p_ndf(&here, s, 0.02, &settings);
            assert!((density - gathered.density(s)).abs() <= 1e-4 * density.max(1.0), "σ {sigma}");
            assert!((density - far.density(s)).abs() <= 2e-3 * density.max(1.0), "σ {sigma}");
        }
    }
}

#[test]
fn any_footprint_gets_a_normalised_answer_for_bounded_work() {
    let flat = NormalMap { width: 112, height: 112, wrap: Wrap::Repeat, projected: vec![[0.3, -0.2]; 112 * 112] };
    let samples = [waves(128, 128, Wrap::Clamp), flat];
    let settings = SurfaceSettings::default();
    for sample in &samples {
        for target in [GRID, TILES] {
            let surface = baked(sample, target);
            for sigma in [0.01, 0.3, 3.0, 30.0, 300.0, 10_000.0] {
                for anisotropy in [1.0, 8.0, 1000.0] {
                    for (x, y) in [(63.9, 64.1), (-1e7 - 0.3, 3e12)] {
                        for roughness in [1e-4, 0.02, 1.0] {
                            let footprint = footprint(x, y, sigma, anisotropy, 0.4);
                            let seen = surface.gather(&footprint, roughness, &settings);
                            let sum: f32 = seen.lobes.iter().map(|lobe| lobe.share).sum();
                            assert!((sum - 1.0).abs() < 1e-3, "{sigma} {anisotropy} {sum}");
                            assert!(seen.lobes.iter().all(|lobe| lobe.share >= 0.0 && lobe.peak.is_finite()));
                            // Long footprints on a sample that holds few cells of 64 texels read smaller ones.
                            assert!(seen.lobes.len() < 32_000, "{sigma} {anisotropy}: {}", seen.lobes.len());
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn density_is_continuous_in_the_footprints_size() {
    let sample = waves(128, 128, Wrap::Clamp);
    let surface = baked(&sample, GRID);
    let settings = SurfaceSettings::default();
    let steps = |k: u32| {
        let sigma = 0.5 * f64::from(k as f32 * 0.04).exp2();
        surface.gather(&footprint(100.0, 120.0, sigma, 1.0, 0.0), 0.05, &settings)
    };
    let points: Vec<Vec2> = (0..17 * 17).map(|k| Vec2::new((k % 17 - 8) as f32, (k / 17 - 8) as f32) * 0.05).collect();
    let at = |k: u32| -> Vec<f32> {
        let seen = steps(k);
        points.iter().map(|s| seen.density(*s)).collect()
    };
    let mut last = at(0);
    for k in 1..180 {
        let now = at(k);
        let change: f32 = now.iter().zip(&last).map(|(a, b)| (a - b).abs()).sum();
        let whole: f32 = now.iter().sum();
        assert!(change < 0.1 * whole, "σ {}: {}", 0.5 * (k as f32 * 0.04).exp2(), change / whole);
        last = now;
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let sample = waves(128, 128, Wrap::Clamp);
    let refused = |lobes: LobesOptions, synthesis: SynthesisOptions| match baked_of(&sample, lobes, synthesis) {
        Err(error) => error.to_string(),
        Ok(baked) => panic!("{:?} was taken", baked.synthesis.params),
    };
    assert!(refused(LobesOptions { cell_texels: 32, ..lobes() }, synthesis(GRID)).contains("cell: "));
    assert!(refused(LobesOptions { seeds: 3, ..lobes() }, synthesis(GRID)).contains("seeds: "));
    let odd = SynthesisOptions { alignment: 12, patch: 60, ..synthesis(GRID) };
    assert!(refused(lobes(), odd).contains("alignment: "));
    assert!(refused(lobes(), SynthesisOptions { patch: 256, ..synthesis(GRID) }).contains("patch"));
}

#[test]
fn clear_of_seams_whole_blocks_are_what_is_shown() {
    let sample = waves(128, 128, Wrap::Repeat);
    let surface = baked(&sample, GRID);
    let whole = SurfaceSettings::realtime();
    let exact = SurfaceSettings { whole_blocks: false, ..whole };
    // Footprints that read boxes, of which few lie on a seam, since boxes follow it but for its own; and such that read cells.
    for (sigma, least) in [(1.6, 0), (2.4, 20)] {
        let mut other = 0;
        for k in 0..40 {
            // Middles of patches, then places on their corners.
            let (x, y) = (64.0 * f64::from(k % 7), 64.0 * f64::from(k / 7));
            let gathered = |shift: f64, settings| {
                surface.gather(&footprint(x + shift, y + shift, sigma, 1.0, 0.0), 0.02, settings)
            };
            assert_eq!(gathered(28.0, &exact), gathered(28.0, &whole), "{k}");
            other += u32::from(gathered(0.0, &exact) != gathered(0.0, &whole));
        }
        println!("σ {sigma}: {other} of 40 corners differ");
        assert!(other > least, "σ {sigma}: seams make no difference at all but {other} of 40 corners");
    }
}
