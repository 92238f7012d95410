// A surface tiled with one example: places far from the origin keep their digits. Twin of glint-bake-core ndf_maps/surface.rs.

#import ndf_maps::view

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
    let position = bitcast<vec4f>(glint_ndf_record(material.palette_records));
    let normal = bitcast<vec4f>(glint_ndf_record(material.palette_records + 1u));
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
