// Directions of light in proportion to what a material of counted facets reflects on average, for path tracers. Twin of sampling.rs, where
// formulas and their sources are. Directions are unit vectors in the tangent frame.
//
// Accessors: those of glints/eval.wgsl.

#import glints::eval

// Chances of the lobes: facets, scattered light, coat; 1 together.
fn glint_lobe_chances(material: GlintCountedMaterial, cos_view: f32) -> vec3f {
    let reflected = glint_fresnel(material.f0, cos_view);
    let through = glint_coat_through(material.layers, cos_view);
    let scattering = material.layers.diffuse * (vec3f(1.0) - reflected);
    let facets = max(max(reflected.x, reflected.y), reflected.z) * through;
    let scattered = max(max(scattering.x, scattering.y), scattering.z) * through;
    let coat = material.layers.coat * glint_fresnel(GLINT_COAT_F0, cos_view).x;
    // A material that reflects nothing is sampled by its facets.
    let all_lobes = vec3f(facets + 1.0e-6, scattered, coat);
    return all_lobes / (all_lobes.x + all_lobes.y + all_lobes.z);
}

// A direction of light for `view` and three uniform numbers in [0, 1): its density is glint_counted_pdf. Below the surface it counts as
// one that brings nothing.
fn glint_counted_sample(material: GlintCountedMaterial, view: vec3f, random: vec3f) -> vec3f {
    let chances = glint_lobe_chances(material, view.z);
    let numbers = random.yz;
    if random.x >= chances.x && random.x < chances.x + chances.y {
        let across = sqrt(numbers.y);
        let angle = 6.2831853 * numbers.x;
        return vec3f(across * cos(angle), across * sin(angle), sqrt(1.0 - numbers.y));
    }
    let seen = glint_turned(material.turn, view);
    var taken = glint_coat_surface(material.layers);
    if random.x < chances.x {
        taken = glint_smooth_surface(material);
    }
    let normal = glint_mirror_normal(taken, seen, numbers);
    let light = normal * (2.0 * dot(seen, normal)) - seen;
    return glint_turned(material.turn * vec2f(1.0, -1.0), light);
}

// Density over solid angle, 1/sr, of glint_counted_sample at `light`; 0 unless both directions are above the surface.
fn glint_counted_pdf(material: GlintCountedMaterial, view: vec3f, light: vec3f) -> f32 {
    if !(view.z > 0.0 && light.z > 0.0) {
        return 0.0;
    }
    let chances = glint_lobe_chances(material, view.z);
    let seen = glint_turned(material.turn, view);
    let towards = glint_turned(material.turn, light);
    return chances.x * glint_mirror_pdf(glint_smooth_surface(material), seen, towards)
        + chances.y * (light.z * 0.31830989)
        + chances.z * glint_mirror_pdf(glint_coat_surface(material.layers), seen, towards);
}
