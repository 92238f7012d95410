// The pixel's footprint as a 2D Gaussian over a surface, in texels. Twin of footprint.rs. Texel centres lie at i + 1/2.

// Where a pixel lies on a surface: uv, or whatever units the host measures a material's surface in.
struct GlintPixelOnSurface {
    position: vec2f,
    // Derivatives along the screen's axes, a pixel.
    d_dx: vec2f,
    d_dy: vec2f,
}

// What a pixel sees of a surface.
struct GlintFootprint {
    // Centre, texels.
    mean: vec2f,
    // Covariance, texels^2.
    xx: f32,
    xy: f32,
    yy: f32,
}

// Principal axes of a footprint.
struct GlintPrincipal {
    // Unit vector along the major axis; (1, 0) for a circle.
    axis: vec2f,
    // Standard deviations, texels.
    major: f32,
    minor: f32,
}

// Ellipse of a pixel's second moments, in squares of the units of its derivatives.
struct GlintPixelAxes {
    // Squares of the longer and the shorter axis.
    major2: f32,
    minor2: f32,
    // Vector at twice the longer axis's angle, `gap` long.
    difference: vec2f,
    // Half the difference of the squares.
    gap: f32,
}

// Footprint of a pixel at `mean` whose place moves by `d_dx` and `d_dy` (texels) a pixel along the screen's axes:
// pixel_sigma^2 (d_dx d_dx^T + d_dy d_dy^T). `pixel_sigma` is the standard deviation of the pixel's filter, in pixels.
fn glint_footprint_of_pixel(mean: vec2f, d_dx: vec2f, d_dy: vec2f, pixel_sigma: f32) -> GlintFootprint {
    let limit = vec2f(1.0e8);
    let dx = clamp(d_dx * pixel_sigma, -limit, limit);
    let dy = clamp(d_dy * pixel_sigma, -limit, limit);
    return GlintFootprint(
        mean,
        dx.x * dx.x + dy.x * dy.x,
        dx.x * dx.y + dy.x * dy.y,
        dx.y * dx.y + dy.y * dy.y,
    );
}

// Parallelogram of a pixel whose place moves by `d_dx` and `d_dy` a pixel along the screen's axes, as the ellipse of its second moments.
fn glint_pixel_axes(d_dx: vec2f, d_dy: vec2f) -> GlintPixelAxes {
    let limit = vec2f(1.0e8);
    let dx = clamp(d_dx, -limit, limit);
    let dy = clamp(d_dy, -limit, limit);
    let a = dx.x * dx.x + dy.x * dy.x;
    let b = dx.x * dx.y + dy.x * dy.y;
    let c = dx.y * dx.y + dy.y * dy.y;
    let half_difference = 0.5 * (a - c);
    let gap = sqrt(half_difference * half_difference + b * b);
    let major2 = 0.5 * (a + c) + gap;
    // By the area, which keeps the digits of long pixels.
    let cross = dx.x * dy.y - dx.y * dy.x;
    return GlintPixelAxes(major2, cross * cross / max(major2, 1.0e-30), vec2f(half_difference, b), gap);
}

// The leading 11 bits of a number. A product of two such parts is exact; what is left has 13.
fn glint_upper_half(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0xffffe000u);
}

// A number but for its last bit. Compilers take sums and products apart for speed, which costs the digits that are kept by
// halves; they cannot look through integers.
fn glint_keep(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0xfffffffeu);
}

// a c - b^2 with the digits that cancel, by exact products of halves.
fn glint_determinant(a: f32, b: f32, c: f32) -> f32 {
    let ah = glint_upper_half(a);
    let bh = glint_upper_half(b);
    let ch = glint_upper_half(c);
    let al = a - ah;
    let bl = b - bh;
    let cl = c - ch;
    let halves = glint_keep(glint_keep(ah * ch) - glint_keep(bh * bh));
    let cross = glint_keep(glint_keep(ah * cl) - glint_keep(bh * bl)) + glint_keep(glint_keep(al * ch) - glint_keep(bh * bl));
    return glint_keep(halves + glint_keep(cross)) + glint_keep(al * cl - bl * bl);
}

// Unit vector at half the angle of `v`, with x >= 0; (1, 0) for a zero vector.
fn glint_half_angle(v: vec2f) -> vec2f {
    let h = sqrt(v.x * v.x + v.y * v.y);
    let up = select(-1.0, 1.0, v.y >= 0.0);
    let twice = select(vec2f(abs(v.y), (h - v.x) * up), vec2f(h + v.x, v.y), v.x >= 0.0);
    let long = sqrt(twice.x * twice.x + twice.y * twice.y);
    if long > 0.0 {
        return twice / long;
    }
    return vec2f(1.0, 0.0);
}

// Principal axes. The minor one follows from the determinant: four digits at an anisotropy of 1000, where the difference of
// eigenvalues would have one.
fn glint_principal(footprint: GlintFootprint) -> GlintPrincipal {
    // A power of two brings the numbers to order 1 without rounding.
    let exponent = bitcast<u32>(clamp(footprint.xx + footprint.yy, 1.0e-30, 1.0e30)) & 0x7f800000u;
    let down = bitcast<f32>(0x7f000000u - exponent);
    let up = bitcast<f32>(exponent);
    let a = footprint.xx * down;
    let b = footprint.xy * down;
    let c = footprint.yy * down;
    let half_gap = vec2f(0.5 * (a - c), b);
    let major2 = 0.5 * (a + c) + sqrt(half_gap.x * half_gap.x + half_gap.y * half_gap.y);
    let minor2 = max(glint_determinant(a, b, c), 0.0) / max(major2, 1.0e-30);
    return GlintPrincipal(glint_half_angle(half_gap), sqrt(major2 * up), sqrt(min(minor2, major2) * up));
}
