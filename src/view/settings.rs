//! All that a user sets, in the window's panel or by flags, and the view that follows from it.

use crate::render::{
    Camera, Compare, Display, Environment, Lights, Material, Overlay, PointLight, RectLight, Scene, Shown, Side, Sun,
    ToneMapping, View,
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
}

impl Default for LightSettings {
    /// A directional light from behind the surface, a point over it and a rectangle behind it, for meshes of radius 1.
    fn default() -> LightSettings {
        let corner = |x: f32, y: f32| Vec3::new(x, y, -1.6);
        LightSettings {
            sun_on: true,
            sun: Sun { direction: Vec3::new(0.3, 1.2, -1.0), irradiance: Vec3::splat(3.0) },
            points_on: false,
            points: vec![PointLight { position: Vec3::new(0.6, 0.9, -0.6), intensity: Vec3::splat(3.0) }],
            rect_on: false,
            rect: RectLight {
                corners: [corner(-0.8, 0.3), corner(0.8, 0.3), corner(0.8, 1.1), corner(-0.8, 1.1)],
                radiance: Vec3::splat(6.0),
                two_sided: false,
            },
            environment_on: false,
            environment: Environment { turn: 0.0, gain: 1.0 },
        }
    }
}

impl LightSettings {
    fn lights(&self) -> Lights {
        Lights {
            sun: self.sun_on.then_some(self.sun),
            points: if self.points_on { self.points.clone() } else { Vec::new() },
            rect: self.rect_on.then_some(self.rect),
            environment: self.environment_on.then_some(self.environment),
        }
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
    /// What a new user sees of `list`: its first entry in directional light.
    pub fn new(list: &[Shown], camera: Orbit) -> Settings {
        Settings {
            shown: 0,
            against: Against::Nothing,
            layout: Layout::Split(0.5),
            reference: false,
            materials: list.iter().map(|shown| shown.material).collect(),
            lights: LightSettings::default(),
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
    pub fn view(&self, list: &[Shown], size: [u32; 2]) -> View {
        let side = |index: usize, reference| Side {
            shown: Shown { material: self.materials[index], ..list[index].clone() },
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
