//! Area lights: what lies under a footprint, rectangles over its lobes, and GGX for directions.

use crate::support::{QUERIES, compare, gpu, log_uniform, random, real_map};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use glint_bake_core::area_light::baked::{Maps, Tables, decode_tables};
use glint_bake_core::area_light::eval::{Surface, alpha_from_deficit, convolve_alpha, fetch, surface_radiance};
use glint_bake_core::area_light::rect::{RectLight, Roughness, tangent_frame};
use glint_bake_core::area_light::reference::brdf_cosine;
use glint_bake_core::area_light::{AreaLightMaterial, AreaLightOptions, bake, sections};
use glint_bake_core::normal_map::{HORIZON, NormalMap};
use glint_bake_core::progress::Silent;
use glint_formats::area_light::{AreaLightUniform, BINDINGS, NormalStorage};
use glint_formats::{Codec, Wrap};
use glint_shaders::assert_same_layout;
use glint_view::gpu::{Gpu, Resources, answer, bind_sections};
use rand::{Rng, RngExt};
use std::f32::consts::{PI, TAU};

/// `AreaLightQuery` of query_area_light.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Query {
    corners: [[f32; 4]; 4],
    view: Vec3,
    base_alpha: f32,
    f0: Vec3,
    footprint_texels: f32,
    radiance: Vec3,
    two_sided: u32,
    light: Vec3,
    lobes: u32,
    position: Vec2,
    deficit: f32,
    unused: u32,
}

/// `AreaLightAnswer`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Answer {
    radiance: Vec3,
    alpha_from_deficit: f32,
    reflected: Vec3,
    size: f32,
    normal: Vec3,
    alpha: f32,
    major: f32,
    minor: f32,
    axis: Vec2,
}

fn between(rng: &mut impl Rng, low: f32, high: f32) -> f32 {
    low + (high - low) * rng.random::<f32>()
}

fn direction(theta: f32, phi: f32) -> Vec3 {
    Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// Anywhere on the sphere.
fn anywhere(rng: &mut impl Rng) -> Vec3 {
    direction(between(rng, -1.0, 1.0).acos(), TAU * rng.random::<f32>())
}

/// A rectangle whose middle is near `towards`: large and small, near and far, turned any way, some through the horizon.
fn rectangle(rng: &mut impl Rng, towards: Vec3, spread: f32) -> [Vec3; 4] {
    let distance = log_uniform(rng, 0.2, 50.0);
    let (t, b) = tangent_frame(towards);
    let turn = Vec2::from_angle(TAU * rng.random::<f32>()) * (2.0 * spread * rng.random::<f32>());
    let centre = (towards + t * turn.x + b * turn.y).normalize() * distance;
    let facing = if rng.random::<f32>() < 0.8 { -centre + 0.7 * distance * anywhere(rng) } else { anywhere(rng) };
    let (x, y) = tangent_frame(facing.normalize());
    let axis = Vec2::from_angle(TAU * rng.random::<f32>());
    let half = log_uniform(rng, 0.02, 2.0) * distance;
    let u = (x * axis.x + y * axis.y) * half;
    let v = (y * axis.x - x * axis.y) * half * log_uniform(rng, 0.1, 1.0);
    [centre - u - v, centre + u - v, centre + u + v, centre - u + v]
}

fn query(rng: &mut impl Rng, maps: &Maps<'_>, size: Vec2) -> (Query, Surface) {
    let position = Vec2::new(between(rng, -2.0, 3.0), between(rng, -2.0, 3.0)) * size;
    let footprint_texels = log_uniform(rng, 0.1, 1000.0);
    let surface = fetch(maps, position, footprint_texels);
    let base_alpha = log_uniform(rng, 1e-3, 1.0);
    let theta = if rng.random::<f32>() < 0.1 { between(rng, 1.4, 1.65) } else { between(rng, 0.0, 1.4) };
    let view = direction(theta, TAU * rng.random::<f32>());
    let spread = convolve_alpha(base_alpha, surface.alpha);
    let mirror = |normal: Vec3| normal * (2.0 * normal.dot(view)) - view;
    let corners = rectangle(rng, mirror(surface.normal), spread);
    let (t, b) = tangent_frame(surface.normal);
    let tilt = Vec2::from_angle(TAU * rng.random::<f32>()) * (2.0 * spread * rng.random::<f32>());
    let facet = (surface.normal + t * tilt.x + b * tilt.y).normalize();
    let radiance = Vec3::new(between(rng, 0.1, 9.0), between(rng, 0.1, 9.0), between(rng, 0.1, 9.0));
    let query = Query {
        corners: corners.map(|corner| corner.extend(0.0).to_array()),
        view,
        base_alpha,
        f0: Vec3::new(rng.random(), rng.random(), rng.random()),
        footprint_texels,
        radiance,
        two_sided: u32::from(rng.random::<f32>() < 0.3),
        light: mirror(facet),
        lobes: if rng.random() { 0 } else { rng.random_range(0..10) },
        position,
        deficit: log_uniform(rng, 1e-7, 0.5),
        unused: 0,
    };
    (query, surface)
}

/// Radiance by colour, from the CPU.
fn cpu_radiance(tables: &Tables, query: &Query, surface: &Surface) -> Vec3 {
    let corners = query.corners.map(|[x, y, z, _]| Vec3::new(x, y, z));
    let shade = |c: usize| {
        let light = RectLight { corners, radiance: query.radiance[c], two_sided: query.two_sided != 0 };
        surface_radiance(tables, surface, query.base_alpha, query.view, query.f0[c], &light, query.lobes)
    };
    Vec3::new(shade(0), shade(1), shade(2))
}

/// BRDF times cosine for the light that is a direction, by colour, from the definition.
fn cpu_reflected(query: &Query, surface: &Surface) -> Vec3 {
    let alpha = f64::from(convolve_alpha(query.base_alpha, surface.alpha));
    let [normal, view, light] = [surface.normal, query.view, query.light].map(|v| v.as_dvec3());
    let shade = |c: usize| brdf_cosine(normal, view, light, alpha, f64::from(query.f0[c])) as f32;
    Vec3::new(shade(0), shade(1), shade(2))
}

fn upload(gpu: &Gpu, material: &AreaLightMaterial) -> Resources {
    let sections = sections::to_sections("material", material, Codec::None);
    bind_sections(gpu, &sections, BINDINGS, material.params.wrap).unwrap()
}

#[test]
fn uniforms_lie_as_the_shader_reads_them() {
    let source = glint_shaders::compose(&["bind_area_light_sampler"]);
    assert_same_layout!(
        &source,
        "GlintAreaLightMaps",
        AreaLightUniform,
        size,
        mips,
        wrap,
        anisotropic,
        unused_0,
        unused_1,
        unused_2
    );
}

/// Asks both, and compares: radiance as a share of the light's, GGX over its peak, roughness and normals as they are.
fn check(what: &str, gpu: &Gpu, materials: &[AreaLightMaterial]) {
    let rng = &mut random(11);
    let source = glint_shaders::compose(&["query_area_light"]);
    let mut rectangles = Vec::new();
    let mut directions = Vec::new();
    let mut surfaces = Vec::new();
    for material in materials {
        let (maps, tables) = (Maps::new(material), decode_tables(&material.tables));
        let size = Vec2::new(material.params.width as f32, material.params.height as f32);
        let asked: Vec<_> = (0..QUERIES.div_ceil(materials.len())).map(|_| query(rng, &maps, size)).collect();
        let queries: Vec<Query> = asked.iter().map(|(query, _)| *query).collect();
        let answers: Vec<Answer> = answer(gpu, what, &source, &[&upload(gpu, material)], &queries).unwrap();
        for ((query, surface), answer) in asked.iter().zip(&answers) {
            let expected = cpu_radiance(&tables, query, surface);
            let share = answer.radiance / query.radiance;
            rectangles.extend((0..3).map(|c| (share[c], expected[c] / query.radiance[c])));

            let alpha = convolve_alpha(query.base_alpha, surface.alpha);
            let peak = 1.0 / (4.0 * PI * alpha * alpha * surface.normal.dot(query.view).max(1e-3));
            let expected = cpu_reflected(query, surface);
            directions.extend((0..3).map(|c| (answer.reflected[c] / peak, expected[c] / peak)));

            // Opposite axes are the same, and where roughness is the same in all directions any axis is right.
            let by_direction = if query.lobes > 0 { surface.by_direction } else { plain(surface) };
            let doubled = |axis: Vec2, gap: f32| (axis.x * axis.x - axis.y * axis.y) * gap;
            surfaces.extend([
                (answer.normal.x, surface.normal.x),
                (answer.normal.y, surface.normal.y),
                (answer.normal.z, surface.normal.z),
                (answer.size, surface.length),
                (answer.alpha, surface.alpha),
                (answer.major, by_direction.major),
                (answer.minor, by_direction.minor),
                (
                    doubled(answer.axis, answer.major - answer.minor),
                    doubled(by_direction.axis, by_direction.major - by_direction.minor),
                ),
                (answer.alpha_from_deficit, alpha_from_deficit(query.deficit)),
            ]);
        }
    }
    compare(&format!("{what}, rectangles"), rectangles.into_iter());
    compare(&format!("{what}, directions"), directions.into_iter());
    compare(&format!("{what}, surface"), surfaces.into_iter());
}

/// Its roughness by direction where none is asked for.
fn plain(surface: &Surface) -> Roughness {
    Roughness { major: surface.alpha, minor: surface.alpha, axis: Vec2::X }
}

fn baked(map: &NormalMap, anisotropic: bool, storage: NormalStorage) -> AreaLightMaterial {
    let options = AreaLightOptions { anisotropic, storage, ..AreaLightOptions::default() };
    bake(map, &options, &Silent).unwrap()
}

fn map(width: u32, height: u32, wrap: Wrap, normal: impl Fn(u32, u32) -> [f32; 2]) -> NormalMap {
    let projected = (0..width * height).map(|k| normal(k % width, k / width)).collect();
    NormalMap { width, height, wrap, projected }
}

/// Waves and scratches, of any size.
fn waves(width: u32, height: u32, wrap: Wrap, seed: u64) -> NormalMap {
    let rng = &mut random(seed);
    let [a, b, c, d] = std::array::from_fn(|_| TAU * rng.random::<f32>());
    let lines: Vec<f32> = (0..height).map(|_| between(rng, -0.3, 0.3)).collect();
    map(width, height, wrap, |i, j| {
        let (u, v) = (TAU * i as f32 / width as f32, TAU * j as f32 / height as f32);
        [0.2 * (3.0 * u + a).sin() * (2.0 * v + b).cos(), 0.2 * (5.0 * v + c + (u + d).sin()).sin() + lines[j as usize]]
    })
}

#[test]
fn area_lights_of_the_shader_are_those_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let mut materials = Vec::new();
    for (k, (width, height)) in [(128, 64), (37, 21), (64, 64), (1, 33)].into_iter().enumerate() {
        for wrap in [Wrap::Repeat, Wrap::Clamp] {
            for storage in [NormalStorage::F16, NormalStorage::Snorm8] {
                for anisotropic in [false, true] {
                    materials.push(baked(&waves(width, height, wrap, k as u64), anisotropic, storage));
                }
            }
        }
    }
    check("area light", gpu, &materials);
}

#[test]
fn a_real_map_gives_the_same_on_both() {
    let Some(gpu) = gpu() else { return };
    let Some(map) = real_map("normals/technical_fabric_sheencloth_256_rgba.png") else { return };
    check("area light, fabric", gpu, &[baked(&map, true, NormalStorage::F16)]);
}

#[test]
fn hard_cases_are_finite_on_the_gpu_too() {
    let Some(gpu) = gpu() else { return };
    let edge = HORIZON as f32;
    let quads: [[[f32; 3]; 4]; 8] = [
        [[-1.0, -1.0, 2.0], [-1.0, 1.0, 2.0], [1.0, 1.0, 2.0], [1.0, -1.0, 2.0]],
        [[1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, -1.0]],
        [[-1.0, -1.0, -2.0], [-1.0, 1.0, -2.0], [1.0, 1.0, -2.0], [1.0, -1.0, -2.0]],
        [[-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0]],
        [[0.0; 3], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]],
        [[1.0, 0.0, 1.0]; 4],
        [[1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [2.0, 0.0, 2.0], [2.0, 0.0, 2.0]],
        [[1e20, 0.0, 1e20], [1e20, 1e20, 1e20], [0.0, 1e20, 1e20], [0.0, 0.0, 1e20]],
    ];
    let mut queries = Vec::new();
    for position in [Vec2::ZERO, Vec2::new(-0.01, 0.3), Vec2::new(1e9, -1e30), Vec2::new(f32::NAN, f32::INFINITY)] {
        for footprint_texels in [0.0, 0.01, 1.0, 37.5, 1e4, 1e30, f32::INFINITY, f32::NAN, -1.0] {
            for base_alpha in [1e-3, 0.1, 1.0] {
                for theta in [0.0, 0.8, 1.56, 0.5 * PI, 2.0] {
                    for corners in quads {
                        for (lobes, two_sided) in [(0, 1), (3, 0), (9, 1)] {
                            queries.push(Query {
                                corners: corners.map(|[x, y, z]| [x, y, z, 0.0]),
                                view: direction(theta, 1.0 + theta),
                                base_alpha,
                                f0: Vec3::new(0.0, 0.5, 1.0),
                                footprint_texels,
                                radiance: Vec3::ONE,
                                two_sided,
                                light: direction(theta, 2.0),
                                lobes,
                                position,
                                deficit: footprint_texels,
                                unused: 0,
                            });
                        }
                    }
                }
            }
        }
    }
    let maps = [
        map(16, 16, Wrap::Repeat, |_, _| [0.0, 0.0]),
        map(1, 1, Wrap::Repeat, |_, _| [0.1, 0.2]),
        map(1, 33, Wrap::Clamp, |_, y| [0.0, if y == 16 { edge } else { -0.2 }]),
        map(8, 8, Wrap::Repeat, |x, y| if (x + y) % 2 == 0 { [edge, 0.0] } else { [-edge, 0.0] }),
    ];
    let mut bright = 0;
    // By loads, and by samplers as the viewer has it.
    let by_samplers = {
        let library = ["bind_area_light_sampler", "ggx"];
        glint_shaders::compose(&library) + &glint_shaders::text(glint_shaders::module("query_area_light").unwrap())
    };
    for source in [&glint_shaders::compose(&["query_area_light"]), &by_samplers] {
        for map in &maps {
            let data = upload(gpu, &baked(map, true, NormalStorage::F16));
            let answers: Vec<Answer> = answer(gpu, "hard cases", source, &[&data], &queries).unwrap();
            for (query, found) in queries.iter().zip(&answers) {
                let within = |v: f32, most: f32| (0.0..=most).contains(&v);
                assert!(found.radiance.to_array().iter().all(|&v| within(v, 1.02)), "{query:?}: {found:?}");
                assert!(found.reflected.to_array().iter().all(|&v| within(v, 1e12)), "{query:?}: {found:?}");
                assert!((found.normal.length() - 1.0).abs() < 1e-3, "{query:?}: {found:?}");
                assert!(
                    [found.alpha, found.major, found.minor].iter().all(|&v| within(v, 1.0)),
                    "{query:?}: {found:?}"
                );
                assert!(within(found.alpha_from_deficit, 1.0), "{query:?}: {found:?}");
                bright += usize::from(found.radiance.z > 0.1);
            }
        }
    }
    assert!(bright > 1000, "{bright}");
}
