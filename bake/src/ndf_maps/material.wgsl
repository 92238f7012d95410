// A material of NDF maps as its sections lie in two buffers, the settings of an evaluation, and what it sums. See
// glint_ndf_maps.wgsl for the accessors.

const GLINT_NDF_SQRT_U8: u32 = 0u;
const GLINT_NDF_F16: u32 = 1u;
const GLINT_NDF_PAPER_F32: u32 = 2u;
const GLINT_NDF_REPEAT: u32 = 0u;
const GLINT_NDF_CLAMP: u32 = 1u;

// Edge, in example texels, of the boxes that are seen as lobes, at most.
const GLINT_NDF_LOBE_TEXELS: f32 = 1.0;
// Sub-regions of a stochastic surface that a footprint visits, at most.
const GLINT_NDF_MAX_REGIONS: f32 = 64.0;
// From this minor axis on (in sub-regions), where top tiles are enough, one tells all of a sub-region.
const GLINT_NDF_WHOLE_REGION_SIGMA: f32 = 0.5;
// From this minor axis on (in example edges) the top tile is enough for tiled examples.
const GLINT_NDF_TOP_TILE_SIGMA: f32 = 0.5;
// Pieces under a footprint that is widened by their own size, at most, relative to max_terms.
const GLINT_NDF_MOST_OF_TERMS: f32 = 4.0;
// A tile that a sub-region cuts is split from this share on, relative to an even share of max_terms.
const GLINT_NDF_SPLIT_FROM: f32 = 2.0;
const GLINT_NDF_MAX_SPLITS: u32 = 6u;
// From this minor axis on (in cells) a stochastic surface is seen as shares of transforms.
const GLINT_NDF_CLASS_SIGMA_CELLS: f32 = 1.0;
// Largest palette, in groups of four.
const GLINT_NDF_MAX_LAYERS: u32 = 8u;
// Cells of the reach mask along an axis of [-1, 1]^2.
const GLINT_NDF_REACH_CELLS: u32 = 128u;

// One material: sections NMPP and PLPP, and where the others begin.
struct GlintNdfMaterial {
    // Example, in texels.
    size: vec2u,
    // What lies beyond the example's edge: GLINT_NDF_REPEAT or GLINT_NDF_CLAMP.
    wrap: u32,
    // GLINT_NDF_SQRT_U8, _F16 or _PAPER_F32.
    storage: u32,
    // Standard deviation of the lobe of a normal, in the projected-normal disk.
    intrinsic_roughness: f32,
    levels: u32,
    palette: u32,
    // Cells of the stochastic placement along an axis, a power of two; 0 means tiled.
    cells: u32,
    // Edge of a cell in surface texels.
    cell_texels: f32,
    // First record of: the levels, one each: tile_texels, tiles_x, tiles_y, first_tile.
    level_records: u32,
    // The tiles (section NMTI), two each.
    tile_records: u32,
    // The palette (section PLPL), two each.
    palette_records: u32,
    // The noise map, one a sub-region: that of the cell that owns it (section PLNO), with which of the 3 x 3 cells around that is in
    // place of its own sub-regions' owners.
    noise_records: u32,
    // First word of: the density (section NMDE).
    density_words: u32,
    // The normals (section NMNO), one each.
    normal_words: u32,
    // The classes (section PLCL).
    class_words: u32,
    // The reach mask, see glint_ndf_reaches.
    reach_words: u32,
    // 1 where blocks hold the density (8-bit storage only), 0 where words do.
    blocks: u32,
    // 1 where the tiles are among the records of the levels and the palette, 0 where they have a table.
    few_tiles: u32,
    // Example texels a surface texel, by area, under the transform of the palette that has most.
    most_texels: f32,
}

// Choice between speed and accuracy at run time.
struct GlintNdfSettings {
    // Largest tile, or block of cells, in standard deviations of the footprint's minor axis.
    tile_sigmas: f32,
    // Largest box that is seen as one lobe, likewise.
    lobe_sigmas: f32,
    // Tiles or lobes in the area of the footprint's ellipse, at most, but for those that sub-regions cut.
    max_terms: u32,
    // How often a tile that a sub-region shows only in part is split, 0 to GLINT_NDF_MAX_SPLITS.
    splits: u32,
    // Pieces lie within this many standard deviations of the footprint's centre, each widened by its size; what lies farther out is
    // left out: 2 % of the mass at 2.8, 14 % at 2.
    reach: f32,
    // Places along the minor axis where a stochastic surface is seen, each as one tile; 0 for all tiles of all sub-regions.
    probes: u32,
}

// A sum over pieces of a footprint, not yet divided by its share.
struct GlintNdfSum {
    // Density times share.
    density: f32,
    share: f32,
    // Tiles and lobes visited.
    terms: f32,
}

// What is visible of one placed example, and how the footprint lies on it; tiled examples are visible everywhere.
struct GlintNdfView {
    // The footprint in example texels.
    ellipse: GlintNdfEllipse,
    // The sub-region's middle in example texels.
    middle: vec2f,
    to_surface: vec4f,
    // Surface texels an example texel, by area.
    scale: f32,
    // Half the sub-region's edge in surface texels.
    half: f32,
    // Half the box, in example texels, around a sub-region of half edge 1.
    extent: vec2f,
    // |determinant| of the matrix from projected normals on the surface to those in the example.
    jacobian: f32,
}

struct GlintNdfNormal {
    // Projected normal and its derivatives along the example's axes, per texel.
    s: vec2f,
    du: vec2f,
    dv: vec2f,
}

fn glint_ndf_add(a: GlintNdfSum, b: GlintNdfSum) -> GlintNdfSum {
    return GlintNdfSum(a.density + b.density, a.share + b.share, a.terms + b.terms);
}
