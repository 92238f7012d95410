//! Polygons in space, cut into triangles: a fan where that covers them, else ear by ear (Meisters, "Polygons have ears", 1975).
//!
//! The earcut crate is not used: it reaches into its lists without checks, and its time on bad outlines has no bound.

use glam::{DVec2, DVec3, Vec3};
use std::collections::VecDeque;

/// Corners and edges looked at in all polygons of a file, at most: some seconds.
pub(super) const MAX_STEPS: u64 = 1 << 30;

/// How a polygon was cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cut {
    /// The triangles cover the polygon.
    Whole,
    /// The outline has no area, or crosses itself as seen along its normal: the triangles are a fan.
    Fan,
    /// There are no steps left.
    TooLong,
}

/// Cuts the polygon of these corners (three or more) into triangles of `found`, numbers of corners in the polygon's sense.
/// `steps` is what is left of [`MAX_STEPS`].
pub(super) fn cut(corners: &[Vec3], steps: &mut u64, found: &mut Vec<[usize; 3]>) -> Cut {
    found.clear();
    let fan = |found: &mut Vec<[usize; 3]>| found.extend((1..corners.len() - 1).map(|k| [0, k, k + 1]));
    if corners.len() == 3 {
        fan(found);
        return Cut::Whole;
    }
    let Some(outline) = flattened(corners) else {
        fan(found);
        return Cut::Fan;
    };
    if is_fan(&outline) {
        fan(found);
        return Cut::Whole;
    }
    // Each pair of edges, and each corner for each that may be an ear: all, two where one goes, and all again twice.
    let needed = (outline.len() as u64).saturating_pow(2).saturating_mul(6);
    let Some(left) = steps.checked_sub(needed) else { return Cut::TooLong };
    *steps = left;
    if !crosses_itself(&outline) && cut_ears(&outline, found) {
        return Cut::Whole;
    }
    found.clear();
    fan(found);
    Cut::Fan
}

/// The outline along the axis that its normal is closest to, counter-clockwise; `None` without area.
fn flattened(corners: &[Vec3]) -> Option<Vec<DVec2>> {
    let from = corners[0].as_dvec3();
    let points: Vec<DVec3> = corners.iter().map(|corner| corner.as_dvec3() - from).collect();
    let edges = points.iter().zip(points.iter().cycle().skip(1));
    // Newell's normal: a mean over the outline, which no one corner spoils.
    let normal: DVec3 = edges.map(|(a, b)| a.cross(*b)).sum();
    let size = points.iter().map(|point| point.abs().max_element()).fold(0.0, f64::max);
    // Less than the rounding of coordinates is nothing.
    let rounding = f64::from(f32::EPSILON) * (size + from.abs().max_element());
    if normal.abs().max_element() <= 4.0 * rounding * size {
        return None;
    }
    let axis = normal.abs().max_position();
    let flat = |p: &DVec3| DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    let turned = |p: DVec2| if normal[axis] < 0.0 { DVec2::new(-p.x, p.y) } else { p };
    Some(points.iter().map(flat).map(turned).collect())
}

/// Twice the area of a triangle, positive if it is counter-clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Whether triangles from the first corner cover the outline once.
fn is_fan(outline: &[DVec2]) -> bool {
    let first = outline[0];
    let mut angle = 0.0;
    outline[1..].windows(2).all(|pair| {
        let (b, c) = (pair[0] - first, pair[1] - first);
        angle += b.perp_dot(c).atan2(b.dot(c));
        b.perp_dot(c) >= 0.0 && angle < std::f64::consts::TAU
    })
}

/// Whether two edges cross at a point that is a corner of neither.
fn crosses_itself(outline: &[DVec2]) -> bool {
    let n = outline.len();
    let edge = |i: usize| (outline[i], outline[(i + 1) % n]);
    let apart = |(a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)| {
        let (left, right) = (area(a, b, c), area(a, b, d));
        left > 0.0 && right < 0.0 || left < 0.0 && right > 0.0
    };
    (0..n).any(|i| (i + 2..n).any(|j| apart(edge(i), edge(j)) && apart(edge(j), edge(i))))
}

/// Cuts ears off until a triangle is left; false if there is none left to cut.
fn cut_ears(outline: &[DVec2], found: &mut Vec<[usize; 3]>) -> bool {
    let n = outline.len();
    let mut last: Vec<usize> = (0..n).map(|i| (i + n - 1) % n).collect();
    let mut next: Vec<usize> = (0..n).map(|i| (i + 1) % n).collect();
    let mut gone = vec![false; n];
    // Corners to look at. Whether one is an ear changes only where a neighbour goes, but for corners that touch an edge.
    let mut waiting: VecDeque<usize> = (0..n).collect();
    let (mut left, mut again) = (n, 2);
    while left > 3 {
        let Some(i) = waiting.pop_front() else {
            if again == 0 {
                return false;
            }
            again -= 1;
            waiting.extend((0..n).filter(|&i| !gone[i]));
            continue;
        };
        if gone[i] || !is_ear(outline, &last, &next, i) {
            continue;
        }
        let (before, after) = (last[i], next[i]);
        found.push([before, i, after]);
        (next[before], last[after], gone[i]) = (after, before, true);
        left -= 1;
        waiting.extend([after, before]);
    }
    let Some(i) = (0..n).find(|&i| !gone[i]) else { return false };
    found.push([i, next[i], next[next[i]]]);
    true
}

/// Whether the triangle at corner `i` lies in what is left of the outline and holds no other corner of it. Corners without an
/// angle are cut, too: their triangle is nothing.
fn is_ear(outline: &[DVec2], last: &[usize], next: &[usize], i: usize) -> bool {
    let [a, b, c] = [last[i], i, next[i]].map(|k| outline[k]);
    let size = area(a, b, c);
    if size <= 0.0 {
        return size == 0.0;
    }
    let mut k = next[next[i]];
    while k != last[i] {
        let p = outline[k];
        let bent_inwards = || area(outline[last[k]], p, outline[next[k]]) <= 0.0;
        let within = area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0;
        // A hole is reached over an edge that is there twice: its ends may meet the ends of the cut.
        if within && p != a && p != c && bent_inwards() {
            return false;
        }
        k = next[k];
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    /// The triangles of an outline in the plane z = 0, and how it was cut; checked in other planes and with another first
    /// corner, too.
    fn cut_flat(outline: &[(f32, f32)]) -> (Cut, f64) {
        let corners: Vec<Vec3> = outline.iter().map(|&(x, y)| Vec3::new(x, y, 0.0)).collect();
        let mut results = Vec::new();
        for turn in
            [Quat::IDENTITY, Quat::from_rotation_y(1.2), Quat::from_rotation_x(-1.4), Quat::from_rotation_y(3.0)]
        {
            for first in 0..corners.len() {
                let mut turned: Vec<Vec3> = corners.iter().map(|&p| turn * p + Vec3::new(3.0, -2.0, 1.0)).collect();
                turned.rotate_left(first);
                let mut found = Vec::new();
                let how = cut(&turned, &mut MAX_STEPS.clone(), &mut found);
                assert_eq!(found.len(), corners.len() - 2);
                let normal = turn * Vec3::Z;
                let areas = found.iter().map(|t| {
                    let [a, b, c] = t.map(|k| turned[k]);
                    0.5 * f64::from((b - a).cross(c - a).dot(normal))
                });
                let areas: Vec<f64> = areas.collect();
                if how == Cut::Whole {
                    assert!(areas.iter().all(|&area| area >= -1e-5), "{areas:?}");
                }
                results.push((how, areas.iter().map(|area| area.abs()).sum::<f64>()));
            }
        }
        assert!(results.iter().all(|r| r.0 == results[0].0), "{results:?}");
        assert!(results[0].0 == Cut::Fan || results.iter().all(|r| (r.1 - results[0].1).abs() < 1e-4), "{results:?}");
        results[0]
    }

    #[track_caller]
    fn is_whole(outline: &[(f32, f32)], area: f64) {
        let (how, found) = cut_flat(outline);
        assert!(how == Cut::Whole && (found - area).abs() < 1e-4, "{how:?}, {found} for {area}");
    }

    #[test]
    fn convex_and_concave_outlines_are_covered_once() {
        is_whole(&[(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)], 2.0);
        // An arrow, an L, an E, a star.
        is_whole(&[(0.0, 0.0), (2.0, -1.0), (1.0, 0.0), (2.0, 1.0)], 1.0);
        is_whole(&[(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)], 5.0);
        let e = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (3, 2), (3, 3), (1, 3), (1, 4), (3, 4), (3, 5), (0, 5)];
        is_whole(&e.map(|(x, y)| (x as f32, y as f32)), 11.0);
        let star: Vec<(f32, f32)> = (0..14)
            .map(|i| {
                let (radius, angle) = (if i % 2 == 0 { 3.0 } else { 1.0 }, i as f32 * std::f32::consts::TAU / 14.0);
                (radius * angle.cos(), radius * angle.sin())
            })
            .collect();
        is_whole(&star, 7.0 * 3.0 * f64::sin(std::f64::consts::PI / 7.0));
    }

    #[test]
    fn corners_on_a_line_and_holes_reached_over_an_edge() {
        let mid = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0), (1.0, 1.0), (0.0, 1.0)];
        is_whole(&mid, 3.0);
        // A square of 4 × 4 with a hole of 2 × 2, clockwise, over the edge (0,0)–(1,1).
        let hole = [(1.0, 1.0), (1.0, 3.0), (3.0, 3.0), (3.0, 1.0), (1.0, 1.0)];
        let outer = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0)];
        is_whole(&[&outer[..], &hole[..]].concat(), 12.0);
    }

    /// A comb of many teeth, and a spiral.
    #[test]
    fn long_outlines_are_covered_once() {
        let teeth = 40;
        let mut comb = vec![(0.0, 0.0), (teeth as f32, 0.0)];
        comb.extend((0..teeth).rev().flat_map(|i| [(i as f32 + 0.75, 5.0), (i as f32 + 0.5, 1.0)]));
        let area: f64 = {
            let edges = comb.iter().zip(comb.iter().cycle().skip(1));
            edges.map(|(a, b)| f64::from(a.0 * b.1 - a.1 * b.0)).sum::<f64>() / 2.0
        };
        is_whole(&comb, area);
        let arm = |i: usize, out: f32| {
            let angle = i as f32 * 0.4;
            ((angle + out) * angle.cos(), (angle + out) * angle.sin())
        };
        let spiral: Vec<_> = (0..60).map(|i| arm(i, 4.0)).chain((0..60).rev().map(|i| arm(i, 1.0))).collect();
        let (how, area) = cut_flat(&spiral);
        assert!(how == Cut::Whole && area > 100.0, "{how:?}, {area}");
    }

    #[test]
    fn what_has_no_area_or_crosses_itself_is_a_fan() {
        let bow_tie = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 3.0)];
        assert_eq!(cut_flat(&bow_tie).0, Cut::Fan);
        assert_eq!(cut_flat(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)]).0, Cut::Fan);
        assert_eq!(cut_flat(&[(1.0, 1.0); 5]).0, Cut::Fan);
        let five = [0, 2, 4, 1, 3].map(|i| (i as f32 * std::f32::consts::TAU / 5.0).sin_cos());
        assert_eq!(cut_flat(&five).0, Cut::Fan);
    }

    #[test]
    fn steps_have_an_end() {
        let arrow = [(0.0, 0.0), (2.0, -1.0), (1.0, 0.0), (2.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let mut steps = 96 + 63;
        let mut turned = arrow;
        turned.rotate_left(1);
        assert_eq!(cut(&turned, &mut steps, &mut Vec::new()), Cut::Whole);
        assert_eq!(steps, 63);
        assert_eq!(cut(&turned, &mut steps, &mut Vec::new()), Cut::TooLong);
    }
}
