// What a footprint sees of a surface covered with examples, side by side or at random: the density of its normals. Xing et al. 2024,
// section 6.3; twin of query.rs, whose numbers of 64 bits are products of halves here. See eval.wgsl for the accessors.

#import ndf_maps::regions

// From this minor axis on (in example edges) the top tile is enough for tiled examples.
const GLINT_NDF_TOP_TILE_SIGMA: f32 = 0.5;
// Rows of the reach mask, one record each of 128 bits.
const GLINT_NDF_REACH_ROWS: u32 = 128u;

// m x modulo `period` (a whole number), nearest to 0; exact up to the last sum however large x is, by products of halves.
fn glint_ndf_product_within(m: f32, x: f32, period: f32) -> f32 {
    let mh = glint_upper_half(m);
    let xh = glint_upper_half(x);
    return (glint_ndf_rest_of(mh * xh, period) + glint_ndf_rest_of(mh * (x - xh), period))
        + (glint_ndf_rest_of((m - mh) * xh, period) + glint_ndf_rest_of((m - mh) * (x - xh), period));
}

// x modulo `period`, nearest to 0.
fn glint_ndf_rest_of(x: f32, period: f32) -> f32 {
    let exact = glint_keep(x);
    return glint_keep(exact - glint_keep(round(exact / period) * period));
}

// The point of a tiled example that lies at a surface position, within the example.
fn glint_ndf_tiled_place(material: GlintNdfMaterial, position: vec4f, place: vec2f) -> vec2f {
    let size = vec2f(material.size);
    let local = vec2f(
        glint_ndf_product_within(position.x, place.x, size.x) + glint_ndf_product_within(position.y, place.y, size.x),
        glint_ndf_product_within(position.z, place.x, size.y) + glint_ndf_product_within(position.w, place.y, size.y),
    );
    return local - floor(local / size) * size;
}

fn glint_ndf_tiled(
    material: GlintNdfMaterial,
    footprint: GlintFootprint,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    let position = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records));
    let normal = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 1u));
    let size = vec2f(material.size);
    let within = glint_ndf_tiled_place(material, position, footprint.mean);
    let ellipse = glint_ndf_transformed(glint_ndf_ellipse(footprint, settings.reach), position, within);
    let jacobian = abs(glint_ndf_determinant(normal));
    let local_s = glint_ndf_apply(normal, s);
    let detail = glint_ndf_detail(material, ellipse, settings);
    let wide = ellipse.minor >= GLINT_NDF_TOP_TILE_SIGMA * max(size.x, size.y);
    if wide || detail.level == i32(material.levels) - 1 {
        return GlintNdfSum(jacobian * glint_ndf_tile_density(material, glint_ndf_top_tile(material), local_s), 1.0, 1.0);
    }
    // A sub-region without end.
    let view =
        GlintNdfView(ellipse, within, vec4f(1.0, 0.0, 0.0, 1.0), 1.0, 1.0e20, vec2f(1.0), jacobian);
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    if detail.level >= 0 {
        sum = glint_ndf_tiles(material, view, settings, local_s, u32(detail.level));
    }
    if !(sum.share > 0.0) {
        var at_point = detail.level >= 0;
        for (var k = 0; k < 2; k++) {
            sum = glint_ndf_boxes(material, view, local_s, detail.edge, at_point);
            // None has a share: the place alone.
            if sum.share > 0.0 {
                break;
            }
            at_point = true;
        }
    }
    return sum;
}

// The density over the disk of projected normals, at `s`, of what lies under a footprint (surface texels); 0 outside the disk.
// Also the number of tiles and lobes that it took.
fn glint_ndf_density(
    material: GlintNdfMaterial,
    footprint: GlintFootprint,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    if dot(s, s) > 1.0 {
        return GlintNdfSum(0.0, 1.0, 0.0);
    }
    var sum: GlintNdfSum;
    if material.cells == 0u {
        sum = glint_ndf_tiled(material, footprint, settings, s);
    } else {
        sum = glint_ndf_stochastic(material, footprint, settings, s);
    }
    return GlintNdfSum(sum.density / sum.share, sum.share, sum.terms);
}

// Whether any footprint sees normals near `s`: a bit a cell of 128 x 128 over [-1, 1]^2, set where a texel other than zero of
// some tile under some transform of the palette reaches. False means that glint_ndf_density is 0, but for lobes' tails that
// the tiles' storage rounds to nothing.
fn glint_ndf_reaches(material: GlintNdfMaterial, s: vec2f) -> bool {
    let half = 0.5 * f32(GLINT_NDF_REACH_ROWS);
    let cell = vec2u(clamp((s + 1.0) * half, vec2f(0.0), vec2f(2.0 * half - 1.0)));
    let row = glint_ndf_record(material.layer, material.reach_records + cell.y);
    return ((row[cell.x / 32u] >> (cell.x % 32u)) & 1u) == 1u;
}

// The density at `s` by its definition, at one point of the surface (texels): the Gaussian of the intrinsic roughness around
// the micro-normal that shows there. Its mean over points under a footprint is what glint_ndf_density approximates.
fn glint_ndf_density_at_point(material: GlintNdfMaterial, place: vec2f, s: vec2f) -> f32 {
    if dot(s, s) > 1.0 {
        return 0.0;
    }
    if material.cells == 0u {
        let position = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records));
        return glint_ndf_point(material, 0u, glint_ndf_tiled_place(material, position, place), s).density;
    }
    let cells = glint_ndf_cells_around(material, place);
    let shown = glint_ndf_shown_at(material, cells, cells.mean);
    return glint_ndf_point(material, shown.class_index, shown.local, s).density;
}
