//! Shapes: where a ray meets them, and how example texels lie on them there.

use glam::{Mat2, Vec2, Vec3};

/// A shape with its texture coordinates.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// The horizontal plane y = 0 within `half_edge` of the origin. +u is +x, +v is +z.
    Plane {
        /// Half the edge of the square.
        half_edge: f32,
    },
    /// A sphere. Its chart is the equal-area azimuthal projection around `axis`, which has no seam on that side.
    Sphere {
        /// Centre.
        centre: Vec3,
        /// Radius.
        radius: f32,
        /// Unit direction from which the sphere is looked at.
        axis: Vec3,
    },
}

/// A point of a surface with its tangent frame.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Position.
    pub position: Vec3,
    /// Normal, the tangent space's +Z.
    pub normal: Vec3,
    /// Direction of +u, the tangent space's +X.
    pub tangent: Vec3,
    /// Tangent space's +Y, against +v.
    pub bitangent: Vec3,
    /// Surface coordinates (u, v) in units of length.
    pub uv: Vec2,
    /// Offsets along (tangent, bitangent) → offsets in uv.
    pub to_uv: Mat2,
}

impl Shape {
    /// Distance along a ray of unit direction to the first point in front of it.
    pub fn hit(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        const NEAR: f32 = 1e-4;
        match *self {
            Shape::Plane { half_edge } => {
                let t = -origin.y / direction.y;
                let at = origin + direction * t;
                (t > NEAR && at.x.abs() <= half_edge && at.z.abs() <= half_edge).then_some(t)
            }
            Shape::Sphere { centre, radius, .. } => {
                let to_origin = origin - centre;
                let b = to_origin.dot(direction);
                // The distance of the ray from the centre, without the cancellation of b² − c.
                let off = to_origin - direction * b;
                let inside = radius * radius - off.length_squared();
                let root = (inside >= 0.0).then(|| inside.sqrt())?;
                [-b - root, -b + root].into_iter().find(|t| *t > NEAR)
            }
        }
    }

    /// The surface at a position on it.
    pub fn point(&self, position: Vec3) -> Point {
        match *self {
            Shape::Plane { .. } => Point {
                position,
                normal: Vec3::Y,
                tangent: Vec3::X,
                bitangent: Vec3::NEG_Z,
                uv: Vec2::new(position.x, position.z),
                to_uv: Mat2::from_cols(Vec2::X, Vec2::NEG_Y),
            },
            Shape::Sphere { centre, radius, axis } => sphere_point(position, centre, radius, axis),
        }
    }
}

/// Chart of the sphere: with n = (x, y, z) along (right, up, axis), u = r·x·√(2/(1+z)) and v = −r·y·√(2/(1+z)).
fn sphere_point(position: Vec3, centre: Vec3, radius: f32, axis: Vec3) -> Point {
    let normal = (position - centre) / radius;
    let right = Vec3::Y.cross(axis).try_normalize().unwrap_or(Vec3::X);
    let up = axis.cross(right);
    // Behind, the chart tears in one point; keeping a little away from it keeps every number finite.
    let z = normal.dot(axis).max(-0.99);
    let (x, y) = (normal.dot(right), normal.dot(up));
    let k = (2.0 / (1.0 + z)).sqrt();
    let uv = radius * k * Vec2::new(x, -y);
    // Inverse of the chart: x = a·u/r, y = −a·v/r, z = 1 − q/2 with q = (u² + v²)/r² and a = √(1 − q/4).
    let (p, q) = (uv / radius, uv.length_squared() / (radius * radius));
    let a = (1.0 - 0.25 * q).max(1e-3).sqrt();
    let du = right * (a - p.x * p.x / (4.0 * a)) + up * (p.x * p.y / (4.0 * a)) - axis * p.x;
    let dv = right * (-p.x * p.y / (4.0 * a)) - up * (a - p.y * p.y / (4.0 * a)) - axis * p.y;
    let tangent = (du - normal * du.dot(normal)).try_normalize().unwrap_or(right);
    let bitangent = normal.cross(tangent);
    let from_uv =
        Mat2::from_cols(Vec2::new(du.dot(tangent), du.dot(bitangent)), Vec2::new(dv.dot(tangent), dv.dot(bitangent)));
    Point { position, normal, tangent, bitangent, uv, to_uv: from_uv.inverse() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chart_of_the_sphere_matches_its_derivatives() {
        let shape = Shape::Sphere { centre: Vec3::new(0.1, 0.2, 0.3), radius: 1.5, axis: Vec3::new(0.6, 0.0, 0.8) };
        let Shape::Sphere { centre, radius, .. } = shape else { unreachable!() };
        for direction in [Vec3::new(0.3, 0.2, 0.9), Vec3::new(0.9, -0.3, 0.4), Vec3::new(0.6, 0.1, 0.8)] {
            let n = direction.normalize();
            let here = shape.point(centre + n * radius);
            assert!(here.tangent.cross(here.bitangent).dot(here.normal) > 0.999);
            for (offset, column) in [(here.tangent, here.to_uv.x_axis), (here.bitangent, here.to_uv.y_axis)] {
                let step = 1e-2;
                let ahead = shape.point(centre + (n * radius + offset * step).normalize() * radius);
                let found = (ahead.uv - here.uv) / step;
                assert!((found - column).length() < 0.02, "{found} {column}");
            }
        }
    }

    #[test]
    fn rays_meet_shapes_or_miss_them() {
        let sphere = Shape::Sphere { centre: Vec3::ZERO, radius: 1.0, axis: Vec3::Z };
        assert!((sphere.hit(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z).unwrap() - 4.0).abs() < 1e-5);
        assert!(sphere.hit(Vec3::new(0.0, 2.0, 5.0), Vec3::NEG_Z).is_none());
        let plane = Shape::Plane { half_edge: 1.0 };
        assert!(plane.hit(Vec3::Y, Vec3::NEG_Y).is_some());
        assert!(plane.hit(Vec3::new(3.0, 1.0, 0.0), Vec3::NEG_Y).is_none());
        assert!(plane.hit(Vec3::Y, Vec3::X).is_none());
    }
}
