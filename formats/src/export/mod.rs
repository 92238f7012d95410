//! Textures of a pack as files that other programs read: KTX2 and DDS. Bytes in, bytes out; files are the caller's.

pub mod blocks;
pub mod dds;
mod dfd;
mod image;
pub mod ktx2;
pub mod texel;
mod texels;

pub use image::{Image, Texture};
pub use texels::Texels;
