//! `glint-view`: packs and materials in a window, as pictures, or as a bench. Only builds with the feature `view` can draw.

#[cfg(feature = "view")]
mod bench_json;
mod flags;
#[cfg(feature = "view")]
mod run;
#[cfg(feature = "view")]
mod textures;

pub use flags::Args;
#[cfg(feature = "view")]
pub use run::run;
