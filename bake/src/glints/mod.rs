//! Counted facets: glints of any mesh under every light of a scene at once, without a map and without stored facets.
//!
//! Method: Kneiphof and Klein 2025, "Real-Time Image-based Lighting of Glints", sections 3.2, 3.3 and 4, which stands on Deliot and Belcour 2023
//! for points and on Kneiphof and Klein 2024 for area lights. The facets under a pixel are a number and one random state
//! ([`counting::query`](crate::counting::query)); each light has a chance to be reflected by a facet, and one binomial draw
//! ([`counting`](crate::counting)) says how many do ([`eval`]). A pack holds the material and two small tables for rectangles ([`bake()`]).
//! [`reference`](mod@reference) integrates chances in f64 and places facets one by one.
//!
//! What deviates from the paper stands on top of [`eval`] and in `docs/methods/glints.md`.

mod bake;
pub mod baked;
pub mod eval;
pub mod layers;
pub mod options;
pub mod reference;
pub mod sampling;
pub mod sections;

crate::shader::shaders!("glints": "eval", "layers", "sampling");

pub use bake::bake;
pub use baked::CountedFacets;
pub use options::GlintsOptions;
