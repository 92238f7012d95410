// Density of one NDF tile, decoded and filtered as it is stored. Xing et al. 2024, section 5; twin of glint-bake-core
// ndf_maps/{eval,spline}.rs.

#import ndf_maps::material

// Quadratic B-splines at p, in node distances from node 0: weights of the nodes floor(p + 1/2) - 1 and the next two.
fn glint_ndf_spline(p: f32) -> vec3f {
    let f = p - floor(p + 0.5);
    return vec3f(0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f));
}

// Density texels `at`, at + 1 and at + 2, relative to their tile's scale.
fn glint_ndf_texels(material: GlintNdfMaterial, at: i32) -> vec3f {
    if material.storage == GLINT_NDF_SQRT_U8 {
        let word = at >> 2u;
        let shift = u32(at & 3) * 8u;
        var bits = glint_ndf_word(material.density_words + u32(max(word, 0))) >> shift;
        if shift > 8u {
            bits |= glint_ndf_word(material.density_words + u32(word + 1)) << (32u - shift);
        }
        let root = vec3f(f32(bits & 255u), f32((bits >> 8u) & 255u), f32((bits >> 16u) & 255u)) / 255.0;
        return root * root;
    }
    if material.storage == GLINT_NDF_F16 {
        let word = at >> 1u;
        let a = unpack2x16float(glint_ndf_word(material.density_words + u32(max(word, 0))));
        let b = unpack2x16float(glint_ndf_word(material.density_words + u32(word + 1)));
        return select(vec3f(a, b.x), vec3f(a.y, b), (at & 1) == 1);
    }
    let first = material.density_words + u32(max(at, 0));
    return vec3f(
        bitcast<f32>(glint_ndf_word(first)),
        bitcast<f32>(glint_ndf_word(material.density_words + u32(at + 1))),
        bitcast<f32>(glint_ndf_word(material.density_words + u32(at + 2))),
    );
}

// Weighted sum of those of the three density texels from `at` on that lie inside the tile.
fn glint_ndf_row(material: GlintNdfMaterial, at: i32, weights: vec3f, inside: vec3<bool>) -> f32 {
    if !any(inside) {
        return 0.0;
    }
    // What lies beyond the tile may be no number.
    let v = select(vec3f(0.0), glint_ndf_texels(material, at), inside);
    return weights.x * v.x + weights.y * v.y + weights.z * v.z;
}

// Of a tile in blocks, at p (in texels from its first one): each place of the splines has its three by three texels together, those
// beyond the tile as zeros, so that one load has them all. A tile of w x h texels has (w + 2) (h + 2) blocks, by rows, from `first`
// on; the block at (i, j) begins at texel (i - 2, j - 2).
fn glint_ndf_block_density(first: u32, size: vec2i, p: vec2f) -> f32 {
    let node = floor(p + 0.5);
    let f = p - node;
    let at = clamp(vec2i(node) + 1, vec2i(0), size + 1);
    let rows = glint_ndf_block(first + u32(at.y * (size.x + 2) + at.x));
    let low = (0.5 - f) * (0.5 - f);
    let high = (0.5 + f) * (0.5 + f);
    let middle = 1.5 - 2.0 * f * f;
    let across = vec3f(low.x, middle.x, high.x);
    let top = vec3f(f32(rows.x & 255u), f32((rows.x >> 8u) & 255u), f32(rows.x >> 16u));
    let centre = vec3f(f32(rows.y & 255u), f32((rows.y >> 8u) & 255u), f32(rows.y >> 16u));
    let bottom = vec3f(f32(rows.z & 255u), f32((rows.z >> 8u) & 255u), f32(rows.z >> 16u));
    // Texels are squares of n / 255; both splines are halves of these weights.
    return (low.y * dot(across, top * top) + middle.y * dot(across, centre * centre) + high.y * dot(across, bottom * bottom))
        * (0.25 / 65025.0);
}

// Density of one tile at the example's projected normal `s`: quadratic splines over decoded texels (bilinear for the paper's
// storage), 0 outside the box.
fn glint_ndf_tile_density(material: GlintNdfMaterial, tile: u32, s: vec2f) -> f32 {
    if dot(s, s) > 1.0 {
        return 0.0;
    }
    let at = material.tile_records + 2u * tile;
    var place: vec4f;
    var texels: vec4u;
    if material.few_tiles == 1u {
        place = bitcast<vec4f>(glint_ndf_record(at));
        texels = glint_ndf_record(at + 1u);
    } else {
        place = bitcast<vec4f>(glint_ndf_tile(at));
        texels = glint_ndf_tile(at + 1u);
    }
    let size = vec2i(vec2u(texels.z & 0xffffu, texels.z >> 16u));
    let p = (s - place.xy) * place.zw;
    if !(all(p >= vec2f(-1.5)) && all(p <= vec2f(size) + 0.5)) {
        return 0.0;
    }
    if material.blocks == 1u {
        return bitcast<f32>(texels.x) * glint_ndf_block_density(texels.w, size, p);
    }
    var first = vec2i(floor(p + 0.5)) - 1;
    var across = glint_ndf_spline(p.x);
    var down = glint_ndf_spline(p.y);
    if material.storage == GLINT_NDF_PAPER_F32 {
        let cell = floor(p);
        let f = p - cell;
        first = vec2i(cell);
        across = vec3f(1.0 - f.x, f.x, 0.0);
        down = vec3f(1.0 - f.y, f.y, 0.0);
    }
    let columns = first.x + vec3i(0, 1, 2);
    let inside = columns >= vec3i(0) & columns < vec3i(size.x);
    let start = i32(texels.y) + first.y * size.x + first.x;
    let sum = down.x * glint_ndf_row(material, start, across, inside & vec3<bool>(first.y >= 0 && first.y < size.y))
        + down.y
            * glint_ndf_row(material, start + size.x, across, inside & vec3<bool>(first.y >= -1 && first.y + 1 < size.y))
        + down.z
            * glint_ndf_row(material, start + 2 * size.x, across, inside & vec3<bool>(first.y >= -2 && first.y + 2 < size.y));
    return bitcast<f32>(texels.x) * sum;
}
