// The scene's rectangle for area_light/rect.wgsl.

#import view_scene
#import area_light::rect

// Relative to the point, in its tangent frame.
fn shade_rect_light(point: ViewPoint) -> GlintRectLight {
    return GlintRectLight(
        view_to_tangent(point, scene.rect[0].xyz - point.position),
        view_to_tangent(point, scene.rect[1].xyz - point.position),
        view_to_tangent(point, scene.rect[2].xyz - point.position),
        view_to_tangent(point, scene.rect[3].xyz - point.position),
        scene.rect_radiance,
        scene.rect_two_sided,
    );
}
