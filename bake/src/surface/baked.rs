//! A synthesised surface and the lobes of its sample.

use crate::lobes::BakedLobes;
use crate::synthesis::Synthesis;

/// A synthesised surface and the lobes of its sample: what sections of a pack hold under one name.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Lobes of the sample; their last level is the surface as a whole.
    pub lobes: BakedLobes,
    /// Where the surface shows what of the sample.
    pub synthesis: Synthesis,
}

impl Surface {
    /// Bytes of the sections that a GPU holds: the uniform, lobes, normals, offsets and seams.
    pub fn gpu_bytes(&self) -> usize {
        self.lobes.gpu_bytes() + self.synthesis.gpu_bytes()
    }
}
