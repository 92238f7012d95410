// A rectangle light as four by four points, each with its share of the area.

#import view_scene

fn shade_rect(point: ViewPoint) -> vec3f {
    let a = scene.rect[0].xyz;
    let u = scene.rect[1].xyz - a;
    let v = scene.rect[3].xyz - a;
    let front = cross(u, v);
    var sum = vec3f(0.0);
    for (var k = 0u; k < 16u; k++) {
        let share = (vec2f(f32(k % 4u), f32(k / 4u)) + 0.5) * 0.25;
        let to_light = a + u * share.x + v * share.y - point.position;
        let distance2 = max(dot(to_light, to_light), 1.0e-8);
        let direction = to_light * inverseSqrt(distance2);
        var area = -dot(front, direction);
        if scene.rect_two_sided != 0u {
            area = abs(area);
        }
        let light = view_to_tangent(point, direction);
        if light.z > 0.0 && area > 0.0 {
            sum += shade_reflect(point, light) * (area / distance2);
        }
    }
    return sum * scene.rect_radiance / 16.0;
}
