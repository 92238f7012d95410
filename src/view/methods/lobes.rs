//! Lobes of a map, and the surface synthesised from it, on the GPU: `bind_lobes.wgsl`.

use crate::gpu::{Gpu, ResourceSet, Resources};
use bytemuck::{Pod, Zeroable};
use glint_bake_core::lobes::BakedLobes;
use glint_bake_core::lobes::quantise::nominal_extent;
use glint_bake_core::surface::Surface;
use glint_bake_core::synthesis::Synthesis;
use glint_formats::Wrap;
use glint_formats::lobes::{Filter, LobeLevel, LobeStorage, LobesParams, NormalsStorage};
use glint_formats::synthesis::Layout;

/// Most levels: cells of 4 texels doubled to the largest map, and the whole of a surface.
const LEVELS: usize = 16;

/// `GlintLobesMap`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct MapUniform {
    width: u32,
    height: u32,
    wrap: u32,
    nearest: u32,
    normals: u32,
    lobes_per_cell: u32,
    step_texels: u32,
    levels: u32,
    normal_low: [f32; 2],
    normal_extent: [f32; 2],
}

/// `GlintSynthesis`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
struct SynthesisUniform {
    sample: [u32; 2],
    wrap: u32,
    patch_texels: u32,
    overlap: u32,
    layout: u32,
    columns: u32,
    rows: u32,
    colours: u32,
    variants: u32,
    margin: u32,
    hash_seed: u32,
    path_bits: u32,
    path_per_word: u32,
    path_words: u32,
    colour_path_words: u32,
}

/// `GlintLobesLevel`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
struct LevelUniform {
    cell_texels: u32,
    cells_x: u32,
    cells_y: u32,
    first_lobe: u32,
    weight_scale: f32,
    jacobian_scale: f32,
    position_sigma: f32,
    position_log_ratio: f32,
    residual_sigma: f32,
    residual_log_ratio: f32,
    extent: [f32; 2],
}

/// `LobesData`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct LobesUniform {
    map: MapUniform,
    synthesis: SynthesisUniform,
    levels: [LevelUniform; LEVELS],
}

fn wrap(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 0,
        Wrap::Clamp => 1,
    }
}

fn map_uniform(params: &LobesParams) -> MapUniform {
    MapUniform {
        width: params.width,
        height: params.height,
        wrap: wrap(params.wrap),
        nearest: u32::from(params.filter == Filter::Nearest),
        normals: u32::from(params.normals == NormalsStorage::Unorm8),
        lobes_per_cell: params.lobes_per_cell,
        step_texels: params.step_texels,
        levels: params.levels.len() as u32,
        normal_low: params.normal_low,
        normal_extent: params.normal_extent,
    }
}

fn level_uniform(params: &LobesParams, level: &LobeLevel) -> LevelUniform {
    let log_ratio = |[low, high]: [f32; 2]| (high / low).log2();
    LevelUniform {
        cell_texels: level.cell_texels,
        cells_x: level.cells_x,
        cells_y: level.cells_y,
        first_lobe: level.first_lobe,
        weight_scale: level.weight_scale,
        jacobian_scale: level.jacobian_scale,
        position_sigma: level.position_sigma[0],
        position_log_ratio: log_ratio(level.position_sigma),
        residual_sigma: level.residual_sigma[0],
        residual_log_ratio: log_ratio(level.residual_sigma),
        extent: nominal_extent(params, level).to_array(),
    }
}

fn synthesis_uniform(synthesis: &Synthesis) -> SynthesisUniform {
    let params = &synthesis.params;
    let shape = params.patch_path();
    let uniform = SynthesisUniform {
        sample: [params.sample_width, params.sample_height],
        wrap: wrap(params.wrap),
        patch_texels: params.patch,
        overlap: params.overlap,
        path_bits: shape.bits,
        path_per_word: shape.per_word,
        path_words: shape.words,
        ..SynthesisUniform::default()
    };
    match params.layout {
        Layout::Patches { columns, rows, .. } => SynthesisUniform { columns, rows, ..uniform },
        Layout::CornerTiles { colours, variants, margin, hash_seed } => SynthesisUniform {
            layout: 1,
            colours,
            variants,
            margin,
            hash_seed,
            path_words: params.middle_path(margin).words,
            colour_path_words: params.colour_path(margin).words,
            ..uniform
        },
    }
}

/// The WGSL files that a program of these lobes takes in besides `query_lobes` or `shade_lobes`.
pub fn modules(params: &LobesParams) -> [&'static str; 1] {
    match params.storage {
        LobeStorage::Packed => ["lobes::packed"],
        LobeStorage::Half => ["lobes::half"],
    }
}

/// The WGSL files that a program of this surface takes in besides `query_surface` or `shade_surface`; with `whole_blocks`
/// ([`glint_bake_core::surface::SurfaceSettings::whole_blocks`]) seams are not followed.
pub fn surface_modules(surface: &Surface, whole_blocks: bool) -> [&'static str; 3] {
    let [records] = modules(&surface.lobes.params);
    let arrangement = match surface.synthesis.params.layout {
        Layout::Patches { .. } => "synthesis::grid",
        Layout::CornerTiles { .. } => "synthesis::tiles",
    };
    [records, arrangement, if whole_blocks { "surface::blocks" } else { "surface::seams" }]
}

/// Uploads the lobes of a map: for `query_lobes` and `shade_lobes`.
pub fn upload(gpu: &Gpu, lobes: &BakedLobes) -> Resources {
    resources(gpu, lobes, None)
}

/// Uploads a synthesised surface: for `query_surface` and `shade_surface`.
pub fn upload_surface(gpu: &Gpu, surface: &Surface) -> Resources {
    resources(gpu, &surface.lobes, Some(&surface.synthesis))
}

/// Each texel of the normals and the one below it as the map is wrapped, so that a bilinear patch is two loads: stored numbers,
/// x in the lower half of a word.
fn normal_pairs(lobes: &BakedLobes) -> Vec<[u32; 2]> {
    let params = &lobes.params;
    let (width, height) = (params.width as usize, params.height as usize);
    let after_last = match params.wrap {
        Wrap::Repeat => 0,
        Wrap::Clamp => height - 1,
    };
    let bytes = params.normals.texel_bytes();
    let word = |column: usize, row: usize| {
        let texel = &lobes.normals[(row * width + column) * bytes..][..bytes];
        match params.normals {
            NormalsStorage::Snorm16 => u32::from_le_bytes([texel[0], texel[1], texel[2], texel[3]]),
            NormalsStorage::Unorm8 => u32::from(texel[0]) | u32::from(texel[1]) << 16,
        }
    };
    let below = |row: usize| if row + 1 < height { row + 1 } else { after_last };
    (0..width * height)
        .map(|at| (at % width, at / width))
        .map(|(column, row)| [word(column, row), word(column, below(row))])
        .collect()
}

fn resources(gpu: &Gpu, lobes: &BakedLobes, synthesis: Option<&Synthesis>) -> Resources {
    let params = &lobes.params;
    let mut levels = [LevelUniform::default(); LEVELS];
    for (slot, level) in levels.iter_mut().zip(&params.levels) {
        *slot = level_uniform(params, level);
    }
    let uniform = LobesUniform {
        map: map_uniform(params),
        synthesis: synthesis.map_or_else(SynthesisUniform::default, synthesis_uniform),
        levels,
    };
    let offsets: &[[u16; 2]] = synthesis.map_or(&[], |synthesis| &synthesis.offsets);
    let seams: &[u32] = synthesis.map_or(&[], |synthesis| &synthesis.seams);
    let mut set = ResourceSet::default();
    set.uniform(gpu, bytemuck::bytes_of(&uniform));
    set.storage(gpu, &lobes.lobes);
    set.storage(gpu, bytemuck::cast_slice(&normal_pairs(lobes)));
    set.storage(gpu, bytemuck::cast_slice(offsets));
    set.storage(gpu, bytemuck::cast_slice(seams));
    set.finish(gpu)
}
