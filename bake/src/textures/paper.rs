//! The closed forms that engines use, for comparison in reports and tests; nothing that ships uses them.
//!
//! Each makes a texel of a mip from moments of the normals under it and from the mean roughness of the material there.

use super::levels;
use super::options::Roughness;
use super::reference::Facet;
use crate::normal_map::NormalMap;
use glam::{DVec2, DVec3};

/// A closed form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClosedForm {
    /// Mean normals, renormalised; the mean of perceptual roughness. Whether normals are renormalised in the file or by the
    /// shader is the same.
    Plain,
    /// Toksvig 2004: the length of the mean normal dims a Phong lobe of power s = 2/α² − 2.
    Toksvig,
    /// Olano and Baker 2010 (LEAN), the same in all directions: mean and variance of slopes, α² grows by twice the mean variance
    /// along an axis.
    Lean,
    /// Tokuyoshi and Kaplanyan 2019, applied to what lies under a texel: twice the variance of projected normals, at most
    /// [`KAPLANYAN_LIMIT`].
    Kaplanyan,
}

/// Most that α² grows by, as published for variances of half vectors.
pub const KAPLANYAN_LIMIT: f64 = 0.18;

impl ClosedForm {
    /// All of them.
    pub const ALL: [ClosedForm; 4] = [ClosedForm::Plain, ClosedForm::Toksvig, ClosedForm::Lean, ClosedForm::Kaplanyan];

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            ClosedForm::Plain => "plain",
            ClosedForm::Toksvig => "Toksvig",
            ClosedForm::Lean => "LEAN",
            ClosedForm::Kaplanyan => "Kaplanyan",
        }
    }

    /// The texel that it makes of moments.
    pub fn texel(self, moments: &Moments) -> Facet {
        let a2 = moments.perceptual.powi(4);
        let facet = |normal: DVec3, a2: f64| Facet { normal, alpha: a2.clamp(1e-6, 1.0).sqrt() };
        let mean = moments.normal.normalize_or(DVec3::Z);
        match self {
            ClosedForm::Plain => facet(mean, a2),
            ClosedForm::Toksvig => {
                let length = moments.normal.length().min(1.0);
                let power = (2.0 / a2.max(1e-6) - 2.0).max(0.0);
                let factor = length / (length + power * (1.0 - length));
                facet(mean, 2.0 / (factor * power + 2.0))
            }
            ClosedForm::Lean => {
                let m = moments.slope;
                let variance = moments.slope_squared - m.length_squared();
                facet(DVec3::new(-m.x, -m.y, 1.0).normalize(), a2 + variance.max(0.0))
            }
            ClosedForm::Kaplanyan => {
                let s = DVec2::new(moments.normal.x, moments.normal.y);
                let variance = (moments.projected_squared - s.length_squared()).max(0.0);
                facet(mean, a2 + variance.min(KAPLANYAN_LIMIT))
            }
        }
    }
}

/// Moments of the normals and of the roughness under a texel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Mean of the unit normals, not renormalised.
    pub normal: DVec3,
    /// Mean of |(n_x, n_y)|².
    pub projected_squared: f64,
    /// Mean slope (−x/z, −y/z).
    pub slope: DVec2,
    /// Mean of the squared length of slopes.
    pub slope_squared: f64,
    /// Mean perceptual roughness.
    pub perceptual: f64,
}

/// Moments under texel (i, j) of a level, over the texels of the map.
pub fn moments(map: &NormalMap, roughness: &Roughness, (width, height): (u32, u32), (i, j): (u32, u32)) -> Moments {
    let (first_column, columns) = &levels::shares(map.width, width)[i as usize];
    let (first_row, rows) = &levels::shares(map.height, height)[j as usize];
    let mut sum = Moments::default();
    for (dj, row) in rows.iter().enumerate() {
        for (di, column) in columns.iter().enumerate() {
            let at = (*first_row as usize + dj) * map.width as usize + *first_column as usize + di;
            let weight = f64::from(*row) * f64::from(*column);
            let [x, y] = map.projected[at].map(f64::from);
            let z = (1.0 - x * x - y * y).max(1e-4).sqrt();
            let slope = DVec2::new(-x / z, -y / z);
            sum.normal += weight * DVec3::new(x, y, z);
            sum.projected_squared += weight * (x * x + y * y);
            sum.slope += weight * slope;
            sum.slope_squared += weight * slope.length_squared();
            sum.perceptual += weight * f64::from(roughness.texel(at));
        }
    }
    sum
}
