//! The device, what is bound on it, and how programs run there.

mod compute;
mod device;
mod resources;
mod sections;

pub use compute::{answer, answer_by, read_back};
pub use device::{AdapterChoice, Gpu, GpuError};
pub use resources::{BoundSection, GpuTexture, ResourceSet, Resources};
pub use sections::{bind_pack, bind_parts, bind_sections, collect_pack, collect_sections};
