// Lights one after the other, by the hooks of view_scene.wgsl.

#import view_scene

fn view_reflect(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f {
    if light.z <= 0.0 {
        return vec3f(0.0);
    }
    if REFERENCE {
        return shade_reference(point, light, random);
    }
    return shade_reflect(point, light);
}

fn shade_lights(point: ViewPoint, random: vec2f) -> vec3f {
    var radiance = vec3f(0.0);
    if (LIGHTS & VIEW_LIGHT_SUN) != 0u {
        radiance += view_reflect(point, view_to_tangent(point, scene.sun), random) * scene.sun_irradiance;
    }
    if (LIGHTS & VIEW_LIGHT_POINTS) != 0u {
        for (var i = 0u; i < scene.point_count; i++) {
            let to_light = scene.points[i].position - point.position;
            let distance2 = max(dot(to_light, to_light), 1.0e-8);
            let light = view_to_tangent(point, to_light * inverseSqrt(distance2));
            radiance += view_reflect(point, light, random) * scene.points[i].intensity / distance2;
        }
    }
    if (LIGHTS & VIEW_LIGHT_RECT) != 0u {
        radiance += shade_rect(point);
    }
    if (LIGHTS & VIEW_LIGHT_ENVIRONMENT) != 0u {
        radiance += shade_environment(point);
    }
    return radiance;
}
