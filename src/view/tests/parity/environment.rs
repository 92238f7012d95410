//! Glints under an environment, and the random words of a surface's cells.
//!
//! Look-ups are compared texel by texel (`bind_environment_exact.wgsl`); how far a sampler is from that is a test of its own.
//! Draws flip between neighbouring counts where the random word lies at a step, as `counting.rs` says.

use crate::counting::{MAX_FLIPPED, beside};
use crate::support::{QUERIES, agree, compare, gpu, log_uniform, random, real_file};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use glint_bake_core::counting::eval::{tree_leaves, unit_from_bits};
use glint_bake_core::counting::query::{cell_words, facet_cell, footprint_area, footprint_box, footprint_facets};
use glint_bake_core::environment::eval::{Surface, chances, environment_glints};
use glint_bake_core::environment::image::direction as direction_at;
use glint_bake_core::environment::options::LevelCount;
use glint_bake_core::environment::sections::to_sections;
use glint_bake_core::environment::{Environment, EnvironmentImage, EnvironmentOptions, bake};
use glint_bake_core::progress::Silent;
use glint_formats::binding::{Binding, View};
use glint_formats::environment::{
    ALBEDO, BINDINGS, COLOURS, EnvironmentUniform, INDICATORS, MAX_LEVELS, MIRROR, RADIANCE, UNIFORM,
};
use glint_formats::{Codec, Wrap};
use glint_shaders::assert_same_layout;
use glint_view::gpu::{Gpu, ResourceSet, answer, bind_sections};
use glint_view::methods::environment::empty;
use rand::{Rng, RngExt};
use std::f64::consts::PI;

/// The bind group of `bind_environment_exact.wgsl`.
const EXACT_BINDINGS: &[Binding] = &[
    Binding::Uniform(UNIFORM),
    Binding::Texture(MIRROR, View::Float2dArray),
    Binding::Texture(RADIANCE, View::Float2dArray),
    Binding::Texture(INDICATORS, View::Float2dArray),
    Binding::Texture(COLOURS, View::Float2dArray),
    Binding::Texture(ALBEDO, View::Float2dArray),
];

/// How shaders look directions up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LookUp {
    /// By a sampler.
    Sampler,
    /// Texel by texel.
    Exact,
}

/// `EnvironmentQuery` of query_environment.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Query {
    normal: Vec3,
    alpha: f32,
    view: Vec3,
    f0: f32,
    density: f32,
    seed: u32,
    position: Vec2,
    d_dx: Vec2,
    d_dy: Vec2,
    words: [f32; MAX_LEVELS],
    own_words: u32,
    facets: f32,
    unused: [u32; 2],
}

/// `EnvironmentAnswer`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Answer {
    smooth: [f32; 3],
    std_factor: f32,
    glints: [f32; 3],
    facets: f32,
    moments: [f32; 2],
    lod: f32,
    unused: u32,
    p: [f32; MAX_LEVELS],
    words: [f32; MAX_LEVELS],
}

impl Query {
    fn surface(&self, facets: f32) -> Surface {
        Surface { normal: self.normal, view: self.view, alpha: self.alpha, f0: self.f0, facets }
    }
}

/// A sky with a gradient and lamps in it, `bright` times as bright.
fn image(bright: f32) -> EnvironmentImage {
    const HEIGHT: u32 = 32;
    let mut pixels = Vec::new();
    for y in 0..HEIGHT {
        for x in 0..2 * HEIGHT {
            let longitude = PI * ((f64::from(x) + 0.5) / f64::from(HEIGHT) - 1.0);
            let d = direction_at(longitude, (PI * (0.5 - (f64::from(y) + 0.5) / f64::from(HEIGHT))).sin());
            let lit = (9.0 * d.x).sin() * (7.0 * d.z).cos() > 0.85;
            let sky = [0.3 + 0.2 * d.y as f32, 0.3 + 0.1 * d.x as f32, 0.4];
            pixels.push(if lit { [bright, 0.8 * bright, 0.4 * bright] } else { sky });
        }
    }
    EnvironmentImage::new(2 * HEIGHT, HEIGHT, pixels).unwrap()
}

fn baked(image: &EnvironmentImage, face_size: u32, levels: u32, coloured: bool) -> Environment {
    baked_to(1, image, face_size, levels, coloured, 1)
}

fn baked_to(
    min_face_size: u32,
    image: &EnvironmentImage,
    face_size: u32,
    levels: u32,
    coloured: bool,
    look_ups: u32,
) -> Environment {
    let options = EnvironmentOptions {
        face_size,
        min_face_size,
        per_size: 2,
        look_ups,
        levels: LevelCount::Exactly(levels),
        coloured,
        measured_reads: 0,
        filter_error: 0.02,
        ..EnvironmentOptions::default()
    };
    bake(image, &options, &Silent).unwrap()
}

fn sphere(rng: &mut impl Rng) -> Vec3 {
    direction_at(2.0 * PI * rng.random::<f64>(), 2.0 * rng.random::<f64>() - 1.0).as_vec3()
}

/// All angles, roughnesses and numbers of facets; footprints of 0.05 to 500 thousandths of a unit, up to 50 times as long as wide.
fn query(rng: &mut impl Rng) -> Query {
    let normal = sphere(rng);
    let (across, cosine) = (normal.cross(sphere(rng)).normalize(), rng.random::<f32>());
    let size = log_uniform(rng, 0.05, 500.0) * 1e-3;
    let along = Vec2::from_angle(rng.random::<f32>() * std::f32::consts::TAU);
    let facets = log_uniform(rng, 0.01, 1e9);
    Query {
        normal,
        alpha: rng.random::<f32>().powi(2),
        view: normal * cosine + across * (1.0 - cosine * cosine).sqrt(),
        f0: rng.random(),
        density: facets / (size * size),
        seed: rng.random(),
        position: Vec2::from_angle(rng.random::<f32>() * std::f32::consts::TAU) * log_uniform(rng, 1e-3, 30.0),
        d_dx: along * size,
        d_dy: along.perp() * size * log_uniform(rng, 0.02, 1.0) + along * size * (rng.random::<f32>() - 0.5),
        words: std::array::from_fn(|_| unit_from_bits(rng.random())),
        own_words: u32::from(rng.random::<bool>()),
        facets,
        unused: [0; 2],
    }
}

fn ask(gpu: &Gpu, environment: &Environment, look_up: LookUp, queries: &[Query]) -> Vec<Answer> {
    let (bind, bindings) = match look_up {
        LookUp::Sampler => ("bind_environment", BINDINGS),
        LookUp::Exact => ("bind_environment_exact", EXACT_BINDINGS),
    };
    let source = glint_shaders::compose(&["query_environment", bind]);
    let data = bind_sections(gpu, &to_sections("sky", environment, Codec::None), bindings, Wrap::Clamp).unwrap();
    answer(gpu, "environment", &source, &[&ResourceSet::default().finish(gpu), &data], queries).unwrap()
}

/// What is compared of one answer.
#[derive(Default)]
struct Pairs {
    smooth: Vec<(f32, f32)>,
    p: Vec<(f32, f32)>,
    variance: Vec<(f32, f32)>,
    glints: Vec<(f32, f32)>,
    words: Vec<(f32, f32)>,
    small_words: Vec<(f32, f32)>,
    flipped: usize,
    elsewhere: usize,
}

/// Twin's radiance for these words and, where the shader's is another, for words beside them.
fn glints_beside(environment: &Environment, surface: &Surface, words: &[f32; MAX_LEVELS], found: [f32; 3]) -> bool {
    let leaves = tree_leaves(environment.params.levels.len().max(2));
    (0..leaves).any(|node| {
        beside(words[node]).into_iter().any(|word| {
            let mut words = *words;
            words[node] = word;
            let expected = environment_glints(environment, surface, &words);
            (0..3).all(|c| agree(found[c], expected[c]))
        })
    })
}

fn hold(environment: &Environment, queries: &[Query], answers: &[Answer], pairs: &mut Pairs) {
    let levels = environment.params.levels.len();
    let leaves = tree_leaves(levels.max(2));
    for (query, answer) in queries.iter().zip(answers) {
        let area = footprint_area(query.d_dx, query.d_dy);
        let footprint = footprint_box(query.d_dx, query.d_dy);
        let facets = if query.own_words != 0 { footprint_facets(area, query.density) } else { query.facets };
        let surface = query.surface(facets);
        let chances = chances(environment, &surface);
        pairs.smooth.extend(answer.smooth.into_iter().zip(chances.smooth_radiance));
        pairs.p.extend(answer.p[..levels].iter().copied().zip(chances.p));
        let variance =
            |std_factor: f32, [mean, square]: [f32; 2]| std_factor * std_factor * (square / (mean * mean) - 1.0);
        pairs
            .variance
            .push((variance(answer.std_factor, answer.moments), variance(chances.std_factor, chances.moments)));
        if query.own_words != 0 {
            let words = cell_words(facet_cell(footprint, query.position, query.seed), leaves);
            // A cell is a step function of the place.
            if !(0..leaves).all(|i| agree(answer.words[i], words[i])) {
                pairs.elsewhere += 1;
                continue;
            }
            for i in 0..leaves {
                pairs.words.push((answer.words[i], words[i]));
                // Rare ones by their size: a word is as rare as it is small.
                pairs.small_words.push((answer.words[i].max(1e-8).log10(), words[i].max(1e-8).log10()));
            }
            assert!(agree(answer.facets, facets) && agree(answer.lod, footprint.lod), "{query:?} {answer:?}");
        }
        // With the shader's own words, so that differences do not pile up.
        let surface = query.surface(answer.facets);
        let expected = environment_glints(environment, &surface, &answer.words);
        let same = (0..3).all(|c| agree(answer.glints[c], expected[c]));
        if same {
            pairs.glints.extend(answer.glints.into_iter().zip(expected));
        } else {
            pairs.flipped += 1;
            let other = glints_beside(environment, &surface, &answer.words, answer.glints);
            assert!(other, "{levels} levels, {query:?}: {:?}, expected {expected:?}", answer.glints);
        }
    }
}

fn finish(what: &str, pairs: Pairs, queries: usize) {
    println!("{what}: {} of {queries} draws on the other side of a step", pairs.flipped);
    assert!(pairs.flipped as f64 <= MAX_FLIPPED * queries as f64, "{} flipped", pairs.flipped);
    assert!(pairs.elsewhere as f64 <= MAX_FLIPPED * queries as f64, "{} in other cells", pairs.elsewhere);
    compare(&format!("{what}, smooth"), pairs.smooth.into_iter());
    compare(&format!("{what}, probabilities"), pairs.p.into_iter());
    compare(&format!("{what}, relative variance of a facet"), pairs.variance.into_iter());
    compare(&format!("{what}, glints"), pairs.glints.into_iter());
    compare(&format!("{what}, words"), pairs.words.into_iter());
    compare(&format!("{what}, size of words"), pairs.small_words.into_iter());
}

#[test]
fn glints_of_the_shader_are_those_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let rng = &mut random(31);
    let mut pairs = Pairs::default();
    let mut count = 0;
    for (levels, coloured, face_size, look_ups) in [
        (1, false, 16, 3),
        (2, true, 8, 1),
        (3, false, 16, 2),
        (4, false, 32, 1),
        (5, true, 8, 3),
        (8, false, 16, 2),
        (11, true, 8, 1),
        (16, false, 16, 3),
    ] {
        let environment = baked_to(1, &image(30.0), face_size, levels, coloured, look_ups);
        let queries: Vec<Query> = (0..QUERIES / 4).map(|_| query(rng)).collect();
        hold(&environment, &queries, &ask(gpu, &environment, LookUp::Exact, &queries), &mut pairs);
        count += queries.len();
    }
    finish("environment", pairs, count);
}

#[test]
fn a_real_environment_agrees_too() {
    let Some(gpu) = gpu() else { return };
    let Some(path) = real_file("hdri/dancing_hall_1k.hdr") else { return };
    let pixels = image::open(path).unwrap();
    let pixels = pixels.into_rgb32f();
    let (width, height) = pixels.dimensions();
    let image = EnvironmentImage::new(width, height, pixels.pixels().map(|pixel| pixel.0).collect()).unwrap();
    let environment = baked_to(1, &image, 32, 8, false, 3);
    let rng = &mut random(32);
    let queries: Vec<Query> = (0..QUERIES).map(|_| query(rng)).collect();
    let mut pairs = Pairs::default();
    hold(&environment, &queries, &ask(gpu, &environment, LookUp::Exact, &queries), &mut pairs);
    finish("dancing hall", pairs, queries.len());
}

/// A sampler filters with weights of 8 bits or more, off by up to 1/512 of the difference of two texels in each of three
/// directions, and has its own rule at the corners of a cube. Filtered faces are 32 to 8 texels.
#[test]
fn a_sampler_reads_what_is_read_texel_by_texel() {
    let Some(gpu) = gpu() else { return };
    let environment = baked_to(8, &image(30.0), 64, 8, false, 3);
    let rng = &mut random(33);
    let queries: Vec<Query> = (0..QUERIES).map(|_| query(rng)).collect();
    let exact = ask(gpu, &environment, LookUp::Exact, &queries);
    let sampled = ask(gpu, &environment, LookUp::Sampler, &queries);
    let (mut worst, mut sum, mut shares, mut apart) = (0.0f32, 0.0, 0.0f32, 0);
    for (exact, sampled) in exact.iter().zip(&sampled) {
        let off = (sampled.smooth[1] - exact.smooth[1]).abs() / exact.smooth[1];
        worst = worst.max(off);
        sum += f64::from(off);
        apart += usize::from(off > 1e-3);
        shares = (0..8).map(|k| (sampled.p[k] - exact.p[k]).abs()).fold(shares, f32::max);
    }
    let mean = sum / queries.len() as f64;
    println!(
        "sampler against texels: smooth light mean {mean:.1e}, worst {worst:.1e}, {apart} of {} apart by \
             more than 1e-3; probabilities worst {shares:.1e}",
        queries.len()
    );
    assert!(mean < 2e-3 && worst < 0.05 && shares < 0.02, "{mean} {worst} {shares}");
}

#[test]
fn the_uniform_lies_as_the_shader_reads_it() {
    let source = glint_shaders::compose(&["query_environment", "bind_environment"]);
    assert_same_layout!(
        &source,
        "GlintEnvironment",
        EnvironmentUniform,
        level,
        present,
        levels,
        coloured,
        radiance_scale,
        roughnesses,
        per_size,
        first_alpha,
        inverse_log,
        bend,
        look_ups
    );
}

/// White furnace: the mean of glints over 1024 seeds is the smooth reflection.
#[test]
fn the_mean_of_1024_seeds_is_the_smooth_reflection() {
    const SEEDS: u32 = 1024;
    let Some(gpu) = gpu() else { return };
    for (levels, coloured, look_ups) in [(1, false, 1), (4, false, 3), (8, false, 1), (4, true, 2)] {
        let environment = baked_to(1, &image(3.0), 16, levels, coloured, look_ups);
        let rng = &mut random(35);
        // Points enough that the mean is known to a third of a per cent.
        let lots = [(2.5, 192), (30.0, 64), (3000.0, 16)];
        let mut queries = Vec::new();
        for (facets, points) in lots {
            for _ in 0..points {
                let mut point = query(rng);
                let edge = point.d_dx.length();
                (point.d_dx, point.d_dy) = (Vec2::new(edge, 0.0), Vec2::new(0.0, edge));
                point.density = facets / (edge * edge);
                point.own_words = 1;
                for seed in 0..SEEDS {
                    point.seed = seed;
                    queries.push(point);
                }
            }
        }
        let answers = ask(gpu, &environment, LookUp::Sampler, &queries);
        let mut rest = answers.as_slice();
        for (facets, points) in lots {
            let (lot, after) = rest.split_at(points * SEEDS as usize);
            rest = after;
            // Each point counts the same, bright or not.
            let ratios = lot.iter().map(|a| f64::from(a.glints[1] / a.smooth[1]));
            let count = lot.len() as f64;
            let (sum, square) = ratios.fold((0.0, 0.0), |(sum, square), r| (sum + r, square + r * r));
            let mean = sum / count;
            let noise = ((square / count - mean * mean) / count).sqrt();
            println!(
                "{levels} levels, coloured {coloured}, {facets} facets: {mean:.4} of smooth, standard error {noise:.4}"
            );
            assert!(noise < 1.0 / 300.0, "{noise}: too few points to tell");
            assert!((mean - 1.0).abs() < 0.01, "{levels} levels, {facets} facets: {mean} of the smooth reflection");
        }
    }
}

#[test]
fn hard_cases_stay_finite() {
    let Some(gpu) = gpu() else { return };
    let rng = &mut random(36);
    let mut queries = Vec::new();
    for k in 0..4096 {
        let mut hard = query(rng);
        hard.own_words = 1;
        match k % 10 {
            0 => hard.d_dx = Vec2::ZERO,
            1 => hard.d_dy = hard.d_dx,
            2 => hard.density = 0.0,
            3 => hard.density = 1e30,
            4 => hard.view = hard.normal,
            5 => hard.view = hard.normal.any_orthonormal_vector(),
            6 => hard.alpha = [0.0, 1.0, 1e-6][k % 3],
            7 => hard.position = Vec2::splat(1e30),
            8 => hard.normal = Vec3::Y,
            _ => (hard.d_dx, hard.d_dy) = (hard.d_dx * 1e20, hard.d_dy * 1e20),
        }
        if hard.view.dot(hard.normal) < 0.0 {
            hard.view = -hard.view;
        }
        queries.push(hard);
    }
    let black = EnvironmentImage::new(8, 4, vec![[0.0; 3]; 32]).unwrap();
    let sun = {
        let mut pixels = vec![[0.1; 3]; 32 * 64];
        pixels[700] = [1e6; 3];
        EnvironmentImage::new(64, 32, pixels).unwrap()
    };
    for (image, levels) in [(&black, 1), (&black, 4), (&image(30.0), 16), (&sun, 4)] {
        let environment = baked(image, 8, levels, false);
        for answer in ask(gpu, &environment, LookUp::Sampler, &queries) {
            let finite = answer.glints.iter().chain(&answer.smooth).all(|v| v.is_finite() && *v >= 0.0);
            assert!(finite, "{levels} levels: {answer:?}");
        }
    }
    let source = glint_shaders::compose(&["query_environment", "bind_environment"]);
    let none = ResourceSet::default().finish(gpu);
    let answers: Vec<Answer> = answer(gpu, "environment", &source, &[&none, &empty(gpu).unwrap()], &queries).unwrap();
    assert!(answers.iter().all(|answer| answer.glints == [0.0; 3]), "no environment, no light");
}
