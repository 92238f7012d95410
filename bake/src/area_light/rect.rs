//! Form factor of a polygon over the horizon, with exact clipping. f32, plain functions, as in WGSL.
//!
//! Lambert's formula, as in Heitz et al. 2016, section 4 and listing 2: a sum over edges of the angle that an edge
//! subtends times the vertical part of its plane's normal. Deviations: the polygon is clipped by the horizon plane one
//! edge after another, which needs no table of cases; the angle comes from atan2, which is exact both for edges that are
//! seen end on and for those that subtend nearly half a turn; vertices at the origin have no direction and are left out.

use glam::Vec3;

const INV_TWO_PI: f32 = 0.159_154_94;
/// Vertices after clipping a quadrilateral by a plane.
const MAX_VERTICES: usize = 5;

/// What the edge from `a` to `b` adds to the form factor. Both have any length above 0.
pub fn edge_form_factor(a: Vec3, b: Vec3) -> f32 {
    let normal = a.cross(b);
    let sine = normal.length();
    if sine <= 0.0 || sine.is_nan() {
        return 0.0;
    }
    normal.z / sine * sine.atan2(a.dot(b)) * INV_TWO_PI
}

/// Form factor, 0 to 1, of a quadrilateral for a receiver at the origin whose normal is z. Counter-clockwise, as the
/// receiver sees it, is positive; both sides count. Vertices may lie anywhere; those with a coordinate that is not
/// finite make the result 0.
pub fn quad_form_factor(corners: [Vec3; 4]) -> f32 {
    let mut vertices = [Vec3::ZERO; MAX_VERTICES];
    let mut count = 0;
    let unit = corners.map(direction);
    if !unit.iter().all(|v| v.is_finite()) {
        return 0.0;
    }
    for k in 0..4 {
        let (a, b) = (unit[k], unit[(k + 1) & 3]);
        if a.z >= 0.0 && a != Vec3::ZERO {
            vertices[count.min(MAX_VERTICES - 1)] = a;
            count += 1;
        }
        if (a.z > 0.0 && b.z < 0.0) || (a.z < 0.0 && b.z > 0.0) {
            // Both lie on rays through the corners, and so does the point of their connecting line at the horizon.
            let crossing = direction(a * b.z.abs() + b * a.z.abs());
            if crossing != Vec3::ZERO {
                vertices[count.min(MAX_VERTICES - 1)] = Vec3::new(crossing.x, crossing.y, 0.0);
                count += 1;
            }
        }
    }
    count = count.min(MAX_VERTICES);
    if count < 3 {
        return 0.0;
    }
    let mut sum = 0.0;
    for k in 0..count {
        sum += edge_form_factor(vertices[k], vertices[if k + 1 == count { 0 } else { k + 1 }]);
    }
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
