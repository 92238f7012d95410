// What glTF's metallic-roughness materials reflect: GGX with height-correlated masking, and diffuse light of what is not metal.
// (glTF 2.0 specification, appendix B.) Directions are unit vectors in one frame.

#import ggx

struct ShadeTexturesSurface {
    // Unit normal.
    normal: vec3f,
    // GGX roughness.
    alpha: f32,
    // Reflectance at normal incidence.
    f0: vec3f,
    // Share of the light that gets to a point from around it.
    occlusion: f32,
    // Albedo of what is scattered below the surface.
    diffuse: vec3f,
    // Radiance that the surface emits.
    emitted: vec3f,
}

// BRDF times the cosine of the light over the surface's own normal; 0 unless both directions are above it.
fn shade_textures_brdf(surface: ShadeTexturesSurface, view: vec3f, light: vec3f) -> vec3f {
    let cos_l = dot(surface.normal, light);
    if !(dot(surface.normal, view) > 0.0 && cos_l > 0.0) {
        return vec3f(0.0);
    }
    let specular = glint_ggx_cosine(surface.normal, view, light, surface.alpha, surface.f0);
    let entering = vec3f(1.0) - glint_fresnel(surface.f0, dot(view, glint_half_vector(view, light)));
    return specular + entering * surface.diffuse * (cos_l / 3.14159265);
}
