// The error function at run time. Twin of erf.rs.

// erf(x) by Abramowitz and Stegun 7.1.26: absolute error 1.5e-7 before rounding, one exponential.
fn glint_erf(x: f32) -> f32 {
    let t = 1.0 / (1.0 + 0.3275911 * abs(x));
    let poly = t * (0.2548296 + t * (-0.28449674 + t * (1.4214137 + t * (-1.4531521 + t * 1.0614054))));
    return select(-1.0, 1.0, x >= 0.0) * (1.0 - poly * exp(-x * x));
}
