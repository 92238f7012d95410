// A material as textures with mips, as any engine draws it: trilinear look-ups, then one BRDF. The reference reads the first mip at
// places of the pixel's Gaussian, one a frame, the same for all lights.

#import view_scene
#import view_sky
#import shade_environment_levels
#import bind_loads
#import bind_textures
#import hash
#import shade_textures_brdf

// Rougher than the map's own texels tell apart, see LEAST_ALPHA of the reference.
const SHADE_TEXTURES_LEAST_ALPHA: f32 = 1.0e-3;

// Where a pixel reads: texture coordinates and their derivatives.
struct ShadeTexturesPlace {
    uv: vec2f,
    d_dx: vec2f,
    d_dy: vec2f,
}

// Read once, however many lights there are.
var<private> shade_textures_found: ShadeTexturesSurface;
var<private> shade_textures_is_found: bool = false;

fn shade_textures_place(point: ViewPoint) -> ShadeTexturesPlace {
    let scale = material.texels_per_unit / textures.texels;
    var uv = point.uv;
    if REFERENCE {
        let state = glint_cell_state(bitcast<u32>(point.uv.x), bitcast<u32>(point.uv.y), scene.frame);
        let radius = material.pixel_sigma * sqrt(-2.0 * log(1.0 - glint_draw_uniform(state, 0u)));
        let angle = 6.2831853 * glint_draw_uniform(state, 1u);
        uv += point.d_dx * (radius * cos(angle)) + point.d_dy * (radius * sin(angle));
    }
    return ShadeTexturesPlace(uv * scale, point.d_dx * scale, point.d_dy * scale);
}

// Level of detail of a texture: one texel a pixel along the longer side of what the pixel covers.
fn shade_textures_level(at: ShadeTexturesPlace, slot: u32) -> f32 {
    let place = textures.places[slot];
    let linear = mat2x2f(place.linear.xy, place.linear.zw);
    let dx = linear * at.d_dx * place.size;
    let dy = linear * at.d_dy * place.size;
    return max(0.5 * log2(max(max(dot(dx, dx), dot(dy, dy)), 1.0e-20)), 0.0);
}

fn shade_textures_read(map: texture_2d<f32>, filtering: sampler, slot: u32, at: ShadeTexturesPlace) -> vec4f {
    bound_loads += 1u;
    let place = textures.places[slot];
    let uv = mat2x2f(place.linear.xy, place.linear.zw) * at.uv + place.offset;
    if REFERENCE {
        return textureSampleLevel(map, filtering, uv, 0.0);
    }
    return textureSampleLevel(map, filtering, uv, shade_textures_level(at, slot));
}

fn shade_textures_surface(point: ViewPoint) -> ShadeTexturesSurface {
    if shade_textures_is_found {
        return shade_textures_found;
    }
    let at = shade_textures_place(point);
    let base = shade_textures_read(textures_base_colour, textures_base_colour_sampler, 0u, at).rgb
        * mix(textures.base_colour, material.f0, textures.own_colour);
    let normal = shade_textures_read(textures_normal, textures_normal_sampler, 1u, at).xyz * 2.0 - 1.0;
    let rough = shade_textures_read(textures_roughness, textures_roughness_sampler, 2u, at);
    let occlusion = shade_textures_read(textures_occlusion, textures_occlusion_sampler, 3u, at).r;
    let metallic = rough.b * textures.metallic;
    let perceptual = rough.g * textures.roughness;
    let scaled = normal * vec3f(textures.normal_scale, textures.normal_scale, 1.0);
    var surface: ShadeTexturesSurface;
    // Opposite normals may have a mean of no length.
    surface.normal = scaled * inverseSqrt(max(dot(scaled, scaled), 1.0e-12));
    surface.alpha = max(perceptual * perceptual, SHADE_TEXTURES_LEAST_ALPHA);
    surface.f0 = mix(vec3f(0.04), base, metallic);
    surface.diffuse = base * (1.0 - metallic);
    surface.occlusion = 1.0 + textures.occlusion_strength * (occlusion - 1.0);
    if EMITS {
        surface.emitted = textures.emissive
            * shade_textures_read(textures_emissive, textures_emissive_sampler, 4u, at).rgb;
    }
    shade_textures_found = surface;
    shade_textures_is_found = true;
    return surface;
}

fn shade_reflect(point: ViewPoint, light: vec3f) -> vec3f {
    return shade_textures_brdf(shade_textures_surface(point), point.view, light);
}

fn shade_reference(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f {
    return shade_reflect(point, light);
}

// Light from everywhere: what reflection and scattering leave of it. `normal` and `view` are the surface's in the world.
fn shade_environment(point: ViewPoint) -> vec3f {
    let surface = shade_textures_surface(point);
    let normal = scene.environment_from_world * view_to_world(point, surface.normal);
    let view = scene.environment_from_world * view_to_world(point, point.view);
    let smooth_surface = GlintSurface(normal, view, surface.alpha, surface.f0, 0.0);
    let data = shade_environment_data();
    let specular = glint_environment_smooth(data, smooth_surface);
    // The widest reflection stands for light from the half space.
    let around = glint_environment_filtered(normal, glint_environment_roughness(data, 1.0)).rgb;
    let entering = vec3f(1.0) - glint_fresnel(surface.f0, dot(normal, view));
    return (specular + entering * surface.diffuse * around) * (surface.occlusion * scene.environment_gain);
}

fn shade_room(point: ViewPoint) -> vec3f {
    let surface = shade_textures_surface(point);
    let cos_v = dot(surface.normal, point.view);
    let mirrored = view_sky(view_to_world(point, 2.0 * cos_v * surface.normal - point.view));
    let around = view_sky(view_to_world(point, surface.normal));
    let reflected = glint_fresnel(surface.f0, cos_v);
    return (reflected * mirrored + (vec3f(1.0) - reflected) * surface.diffuse * around) * surface.occlusion;
}

fn shade_emitted(point: ViewPoint) -> vec3f {
    return shade_textures_surface(point).emitted;
}

fn shade_lod(point: ViewPoint) -> f32 {
    return shade_textures_level(shade_textures_place(point), 1u);
}
