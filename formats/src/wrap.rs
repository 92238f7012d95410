//! What lies beyond a map's edge, for every method that reads maps.

use serde::{Deserialize, Serialize};

/// What lies beyond a map's edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Wrap {
    /// The map repeats.
    Repeat,
    /// The edge texel goes on.
    Clamp,
}
