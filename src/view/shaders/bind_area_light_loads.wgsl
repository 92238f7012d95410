// Accessors of area_light/{eval,rect}.wgsl by loads of single texels: filtered with all digits of a float, as
// the CPU twin does, which samplers do not promise.

#import bind_area_light

// Four texels, and the place between them.
struct AreaLightCell {
    low: vec2i,
    high: vec2i,
    mip: u32,
    f: vec2f,
}

fn area_light_wrapped(i: vec2i, size: vec2i) -> vec2i {
    if area_light_maps.wrap == 0u {
        // Positions lie within a map's size of the map.
        return (i + 4 * size) % size;
    }
    return clamp(i, vec2i(0), size - 1);
}

// The texels around `position`, in texels of the first mip, in one mip.
fn area_light_cell(position: vec2f, mip: u32) -> AreaLightCell {
    let size = max(vec2u(area_light_maps.size) >> vec2u(mip), vec2u(1u));
    let p = position / area_light_maps.size * vec2f(size) - 0.5;
    let cell = floor(p);
    let i = vec2i(cell);
    return AreaLightCell(area_light_wrapped(i, vec2i(size)), area_light_wrapped(i + 1, vec2i(size)), mip, p - cell);
}

fn area_light_bilinear(map: texture_2d<f32>, position: vec2f, mip: u32) -> vec4f {
    let c = area_light_cell(position, mip);
    let low = mix(textureLoad(map, c.low, c.mip), textureLoad(map, vec2i(c.high.x, c.low.y), c.mip), c.f.x);
    let high = mix(textureLoad(map, vec2i(c.low.x, c.high.y), c.mip), textureLoad(map, c.high, c.mip), c.f.x);
    return mix(low, high, c.f.y);
}

fn area_light_trilinear(map: texture_2d<f32>, position: vec2f, level: f32) -> vec4f {
    let low = min(u32(level), area_light_maps.mips - 1u);
    let high = min(low + 1u, area_light_maps.mips - 1u);
    let near = area_light_bilinear(map, position, low);
    return mix(near, area_light_bilinear(map, position, high), level - f32(low));
}

fn area_light_table(table: texture_2d<f32>, place: vec2f) -> vec4f {
    let p = clamp(place, vec2f(0.0), vec2f(GLINT_LTC_SIZE - 1.0));
    let i = min(vec2u(p), vec2u(u32(GLINT_LTC_SIZE) - 2u));
    let f = p - vec2f(i);
    let low = mix(textureLoad(table, i, 0), textureLoad(table, i + vec2u(1u, 0u), 0), f.x);
    let high = mix(textureLoad(table, i + vec2u(0u, 1u), 0), textureLoad(table, i + vec2u(1u), 0), f.x);
    return mix(low, high, f.y);
}

fn glint_area_light_normals(position: vec2f, level: f32) -> vec4f {
    return area_light_trilinear(area_light_normals, position, level);
}

fn glint_area_light_roughness(position: vec2f, level: f32) -> vec4f {
    return area_light_trilinear(area_light_roughness, position, level);
}

fn glint_ltc_inverse(place: vec2f) -> vec4f {
    return area_light_table(area_light_inverse, place);
}

fn glint_ltc_terms(place: vec2f) -> vec4f {
    return area_light_table(area_light_terms, place);
}
