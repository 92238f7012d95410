//! How far vectors are from unit length, and where they point on average: what tells normals from other data.

/// Bins a unit of deviation; deviations above 1 are all one.
const BINS: usize = 1000;

/// Lengths and directions of many vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fit {
    /// Median of | |n| − 1 |, to 0.001; of [`Fit::cautious`] the deviation that 53 % do not exceed.
    pub deviation: f64,
    /// Angle between the mean vector and z, degrees.
    pub lean: f64,
}

impl Fit {
    /// Measures; None where there are no finite vectors.
    pub fn of(vectors: impl Iterator<Item = [f32; 3]>) -> Option<Fit> {
        Fit::with_share(0.5, vectors)
    }

    /// Measures a sample of 16,384 vectors or more so that all have no larger median: the margin is 7 standard deviations of a
    /// share.
    pub fn cautious(sample: impl Iterator<Item = [f32; 3]>) -> Option<Fit> {
        Fit::with_share(0.53, sample)
    }

    /// The deviation is the one that this share of the vectors does not exceed.
    fn with_share(share: f64, vectors: impl Iterator<Item = [f32; 3]>) -> Option<Fit> {
        let mut bins = [0u64; BINS + 1];
        let (mut sum, mut count) = ([0.0f64; 3], 0u64);
        for vector in vectors.filter(|vector| vector.iter().all(|c| c.is_finite())) {
            let [x, y, z] = vector.map(f64::from);
            let deviation = ((x * x + y * y + z * z).sqrt() - 1.0).abs();
            bins[(deviation * BINS as f64).min(BINS as f64) as usize] += 1;
            sum = [sum[0] + x, sum[1] + y, sum[2] + z];
            count += 1;
        }
        let mut below = 0;
        let median = bins.iter().position(|bin| {
            below += bin;
            below as f64 >= share * count as f64 && count > 0
        })?;
        let lean = sum[0].hypot(sum[1]).atan2(sum[2]).to_degrees();
        Some(Fit { deviation: median as f64 / BINS as f64, lean })
    }
}
