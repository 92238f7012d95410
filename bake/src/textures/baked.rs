//! What the bake gives: the levels below the map, which itself is level 0 and stays as it is.

/// Normals and roughness of all levels from 1 on.
#[derive(Clone, Debug, PartialEq)]
pub struct Textures {
    /// Level 1 first; none for a map of one texel.
    pub levels: Vec<Level>,
    /// With axes of the surface, what that costs each level: mean errors of highlights as parts of the whole, with anisotropy and
    /// without. Empty otherwise.
    pub against_round: Vec<[f32; 2]>,
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
    /// GGX α of the fitted highlight, row-major; with anisotropy that across its direction.
    pub alphas: Vec<f32>,
    /// Strengths and directions of KHR_materials_anisotropy, row-major; none unless they were asked for.
    pub anisotropies: Vec<Anisotropy>,
}

/// How far and along what a highlight is stretched, as KHR_materials_anisotropy has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropy {
    /// α along the direction is α + (1 − α) strength², 0 to 1.
    pub strength: f32,
    /// Unit vector along which α is larger, in the plane of the texture, +Y up.
    pub direction: [f32; 2],
}

impl Anisotropy {
    /// None.
    pub const NONE: Anisotropy = Anisotropy { strength: 0.0, direction: [1.0, 0.0] };
}
