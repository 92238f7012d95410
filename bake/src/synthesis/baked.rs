//! A synthesised surface as it is baked and stored.

use glint_formats::synthesis::{SynthesisParams, SynthesisUniform};

/// A synthesised surface: where in the sample each patch lies, and along which seams patches meet.
#[derive(Clone, Debug, PartialEq)]
pub struct Synthesis {
    /// Parameters.
    pub params: SynthesisParams,
    /// What look-ups need of the parameters: [`SynthesisParams::uniform`].
    pub uniform: SynthesisUniform,
    /// Sample texel at a patch's texel (0, 0), as the layout orders patches.
    pub offsets: Vec<[u16; 2]>,
    /// Seam paths, as the layout orders them.
    pub seams: Vec<u32>,
}

impl Synthesis {
    /// A surface of these parts.
    pub(crate) fn new(params: SynthesisParams, offsets: Vec<[u16; 2]>, seams: Vec<u32>) -> Synthesis {
        let uniform = params.uniform();
        Synthesis { params, uniform, offsets, seams }
    }

    /// Bytes of the sections of offsets and seams.
    pub fn gpu_bytes(&self) -> usize {
        4 * (self.params.stored_offsets() + self.params.stored_seam_words()) as usize
    }
}
