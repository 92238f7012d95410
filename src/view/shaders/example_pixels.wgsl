// Pixels that an example shades, one an invocation, a multiple of 64 of them: group 0.

#import footprint

struct ExamplePixel {
    position: vec2f,
    d_dx: vec2f,
    d_dy: vec2f,
    // Unit vectors to the eye and to a light, in the tangent frame.
    view: vec3f,
    light: vec3f,
    // Numbers in [0, 1) to sample a direction by.
    random: vec3f,
}

struct ExampleAnswer {
    // BRDF for the light, and the density of sampling it.
    brdf: vec3f,
    pdf: f32,
    // The direction that is sampled.
    sampled: vec3f,
    unused: f32,
    // Radiance of the light that the example has besides: a rectangle, or an environment.
    radiance: vec3f,
}

@group(0) @binding(0) var<storage, read> example_pixels: array<ExamplePixel>;
@group(0) @binding(1) var<storage, read_write> example_answers: array<ExampleAnswer>;

fn example_pixel(asked: ExamplePixel) -> GlintPixelOnSurface {
    return GlintPixelOnSurface(asked.position, asked.d_dx, asked.d_dy);
}
