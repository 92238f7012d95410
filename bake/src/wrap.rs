//! Indices of texels beyond the edges of a map, and the four texels that linear filtering reads.

use glam::{IVec2, Vec2};
use glint_formats::Wrap;

/// The index, from 0 to `size` − 1, of what lies at index `i` of an axis of `size` texels.
#[inline]
pub(crate) fn wrapped(i: i32, size: i32, wrap: Wrap) -> i32 {
    match wrap {
        Wrap::Repeat => i.rem_euclid(size),
        Wrap::Clamp => i.clamp(0, size - 1),
    }
}

/// What linear filtering reads at `u`, in texels with centres at i + ½: the upper left of the four texels, and how far `u` lies
/// from its centre towards those of the others, 0 to 1.
#[inline]
pub(crate) fn filtered_texels(u: Vec2) -> (IVec2, Vec2) {
    let p = u - 0.5;
    let cell = p.floor();
    (cell.as_ivec2(), p - cell)
}
