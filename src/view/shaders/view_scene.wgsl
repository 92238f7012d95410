// What every program of the viewer binds in group 0, and the point that is shaded.
//
// A method gives, in its shade_<method>.wgsl:
//   fn shade_lights(point: ViewPoint, random: vec2f) -> vec3f
//       radiance towards the viewer from the directional light, the points, the rectangle and the environment, those that LIGHTS says
//   fn shade_room(point: ViewPoint) -> vec3f
//       radiance towards the viewer from the room of view_sky.wgsl; shade_mirror.wgsl has it for surfaces without materials of their own
//   fn shade_emitted(point: ViewPoint) -> vec3f
//       radiance that the surface emits; asked for where EMITS says so
//   fn shade_lod(point: ViewPoint) -> f32
//       level of detail that is read, 0 the finest
// shade_each_light.wgsl gives shade_lights to a method that has, in its place:
//   fn shade_reflect(point: ViewPoint, light: vec3f) -> vec3f
//       BRDF times n.l for light from the unit direction `light` (tangent frame), linear RGB
//   fn shade_reference(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f
//       the same, as one sample whose mean over `random` in [0, 1)^2 is what the method approximates
//   fn shade_rect(point: ViewPoint) -> vec3f
//       radiance towards the viewer from the scene's rectangle; shade_rect_points.wgsl does it by samples of shade_reflect
//   fn shade_environment(point: ViewPoint) -> vec3f
//       radiance towards the viewer from the environment; shade_environment_smooth.wgsl does it without glints

const VIEW_LIGHT_SUN: u32 = 1u;
const VIEW_LIGHT_POINTS: u32 = 2u;
const VIEW_LIGHT_RECT: u32 = 4u;
const VIEW_LIGHT_ENVIRONMENT: u32 = 8u;
// The room of view_sky.wgsl.
const VIEW_LIGHT_ROOM: u32 = 16u;

// Distribution of slopes of methods that have one, 0 Beckmann, 1 GGX: known when a pipeline is made, since some devices take both ways of a
// branch.
override NORMAL_TARGET: u32 = 0u;

struct ViewPointLight {
    position: vec3f,
    // Radius of the sphere that it is as counted facets see it.
    radius: f32,
    // Radiant intensity, linear RGB.
    intensity: vec3f,
}

struct ViewScene {
    clip_from_world: mat4x4f,
    camera: vec3f,
    // Running number of the frame, which random numbers depend on.
    frame: u32,
    // Unit direction towards the directional light.
    sun: vec3f,
    point_count: u32,
    // Irradiance of a surface that faces the directional light.
    sun_irradiance: vec3f,
    // Surface units on one unit of uv.
    uv_scale: f32,
    points: array<ViewPointLight, 4>,
    // Corners of the rectangle light in order, counter-clockwise on the side that radiates.
    rect: array<vec4f, 4>,
    rect_radiance: vec3f,
    rect_two_sided: u32,
    // Columns: world directions to those of the environment.
    environment_from_world: mat3x3f,
    // Factor on the environment's radiance.
    environment_gain: f32,
    // Solid angle of the directional light as counted facets see it, in steradians.
    sun_solid_angle: f32,
    // Half the picture's width and height at distance 1.
    half_size: vec2f,
    // Columns: camera's right, up and back in the world.
    world_from_camera: mat3x3f,
}

// One for all methods; each reads what it has.
struct ViewMaterial {
    // Reflectance at normal incidence, linear RGB.
    f0: vec3f,
    // Intrinsic roughness of NDF maps and lobes, as a standard deviation of projected normals.
    intrinsic_roughness: f32,
    // Roughness along the tangent axes: of the smooth BRDF, the dictionary, environments and the base of area lights.
    alpha: vec2f,
    // 0 Beckmann, 1 GGX; programs have it as NORMAL_TARGET.
    normal_target: u32,
    // Facets on one surface unit squared.
    density: f32,
    mean_colour: vec3f,
    // Share of the surface that glints, 0 to 1.
    relative_area: f32,
    density_randomisation: f32,
    max_anisotropy: f32,
    seed: u32,
    // Number of glint colours.
    colours: u32,
    // Texels of the map on one surface unit; 1 for methods without a map.
    texels_per_unit: f32,
    // Lobes of directional roughness of area lights, 0 to 9.
    lobes: u32,
    // Standard deviation of the Gaussian that a pixel sees, in pixels.
    pixel_sigma: f32,
    // Switches of a method, see its shade file.
    switches: u32,
    // Whole facet area over surface area of counted facets; follows from the roughness.
    facet_area: f32,
    // Half angle of the cone that a counted facet reflects a point into, in radians.
    facet_spread: f32,
    // By how much the eye turns, in radians, until facets under an environment are others; 0 for never.
    sky_spread: f32,
}

// The pixel's place on the surface and its frame.
struct ViewPoint {
    // Place and its derivatives along the screen's axes, a pixel, in surface units.
    uv: vec2f,
    d_dx: vec2f,
    d_dy: vec2f,
    // Unit direction to the camera in the tangent frame.
    view: vec3f,
    // World position and its derivatives along the screen's axes, a pixel.
    position: vec3f,
    position_dx: vec3f,
    position_dy: vec3f,
    // Unit tangent (along +u), bitangent (against +v) and normal.
    tangent: vec3f,
    bitangent: vec3f,
    normal: vec3f,
}

@group(0) @binding(0) var<uniform> scene: ViewScene;
@group(0) @binding(1) var<uniform> material: ViewMaterial;

fn view_to_tangent(point: ViewPoint, world: vec3f) -> vec3f {
    return vec3f(dot(world, point.tangent), dot(world, point.bitangent), dot(world, point.normal));
}

fn view_to_world(point: ViewPoint, tangent: vec3f) -> vec3f {
    return point.tangent * tangent.x + point.bitangent * tangent.y + point.normal * tangent.z;
}
