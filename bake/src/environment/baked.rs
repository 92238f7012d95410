//! A baked environment: its parameters and the bytes of its textures, and how a texel is found in them.

use glint_formats::environment::{EnvironmentParams, EnvironmentUniform};
use half::f16;

/// A baked environment. Textures are in the order of the pack: mip, layer, face, row, column, which is that of rising roughness.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Parameters.
    pub params: EnvironmentParams,
    /// What a shader binds of them.
    pub uniform: EnvironmentUniform,
    /// The mirror and its root mean square luminance over the scale, RGBA, as half floats.
    pub mirror: Vec<u16>,
    /// Filtered radiance and root mean square luminance over the scale, RGBA, as half floats.
    pub radiance: Vec<u16>,
    /// Indicators of levels from 1 on, four a layer, as half floats; empty with one level.
    pub indicators: Vec<u16>,
    /// Colours of levels from 1 on, a layer each; empty when levels have none.
    pub colours: Vec<u32>,
    /// Albedo and look-ups, layer by layer as the section has them, as half floats.
    pub albedo: Vec<u16>,
}

impl Environment {
    /// Texels of all filtered roughnesses before `index`, 1 or more, and of it.
    fn texels(&self, index: u32) -> (usize, usize) {
        let of = |index: u32| 6 * (self.params.size(index) as usize).pow(2);
        ((1..index).map(of).sum(), of(index))
    }

    /// Texel of a face of roughness `index`.
    fn texel(&self, index: u32, face: usize, i: u32, j: u32) -> usize {
        let size = self.params.size(index) as usize;
        (face * size + j as usize) * size + i as usize
    }

    /// Radiance of a texel, R, G, B and root mean square luminance, as a GPU reads it times the scale. Index 0 is the mirror, others are
    /// filtered roughnesses.
    pub fn radiance_texel(&self, index: u32, face: usize, i: u32, j: u32) -> [f32; 4] {
        let texel = self.texel(index, face, i, j);
        let (texels, at) =
            if index == 0 { (&self.mirror, texel) } else { (&self.radiance, self.texels(index).0 + texel) };
        [0, 1, 2, 3].map(|c| self.uniform.radiance_scale * f16::from_bits(texels[4 * at + c]).to_f32())
    }

    /// Indicators of levels 4 layer + 1 to 4 layer + 4 of a texel of filtered roughness `index`.
    pub fn indicator_texel(&self, layer: usize, index: u32, face: usize, i: u32, j: u32) -> [f32; 4] {
        let (before, texels) = self.texels(index);
        let at = before * self.params.indicator_layers() as usize + layer * texels + self.texel(index, face, i, j);
        [0, 1, 2, 3].map(|c| f16::from_bits(self.indicators[4 * at + c]).to_f32())
    }

    /// Colour of level `layer` + 1 of a texel of a mip.
    pub fn colour_texel(&self, layer: usize, mip: u32, face: usize, i: u32, j: u32) -> [f32; 3] {
        let index = 1 + mip * self.params.per_size;
        let texels = self.texels(index).1;
        let before = self.texels(index).0 / self.params.per_size as usize * (self.params.levels.len() - 1);
        from_shared_exponent(self.colours[before + layer * texels + self.texel(index, face, i, j)])
    }

    /// Entry of layer `layer` of the albedo table.
    pub fn albedo_texel(&self, layer: u32, column: u32, row: u32) -> [f32; 4] {
        let size = self.params.albedo_size;
        let at = 4 * ((layer * size + row) * size + column) as usize;
        [0, 1, 2, 3].map(|c| f16::from_bits(self.albedo[at + c]).to_f32())
    }
}

/// The colour that E5B9G9R9 bits stand for.
pub(super) fn from_shared_exponent(bits: u32) -> [f32; 3] {
    let unit = libm::ldexpf(1.0, (bits >> 27) as i32 - 24);
    [0, 9, 18].map(|shift| (bits >> shift & 511) as f32 * unit)
}
