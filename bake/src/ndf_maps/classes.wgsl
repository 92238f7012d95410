// A surface of examples placed at random under a wide footprint: the top tile under every transform, by shares of cells. Deviates
// from Xing et al. 2024, section 6.3, where every example is visited; twin of glint-bake-core ndf_maps/surface.rs.

#import ndf_maps::regions

// Shares of four palette entries in one texel of the class texture.
fn glint_ndf_class_shares(material: GlintNdfMaterial, mip_words: u32, size: u32, layer: u32, block: vec2i) -> vec4f {
    let at = vec2u(block) & vec2u(size - 1u);
    let word = material.class_words + mip_words + layer * size * size + at.y * size + at.x;
    return unpack4x8unorm(glint_ndf_word(word));
}

// The top tile under every transform, by the share of cells that use it.
fn glint_ndf_classes(
    material: GlintNdfMaterial,
    ellipse: GlintNdfEllipse,
    cells: GlintNdfCells,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    let most = GLINT_NDF_MOST_OF_TERMS * f32(settings.max_terms);
    let layers = min((material.palette + 3u) / 4u, GLINT_NDF_MAX_LAYERS);
    var mip = 0u;
    var mip_words = 0u;
    var size = material.cells;
    var block = material.cell_texels;
    for (var k = 0u; k < 31u; k++) {
        let coarser = size > 1u
            && (2.0 * block <= settings.tile_sigmas * ellipse.minor || glint_ndf_pieces(ellipse, block) > most);
        if !coarser {
            break;
        }
        mip_words += size * size * layers;
        size /= 2u;
        mip += 1u;
        block *= 2.0;
    }
    let whole = size == 1u;
    // The block that holds the base cell, and where it begins.
    let first = cells.base >> vec2u(mip);
    let origin = vec2f((first << vec2u(mip)) - cells.base) * material.cell_texels;
    var widened = glint_ndf_widened(ellipse, block);
    widened.mean -= origin;
    // At a smaller reach a footprint might lie between the middles of its blocks.
    widened.reach = GLINT_NDF_REACH;
    let reach = glint_ndf_reach_y(widened);
    var rows = glint_ndf_cells(0.0, block, widened.mean.y - reach, widened.mean.y + reach);
    rows = select(rows, vec2i(0, 1), whole);
    let top = glint_ndf_top_tile(material);
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    // Four classes at a time, so that none needs an array.
    for (var layer = 0u; layer < layers; layer++) {
        var shares = vec4f(0.0);
        for (var j = rows.x; j < rows.y; j++) {
            let y = glint_ndf_cell_centre(0.0, block, j);
            let span = glint_ndf_span_x(widened, y);
            var columns = glint_ndf_cells(0.0, block, span.x, span.y);
            columns = select(columns, vec2i(0, 1), whole);
            for (var i = columns.x; i < columns.y; i++) {
                let centre = vec2f(glint_ndf_cell_centre(0.0, block, i), y);
                let weight = select(glint_ndf_gaussian(widened, centre) * block * block, 1.0, whole);
                shares += weight * glint_ndf_class_shares(material, mip_words, size, layer, first + vec2i(i, j));
            }
        }
        for (var k = 4u * layer; k < min(material.palette, 4u * layer + 4u); k++) {
            let low = select(shares.x, shares.y, (k & 1u) == 1u);
            let high = select(shares.z, shares.w, (k & 1u) == 1u);
            let weight = select(low, high, (k & 2u) == 2u);
            if weight > 0.0 {
                let normal = bitcast<vec4f>(glint_ndf_record(material.palette_records + 2u * k + 1u));
                let density = glint_ndf_tile_density(material, top, glint_ndf_apply(normal, s));
                sum.density += weight * abs(glint_ndf_determinant(normal)) * density;
                sum.share += weight;
                sum.terms += 1.0;
            }
        }
    }
    return sum;
}
