// Accessors of area_light/{eval,rect}.wgsl by samplers: one look-up a texture. GPUs may take the place between
// texels and mips in steps of 1/256.

#import bind_area_light
#import bind_loads

fn glint_area_light_normals(position: vec2f, level: f32) -> vec4f {
    bound_loads += 1u;
    return textureSampleLevel(area_light_normals, area_light_sampler, position / area_light_maps.size, level);
}

fn glint_area_light_roughness(position: vec2f, level: f32) -> vec4f {
    bound_loads += 1u;
    return textureSampleLevel(area_light_roughness, area_light_sampler, position / area_light_maps.size, level);
}

fn area_light_table_uv(place: vec2f) -> vec2f {
    return (place + 0.5) / GLINT_LTC_SIZE;
}

fn glint_ltc_inverse(place: vec2f) -> vec4f {
    bound_loads += 1u;
    return textureSampleLevel(area_light_inverse, area_light_table_sampler, area_light_table_uv(place), 0.0);
}

fn glint_ltc_terms(place: vec2f) -> vec4f {
    bound_loads += 1u;
    return textureSampleLevel(area_light_terms, area_light_table_sampler, area_light_table_uv(place), 0.0);
}
