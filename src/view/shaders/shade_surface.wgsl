// A surface synthesised by patches of a normal map, by the lobes of the map. Uses the material as shade_lobes.wgsl. The
// program takes in lobes::packed or lobes::half, synthesis::grid or synthesis::tiles, and surface::blocks (or surface::seams, at
// many times the cost near seams) as well.

#import shade_normals
#import bind_lobes
#import surface::eval

// Whether mass beyond the rim is given back, see glint_lobes_rim.
override LOBES_RIM: bool = true;

fn shade_surface_query(point: ViewPoint, s: vec2f) -> GlintSurfaceQuery {
    let texels = material.texels_per_unit;
    let footprint =
        glint_footprint_of_pixel(point.uv * texels, point.d_dx * texels, point.d_dy * texels, material.pixel_sigma);
    return glint_surface_query(
        lobes.map, lobes.synthesis, footprint, s, material.intrinsic_roughness, glint_surface_realtime(),
    );
}

fn shade_reflect(point: ViewPoint, light: vec3f) -> vec3f {
    glint_lobes_rim = LOBES_RIM;
    let half = glint_half_vector(point.view, light);
    return shade_projected(glint_surface_p_ndf(shade_surface_query(point, half.xy)), point, light, half);
}

// The surface's normal at one place of the footprint, with the intrinsic roughness.
fn shade_reference(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f {
    let half = glint_half_vector(point.view, light);
    var query = shade_surface_query(point, half.xy);
    let d = (shade_normal_place(point, random) - point.uv) * material.texels_per_unit;
    let normal = glint_surface_patch_at(query, query.point.frame.mean + d).normal;
    return shade_projected(shade_facet(half.xy, normal), point, light, half);
}

fn shade_lod(point: ViewPoint) -> f32 {
    let query = shade_surface_query(point, vec2f(0.0));
    let lod = glint_lobes_lod(query.map, query.point.frame, query.settings.lobes);
    return f32(lod.finer) + lod.fraction;
}
