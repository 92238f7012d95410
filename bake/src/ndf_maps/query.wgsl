// What a footprint sees of a surface covered with examples, side by side or at random: the density of its normals. Xing et al. 2024,
// section 6.3; twin of query.rs, whose numbers of 64 bits are products of halves here. See eval.wgsl for the accessors.

#import ndf_maps::owners

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

// What a footprint sees of a surface tiled with one example.
fn glint_ndf_tiled(
    material: GlintNdfMaterial,
    footprint: GlintFootprint,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    let position = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records));
    let normal = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 1u));
    let within = glint_ndf_tiled_place(material, position, footprint.mean);
    let transformed = glint_windows_transformed(glint_windows_ellipse(footprint), position, within);
    let seen = glint_windows_shortened(transformed, settings.max_ratio);
    let local_s = glint_windows_apply(normal, s);
    let in_patches = glint_ndf_patches_share(seen.minor, material.finest_variance);
    var sum = GlintNdfSum(0.0, 0.0);
    if in_patches < 1.0 {
        let probes = glint_ndf_probes(seen);
        let blend = glint_ndf_blend(material, probes.variance);
        // Probes go over to the coarser level one after another.
        var coarser = blend.coarser * probes.total;
        var k = 0.0;
        for (var i = 0; i < 2 * GLINT_NDF_MAX_PROBES; i++) {
            let weight = glint_ndf_weight(probes, k);
            if weight <= 0.0 {
                break;
            }
            let place = within + seen.axis * (k * probes.step);
            let part = GlintNdfBlend(blend.level, clamp(coarser / weight, 0.0, 1.0));
            let share = weight / probes.total * (1.0 - in_patches);
            let shown = glint_ndf_windows(material, place, part, share, local_s);
            sum = GlintNdfSum(sum.density + shown.density, sum.terms + shown.terms);
            coarser -= weight;
            k = glint_ndf_next_probe(k);
        }
    }
    if in_patches > 0.0 {
        let shown = glint_ndf_patches(material, seen, settings, in_patches, local_s);
        sum = GlintNdfSum(sum.density + shown.density, sum.terms + shown.terms);
    }
    return GlintNdfSum(abs(glint_windows_determinant(normal)) * sum.density, sum.terms);
}

// The density over the disk of projected normals, at `s`, of what lies under a footprint (surface texels); 0 outside the disk.
// Also the number of nodes and patches that it took.
fn glint_ndf_density(
    material: GlintNdfMaterial,
    footprint: GlintFootprint,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    if dot(s, s) > 1.0 {
        return GlintNdfSum(0.0, 0.0);
    }
    if material.cells == 0u {
        return glint_ndf_tiled(material, footprint, settings, s);
    }
    return glint_ndf_stochastic(material, footprint, settings, s);
}

// Whether any footprint sees normals near `s`: a bit a cell of 128 x 128 over [-1, 1]^2, set where a texel other than zero of
// some node under some transform of the palette reaches. False means that glint_ndf_density is 0, but for lobes' tails that
// the tables' eight bits round to nothing.
fn glint_ndf_reaches(material: GlintNdfMaterial, s: vec2f) -> bool {
    let half = 0.5 * f32(GLINT_NDF_REACH_ROWS);
    let cell = vec2u(clamp((s + 1.0) * half, vec2f(0.0), vec2f(2.0 * half - 1.0)));
    let row = glint_ndf_record(material.layer, material.reach_records + cell.y);
    return ((row[cell.x / 32u] >> (cell.x % 32u)) & 1u) == 1u;
}

// Bilinear projected normal at an example point; the example repeats.
fn glint_ndf_normal(material: GlintNdfMaterial, local: vec2f) -> vec2f {
    let at = floor(local + 0.5);
    let f = local + 0.5 - at;
    let size = vec2f(material.size);
    let texel = glint_ndf_normal_texel(material.layer, vec2u(at - floor((at + 0.5) / size) * size));
    return glint_windows_bilinear(
        unpack2x16snorm(texel.x), unpack2x16snorm(texel.y), unpack2x16snorm(texel.z), unpack2x16snorm(texel.w), f,
    );
}

// The normal at the example point `local` with its intrinsic lobe, seen through a palette entry.
fn glint_ndf_point(material: GlintNdfMaterial, class_index: u32, local: vec2f, surface_s: vec2f) -> f32 {
    let to_local = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 2u * class_index + 1u));
    let normal = glint_ndf_normal(material, local);
    let d = glint_windows_apply(to_local, surface_s) - normal;
    let sigma = material.intrinsic_roughness;
    let mass = glint_windows_inside_disk(normal, sigma);
    let density = exp(-0.5 * dot(d, d) / (sigma * sigma)) / (6.2831853 * sigma * sigma * mass);
    return abs(glint_windows_determinant(to_local)) * density;
}

// The density at `s` by its definition, at one point of the surface (texels): the Gaussian of the intrinsic roughness around
// the micro-normal that shows there, or those of the owners that fade into each other. Its mean over points under a footprint is what
// glint_ndf_density approximates.
fn glint_ndf_density_at_point(material: GlintNdfMaterial, place: vec2f, s: vec2f) -> f32 {
    if dot(s, s) > 1.0 {
        return 0.0;
    }
    if material.cells == 0u {
        let position = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records));
        return glint_ndf_point(material, 0u, glint_ndf_tiled_place(material, position, place), s);
    }
    let cells = glint_ndf_cells_around(material, place);
    var owners = glint_ndf_owners_at(material, cells, cells.mean, 0.0);
    var sum = 0.0;
    for (var o = 0u; o < 4u; o++) {
        let owner = owners[o];
        if owner.weight > 0.0 {
            let at = material.palette_records + 2u * owner.class_index;
            let position = bitcast<vec4f>(glint_ndf_record(material.layer, at));
            let local = glint_windows_apply(position, cells.mean - owner.centre) + owner.offset;
            sum += owner.weight * glint_ndf_point(material, owner.class_index, local, s);
        }
    }
    return sum;
}
