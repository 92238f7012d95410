//! The pixel footprint as a 2D Gaussian over a surface, in texels.

use glam::{DMat2, DVec2};

/// Gaussian footprint: mean and covariance in texels (texel centres at i + ½).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Centre in texels.
    pub mean: DVec2,
    /// Covariance in texels².
    pub covariance: DMat2,
}

impl Footprint {
    /// Footprint with standard deviation `sigma_texels` along its minor axis and `anisotropy` times that along its
    /// major axis, which is turned by `angle` radians from +u.
    pub fn new(mean: DVec2, sigma_texels: f64, anisotropy: f64, angle: f64) -> Footprint {
        let axis = DVec2::from_angle(angle);
        let major = (sigma_texels * anisotropy).powi(2);
        let minor = sigma_texels.powi(2);
        let outer = DMat2::from_cols(axis * axis.x, axis * axis.y);
        let covariance = outer * (major - minor) + DMat2::IDENTITY * minor;
        Footprint { mean, covariance }
    }

    /// Standard deviations along the principal axes (minor, major) and the direction of the major axis.
    pub fn principal(&self) -> (f64, f64, DVec2) {
        let (a, b, c) = (self.covariance.x_axis.x, self.covariance.x_axis.y, self.covariance.y_axis.y);
        let mid = 0.5 * (a + c);
        let half_gap = (0.5 * (a - c)).hypot(b);
        let major = (mid + half_gap).max(0.0);
        let minor = (mid - half_gap).max(0.0);
        let angle = 0.5 * libm::atan2(2.0 * b, a - c);
        (minor.sqrt(), major.sqrt(), DVec2::from_angle(angle))
    }

    /// The footprint seen in coordinates x' = m · x + offset.
    pub fn transformed(&self, m: DMat2, offset: DVec2) -> Footprint {
        Footprint { mean: m * self.mean + offset, covariance: m * self.covariance * m.transpose() }
    }
}
