// A surface of a slope dictionary with its default material, of gold.

#import bind_dictionary
#import include_dictionary
#import example_pixels

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let asked = example_pixels[id.x];
    let pixel = example_pixel(asked);
    var answer = ExampleAnswer();
    let material = glint_dictionary_defaults();
    answer.brdf = glint_dictionary_eval(pixel, asked.view, asked.light, material, vec3f(1.0, 0.78, 0.34));
    answer.pdf = glint_dictionary_pdf(asked.view, asked.light, material);
    answer.sampled = glint_dictionary_sample(asked.view, asked.random.xy, material);
    example_answers[id.x] = answer;
}
