//! What a bake of NDF maps makes: the maps of one example, and how a surface is covered with it.

use glint_formats::ndf_maps::{
    MAX_PALETTE, MomentsRecord, NdfMapsParams, NodeRecord, NoiseTexel, PlacementParams, TransformRecord,
};

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
    /// One record a node, by level, row and column.
    pub nodes: Vec<NodeRecord>,
    /// Mean and covariance of each node's density.
    pub moments: Vec<MomentsRecord>,
    /// Width and height of the atlas in texels.
    pub atlas_size: [u32; 2],
    /// Roots of densities of all nodes' tables, row-major.
    pub atlas: Vec<u8>,
    /// Projected normals of the example, snorm16, row-major.
    pub normals: Vec<[i16; 2]>,
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
    /// Shares of palette entries, unorm8, under Gaussian windows around sub-regions, all mips; empty when tiled.
    pub classes: Vec<[u8; MAX_PALETTE as usize]>,
}
