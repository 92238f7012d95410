//! MIP-mapped lobes of one map, ready for a pack.

use glint_formats::lobes::{LevelUniform, LobesParams, LobesUniform};

/// MIP-mapped lobes of one map: what sections of a pack hold.
#[derive(Clone, Debug, PartialEq)]
pub struct BakedLobes {
    /// Parameters.
    pub params: LobesParams,
    /// Records of all lobes: bytes of [`glint_formats::lobes::LOBES`].
    pub lobes: Vec<u8>,
    /// Normals, each with that of the texel below it: pairs of [`glint_formats::lobes::NORMALS`].
    pub normals: Vec<[u32; 2]>,
}

impl BakedLobes {
    /// Bytes that a renderer keeps: the uniform, lobes and normals.
    pub fn gpu_bytes(&self) -> usize {
        size_of::<LobesUniform>() + self.lobes.len() + size_of_val(&self.normals[..])
    }

    /// A stored level, 0 the finest, as shaders have it.
    pub(crate) fn level(&self, index: usize) -> LevelUniform {
        self.params.level_uniform(&self.params.levels[index])
    }
}
