//! The scene and the material as a user sets them, and as `view_scene.wgsl` reads them.

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Mat4, Vec2, Vec3};
use glint_bake_core::microfacet::{SmoothSurface, microfacet_area};

/// Lights of a scene, most of them at once.
pub const MAX_POINT_LIGHTS: usize = 4;

/// Bit of [`Material::switches`]: layers of two-layer materials are exchanged.
pub const SWAP_LAYERS: u32 = 1;
/// Bit of [`Material::switches`]: NDF maps are read with the settings that their accuracy is measured with.
pub const ACCURATE: u32 = 2;

/// Bit of [`Material::switches`]: counted facets lie in space and not in uv.
pub const IN_SPACE: u32 = 4;

/// Where the camera is. +Y of the world is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position.
    pub position: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// Vertical field of view in radians.
    pub field_of_view: f32,
    /// Distance of the near plane; there is no far one.
    pub near: f32,
}

impl Camera {
    /// Columns: right, up and back.
    pub fn axes(&self) -> Mat3 {
        let back = (self.position - self.target).try_normalize().unwrap_or(Vec3::Z);
        // Looking straight up or down leaves "right" open.
        let right = Vec3::Y.cross(back).try_normalize().unwrap_or(Vec3::X);
        Mat3::from_cols(right, back.cross(right), back)
    }

    /// World to clip space, depth 1 at the near plane and 0 at infinity; the picture is moved by `jitter` pixels.
    fn clip_from_world(&self, size: [u32; 2], jitter: Vec2) -> Mat4 {
        let aspect = size[0] as f32 / size[1] as f32;
        let projection =
            glam::camera::rh::proj::directx::perspective_infinite_reverse(self.field_of_view, aspect, self.near);
        let moved = 2.0 * jitter / Vec2::new(size[0] as f32, size[1] as f32);
        let shift = Mat4::from_translation(Vec3::new(moved.x, -moved.y, 0.0));
        let axes = self.axes();
        let view = Mat4::from_mat3(axes.transpose()) * Mat4::from_translation(-self.position);
        shift * projection * view
    }
}

/// Light from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Direction towards it; need not be a unit vector.
    pub direction: Vec3,
    /// Irradiance of a surface that faces it, linear RGB.
    pub irradiance: Vec3,
    /// Solid angle as counted facets see it, in steradians.
    pub solid_angle_sr: f32,
}

/// Light from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// World position.
    pub position: Vec3,
    /// Radiant intensity, linear RGB.
    pub intensity: Vec3,
    /// Radius of the sphere that it is as counted facets see it.
    pub radius: f32,
}

/// A rectangle that radiates evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectLight {
    /// Corners in order, counter-clockwise on the side that radiates.
    pub corners: [Vec3; 4],
    /// Radiance, linear RGB.
    pub radiance: Vec3,
    /// Whether both sides radiate.
    pub two_sided: bool,
}

/// How the environment of a pack lights the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// Turn around the vertical axis in radians.
    pub turn: f32,
    /// Factor on its radiance.
    pub gain: f32,
}

/// The lights that are on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lights {
    /// Directional light.
    pub sun: Option<Sun>,
    /// Up to [`MAX_POINT_LIGHTS`] points; more are not drawn.
    pub points: Vec<PointLight>,
    /// Rectangle.
    pub rect: Option<RectLight>,
    /// Environment.
    pub environment: Option<Environment>,
    /// A dim room around the scene, so that shapes show where no light reaches.
    pub room: bool,
}

impl Lights {
    /// The switches of `LIGHTS` in view_surface.wgsl.
    pub(super) fn bits(&self) -> u32 {
        u32::from(self.sun.is_some())
            | u32::from(!self.points.is_empty()) << 1
            | u32::from(self.rect.is_some()) << 2
            | u32::from(self.environment.is_some()) << 3
            | u32::from(self.room) << 4
    }
}

/// What is looked at, from where, in which light.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Camera.
    pub camera: Camera,
    /// Lights.
    pub lights: Lights,
    /// Surface units on one unit of the mesh's uv.
    pub uv_scale: f32,
}

/// Parameters of all methods; each reads what it has. Meaning and ranges: `ViewMaterial` in view_scene.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Material {
    /// Reflectance at normal incidence, linear RGB.
    pub f0: [f32; 3],
    /// Intrinsic roughness of NDF maps and lobes: standard deviation of projected normals.
    pub intrinsic_roughness: f32,
    /// Roughness α along the tangent axes.
    pub alpha: [f32; 2],
    /// 0 Beckmann, 1 GGX.
    pub normal_target: u32,
    /// Facets on one surface unit squared.
    pub density: f32,
    /// Mean of the glint colours, linear RGB; white if there are none.
    pub mean_colour: [f32; 3],
    /// Share of the surface that glints, 0 to 1.
    pub relative_area: f32,
    /// Standard deviation of a cell's level.
    pub density_randomisation: f32,
    /// Largest ratio of the footprint's axes.
    pub max_anisotropy: f32,
    /// Surfaces with different seeds have different glints.
    pub seed: u32,
    /// Number of glint colours.
    pub colours: u32,
    /// Texels of the map on one surface unit.
    pub texels_per_unit: f32,
    /// Lobes of directional roughness of area lights, 0 to 9.
    pub lobes: u32,
    /// Standard deviation of the Gaussian that a pixel sees, in pixels.
    pub pixel_sigma: f32,
    /// Switches of a method, see its shade file.
    pub switches: u32,
    /// Whole facet area over surface area of counted facets; [`Material::complete`] has it from the roughness.
    pub facet_area: f32,
    /// Half angle of the cone that a counted facet reflects a point into, in radians.
    pub facet_spread: f32,
    /// By how much the eye turns, in radians, until counted facets under an environment are others; 0 for never.
    pub sky_spread: f32,
    /// 0.
    pub unused: f32,
}

impl Material {
    /// The material with what follows from the rest of it.
    pub(super) fn complete(&self) -> Material {
        let alpha = Vec2::from_array(self.alpha);
        let smooth = SmoothSurface { alpha2: alpha * alpha, normal_target: self.normal_target };
        Material { facet_area: microfacet_area(smooth), ..*self }
    }
}

impl Default for Material {
    fn default() -> Material {
        Material {
            f0: [0.95, 0.93, 0.88],
            intrinsic_roughness: 0.01,
            alpha: [0.3, 0.3],
            normal_target: 0,
            density: 1.0e6,
            mean_colour: [1.0; 3],
            relative_area: 1.0,
            density_randomisation: 0.0,
            max_anisotropy: 8.0,
            seed: 1,
            colours: 0,
            texels_per_unit: 1.0,
            lobes: 3,
            pixel_sigma: 0.5,
            switches: 0,
            facet_area: 1.0,
            facet_spread: 0.004_65,
            sky_spread: 0.0,
            unused: 0.0,
        }
    }
}

/// `ViewScene`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct SceneUniform {
    clip_from_world: [f32; 16],
    camera: [f32; 3],
    frame: u32,
    sun: [f32; 3],
    point_count: u32,
    sun_irradiance: [f32; 3],
    uv_scale: f32,
    points: [[f32; 8]; MAX_POINT_LIGHTS],
    rect: [[f32; 4]; 4],
    rect_radiance: [f32; 3],
    rect_two_sided: u32,
    environment_from_world: [[f32; 4]; 3],
    environment_gain: f32,
    sun_solid_angle: f32,
    half_size: [f32; 2],
    world_from_camera: [[f32; 4]; 3],
}

/// Columns of a matrix as WGSL lays them out in a uniform.
fn columns(matrix: Mat3) -> [[f32; 4]; 3] {
    [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.extend(0.0).to_array())
}

impl SceneUniform {
    /// The scene in frame `frame` of a picture of `size` pixels.
    pub fn new(scene: &Scene, size: [u32; 2], frame: u32, jitter: Vec2) -> SceneUniform {
        let lights = &scene.lights;
        let mut points = [[0.0; 8]; MAX_POINT_LIGHTS];
        for (slot, light) in points.iter_mut().zip(&lights.points) {
            slot[..3].copy_from_slice(&light.position.to_array());
            slot[3] = light.radius;
            slot[4..7].copy_from_slice(&light.intensity.to_array());
        }
        let environment = lights.environment.unwrap_or(Environment { turn: 0.0, gain: 0.0 });
        let half_height = (0.5 * scene.camera.field_of_view).tan();
        let rect = lights.rect.map_or([[0.0; 4]; 4], |rect| rect.corners.map(|corner| corner.extend(0.0).to_array()));
        SceneUniform {
            clip_from_world: scene.camera.clip_from_world(size, jitter).to_cols_array(),
            camera: scene.camera.position.to_array(),
            frame,
            sun: lights.sun.map_or(Vec3::Y, |sun| sun.direction.normalize_or(Vec3::Y)).to_array(),
            point_count: lights.points.len().min(MAX_POINT_LIGHTS) as u32,
            sun_irradiance: lights.sun.map_or(Vec3::ZERO, |sun| sun.irradiance).to_array(),
            uv_scale: scene.uv_scale,
            points,
            rect,
            rect_radiance: lights.rect.map_or(Vec3::ZERO, |rect| rect.radiance).to_array(),
            rect_two_sided: u32::from(lights.rect.is_some_and(|rect| rect.two_sided)),
            environment_from_world: columns(Mat3::from_rotation_y(-environment.turn)),
            environment_gain: environment.gain,
            sun_solid_angle: lights.sun.map_or(0.0, |sun| sun.solid_angle_sr),
            half_size: [half_height * size[0] as f32 / size[1] as f32, half_height],
            world_from_camera: columns(scene.camera.axes()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glint_shaders::assert_same_layout;

    #[test]
    fn uniforms_lie_as_the_shader_reads_them() {
        let source = glint_shaders::compose(&["view_scene"]);
        assert_same_layout!(
            &source,
            "ViewScene",
            SceneUniform,
            clip_from_world,
            camera,
            frame,
            sun,
            point_count,
            sun_irradiance,
            uv_scale,
            points,
            rect,
            rect_radiance,
            rect_two_sided,
            environment_from_world,
            environment_gain,
            sun_solid_angle,
            half_size,
            world_from_camera
        );
        assert_same_layout!(
            &source,
            "ViewMaterial",
            Material,
            f0,
            intrinsic_roughness,
            alpha,
            normal_target,
            density,
            mean_colour,
            relative_area,
            density_randomisation,
            max_anisotropy,
            seed,
            colours,
            texels_per_unit,
            lobes,
            pixel_sigma,
            switches,
            facet_area,
            facet_spread,
            sky_spread
        );
    }

    #[test]
    fn what_is_looked_at_is_in_the_middle_and_near_is_deep() {
        let camera = Camera {
            position: Vec3::new(1.0, 2.0, 3.0),
            target: Vec3::new(0.5, 0.0, -1.0),
            field_of_view: 0.8,
            near: 0.1,
        };
        let clip = camera.clip_from_world([640, 360], Vec2::ZERO) * camera.target.extend(1.0);
        assert!((clip.x / clip.w).abs() < 1e-5 && (clip.y / clip.w).abs() < 1e-5);
        let toward = camera.position + (camera.target - camera.position).normalize() * 0.1;
        let clip = camera.clip_from_world([640, 360], Vec2::ZERO) * toward.extend(1.0);
        assert!((clip.z / clip.w - 1.0).abs() < 1e-4);
        assert!((camera.axes().determinant() - 1.0).abs() < 1e-5);
    }
}
