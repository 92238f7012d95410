// A glittering plane, whose tangent frame is the environment's.

#import bind_environment
#import include_environment
#import example_pixels

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let asked = example_pixels[id.x];
    let pixel = example_pixel(asked);
    var answer = ExampleAnswer();
    var material = glint_environment_defaults();
    material.f0 = vec3f(0.9);
    let normal = vec3f(0.0, 0.0, 1.0);
    answer.radiance = glint_environment_eval(pixel, normal, asked.view, material);
    answer.brdf = glint_environment_mean(normal, asked.view, material);
    example_answers[id.x] = answer;
}
