// A surface of counted facets under suns, points, rectangles and skies.
// Kneiphof and Klein 2025, "Real-Time Image-based Lighting of Glints", Eq. 7 to 9 and 17: n of N facets reflect a light with chance p each,
// and the light's smooth reflection is multiplied by n / (N p). Twin of glint-bake-core glints/eval.rs, where deviations are derived.
//
// A pixel: glint_counted_surface once; glint_cone_light for each sun or point, glint_rect_facets for each rectangle; glint_four_lights of
// four of them (glint_no_light where there are fewer). A sky: glint_environment_draw of environment::eval with
// glint_sky_words.
//
// Accessors that the including program defines, besides those of area_light/rect.wgsl:
//   fn glint_facet_palette(index: u32) -> vec3f   section GLCO: colour of a facet, linear RGB; called only where material.colours > 0

#import brdf
#import microfacet
#import counting::query
#import area_light::rect
#import glints::layers

const GLINT_WHOLE_DRAW: u32 = 0u;
const GLINT_COUNT_DRAW: u32 = 1u;
const GLINT_COLOUR_DRAW: u32 = 2u;
const GLINT_LEAST_EXPECTED: f32 = 1.0e-37;
// Least cosine of a direction and the half vector.
const GLINT_LEAST_COSINE: f32 = 1.0e-4;
// A hemisphere.
const GLINT_WIDEST: f32 = 6.2831853;
// From where to where the chance of a rectangle goes over from that of a cone to its share of the lobe, by solid angles over the lobe's.
const GLINT_WIDE_RECT: vec2f = vec2f(0.06, 0.15);
// Least part of that share that is a chance: where a lobe without tails is all but 0, the tables' lobe has tails.
const GLINT_LEAST_SHARE: f32 = 0.05;

// A material of counted facets: section GLUB. Roughness, density and turn may differ from pixel to pixel; `facet_area` goes with the
// roughness.
struct GlintCountedMaterial {
    // Reflectance at normal incidence, linear RGB.
    f0: vec3f,
    // 0 Beckmann, 1 GGX.
    normal_target: u32,
    // Roughness along both tangent axes, 1e-3 to 1.
    alpha: vec2f,
    // Cosine and sine of the angle from the tangent to the first axis of roughness.
    turn: vec2f,
    // Mean of the facets' colours, linear RGB; white where there are none.
    mean_colour: vec3f,
    // Number of colours; 0 means white.
    colours: u32,
    // Facets on one surface unit squared of what glints.
    density: f32,
    // Share of the surface that glints, 0 to 1; the rest is smooth.
    relative_area: f32,
    // Whole facet area over surface area, glint_microfacet_area.
    facet_area: f32,
    // Half angle of the cone that a facet reflects a point into, in radians, above 0.
    facet_spread: f32,
    // By how much the eye turns, in radians, until facets under a sky are others; 0 for never.
    sky_spread: f32,
    seed: u32,
    layers: GlintLayers,
}

// A pixel of a material: its facets, in the frame of the roughness.
struct GlintCountedSurface {
    material: GlintCountedMaterial,
    // Expected number of facets under the pixel, and that made whole.
    facets: f32,
    whole: f32,
    // The cell that they come from.
    cell: GlintCellState,
    // To the eye.
    view: vec3f,
}

// A light that is a small cone as seen from the surface: a sun, or a sphere far away.
struct GlintConeLight {
    // Unit direction towards it in the tangent frame.
    direction: vec3f,
    // Irradiance of a surface that faces it, linear RGB.
    irradiance: vec3f,
    // In steradians; 0 for lights without extent.
    solid_angle_sr: f32,
}

// What one light does: the smooth reflection of facets, what other layers add, and the chance and the random state of its facets.
struct GlintFacetLight {
    radiance: vec3f,
    chance: f32,
    beside: vec3f,
    state: GlintCellState,
}

// No light at all. A function, since a constant of nested structs does not come through translation to HLSL.
fn glint_no_light() -> GlintFacetLight {
    return GlintFacetLight(vec3f(0.0), 0.0, vec3f(0.0), GlintCellState(0u, 0u));
}

// The smooth surface that a material's facets converge to.
fn glint_smooth_surface(material: GlintCountedMaterial) -> GlintSmoothSurface {
    return GlintSmoothSurface(material.alpha * material.alpha, material.normal_target);
}

// From the tangent frame to that of the roughness.
fn glint_turned(turn: vec2f, v: vec3f) -> vec3f {
    return vec3f(turn.x * v.x + turn.y * v.y, turn.x * v.y - turn.y * v.x, v.z);
}

// The facets of the pixel at `position` (surface units) whose derivatives along the screen's axes are `d_dx` and `d_dy`, seen from the
// unit direction `view` (tangent frame).
fn glint_counted_surface(
    material: GlintCountedMaterial,
    position: vec2f,
    d_dx: vec2f,
    d_dy: vec2f,
    view: vec3f,
) -> GlintCountedSurface {
    let area = glint_footprint_area(d_dx, d_dy);
    let facets = glint_footprint_facets(area, material.density * material.relative_area);
    let cell = glint_facet_cell(glint_footprint_box(d_dx, d_dy), position, material.seed);
    let words = glint_unit_from_bits(vec4u(glint_cell_bits(cell, GLINT_WHOLE_DRAW)));
    let whole = glint_whole_count(facets, words.x);
    return GlintCountedSurface(material, facets, whole, cell, glint_turned(material.turn, view));
}

// Solid angle of a light as facets see it that reflect cones themselves.
fn glint_seen_solid_angle(material: GlintCountedMaterial, solid_angle: f32) -> f32 {
    return min(solid_angle + 3.14159265 * material.facet_spread * material.facet_spread, GLINT_WIDEST);
}

// Place, in cells as wide as a light of `solid_angle`, of the normal `half` that facets need to reflect it.
fn glint_light_place(view: vec3f, half: vec3f, solid_angle: f32) -> vec2f {
    // The same quotient as in glint_microfacet_under_cone.
    let inverse = 1.0 / max(dot(view.xy, view.xy), 1.0e-12);
    let across = vec2f(-view.y, view.x);
    let shortened = half.xy - across * ((1.0 - dot(view, half)) * dot(across, half.xy) * inverse);
    return shortened * (2.0 * inverseSqrt(solid_angle));
}

// A small cone on the surface.
fn glint_cone_light(surface: GlintCountedSurface, light: GlintConeLight) -> GlintFacetLight {
    let material = surface.material;
    let smooth_surface = glint_smooth_surface(material);
    let direction = glint_turned(material.turn, light.direction);
    let half = glint_half_vector(surface.view, direction);
    let solid_angle = glint_seen_solid_angle(material, light.solid_angle_sr);
    let cos_h = dot(surface.view, half);
    let seen = glint_microfacet_under_cone(smooth_surface, surface.view, solid_angle, cos_h);
    let density = glint_microfacet_ndf(seen, half);
    let chance = density * solid_angle / (4.0 * max(cos_h, GLINT_LEAST_COSINE) * material.facet_area);
    let reflected = density * glint_microfacet_masked(seen, surface.view, direction);
    let through = glint_coat_through(material.layers, surface.view.z);
    return GlintFacetLight(
        glint_fresnel(material.f0, cos_h) * light.irradiance * (reflected * through),
        min(chance, 1.0),
        glint_cone_layers(material.layers, material.f0, surface.view, direction, light.solid_angle_sr) * light.irradiance,
        glint_angle_state(surface.cell, glint_light_place(surface.view, half, solid_angle)),
    );
}

// A rectangle on the surface, `light` in the tangent frame.
fn glint_rect_facets(surface: GlintCountedSurface, light: GlintRectLight) -> GlintFacetLight {
    let material = surface.material;
    let alpha = material.alpha;
    var rect = light;
    rect.corner_0 = glint_turned(material.turn, light.corner_0);
    rect.corner_1 = glint_turned(material.turn, light.corner_1);
    rect.corner_2 = glint_turned(material.turn, light.corner_2);
    rect.corner_3 = glint_turned(material.turn, light.corner_3);
    let swapped = alpha.y > alpha.x;
    let axis = select(vec2f(1.0, 0.0), vec2f(0.0, 1.0), swapped);
    let lobe = GlintRoughness(max(alpha.x, alpha.y), min(alpha.x, alpha.y), axis);
    let found = glint_lobe_light(vec3f(0.0, 0.0, 1.0), lobe, surface.view, rect);
    let form_factor = select(0.0, found.form_factor, glint_faces(rect));
    let middle = (rect.corner_0 + rect.corner_1 + rect.corner_2 + rect.corner_3) * 0.25;
    let direction = middle * inverseSqrt(max(dot(middle, middle), 1.0e-20));
    let half = glint_half_vector(surface.view, direction);
    let solid_angle = glint_seen_solid_angle(material, glint_rect_solid_angle(rect));
    let place = glint_light_place(surface.view, half, solid_angle);
    let reflectance = material.f0 * found.terms.x + (vec3f(1.0) - material.f0) * found.terms.y;
    // From what reaches the eye to what facets reflect: masking and the view's cosine, at the rectangle's middle.
    let smooth_surface = glint_smooth_surface(material);
    let masked = 1.0 + glint_microfacet_lambda(smooth_surface, surface.view)
        + glint_microfacet_lambda(smooth_surface, direction);
    let cos_h = max(dot(surface.view, half), GLINT_LEAST_COSINE);
    let facets = found.terms.x * max(surface.view.z, GLINT_LEAST_COSINE) * masked / (cos_h * material.facet_area);
    let share = form_factor * facets;
    // As a cone.
    let seen = glint_microfacet_under_cone(smooth_surface, surface.view, solid_angle, cos_h);
    let cone = glint_microfacet_ndf(seen, half) * solid_angle / (4.0 * cos_h * material.facet_area);
    var chance = max(cone, GLINT_LEAST_SHARE * share);
    if material.normal_target == GLINT_MICROFACET_GGX {
        let width = solid_angle / (12.566371 * alpha.x * alpha.y);
        let wide = clamp((width - GLINT_WIDE_RECT.x) / (GLINT_WIDE_RECT.y - GLINT_WIDE_RECT.x), 0.0, 1.0);
        chance = cone + (share - cone) * wide;
    }
    return GlintFacetLight(
        reflectance * light.radiance * (form_factor * glint_coat_through(material.layers, surface.view.z)),
        min(chance, 1.0),
        glint_rect_layers(material.layers, material.f0, surface.view, rect),
        glint_angle_state(surface.cell, place),
    );
}

// Hits of four lights over their expected number; of a light that no facet can reflect, 0. Lights that are not `drawn` are anything.
fn glint_hit_ratios(
    surface: GlintCountedSurface,
    a: GlintFacetLight,
    b: GlintFacetLight,
    c: GlintFacetLight,
    d: GlintFacetLight,
    drawn: vec4<bool>,
) -> vec4f {
    let bits = vec4u(
        glint_cell_bits(a.state, GLINT_COUNT_DRAW), glint_cell_bits(b.state, GLINT_COUNT_DRAW),
        glint_cell_bits(c.state, GLINT_COUNT_DRAW), glint_cell_bits(d.state, GLINT_COUNT_DRAW),
    );
    let chances = vec4f(a.chance, b.chance, c.chance, d.chance);
    // Without facets nothing is worked out of lights that are not drawn.
    let whole = GlintCounts(select(vec4f(0.0), vec4f(surface.whole), drawn), vec4f(0.0));
    let splits = glint_whole_binomial(
        whole, chances, 1.0 - chances, glint_unit_from_bits(bits), glint_unit_from_bits(~bits), drawn,
    );
    return glint_count_value(splits.hits) / max(surface.facets * chances, vec4f(GLINT_LEAST_EXPECTED));
}

// Colour of `hits` facets: one facet has one of the palette, many have nearly the mean.
fn glint_facet_colour(material: GlintCountedMaterial, state: GlintCellState, hits: f32) -> vec3f {
    if material.colours == 0u {
        return vec3f(1.0);
    }
    let index = ((glint_cell_bits(state, GLINT_COLOUR_DRAW) >> 16u) * material.colours) >> 16u;
    return material.mean_colour + (glint_facet_palette(index) - material.mean_colour) * inverseSqrt(max(hits, 1.0));
}

// Radiance of a light, linear RGB: of the facets, `ratio` times what is expected of them, of the smooth part, and of other layers.
fn glint_facet_radiance(surface: GlintCountedSurface, light: GlintFacetLight, ratio: f32) -> vec3f {
    let share = surface.material.relative_area;
    let colour = glint_facet_colour(surface.material, light.state, ratio * (surface.facets * light.chance));
    return light.radiance * (colour * (share * ratio) + (1.0 - share)) + light.beside;
}

// Radiance towards the eye from up to four lights, linear RGB: those that are `drawn`, glint_no_light the others.
fn glint_four_lights(
    surface: GlintCountedSurface,
    a: GlintFacetLight,
    b: GlintFacetLight,
    c: GlintFacetLight,
    d: GlintFacetLight,
    drawn: vec4<bool>,
) -> vec3f {
    let ratios = glint_hit_ratios(surface, a, b, c, d, drawn);
    // Which lights are drawn is mostly known when a pipeline is made, and then nothing of the others is worked out.
    var radiance = vec3f(0.0);
    if drawn.x {
        radiance = glint_facet_radiance(surface, a, ratios.x);
    }
    if drawn.y {
        radiance += glint_facet_radiance(surface, b, ratios.y);
    }
    if drawn.z {
        radiance += glint_facet_radiance(surface, c, ratios.z);
    }
    if drawn.w {
        radiance += glint_facet_radiance(surface, d, ratios.w);
    }
    return radiance;
}

// Radiance of the mean over seeds, linear RGB, where the smooth reflection is `radiance`: what facets converge to.
fn glint_mean_radiance(material: GlintCountedMaterial, radiance: vec3f) -> vec3f {
    return radiance * (material.mean_colour * material.relative_area + (1.0 - material.relative_area));
}

// State of the cell towards the sky.
fn glint_sky_state(surface: GlintCountedSurface) -> GlintCellState {
    let spread = surface.material.sky_spread;
    // Normals turn half as much as the eye.
    let scale = select(0.0, 0.5 / spread, spread > 0.0);
    return glint_angle_state(surface.cell, surface.view.xy * scale);
}

// Radiance of a sky: `drawn` of its facets, `smooth_radiance` without any, and the first two moments of what a facet reflects. The facets
// of its draw are as many as those of one level with these moments. Other layers add glint_sky_layers.
fn glint_sky_radiance(surface: GlintCountedSurface, drawn: vec3f, smooth_radiance: vec3f, moments: vec2f) -> vec3f {
    let share = surface.material.relative_area;
    let hits = surface.facets * moments.x * moments.x / max(moments.y, GLINT_LEAST_EXPECTED);
    let colour = glint_facet_colour(surface.material, glint_sky_state(surface), hits);
    let through = glint_coat_through(surface.material.layers, surface.view.z);
    return (drawn * colour * share + smooth_radiance * (1.0 - share)) * through;
}

// The words of a draw under a sky of `levels` levels: word 0 is that of the whole number of facets, which all lights share.
fn glint_sky_words(surface: GlintCountedSurface, levels: u32) -> GlintWords {
    var words = glint_cell_words(glint_sky_state(surface), levels);
    words.a.x = glint_unit_from_bits(vec4u(glint_cell_bits(surface.cell, GLINT_WHOLE_DRAW))).x;
    return words;
}
