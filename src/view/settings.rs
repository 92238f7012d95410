//! All that a user sets, in the window's panel or by flags, and the view that follows from it.

use crate::render::{
    Camera, Compare, Display, Environment, LightKind, Lights, Material, Overlay, PointLight, RectLight, Scene, Side,
    Subject, Sun, ToneMapping, View,
};
use crate::scene::Orbit;
use glam::Vec3;

/// What stands beside the method that is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Against {
    /// Nothing.
    #[default]
    Nothing,
    /// Another entry of the list of what can be shown, by its index.
    Other(usize),
    /// The method's own reference, which converges frame by frame.
    Reference,
}

/// How two sides are put together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    /// Left and right of a line at this share of the width.
    Split(f32),
    /// Relative difference in false colours.
    Error,
    /// Only what the method is compared with: B of A and B.
    Swapped,
}

/// The lights, each with a switch: what is off keeps its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct LightSettings {
    /// Whether the directional light is on.
    pub sun_on: bool,
    /// Directional light.
    pub sun: Sun,
    /// Whether the points are on.
    pub points_on: bool,
    /// Points.
    pub points: Vec<PointLight>,
    /// Whether the rectangle is on.
    pub rect_on: bool,
    /// Rectangle.
    pub rect: RectLight,
    /// Whether the environment is on.
    pub environment_on: bool,
    /// How it is turned and scaled.
    pub environment: Environment,
    /// Whether a dim room is around the scene; not where the environment is on.
    pub room_on: bool,
}

impl LightSettings {
    /// Lights for the mesh that a camera was made for: over and behind what is flat, where its mirror image is seen; else in
    /// front.
    pub fn for_camera(camera: &Orbit) -> LightSettings {
        let (centre, radius) = (camera.target, camera.radius());
        let (sun, point, middle) = if camera.is_flat() {
            (Vec3::new(0.1, 0.65, -0.8), Vec3::new(0.2, 0.6, -0.6), Vec3::new(0.0, 0.6, -1.2))
        } else {
            (Vec3::new(0.5, 0.8, 0.7), Vec3::new(0.9, 1.0, 1.3), Vec3::new(-1.0, 1.4, 1.3))
        };
        LightSettings {
            sun_on: true,
            sun: Sun { direction: sun, irradiance: Vec3::splat(1.0), solid_angle_sr: cone_solid_angle(SUN_DEGREES) },
            points_on: false,
            points: vec![PointLight {
                position: centre + point * radius,
                intensity: Vec3::splat(3.0 * radius * radius),
                radius: 0.02 * radius,
            }],
            rect_on: false,
            rect: rect_facing(centre, centre + middle * radius, 0.55 * radius, 0.35 * radius),
            environment_on: false,
            environment: Environment { turn: 0.0, gain: 1.0 },
            room_on: true,
        }
    }

    /// Switches these on and all others off.
    pub fn only(&mut self, kinds: &[LightKind]) {
        self.sun_on = kinds.contains(&LightKind::Sun);
        self.points_on = kinds.contains(&LightKind::Points);
        self.rect_on = kinds.contains(&LightKind::Rect);
        self.environment_on = kinds.contains(&LightKind::Environment);
    }

    fn lights(&self) -> Lights {
        Lights {
            sun: self.sun_on.then_some(self.sun),
            points: if self.points_on { self.points.clone() } else { Vec::new() },
            rect: self.rect_on.then_some(self.rect),
            environment: self.environment_on.then_some(self.environment),
            room: self.room_on && !self.environment_on,
        }
    }
}

/// Angle across the sun's disk, in degrees.
pub const SUN_DEGREES: f32 = 0.533;

/// Solid angle, in steradians, of a disk in the sky that is so many degrees across.
pub fn cone_solid_angle(degrees: f32) -> f32 {
    // 1 − cos x, with its digits.
    let half_sine = (0.25 * degrees.to_radians()).sin();
    4.0 * std::f32::consts::PI * half_sine * half_sine
}

/// A rectangle around `middle` that faces `target`, upright, of this half width and half height.
pub(crate) fn rect_facing(target: Vec3, middle: Vec3, half_width: f32, half_height: f32) -> RectLight {
    let front = (target - middle).normalize_or(Vec3::NEG_Y);
    let right = Vec3::Y.cross(front).normalize_or(Vec3::X);
    let (across, up) = (right * half_width, front.cross(right) * half_height);
    RectLight {
        corners: [middle - across - up, middle + across - up, middle + across + up, middle - across + up],
        radiance: Vec3::splat(4.0),
        two_sided: false,
    }
}

/// All that a user sets.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Index of what is shown.
    pub shown: usize,
    /// What it is compared with.
    pub against: Against,
    /// How.
    pub layout: Layout,
    /// Whether the reference is shown in place of the method.
    pub reference: bool,
    /// Parameters, one entry for each that can be shown.
    pub materials: Vec<Material>,
    /// Lights.
    pub lights: LightSettings,
    /// Exposure in stops: radiance is multiplied by 2 to this.
    pub exposure_stops: f32,
    /// Tone mapping.
    pub tone: ToneMapping,
    /// False colours.
    pub overlay: Overlay,
    /// Camera.
    pub camera: Orbit,
    /// Surface units on one unit of the mesh's uv.
    pub uv_scale: f32,
    /// Whether frames are averaged with their edges smoothed.
    pub antialias: bool,
    /// Whether every frame has another seed, so that the mean over frames is that over surfaces.
    pub vary_seed: bool,
}

impl Settings {
    /// What a new user sees of `list` through a camera that was made for the mesh: its first entry in directional light.
    pub fn new(list: &[Subject], camera: Orbit) -> Settings {
        Settings {
            shown: 0,
            against: Against::Nothing,
            layout: Layout::Split(0.5),
            reference: false,
            materials: list.iter().map(|shown| shown.material).collect(),
            lights: LightSettings::for_camera(&camera),
            exposure_stops: 0.0,
            tone: ToneMapping::Filmic,
            overlay: Overlay::None,
            camera,
            uv_scale: 1.0,
            antialias: false,
            vary_seed: false,
        }
    }

    /// The view of `list` in `size` pixels.
    pub fn view(&self, list: &[Subject], size: [u32; 2]) -> View {
        let side = |index: usize, reference| Side {
            shown: Subject { material: self.materials[index], ..list[index].clone() },
            reference,
        };
        let own = side(self.shown, self.reference);
        let other = match self.against {
            Against::Nothing => None,
            Against::Other(index) => Some(side(index, false)),
            Against::Reference => Some(side(self.shown, true)),
        };
        let compare = match (other, self.layout) {
            (None, _) => Compare::Single(own),
            (Some(other), Layout::Split(at)) => Compare::Split(own, other, at),
            (Some(other), Layout::Error) => Compare::Error(own, other),
            (Some(other), Layout::Swapped) => Compare::Single(other),
        };
        View {
            size,
            scene: Scene {
                camera: Camera {
                    position: self.camera.position(),
                    target: self.camera.target,
                    field_of_view: self.camera.field_of_view,
                    near: self.camera.near(),
                },
                lights: self.lights.lights(),
                uv_scale: self.uv_scale,
            },
            compare,
            display: Display { exposure: self.exposure_stops.exp2(), tone: self.tone, overlay: self.overlay },
            antialias: self.antialias,
            vary_seed: self.vary_seed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;

    #[test]
    fn the_rectangle_radiates_towards_the_mesh() {
        let bounds = Mesh::sphere(8).bounds();
        let [a, b, _, d] = LightSettings::for_camera(&Orbit::fit(bounds)).rect.corners;
        // Counter-clockwise from where it radiates to: the normal points there.
        assert!((b - a).cross(d - a).dot(bounds.centre() - a) > 0.0);
    }
}
