//! What the bake gives: the levels below the map, which itself is level 0 and stays as it is.

/// Normals and roughness of all levels from 1 on.
#[derive(Clone, Debug, PartialEq)]
pub struct Textures {
    /// Level 1 first; none for a map of one texel.
    pub levels: Vec<Level>,
}

/// One level.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Mean normals of length 1, projected: (x, y), +Y up, z = √(1 − x² − y²); row-major.
    pub normals: Vec<[f32; 2]>,
    /// GGX α of the fitted highlight, row-major.
    pub alphas: Vec<f32>,
}
