//! A scene: objects, one directional light, a camera; and the radiance along a pixel's ray.

use super::shape::{Point, Shape};
use super::sky;
use super::surface::{Geometry, Surface};
use glam::{Mat2, Vec2, Vec3};
use glint_bake_core::footprint::Footprint;

/// Standard deviation of the pixel's filter, in pixels.
const PIXEL_SIGMA: f32 = 0.5;
/// Cosine below which a footprint grows no longer: at an outline it would have no end.
const GRAZING: f32 = 0.06;

/// Longer footprints are widened, as graphics cards do it: they cost more than they show.
const MOST_ANISOTROPIC: f64 = 4.0;

/// An object.
#[derive(Clone, Copy, Debug)]
pub struct Object<'a> {
    /// Its shape.
    pub shape: Shape,
    /// What it is made of.
    pub surface: Surface<'a>,
}

/// A pinhole camera.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Where it stands.
    pub position: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// Half the picture's height at distance 1.
    pub half_height: f32,
}

/// Objects, a light and a camera.
#[derive(Clone, Debug)]
pub struct Scene<'a> {
    /// Objects.
    pub objects: Vec<Object<'a>>,
    /// Unit direction towards the light.
    pub light: Vec3,
    /// Irradiance of a surface that faces the light.
    pub irradiance: Vec3,
    /// The camera.
    pub camera: Camera,
    /// Factor on radiance before it is developed.
    pub exposure: f32,
    /// Distance from the origin at which objects have faded into the backdrop.
    pub fade: Option<f32>,
}

impl Scene<'_> {
    /// What a pixel position shows: the object and whether it is lit. Edges lie where this changes.
    pub fn identify(&self, pixel: Vec2, size: Vec2) -> Option<(usize, bool)> {
        let direction = self.camera.direction(pixel, size);
        let (object, t) = self.hit(self.camera.position, direction)?;
        let point = self.objects[object].shape.point(self.camera.position + direction * t);
        Some((object, self.is_lit(&point)))
    }

    /// Radiance towards the camera at a pixel position; the footprint is one pixel's.
    pub fn radiance(&self, pixel: Vec2, size: Vec2) -> Vec3 {
        let screen = (pixel - 0.5 * size) / (0.5 * size.y);
        let backdrop = sky::backdrop(screen.x / (size.x / size.y), screen.y);
        let direction = self.camera.direction(pixel, size);
        let Some((object, t)) = self.hit(self.camera.position, direction) else { return backdrop };
        let shape = &self.objects[object].shape;
        let point = shape.point(self.camera.position + direction * t);
        let shaded = self.shade(object, &point, direction, t, size);
        match self.fade {
            None => shaded,
            Some(end) => shaded.lerp(backdrop, sky::smooth((point.position.length() - 0.35 * end) / (0.65 * end))),
        }
    }

    fn shade(&self, object: usize, point: &Point, direction: Vec3, t: f32, size: Vec2) -> Vec3 {
        let surface = &self.objects[object].surface;
        let view = -direction;
        let n_v = point.normal.dot(view).max(1e-3);
        let mirrored = direction + point.normal * (2.0 * n_v);
        let open = self.openness(object, point);
        let mut radiance =
            surface.ambient(n_v) * sky::radiance(mirrored) * open * self.reflected_share(object, point, mirrored);
        let n_l = point.normal.dot(self.light);
        if n_l > 0.0 && self.is_lit(point) {
            let half = (self.light + view).normalize();
            let geometry = Geometry {
                half: Vec3::new(half.dot(point.tangent), half.dot(point.bitangent), half.dot(point.normal)),
                n_l,
                n_v,
                v_h: view.dot(half).max(1e-3),
            };
            let footprint = self.footprint(surface.texels_per_unit, point, direction, t, size);
            radiance += surface.reflect(&footprint, &geometry) * self.irradiance;
        }
        radiance
    }

    /// The pixel's Gaussian on the surface, in texels: the pixel's width and height, laid on the tangent plane.
    fn footprint(&self, texels_per_unit: f32, point: &Point, direction: Vec3, t: f32, size: Vec2) -> Footprint {
        let (right, down) = self.camera.pixel_steps(size);
        let forward = self.camera.forward();
        // A step of one pixel on the image plane at the point's depth, then along the ray onto the tangent plane.
        let depth = t * direction.dot(forward);
        let n_d = point.normal.dot(direction).min(-GRAZING);
        let on_plane = |step: Vec3| {
            let step = step * depth;
            let lifted = step - direction * (step.dot(point.normal) / n_d);
            point.to_uv * Vec2::new(lifted.dot(point.tangent), lifted.dot(point.bitangent)) * texels_per_unit
        };
        let axes = Mat2::from_cols(on_plane(right), on_plane(down)) * PIXEL_SIGMA;
        let axes = axes.as_dmat2();
        let exact = Footprint { mean: (point.uv * texels_per_unit).as_dvec2(), covariance: axes * axes.transpose() };
        let (minor, major, direction) = exact.principal();
        if major <= MOST_ANISOTROPIC * minor {
            return exact;
        }
        let angle = libm::atan2(direction.y, direction.x);
        Footprint::new(exact.mean, major / MOST_ANISOTROPIC, MOST_ANISOTROPIC, angle)
    }

    fn hit(&self, origin: Vec3, direction: Vec3) -> Option<(usize, f32)> {
        let mut nearest: Option<(usize, f32)> = None;
        for (i, object) in self.objects.iter().enumerate() {
            if let Some(t) = object.shape.hit(origin, direction)
                && nearest.is_none_or(|(_, other)| t < other)
            {
                nearest = Some((i, t));
            }
        }
        nearest
    }

    fn is_lit(&self, point: &Point) -> bool {
        point.normal.dot(self.light) > 0.0 && self.hit(point.position + point.normal * 1e-3, self.light).is_none()
    }

    /// Share of the hemisphere that other spheres leave open: 1 − (r/d)² cos θ, exact while the sphere is above.
    fn openness(&self, object: usize, point: &Point) -> f32 {
        let mut open = 1.0;
        for (i, other) in self.objects.iter().enumerate() {
            if let Shape::Sphere { centre, radius, .. } = other.shape
                && i != object
            {
                let to_centre = centre - point.position;
                let distance = to_centre.length().max(radius);
                let cosine = (to_centre.dot(point.normal) / distance).max(0.0);
                open *= 1.0 - (radius / distance).powi(2) * cosine;
            }
        }
        open
    }

    /// How much of the sky is left where the mirrored ray meets another object, softened by the distance to its middle.
    fn reflected_share(&self, object: usize, point: &Point, mirrored: Vec3) -> f32 {
        let mut share = 1.0f32;
        for (i, other) in self.objects.iter().enumerate() {
            if let Shape::Sphere { centre, radius, .. } = other.shape
                && i != object
            {
                let to_centre = centre - point.position;
                let along = to_centre.dot(mirrored);
                let off = (to_centre - mirrored * along).length();
                if along > 0.0 {
                    share = share.min(0.25 + 0.75 * sky::smooth((off / radius - 0.5) / 1.0));
                }
            }
        }
        share
    }
}

impl Camera {
    fn forward(&self) -> Vec3 {
        (self.target - self.position).normalize()
    }

    /// Steps of one pixel to the right and down at distance 1.
    fn pixel_steps(&self, size: Vec2) -> (Vec3, Vec3) {
        let forward = self.forward();
        // Looking straight up or down leaves "right" open.
        let right = forward.cross(Vec3::Y).try_normalize().unwrap_or(Vec3::X);
        let up = right.cross(forward);
        let pixel = 2.0 * self.half_height / size.y;
        (right * pixel, -up * pixel)
    }

    /// Unit direction through a pixel position.
    fn direction(&self, pixel: Vec2, size: Vec2) -> Vec3 {
        let (right, down) = self.pixel_steps(size);
        let off = pixel - 0.5 * size;
        (self.forward() + right * off.x + down * off.y).normalize()
    }
}
