//! A validated normal map: projected normals in the unit disk, bilinear look-up, wrap.
//!
//! `raw` turns colours, two channels or heights into vectors; `validate` turns vectors into a [`NormalMap`]; `report` measures
//! what came in.
//!
//! The green axis: row 0 of an image is its top and v grows downwards, while tangent space has +Y up. So y = −v, and
//! over a height field h(u, v) the normal is proportional to (−∂h/∂u, **+**∂h/∂v, 1): the upper side of a bump is
//! bright green. A map with [`GreenAxis::Down`] (DirectX) stores −n_y instead; it is negated once, on the way in.

mod map;
mod raw;
mod report;
mod validate;

#[cfg(test)]
mod tests;

pub use map::NormalMap;
pub use raw::{GreenAxis, NormalOptions, RawNormals, ZERO_LENGTH, crop_rows, lifted};
pub use report::{NormalReport, SEAM_RATIO, SeamRatio};
pub use validate::{HORIZON, MAX_BELOW_HORIZON, MAX_ZERO_LENGTH};
