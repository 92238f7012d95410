//! NDF maps of tiny examples, tiled and stochastic, in one or two layers.

use crate::support::{QUERIES, compare, gpu, random, real_map};
use bytemuck::{Pod, Zeroable};
use glam::{DMat2, DVec2, Vec2, Vec3};
use glint_bake_core::footprint::Footprint;
use glint_bake_core::moments::{moments_pdf, moments_sample, rough_normal};
use glint_bake_core::ndf_maps::bake::bake_maps;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::eval::{EvalSettings, matrix};
use glint_bake_core::ndf_maps::options::{NdfMapsOptions, PlacementOptions, StochasticOptions, TransformRanges};
use glint_bake_core::ndf_maps::placement::place;
use glint_bake_core::ndf_maps::reference_surface::SurfaceReference;
use glint_bake_core::ndf_maps::sections::{from_pack, layer_sections, to_sections};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_formats::ndf_maps::{LayeredMaterial, MaterialUniform, UNIFORM_BYTES};
use glint_formats::{Codec, Limits, Pack, PackBuilder, Wrap};
use glint_shaders::assert_same_layout;
use glint_shaders::layout::layout;
use glint_view::gpu::{Gpu, answer};
use glint_view::methods::ndf_maps::bind;
use rand::{Rng, RngExt};
use rand_pcg::Pcg64;

/// `NdfMapsQuery` of query_ndf_maps.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Query {
    mean: Vec2,
    s: Vec2,
    covariance: [f32; 3],
    max_ratio: f32,
    reach: f32,
    layer: u32,
    random: [f32; 2],
}

/// `NdfMapsAnswer`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Answer {
    density: f32,
    terms: f32,
    reached: f32,
    at_point: f32,
    mean: Vec2,
    covariance: [f32; 3],
    unused: f32,
    alpha: Vec2,
    light: Vec3,
    pdf: f32,
}

/// `NDF_MAPS_VIEW`.
const VIEW: Vec3 = Vec3::new(0.36, -0.48, 0.8);

impl Query {
    fn new(footprint: &Footprint, s: Vec2, settings: EvalSettings, layer: u32) -> Query {
        let c = footprint.covariance;
        Query {
            mean: footprint.mean.as_vec2(),
            s,
            covariance: [c.x_axis.x as f32, c.x_axis.y as f32, c.y_axis.y as f32],
            max_ratio: settings.max_ratio,
            reach: settings.reach,
            layer,
            random: [0.0; 2],
        }
    }

    /// The footprint that the shader sees.
    fn footprint(&self) -> Footprint {
        let [xx, xy, yy] = self.covariance.map(f64::from);
        let covariance = DMat2::from_cols(DVec2::new(xx, xy), DVec2::new(xy, yy));
        Footprint { mean: self.mean.as_dvec2(), covariance }
    }

    fn settings(&self) -> EvalSettings {
        let Query { max_ratio, reach, .. } = *self;
        EvalSettings { max_ratio, reach }
    }
}

const SETTINGS: [EvalSettings; 3] =
    [EvalSettings::REAL_TIME, EvalSettings::ACCURATE, EvalSettings { max_ratio: 1.0, reach: 2.0 }];

/// A material with the map it was baked from.
struct Sample {
    map: NormalMap,
    material: Material,
}

impl Sample {
    fn new(map: NormalMap, maps: NdfMapsOptions, placement: PlacementOptions) -> Sample {
        let placement = place(&map, maps.roughness, &placement).unwrap();
        let material = Material { maps: bake_maps(&map, &maps, &Silent).unwrap(), placement };
        Sample { map, material }
    }

    fn roughness(&self) -> f32 {
        self.material.maps.params.intrinsic_roughness
    }

    /// Peak of a Gaussian with the spread of the whole example.
    fn typical_peak(&self) -> f32 {
        let normals = &self.map.projected;
        let mean = normals.iter().map(|s| Vec2::from(*s)).sum::<Vec2>() / normals.len() as f32;
        let spread = normals.iter().map(|s| Vec2::from(*s).distance_squared(mean)).sum::<f32>() / normals.len() as f32;
        (std::f32::consts::TAU * (self.roughness().powi(2) + 0.5 * spread)).recip()
    }

    /// A projected normal of the surface, near one of the map's.
    fn normal(&self, rng: &mut Pcg64) -> Vec2 {
        let entry = &self.material.placement.palette[rng.random_range(0..self.material.placement.palette.len())];
        let s = Vec2::from(self.map.projected[rng.random_range(0..self.map.projected.len())]);
        let off = direction(rng) * (2.5 * self.roughness() * rng.random::<f32>());
        matrix(entry.normal_to_local).inverse() * (s + off)
    }
}

fn log_uniform(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(rng.random::<f64>())
}

fn direction(rng: &mut impl Rng) -> Vec2 {
    Vec2::from_angle(rng.random::<f32>() * std::f32::consts::TAU)
}

/// A bumpy map with a step in it.
fn map(width: u32, height: u32, wrap: Wrap) -> NormalMap {
    let normal = |k: u32| {
        let (x, y) = ((k % width) as f32, (k / width) as f32);
        let step = if 3.0 * x > 2.0 * width as f32 { 0.12 } else { 0.0 };
        [0.15 * (x * 1.3 + 0.4 * y).sin() + step, 0.2 * (y * 0.9 - 0.3 * x).cos() - 0.5 * step]
    };
    NormalMap { width, height, wrap, projected: (0..width * height).map(normal).collect() }
}

fn options(roughness: f64, finest_window: f64) -> NdfMapsOptions {
    NdfMapsOptions { roughness, max_error: 0.03, finest_window }
}

fn tiled(degrees: f64, scale: f64, shear: f64) -> PlacementOptions {
    let one = |v: f64| (v, v);
    let ranges =
        TransformRanges { rotate_degrees: one(degrees), scale: one(scale), shear: one(shear), ..Default::default() };
    PlacementOptions::Tiled(ranges)
}

fn stochastic(palette: u32, cells: u32, spacing: f64, seed: u64) -> PlacementOptions {
    PlacementOptions::Stochastic(StochasticOptions { palette, cells, spacing, seed, ..Default::default() })
}

/// Every placement and wrap, two materials a set of bindings.
fn samples() -> [[Sample; 2]; 4] {
    let all = TransformRanges {
        rotate_degrees: (0.0, 360.0),
        mirror: true,
        scale: (0.5, 2.0),
        stretch: (0.7, 1.2),
        shear: (-0.3, 0.3),
    };
    let varied = StochasticOptions { ranges: all, palette: 7, cells: 4, spacing: 0.6, seed: 5 };
    [
        [
            Sample::new(map(16, 16, Wrap::Repeat), options(0.05, 0.7), tiled(0.0, 1.0, 0.0)),
            Sample::new(map(13, 7, Wrap::Clamp), options(0.04, 0.7), tiled(31.0, 1.7, 0.2)),
        ],
        [
            Sample::new(map(16, 16, Wrap::Repeat), options(0.05, 0.7), stochastic(16, 8, 1.0, 1)),
            Sample::new(map(12, 16, Wrap::Clamp), options(0.06, 0.7), PlacementOptions::Stochastic(varied)),
        ],
        [
            Sample::new(map(8, 8, Wrap::Repeat), options(0.06, 0.7), stochastic(16, 16, 2.0, 9)),
            Sample::new(map(9, 5, Wrap::Clamp), options(0.08, 0.7), tiled(200.0, 0.6, 0.0)),
        ],
        [
            Sample::new(map(32, 32, Wrap::Repeat), options(0.03, 2.0), stochastic(1, 2, 0.8, 3)),
            Sample::new(map(37, 1, Wrap::Repeat), options(0.05, 0.7), tiled(0.0, 1.0, 0.0)),
        ],
    ]
}

/// Queries of both layers: footprints of 0.05 to 500 texels, long ones too, far from the origin too.
fn queries(rng: &mut Pcg64, layers: [&Sample; 2], count: usize) -> Vec<Query> {
    let query = |k: usize| {
        let layer = k % 2;
        let mean = direction(rng).as_dvec2() * log_uniform(rng, 1.0, 1e5);
        let (sigma, anisotropy) = (log_uniform(rng, 0.05, 500.0), log_uniform(rng, 1.0, 40.0));
        let footprint = Footprint::new(mean, sigma, anisotropy, rng.random::<f64>() * std::f64::consts::TAU);
        let s = if k % 5 == 4 { direction(rng) * rng.random::<f32>() } else { layers[layer].normal(rng) };
        Query::new(&footprint, s, SETTINGS[rng.random_range(0..SETTINGS.len())], layer as u32)
    };
    (0..count).map(query).collect()
}

/// A pack of two materials, the second as a coat over the first.
fn pack(layers: [&Sample; 2]) -> Pack {
    let names = ["base", "coat"];
    let both = LayeredMaterial { coat: names[1].into(), base: names[0].into(), coat_f0: 0.04, base_f0: [0.9; 3] };
    let mut builder = PackBuilder::new();
    let materials =
        names.into_iter().zip(layers).flat_map(|(name, layer)| to_sections(name, &layer.material, Codec::None));
    for section in materials.chain(layer_sections("both", &both)) {
        builder.push(section).unwrap();
    }
    let pack = Pack::from_bytes(builder.finish().unwrap(), &Limits::default()).unwrap();
    assert_eq!(pack.verify(), []);
    pack
}

fn ask(gpu: &Gpu, layers: [&Sample; 2], queries: &[Query]) -> Vec<Answer> {
    let data = bind(gpu, &pack(layers), "base", Some(("coat", "both"))).unwrap();
    answer(gpu, "NDF maps", &glint_shaders::compose(&["query_ndf_maps"]), &[&data], queries).unwrap()
}

fn expected(sample: &Sample, query: &Query) -> f32 {
    let terms = sample.material.gather(&query.footprint(), query.settings());
    sample.material.density(&terms, query.s)
}

/// Densities of GPU and CPU over a typical peak; what is out of reach must be nothing.
fn densities(gpu: &Gpu, layers: [&Sample; 2], queries: &[Query]) -> Vec<(f32, f32)> {
    let mut unreached = 0;
    let pairs = queries.iter().zip(ask(gpu, layers, queries)).map(|(query, answer)| {
        let sample = layers[query.layer as usize];
        let (cpu, unit) = (expected(sample, query), sample.typical_peak().recip());
        if answer.reached == 0.0 {
            unreached += 1;
            assert!(cpu * unit < 1e-4, "{cpu} is left out under {query:?}");
        }
        (answer.density * unit, cpu * unit)
    });
    let pairs = pairs.collect();
    assert!(unreached * 50 > queries.len(), "only {unreached} of {} queries are out of reach", queries.len());
    pairs
}

#[test]
fn the_density_of_the_shader_is_that_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let mut pairs = Vec::new();
    for (k, pair) in samples().iter().enumerate() {
        let layers = [&pair[0], &pair[1]];
        pairs.extend(densities(gpu, layers, &queries(&mut random(k as u64), layers, 2600)));
    }
    compare("NDF maps, density over a typical peak", pairs.into_iter());
}

#[test]
fn the_moments_of_the_shader_are_those_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let mut pairs = Vec::new();
    for (k, pair) in samples().iter().enumerate() {
        let layers = [&pair[0], &pair[1]];
        let mut rng = random(60 + k as u64);
        let mut queries = queries(&mut rng, layers, 2600);
        queries.iter_mut().for_each(|query| query.random = [rng.random(), rng.random()]);
        for (query, answer) in queries.iter().zip(ask(gpu, layers, &queries)) {
            let moments = layers[query.layer as usize].material.moments(&query.footprint(), query.settings());
            let rough = rough_normal(moments);
            let [x, y] = query.random;
            let light = moments_sample(moments, VIEW, Vec3::new(x, y, x));
            pairs.extend([
                (answer.mean.x, moments.mean.x),
                (answer.mean.y, moments.mean.y),
                (answer.covariance[0].sqrt(), moments.covariance.x.sqrt()),
                (answer.covariance[1], moments.covariance.y),
                (answer.covariance[2].sqrt(), moments.covariance.z.sqrt()),
                (answer.alpha.x, rough.alpha.x),
                (answer.alpha.y, rough.alpha.y),
                (answer.light.x, light.x),
                (answer.light.z, light.z),
                // Over that of a peak of the width of a lobe.
                (answer.pdf * 0.02, moments_pdf(moments, VIEW, light) * 0.02),
            ]);
        }
    }
    compare("NDF maps, moments and samples", pairs.into_iter());
}

#[test]
fn a_real_map_gives_the_same_on_both() {
    let Some(gpu) = gpu() else { return };
    let Some(map) = real_map("tiny/scratches_32x32.png") else { return };
    let maps = NdfMapsOptions::default();
    let pair = [
        Sample::new(map.clone(), maps.clone(), tiled(0.0, 1.0, 0.0)),
        Sample::new(map, maps, PlacementOptions::Stochastic(StochasticOptions::default())),
    ];
    let layers = [&pair[0], &pair[1]];
    let pairs = densities(gpu, layers, &queries(&mut random(40), layers, QUERIES));
    compare("NDF maps, scratches", pairs.into_iter());
}

#[test]
fn one_place_is_what_the_definition_shows_there() {
    let Some(gpu) = gpu() else { return };
    let mut densities = Vec::new();
    for (k, pair) in samples().iter().enumerate() {
        let layers = [&pair[0], &pair[1]];
        let references = layers.map(|sample| SurfaceReference::new(&sample.map, &sample.material));
        let queries = queries(&mut random(10 + k as u64), layers, 2600);
        for (query, answer) in queries.iter().zip(ask(gpu, layers, &queries)) {
            let sample = layers[query.layer as usize];
            let shown = references[query.layer as usize].shown_at(query.mean.as_dvec2());
            let density = |(class, local, part): &(usize, DVec2, f64)| {
                *part as f32 * sample.material.point(*class as u32, local.as_vec2(), query.s)
            };
            let unit = std::f32::consts::TAU * sample.roughness().powi(2);
            densities.push((answer.at_point * unit, shown.iter().map(density).sum::<f32>() * unit));
        }
    }
    compare("NDF maps, one place", densities.into_iter());
}

/// Draws from a footprint's Gaussian.
fn places(rng: &mut Pcg64, footprint: &Footprint, count: usize) -> Vec<DVec2> {
    let (minor, major, axis) = footprint.principal();
    let place = |_| {
        let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
        let unit = DVec2::from_angle(rng.random::<f64>() * std::f64::consts::TAU) * radius;
        footprint.mean + axis * (unit.x * major) + axis.perp() * (unit.y * minor)
    };
    (0..count).map(place).collect()
}

#[test]
fn the_density_is_the_mean_of_its_places() {
    const PLACES: usize = 6000;
    const NORMALS: usize = 6;
    let Some(gpu) = gpu() else { return };
    let rng = &mut random(20);
    let accurate = SETTINGS[1];
    for pair in &samples()[..2] {
        let layers = [&pair[0], &pair[1]];
        let footprints = [(0.3, 2.0), (3.0, 4.0), (30.0, 1.5)]
            .map(|(sigma, anisotropy)| Footprint::new(DVec2::new(77.3, -40.1), sigma, anisotropy, 0.6));
        let cases: Vec<(usize, Footprint)> = footprints.into_iter().flat_map(|f| [(0, f), (1, f)]).collect();
        let mut queries = Vec::new();
        for (layer, footprint) in &cases {
            let normals: Vec<Vec2> = (0..NORMALS).map(|_| layers[*layer].normal(rng)).collect();
            queries.extend(normals.iter().map(|s| Query::new(footprint, *s, accurate, *layer as u32)));
            for mean in places(rng, footprint, PLACES) {
                let place = Footprint { mean, covariance: DMat2::ZERO };
                queries.extend(normals.iter().map(|s| Query::new(&place, *s, SETTINGS[0], *layer as u32)));
            }
        }
        let answers = ask(gpu, layers, &queries);
        for ((layer, footprint), answers) in cases.iter().zip(answers.chunks_exact(NORMALS * (PLACES + 1))) {
            let density: f32 = answers[..NORMALS].iter().map(|answer| answer.density).sum();
            let sums = answers[NORMALS..].chunks_exact(NORMALS);
            let values: Vec<f32> = sums.map(|chunk| chunk.iter().map(|answer| answer.at_point).sum()).collect();
            let mean = values.iter().sum::<f32>() / PLACES as f32;
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / PLACES as f32;
            let noise = 4.0 * (variance / PLACES as f32).sqrt();
            println!("layer {layer}: {density:.3}, mean of places {mean:.3} ± {noise:.3}");
            assert!((density - mean).abs() < noise + 0.05 * mean, "layer {layer} under {footprint:?}");
        }
    }
}

#[test]
fn hard_maps_and_footprints_have_finite_answers() {
    let Some(gpu) = gpu() else { return };
    let repeat = |width: u32, height: u32, normal: fn(u32, u32) -> [f32; 2]| {
        let projected = (0..width * height).map(|k| normal(k % width, k / width)).collect();
        NormalMap { width, height, wrap: Wrap::Repeat, projected }
    };
    let maps = [
        repeat(8, 8, |_, _| [0.1, -0.2]),
        repeat(1, 1, |_, _| [0.0, 0.0]),
        repeat(1, 6, |_, j| [0.0, 0.1 * j as f32 - 0.3]),
        repeat(8, 8, |i, j| if (i + j) % 2 == 0 { [0.9, 0.0] } else { [-0.9, 0.0] }),
        repeat(4, 4, |i, _| if i % 2 == 0 { [0.9999, 0.0] } else { [0.0, -0.9999] }),
    ];
    let rng = &mut random(30);
    let mut count = 0;
    for map in maps {
        let maps = options(0.05, 0.7);
        let sample = |placement| Sample::new(map.clone(), maps.clone(), placement);
        let pair = [sample(tiled(0.0, 1.0, 0.0)), sample(stochastic(8, 4, 1.0, 2))];
        let mut queries = Vec::new();
        for (sigma, anisotropy) in
            [(0.0, 1.0), (0.01, 1.0), (1e-3, 1e6), (0.3, 8.0), (1.0, 1000.0), (3.0, 1.0), (1e4, 1.0), (1e4, 1000.0)]
        {
            // On a corner shared by wrap seam and patch seam, off it, and far out.
            for mean in [DVec2::ZERO, DVec2::new(5.3, -1000.7), DVec2::new(-1e8, 1e12)] {
                let footprint = Footprint::new(mean, sigma, anisotropy, 0.7);
                for k in 0..40 {
                    let near = pair[k % 2].normal(rng);
                    let s = [near, direction(rng), Vec2::ZERO, direction(rng) * 2.0][k / 2 % 4];
                    queries.push(Query::new(&footprint, s, SETTINGS[k / 8 % SETTINGS.len()], k as u32 % 2));
                }
            }
        }
        for (query, answer) in queries.iter().zip(ask(gpu, [&pair[0], &pair[1]], &queries)) {
            let fine = answer.density.is_finite() && answer.density >= 0.0 && answer.at_point.is_finite();
            assert!(fine && answer.terms < 8192.0, "{answer:?} under {query:?}");
            count += usize::from(answer.density > 0.0);
        }
    }
    println!("{count} answers are not zero");
    assert!(count > 1000);
}

#[test]
fn a_material_comes_back_from_its_sections() {
    for pair in samples() {
        let pack = pack([&pair[0], &pair[1]]);
        for (name, sample) in ["base", "coat"].into_iter().zip(&pair) {
            let (found, expected) = (from_pack(&pack, name).unwrap(), &sample.material);
            assert_eq!(found.maps.params, expected.maps.params);
            assert_eq!(found.maps.nodes, expected.maps.nodes);
            assert_eq!((found.maps.atlas_size, &found.maps.atlas), (expected.maps.atlas_size, &expected.maps.atlas));
            assert_eq!(found.maps.normals, expected.maps.normals);
            assert_eq!(found.placement.params, expected.placement.params);
            assert_eq!(found.placement.palette, expected.placement.palette);
            assert_eq!(found.placement.noise, expected.placement.noise);
            assert_eq!(found.placement.classes, expected.placement.classes);
        }
    }
}

/// Every section that is bound is on the GPU as it lies in the pack.
#[test]
fn what_is_bound_is_what_the_pack_holds() {
    let Some(gpu) = gpu() else { return };
    for pair in samples() {
        let pack = pack([&pair[0], &pair[1]]);
        let data = bind(gpu, &pack, "base", Some(("coat", "both"))).unwrap();
        let held: usize = data.sections.len();
        let bound = |name: &str| pack.sections().iter().filter(|entry| entry.name == name).count();
        // Two parameter sections a material, one of the layers.
        assert_eq!(held, bound("base") + bound("coat") + bound("both") - 5);
    }
}

#[test]
fn the_uniform_lies_as_the_shader_reads_it() {
    let source = glint_shaders::compose(&["query_ndf_maps"]);
    assert_same_layout!(
        &source,
        "GlintNdfMaterial",
        MaterialUniform,
        size,
        moments,
        levels,
        intrinsic_roughness,
        steps,
        finest_variance,
        palette,
        cells,
        cell_texels,
        palette_records,
        reach_records,
        inv_atlas,
        layer,
        most_texels
    );
    let whole = layout(&source, "NdfMapsData").unwrap();
    assert_eq!(whole.members[1], ("records".into(), size_of::<MaterialUniform>() as u32));
    assert_eq!(whole.size as usize, UNIFORM_BYTES);
}
