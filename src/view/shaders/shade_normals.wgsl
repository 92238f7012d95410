// What methods of normal maps share: densities over projected normals as radiance, and one sample of the reference.

#import view_scene
#import brdf

// BRDF times n.l of a density over the disk of projected normals at the half vector. Projected solid angle is area of the disk,
// so that the density is the microfacet distribution D.
fn shade_projected(density: f32, point: ViewPoint, light: vec3f, half: vec3f) -> vec3f {
    return glint_facet_brdf(vec3f(density), material.f0, point.view, light) * light.z;
}

// A place of the pixel's Gaussian footprint, in surface units (Box-Muller).
fn shade_normal_place(point: ViewPoint, random: vec2f) -> vec2f {
    let radius = material.pixel_sigma * sqrt(-2.0 * log(1.0 - random.x));
    let angle = 6.2831853 * random.y;
    return point.uv + point.d_dx * (radius * cos(angle)) + point.d_dy * (radius * sin(angle));
}

// Density at `s` of a facet whose projected normal is `normal`: a Gaussian of the intrinsic roughness.
fn shade_facet(s: vec2f, normal: vec2f) -> f32 {
    let variance = material.intrinsic_roughness * material.intrinsic_roughness;
    let d = s - normal;
    return exp(-0.5 * dot(d, d) / variance) / (6.2831853 * variance);
}
