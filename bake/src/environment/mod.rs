//! Environments: image-based lighting of glints from filtered radiance and filtered indicators of radiance levels.
//!
//! Method: Kneiphof and Klein 2025, "Real-Time Image-based Lighting of Glints", sections 3.4 to 5. An equirectangular
//! image ([`image`]) becomes a cube ([`cube`]) whose mips are filtered with a GGX lobe each ([`kernel`], [`prefilter`]):
//! radiance, its square, and the share of each of a few radiance levels ([`levels`]). At run time ([`eval`]) the
//! shares are the probabilities that a facet reflects each level, scaled by areas that depend on view angle and
//! roughness only ([`albedo`]), and [`glints`] draws,
//! with the random words of a place on the surface ([`cells`]). [`reference`] sums over every pixel in f64, and [`quality`] measures one by the other.
//!
//! What deviates from the paper, and why, stands on top of each file and in `docs/methods/environment.md`. The main points:
//! - filtering to an error bound by a tree of the source, without samples ([`tree`], [`blocks`], [`filter_sum`]);
//! - the source is resampled by exact areas;
//! - levels chosen for the least error of the second moment;
//! - the darkest indicator is what the others leave of 1 ([`quantise`]);
//! - levels may have colours of their own.

pub mod albedo;
pub mod bake;
pub mod blocks;
pub mod cells;
pub mod cube;
pub mod eval;
pub mod filter_sum;
pub mod glints;
pub mod image;
pub mod kernel;
pub mod levels;
pub mod options;
pub mod prefilter;
pub mod quality;
pub mod quantise;
pub mod reference;
pub mod reference_glints;
pub mod scale;
pub mod sections;
pub mod tables;
pub mod tree;

crate::shader::shaders!("environment": "cells", "eval");

pub use bake::bake;
pub use image::EnvironmentImage;
pub use options::{EnvironmentOptions, LevelCount};
pub use tables::Environment;
