//! What is compared where patches overlap: Eq. 7 of Tan et al. 2022 in integers.
//!
//! Eq. 7 is α ‖n_i − n_j‖² + (1 − α) ‖J_i − J_j‖², the squared distance of the vectors (√α n, √(1−α) J). n is the
//! projected normal, the domain of the lobes, and J its Jacobian by central differences. Each of the six numbers is taken
//! from its mean over the sample and rounded to a multiple of 1/[`RANGE`] of the largest there is, so that distances are
//! exact integers: their sums do not depend on the order, and the choice of a patch does not depend on the machine.

use crate::normal_map::NormalMap;
use glint_formats::Wrap;

/// Largest size of a feature.
pub const RANGE: f64 = 2047.0;

/// Numbers a texel: two of the normal, four of the Jacobian.
pub const COUNT: usize = 6;

/// A texel's features.
pub type Feature = [i16; COUNT];

/// Features of a sample, which repeats. (Patches of one that does not never leave it.)
pub struct Features {
    width: u32,
    height: u32,
    wrap: Wrap,
    texels: Vec<Feature>,
}

/// Eq. 7 in units of the features' step.
#[inline]
pub fn distance(a: Feature, b: Feature) -> u32 {
    let mut sum = 0;
    for k in 0..COUNT {
        let d = i32::from(a[k]) - i32::from(b[k]);
        sum += (d * d) as u32;
    }
    sum
}

impl Features {
    /// Features of a map under the weight `alpha` of normals.
    pub fn new(map: &NormalMap, alpha: f64) -> Features {
        let (normal, jacobian) = (alpha.sqrt(), (1.0 - alpha).sqrt());
        let exact = |i: i64, j: i64| -> [f64; COUNT] {
            let s = map.texel(i, j) * normal;
            let du = (map.texel(i + 1, j) - map.texel(i - 1, j)) * (0.5 * jacobian);
            let dv = (map.texel(i, j + 1) - map.texel(i, j - 1)) * (0.5 * jacobian);
            [s.x, s.y, du.x, du.y, dv.x, dv.y]
        };
        let grid = || (0..i64::from(map.height)).flat_map(|j| (0..i64::from(map.width)).map(move |i| (i, j)));
        let mut mean = [0.0; COUNT];
        for (i, j) in grid() {
            let texel = exact(i, j);
            for k in 0..COUNT {
                mean[k] += texel[k];
            }
        }
        let texels = map.projected.len() as f64;
        mean = mean.map(|sum| sum / texels);
        let mut largest = 0.0f64;
        for (i, j) in grid() {
            let texel = exact(i, j);
            for k in 0..COUNT {
                largest = largest.max((texel[k] - mean[k]).abs());
            }
        }
        let scale = if largest > 0.0 { RANGE / largest } else { 0.0 };
        let rounded = |(i, j)| {
            let texel = exact(i, j);
            std::array::from_fn(|k| ((texel[k] - mean[k]) * scale).round() as i16)
        };
        Features { width: map.width, height: map.height, wrap: map.wrap, texels: grid().map(rounded).collect() }
    }

    /// Width and height of the sample.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// What lies beyond the edge of the sample.
    pub fn wrap(&self) -> Wrap {
        self.wrap
    }

    /// The texel at (x, y), any integers.
    #[inline]
    pub fn at(&self, x: i32, y: i32) -> Feature {
        let (x, y) = (x.rem_euclid(self.width as i32), y.rem_euclid(self.height as i32));
        self.texels[y as usize * self.width as usize + x as usize]
    }

    /// Copies the texels from (x, y) on, along the row.
    pub fn copy_row(&self, x: i32, y: i32, row: &mut [Feature]) {
        let (width, first) = (self.width as usize, x.rem_euclid(self.width as i32) as usize);
        let texels = &self.texels[y.rem_euclid(self.height as i32) as usize * width..][..width];
        if first + row.len() <= width {
            row.copy_from_slice(&texels[first..][..row.len()]);
        } else {
            row.iter_mut().zip(texels.iter().cycle().skip(first)).for_each(|(to, from)| *to = *from);
        }
    }

    /// Mean distance of neighbours inside the sample, along rows and along columns: the units of errors. One that is less
    /// than a hundredth of the other is taken as that, and both are 1 where nothing varies.
    pub fn neighbour_distance(&self) -> [f64; 2] {
        let (width, height) = (self.width as i32, self.height as i32);
        let along = |dx: i32, dy: i32| {
            let (mut sum, mut pairs) = (0u64, 0u64);
            for y in 0..height - dy {
                for x in 0..width - dx {
                    sum += u64::from(distance(self.at(x, y), self.at(x + dx, y + dy)));
                    pairs += 1;
                }
            }
            sum as f64 / pairs.max(1) as f64
        };
        let found = [along(1, 0), along(0, 1)];
        let largest = found[0].max(found[1]);
        if largest == 0.0 { [1.0; 2] } else { found.map(|unit| unit.max(0.01 * largest)) }
    }
}
