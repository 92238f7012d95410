// Multi-scale NDF maps of tiny examples on a covered surface: the density of normals under a footprint.
// Xing et al. 2024, "A Tiny Example Based Procedural Model for Real-Time Glinty Appearance Rendering", sections 5 and 6.3,
// Eq. 1. Twin of glint-bake-core ndf_maps/{eval,surface,placement}.rs, where deviations from the paper are derived. The CPU
// lists the tiles and lobes of a footprint and then sums; here the sum is taken on the way, in the same order.
//
// Accessors that the including program defines:
//   fn glint_ndf_block(at: u32) -> vec3u    three rows of three 8-bit density texels, the lowest bits first: see
//                                           glint_ndf_block_density. Any value if no material has blocks
//   fn glint_ndf_record(at: u32) -> vec4u   sixteen bytes of the levels and the palette
//   fn glint_ndf_tile(at: u32) -> vec4u     sixteen bytes of the tiles; any value if all materials have them among the records
//   fn glint_ndf_noise_texel(at: u32) -> vec4u    a texel of the noise map
//   fn glint_ndf_word(at: u32) -> u32       four bytes of the texels: density, normals, classes, reach. One word before and
//                                           after a section may be asked for; what is there does not matter
// Both read little-endian sections as they lie in the pack; GlintNdfMaterial says where each begins. Several materials may
// share the two buffers.

#import ndf_maps::tiled
#import ndf_maps::stochastic

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
// the tiles' storage rounds to nothing. The mask is not in the pack; whoever uploads it makes it.
fn glint_ndf_reaches(material: GlintNdfMaterial, s: vec2f) -> bool {
    let half = 0.5 * f32(GLINT_NDF_REACH_CELLS);
    let cell = vec2u(clamp((s + 1.0) * half, vec2f(0.0), vec2f(2.0 * half - 1.0)));
    let bit = cell.y * GLINT_NDF_REACH_CELLS + cell.x;
    return ((glint_ndf_word(material.reach_words + bit / 32u) >> (bit % 32u)) & 1u) == 1u;
}

// The density at `s` by its definition, at one point of the surface (texels): the Gaussian of the intrinsic roughness around
// the micro-normal that shows there. Its mean over points under a footprint is what glint_ndf_density approximates.
fn glint_ndf_density_at_point(material: GlintNdfMaterial, place: vec2f, s: vec2f) -> f32 {
    if dot(s, s) > 1.0 {
        return 0.0;
    }
    if material.cells == 0u {
        let position = bitcast<vec4f>(glint_ndf_record(material.palette_records));
        return glint_ndf_point(material, 0u, glint_ndf_tiled_place(material, position, place), s).density;
    }
    let cells = glint_ndf_cells_around(material, place);
    let shown = glint_ndf_shown_at(material, cells, cells.mean);
    return glint_ndf_point(material, shown.class_index, shown.local, s).density;
}
