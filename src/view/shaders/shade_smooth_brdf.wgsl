// The smooth BRDF that glints converge to: Beckmann or GGX slopes of the material's roughness.

#import view_scene
#import brdf

fn shade_smooth_brdf(view: vec3f, light: vec3f) -> vec3f {
    let half = glint_half_vector(view, light);
    let v = glint_normal_to_slope(half) / material.alpha;
    let q = dot(v, v);
    let area = 3.14159265 * material.alpha.x * material.alpha.y;
    var sdf = 0.0;
    if NORMAL_TARGET == 1u {
        sdf = 1.0 / (area * (1.0 + q) * (1.0 + q));
    } else {
        sdf = exp(-q) / area;
    }
    return glint_facet_brdf(glint_sdf_to_ndf(vec3f(sdf), half.z), material.f0, view, light);
}
