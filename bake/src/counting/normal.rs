//! Uniform and normal numbers from random words, f32, as in WGSL.
//!
//! The paper (algorithm 1, line 18) asks for the inverse of the normal distribution function and leaves its
//! computation open. The form x · P(w), w = −log(4u(1 − u)), is that of Giles 2010, "Approximating the erfinv
//! function"; the polynomials here were fitted anew, because his end at the tail of 24-bit uniforms.

/// Uniform number in (0, 1) of 32 random bits; small ones keep a resolution of 2⁻³².
pub fn unit_from_bits(bits: u32) -> f32 {
    // Words near the top round to 1, whose logarithm below would be infinite.
    ((bits as f32 + 0.5) * (1.0 / 4_294_967_296.0)).min(1.0 - f32::EPSILON / 2.0)
}

/// z with P(Z > z) = u for a standard normal Z; off by at most 3e-5 for u from 2⁻³³ to ½, antisymmetric around ½.
pub fn normal_upper_quantile(u: f32) -> f32 {
    let x = 1.0 - 2.0 * u;
    let w = -(4.0 * u * (1.0 - u)).ln();
    if w < 5.0 {
        // Terms by pairs, which is a shorter chain of operations.
        let d = w - 2.5;
        let d2 = d * d;
        let high = (3.071_955e-4 - d * 6.411_285e-6) + d2 * (-4.487_788e-6 + d * 5.037_158e-7);
        return x * ((2.123_313 + d * 0.348_802_18) + d2 * ((-5.905_745_4e-3 - d * 1.772_403e-3) + d2 * high));
    }
    // 3.463… is the middle of √w over the tail.
    let d = w.sqrt() - 3.463_241_9;
    let d2 = d * d;
    let high = (1.652_151_9e-3 - d * 1.921_085_4e-3) + d2 * 8.503_982e-4;
    x * ((4.664_728_6 + d * 1.424_175) + d2 * ((4.982_674_7e-3 - d * 2.578_961_6e-3) + d2 * high))
}
