//! What lies under a texel of a mip: the box that it covers, for maps of any size.
//!
//! Texel i of a level of w′ texels covers texels i w/w′ to (i + 1) w/w′ of the map, as in `area_light`. A level has half the
//! texels of the one before, rounded down, at least one.

use glint_formats::container::full_mip_count;

/// Widths and heights of all levels, the map itself first.
pub fn sizes(width: u32, height: u32) -> Vec<(u32, u32)> {
    (0..full_mip_count(width, height)).map(|mip| ((width >> mip).max(1), (height >> mip).max(1))).collect()
}

/// Texels of the map under each texel of a level along one axis: the first, and the shares, which add up to 1.
pub fn shares(fine: u32, coarse: u32) -> Vec<(u32, Vec<f32>)> {
    let ratio = f64::from(fine) / f64::from(coarse);
    (0..coarse)
        .map(|i| {
            let (start, end) = (f64::from(i) * ratio, f64::from(i + 1) * ratio);
            let first = start.floor() as u32;
            let last = (end.ceil() as u32).min(fine).max(first + 1);
            let share = |k: u32| (end.min(f64::from(k + 1)) - start.max(f64::from(k))).max(0.0) / ratio;
            (first, (first..last).map(|k| share(k) as f32).collect())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_cover_the_map_once() {
        for (fine, coarse) in [(8, 4), (745, 372), (5, 2), (7, 1), (1, 1), (3, 1)] {
            let mut covered = vec![0.0; fine as usize];
            for (first, shares) in shares(fine, coarse) {
                assert!((shares.iter().sum::<f32>() - 1.0).abs() < 1e-6);
                for (k, share) in shares.iter().enumerate() {
                    covered[first as usize + k] += share * fine as f32 / coarse as f32;
                }
            }
            assert!(covered.iter().all(|c: &f32| (c - 1.0).abs() < 1e-4), "{fine} {coarse}: {covered:?}");
        }
        assert_eq!(sizes(5, 2), [(5, 2), (2, 1), (1, 1)]);
    }
}
