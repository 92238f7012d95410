//! Weighted 4D Gaussians over position (texels) and projected normal, and the moments of their mixtures, in f64.
//!
//! Tan et al. 2022, Eq. 4, by mean and covariance in place of the inverse: a mixture's moments are then sums.

use glam::{DMat2, DVec2};

/// Entries of a symmetric 4 × 4 matrix by rows of the upper triangle: xx xy xz xw yy yz yw zz zw ww.
pub(crate) type Symmetric4 = [f64; 10];

/// A weighted Gaussian; axes are u, v, s_x, s_y. The intrinsic roughness is not in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gaussian4 {
    /// Weight in texels.
    pub weight: f64,
    /// Mean.
    pub mean: [f64; 4],
    /// Covariance.
    pub covariance: Symmetric4,
}

impl Gaussian4 {
    /// The surface s = `normal` + `jacobian` · (u − `position`) + rest over positions u of covariance `positions`; the rest has the
    /// covariance `residual`.
    pub(crate) fn of_surface(
        weight: f64,
        position: DVec2,
        positions: DMat2,
        normal: DVec2,
        jacobian: DMat2,
        residual: DMat2,
    ) -> Gaussian4 {
        let cross = jacobian * positions;
        let normals = cross * jacobian.transpose() + residual;
        Gaussian4 {
            weight,
            mean: [position.x, position.y, normal.x, normal.y],
            covariance: [
                positions.x_axis.x,
                positions.x_axis.y,
                cross.x_axis.x,
                cross.x_axis.y,
                positions.y_axis.y,
                cross.y_axis.x,
                cross.y_axis.y,
                normals.x_axis.x,
                normals.x_axis.y,
                normals.y_axis.y,
            ],
        }
    }

    /// Mean position.
    pub(crate) fn position(&self) -> DVec2 {
        DVec2::new(self.mean[0], self.mean[1])
    }

    /// Mean normal.
    pub(crate) fn normal(&self) -> DVec2 {
        DVec2::new(self.mean[2], self.mean[3])
    }

    /// Covariance of positions.
    pub(crate) fn position_covariance(&self) -> DMat2 {
        let c = &self.covariance;
        DMat2::from_cols(DVec2::new(c[0], c[1]), DVec2::new(c[1], c[4]))
    }

    /// Covariance of normals.
    pub(crate) fn normal_covariance(&self) -> DMat2 {
        let c = &self.covariance;
        DMat2::from_cols(DVec2::new(c[7], c[8]), DVec2::new(c[8], c[9]))
    }

    /// Covariance of normals (rows) with positions (columns).
    fn cross_covariance(&self) -> DMat2 {
        let c = &self.covariance;
        DMat2::from_cols(DVec2::new(c[2], c[3]), DVec2::new(c[5], c[6]))
    }

    /// Slope of the regression of normals on positions: the Jacobian ∂s/∂u of the lobe.
    pub(crate) fn jacobian(&self) -> DMat2 {
        let positions = self.position_covariance();
        if positions.determinant() > 0.0 { self.cross_covariance() * positions.inverse() } else { DMat2::ZERO }
    }

    /// What a Jacobian over positions of covariance `positions` leaves of the normals' covariance; may be indefinite by
    /// rounding, or where either is not this lobe's own.
    pub(crate) fn residual(&self, jacobian: DMat2, positions: DMat2) -> DMat2 {
        self.normal_covariance() - jacobian * positions * jacobian.transpose()
    }
}

/// Sum of weighted Gaussians by their moments about a fixed origin near them.
pub(crate) struct Moments {
    origin: [f64; 4],
    weight: f64,
    first: [f64; 4],
    second: Symmetric4,
}

impl Moments {
    /// No Gaussians yet; `origin` is near their means, for digits.
    pub(crate) fn about(origin: [f64; 4]) -> Moments {
        Moments { origin, weight: 0.0, first: [0.0; 4], second: [0.0; 10] }
    }

    /// Adds one.
    pub(crate) fn add(&mut self, g: &Gaussian4) {
        let d: [f64; 4] = std::array::from_fn(|k| g.mean[k] - self.origin[k]);
        self.weight += g.weight;
        for k in 0..4 {
            self.first[k] += g.weight * d[k];
        }
        let mut at = 0;
        for i in 0..4 {
            for j in i..4 {
                self.second[at] += g.weight * (g.covariance[at] + d[i] * d[j]);
                at += 1;
            }
        }
    }

    /// The Gaussian of the same weight, mean and covariance; None when nothing has weight.
    pub(crate) fn gaussian(&self) -> Option<Gaussian4> {
        if self.weight <= 0.0 {
            return None;
        }
        let scale = 1.0 / self.weight;
        let d = self.first.map(|v| v * scale);
        let mut covariance = self.second.map(|v| v * scale);
        let mut at = 0;
        for i in 0..4 {
            for j in i..4 {
                covariance[at] -= d[i] * d[j];
                at += 1;
            }
        }
        Some(Gaussian4 { weight: self.weight, mean: std::array::from_fn(|k| self.origin[k] + d[k]), covariance })
    }
}

/// Moment matching of two: the Gaussian of the same weight, mean and covariance as both together.
pub(crate) fn merged(a: &Gaussian4, b: &Gaussian4) -> Gaussian4 {
    let weight = a.weight + b.weight;
    let (p, q) = (a.weight / weight, b.weight / weight);
    let d: [f64; 4] = std::array::from_fn(|k| b.mean[k] - a.mean[k]);
    let mut covariance = [0.0; 10];
    let mut at = 0;
    for i in 0..4 {
        for j in i..4 {
            covariance[at] = p * a.covariance[at] + q * b.covariance[at] + p * q * d[i] * d[j];
            at += 1;
        }
    }
    Gaussian4 { weight, mean: std::array::from_fn(|k| a.mean[k] + q * d[k]), covariance }
}

/// Determinant by the 2 × 2 minors of the upper and the lower two rows.
pub(crate) fn determinant(c: &Symmetric4) -> f64 {
    let [xx, xy, xz, xw, yy, yz, yw, zz, zw, ww] = *c;
    // Minors of rows x, y and of rows z, w.
    let (a01, a02, a03) = (xx * yy - xy * xy, xx * yz - xz * xy, xx * yw - xw * xy);
    let (a12, a13, a23) = (xy * yz - xz * yy, xy * yw - xw * yy, xz * yw - xw * yz);
    let (b01, b02, b03) = (xz * yw - yz * xw, xz * zw - zz * xw, xz * ww - zw * xw);
    let (b12, b13, b23) = (yz * zw - zz * yw, yz * ww - zw * yw, zz * ww - zw * zw);
    a01 * b23 - a02 * b13 + a03 * b12 + a12 * b03 - a13 * b02 + a23 * b01
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(k: f64) -> Gaussian4 {
        Gaussian4::of_surface(
            1.0 + k,
            DVec2::new(3.0 + k, 1.0 - 2.0 * k),
            DMat2::from_cols(DVec2::new(0.5, 0.1), DVec2::new(0.1, 0.3 + k)),
            DVec2::new(0.1, -0.2 * k),
            DMat2::from_cols(DVec2::new(0.1, 0.03), DVec2::new(-0.2, 0.05)),
            DMat2::from_cols(DVec2::new(0.01, 0.001), DVec2::new(0.001, 0.02)),
        )
    }

    #[test]
    fn a_surface_gives_back_its_jacobian_and_residual() {
        let g = sample(0.5);
        let jacobian = g.jacobian();
        assert!((jacobian.x_axis - DVec2::new(0.1, 0.03)).length() < 1e-12);
        assert!((jacobian.y_axis - DVec2::new(-0.2, 0.05)).length() < 1e-12);
        let residual = g.residual(jacobian, g.position_covariance());
        assert!((residual.x_axis - DVec2::new(0.01, 0.001)).length() < 1e-12);
    }

    #[test]
    fn merging_in_pairs_and_all_at_once_agree() {
        let parts = [sample(0.0), sample(0.7), sample(1.9)];
        let pairs = merged(&merged(&parts[0], &parts[1]), &parts[2]);
        let mut moments = Moments::about(parts[1].mean);
        parts.iter().for_each(|g| moments.add(g));
        let all = moments.gaussian().unwrap();
        assert!((pairs.weight - all.weight).abs() < 1e-12);
        for k in 0..10 {
            assert!((pairs.covariance[k] - all.covariance[k]).abs() < 1e-12, "{k}");
        }
    }

    #[test]
    fn determinant_of_a_block_matrix_and_of_a_product() {
        let c = [2.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 5.0, 1.0, 7.0];
        assert!((determinant(&c) - 6.0 * 34.0).abs() < 1e-12);
        // Schur: det = det(positions) · det(residual).
        let g = sample(0.3);
        let expected = g.position_covariance().determinant() * (0.01 * 0.02 - 1e-6);
        assert!((determinant(&g.covariance) - expected).abs() < 1e-15, "{}", determinant(&g.covariance));
    }
}
