// Rectangle lights on normal-mapped surfaces: mean normal and roughness of what lies under a pixel, and its lobes.
// Tao et al. 2021, "Real-Time Antialiased Area Lighting Using Multi-Scale Linearly Transformed Cosines", sections 3.1, 3.3
// and 3.5. Twin of eval.rs, where deviations from the paper are derived; mainly: the
// roughness of normals is stored by itself, convolution is symmetric, and normals that vary more along one direction are
// taken apart into lobes.
//
// Accessors that the including program defines:
//   fn glint_area_light_normals(position: vec2f, level: f32) -> vec4f
//       section ALNM with linear filtering within and between mips; `position` in texels of the first mip, within one map's
//       size of it, wrapped as the parameters say; `level` from 0 to the last mip
//   fn glint_area_light_roughness(position: vec2f, level: f32) -> vec4f
//       section ALRO, read alike; called only where maps.anisotropic is 1

#import area_light::rect

// Most lobes of roughness by direction.
const GLINT_MAX_LOBES: u32 = 9u;
// Deficit of a lobe of roughness 1.
const GLINT_MAX_DEFICIT: f32 = 0.33333334;
// The code of the textures is t / (1 + t), t = (alpha / kappa)^1.4.
const GLINT_KAPPA: f32 = 0.12;
const GLINT_INV_CODE_POWER: f32 = 0.71428573;
// Of the correction in glint_convolve_alpha.
const GLINT_CONVOLVE_FIRST: f32 = 0.3355;
const GLINT_CONVOLVE_SECOND: f32 = 0.0255;

// Shape of the textures: section ALUB.
struct GlintAreaLightMaps {
    // Width and height of the first mip, in texels.
    size: vec2f,
    mips: u32,
    // 0 repeats, 1 clamps.
    wrap: u32,
    // 1 where there is roughness by direction.
    anisotropic: u32,
    unused_0: u32,
    unused_1: u32,
    unused_2: u32,
}

// What lies under a pixel.
struct GlintAreaLightSurface {
    // Mean normal, unit.
    normal: vec3f,
    // Length of the mean normal before it was made a unit vector.
    length: f32,
    // Meso roughness alpha, the same in all directions.
    alpha: f32,
    // Meso roughness by direction; `alpha` in all directions where none was asked for or the material is isotropic.
    by_direction: GlintRoughness,
}

// (atanh(b) / b - 1) / b^2 for b^2 = 1 - alpha^2.
fn glint_deficit_shape(alpha: f32) -> f32 {
    let b2 = (1.0 - alpha) * (1.0 + alpha);
    if b2 < 0.35 {
        var sum = 0.0;
        for (var k = 0; k < 14; k++) {
            sum = sum * b2 + 1.0 / f32(29 - 2 * k);
        }
        return sum;
    }
    let b = sqrt(b2);
    return (log((1.0 + b) / alpha) / b - 1.0) / b2;
}

// Roughness alpha of GGX normals whose mean resultant length is 1 - `deficit`; 1 for 1/3 and above. For engines that have
// mean normals but no section with roughness; the exact inverse of Eq. 4.
fn glint_alpha_from_deficit(deficit: f32) -> f32 {
    if deficit >= GLINT_MAX_DEFICIT {
        return 1.0;
    }
    if !(deficit > 0.0) {
        return 0.0;
    }
    // Newton's method on ln(1 - R) over ln alpha, which is nearly straight.
    var alpha = sqrt(deficit * 3.0);
    for (var i = 0; i < 6; i++) {
        let shape = glint_deficit_shape(alpha);
        let b2 = (1.0 - alpha) * (1.0 + alpha);
        // alpha^2 times the derivative of the shape by b^2; near b = 0 its series.
        var slope = alpha * alpha * (0.2 + b2 * (0.2857143 + b2 / 3.0));
        if b2 >= 0.02 {
            slope = (0.5 - 1.5 * alpha * alpha * shape) / b2;
        }
        let rate = 2.0 - 2.0 * slope / shape;
        let error = deficit / (alpha * alpha * shape);
        alpha = min(alpha * exp(log(error) / rate), 1.0);
    }
    return alpha;
}

// (1 + r^p)^(1/p) of the power sum with p = 1.3021, for r from 0 to 1: a polynomial in the fourth root of r, relative error
// below 1.2e-6. Square roots are cheap where powers are not.
fn glint_power_sum(r: f32) -> f32 {
    let s = sqrt(r);
    let q = sqrt(s);
    let tail = 0.408442 + q * (0.974906 + q * (-1.65692 + q * (2.16163 + q * (-1.67149 + q * 0.486338))));
    return 1.0 + r * q * tail;
}

// Roughness of the convolution of lobes of roughness a and b, both 0 to 1; at least the larger, at most 1 (section 3.5).
fn glint_convolve_alpha(a: f32, b: f32) -> f32 {
    let small = max(min(a, b), 0.0);
    let large = max(a, b);
    if !(large > 0.0) {
        return 0.0;
    }
    let bend = GLINT_CONVOLVE_FIRST - GLINT_CONVOLVE_SECOND * (a + b);
    let sum = large * glint_power_sum(small / large);
    return clamp(sum * (1.0 - small * large * bend), min(large, 1.0), 1.0);
}

// Roughness alpha of a code of the textures.
fn glint_alpha_of_code(code: f32) -> f32 {
    let c = clamp(code, 0.0, 0.99);
    if !(c > 0.0) {
        return 0.0;
    }
    return min(GLINT_KAPPA * pow(c / (1.0 - c), GLINT_INV_CODE_POWER), 1.0);
}

// Larger and smaller eigenvalue of xx, xy, yy, 0 to 1, and the direction of the larger.
fn glint_area_light_principal(matrix: vec3f) -> GlintRoughness {
    let middle = 0.5 * (matrix.x + matrix.z);
    let half = 0.5 * (matrix.x - matrix.z);
    let gap = sqrt(half * half + matrix.y * matrix.y);
    var axis = vec2f(matrix.y, gap - half);
    if half >= 0.0 {
        axis = vec2f(gap + half, matrix.y);
    }
    let size = length(axis);
    if size > 1.0e-12 {
        axis = axis / size;
    } else {
        axis = vec2f(1.0, 0.0);
    }
    return GlintRoughness(clamp(middle + gap, 0.0, 1.0), clamp(middle - gap, 0.0, 1.0), axis);
}

// `position` brought into the map: textures repeat, and far out f32 has no fractions of texels.
fn glint_into_map(maps: GlintAreaLightMaps, position: vec2f) -> vec2f {
    if !all(abs(position) <= vec2f(3.4028234e38)) {
        return vec2f(0.0);
    }
    var inside = position;
    if maps.wrap == 0u {
        inside = position - floor(position / maps.size) * maps.size;
    }
    return clamp(inside, -maps.size, 2.0 * maps.size);
}

// Mip of a footprint of `footprint_texels`, twice its standard deviation.
fn glint_area_light_level(maps: GlintAreaLightMaps, footprint_texels: f32) -> f32 {
    return clamp(log2(clamp(footprint_texels, 1.0, 1.0e9)), 0.0, f32(maps.mips - 1u));
}

// Unit vector along a mean normal. Normals of opposite sides can cancel; what is left has no direction then.
fn glint_mean_direction(mean: vec3f) -> vec3f {
    let size = length(mean);
    if size > 1.0e-4 {
        return mean / size;
    }
    return vec3f(0.0, 0.0, 1.0);
}

// What lies under a footprint of `footprint_texels` (twice its standard deviation, which is the edge of the texels whose
// bilinear look-up averages over as much) around `position`, in texels of the first mip; its roughness by direction only if
// `directional`.
fn glint_area_light_fetch(
    maps: GlintAreaLightMaps,
    position: vec2f,
    footprint_texels: f32,
    directional: bool,
) -> GlintAreaLightSurface {
    let place = glint_into_map(maps, position);
    let level = glint_area_light_level(maps, footprint_texels);
    let mean = glint_area_light_normals(place, level);
    // Under less than a texel the map is all but plane, and normals differ in proportion to the footprint.
    let fade = clamp(footprint_texels, 0.0, 1.0);
    let alpha = glint_alpha_of_code(mean.w) * fade;
    var by_direction = GlintRoughness(alpha, alpha, vec2f(1.0, 0.0));
    if directional && maps.anisotropic != 0u {
        let code = glint_area_light_principal(glint_area_light_roughness(place, level).xyz);
        by_direction =
            GlintRoughness(glint_alpha_of_code(code.major) * fade, glint_alpha_of_code(code.minor) * fade, code.axis);
    }
    return GlintAreaLightSurface(glint_mean_direction(mean.xyz), length(mean.xyz), alpha, by_direction);
}

// Radiance towards `view` (unit) of what lies under a pixel: base roughness `base_alpha` convolved with the meso roughness
// of all directions, or, with `lobes` above 0 (at most GLINT_MAX_LOBES), with that of each direction.
fn glint_surface_radiance(
    surface: GlintAreaLightSurface,
    base_alpha: f32,
    view: vec3f,
    f0: vec3f,
    light: GlintRectLight,
    lobes: u32,
) -> vec3f {
    if !glint_faces(light) {
        return vec3f(0.0);
    }
    // Without roughness by direction it is one lobe, alike in all directions.
    let count = clamp(lobes, 1u, GLINT_MAX_LOBES);
    var meso = surface.by_direction;
    if lobes == 0u {
        meso = GlintRoughness(surface.alpha, surface.alpha, vec2f(1.0, 0.0));
    }
    let spread = sqrt(max(meso.major * meso.major - meso.minor * meso.minor, 0.0));
    let minor = glint_convolve_alpha(base_alpha, meso.minor);
    let major = glint_convolve_alpha(minor, spread / f32(count));
    let frame = glint_tangent_frame(surface.normal);
    let along = frame.x * meso.axis.x + frame.y * meso.axis.y;
    var sum = vec3f(0.0);
    for (var k = 0u; k < count; k++) {
        // Share (k + 1/2) / count of the marginal of GGX: x = spread c / sqrt(1 - c^2).
        let c = f32(2u * k + 1u) / f32(count) - 1.0;
        let tilted = surface.normal + along * (spread * c / sqrt(1.0 - c * c));
        let normal = tilted / length(tilted);
        let own = glint_tangent_frame(normal);
        let axis = vec2f(dot(own.x, along), dot(own.y, along));
        let lobe = GlintRoughness(major, minor, axis / max(length(axis), 1.0e-6));
        sum += glint_lobe_radiance(normal, lobe, view, f0, light);
    }
    return sum / f32(count) * light.radiance;
}
