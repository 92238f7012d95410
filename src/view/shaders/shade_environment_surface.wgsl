// The viewer's point as image-based lighting sees it.

#import view_scene
#import bind_environment

// Surface in the environment's frame. Roughness that differs between the axes is taken as the round one of the same peak.
fn shade_environment_point(point: ViewPoint, facets: f32) -> GlintSurface {
    let normal = scene.environment_from_world * point.normal;
    let view = scene.environment_from_world * view_to_world(point, point.view);
    return GlintSurface(normal, view, sqrt(material.alpha.x * material.alpha.y), material.f0, facets);
}
