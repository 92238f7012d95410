//! A block of a synthesised surface as if it had no seams: one of the two ways to read a surface.
//!
//! The paper (Tan et al. 2022, section 5.2) splits footprints at the edges of patches. Here a block is one cell of the sample, for
//! pictures in real time.

use super::query::{SurfaceQuery, boxes_of, filtered};
use crate::lobes::eval::ConditionalLobe;
use glam::IVec2;

/// Hands the lobes of a block to `visit`, `place` of a level's blocks from the origin: of the cell of the sample at which the
/// patch at the block's middle begins there, or the last before it.
pub(super) fn block(q: &SurfaceQuery<'_>, level_index: usize, place: IVec2, visit: &mut impl FnMut(&ConditionalLobe)) {
    let lobes = &q.surface.lobes;
    let level = lobes.level(level_index);
    let at = place * level.cell_texels as i32;
    let on_surface = q.origin.wrapping_add(at);
    let source = q.surface.synthesis.nominal_texel(on_surface.x, on_surface.y, level.cell_texels as i32);
    let step = lobes.params.step(level.cell_texels);
    let cell_x = (source.0 / step).min(level.cells_x - 1);
    let cell_y = (source.1 / step).min(level.cells_y - 1);
    let first = level.first_lobe + (cell_y * level.cells_x + cell_x) * lobes.params.lobes_per_cell;
    lobes.cell(&q.point, &level, first, at.as_vec2(), visit);
}

/// Hands boxes of `edge` texels under the footprint to `visit`: those of the sample, as if the patch that shows the footprint's
/// middle showed all that it sees. One look-up of a patch serves them all. Returns how many.
pub(super) fn boxes(q: &SurfaceQuery<'_>, edge: f32, visit: &mut impl FnMut(&ConditionalLobe)) -> u32 {
    let lobes = &q.surface.lobes;
    let texel = q.point.frame.mean.floor().as_ivec2();
    let on_surface = q.origin.wrapping_add(texel);
    let (x, y) = q.surface.synthesis.source_texel(on_surface.x, on_surface.y);
    let moved = IVec2::new(x as i32, y as i32) - texel;
    let shown = |at: IVec2| lobes.texel(at.x + moved.x, at.y + moved.y);
    boxes_of(q, edge, |centre| filtered(lobes.params.filter, centre, shown), visit)
}
