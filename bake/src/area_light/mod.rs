//! Rectangle lights on normal-mapped surfaces: highlights that stay as wide and bright as the normals under a pixel make
//! them, at any distance.
//!
//! Method: Tao et al. 2021, "Real-Time Antialiased Area Lighting Using Multi-Scale Linearly Transformed Cosines". A mip
//! chain holds averaged normals and the roughness of what was averaged ([`bake()`], [`spread`]). At run time that roughness
//! is convolved with the surface's own ([`eval`]), and a rectangle light is integrated in closed form ([`rect`]) against the
//! linearly transformed cosine that stands for GGX of that roughness ([`fit`]). [`reference`] says the same from the definitions
//! in f64; [`quality`] measures one by the other; [`paper`] has the paper's own fits, for comparison.
//!
//! What deviates from the paper, and why, stands on top of each file and in `docs/methods/area-light.md`. The main points:
//! - the mean resultant length has a closed form, which is inverted exactly ([`spread`]);
//! - the roughness of normals is matched where a highlight sees it, not by the length alone ([`spread`]);
//! - normals may vary more along one direction than across: a few lobes along it share the light ([`eval`]);
//! - convolution is symmetric, and exact when one roughness is 0 ([`spread`]).

pub mod bake;
pub mod baked;
pub mod eval;
pub mod fit;
pub mod options;
pub mod paper;
pub mod quality;
pub mod rect;
pub mod reference;
pub mod sections;
pub mod spread;

crate::shader::shaders!("area_light": "rect", "eval");

pub use bake::{bake, pack};
pub use baked::AreaLightMaterial;
pub use options::AreaLightOptions;
