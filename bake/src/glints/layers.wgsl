// What counted facets lie on and under: light that is scattered below them, and a smooth clear coat over both. Twin of layers.rs, where
// formulas are derived. Directions are unit vectors in the frame of the roughness.
//
// Accessors: those of area_light/rect.wgsl.

#import brdf
#import microfacet
#import area_light::rect

// Reflectance of a coat at normal incidence: that of an index of refraction of 1.5.
const GLINT_COAT_F0: vec3f = vec3f(0.04);

// What facets lie on and under.
struct GlintLayers {
    // Albedo of what is scattered below the facets, linear RGB; black for metals.
    diffuse: vec3f,
    // Weight of the coat, 0 for none to 1.
    coat: f32,
    // GGX roughness of the coat, 1e-3 to 1.
    coat_alpha: f32,
}

// The smooth surface that a coat is.
fn glint_coat_surface(layers: GlintLayers) -> GlintSmoothSurface {
    return GlintSmoothSurface(vec2f(layers.coat_alpha * layers.coat_alpha), GLINT_MICROFACET_GGX);
}

// Share that a coat leaves of what lies under it, for a view of this cosine.
fn glint_coat_through(layers: GlintLayers, cos_view: f32) -> f32 {
    if !(layers.coat > 0.0) {
        return 1.0;
    }
    return 1.0 - layers.coat * glint_fresnel(GLINT_COAT_F0, cos_view).x;
}

// Albedo, linear RGB, of what is scattered below facets and coat, for a view of this cosine.
fn glint_scattered(layers: GlintLayers, f0: vec3f, cos_view: f32) -> vec3f {
    return layers.diffuse * (vec3f(1.0) - glint_fresnel(f0, cos_view)) * glint_coat_through(layers, cos_view);
}

// What a light that is a cone of `solid_angle` around `direction` adds to its facets, over its irradiance, linear RGB; 0 unless both directions
// are above the surface.
fn glint_cone_layers(layers: GlintLayers, f0: vec3f, view: vec3f, direction: vec3f, solid_angle: f32) -> vec3f {
    var sum = vec3f(0.0);
    if !(view.z > 0.0 && direction.z > 0.0) {
        return sum;
    }
    if any(layers.diffuse > vec3f(0.0)) {
        sum = glint_scattered(layers, f0, view.z) * (direction.z * 0.31830989);
    }
    if layers.coat > 0.0 {
        let half = glint_half_vector(view, direction);
        let cos_h = dot(view, half);
        let seen = glint_microfacet_under_cone(glint_coat_surface(layers), view, solid_angle, cos_h);
        let reflected = glint_microfacet_ndf(seen, half) * glint_microfacet_masked(seen, view, direction);
        sum += glint_fresnel(GLINT_COAT_F0, cos_h) * (layers.coat * reflected);
    }
    return sum;
}

// What a rectangle adds to its facets, linear RGB.
fn glint_rect_layers(layers: GlintLayers, f0: vec3f, view: vec3f, light: GlintRectLight) -> vec3f {
    var sum = vec3f(0.0);
    if !(view.z > 0.0 && glint_faces(light)) {
        return sum;
    }
    if any(layers.diffuse > vec3f(0.0)) {
        let form_factor = glint_quad_form_factor(light.corner_0, light.corner_1, light.corner_2, light.corner_3);
        sum = glint_scattered(layers, f0, view.z) * light.radiance * form_factor;
    }
    if layers.coat > 0.0 {
        let up = vec3f(0.0, 0.0, 1.0);
        sum += glint_isotropic_radiance(up, layers.coat_alpha, view, GLINT_COAT_F0, light) * layers.coat;
    }
    return sum;
}

// What an environment adds to its facets, linear RGB: `around` is the mean radiance that falls on the surface, by the cosine, and `reflected` the smooth
// reflection of a surface of GLINT_COAT_F0 and the coat's roughness.
fn glint_sky_layers(layers: GlintLayers, f0: vec3f, cos_view: f32, around: vec3f, reflected: vec3f) -> vec3f {
    var sum = reflected * layers.coat;
    if any(layers.diffuse > vec3f(0.0)) {
        sum += glint_scattered(layers, f0, cos_view) * around;
    }
    return sum;
}
