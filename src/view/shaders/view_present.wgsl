// From radiance to the display: comparison, overlays, exposure, tone mapping, sRGB.

const VIEW_SHOW_LEFT: u32 = 0u;
const VIEW_SHOW_SPLIT: u32 = 1u;
const VIEW_SHOW_ERROR: u32 = 2u;

const VIEW_TONE_FILMIC: u32 = 0u;
const VIEW_TONE_LINEAR: u32 = 1u;

struct Present {
    // Factor on radiance.
    exposure: f32,
    tone: u32,
    show: u32,
    // Column from which the right side is shown.
    split: f32,
    // Whether alpha is shown in false colours, and its range.
    overlay: u32,
    overlay_low: f32,
    overlay_high: f32,
}

@group(0) @binding(0) var<uniform> present: Present;
@group(0) @binding(1) var left: texture_2d<f32>;
@group(0) @binding(2) var right: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

// Dark blue, blue, green, yellow, red for 0 to 1.
fn view_false_colour(value: f32) -> vec3f {
    let t = clamp(value, 0.0, 1.0) * 4.0;
    var colour = vec3f(0.05, 0.03, 0.30);
    colour = mix(colour, vec3f(0.05, 0.35, 0.80), clamp(t, 0.0, 1.0));
    colour = mix(colour, vec3f(0.10, 0.70, 0.40), clamp(t - 1.0, 0.0, 1.0));
    colour = mix(colour, vec3f(0.95, 0.85, 0.20), clamp(t - 2.0, 0.0, 1.0));
    return mix(colour, vec3f(0.85, 0.10, 0.10), clamp(t - 3.0, 0.0, 1.0));
}

// A filmic curve: Narkowicz's fit of ACES, channel by channel.
fn view_film(radiance: vec3f) -> vec3f {
    let v = clamp(radiance, vec3f(0.0), vec3f(1.0e4)) * 0.8;
    return clamp(v * (v * 2.51 + 0.03) / (v * (v * 2.43 + 0.59) + 0.14), vec3f(0.0), vec3f(1.0));
}

fn view_encode_srgb(linear: vec3f) -> vec3f {
    let low = linear * 12.92;
    let high = 1.055 * pow(max(linear, vec3f(1.0e-6)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}

fn view_luminance(colour: vec3f) -> f32 {
    return dot(colour, vec3f(0.2126, 0.7152, 0.0722));
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2i(position.xy);
    let a = textureLoad(left, at, 0);
    let b = textureLoad(right, at, 0);
    if present.show == VIEW_SHOW_ERROR {
        // Difference of luminance over the reference's, with a floor where both are dark.
        let reference = view_luminance(b.rgb);
        let error = abs(view_luminance(a.rgb) - reference) / (reference + 0.02 / present.exposure);
        return vec4f(view_false_colour(error), 1.0);
    }
    var value = a;
    if present.show == VIEW_SHOW_SPLIT {
        if abs(position.x - present.split) < 1.0 {
            return vec4f(1.0, 0.8, 0.2, 1.0);
        }
        value = select(a, b, position.x > present.split);
    }
    if present.overlay != 0u {
        let range = max(present.overlay_high - present.overlay_low, 1.0e-6);
        return vec4f(view_false_colour((value.a - present.overlay_low) / range), 1.0);
    }
    let exposed = value.rgb * present.exposure;
    if present.tone == VIEW_TONE_LINEAR {
        return vec4f(view_encode_srgb(clamp(exposed, vec3f(0.0), vec3f(1.0))), 1.0);
    }
    return vec4f(view_encode_srgb(view_film(exposed)), 1.0);
}
