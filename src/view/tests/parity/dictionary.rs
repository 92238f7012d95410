//! Slope distributions of the dictionary.

use crate::support::{QUERIES, compare, gpu, log_uniform, random};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use glint_bake_core::dictionary::eval::{DictionaryMaterial, patch_sdf};
use glint_bake_core::dictionary::{DictionaryOptions, bake, quality, sections};
use glint_bake_core::footprint::PixelOnSurface;
use glint_bake_core::progress::Silent;
use glint_formats::Codec;
use glint_formats::dictionary::DictionaryUniform;
use glint_shaders::assert_same_layout;
use glint_view::gpu::answer;
use glint_view::methods::dictionary::upload_sections;
use rand::{Rng, RngExt};

/// `DictionaryQuery` of query_dictionary.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Query {
    alpha: Vec2,
    slope: Vec2,
    position: Vec2,
    d_dx: Vec2,
    d_dy: Vec2,
    normal_target: u32,
    density: f32,
    relative_area: f32,
    density_randomisation: f32,
    max_anisotropy: f32,
    seed: u32,
    colours: u32,
    /// WGSL aligns the colour to 16 bytes.
    unused: [u32; 3],
    mean_colour: [f32; 4],
}

fn direction(rng: &mut impl Rng) -> Vec2 {
    Vec2::from_angle(rng.random::<f32>() * std::f32::consts::TAU)
}

fn material(rng: &mut impl Rng, palette: &[Vec3]) -> DictionaryMaterial {
    let alpha = log_uniform(rng, 0.01, 1.0);
    let colours = if rng.random() { palette.to_vec() } else { Vec::new() };
    let mean_colour = if colours.is_empty() { Vec3::ONE } else { colours.iter().sum::<Vec3>() / palette.len() as f32 };
    DictionaryMaterial {
        alpha: Vec2::new(alpha, if rng.random() { alpha } else { log_uniform(rng, 0.01, 1.0) }),
        normal_target: u32::from(rng.random::<bool>()),
        density: log_uniform(rng, 1.0, 1e12),
        relative_area: if rng.random() { 1.0 } else { rng.random() },
        density_randomisation: if rng.random() { 0.0 } else { 2.0 * rng.random::<f32>() },
        max_anisotropy: log_uniform(rng, 1.0, 16.0),
        seed: rng.random(),
        colours,
        mean_colour,
    }
}

#[test]
fn uniforms_lie_as_the_shader_reads_them() {
    let source = glint_shaders::compose(&["bind_dictionary"]);
    assert_same_layout!(
        &source,
        "GlintDictionaryTables",
        DictionaryUniform,
        marginals,
        levels,
        entries,
        alpha_dict,
        domain,
        inv_spacing,
        lobe_area,
        unused
    );
}

#[test]
fn the_slope_distribution_of_the_shader_is_that_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let dictionary = bake(&DictionaryOptions::default(), &Silent).unwrap();
    let tables = dictionary.tables();
    let palette = [Vec3::new(1.0, 0.2, 0.1), Vec3::new(0.2, 0.9, 0.3), Vec3::new(0.1, 0.3, 1.2)];
    let cell = (-(tables.levels as f32 - 1.0)).exp2();
    let rng = &mut random(7);
    let mut queries = Vec::new();
    let mut expected = Vec::new();
    for _ in 0..QUERIES {
        let material = material(rng, &palette);
        // Footprints of 0.05 to 500 cells, long ones too, and slopes where the target has mass.
        let size = log_uniform(rng, 0.05, 500.0) * cell;
        let along = direction(rng);
        let pixel = PixelOnSurface {
            position: direction(rng) * log_uniform(rng, 1e-3, 30.0),
            d_dx: along * size,
            d_dy: along.perp() * size * log_uniform(rng, 0.02, 1.0) + along * size * (rng.random::<f32>() - 0.5),
        };
        let slope = direction(rng) * material.alpha * (1.6 * rng.random::<f32>());
        expected.push(patch_sdf(&tables, &material, pixel, slope));
        queries.push(Query {
            alpha: material.alpha,
            slope,
            position: pixel.position,
            d_dx: pixel.d_dx,
            d_dy: pixel.d_dy,
            normal_target: material.normal_target,
            density: material.density,
            relative_area: material.relative_area,
            density_randomisation: material.density_randomisation,
            max_anisotropy: material.max_anisotropy,
            seed: material.seed,
            colours: material.colours.len() as u32,
            unused: [0; 3],
            mean_colour: material.mean_colour.extend(0.0).to_array(),
        });
    }
    let sections = sections::to_sections("dictionary", &dictionary, quality::measure(&dictionary), Codec::None);
    let data = upload_sections(gpu, &sections, &palette).unwrap();
    let source = glint_shaders::compose(&["query_dictionary"]);
    let answers: Vec<[f32; 4]> = answer(gpu, "dictionary", &source, &[&data], &queries).unwrap();
    // Compared in units of the peak of the smooth target, so that 1e-5 is small.
    let unit = |i: usize| std::f32::consts::PI * queries[i].alpha.x * queries[i].alpha.y;
    let pairs = answers.iter().zip(&expected);
    compare(
        "dictionary, sdf",
        pairs.clone().enumerate().flat_map(|(i, (a, e))| (0..3).map(move |c| (a[c] * unit(i), e.sdf[c] * unit(i)))),
    );
    compare("dictionary, coverage", pairs.map(|(a, e)| (a[3], e.coverage)));
}
