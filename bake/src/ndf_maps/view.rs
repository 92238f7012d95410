//! What one placed example shows under a footprint: windows of two levels around probes, and patches of the map below the
//! finest.
//!
//! A footprint is a row of probes along its major axis, each a round Gaussian; a probe is a sum of the windows of two levels, three
//! nodes each. All shares are continuous in the footprint: nothing switches.

use super::baked::Material;
use super::eval::{EvalSettings, NodeTerm, PatchTerm, Terms, matrix};
use crate::windows::ellipse::Ellipse;
use glam::{Mat2, Vec2, Vec3};

/// Patches go over to windows from this part of the finest windows' variance on.
const PATCHES_UNTIL: f32 = 0.7;
/// Patches whose middles lie so far, in texels, beyond the reach of a footprint lie in it with a part: half a diagonal.
const PATCH_MARGIN: f32 = 0.71;
/// Distance of probes in standard deviations of the minor axis, and of what the major axis has more.
const PROBE_STEP: [f32; 2] = [2.2, 1.5];
/// What is taken off the probes' weights, so that those at the ends come in without a jump.
const PROBE_TAIL: f32 = 0.02;
/// Where the major axis begins to be seen by more than one probe and where it is by all: what its variance has more, relative to the
/// minor axis.
const PROBES_FROM: [f32; 2] = [0.1, 0.3];

/// Round Gaussians along a footprint's major axis that together are about the footprint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probes {
    /// Distance of neighbours in texels.
    pub step: f32,
    /// 1 over the square of the distance where they end.
    inverse_reach2: f32,
    /// Weight of all but the middle one.
    side: f32,
    /// Sum of weights.
    pub total: f32,
    /// Variance of each, texels².
    pub variance: f32,
}

impl Probes {
    /// Weight of the one `k` steps away.
    pub fn weight(&self, k: f32) -> f32 {
        if k == 0.0 {
            return 1.0;
        }
        let x = k * self.step;
        let t = (1.0 - x * x * self.inverse_reach2).max(0.0);
        self.side * (t * t - PROBE_TAIL).max(0.0)
    }
}

/// Round Gaussians along a footprint's major axis that together are about the footprint: weights are (1 − x²/R²)² with R² seven times the
/// variance that the major axis has more, which is that function's variance. What few probes lack of it widens each of them.
pub(super) fn probes(ellipse: &Ellipse) -> Probes {
    let minor2 = ellipse.minor * ellipse.minor;
    let more = (ellipse.major * ellipse.major - minor2).max(0.0);
    let step = (PROBE_STEP[0] * ellipse.minor).min(PROBE_STEP[1] * more.sqrt());
    let side = ((more / minor2 - PROBES_FROM[0]) / (PROBES_FROM[1] - PROBES_FROM[0])).clamp(0.0, 1.0);
    let inverse_reach2 = 1.0 / (7.0 * more).max(1e-30);
    let mut probes = Probes { step, inverse_reach2, side, total: 1.0, variance: minor2 };
    let mut second = 0.0;
    let mut k = 1.0;
    while probes.weight(k) > 0.0 {
        let weight = probes.weight(k);
        probes.total += 2.0 * weight;
        second += 2.0 * weight * (k * step) * (k * step);
        k += 1.0;
    }
    probes.variance += 0.5 * (more - second / probes.total).max(0.0);
    probes
}

/// The probe after the one `k` steps away: from the middle outward, on both sides.
pub(super) fn next_probe(k: f32) -> f32 {
    if k > 0.0 { -k } else { 1.0 - k }
}

/// A level, and the share of the next one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blend {
    pub level: u32,
    pub coarser: f32,
}

/// Part of a footprint that patches show, from its minor axis in texels of the example.
pub(super) fn patches_share(minor: f32, finest_variance: f32) -> f32 {
    ((1.0 - minor * minor / finest_variance) / (1.0 - PATCHES_UNTIL)).clamp(0.0, 1.0)
}

impl Material {
    /// The levels whose windows have a variance (texels²) between them.
    pub(super) fn blend(&self, variance: f32) -> Blend {
        let top = self.maps.params.levels.len() as u32 - 1;
        let ratio = variance / self.maps.params.finest_variance;
        if ratio <= 1.0 {
            return Blend { level: 0, coarser: 0.0 };
        }
        // A level has twice the variance of the one before: the exponent of the ratio.
        let level = (ratio.to_bits() >> 23) - 127;
        if level >= top {
            return Blend { level: top, coarser: 0.0 };
        }
        Blend { level, coarser: ratio * f32::from_bits((127 - level) << 23) - 1.0 }
    }

    /// The three nodes of a level around the example point `place`, the corners of its triangle, and their shares.
    fn corners(&self, level: u32, place: Vec2) -> ([u32; 3], [f32; 3]) {
        let record = self.maps.params.levels[level as usize];
        let nodes = Vec2::new(record.nodes_x as f32, record.nodes_y as f32);
        let mut at = place / self.size() * nodes;
        // One row alone is not shifted.
        at.y = if record.nodes_y == 1 { 0.0 } else { at.y };
        at.x -= 0.5 * at.y;
        let cell = at.floor();
        let f = at - cell;
        let upper = f.x + f.y < 1.0;
        let corner = if upper { cell } else { cell + 1.0 };
        let weights =
            if upper { Vec3::new(1.0 - f.x - f.y, f.x, f.y) } else { Vec3::new(f.x + f.y - 1.0, 1.0 - f.y, 1.0 - f.x) };
        let corners = [corner, Vec2::new(cell.x + 1.0, cell.y), Vec2::new(cell.x, cell.y + 1.0)];
        let node = |corner: Vec2| {
            // Around the example once along y is half as many columns as rows along x.
            let around = ((corner.y + 0.5) / nodes.y).floor();
            let column = corner.x + 0.5 * around * nodes.y * if record.nodes_y == 1 { 0.0 } else { 1.0 };
            let i = column - ((column + 0.5) / nodes.x).floor() * nodes.x;
            let j = corner.y - around * nodes.y;
            record.first_node + j as u32 * record.nodes_x + i as u32
        };
        (corners.map(node), weights.to_array())
    }

    /// Adds the three nodes of a level around the example point `place`, `weight` together.
    fn triangle(&self, class: u32, level: u32, place: Vec2, weight: f32, terms: &mut Terms) {
        let (nodes, shares) = self.corners(level, place);
        for (node, share) in nodes.into_iter().zip(shares) {
            terms.nodes.push(NodeTerm { node, class, weight: weight * share });
        }
    }

    /// Adds the windows around the example point `place` that stand for a round Gaussian: those of a level and `coarser` of the next.
    pub(super) fn windows(&self, class: u32, place: Vec2, blend: Blend, weight: f32, terms: &mut Terms) {
        if blend.coarser < 1.0 {
            self.triangle(class, blend.level, place, weight * (1.0 - blend.coarser), terms);
        }
        if blend.coarser > 0.0 {
            self.triangle(class, blend.level + 1, place, weight * blend.coarser, terms);
        }
    }

    /// Adds the patches of the map under an ellipse, `weight` together.
    pub(super) fn patches(
        &self,
        class: u32,
        ellipse: &Ellipse,
        settings: EvalSettings,
        weight: f32,
        terms: &mut Terms,
    ) {
        // The patch of the texels (i − 1, j − 1) to (i, j) has its middle at (i, j).
        let within = ellipse.within(settings.reach, PATCH_MARGIN);
        let half = within.half_height();
        let mut y = (within.mean.y - half).ceil();
        while y <= within.mean.y + half {
            let [first, last] = within.span_x(y);
            let mut x = first.ceil();
            while x <= last {
                let at = Vec2::new(x, y);
                let footprint = Ellipse { mean: ellipse.mean - (at - 0.5), ..*ellipse };
                let corners = self.maps.patch(at.as_ivec2());
                terms.patches.push(PatchTerm { class, corners, footprint, weight });
                x += 1.0;
            }
            y += 1.0;
        }
    }

    /// Surface offsets → example offsets under a palette entry.
    pub(super) fn position_to_local(&self, class: u32) -> Mat2 {
        matrix(self.placement.palette[class as usize].position_to_local)
    }

    /// Width and height of the example in texels.
    pub(super) fn size(&self) -> Vec2 {
        Vec2::new(self.maps.params.width as f32, self.maps.params.height as f32)
    }
}
