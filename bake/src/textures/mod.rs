//! Drop-in textures: normal mips and, for each of their texels, the roughness whose highlight is nearest to that of the normals
//! that were averaged away.
//!
//! An engine shades a texel of a mip by one GGX lobe around one normal. What it should show is the mean highlight of all
//! normals, each of its own roughness, under the texel ([`reference`]). [`fit`] finds the roughness of least L1 error; [`paper`]
//! has the closed forms that it is compared with, and [`quality`] measures all of them by the reference.
//!
//! Prior art: Toksvig 2004, Olano and Baker 2010 (LEAN), Tokuyoshi and Kaplanyan 2019. See `docs/methods/textures.md`.

mod anisotropy;
pub mod bake;
pub mod baked;
pub mod fit;
pub mod levels;
pub mod options;
pub mod paper;
pub mod quality;
pub mod reference;
mod surface;

pub use bake::bake;
pub use baked::{Anisotropy, Level, Textures};
pub use options::{Axes, Roughness, TexturesOptions};
