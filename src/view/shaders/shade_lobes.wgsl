// A surface that repeats a normal map, by the map's lobes. material.intrinsic_roughness is the width of a facet's lobe,
// material.texels_per_unit the map's scale, material.pixel_sigma the pixel's filter. The program
// takes in lobes::packed or lobes::half as well, as the pack stores lobes.

#import shade_normals
#import bind_lobes

// Whether mass beyond the rim is given back, see glint_lobes_rim.
override LOBES_RIM: bool = true;

fn shade_lobes_footprint(point: ViewPoint) -> GlintFootprint {
    let texels = material.texels_per_unit;
    return glint_footprint_of_pixel(point.uv * texels, point.d_dx * texels, point.d_dy * texels, material.pixel_sigma);
}

fn shade_reflect(point: ViewPoint, light: vec3f) -> vec3f {
    glint_lobes_rim = LOBES_RIM;
    let half = glint_half_vector(point.view, light);
    let frame = glint_lobes_frame_in_map(lobes.map, shade_lobes_footprint(point));
    let query = glint_lobes_query(frame, half.xy, material.intrinsic_roughness);
    return shade_projected(glint_lobes_p_ndf(lobes.map, query, glint_lobes_realtime()), point, light, half);
}

// The map's normal at one place of the footprint, with the intrinsic roughness.
fn shade_reference(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f {
    let half = glint_half_vector(point.view, light);
    let texels = material.texels_per_unit;
    let at = shade_normal_place(point, random) * texels;
    let size = vec2f(f32(lobes.map.width), f32(lobes.map.height));
    let normal = glint_lobes_surface_at(lobes.map, at - floor(at / size) * size).normal;
    return shade_projected(shade_facet(half.xy, normal), point, light, half);
}

fn shade_lod(point: ViewPoint) -> f32 {
    let frame = glint_lobes_frame_in_map(lobes.map, shade_lobes_footprint(point));
    let lod = glint_lobes_lod(lobes.map, frame, glint_lobes_realtime());
    return f32(lod.finer) + lod.fraction;
}
