// Evaluation of NDF maps: the density of one node as it is stored, and of one patch of the map. Xing et al. 2024, "A Tiny Example Based Procedural
// Model for Real-Time Glinty Appearance Rendering", section 5 and Eq. 1. Twin of eval.rs. The CPU lists the nodes and patches of a
// footprint and then sums; shaders take the sum on the way, in the same order.
//
// Accessors that the including program defines; `layer` is that of the material, which is 0 in programs of one:
//   fn glint_ndf_record(layer: u32, at: u32) -> vec4u                  record `at` of section NMUB, see GlintNdfMaterial
//   fn glint_ndf_node(layer: u32, at: u32) -> vec4u                    element of the table NMND
//   fn glint_ndf_roots(layer: u32, at: vec2f) -> vec4f                 four texels of NMDE: textureGather at the corner that they share,
//                                                                      from 0 to 1; w and z are the upper ones from left to right, x and
//                                                                      y the lower ones
//   fn glint_ndf_normal_texel(layer: u32, at: vec2u) -> vec4u          texel of NMNO
//   fn glint_ndf_noise_texel(layer: u32, at: vec2u) -> vec4u           texel of PLNO; any value for tiled materials
//   fn glint_ndf_class_texel(layer: u32, at: vec2u, mip: u32) -> vec4u texel of PLCL; any value for tiled materials

#import windows::patch

// One material: the first 64 bytes of section NMUB. Records are the rest of that section, four u32 each; the levels come first, one
// record a level: nodes_x, nodes_y, first_node, 0.
struct GlintNdfMaterial {
    // Example, in texels.
    size: vec2u,
    // First element of the nodes' moments in NMND.
    moments: u32,
    levels: u32,
    // Standard deviation of the lobe of a normal, in the projected-normal disk.
    intrinsic_roughness: f32,
    // Steps a unit of the disk; nodes count in them.
    steps: f32,
    // Variance of the finest windows, texels^2; each level has twice that of the one before.
    finest_variance: f32,
    palette: u32,
    // Cells of the stochastic placement along an axis, a power of two; 0 means tiled.
    cells: u32,
    // Edge of a cell in surface texels.
    cell_texels: f32,
    // First record of: the palette, two an entry: position_to_local, normal_to_local, each a matrix by rows.
    palette_records: u32,
    // The reach mask, see glint_ndf_reaches.
    reach_records: u32,
    // 1 over width and height of the atlas.
    inv_atlas: vec2f,
    // 0 in the pack. A program of several materials tells its accessors by this which of them is meant.
    layer: u32,
    // Example texels a surface texel, by area, under the transform of the palette that has most.
    most_texels: f32,
}

// Choice between speed and accuracy at run time.
struct GlintNdfSettings {
    // A footprint's major axis in minor ones at most; longer ones are seen as wide as that.
    max_ratio: f32,
    // Patches of the map lie within this many standard deviations of the footprint's centre: 4 % of its mass is beyond 2.5, 3e-4 beyond 4.
    reach: f32,
}

// What a part of a footprint shows.
struct GlintNdfSum {
    // Its density, times the part.
    density: f32,
    // Nodes and patches visited.
    terms: f32,
}

// Density of one node at the example's projected normal `s`: the square of roots that are bilinear between texels, 0 outside the table
// and outside the disk.
fn glint_ndf_node_density(material: GlintNdfMaterial, node: u32, s: vec2f) -> f32 {
    if dot(s, s) > 1.0 {
        return 0.0;
    }
    let record = glint_ndf_node(material.layer, node);
    let away = (s + 1.0) * material.steps - vec2f(f32(record.x & 0xffffu), f32(record.x >> 16u));
    let p = away / vec2f(f32((record.z >> 16u) & 0xffu), f32(record.z >> 24u));
    let size = vec2f(f32(record.z & 0xffu), f32((record.z >> 8u) & 0xffu));
    if !(all(p > vec2f(-1.0)) && all(p < size)) {
        return 0.0;
    }
    let cell = floor(p);
    let f = p - cell;
    let corner = vec2f(f32(record.y & 0xffffu), f32(record.y >> 16u)) + cell;
    let roots = glint_ndf_roots(material.layer, (corner + 1.0) * material.inv_atlas);
    let top = roots.w + (roots.z - roots.w) * f.x;
    let bottom = roots.x + (roots.y - roots.x) * f.x;
    let root = top + (bottom - top) * f.y;
    return bitcast<f32>(record.w) * root * root;
}

// Density at the example's projected normal `s` of a patch under a footprint, whose centre lies in texels from corner 00. `texel` is
// that of NMNO.
fn glint_ndf_patch_density(material: GlintNdfMaterial, texel: vec4u, e: GlintWindowsEllipse, s: vec2f) -> f32 {
    if dot(s, s) > 1.0 {
        return 0.0;
    }
    return glint_windows_patch_density(
        unpack2x16snorm(texel.x),
        unpack2x16snorm(texel.y),
        unpack2x16snorm(texel.z),
        unpack2x16snorm(texel.w),
        e,
        material.intrinsic_roughness,
        s,
    );
}
