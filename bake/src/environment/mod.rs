//! Environments: image-based lighting of glints from filtered radiance and filtered indicators of radiance levels.
//!
//! Method: Kneiphof and Klein 2025, "Real-Time Image-based Lighting of Glints", sections 3.3 to 5. An equirectangular
//! image ([`image`]) becomes a cube ([`cube`]), and cubes that are filtered with a GGX lobe each ([`kernel`], [`prefilter`]): radiance, its square, and the share of each of a few radiance levels ([`levels`]). At run time ([`eval`], by look-ups as in
//! [`lookup`]) the shares are the probabilities that a facet reflects each level, scaled by areas that depend on view angle and
//! roughness only ([`albedo`]), by round look-ups that stand for the lobe seen at an angle ([`fitted`]), and one draw a pixel is made with the random words of a place on the surface ([`counting::query`](crate::counting::query)).
//! [`reference`] sums over every pixel in f64 and places facets one by one; [`quality`] measures texels and [`reads`] look-ups by it.
//!
//! What deviates from the paper, and why, stands on top of each file and in `docs/methods/environment.md`. The main points:
//! - filtering to an error bound by a tree of the source, without samples ([`tree`], [`prefilter`]);
//! - the source is resampled by exact areas;
//! - levels chosen for the least error of the second moment;
//! - the darkest indicator is what the others leave of 1 ([`rounding`]);
//! - levels may have colours of their own.

pub mod albedo;
mod bake;
mod baked;
pub mod cube;
pub mod eval;
pub mod fitted;
pub mod image;
mod kernel;
pub mod levels;
pub mod lookup;
pub mod options;
mod prefilter;
pub mod quality;
pub mod reads;
pub mod reference;
mod rounding;
pub mod sections;
mod source;
mod table;
mod tree;

crate::shader::shaders!("environment": "eval");

pub use bake::bake;
pub use baked::Environment;
pub use image::EnvironmentImage;
pub use options::{EnvironmentOptions, LevelCount};
