//! Is this a tangent-space map? Normals of object or world space point everywhere, or lean to another axis.
//!
//! In tangent space z points out of the surface: of the real maps that we have none has a normal below the horizon, and
//! their means lean by at most 13°. The map of a closed object has half of its normals below, that of a ground in a world
//! with y up leans by 90°. Normals close to the horizon are not counted, for rounding and lossy codecs push steep ones
//! across. Which space a map with z up was made in nobody could tell; it does not matter there.

use crate::input::error::InputError;
use std::path::Path;

/// z of a unit normal below which it points down for sure: 6°.
const BELOW: f32 = -0.1;

/// Share of normals that may.
const MAX_BELOW: f64 = 0.02;

/// Angle from z up to which the mean may lean, degrees.
const MAX_LEAN: f64 = 60.0;

/// Length of the mean of unit normals from which on it has a direction.
const MIN_MEAN: f64 = 0.3;

/// Angle from z up to which the mean of a sample leaves no doubt, degrees.
const SURE_LEAN: f64 = 50.0;

/// Vectors shorter than this have no direction to speak of.
const MIN_LENGTH: f32 = 0.1;

/// Where the normals of a map point.
struct Directions {
    below: u64,
    count: u64,
    /// Length of the mean of the unit normals.
    mean: f64,
    /// Its angle from z, degrees.
    lean: f64,
}

impl Directions {
    fn of(vectors: impl Iterator<Item = [f32; 3]>) -> Directions {
        let (mut below, mut count, mut sum) = (0u64, 0u64, [0.0f64; 3]);
        for vector in vectors {
            let length = vector.iter().map(|c| c * c).sum::<f32>().sqrt();
            // Not for NaN either, which is named with its texel later.
            if length.is_finite() && length >= MIN_LENGTH {
                let [x, y, z] = vector.map(|c| c / length);
                count += 1;
                below += u64::from(z < BELOW);
                sum = [sum[0] + f64::from(x), sum[1] + f64::from(y), sum[2] + f64::from(z)];
            }
        }
        let [x, y, z] = sum.map(|c| c / count as f64);
        let lean = x.hypot(y).atan2(z).to_degrees();
        Directions { below, count, mean: (x * x + y * y + z * z).sqrt(), lean }
    }

    /// Share of normals that point below the surface; NaN where there are no normals.
    fn below(&self) -> f64 {
        self.below as f64 / self.count as f64
    }
}

/// Refuses maps that are not in tangent space: all vectors are asked where a sample of them leaves doubt.
pub(super) fn refuse_other_spaces<T: Iterator<Item = [f32; 3]>>(
    path: &Path,
    sample: impl Iterator<Item = [f32; 3]>,
    all: impl Fn() -> T,
) -> Result<(), InputError> {
    let of_sample = Directions::of(sample);
    if of_sample.below() <= MAX_BELOW / 2.0 && of_sample.lean <= SURE_LEAN && of_sample.mean > MIN_MEAN {
        return Ok(());
    }
    let Directions { below, count, mean, lean } = Directions::of(all());
    if count == 0 {
        return Ok(());
    }
    let found = if below as f64 > MAX_BELOW * count as f64 {
        format!("{below} of {count} normals point below the surface (z < 0)")
    } else if lean > MAX_LEAN && mean > MIN_MEAN {
        format!("the mean normal leans by {lean:.0}° from z")
    } else {
        return Ok(());
    };
    Err(InputError::bad(
        path,
        format!(
            "this looks like an object-space or world-space map: {found}; expected a tangent-space normal map with z, \
             which points out of the surface, in blue: bake it in tangent space. If it is one, give --channels xyz"
        ),
    ))
}
