//! A camera that orbits a target: mouse, wheel and text set it. +Y of the world is up; azimuth 0 looks along -z.

use super::mesh::{Bounds, Mesh};
use glam::{Mat3, Vec2, Vec3};
use std::fmt;
use std::str::FromStr;

/// Largest elevation in degrees: straight down, right and left would be anywhere.
const MAX_ELEVATION: f32 = 89.9;
/// Vertical field of view of a new camera, in radians (35°).
const FIELD_OF_VIEW: f32 = 0.610_865_24;
/// Distances in units of the mesh's radius. Nearer, a pixel would be less than ten steps of f32 wide on the surface.
const DISTANCES: [f32; 2] = [1.0e-3, 1.0e3];
/// Distance of the near plane in units of that of the target.
const NEAR: f32 = 0.01;

/// Camera on a sphere around its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// What it looks at.
    pub target: Vec3,
    /// Distance from there, world units.
    pub distance: f32,
    /// Angle around the vertical axis in degrees: 0 is on +z of the target, 90 on +x.
    pub azimuth: f32,
    /// Angle above the horizon in degrees, within ±89.9.
    pub elevation: f32,
    /// Vertical field of view in radians.
    pub field_of_view: f32,
    /// Radius of what is looked at: zoom stays in proportion to it.
    radius: f32,
    is_flat: bool,
}

/// What `--camera` says: `azimuth,elevation,distance[,x,y,z]`, degrees and world units, then the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// As [`Orbit::azimuth`].
    pub azimuth: f32,
    /// As [`Orbit::elevation`].
    pub elevation: f32,
    /// As [`Orbit::distance`].
    pub distance: f32,
    /// As [`Orbit::target`]; the middle of the mesh without.
    pub target: Option<Vec3>,
}

/// Why a text is no [`Placement`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{text}' is not azimuth,elevation,distance or azimuth,elevation,distance,x,y,z: {reason}")]
pub struct CameraTextError {
    text: String,
    reason: String,
}

impl FromStr for Placement {
    type Err = CameraTextError;

    fn from_str(text: &str) -> Result<Placement, CameraTextError> {
        let fail = |reason: String| CameraTextError { text: text.to_owned(), reason };
        let mut numbers = Vec::new();
        for word in text.split(',') {
            let number: f32 = word.trim().parse().map_err(|_| fail(format!("'{word}' is not a number")))?;
            // Squares of larger ones are near the end of f32.
            if number.is_nan() || number.abs() > 1.0e15 {
                return Err(fail(format!("{number} is out of range")));
            }
            numbers.push(number);
        }
        let (&[azimuth, elevation, distance], target) = match numbers.len() {
            3 => (numbers.first_chunk().ok_or_else(|| fail(String::new()))?, None),
            6 => (numbers.first_chunk().ok_or_else(|| fail(String::new()))?, Some(Vec3::from_slice(&numbers[3..]))),
            count => return Err(fail(format!("it has {count} numbers"))),
        };
        if elevation.abs() > 90.0 {
            return Err(fail(format!("the elevation {elevation} is not within -90 to 90")));
        }
        if distance < 1.0e-6 {
            return Err(fail(format!("the distance {distance} is not at least 1e-6")));
        }
        Ok(Placement { azimuth, elevation, distance, target })
    }
}

impl fmt::Display for Placement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{}", self.azimuth, self.elevation, self.distance)?;
        self.target.map_or(Ok(()), |t| write!(f, ",{},{},{}", t.x, t.y, t.z))
    }
}

impl Orbit {
    /// Looks at all of `bounds` from a little above; at what is flat from nearer, so that it fills the picture's width.
    pub fn fit(bounds: Bounds) -> Orbit {
        let radius = bounds.radius.max(1.0e-6);
        let is_flat = bounds.max.y - bounds.min.y < 0.01 * radius;
        // A sphere around it, a tenth larger, touches the upper and lower edge of the picture.
        let distance = 1.1 * radius / (0.5 * FIELD_OF_VIEW).sin();
        Orbit {
            target: bounds.centre(),
            distance: if is_flat { 0.6 * distance } else { distance },
            azimuth: 0.0,
            elevation: if is_flat { 35.0 } else { 25.0 },
            field_of_view: FIELD_OF_VIEW,
            radius,
            is_flat,
        }
    }

    /// Radius of the mesh that it was made for.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// Whether that mesh is horizontal and flat.
    pub fn is_flat(&self) -> bool {
        self.is_flat
    }

    /// Puts the camera where a text says; distances are not limited then.
    pub fn place(&mut self, placement: Placement) {
        self.azimuth = placement.azimuth;
        self.elevation = placement.elevation.clamp(-MAX_ELEVATION, MAX_ELEVATION);
        self.distance = placement.distance;
        self.target = placement.target.unwrap_or(self.target);
    }

    /// Where the camera is, as `--camera` takes it.
    pub fn placement(&self) -> Placement {
        Placement {
            azimuth: self.azimuth,
            elevation: self.elevation,
            distance: self.distance,
            target: Some(self.target),
        }
    }

    /// Columns: right, up and back.
    pub fn axes(&self) -> Mat3 {
        let (azimuth, elevation) = (self.azimuth.to_radians(), self.elevation.to_radians());
        let back =
            Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos()).normalize();
        let right = Vec3::new(azimuth.cos(), 0.0, -azimuth.sin());
        Mat3::from_cols(right, back.cross(right), back)
    }

    /// Position of the camera.
    pub fn position(&self) -> Vec3 {
        self.target + self.distance * self.axes().z_axis
    }

    /// Distance of the near plane: it follows the distance, so that single facets are not cut off.
    pub fn near(&self) -> f32 {
        self.distance * NEAR
    }

    /// Turns by a drag of `pixels` in a picture of `size`: its height is half a turn.
    pub fn orbit(&mut self, pixels: Vec2, size: Vec2) {
        let degrees = pixels * 180.0 / size.y.max(1.0);
        self.azimuth = (self.azimuth - degrees.x + 180.0).rem_euclid(360.0) - 180.0;
        self.elevation = (self.elevation + degrees.y).clamp(-MAX_ELEVATION, MAX_ELEVATION);
    }

    /// Moves so that what lies at the target's depth goes with a drag of `pixels` in a picture of `size`.
    pub fn pan(&mut self, pixels: Vec2, size: Vec2) {
        let a_pixel = 2.0 * self.distance * (0.5 * self.field_of_view).tan() / size.y.max(1.0);
        let axes = self.axes();
        self.target += (axes.y_axis * pixels.y - axes.x_axis * pixels.x) * a_pixel;
    }

    /// Direction through `pixel` of a picture of `size`, not a unit vector.
    pub fn ray(&self, pixel: Vec2, size: Vec2) -> Vec3 {
        let size = size.max(Vec2::ONE);
        let half = Vec2::new(size.x / size.y, 1.0) * (0.5 * self.field_of_view).tan();
        let place = (pixel / size * 2.0 - 1.0) * half;
        self.axes() * Vec3::new(place.x, -place.y, -1.0)
    }

    /// Multiplies the distance by `factor`, below 1 to go nearer. With a point that is seen, the camera moves on the line to
    /// it, so that it stays where it is in the picture, and then orbits at its depth: a surface is neared and not passed.
    pub fn zoom(&mut self, factor: f32, seen: Option<Vec3>) {
        let limits = DISTANCES.map(|distance| distance * self.radius);
        let forward = -self.axes().z_axis;
        let position = self.position();
        let depth = seen.map(|point| (point - position).dot(forward)).filter(|&depth| depth > 0.0);
        let (Some(point), Some(depth)) = (seen, depth) else {
            // A distance that a text set beyond the limits stays there until it is changed towards them.
            let zoomed = self.distance * factor;
            self.distance = zoomed.clamp(limits[0].min(self.distance), limits[1].max(self.distance));
            return;
        };
        let zoomed = (depth * factor).clamp(limits[0].min(depth), limits[1].max(depth));
        let moved = point + (position - point) * (zoomed / depth);
        self.distance = zoomed;
        self.target = moved + forward * zoomed;
    }
}

impl Mesh {
    /// The first place where the ray from `origin` along `direction` meets a triangle, from either side.
    /// Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997.
    pub fn hit(&self, origin: Vec3, direction: Vec3) -> Option<Vec3> {
        let place = |index: u32| Vec3::from(self.vertices[index as usize].position);
        let mut nearest = f32::INFINITY;
        for triangle in self.indices.chunks_exact(3) {
            let a = place(triangle[0]);
            let (e, f) = (place(triangle[1]) - a, place(triangle[2]) - a);
            let across = direction.cross(f);
            let determinant = e.dot(across);
            if determinant == 0.0 {
                continue;
            }
            let from = origin - a;
            let u = from.dot(across) / determinant;
            let along = from.cross(e);
            let v = direction.dot(along) / determinant;
            let t = f.dot(along) / determinant;
            if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < nearest {
                nearest = t;
            }
        }
        nearest.is_finite().then(|| origin + direction * nearest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Orbit {
        Orbit::fit(Mesh::sphere(16).bounds())
    }

    #[test]
    fn a_placement_is_its_text() {
        for text in ["0,25,4", "-120.5,89.9,0.001,1,-2,3.25", "1e-7,-90,1000000,0,0,0"] {
            let placement: Placement = text.parse().unwrap();
            assert_eq!(placement.to_string().parse::<Placement>().unwrap(), placement, "{text}");
        }
        let mut orbit = camera();
        orbit.orbit(Vec2::new(33.3, -12.7), Vec2::new(640.0, 360.0));
        let mut again = camera();
        again.place(orbit.placement().to_string().parse().unwrap());
        assert_eq!(again, orbit);
    }

    #[test]
    fn texts_that_are_no_placement_say_why() {
        for (text, reason) in [
            ("", "not a number"),
            ("1,2", "2 numbers"),
            ("1,2,3,4", "4 numbers"),
            ("1,2,3,4,5,6,7", "7 numbers"),
            ("a,2,3", "'a' is not a number"),
            ("0,91,1", "elevation 91"),
            ("0,0,0", "distance 0"),
            ("0,0,-1", "distance -1"),
            ("NaN,0,1", "out of range"),
            ("0,0,inf", "out of range"),
        ] {
            let error = text.parse::<Placement>().unwrap_err().to_string();
            assert!(error.contains(reason), "{text}: {error}");
        }
    }

    #[test]
    fn the_frame_is_right_handed_and_looks_at_the_target() {
        for (azimuth, elevation) in [(0.0, 0.0), (90.0, 30.0), (-170.0, -89.9), (45.0, 89.9)] {
            let mut orbit = camera();
            orbit.place(Placement { azimuth, elevation, distance: 3.0, target: Some(Vec3::new(1.0, 2.0, 3.0)) });
            let axes = orbit.axes();
            assert!((axes.determinant() - 1.0).abs() < 1e-5);
            assert!(axes.y_axis.y > 0.0, "up is up");
            let centre = orbit.ray(Vec2::new(320.0, 180.0), Vec2::new(640.0, 360.0)).normalize();
            assert!((orbit.position() + centre * 3.0 - orbit.target).length() < 1e-4);
        }
    }

    #[test]
    fn all_of_a_sphere_is_in_the_picture() {
        let orbit = camera();
        let size = Vec2::new(640.0, 360.0);
        let sphere = Mesh::sphere(32);
        assert!(sphere.hit(orbit.position(), orbit.ray(Vec2::new(320.0, 180.0), size)).is_some());
        for edge in [Vec2::new(320.0, 1.0), Vec2::new(320.0, 359.0), Vec2::new(1.0, 180.0), Vec2::new(639.0, 180.0)] {
            assert!(sphere.hit(orbit.position(), orbit.ray(edge, size)).is_none(), "{edge}");
        }
    }

    #[test]
    fn zooming_nears_the_surface_under_the_mouse_and_stays_in_front_of_it() {
        let (mut orbit, mesh, size) = (camera(), Mesh::sphere(16), Vec2::new(640.0, 360.0));
        let mouse = Vec2::new(380.0, 150.0);
        let first = mesh.hit(orbit.position(), orbit.ray(mouse, size)).unwrap();
        for _ in 0..200 {
            let seen = mesh.hit(orbit.position(), orbit.ray(mouse, size));
            orbit.zoom(0.9, seen);
        }
        let last = mesh.hit(orbit.position(), orbit.ray(mouse, size)).unwrap();
        assert!((first - last).length() < 1e-3, "the point under the mouse stays there: {first} {last}");
        let left = (orbit.position() - last).length();
        assert!(left > 5e-4 && left < 5e-3, "{left}");
        assert!(orbit.near() < left);
        for _ in 0..400 {
            orbit.zoom(1.2, None);
        }
        assert!(orbit.distance > 1e3 && orbit.distance < 2e3, "{}", orbit.distance);
    }

    #[test]
    fn panning_takes_the_target_along() {
        let mut orbit = camera();
        let (size, target) = (Vec2::new(640.0, 360.0), orbit.target);
        orbit.pan(Vec2::new(50.0, -20.0), size);
        // What was in the middle is now 50 pixels to the right and 20 up.
        let direction = orbit.ray(Vec2::new(320.0 + 50.0, 180.0 - 20.0), size).normalize();
        let to = (target - orbit.position()).normalize();
        assert!(direction.dot(to) > 1.0 - 1e-6);
    }

    #[test]
    fn empty_pictures_move_nothing_out_of_range() {
        let mut orbit = camera();
        orbit.orbit(Vec2::new(5.0, 1e9), Vec2::ZERO);
        orbit.pan(Vec2::new(5.0, 3.0), Vec2::ZERO);
        orbit.zoom(0.0, None);
        assert!(orbit.position().is_finite() && orbit.ray(Vec2::ZERO, Vec2::ZERO).is_finite());
        assert!(orbit.distance > 0.0 && orbit.elevation == MAX_ELEVATION);
    }
}
