//! Distribution of normals (P-NDF) that a footprint sees on a synthesised surface, as a sum over placed cells of the sample, with
//! bounded work. Tan et al. 2022, section 5.2: each level is walked by blocks of its cells' edge, which are read by `seams` or by
//! `blocks`.

use super::baked::Surface;
use super::query::{SurfaceQuery, SurfaceSettings, query};
use super::{blocks, seams};
use crate::footprint::Footprint;
use crate::lobes::eval::{ConditionalLobe, ellipse, row};
use crate::lobes::query::Detail;
use glam::{IVec2, Vec2};

/// Hands what the surface shows of a level under the footprint to `visit`: 0 boxes, then the stored ones; the last is the whole
/// surface. Returns the number of blocks or boxes; the whole surface counts as one.
pub(super) fn level_sum(q: &SurfaceQuery<'_>, detail: Detail, visit: &mut impl FnMut(&ConditionalLobe)) -> u32 {
    let lobes = &q.surface.lobes;
    let last = lobes.params.levels.len() - 1;
    let level = match detail {
        Detail::Boxes(edge) if q.settings.whole_blocks => return blocks::boxes(q, edge, visit),
        Detail::Boxes(edge) => return seams::boxes(q, edge, visit),
        Detail::Cells(level) if level < last => level,
        Detail::Cells(_) | Detail::Whole => {
            lobes.cells(&q.point, &lobes.level(last), 0.0, true, visit);
            return 1;
        }
    };
    let frame = &q.point.frame;
    let ellipse = ellipse(frame, q.settings.lobes.cells_reach);
    let edge = lobes.params.levels[level].cell_texels as f32;
    let index = |y: f32| (y / edge).floor() as i32;
    let mut visited = 0;
    for j in index(frame.mean.y - ellipse.top)..=index(frame.mean.y + ellipse.top) {
        let row = row(&ellipse, 0.0, edge, j as f32 * edge);
        for i in row.0..=row.1 {
            let place = IVec2::new(i, j);
            if q.settings.whole_blocks {
                blocks::block(q, level, place, visit);
            } else {
                seams::block(q, level, place, visit);
            }
            visited += 1;
        }
    }
    visited
}

impl Surface {
    /// P-NDF at the projected normal `s` of a footprint on the surface: density over the disk, 0 outside it.
    pub fn p_ndf(&self, footprint: &Footprint, s: Vec2, roughness: f32, settings: &SurfaceSettings) -> f32 {
        if s.length_squared() > 1.0 {
            return 0.0;
        }
        let q = query(self, footprint, roughness, settings);
        self.lobes.lod(&q.point.frame, &settings.lobes).density(|detail| {
            let (mut sum, mut share) = (0.0, 0.0);
            let mut visit = |lobe: &ConditionalLobe| {
                sum += lobe.density(s);
                share += lobe.share;
            };
            level_sum(&q, detail, &mut visit);
            (sum, share)
        })
    }
}
