// A glittering plane, whose tangent frame is the environment's.

#import bind_environment
#import include_environment
#import example_pixels

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&example_pixels) {
        return;
    }
    let asked = example_pixels[id.x];
    let pixel = example_pixel(asked);
    var answer = ExampleAnswer();
    let material = glint_environment_defaults();
    let normal = vec3f(0.0, 0.0, 1.0);
    answer.radiance = glint_environment_eval(pixel, normal, asked.view, material);
    answer.brdf = glint_environment_mean(normal, asked.view, material);
    example_answers[id.x] = answer;
}
