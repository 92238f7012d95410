//! A small pack of each method, and what its example answers by the bake's own run time. Materials are those of `example_<method>.wgsl`.

use super::pixel::{Answer, Pixel};
use crate::exit::{Exit, Failure};
use glam::{DMat2, DVec2, Vec2, Vec3};
use glint_bake_core::brdf::{facet_brdf, half_vector};
use glint_bake_core::footprint::{Footprint, ShaderFootprint, footprint_of_pixel};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::{
    area_light, counting, dictionary, environment, glints, lobes, microfacet, moments, ndf_maps, surface, synthesis,
};
use glint_formats::{Codec, Section, Wrap};
use std::f32::consts::TAU;

/// Texels of a map on one unit, `texels_per_unit` of the examples.
const TEXELS_PER_UNIT: f32 = 8.0;
/// Those of `glint_map_defaults`.
const PIXEL_SIGMA: f32 = 0.5;
const INTRINSIC_ROUGHNESS: f32 = 0.02;
const ALUMINIUM: Vec3 = Vec3::new(0.91, 0.92, 0.92);
const GOLD: Vec3 = Vec3::new(1.0, 0.78, 0.34);

/// A method's data, and its answers.
pub struct Case {
    /// What its pack holds.
    pub sections: Vec<Section>,
    /// The answer for a pixel.
    pub answer: Box<dyn Fn(&Pixel) -> Answer>,
}

/// The case of a method.
pub fn case(method: &str) -> Result<Case, Failure> {
    match method {
        "dictionary" => dictionary_case(),
        "ndf_maps" => ndf_maps_case(),
        "lobes" => lobes_case(),
        "surface" => surface_case(),
        "glints" => glints_case(),
        "area_light" => area_light_case(),
        "environment" => environment_case(),
        _ => Err(Failure::new(Exit::Unexpected, format!("there are no vectors of {method}; please report this"))),
    }
}

fn dictionary_case() -> Result<Case, Failure> {
    let options = dictionary::DictionaryOptions { marginals: 24, levels: 10, ..Default::default() };
    let baked = dictionary::bake(&options, &Silent)?;
    let tables = baked.tables();
    let sections =
        dictionary::sections::to_sections("dictionary", &baked, dictionary::quality::measure(&baked), Codec::None);
    let material = dictionary::eval::DictionaryMaterial {
        alpha: Vec2::splat(0.3),
        normal_target: dictionary::eval::TARGET_GGX,
        density: 1e6,
        relative_area: 1.0,
        density_randomisation: 0.0,
        max_anisotropy: 8.0,
        seed: 0,
        colours: Vec::new(),
        mean_colour: Vec3::ONE,
    };
    let smooth = microfacet::SmoothSurface { alpha2: Vec2::splat(0.09), normal_target: microfacet::GGX };
    let answer = move |pixel: &Pixel| {
        let (view, light) = (pixel.view(), pixel.light());
        let normal = microfacet::mirror_normal(smooth, view, Vec2::new(pixel.random().x, pixel.random().y));
        Answer {
            brdf: dictionary::eval::patch_brdf(&tables, &material, GOLD, pixel.on_surface(), view, light).value.into(),
            pdf: microfacet::mirror_pdf(smooth, view, light),
            sampled: (normal * (2.0 * view.dot(normal)) - view).into(),
            ..Answer::default()
        }
    };
    Ok(Case { sections, answer: Box::new(answer) })
}

/// Waves across each other, a repeating map.
fn waves(size: u32) -> NormalMap {
    let texel = |at: u32| {
        let (x, y) = ((at % size) as f32 / size as f32, (at / size) as f32 / size as f32);
        let wave = |k: f32| (TAU * k).sin();
        [0.2 * wave(2.0 * x + y), 0.15 * wave(3.0 * y - 2.0 * x) * wave(3.0 * x)]
    };
    NormalMap { width: size, height: size, wrap: Wrap::Repeat, projected: (0..size * size).map(texel).collect() }
}

/// The pixel's footprint on a map, as the shader has it.
fn footprint(pixel: &Pixel) -> Footprint {
    let on = pixel.on_surface();
    let ShaderFootprint { mean, xx, xy, yy } = footprint_of_pixel(
        on.position * TEXELS_PER_UNIT,
        on.d_dx * TEXELS_PER_UNIT,
        on.d_dy * TEXELS_PER_UNIT,
        PIXEL_SIGMA,
    );
    let [xx, xy, yy] = [xx, xy, yy].map(f64::from);
    Footprint { mean: mean.as_dvec2(), covariance: DMat2::from_cols(DVec2::new(xx, xy), DVec2::new(xy, yy)) }
}

/// The projected normal that a pixel asks for.
fn projected(pixel: &Pixel) -> Vec2 {
    half_vector(pixel.view(), pixel.light()).truncate()
}

fn map_brdf(density: f32, pixel: &Pixel) -> [f32; 3] {
    facet_brdf(Vec3::splat(density), ALUMINIUM, pixel.view(), pixel.light()).into()
}

fn ndf_maps_case() -> Result<Case, Failure> {
    let placement = ndf_maps::options::PlacementOptions::Stochastic(Default::default());
    let options = ndf_maps::options::Options { maps: Default::default(), placement };
    let material = ndf_maps::bake::bake(&waves(16), &options, &Silent)?;
    let sections = ndf_maps::sections::to_sections("waves", &material, Codec::None);
    let answer = move |pixel: &Pixel| {
        let settings = ndf_maps::eval::EvalSettings::REAL_TIME;
        let footprint = footprint(pixel);
        let terms = material.gather(&footprint, settings);
        let seen = material.moments(&footprint, settings);
        Answer {
            brdf: map_brdf(material.density(&terms, projected(pixel)), pixel),
            pdf: moments::moments_pdf(seen, pixel.view(), pixel.light()),
            sampled: moments::moments_sample(seen, pixel.view(), pixel.random()).into(),
            ..Answer::default()
        }
    };
    Ok(Case { sections, answer: Box::new(answer) })
}

fn lobes_case() -> Result<Case, Failure> {
    let baked = lobes::bake(&waves(32), &lobes::LobesOptions { footprints: 0, ..Default::default() }, &Silent)?;
    let sections = lobes::sections::to_sections("waves", &baked, Codec::None);
    let answer = move |pixel: &Pixel| {
        let settings = lobes::query::QuerySettings::realtime();
        let density = baked.p_ndf(&footprint(pixel), projected(pixel), INTRINSIC_ROUGHNESS, &settings);
        Answer { brdf: map_brdf(density, pixel), ..Answer::default() }
    };
    Ok(Case { sections, answer: Box::new(answer) })
}

fn surface_case() -> Result<Case, Failure> {
    let target = synthesis::Target::Patches { width: 256, height: 256 };
    let options = surface::SurfaceOptions {
        lobes: lobes::LobesOptions { footprints: 0, ..Default::default() },
        synthesis: synthesis::SynthesisOptions { target, patch: 32, overlap: 4, alignment: 8, ..Default::default() },
    };
    let baked = surface::bake(&waves(64), &options, &Silent)?;
    let sections = surface::sections::to_sections("waves", &baked, Codec::None);
    let answer = move |pixel: &Pixel| {
        let settings = surface::SurfaceSettings::realtime();
        let density = baked.p_ndf(&footprint(pixel), projected(pixel), INTRINSIC_ROUGHNESS, &settings);
        Answer { brdf: map_brdf(density, pixel), ..Answer::default() }
    };
    Ok(Case { sections, answer: Box::new(answer) })
}

/// `example_window` of the examples.
fn window() -> [Vec3; 4] {
    [(-0.5, -1.0), (-0.5, 1.0), (0.5, 1.0), (0.5, -1.0)].map(|(x, y)| Vec3::new(x, y, 3.0))
}
const WINDOW_RADIANCE: f32 = 5.0;

fn glints_case() -> Result<Case, Failure> {
    let baked = glints::bake(&glints::GlintsOptions::default(), &Silent)?;
    let sections = glints::sections::to_sections("facets", &baked, Codec::None);
    let (tables, material) = (area_light::baked::decode_tables(&baked.tables), baked.material());
    let palette = baked.colours();
    let answer = move |pixel: &Pixel| {
        let (on, view, light) = (pixel.on_surface(), pixel.view(), pixel.light());
        let surface = glints::eval::counted_surface(material, on.position, on.d_dx, on.d_dy, view);
        let one = |light| {
            let none = glints::eval::no_light();
            glints::eval::four_lights(surface, &palette, [light, none, none, none])
        };
        let point = glints::eval::ConeLight { direction: light, irradiance: Vec3::ONE, solid_angle_sr: 0.0 };
        let rect = area_light::rect::RectLight { corners: window(), radiance: WINDOW_RADIANCE, two_sided: true };
        Answer {
            brdf: (one(glints::eval::cone_light(surface, point)) / light.z).into(),
            pdf: glints::sampling::counted_pdf(material, view, light),
            sampled: glints::sampling::counted_sample(material, view, pixel.random()).into(),
            radiance: one(glints::eval::rect_facets(&tables, surface, &rect)).into(),
            ..Answer::default()
        }
    };
    Ok(Case { sections, answer: Box::new(answer) })
}

fn area_light_case() -> Result<Case, Failure> {
    let options = area_light::AreaLightOptions { anisotropic: false, ..Default::default() };
    let material = area_light::bake(&waves(32), &options, &Silent)?;
    let sections = area_light::sections::to_sections("waves", &material, Codec::None);
    let tables = area_light::baked::decode_tables(&material.tables);
    // That of glint_area_light_defaults.
    const BASE_ALPHA: f32 = 0.1;
    let answer = move |pixel: &Pixel| {
        let maps = area_light::baked::Maps::new(&material);
        let (on, view, light) = (pixel.on_surface(), pixel.view(), pixel.light());
        let longer = on.d_dx.length().max(on.d_dy.length()) * TEXELS_PER_UNIT;
        let seen = area_light::eval::fetch(&maps, on.position * TEXELS_PER_UNIT, 2.0 * PIXEL_SIGMA * longer);
        let alpha = area_light::eval::convolve_alpha(BASE_ALPHA, seen.alpha);
        let brdf = |f0: f32| {
            let [normal, view, light] = [seen.normal, view, light].map(|v| v.as_dvec3());
            let cosine = area_light::reference::brdf_cosine(normal, view, light, f64::from(alpha), f64::from(f0));
            cosine as f32 / pixel.light().z
        };
        let rect = area_light::rect::RectLight { corners: window(), radiance: WINDOW_RADIANCE, two_sided: true };
        let radiance = |f0| area_light::eval::surface_radiance(&tables, &seen, BASE_ALPHA, view, f0, &rect, 0);
        Answer {
            brdf: ALUMINIUM.to_array().map(brdf),
            radiance: ALUMINIUM.to_array().map(radiance),
            ..Answer::default()
        }
    };
    Ok(Case { sections, answer: Box::new(answer) })
}

/// A sky with a gradient and lamps in it.
fn sky() -> Result<environment::EnvironmentImage, Failure> {
    const HEIGHT: u32 = 32;
    let pixel = |at: u32| {
        let (x, y) = ((at % (2 * HEIGHT)) as f32, (at / (2 * HEIGHT)) as f32);
        let lit = (x * 0.7).sin() * (y * 0.9).cos() > 0.9;
        let up = 1.0 - y / HEIGHT as f32;
        if lit { [40.0, 32.0, 16.0] } else { [0.2 + 0.2 * up, 0.3 + 0.1 * up, 0.4] }
    };
    Ok(environment::EnvironmentImage::new(2 * HEIGHT, HEIGHT, (0..2 * HEIGHT * HEIGHT).map(pixel).collect())?)
}

fn environment_case() -> Result<Case, Failure> {
    let options = environment::EnvironmentOptions {
        face_size: 32,
        levels: environment::LevelCount::Exactly(4),
        measured_reads: 0,
        ..Default::default()
    };
    let baked = environment::bake(&sky()?, &options, &Silent)?;
    let sections = environment::sections::to_sections("sky", &baked, Codec::None);
    // Those of example_environment.wgsl.
    const REFLECTANCE: f32 = 0.9;
    const DENSITY: f32 = 1e6;
    let answer = move |pixel: &Pixel| {
        let on = pixel.on_surface();
        let area = counting::query::footprint_area(on.d_dx, on.d_dy);
        let facets = counting::query::footprint_facets(area, DENSITY);
        let cell = counting::query::facet_cell(counting::query::footprint_box(on.d_dx, on.d_dy), on.position, 0);
        let leaves = counting::eval::tree_leaves(baked.params.levels.len().max(2));
        let words = counting::query::cell_words(cell, leaves);
        let surface =
            environment::eval::Surface { normal: Vec3::Z, view: pixel.view(), alpha: 0.3, f0: REFLECTANCE, facets };
        Answer {
            brdf: environment::eval::environment_smooth(&baked, &surface),
            radiance: environment::eval::environment_glints(&baked, &surface, &words),
            ..Answer::default()
        }
    };
    Ok(Case { sections, answer: Box::new(answer) })
}
