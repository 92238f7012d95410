//! Brute force over all finest lobes, in f64: Tan et al. 2022, Eq. 3, 5 and 6 as they stand.
//!
//! Every box of the repeated map within reach is one 4D Gaussian around its bilinear normal and Jacobian; the product with
//! the footprint is integrated by inverting its precision matrix. No levels, no cells, no stored bytes.

use crate::footprint::Footprint;
use crate::normal_map::NormalMap;
use glam::{DMat2, DVec2};

/// Footprints reach this far, in standard deviations.
const REACH: f64 = 6.0;

/// Lobes of the boxes of `edge` texels of a bilinear map, one over a whole number: the P-NDF at `s`, σ_r = `roughness`.
/// Boxes begin at texel centres. Lobes near the rim are not cut by it.
pub fn sum_of_boxes(map: &NormalMap, footprint: &Footprint, edge: f64, roughness: f64, s: DVec2) -> f64 {
    let (_, major, _) = footprint.principal();
    let reach = DVec2::splat(REACH * major + edge);
    let low = ((footprint.mean - reach - 0.5) / edge).floor();
    let high = ((footprint.mean + reach - 0.5) / edge).ceil();
    let spread = edge * edge / 12.0;
    let both = DMat2::from_diagonal(DVec2::splat(spread)) + footprint.covariance;
    let given_footprint = (DMat2::from_diagonal(DVec2::splat(1.0 / spread)) + footprint.covariance.inverse()).inverse();
    let (mut sum, mut share) = (0.0, 0.0);
    for j in low.y as i64..=high.y as i64 {
        for i in low.x as i64..=high.x as i64 {
            let centre = (DVec2::new(i as f64, j as f64) + 0.5) * edge + 0.5;
            let weight = gaussian(footprint.mean - centre, both);
            let (normal, jacobian) = map.bilinear(centre);
            // The Jacobian's change over the box, as a residual of the same variance.
            let right = map.bilinear(centre + DVec2::new(0.25 * edge, 0.0)).1.y_axis;
            let twist = (right - jacobian.y_axis) / (0.25 * edge);
            let residual = DMat2::from_cols(twist * twist.x, twist * twist.y) * spread * spread;
            let mean = normal + jacobian * (spread * (both.inverse() * (footprint.mean - centre)));
            let intrinsic = DMat2::from_diagonal(DVec2::splat(roughness * roughness));
            let covariance = intrinsic + residual + jacobian * given_footprint * jacobian.transpose();
            sum += weight * gaussian(s - mean, covariance);
            share += weight;
        }
    }
    sum / share
}

fn gaussian(d: DVec2, covariance: DMat2) -> f64 {
    let q = d.dot(covariance.inverse() * d);
    libm::exp(-0.5 * q) / (2.0 * std::f64::consts::PI * covariance.determinant().sqrt())
}
