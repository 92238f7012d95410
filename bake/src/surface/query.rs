//! A footprint on a synthesised surface, and what the surface shows at a place of it. Tan et al. 2022, section 5.2.

use super::baked::Surface;
use crate::footprint::Footprint;
use crate::lobes::boxes::bilinear;
use crate::lobes::eval::{self, ConditionalLobe, Patch, Query, box_lobe, conditional, ellipse, row};
use crate::lobes::query::QuerySettings;
use glam::{DVec2, IVec2, Mat2, Vec2};
use glint_formats::lobes::Filter;
use glint_formats::synthesis::CORNER_TILES;

/// A surface without end is taken to repeat after as many patches as fit into this many texels, so that places have digits.
const MOST_TEXELS: u32 = 1 << 30;

/// Choice between speed and accuracy at run time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSettings {
    /// Choice of levels.
    pub lobes: QuerySettings,
    /// Edge in texels of a level's cells from which on blocks that seams cross are read by the parts of lobes that each
    /// patch owns; those of smaller ones by blocks of the finest level and boxes.
    pub owned_from: f32,
    /// Geometric mean of the footprint's standard deviations, in texels, from which on all but the finest blocks are read so.
    pub owned_sigma: f32,
    /// Largest range of normals in a box at a seam, over σ_r, that is not halved.
    pub box_range: f32,
    /// Footprint's major standard deviation, in texels, up to which boxes at seams are halved along both axes.
    pub halves_until: f32,
    /// Whether a block that seams cross is read as that of the patch at its middle, as if there were no seams, and boxes as
    /// those of the patch at the footprint's middle.
    pub whole_blocks: bool,
}

/// A surface, and what is asked of it. The frame's centre is relative to `origin`.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceQuery<'a> {
    /// The surface.
    pub surface: &'a Surface,
    /// The footprint and the intrinsic roughness.
    pub point: Query,
    /// A texel of the surface that is a corner of blocks of every level.
    pub origin: IVec2,
    /// Choice between speed and accuracy.
    pub settings: &'a SurfaceSettings,
}

impl Default for SurfaceSettings {
    /// Every seam is followed.
    fn default() -> SurfaceSettings {
        SurfaceSettings {
            lobes: QuerySettings::default(),
            owned_from: 32.0,
            owned_sigma: 14.0,
            box_range: 2.0,
            halves_until: 6.0,
            whole_blocks: false,
        }
    }
}

impl SurfaceSettings {
    /// Few lobes, for pictures: those of [`QuerySettings::realtime`], and no work at seams.
    pub fn realtime() -> SurfaceSettings {
        SurfaceSettings { lobes: QuerySettings::realtime(), whole_blocks: true, ..SurfaceSettings::default() }
    }
}

/// The query of a footprint: its centre in the surface's first period, and then relative to a corner of a largest block near
/// it, where places have the most digits.
pub(super) fn query<'a>(
    surface: &'a Surface,
    footprint: &Footprint,
    roughness: f32,
    settings: &'a SurfaceSettings,
) -> SurfaceQuery<'a> {
    let synthesis = &surface.synthesis.uniform;
    let edge = f64::from(synthesis.patch_texels);
    let mut patches = DVec2::new(f64::from(synthesis.columns), f64::from(synthesis.rows));
    if synthesis.arrangement == CORNER_TILES {
        patches = DVec2::splat(f64::from(MOST_TEXELS / synthesis.patch_texels));
    }
    let period = patches * edge;
    let place = footprint.mean - (footprint.mean / period).floor() * period;
    let first = (place / edge).floor() * edge;
    let origin = first.as_ivec2();
    let mean = place - first;
    let frame = eval::frame(&Footprint { mean, ..*footprint });
    SurfaceQuery { surface, point: eval::query(frame, roughness), origin, settings }
}

/// Projected normal of the surface's texel `at` from the origin.
fn texel(q: &SurfaceQuery<'_>, at: IVec2) -> Vec2 {
    let on_surface = q.origin.wrapping_add(at);
    let (x, y) = q.surface.synthesis.source_texel(on_surface.x, on_surface.y);
    q.surface.lobes.texel(x as i32, y as i32)
}

/// The bilinear patch of texels at a place, or the nearest texel, which has no slopes.
pub(super) fn filtered(filter: Filter, u: Vec2, texel: impl Fn(IVec2) -> Vec2) -> Patch {
    if filter == Filter::Nearest {
        return Patch { normal: texel(u.floor().as_ivec2()), jacobian: Mat2::ZERO, twist: Vec2::ZERO };
    }
    let p = u - 0.5;
    let cell = p.floor();
    let at = cell.as_ivec2();
    bilinear(texel(at), texel(at + IVec2::X), texel(at + IVec2::Y), texel(at + IVec2::ONE), p - cell)
}

/// Normal, Jacobian and twist of the surface at a place.
pub(super) fn patch_at(q: &SurfaceQuery<'_>, u: Vec2) -> Patch {
    filtered(q.surface.lobes.params.filter, u, |at| texel(q, at))
}

/// Hands boxes of `edge` texels under the footprint to `visit`, each made of the patch that `patch` gives at its middle. Returns
/// how many.
pub(super) fn boxes_of(
    q: &SurfaceQuery<'_>,
    edge: f32,
    patch: impl Fn(Vec2) -> Patch,
    visit: &mut impl FnMut(&ConditionalLobe),
) -> u32 {
    let frame = &q.point.frame;
    // Boxes of a bilinear map begin at texel centres, where its patches do.
    let origin = if q.surface.lobes.params.filter == Filter::Nearest { 0.0 } else { 0.5 };
    let ellipse = ellipse(frame, q.settings.lobes.reach);
    let index = |y: f32| ((y - origin) / edge).floor() as i32;
    let mut visited = 0;
    for j in index(frame.mean.y - ellipse.top)..=index(frame.mean.y + ellipse.top) {
        let row = row(&ellipse, origin, edge, origin + j as f32 * edge);
        for i in row.0..=row.1 {
            let centre = origin + (Vec2::new(i as f32, j as f32) + 0.5) * edge;
            let lobe = box_lobe(&patch(centre), Vec2::splat(edge));
            visit(&conditional(&q.point, &lobe, frame.mean - centre));
            visited += 1;
        }
    }
    visited
}
