//! P-NDFs of a map's lobes.

use crate::support::{QUERIES, compare, gpu, log_uniform, random, real_map};
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, Vec2};
use glint_bake_core::footprint::Footprint;
use glint_bake_core::lobes::options::NormalsChoice;
use glint_bake_core::lobes::query::QuerySettings;
use glint_bake_core::lobes::sections::to_sections;
use glint_bake_core::lobes::{BakedLobes, LobesOptions, bake};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_formats::lobes::{
    BINDINGS, Filter, LOBES, LevelUniform, LobeStorage, LobesUniform, MapUniform, NORMALS, UNIFORM,
};
use glint_formats::{Codec, Wrap};
use glint_shaders::assert_same_layout;
use glint_view::gpu::{BoundSection, Gpu, Resources, answer, bind_sections};
use glint_view::methods::lobes::modules;
use rand::{Rng, RngExt};

/// Most lobes and boxes that a query may see: Mesa's software adapter silently ends a program after 65 535 steps of all its loops
/// and eight queries together.
pub const MOST_LOBES: usize = 800;

/// `GlintLobesSettings` of lobes/query.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Settings {
    cell_sigmas: f32,
    boxes_until: f32,
    cells_from: f32,
    box_sigmas: f32,
    max_cells: f32,
    max_boxes: f32,
    reach: f32,
    cells_reach: f32,
    blend: f32,
}

impl Settings {
    pub fn of(settings: &QuerySettings) -> Settings {
        let QuerySettings { cell_sigmas, boxes_until, cells_from, box_sigmas, max_cells, max_boxes, .. } = *settings;
        let QuerySettings { reach, cells_reach, blend, .. } = *settings;
        Settings { cell_sigmas, boxes_until, cells_from, box_sigmas, max_cells, max_boxes, reach, cells_reach, blend }
    }
}

/// A footprint as the GPU has it, and the normal that is asked for.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Place {
    pub mean: Vec2,
    pub s: Vec2,
    pub covariance: [f32; 3],
    pub roughness: f32,
}

impl Place {
    /// The footprint whose numbers the GPU has.
    pub fn footprint(&self) -> Footprint {
        let [xx, xy, yy] = self.covariance.map(f64::from);
        let covariance = glam::DMat2::from_cols(DVec2::new(xx, xy), DVec2::new(xy, yy));
        Footprint { mean: self.mean.as_dvec2(), covariance }
    }
}

/// `LobesQuery` of query_lobes.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Query {
    place: Place,
    settings: Settings,
    end: u32,
}

/// The sections of lobes as a pack has them, bound.
fn bound(gpu: &Gpu, lobes: &BakedLobes) -> Resources {
    bind_sections(gpu, &to_sections("", lobes, Codec::None), BINDINGS, lobes.params.wrap).unwrap()
}

/// Two standard normal numbers.
fn normals(rng: &mut impl Rng) -> Vec2 {
    let radius = (-2.0 * (1.0 - rng.random::<f32>()).ln()).sqrt();
    Vec2::from_angle(rng.random::<f32>() * std::f32::consts::TAU) * radius
}

/// Footprints of 0.05 to 500 texels and an anisotropy to 32, and a normal that they see, from what the map shows at a place.
pub fn place(rng: &mut impl Rng, from: f32, shown: impl Fn(Vec2) -> Vec2) -> Place {
    let major = log_uniform(rng, 0.05, 500.0);
    let minor = (major / log_uniform(rng, 1.0, 32.0)).max(0.05);
    let axis = Vec2::from_angle(rng.random::<f32>() * std::f32::consts::TAU);
    let mean = Vec2::new(rng.random::<f32>() - 0.5, rng.random::<f32>() - 0.5) * from;
    let outer = |a: f32, b: f32| major * major * a * b;
    let across = |a: f32, b: f32| minor * minor * a * b;
    let roughness = log_uniform(rng, 0.008, 0.15);
    let at = normals(rng) * Vec2::new(major, minor);
    let u = mean + axis * at.x + axis.perp() * at.y;
    Place {
        mean,
        s: shown(u) + normals(rng) * roughness * rng.random::<f32>() * 1.5,
        covariance: [
            outer(axis.x, axis.x) + across(axis.y, axis.y),
            outer(axis.x, axis.y) - across(axis.x, axis.y),
            outer(axis.y, axis.y) + across(axis.x, axis.x),
        ],
        roughness,
    }
}

/// Settings as they are by default, or any.
pub fn settings(rng: &mut impl Rng) -> QuerySettings {
    match rng.random_range(0..4) {
        0 => return QuerySettings::default(),
        1 => return QuerySettings::realtime(),
        _ => {}
    }
    let boxes_until = log_uniform(rng, 0.05, 0.3);
    QuerySettings {
        cell_sigmas: log_uniform(rng, 0.2, 0.8),
        boxes_until,
        cells_from: boxes_until * (1.2 + rng.random::<f32>()),
        box_sigmas: log_uniform(rng, 0.2, 1.0),
        max_cells: log_uniform(rng, 3.0, 40.0),
        max_boxes: log_uniform(rng, 16.0, 800.0),
        reach: 2.0 + 1.5 * rng.random::<f32>(),
        cells_reach: 1.0 + 2.5 * rng.random::<f32>(),
        blend: log_uniform(rng, 0.05, 1.0),
    }
}

/// Waves with noise on them: something smooth, something rough.
pub fn waves(width: u32, height: u32, wrap: Wrap) -> NormalMap {
    let rng = &mut random(5);
    let texel = |at: u32| {
        let (x, y) = ((at % width) as f32 / width as f32, (at / width) as f32 / height as f32);
        let wave = |k: f32| (std::f32::consts::TAU * k).sin();
        let mut noise = || 0.06 * (rng.random::<f32>() - 0.5);
        [0.2 * wave(2.0 * x + y) + noise(), 0.15 * wave(3.0 * y - 2.0 * x) * wave(3.0 * x) + noise()]
    };
    NormalMap { width, height, wrap, projected: (0..width * height).map(texel).collect() }
}

/// Density whose inverse is the unit of comparison: that of the map's normals as a whole, with the roughness.
pub fn unit(range: [f32; 2], roughness: f32) -> f32 {
    let variance = |range: f32| roughness * roughness + range * range / 12.0;
    std::f32::consts::TAU * (variance(range[0]) * variance(range[1])).sqrt()
}

fn answers(gpu: &Gpu, lobes: &BakedLobes, rng: &mut impl Rng, count: usize) -> Vec<(f32, f32)> {
    let params = &lobes.params;
    let size = Vec2::new(params.width as f32, params.height as f32);
    let shown = |u: Vec2| {
        let at = (u - (u / size).floor() * size).as_ivec2();
        lobes.texel(at.x.min(params.width as i32 - 1), at.y.min(params.height as i32 - 1))
    };
    let mut queries = Vec::new();
    let mut expected = Vec::new();
    let mut drawn = 0;
    while queries.len() < count {
        drawn += 1;
        let place = place(rng, 3000.0, shown);
        let settings = settings(rng);
        let gathered = lobes.gather(&place.footprint(), place.roughness, &settings);
        if gathered.lobes.len() > MOST_LOBES {
            continue;
        }
        expected.push(gathered.density(place.s));
        queries.push(Query { place, settings: Settings::of(&settings), end: 0 });
    }
    println!("{count} queries of {drawn} are of no more than {MOST_LOBES} lobes");
    let source = glint_shaders::compose(&["query_lobes", modules(params)[0]]);
    let found: Vec<f32> = answer(gpu, "lobes", &source, &[&bound(gpu, lobes)], &queries).unwrap();
    let unit = |i: usize| unit(params.normal_extent, queries[i].place.roughness);
    found.iter().zip(&expected).enumerate().map(|(i, (a, e))| (a * unit(i), e * unit(i))).collect()
}

#[test]
fn the_uniform_lies_as_the_shader_reads_it() {
    let source = glint_shaders::compose(&["bind_lobes", "lobes::packed", "synthesis::grid"]);
    assert_same_layout!(&source, "LobesUniform", LobesUniform, map, synthesis, levels);
    assert_same_layout!(
        &source,
        "GlintLobesMap",
        MapUniform,
        width,
        height,
        wrap,
        nearest,
        normals,
        lobes_per_cell,
        step_texels,
        levels,
        normal_low,
        normal_extent,
    );
    assert_same_layout!(
        &source,
        "GlintLobesLevel",
        LevelUniform,
        cell_texels,
        cells_x,
        cells_y,
        first_lobe,
        weight_scale,
        jacobian_scale,
        position_sigma,
        position_log_ratio,
        residual_sigma,
        residual_log_ratio,
        extent,
    );
}

#[test]
fn what_is_bound_is_what_the_sections_hold() {
    let Some(gpu) = gpu() else { return };
    let options = LobesOptions { footprints: 0, ..LobesOptions::default() };
    let lobes = bake(&waves(21, 15, Wrap::Clamp), &options, &Silent).unwrap();
    let sections = to_sections("", &lobes, Codec::None);
    let data = bind_sections(gpu, &sections, BINDINGS, Wrap::Clamp).unwrap();
    assert_eq!(data.bytes, lobes.gpu_bytes() as u64);
    let kinds: Vec<_> = data.sections.iter().map(|(kind, _)| *kind).collect();
    assert_eq!(kinds, [UNIFORM, LOBES, NORMALS]);
    for (kind, bound) in &data.sections {
        let BoundSection::Buffer(buffer) = bound else { panic!("{kind} is no buffer") };
        let section = sections.iter().find(|section| section.kind == *kind).unwrap();
        assert_eq!(buffer.size(), section.payload.len() as u64, "{kind}");
    }
}

#[test]
fn the_density_of_the_shader_is_that_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let rng = &mut random(3);
    let mut pairs = Vec::new();
    let wraps = [Wrap::Repeat, Wrap::Clamp];
    let storages = [LobeStorage::Packed, LobeStorage::Half];
    let normals = [NormalsChoice::Snorm16, NormalsChoice::Unorm8];
    for (i, (filter, wrap)) in [Filter::Linear, Filter::Nearest].iter().flat_map(|f| wraps.map(|w| (f, w))).enumerate()
    {
        for (j, storage) in storages.into_iter().enumerate() {
            let options = LobesOptions {
                filter: *filter,
                storage,
                normals: normals[(i + j) % 2],
                lobes_per_cell: [8, 16][j],
                cell_texels: [8, 4][j],
                footprints: 0,
                ..LobesOptions::default()
            };
            let lobes = bake(&waves(61, 48, wrap), &options, &Silent).unwrap();
            pairs.extend(answers(gpu, &lobes, rng, QUERIES / 8));
        }
    }
    compare("lobes", pairs.into_iter());
}

#[test]
fn a_real_map_gives_the_same_on_both() {
    let Some(gpu) = gpu() else { return };
    let Some(map) = real_map("normals/carpaint_flakes_khronos_128.png") else { return };
    let options = LobesOptions { lobes_per_cell: 16, footprints: 0, ..LobesOptions::default() };
    let lobes = bake(&map, &options, &Silent).unwrap();
    compare("lobes, flakes", answers(gpu, &lobes, &mut random(8), QUERIES).into_iter());
}

#[test]
fn hard_maps_and_footprints_have_finite_densities() {
    let Some(gpu) = gpu() else { return };
    let map = |width: u32, height: u32, wrap, s: &dyn Fn(u32) -> [f32; 2]| NormalMap {
        width,
        height,
        wrap,
        projected: (0..width * height).map(s).collect(),
    };
    let steep = |at: u32| if at.is_multiple_of(3) { [0.999, 0.0] } else { [-0.7, 0.7] };
    let maps = [
        map(1, 1, Wrap::Repeat, &|_| [0.0; 2]),
        map(16, 16, Wrap::Clamp, &|_| [0.3, -0.2]),
        map(33, 1, Wrap::Repeat, &steep),
        map(20, 20, Wrap::Clamp, &steep),
    ];
    for map in &maps {
        for (filter, roughness) in [(Filter::Linear, 1e-3), (Filter::Nearest, 1.0)] {
            let options = LobesOptions { filter, roughness, footprints: 0, ..LobesOptions::default() };
            let lobes = bake(map, &options, &Silent).unwrap();
            let mut queries = Vec::new();
            for covariance in [[0.0; 3], [1e16, 0.0, 1e16], [1e16, 0.0, 0.0], [1e8, 9.9e7, 1e8], [1e-12, 0.0, 1e-4]] {
                for mean in [Vec2::ZERO, Vec2::splat(-1e6), Vec2::splat(3e9)] {
                    for s in [Vec2::ZERO, Vec2::X, Vec2::new(0.3, -0.2), Vec2::splat(2.0)] {
                        for settings in [QuerySettings::default(), QuerySettings::realtime()] {
                            let place = Place { mean, s, covariance, roughness: roughness as f32 };
                            queries.push(Query { place, settings: Settings::of(&settings), end: 0 });
                        }
                    }
                }
            }
            let source = glint_shaders::compose(&["query_lobes", modules(&lobes.params)[0]]);
            let found: Vec<f32> = answer(gpu, "lobes", &source, &[&bound(gpu, &lobes)], &queries).unwrap();
            for (density, query) in found.iter().zip(&queries) {
                assert!(density.is_finite() && *density >= 0.0, "{density} at {query:?}");
                assert!(query.place.s.length() <= 1.0 || *density == 0.0, "{density} outside the disk");
            }
        }
    }
}
