//! P-NDFs of a synthesised surface: lobes of a small sample, read through the patches that the surface is made of.
//!
//! Tan, Zhu, Xu, Meng, Wang, Yan, *Real-Time Microstructure Rendering with MIP-mapped Normal Map Samples*, 2022, sections
//! 5.1 and 5.2. The paper stores clustered lobes for every patch of the surface; here cells of the sample's MIP begin at all
//! multiples of the patches' alignment, so that one small set serves every patch wherever it was cut from.
//! `docs/methods/surface.md` has what deviates.
//!
//! [`mod@bake`] makes both parts, [`query`] lists what a footprint sees, [`quality`] compares it with the assembled map.

pub mod bake;
pub mod quality;
pub mod query;
pub mod sections;
mod whole;

crate::shader::shaders!("surface": "query", "seams", "blocks");

pub use bake::bake;
pub use query::SurfaceSettings;

use crate::lobes::BakedLobes;
use crate::synthesis::Synthesis;

/// A synthesised surface and the lobes of its sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Lobes of the sample; their last level is the surface as a whole.
    pub lobes: BakedLobes,
    /// Where the surface shows what of the sample.
    pub synthesis: Synthesis,
}

impl Surface {
    /// Bytes that a renderer keeps: lobes, normals, offsets and seams.
    pub fn gpu_bytes(&self) -> usize {
        self.lobes.gpu_bytes() + 4 * (self.synthesis.offsets.len() + self.synthesis.seams.len())
    }
}
