//! What a bake of NDF maps makes: the maps of one example, and how a surface is covered with it.

use glint_formats::ndf_maps::{NdfMapsParams, NoiseTexel, PlacementParams, TileRecord, TransformRecord};

/// A material: one example's maps and how they cover the surface.
#[derive(Clone, Debug)]
pub struct Material {
    /// NDF maps of the example.
    pub maps: BakedNdfMaps,
    /// Placement on the surface.
    pub placement: BakedPlacement,
}

/// One example's NDF maps.
#[derive(Clone, Debug)]
pub struct BakedNdfMaps {
    /// Parameters.
    pub params: NdfMapsParams,
    /// One record a tile, by level, row and column.
    pub tiles: Vec<TileRecord>,
    /// Encoded density texels of all tiles, tile after tile, row-major.
    pub density: Vec<u8>,
    /// Projected normals of the example, snorm16, row-major.
    pub normals: Vec<[i16; 2]>,
}

impl BakedNdfMaps {
    /// Bytes of tile records, encoded densities and normals, each texel once.
    pub fn compact_bytes(&self) -> usize {
        self.tiles.len() * size_of::<TileRecord>() + self.density.len() + self.normals.len() * 4
    }
}

/// A placement.
#[derive(Clone, Debug)]
pub struct BakedPlacement {
    /// Parameters.
    pub params: PlacementParams,
    /// Transforms.
    pub palette: Vec<TransformRecord>,
    /// One texel a sub-region, row by row; empty when tiled.
    pub noise: Vec<NoiseTexel>,
    /// Shares of palette entries, unorm8: all mips, each with ⌈palette / 4⌉ layers of RGBA texels; empty when tiled.
    pub classes: Vec<u8>,
}
