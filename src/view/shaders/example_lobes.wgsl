// A surface with the lobes of a map, eight texels of them on a unit.

#import bind_lobes
#import include_lobes
#import example_pixels

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let asked = example_pixels[id.x];
    let pixel = example_pixel(asked);
    var answer = ExampleAnswer();
    var material = glint_map_defaults();
    material.texels_per_unit = 8.0;
    answer.brdf = glint_lobes_eval(pixel, asked.view, asked.light, material, glint_lobes_realtime());
    example_answers[id.x] = answer;
}
