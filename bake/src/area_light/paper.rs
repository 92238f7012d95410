//! The paper's own fits, for comparison in reports and tests; nothing that ships uses them.
//!
//! Tao et al. 2021, Eq. 5 (roughness from the length of the mean normal) and Eq. 7 (convolution).

/// Meso roughness from the length of the mean normal (Eq. 5), as printed: negative above 0.9997, above 1 below 0.667.
pub fn paper_meso_alpha(length: f64) -> f64 {
    let r = length;
    ((((1.629 * r + 17.05) * r - 18.96) * r - 23.37) * r + 23.65) / (((r - 28.07) * r + 31.1) * r - 3.545)
}

/// Roughness of the convolution (Eq. 7), as printed: above 1 on a fifth of the square.
pub fn paper_convolution(micro: f64, meso: f64) -> f64 {
    0.07 * micro * micro + 0.94 * micro + meso - 0.83 * micro * meso
}

/// Overall roughness by both, each cut to 0…1.
pub fn paper_alpha(base_alpha: f64, length: f64) -> f64 {
    paper_convolution(base_alpha, paper_meso_alpha(length).clamp(0.0, 1.0)).clamp(0.0, 1.0)
}
