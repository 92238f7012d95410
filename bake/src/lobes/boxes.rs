//! The filtered map, and boxes of it under a footprint: of a texel or less, one bilinear patch each. Tan et al. 2022, sections
//! 5.1.2 and 5.2.
//!
//! Boxes are lobes like others here; `boxes.wgsl` finds once what boxes of one size have in common.

use super::baked::BakedLobes;
use super::eval::{ConditionalLobe, Patch, Query, box_lobe, conditional, ellipse, row};
use crate::wrap::wrapped;
use glam::{IVec2, Mat2, Vec2};
use glint_formats::Wrap;
use glint_formats::lobes::{Filter, LobesParams, NormalsStorage};

/// A normal's stored numbers.
fn codes(word: u32) -> Vec2 {
    Vec2::new(f32::from(word as i16), f32::from((word >> 16) as i16))
}

/// A bilinear patch from its texels, at the fraction `f`.
pub(crate) fn bilinear(s00: Vec2, s10: Vec2, s01: Vec2, s11: Vec2, f: Vec2) -> Patch {
    let top = s00 + (s10 - s00) * f.x;
    let bottom = s01 + (s11 - s01) * f.x;
    let twist = s11 - s10 - s01 + s00;
    let along = s10 - s00 + twist * f.y;
    Patch { normal: top + (bottom - top) * f.y, jacobian: Mat2::from_cols(along, bottom - top), twist }
}

impl BakedLobes {
    /// A texel of the map, wrapped or clamped.
    fn wrapped(&self, texel: IVec2) -> IVec2 {
        let LobesParams { width, height, wrap, .. } = self.params;
        IVec2::new(wrapped(texel.x, width as i32, wrap), wrapped(texel.y, height as i32, wrap))
    }

    /// Factor and offset of stored numbers of normals.
    fn normals_scale(&self) -> Vec2 {
        match self.params.normals {
            NormalsStorage::Snorm16 => Vec2::new(1.0 / 32767.0, 0.0),
            NormalsStorage::Unorm8 => Vec2::new(2.0 / 255.0, -1.0),
        }
    }

    /// Projected normal of texel (i, j), wrapped or clamped.
    pub fn texel(&self, i: i32, j: i32) -> Vec2 {
        let at = self.wrapped(IVec2::new(i, j));
        let scale = self.normals_scale();
        codes(self.normals[at.y as usize * self.params.width as usize + at.x as usize][0]) * scale.x + scale.y
    }

    /// Stored numbers of a texel and of the one below it; `again` takes the texel for both.
    fn pair(&self, index: usize, again: bool) -> [Vec2; 2] {
        let pair = self.normals[index];
        [codes(pair[0]), codes(if again { pair[0] } else { pair[1] })]
    }

    /// The bilinear patch from texel `at` on, at the fraction `f`. A nearest texel has no slopes.
    fn patch(&self, at: IVec2, f: Vec2) -> Patch {
        let place = self.wrapped(at);
        let beside = self.wrapped(at + IVec2::X).x;
        let row = place.y as usize * self.params.width as usize;
        // Above the first row of a clamped map lies that row once more.
        let again = self.params.wrap == Wrap::Clamp && at.y < 0;
        let left = self.pair(row + place.x as usize, again);
        let right = self.pair(row + beside as usize, again);
        let codes = bilinear(left[0], right[0], left[1], right[1], f);
        let scale = self.normals_scale();
        let slope = if self.params.filter == Filter::Nearest { 0.0 } else { scale.x };
        Patch { normal: codes.normal * scale.x + scale.y, jacobian: codes.jacobian * slope, twist: codes.twist * slope }
    }

    /// Projected normal, Jacobian and twist of the filtered map at a place in it.
    fn surface_at(&self, u: Vec2) -> Patch {
        let nearest = self.params.filter == Filter::Nearest;
        let p = if nearest { u } else { u - 0.5 };
        let cell = p.floor();
        self.patch(cell.as_ivec2(), if nearest { Vec2::ZERO } else { p - cell })
    }

    /// Texels from one copy of the map to the next. Beyond a clamped sample of a surface lies its edge, with no copies.
    fn repeat(&self) -> Vec2 {
        let none = self.params.wrap == Wrap::Clamp && self.params.step_texels != 0;
        if none { Vec2::ZERO } else { Vec2::new(self.params.width as f32, self.params.height as f32) }
    }

    /// Hands boxes of `edge` texels under the footprint on the repeated map to `visit`. Returns how many.
    pub(crate) fn boxes(&self, query: &Query, edge: f32, reach: f32, visit: &mut impl FnMut(&ConditionalLobe)) -> u32 {
        let frame = &query.frame;
        let size = Vec2::new(self.params.width as f32, self.params.height as f32);
        let repeat = self.repeat();
        // Boxes of a bilinear map begin at texel centres, where its patches do.
        let origin = if self.params.filter == Filter::Nearest { 0.0 } else { 0.5 };
        let ellipse = ellipse(frame, reach);
        let index = |y: f32| ((y - origin) / edge).floor() as i32;
        let mut visited = 0;
        for j in index(frame.mean.y - ellipse.top)..=index(frame.mean.y + ellipse.top) {
            let y = origin + (j as f32 + 0.5) * edge;
            let row = row(&ellipse, origin, edge, origin + j as f32 * edge);
            for i in row.0..=row.1 {
                let place = Vec2::new(origin + (i as f32 + 0.5) * edge, y);
                let copy = (place / size).floor() * repeat;
                let centre = place - copy;
                let lobe = box_lobe(&self.surface_at(centre), Vec2::splat(edge));
                visit(&conditional(query, &lobe, frame.mean - centre - copy));
                visited += 1;
            }
        }
        visited
    }
}
