// NDF maps under light from all around: the environment as the mean normal and the roughness of the pixel's footprint reflect it, in one
// or two layers; a clear coat over the base after Xing et al. 2024, Eq. 3. The reference reflects it at the micro-normals of places in
// the footprint, one a frame.

#import shade_ndf_maps
#import shade_environment_levels
#import hash
#import moments
#import ndf_maps::moments

// Least cosine between a mean normal and the view: one that turns away is bent back, as the facets that are seen do not.
const SHADE_NDF_LEAST_COSINE: f32 = 0.05;

fn shade_ndf_place(point: ViewPoint) -> GlintFootprint {
    let footprint = shade_ndf_footprint(point);
    if !REFERENCE {
        return footprint;
    }
    let state = glint_cell_state(bitcast<u32>(point.uv.x), bitcast<u32>(point.uv.y), scene.frame);
    let radius = material.pixel_sigma * sqrt(-2.0 * log(1.0 - glint_draw_uniform(state, 0u)));
    let angle = 6.2831853 * glint_draw_uniform(state, 1u);
    let place = point.uv + point.d_dx * (radius * cos(angle)) + point.d_dy * (radius * sin(angle));
    return GlintFootprint(place * material.texels_per_unit, 0.0, 0.0, 0.0);
}

// A layer as a smooth surface of the environment. Roughness that differs between the axes is taken as the round one of the same peak.
fn shade_ndf_rough(point: ViewPoint, layer: u32, f0: vec3f) -> GlintSurface {
    let moments = glint_ndf_moments(shade_ndf_material(layer), shade_ndf_place(point), shade_ndf_settings());
    let rough = glint_rough_normal(moments);
    let turned = max(SHADE_NDF_LEAST_COSINE - dot(rough.normal, point.view), 0.0);
    let seen = normalize(rough.normal + turned * point.view);
    let normal = scene.environment_from_world * view_to_world(point, seen);
    let view = scene.environment_from_world * view_to_world(point, point.view);
    return GlintSurface(normal, view, sqrt(rough.alpha.x * rough.alpha.y), f0, 0.0);
}

fn shade_environment(point: ViewPoint) -> vec3f {
    let layered = NDF_MAPS_LAYERED && ndf_maps_layers.count > 1u;
    let swap = select(0u, material.switches & SHADE_NDF_SWAP, layered);
    let lower = shade_ndf_rough(point, swap, material.f0);
    let data = shade_environment_data();
    let base = glint_environment_smooth(data, lower);
    if !layered {
        return base * scene.environment_gain;
    }
    let coat_f0 = vec3f(ndf_maps_layers.coat_f0);
    let upper = shade_ndf_rough(point, 1u - swap, coat_f0);
    let through = vec3f(1.0) - glint_fresnel(coat_f0, dot(upper.normal, upper.view));
    return (base * through + glint_environment_smooth(data, upper)) * scene.environment_gain;
}
