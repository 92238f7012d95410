// Image-based lighting of glints: filtered radiance, and a draw of how many facets reflect each of a few radiance levels.
// Kneiphof and Klein 2025, "Real-Time Image-based Lighting of Glints", sections 4 and 5, Eq. 11, 15, 17 and 21.
// Twin of glint-bake-core environment/eval.rs, where deviations from the paper are derived: the variance of
// glints is that of the filtered second moment, the lobe seen at an angle is that of fitted look-ups, and levels may have colours.
//
// Directions are unit vectors in the environment's frame. Accessors that the including program defines; cubes are filtered between
// texels and across edges, colours between mips as well, which are whole numbers elsewhere:
//   fn glint_environment_mirror_at(direction: vec3f) -> vec4f                            section ENMI times radiance_scale: RGB, root mean square luminance
//   fn glint_environment_radiance_at(layer: u32, direction: vec3f, mip: f32) -> vec4f    section ENRA, the same
//   fn glint_environment_indicators_at(layer: u32, direction: vec3f, mip: f32) -> vec4f  section ENIN; called for levels > 1
//   fn glint_environment_colour_at(layer: u32, direction: vec3f, mip: f32) -> vec3f      section ENCO; called if coloured
//   fn glint_environment_albedo_at(layer: u32, place: vec2f) -> vec4f                    section ENAL, clamped to its edge, place 0 to 1

#import counting::eval

// What a shader needs of the parameters: the section ENUB.
struct GlintEnvironment {
    // Radiance of each level.
    level: GlintLevels,
    // 1 for the levels that there are, else 0.
    present: GlintLevels,
    levels: u32,
    coloured: u32,
    radiance_scale: f32,
    // Filtered roughnesses, and how many each face size has.
    roughnesses: f32,
    per_size: f32,
    // The least of them; 1 over its logarithm to base 2, 0 where it is 1; how the others are spread.
    first_alpha: f32,
    inverse_log: f32,
    bend: f32,
    // Look-ups of a surface, 1 to 3.
    look_ups: u32,
}

// A point of a glittering surface as a pixel sees it, in the environment's frame.
struct GlintSurface {
    normal: vec3f,
    // To the eye.
    view: vec3f,
    // GGX roughness.
    alpha: f32,
    // Reflectance at normal incidence.
    f0: vec3f,
    // Facets under the pixel, any number >= 0.
    facets: f32,
}

// The smooth reflection and the chances of every level.
struct GlintChances {
    smooth_radiance: vec3f,
    // Chance that a facet reflects each level.
    p: GlintLevels,
    // Sums of L p and L^2 p over the levels.
    moments: vec2f,
    // Factor on the standard deviation of what the levels give, 0 to 1.
    std_factor: f32,
    // Where the first look-up looks.
    towards: vec3f,
    // Mip of the colours of levels.
    colour_mip: f32,
}

// The two filtered roughnesses that a roughness lies between, and the shares of what it reads.
struct GlintEnvironmentRoughness {
    // Mip and layer of each.
    low: vec2f,
    high: vec2f,
    // Share of the rougher one in what is filtered.
    share: f32,
    // Share of the mirror in all; above 0 below the least filtered roughness.
    mirror: f32,
    // Mip of the colours of levels.
    colour_mip: f32,
}

// One of the round look-ups that stand for the lobe of a surface.
struct GlintEnvironmentLookUp {
    direction: vec3f,
    roughness: GlintEnvironmentRoughness,
}

// Mip and layer of filtered roughness `index`, 0 for the least.
fn glint_environment_place(environment: GlintEnvironment, index: f32) -> vec2f {
    let mip = floor((index + 0.5) / environment.per_size);
    return vec2f(mip, index - mip * environment.per_size);
}

// Where a roughness is read: the inverse of what the bake gives each.
fn glint_environment_roughness(environment: GlintEnvironment, alpha: f32) -> GlintEnvironmentRoughness {
    let last = environment.roughnesses - 1.0;
    let rough = 1.0 - log2(clamp(alpha, environment.first_alpha, 1.0)) * environment.inverse_log;
    let index = clamp(last * rough * (1.0 + environment.bend * (1.0 - rough)), 0.0, last);
    let low = floor(index);
    let colours = (index - floor(0.5 * environment.per_size)) / environment.per_size;
    return GlintEnvironmentRoughness(
        glint_environment_place(environment, low),
        glint_environment_place(environment, min(low + 1.0, last)),
        index - low,
        1.0 - clamp(alpha / environment.first_alpha, 0.0, 1.0),
        clamp(colours, 0.0, environment.roughnesses / environment.per_size - 1.0),
    );
}

// Filtered radiance of a roughness, without the mirror: RGB and root mean square luminance. All is read without branches: what
// two pixels of a group need differs.
fn glint_environment_filtered(direction: vec3f, roughness: GlintEnvironmentRoughness) -> vec4f {
    let low = glint_environment_radiance_at(u32(roughness.low.y), direction, roughness.low.x);
    let high = glint_environment_radiance_at(u32(roughness.high.y), direction, roughness.high.x);
    return (1.0 - roughness.share) * low + roughness.share * high;
}

// Radiance of a roughness; `filtered` is that of glint_environment_filtered.
fn glint_environment_radiance(direction: vec3f, roughness: GlintEnvironmentRoughness, filtered: vec3f) -> vec3f {
    return (1.0 - roughness.mirror) * filtered + roughness.mirror * glint_environment_mirror_at(direction).rgb;
}

// Layer `layer` of the table by view cosine and roughness.
fn glint_environment_table(layer: u32, surface: GlintSurface) -> vec4f {
    let cos_o = dot(surface.normal, surface.view);
    return glint_environment_albedo_at(layer, vec2f(clamp(cos_o, 0.0, 1.0), sqrt(clamp(surface.alpha, 0.0, 1.0))));
}

// A look-up of a shift and a ratio of roughnesses: in the plane of incidence, a shift above 0 towards the normal.
fn glint_environment_look_up(
    environment: GlintEnvironment,
    surface: GlintSurface,
    shift: f32,
    ratio: f32,
) -> GlintEnvironmentLookUp {
    let cos_o = dot(surface.normal, surface.view);
    let mirror = 2.0 * cos_o * surface.normal - surface.view;
    let direction = normalize(mirror + shift * surface.alpha * (surface.normal - cos_o * mirror));
    return GlintEnvironmentLookUp(direction, glint_environment_roughness(environment, ratio * surface.alpha));
}

// Filtered radiance of the look-ups of a surface, of which `first` is the first: RGB and mean square luminance.
fn glint_environment_lobe(
    environment: GlintEnvironment,
    surface: GlintSurface,
    first: GlintEnvironmentLookUp,
) -> vec4f {
    let read = glint_environment_filtered(first.direction, first.roughness);
    let alone = vec4f(read.rgb, read.w * read.w);
    var sum = alone;
    for (var layer = 2u; layer <= environment.look_ups; layer++) {
        let entry = glint_environment_table(layer, surface);
        let look_up = glint_environment_look_up(environment, surface, entry.x, entry.y);
        let filtered = glint_environment_filtered(look_up.direction, look_up.roughness);
        sum += entry.z * (vec4f(filtered.rgb, filtered.w * filtered.w) - alone);
    }
    // Rounding may leave a little less than nothing of the first.
    return max(sum, vec4f(0.0));
}

// Image-based light without glints: the smooth reflection (Eq. 11).
fn glint_environment_smooth(environment: GlintEnvironment, surface: GlintSurface) -> vec3f {
    let areas = glint_environment_table(0u, surface);
    let first = glint_environment_look_up(environment, surface, areas.z, areas.w);
    let filtered = glint_environment_lobe(environment, surface, first).rgb;
    let radiance = glint_environment_radiance(first.direction, first.roughness, filtered);
    return (surface.f0 * areas.x + areas.y) * radiance;
}

fn glint_levels_sum(levels: GlintLevels, count: u32) -> f32 {
    var sum = dot(levels.a, vec4f(1.0));
    if count > 4u {
        sum += dot(levels.b, vec4f(1.0));
    }
    if count > 8u {
        sum += dot(levels.c, vec4f(1.0)) + dot(levels.d, vec4f(1.0));
    }
    return sum;
}

// Sum of the products of two lists of the first `count` levels.
fn glint_levels_dot(x: GlintLevels, y: GlintLevels, count: u32) -> f32 {
    var sum = dot(x.a, y.a);
    if count > 4u {
        sum += dot(x.b, y.b);
    }
    if count > 8u {
        sum += dot(x.c, y.c) + dot(x.d, y.d);
    }
    return sum;
}

// Shares of levels 4 `layer` + 1 to 4 `layer` + 4 of a roughness; of the least filtered one below it.
fn glint_environment_indicators(
    environment: GlintEnvironment,
    layer: u32,
    direction: vec3f,
    roughness: GlintEnvironmentRoughness,
) -> vec4f {
    let layers = (environment.levels + 2u) / 4u;
    let places = vec2u(vec2f(roughness.low.y, roughness.high.y)) * layers + layer;
    let low = glint_environment_indicators_at(places.x, direction, roughness.low.x);
    let high = glint_environment_indicators_at(places.y, direction, roughness.high.x);
    return (1.0 - roughness.share) * low + roughness.share * high;
}

// Probabilities that a facet reflects each level around a direction (Eq. 15 and 21), with `visible` the share of facets that reflect at
// all. Level 0 also takes the facets that reflect nothing.
fn glint_level_probabilities(
    environment: GlintEnvironment,
    direction: vec3f,
    roughness: GlintEnvironmentRoughness,
    visible: f32,
) -> GlintLevels {
    let count = environment.levels;
    var p = GlintLevels(vec4f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0));
    if count == 1u {
        p.a.x = visible;
        return p;
    }
    // Component c of layer l is level 4 l + c + 1, so lists are shifted by one.
    let first = glint_environment_indicators(environment, 0u, direction, roughness) * visible;
    p.a = vec4f(0.0, first.xyz) * environment.present.a;
    if count > 4u {
        var second = vec4f(0.0);
        if count > 5u {
            second = glint_environment_indicators(environment, 1u, direction, roughness) * visible;
        }
        p.b = vec4f(first.w, second.xyz) * environment.present.b;
        if count > 8u {
            var third = vec4f(0.0);
            var fourth = vec4f(0.0);
            if count > 9u {
                third = glint_environment_indicators(environment, 2u, direction, roughness) * visible;
            }
            if count > 13u {
                fourth = glint_environment_indicators(environment, 3u, direction, roughness) * visible;
            }
            p.c = vec4f(second.w, third.xyz) * environment.present.c;
            p.d = vec4f(third.w, fourth.xyz) * environment.present.d;
        }
    }
    p.a.x = max(1.0 - glint_levels_sum(p, count), 0.0);
    return p;
}

// Probabilities that a facet reflects each level by all look-ups of a surface, of which `first` is the first.
fn glint_lobe_probabilities(
    environment: GlintEnvironment,
    surface: GlintSurface,
    first: GlintEnvironmentLookUp,
    visible: f32,
) -> GlintLevels {
    let alone = glint_level_probabilities(environment, first.direction, first.roughness, visible);
    var p = alone;
    for (var layer = 2u; layer <= environment.look_ups; layer++) {
        let entry = glint_environment_table(layer, surface);
        let look_up = glint_environment_look_up(environment, surface, entry.x, entry.y);
        let other = glint_level_probabilities(environment, look_up.direction, look_up.roughness, visible);
        p.a += entry.z * (other.a - alone.a);
        p.b += entry.z * (other.b - alone.b);
        p.c += entry.z * (other.c - alone.c);
        p.d += entry.z * (other.d - alone.d);
    }
    let none = vec4f(0.0);
    return GlintLevels(max(p.a, none), max(p.b, none), max(p.c, none), max(p.d, none));
}

// Share of facets that all reflect alike and have the mean and the mean square of those that there are; `areas` and `squares` are the
// first two layers of the table.
fn glint_visible_share(areas: vec4f, squares: vec4f, f0: f32) -> f32 {
    let scaled = f0 * areas.x;
    let x = scaled / max(scaled + areas.y, 1.0e-37);
    let y = 1.0 - x;
    return 1.0 / max(squares.x * x * x + 2.0 * squares.y * x * y + squares.z * y * y, 1.0);
}

// Mean and second moment of what one facet reflects.
fn glint_facet_moments(environment: GlintEnvironment, p: GlintLevels) -> vec2f {
    let level = environment.level;
    let light = GlintLevels(p.a * level.a, p.b * level.b, p.c * level.c, p.d * level.d);
    let count = environment.levels;
    return vec2f(glint_levels_sum(light, count), glint_levels_dot(light, level, count));
}

// Factor that brings the variance of the levels to that of the unsorted facets; `square` is the filtered second moment.
fn glint_std_factor(moments: vec2f, square: f32, visible: f32) -> f32 {
    let mean2 = moments.x * moments.x;
    let of_levels = moments.y - mean2;
    if of_levels > 0.0 {
        return sqrt(clamp((visible * square - mean2) / of_levels, 0.0, 1.0));
    }
    return 1.0;
}

// The smooth reflection and the chances of the levels at a surface point.
fn glint_chances(environment: GlintEnvironment, surface: GlintSurface) -> GlintChances {
    let areas = glint_environment_table(0u, surface);
    let first = glint_environment_look_up(environment, surface, areas.z, areas.w);
    let filtered = glint_environment_lobe(environment, surface, first);
    let radiance = glint_environment_radiance(first.direction, first.roughness, filtered.rgb);
    // One draw serves all channels, so its facets have the reflectance that the eye sees.
    let f0 = dot(surface.f0, vec3f(0.2126, 0.7152, 0.0722));
    let visible = glint_visible_share(areas, glint_environment_table(1u, surface), f0);
    let p = glint_lobe_probabilities(environment, surface, first, visible);
    let moments = glint_facet_moments(environment, p);
    // Levels are filtered, so the moment beside them is that of what is filtered.
    let std_factor = glint_std_factor(moments, filtered.w, visible);
    let smooth_radiance = (surface.f0 * areas.x + areas.y) * radiance;
    return GlintChances(smooth_radiance, p, moments, std_factor, first.direction, first.roughness.colour_mip);
}

// Drawn over expected light, channel by channel.
fn glint_coloured_ratios(
    environment: GlintEnvironment,
    chances: GlintChances,
    facets: f32,
    counts: GlintLevels,
) -> vec3f {
    let level = environment.level;
    var light = array<vec4f, 4>(level.a, level.b, level.c, level.d);
    var drawn_counts = array<vec4f, 4>(counts.a, counts.b, counts.c, counts.d);
    var p = array<vec4f, 4>(chances.p.a, chances.p.b, chances.p.c, chances.p.d);
    var drawn = vec3f(0.0);
    var expected = vec3f(0.0);
    for (var k = 1u; k < min(environment.levels, 16u); k++) {
        let colour = glint_environment_colour_at(k - 1u, chances.towards, chances.colour_mip) * light[k / 4u][k % 4u];
        drawn += colour * drawn_counts[k / 4u][k % 4u];
        expected += colour * (p[k / 4u][k % 4u] * facets);
    }
    return select(vec3f(1.0), drawn / max(expected, vec3f(1.0e-37)), expected > vec3f(0.0));
}

// Radiance towards the eye of one draw of facets (Eq. 17), linear RGB; of chances that glint_chances has found.
fn glint_environment_draw(
    environment: GlintEnvironment,
    chances: GlintChances,
    facets: f32,
    words: GlintWords,
) -> vec3f {
    var p = chances.p;
    if environment.levels == 1u {
        // A single level needs a second one for the facets that reflect nothing.
        p.a.y = 1.0 - p.a.x;
    }
    let counts = glint_multinomial(facets, p, environment.levels, words);
    let share = 1.0 / (facets * chances.moments.x);
    let there = glint_levels_sum(counts, environment.levels) * chances.moments.x * share;
    var ratios = vec3f(0.0);
    if environment.coloured != 0u {
        ratios = glint_coloured_ratios(environment, chances, facets, counts);
    } else {
        let light = glint_levels_dot(environment.level, counts, environment.levels);
        ratios = vec3f(light * share);
    }
    let drawn = max(vec3f(there) + chances.std_factor * (ratios - there), vec3f(0.0));
    // Without light or facets there is nothing to draw.
    let dark = select(vec3f(0.0), vec3f(1.0), facets > 0.0);
    return chances.smooth_radiance * select(dark, drawn, (chances.moments.x > 0.0) & (facets > 0.0));
}

// Radiance towards the eye of one draw of facets, linear RGB; `words` are the random words of the pixel.
fn glint_environment_glints(environment: GlintEnvironment, surface: GlintSurface, words: GlintWords) -> vec3f {
    return glint_environment_draw(environment, glint_chances(environment, surface), surface.facets, words);
}
