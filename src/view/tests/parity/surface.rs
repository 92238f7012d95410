//! P-NDFs of a surface synthesised by patches.

use crate::lobes::{MOST_LOBES, Place, Settings, place, settings, unit, waves};
use crate::support::{QUERIES, compare, gpu, log_uniform, random};
use bytemuck::{Pod, Zeroable};
use glint_bake_core::lobes::LobesOptions;
use glint_bake_core::lobes::options::NormalsChoice;
use glint_bake_core::lobes::query::QuerySettings;
use glint_bake_core::progress::Silent;
use glint_bake_core::surface::sections::to_sections;
use glint_bake_core::surface::{Surface, SurfaceOptions, SurfaceSettings, bake};
use glint_bake_core::synthesis::{SynthesisOptions, Target};
use glint_formats::lobes::{BINDINGS, Filter, LobeStorage};
use glint_formats::synthesis::SynthesisUniform;
use glint_formats::{Codec, Wrap};
use glint_shaders::assert_same_layout;
use glint_view::gpu::{Gpu, answer, bind_sections};
use glint_view::methods::lobes::surface_modules;
use rand::{Rng, RngExt};

/// `SurfaceQuery` of query_surface.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Query {
    place: Place,
    lobes: Settings,
    owned_from: f32,
    owned_sigma: f32,
    box_range: f32,
    halves_until: f32,
    end: u32,
}

fn surface_settings(rng: &mut impl Rng, whole_blocks: bool) -> SurfaceSettings {
    let query = settings(rng);
    let query = QuerySettings { max_cells: 0.5 * query.max_cells, max_boxes: 0.5 * query.max_boxes, ..query };
    if rng.random_range(0..4) == 0 {
        return SurfaceSettings { lobes: query, whole_blocks, ..SurfaceSettings::default() };
    }
    SurfaceSettings {
        lobes: query,
        owned_from: [8.0, 16.0, 32.0, 64.0][rng.random_range(0..4)],
        owned_sigma: log_uniform(rng, 2.0, 30.0),
        box_range: log_uniform(rng, 0.3, 4.0),
        halves_until: log_uniform(rng, 1.0, 20.0),
        whole_blocks,
    }
}

fn answers(gpu: &Gpu, surface: &Surface, rng: &mut impl Rng, whole_blocks: bool, count: usize) -> Vec<(f32, f32)> {
    let shown = |u: glam::Vec2| {
        let at = u.floor().as_ivec2();
        let (x, y) = surface.synthesis.source_texel(at.x, at.y);
        surface.lobes.texel(x as i32, y as i32)
    };
    let mut queries = Vec::new();
    let mut expected = Vec::new();
    let mut drawn = 0;
    while queries.len() < count {
        drawn += 1;
        let place = place(rng, 3000.0, shown);
        let settings = surface_settings(rng, whole_blocks);
        let SurfaceSettings { lobes, owned_from, owned_sigma, box_range, halves_until, .. } = settings;
        let gathered = surface.gather(&place.footprint(), place.roughness, &settings);
        if gathered.lobes.len() > MOST_LOBES {
            continue;
        }
        expected.push(gathered.density(place.s));
        queries.push(Query {
            place,
            lobes: Settings::of(&lobes),
            owned_from,
            owned_sigma,
            box_range,
            halves_until,
            end: 0,
        });
    }
    println!("{count} queries of {drawn} are of no more than {MOST_LOBES} lobes");
    let mut modules = vec!["query_surface"];
    modules.extend(surface_modules(&surface.lobes.params, &surface.synthesis.params, whole_blocks));
    let source = glint_shaders::compose(&modules);
    let sections = to_sections("", surface, Codec::None);
    let data = bind_sections(gpu, &sections, BINDINGS, surface.lobes.params.wrap).unwrap();
    let found: Vec<f32> = answer(gpu, "surface", &source, &[&data], &queries).unwrap();
    let unit = |i: usize| unit(surface.lobes.params.normal_extent, queries[i].place.roughness);
    found.iter().zip(&expected).enumerate().map(|(i, (a, e))| (a * unit(i), e * unit(i))).collect()
}

#[test]
fn the_synthesis_lies_as_the_shader_reads_it() {
    let source = glint_shaders::compose(&["bind_lobes", "lobes::packed", "synthesis::grid"]);
    assert_same_layout!(
        &source,
        "GlintSynthesis",
        SynthesisUniform,
        sample_width,
        sample_height,
        wrap,
        patch_texels,
        overlap,
        arrangement,
        columns,
        rows,
        colours,
        variants,
        margin,
        hash_seed,
        path_bits,
        path_per_word,
        path_words,
        colour_path_words,
    );
}

#[test]
fn the_density_of_the_shader_is_that_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let rng = &mut random(4);
    let grid = (Target::Patches { width: 500, height: 400 }, 64, 8);
    let tiles = (Target::Unbounded { colours: 2, variants: 2 }, 96, 6);
    // A sample that repeats in whole steps, one that does not; bilinear and nearest; both storages.
    let cases = [
        (grid, Wrap::Repeat, Filter::Linear, LobeStorage::Packed, NormalsChoice::Snorm16),
        (grid, Wrap::Clamp, Filter::Nearest, LobeStorage::Half, NormalsChoice::Unorm8),
        (tiles, Wrap::Repeat, Filter::Nearest, LobeStorage::Half, NormalsChoice::Snorm16),
        (tiles, Wrap::Clamp, Filter::Linear, LobeStorage::Packed, NormalsChoice::Unorm8),
    ];
    let mut pairs = Vec::new();
    for ((target, patch, overlap), wrap, filter, storage, normals) in cases {
        let lobes =
            LobesOptions { filter, storage, normals, lobes_per_cell: 8, footprints: 0, ..LobesOptions::default() };
        let synthesis = SynthesisOptions { target, patch, overlap, alignment: 16, ..SynthesisOptions::default() };
        let surface = bake(&waves(112, 128, wrap), &SurfaceOptions { lobes, synthesis }, &Silent).unwrap();
        for whole_blocks in [false, true] {
            pairs.extend(answers(gpu, &surface, rng, whole_blocks, QUERIES / 8));
        }
    }
    compare("surface", pairs.into_iter());
}
