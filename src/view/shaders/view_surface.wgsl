// Draws a mesh: the pixel's point, the lights, and the method between them.

#import view_scene
#import hash
#import bind_loads

const VIEW_OVERLAY_FOOTPRINT: u32 = 1u;
const VIEW_OVERLAY_LOD: u32 = 2u;
const VIEW_OVERLAY_LOADS: u32 = 3u;
const VIEW_OVERLAY_OPERATIONS: u32 = 4u;

// Lights that are on, as a sum of the above.
override LIGHTS: u32 = 1u;
// One sample of the reference instead of the method.
override REFERENCE: bool = false;
// Whether the surface emits light.
override EMITS: bool = false;
// What goes into alpha: 0 nothing, else one of the above.
override OVERLAY: u32 = 0u;

struct ViewVertex {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    // Direction of +u; w is -1 where the bitangent is mirrored.
    @location(2) tangent: vec4f,
    @location(3) uv: vec2f,
}

struct ViewFragment {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv: vec2f,
}

@vertex
fn vertex(v: ViewVertex) -> ViewFragment {
    return ViewFragment(scene.clip_from_world * vec4f(v.position, 1.0), v.position, v.normal, v.tangent, v.uv);
}

fn view_point(f: ViewFragment, front: bool) -> ViewPoint {
    let side = select(-1.0, 1.0, front);
    let normal = normalize(f.normal) * side;
    let tangent = normalize(f.tangent.xyz - normal * dot(f.tangent.xyz, normal));
    let bitangent = cross(normal, tangent) * (f.tangent.w * side);
    var point: ViewPoint;
    point.uv = f.uv * scene.uv_scale;
    point.d_dx = dpdx(point.uv);
    point.d_dy = dpdy(point.uv);
    point.position = f.position;
    point.position_dx = dpdx(f.position);
    point.position_dy = dpdy(f.position);
    point.normal = normal;
    point.tangent = tangent;
    point.bitangent = bitangent;
    let to_camera = normalize(scene.camera - f.position);
    point.view = view_to_tangent(point, to_camera);
    // Interpolated normals may turn away from a camera that sees the triangle.
    point.view = normalize(vec3f(point.view.xy, max(point.view.z, 1.0e-3)));
    return point;
}

@fragment
fn fragment(f: ViewFragment, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let point = view_point(f, front);
    let pixel = glint_cell_state(u32(f.clip.x), u32(f.clip.y), scene.frame);
    let random = vec2f(glint_draw_uniform(pixel, 0u), glint_draw_uniform(pixel, 1u));
    var radiance = shade_lights(point, random);
    if (LIGHTS & VIEW_LIGHT_ROOM) != 0u {
        radiance += shade_room(point);
    }
    if EMITS {
        radiance += shade_emitted(point);
    }
    var overlay = 0.0;
    if OVERLAY == VIEW_OVERLAY_FOOTPRINT {
        let area = abs(point.d_dx.x * point.d_dy.y - point.d_dx.y * point.d_dy.x);
        overlay = 0.5 * log2(max(area, 1.0e-20)) + log2(material.texels_per_unit * material.pixel_sigma);
    }
    if OVERLAY == VIEW_OVERLAY_LOD {
        overlay = shade_lod(point);
    }
    if OVERLAY == VIEW_OVERLAY_LOADS {
        overlay = log2(1.0 + f32(bound_loads));
    }
    if OVERLAY == VIEW_OVERLAY_OPERATIONS {
        overlay = log2(1.0 + f32(bound_operations));
    }
    return vec4f(radiance, overlay);
}
