//! A baked environment: its parameters and the bytes of its textures, and how a texel is found in them.

use glint_formats::environment::{EnvironmentParams, EnvironmentUniform};
use half::f16;

/// A baked environment. Textures are in the order of the pack: mip, layer, face, row, column.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Parameters.
    pub params: EnvironmentParams,
    /// What a shader binds of them.
    pub uniform: EnvironmentUniform,
    /// Prefiltered radiance and root mean square luminance over the scale, RGBA, as half floats.
    pub radiance: Vec<u16>,
    /// Indicators of levels from 1 on, four a layer, as half floats; empty with one level.
    pub indicators: Vec<u16>,
    /// Colours of levels from 1 on, a layer each; empty when levels have none.
    pub colours: Vec<u32>,
    /// Albedo table: scale and bias of F₀, visible reflecting area, whole facet area, as half floats.
    pub albedo: Vec<u16>,
}

impl Environment {
    /// Edge of a face of a mip.
    pub fn size(&self, mip: u32) -> u32 {
        self.params.face_size >> mip
    }

    /// Texels of a layer in all mips before `mip`, and in `mip`.
    fn texels(&self, mip: u32) -> (usize, usize) {
        let of = |mip: u32| 6 * (self.size(mip) as usize).pow(2);
        ((0..mip).map(of).sum(), of(mip))
    }

    /// Index of a texel of a texture of `layers` layers.
    fn index(&self, layers: usize, layer: usize, mip: u32, face: usize, i: u32, j: u32) -> usize {
        let (before, texels) = self.texels(mip);
        let size = self.size(mip) as usize;
        before * layers + layer * texels + (face * size + j as usize) * size + i as usize
    }

    /// Radiance of a texel, R, G, B and root mean square luminance, as a GPU reads it times the scale.
    pub fn radiance_texel(&self, mip: u32, face: usize, i: u32, j: u32) -> [f32; 4] {
        let texel = self.index(1, 0, mip, face, i, j);
        [0, 1, 2, 3].map(|c| self.uniform.radiance_scale * f16::from_bits(self.radiance[4 * texel + c]).to_f32())
    }

    /// Indicators of levels 4 layer + 1 to 4 layer + 4 of a texel.
    pub fn indicator_texel(&self, layer: usize, mip: u32, face: usize, i: u32, j: u32) -> [f32; 4] {
        let texel = self.index(self.params.indicator_layers() as usize, layer, mip, face, i, j);
        [0, 1, 2, 3].map(|c| f16::from_bits(self.indicators[4 * texel + c]).to_f32())
    }

    /// Colour of level `layer` + 1 of a texel.
    pub fn colour_texel(&self, layer: usize, mip: u32, face: usize, i: u32, j: u32) -> [f32; 3] {
        from_shared_exponent(self.colours[self.index(self.params.levels.len() - 1, layer, mip, face, i, j)])
    }

    /// Entry of the albedo table.
    pub fn albedo_texel(&self, column: u32, row: u32) -> [f32; 4] {
        let at = 4 * (row * self.params.albedo_size + column) as usize;
        [0, 1, 2, 3].map(|c| f16::from_bits(self.albedo[at + c]).to_f32())
    }
}

/// The colour that E5B9G9R9 bits stand for.
pub(super) fn from_shared_exponent(bits: u32) -> [f32; 3] {
    let unit = libm::ldexpf(1.0, (bits >> 27) as i32 - 24);
    [0, 9, 18].map(|shift| (bits >> shift & 511) as f32 * unit)
}
