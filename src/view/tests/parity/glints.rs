//! Counted facets: cells, smooth parts, chances, and draws.
//!
//! A cell is a step function of place and footprint, a count of its random word: where a number lies within rounding of a step, two
//! devices may stand on different sides. How often they do is counted and bounded.

use crate::counting::MAX_FLIPPED;
use crate::support::{QUERIES, agree, compare, gpu, log_uniform, random};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use glint_bake_core::area_light::baked::decode_tables;
use glint_bake_core::area_light::rect::RectLight;
use glint_bake_core::counting::query::facing_plane;
use glint_bake_core::glints::eval::{
    ConeLight, CountedMaterial, cone_light, counted_surface, four_lights, hit_ratios, no_light, rect_facets, sky_words,
};
use glint_bake_core::glints::layers::Layers;
use glint_bake_core::glints::sampling::{counted_pdf, counted_sample};
use glint_bake_core::glints::{GlintsOptions, bake, sections};
use glint_bake_core::microfacet::{SmoothSurface, microfacet_area};
use glint_bake_core::progress::Silent;
use glint_formats::glints::{BINDINGS, GlintsUniform, LayersUniform};
use glint_formats::{Codec, Wrap};
use glint_shaders::assert_same_layout;
use glint_view::gpu::{answer, bind_sections};
use rand::{Rng, RngExt};

/// Largest difference of the hits of a rectangle over their expected number: a sampler reads the tables in steps of 1/256 of a texel.
const RECT_TOLERANCE: f32 = 1e-3;
/// Least chance of a rectangle whose hits are compared: one that is next to nothing is a difference of angles of edges, and has their absolute error.
const LEAST_CHANCE: f32 = 1e-4;

/// `GlintsQuery` of query_glints.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Query {
    f0: Vec3,
    normal_target: u32,
    alpha: Vec2,
    turn: Vec2,
    position: Vec2,
    density: f32,
    relative_area: f32,
    d_dx: Vec2,
    d_dy: Vec2,
    view: Vec3,
    facet_spread: f32,
    light: Vec3,
    solid_angle_sr: f32,
    corner_0: Vec3,
    sky_spread: f32,
    corner_1: Vec3,
    seed: u32,
    corner_2: Vec3,
    facet_area: f32,
    corner_3: Vec3,
    colours: u32,
    diffuse: Vec3,
    coat: f32,
    random: Vec3,
    coat_alpha: f32,
}

/// `GlintsAnswer`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Answer {
    cone_radiance: Vec3,
    cone_chance: f32,
    rect_radiance: Vec3,
    rect_chance: f32,
    cone_beside: Vec3,
    pdf: f32,
    rect_beside: Vec3,
    sampled_pdf: f32,
    sampled: Vec3,
    unused_0: u32,
    radiance: Vec3,
    facets: f32,
    ratios: [f32; 2],
    whole: f32,
    facet_area: f32,
    cell: [u32; 2],
    cone_state: [u32; 2],
    rect_state: [u32; 2],
    plane: u32,
    area_ratio: f32,
    words: [f32; 4],
}

#[test]
fn uniforms_lie_as_the_shader_reads_them() {
    let source = glint_shaders::compose(&["bind_glints"]);
    assert_same_layout!(
        &source,
        "GlintCountedMaterial",
        GlintsUniform,
        f0,
        normal_target,
        alpha,
        turn,
        mean_colour,
        colours,
        density,
        relative_area,
        facet_area,
        facet_spread,
        sky_spread,
        seed,
        layers
    );
    assert_same_layout!(&source, "GlintLayers", LayersUniform, diffuse, coat, coat_alpha);
}

fn direction(rng: &mut impl Rng) -> Vec3 {
    let cosine: f32 = rng.random::<f32>().max(0.02);
    let flat = Vec2::from_angle(rng.random::<f32>() * std::f32::consts::TAU) * (1.0 - cosine * cosine).sqrt();
    Vec3::new(flat.x, flat.y, cosine)
}

fn query(rng: &mut impl Rng, palette: u32) -> Query {
    let alpha = log_uniform(rng, 0.02, 1.0);
    let alpha = Vec2::new(alpha, if rng.random() { alpha } else { log_uniform(rng, 0.02, 1.0) });
    let normal_target = u32::from(rng.random::<bool>());
    let view = direction(rng);
    // Half of the lights near the mirror image of the eye.
    let aside = direction(rng) * (alpha.max_element() * rng.random::<f32>());
    let light = if rng.random() { (view * Vec3::new(-1.0, -1.0, 1.0) + aside).normalize() } else { direction(rng) };
    let along = Vec2::from_angle(rng.random::<f32>() * std::f32::consts::TAU);
    let size = log_uniform(rng, 1e-4, 10.0);
    let middle = direction(rng) * log_uniform(rng, 0.5, 10.0);
    let (u, v) = (direction(rng) * 0.5, direction(rng) * 0.5);
    let facets = log_uniform(rng, 1e-2, 1e9);
    Query {
        f0: Vec3::new(rng.random(), rng.random(), rng.random()),
        normal_target,
        alpha,
        turn: Vec2::from_angle(rng.random::<f32>() * std::f32::consts::TAU),
        // Farther away an f32 does not tell the parts of a pixel.
        position: Vec2::new(rng.random(), rng.random()) * (size * log_uniform(rng, 0.1, 3e4)),
        density: facets / (size * size),
        relative_area: if rng.random() { 1.0 } else { rng.random() },
        d_dx: along * size,
        d_dy: (along.perp() * log_uniform(rng, 0.02, 1.0) + along * (rng.random::<f32>() - 0.5)) * size,
        view,
        facet_spread: log_uniform(rng, 1e-3, 0.1),
        light,
        solid_angle_sr: if rng.random() { 0.0 } else { log_uniform(rng, 1e-5, 0.1) },
        corner_0: middle - u - v,
        sky_spread: if rng.random() { 0.0 } else { 0.1 },
        corner_1: middle + u - v,
        seed: rng.random(),
        corner_2: middle + u + v,
        facet_area: microfacet_area(SmoothSurface { alpha2: alpha * alpha, normal_target }),
        corner_3: middle - u + v,
        colours: if rng.random() { palette } else { 0 },
        diffuse: if rng.random() { Vec3::ZERO } else { Vec3::new(rng.random(), rng.random(), rng.random()) },
        coat: if rng.random() { 0.0 } else { rng.random() },
        random: Vec3::new(rng.random(), rng.random(), rng.random()),
        coat_alpha: log_uniform(rng, 0.02, 1.0),
    }
}

#[test]
fn counted_facets_of_the_shader_are_those_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let colours = vec![[1.0, 0.2, 0.1], [0.2, 0.9, 0.3], [0.1, 0.3, 1.0]];
    let facets = bake(&GlintsOptions { colours, ..GlintsOptions::default() }, &Silent).unwrap();
    let (tables, palette) = (decode_tables(&facets.tables), facets.colours());
    let rng = &mut random(41);
    let queries: Vec<Query> = (0..2 * QUERIES).map(|_| query(rng, palette.len() as u32)).collect();
    let sections = sections::to_sections("facets", &facets, Codec::None);
    let data = bind_sections(gpu, &sections, BINDINGS, Wrap::Clamp).unwrap();
    let source = glint_shaders::compose(&["query_glints"]);
    let answers: Vec<Answer> = answer(gpu, "glints", &source, &[&data], &queries).unwrap();
    let (mut areas, mut cones, mut rects, mut chances, mut words) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut densities, mut samples) = (Vec::new(), Vec::new());
    let (mut elsewhere, mut towards, mut planes, mut flipped, mut drawn) = (0usize, 0usize, 0usize, 0usize, 0usize);
    for (q, a) in queries.iter().zip(&answers) {
        let material = CountedMaterial {
            f0: q.f0,
            normal_target: q.normal_target,
            alpha: q.alpha,
            turn: q.turn,
            mean_colour: facets.material().mean_colour,
            colours: q.colours,
            density: q.density,
            relative_area: q.relative_area,
            facet_area: q.facet_area,
            facet_spread: q.facet_spread,
            sky_spread: q.sky_spread,
            seed: q.seed,
            layers: Layers { diffuse: q.diffuse, coat: q.coat, coat_alpha: q.coat_alpha },
        };
        areas.push((a.facet_area, q.facet_area));
        let surface = counted_surface(material, q.position, q.d_dx, q.d_dy, q.view);
        let cone = cone_light(
            surface,
            ConeLight { direction: q.light, irradiance: Vec3::new(1.0, 2.0, 3.0), solid_angle_sr: q.solid_angle_sr },
        );
        let corners = [q.corner_0, q.corner_1, q.corner_2, q.corner_3];
        let rect = rect_facets(&tables, surface, &RectLight { corners, radiance: 2.0, two_sided: true });
        // In units of the lobe's peak, so that 1e-5 is small.
        let unit = std::f32::consts::PI * q.alpha.x * q.alpha.y;
        cones.extend((0..3).map(|c| (a.cone_radiance[c] * unit, cone.radiance[c] * unit)));
        rects.extend((0..3).map(|c| (a.rect_radiance[c], rect.radiance[c])));
        rects.extend((0..3).map(|c| (a.rect_beside[c], rect.beside[c])));
        rects.push((a.rect_chance, rect.chance));
        let coat_unit = unit.min(std::f32::consts::PI * q.coat_alpha * q.coat_alpha);
        cones.extend((0..3).map(|c| (a.cone_beside[c] * coat_unit, cone.beside[c] * coat_unit)));
        densities.push((a.pdf * coat_unit, counted_pdf(material, q.view, q.light) * coat_unit));
        let sampled = counted_sample(material, q.view, q.random);
        samples.extend((0..3).map(|c| (a.sampled[c], sampled[c])));
        densities.push((a.sampled_pdf * coat_unit, counted_pdf(material, q.view, a.sampled) * coat_unit));
        chances.push((a.cone_chance.sqrt(), cone.chance.sqrt()));
        let position = Vec3::new(q.position.x, q.position.y, q.density);
        let plane = facing_plane(position, q.d_dx.extend(0.0), q.d_dy.extend(0.1), q.view, q.seed);
        planes += usize::from(a.plane != plane.seed);
        if a.plane == plane.seed {
            areas.push((a.area_ratio, plane.area_ratio));
        }
        if a.cell != [surface.cell.a, surface.cell.b] {
            elsewhere += 1;
            continue;
        }
        let expected = sky_words(surface, 4);
        if q.sky_spread == 0.0 {
            words.extend((0..4).map(|k| (a.words[k], expected[k])));
        }
        let states = [(a.cone_state, cone.state), (a.rect_state, rect.state)];
        if states.iter().any(|(found, expected)| *found != [expected.a, expected.b]) {
            towards += 1;
            continue;
        }
        let lights = [cone, rect, no_light(), no_light()];
        let expected = hit_ratios(surface, lights);
        let radiance = four_lights(surface, &palette, lights) * coat_unit;
        let found = a.radiance * coat_unit;
        let same = a.whole == surface.whole
            && agree(a.ratios[0], expected[0])
            && (rect.chance < LEAST_CHANCE
                || (a.ratios[1] - expected[1]).abs() <= RECT_TOLERANCE * expected[1].max(1.0))
            && (0..3).all(|c| (found[c] - radiance[c]).abs() <= RECT_TOLERANCE * radiance[c].max(1.0));
        if same {
            drawn += 1;
        } else {
            flipped += 1;
        }
    }
    println!(
        "{elsewhere} cells, {towards} cells of directions, {planes} planes, {flipped} draws on the other side of a step, of {}",
        queries.len()
    );
    let most = MAX_FLIPPED * queries.len() as f64;
    for (what, count) in
        [("cells", elsewhere), ("cells of directions", towards), ("planes", planes), ("draws", flipped)]
    {
        assert!(f64::from(count as u32) <= most, "{count} {what} differ");
    }
    compare("glints, areas", areas.into_iter());
    compare("glints, cones", cones.into_iter());
    let rect_worst = rects.iter().map(|(found, expected)| (found - expected).abs()).fold(0.0, f32::max);
    println!(
        "glints, rectangles: worst difference {rect_worst:.1e}, largest {:.2}",
        rects.iter().map(|pair| pair.1).fold(0.0, f32::max)
    );
    assert!(rect_worst < 1e-5, "{rect_worst}");
    compare("glints, chances", chances.into_iter());
    compare("glints, densities of samples", densities.into_iter());
    compare("glints, samples", samples.into_iter());
    compare("glints, words", words.into_iter());
    assert!(drawn > QUERIES, "{drawn}");
}
