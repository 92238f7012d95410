// A normal-mapped surface under a window, eight texels of its map on a unit.

#import bind_area_light_sampler
#import include_area_light
#import example_pixels

// A window of 1 by 2 at a distance of 3, seen from the surface.
fn example_window() -> GlintRectLight {
    return GlintRectLight(
        vec3f(-0.5, -1.0, 3.0), vec3f(-0.5, 1.0, 3.0), vec3f(0.5, 1.0, 3.0), vec3f(0.5, -1.0, 3.0), vec3f(5.0), 1u,
    );
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let asked = example_pixels[id.x];
    let pixel = example_pixel(asked);
    var answer = ExampleAnswer();
    var material = glint_area_light_defaults();
    material.texels_per_unit = 8.0;
    answer.brdf = glint_area_light_eval(pixel, asked.view, asked.light, material);
    answer.radiance = glint_area_light_rect(pixel, asked.view, example_window(), material);
    example_answers[id.x] = answer;
}
