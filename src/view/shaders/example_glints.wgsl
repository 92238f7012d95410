// A surface of counted facets with the pack's own material, under a window.

#import bind_glints
#import include_glints
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
    let material = glint_glints_material();
    answer.brdf = glint_glints_eval(pixel, asked.view, asked.light, material);
    answer.pdf = glint_glints_pdf(asked.view, asked.light, material);
    answer.sampled = glint_glints_sample(asked.view, asked.random, material);
    answer.radiance = glint_glints_rect(pixel, asked.view, example_window(), material);
    example_answers[id.x] = answer;
}
