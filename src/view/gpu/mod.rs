//! The device, what is bound on it, and how programs run there.

mod compute;
mod device;
mod resources;

pub use compute::{answer, read_back};
pub use device::{Gpu, GpuError, Wish};
pub use resources::{GpuTexture, ResourceSet, Resources, TABLE_WIDTH};
