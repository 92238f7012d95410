//! Form factor of a rectangle over the horizon, with exact clipping. f32, plain functions, as in WGSL.
//!
//! Lambert's formula, as in Heitz et al. 2016, section 4 and listing 2: a sum over edges of the angle that an edge
//! subtends times the vertical part of its plane's normal. Deviations: every edge is cut at the horizon plane by itself,
//! and one edge along the horizon closes what is left, which needs no table of cases and no list of vertices; the angle
//! comes from atan2, which is exact both for edges that are seen end on and for those that subtend nearly half a turn; a
//! rectangle with a corner at the origin is seen edge on and gives nothing.

use glam::Vec3;

const INV_TWO_PI: f32 = 0.159_154_94;

/// What the edge from `a` to `b` adds to the form factor. Both have any length above 0.
pub fn edge_form_factor(a: Vec3, b: Vec3) -> f32 {
    let normal = a.cross(b);
    let sine = normal.length();
    if sine <= 0.0 || sine.is_nan() {
        return 0.0;
    }
    normal.z / sine * sine.atan2(a.dot(b)) * INV_TWO_PI
}

/// Form factor, 0 to 1, of a plane, convex quadrilateral for a receiver at the origin whose normal is z. Both sides count.
/// Vertices may lie anywhere; those with a coordinate that is not finite, or at the origin, make the result 0.
pub fn quad_form_factor(corners: [Vec3; 4]) -> f32 {
    let unit = corners.map(direction);
    if !unit.iter().all(|v| v.is_finite() && *v != Vec3::ZERO) {
        return 0.0;
    }
    let mut sum = 0.0;
    // Where the outline goes below the horizon and where it comes up again.
    let mut down = Vec3::ZERO;
    let mut up = Vec3::ZERO;
    for k in 0..4 {
        let (mut a, mut b) = (unit[k], unit[(k + 1) & 3]);
        let (from_above, to_above) = (a.z >= 0.0, b.z >= 0.0);
        if from_above != to_above {
            // Both lie on rays through the corners, and so does the point of their connecting line at the horizon.
            let crossing = direction(a * b.z.abs() + b * a.z.abs()) * Vec3::new(1.0, 1.0, 0.0);
            if from_above {
                b = crossing;
                down = crossing;
            } else {
                a = crossing;
                up = crossing;
            }
        }
        if from_above || to_above {
            sum += edge_form_factor(a, b);
        }
    }
    sum += edge_form_factor(down, up);
    sum.abs().min(1.0)
}

/// Unit vector, without overflow; 0 for 0, NaN for what is not finite.
pub fn direction(v: Vec3) -> Vec3 {
    let most = v.abs().max_element();
    if !v.is_finite() {
        return Vec3::NAN;
    }
    if most <= 0.0 {
        return Vec3::ZERO;
    }
    let scaled = v / most;
    scaled / scaled.length()
}
