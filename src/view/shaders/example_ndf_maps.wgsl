// A surface with NDF maps, eight texels of them on a unit.

#import bind_ndf_maps
#import bind_ndf_maps_layered
#import include_ndf_maps
#import example_pixels

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let asked = example_pixels[id.x];
    let pixel = example_pixel(asked);
    var answer = ExampleAnswer();
    var material = glint_map_defaults();
    material.texels_per_unit = 8.0;
    let settings = glint_ndf_maps_settings();
    answer.brdf = glint_ndf_maps_eval(pixel, asked.view, asked.light, material, settings);
    let moments = glint_ndf_maps_moments(pixel, material, settings);
    answer.pdf = glint_ndf_maps_pdf(asked.view, asked.light, moments);
    answer.sampled = glint_ndf_maps_sample(asked.view, asked.random, moments);
    example_answers[id.x] = answer;
}
