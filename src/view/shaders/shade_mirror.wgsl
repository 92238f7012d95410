// Surfaces whose reflectance is material.f0 alone: they mirror the room and emit nothing.

#import view_scene
#import view_sky
#import brdf

fn shade_room(point: ViewPoint) -> vec3f {
    let mirrored = view_to_world(point, vec3f(-point.view.xy, point.view.z));
    return glint_fresnel(material.f0, point.view.z) * view_sky(mirrored);
}

fn shade_emitted(point: ViewPoint) -> vec3f {
    return vec3f(0.0);
}
