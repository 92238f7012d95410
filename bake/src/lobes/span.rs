//! Which cells of a repeated grid an ellipse touches, row by row.

use super::eval::Frame;

impl Frame {
    /// Half the height of the ellipse of `reach` standard deviations.
    pub(crate) fn reach_y(&self, reach: f32) -> f32 {
        reach * self.variance_y().sqrt()
    }

    fn variance_y(&self) -> f32 {
        (self.axis.y * self.major).powi(2) + (self.axis.x * self.minor).powi(2)
    }
}

/// Range of x of the ellipse of `reach` standard deviations between the heights `from` and `to`.
pub(crate) fn span_x(frame: &Frame, reach: f32, from: f32, to: f32) -> Option<(f32, f32)> {
    let yy = frame.variance_y();
    let top = reach * yy.sqrt();
    let (from, to) = ((from - frame.mean.y).max(-top), (to - frame.mean.y).min(top));
    if from > to {
        return None;
    }
    let xy = frame.axis.x * frame.axis.y * (frame.major * frame.major - frame.minor * frame.minor);
    let xx = (frame.axis.x * frame.major).powi(2) + (frame.axis.y * frame.minor).powi(2);
    // At height y: middle ± half the width. Both sides are extreme where the ellipse is, or at an end of the range.
    let narrow = frame.major * frame.minor / yy;
    let side = |y: f32| (xy / yy * y, narrow * (top * top - y * y).max(0.0).sqrt());
    let widest = reach * xy / xx.sqrt();
    let (left, right) = (side((-widest).clamp(from, to)), side(widest.clamp(from, to)));
    Some((frame.mean.x + left.0 - left.1, frame.mean.x + right.0 + right.1))
}

/// A cell's place on one axis of the repeated map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slot {
    /// Index of the cell in the map.
    pub index: u32,
    /// Copy of the map.
    pub copy: f32,
    /// Lower end, in texels.
    pub start: f32,
    /// Upper end.
    pub end: f32,
}

/// The cells of `edge` texels, `count` of them in every `length`, that touch the range `from … to`.
pub(super) fn slots(from: f32, to: f32, length: f32, edge: f32, count: u32) -> impl Iterator<Item = Slot> {
    let mut copy = (from / length).floor();
    let mut index = (((from - copy * length) / edge) as u32).min(count - 1);
    std::iter::from_fn(move || {
        let start = copy * length + index as f32 * edge;
        if start > to {
            return None;
        }
        let slot = Slot { index, copy, start, end: (start + edge).min((copy + 1.0) * length) };
        index += 1;
        if index == count {
            index = 0;
            copy += 1.0;
        }
        Some(slot)
    })
}
