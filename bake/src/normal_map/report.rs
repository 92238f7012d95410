//! What a normal map is like: lengths as they came in, then mean, spread, convention, seams of the mended map.
//!
//! Is the green axis up or down? A surface has no curl, and a flipped axis breaks that.
//!
//! Over a height field with y up, ∂m_x/∂y = ∂m_y/∂x: the two cross derivatives are equal, their correlation is +1.
//! With green flipped it is −1. Projected normals stand in for slopes: they behave alike and have no poles at the
//! horizon. Real maps give 0.4 to 0.95 in size; flat and flake maps next to nothing, for those are no height fields.

use glint_formats::Wrap;
use serde::Serialize;

use super::map::NormalMap;
use super::raw::ZERO_LENGTH;

/// A seam is suspected where the step across it is this many times the mean step between neighbours inside, and
/// larger than any of those.
pub const SEAM_RATIO: f64 = 2.0;

/// Spread of the projected normal (any texel's distance from the mean) up to which a map is called flat: all texels
/// equal but for ±1 in 8 bits, a step being 2/255.
const FLAT: f64 = 1.5 * 2.0 / 255.0;

/// Correlation below which green is called flipped. Real DirectX maps lie at −0.4 and lower.
const FLIPPED_BELOW: f64 = -0.3;

/// Texels below which nothing is concluded: few texels hold few independent ones.
const ENOUGH_TEXELS: u64 = 4096;

/// What was found in a normal map. Lengths and counts describe the input, all else the validated map (+Y up).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NormalReport {
    /// Number of texels.
    pub texels: u64,
    /// Texels whose length was off by more than 1 %; renormalised.
    pub off_unit: u64,
    /// Shortest vector found.
    pub min_length: f64,
    /// Longest vector found.
    pub max_length: f64,
    /// Texels with z ≤ 0; pushed to the horizon. Zero-length ones are not counted here.
    pub below_horizon: u64,
    /// Texels without a direction; made flat.
    pub zero_length: u64,
    /// Mean of the unit normals.
    pub mean_normal: [f64; 3],
    /// Standard deviation of the slopes −x/z and −y/z.
    pub slope_std: [f64; 2],
    /// Correlation of ∂s_x/∂y with ∂s_y/∂x, y = −v: near +1 for the normals of a surface, near −1 when green is
    /// flipped, near 0 when neither can be told. Absent when the map is too small or does not vary.
    pub curl_correlation: Option<f64>,
    /// True when the green axis is flipped for sure.
    pub flipped_green_suspected: bool,
    /// Step across the left-right edge against the steps inside, along u; absent on fewer than three columns.
    pub seam_u: Option<SeamRatio>,
    /// The same across the top-bottom edge, along v.
    pub seam_v: Option<SeamRatio>,
    /// True when a repeating map shows a seam at an edge; never for a clamped one.
    pub seam_suspected: bool,
    /// True when all texels are equal but for ±1 in 8 bits.
    pub is_flat: bool,
}

/// Mean |Δs| across an edge, as a ratio.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SeamRatio {
    /// To the mean over all pairs of neighbouring columns (or rows) inside.
    pub to_mean: f64,
    /// To the largest over those pairs.
    pub to_largest: f64,
}

/// Tally of the vectors as they come in.
pub(super) struct Lengths {
    pub texels: u64,
    pub zero: u64,
    pub below_horizon: u64,
    off_unit: u64,
    min: f64,
    max: f64,
}

impl Lengths {
    pub fn new() -> Lengths {
        Lengths { texels: 0, zero: 0, below_horizon: 0, off_unit: 0, min: f64::INFINITY, max: 0.0 }
    }

    pub fn add(&mut self, length: f64, z: f64) {
        self.texels += 1;
        self.min = self.min.min(length);
        self.max = self.max.max(length);
        self.off_unit += u64::from((length - 1.0).abs() > 0.01);
        if length < ZERO_LENGTH {
            self.zero += 1;
        } else {
            self.below_horizon += u64::from(z <= 0.0);
        }
    }
}

impl NormalReport {
    /// Measures a validated map, given the tally of its input.
    pub(super) fn measure(map: &NormalMap, lengths: &Lengths) -> NormalReport {
        let moments = Moments::of(map);
        let curl_correlation = curl_correlation(map);
        let (seam_u, seam_v) = (seam_u(map), seam_v(map));
        let visible = |seam: Option<SeamRatio>| seam.is_some_and(|s| s.to_mean > SEAM_RATIO && s.to_largest > 1.0);
        NormalReport {
            texels: lengths.texels,
            off_unit: lengths.off_unit,
            min_length: lengths.min,
            max_length: lengths.max,
            below_horizon: lengths.below_horizon,
            zero_length: lengths.zero,
            mean_normal: moments.mean_normal,
            slope_std: moments.slope_std,
            curl_correlation,
            flipped_green_suspected: flipped_green(map, curl_correlation),
            seam_u,
            seam_v,
            seam_suspected: map.wrap == Wrap::Repeat && (visible(seam_u) || visible(seam_v)),
            is_flat: moments.spread <= FLAT,
        }
    }
}

struct Moments {
    mean_normal: [f64; 3],
    slope_std: [f64; 2],
    /// Largest distance of a projected normal from the mean one.
    spread: f64,
}

impl Moments {
    fn of(map: &NormalMap) -> Moments {
        let n = map.projected.len() as f64;
        let unit = |&[x, y]: &[f32; 2]| {
            let (x, y) = (x as f64, y as f64);
            (x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
        };
        let (mut mean, mut mean_slope) = ([0.0; 3], [0.0; 2]);
        for (x, y, z) in map.projected.iter().map(unit) {
            mean = [mean[0] + x / n, mean[1] + y / n, mean[2] + z / n];
            mean_slope = [mean_slope[0] - x / z / n, mean_slope[1] - y / z / n];
        }
        // A second pass: the difference of sums loses the small spread of a nearly flat map.
        let (mut variance, mut spread) = ([0.0; 2], 0.0f64);
        for (x, y, z) in map.projected.iter().map(unit) {
            variance[0] += (-x / z - mean_slope[0]).powi(2) / n;
            variance[1] += (-y / z - mean_slope[1]).powi(2) / n;
            spread = spread.max((x - mean[0]).hypot(y - mean[1]));
        }
        Moments { mean_normal: mean, slope_std: variance.map(f64::sqrt), spread }
    }
}

/// Correlation, over the interior texels, of ∂s_x/∂y with ∂s_y/∂x by central differences (y = −v). None when there are
/// no interior texels or a derivative does not vary.
fn curl_correlation(map: &NormalMap) -> Option<f64> {
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for j in 1..map.height as i64 - 1 {
        for i in 1..map.width as i64 - 1 {
            // The common factor ½ of the differences cancels.
            let a = map.texel(i, j - 1).x - map.texel(i, j + 1).x;
            let b = map.texel(i + 1, j).y - map.texel(i - 1, j).y;
            aa += a * a;
            bb += b * b;
            ab += a * b;
        }
    }
    let scale = (aa * bb).sqrt();
    (scale > 0.0).then(|| ab / scale)
}

/// True when the correlation says so and there is enough to go by.
fn flipped_green(map: &NormalMap, curl_correlation: Option<f64>) -> bool {
    let enough = map.width as u64 * map.height as u64 >= ENOUGH_TEXELS;
    enough && curl_correlation.is_some_and(|c| c < FLIPPED_BELOW)
}

fn seam_u(map: &NormalMap) -> Option<SeamRatio> {
    let mut steps = vec![0.0; map.width as usize];
    for j in 0..map.height as i64 {
        for i in 0..map.width as i64 {
            steps[i as usize] += step(map, (i, j), ((i + 1) % map.width as i64, j));
        }
    }
    seam(&steps)
}

fn seam_v(map: &NormalMap) -> Option<SeamRatio> {
    let mut steps = vec![0.0; map.height as usize];
    for j in 0..map.height as i64 {
        for i in 0..map.width as i64 {
            steps[j as usize] += step(map, (i, j), (i, (j + 1) % map.height as i64));
        }
    }
    seam(&steps)
}

fn step(map: &NormalMap, a: (i64, i64), b: (i64, i64)) -> f64 {
    map.texel(a.0, a.1).distance(map.texel(b.0, b.1))
}

/// Compares the last step, which is the one across the edge, with those before it, between neighbouring lines.
fn seam(steps: &[f64]) -> Option<SeamRatio> {
    let (across, inside) = steps.split_last()?;
    let mean = inside.iter().sum::<f64>() / inside.len() as f64;
    let largest = inside.iter().copied().fold(0.0, f64::max);
    // Lines that never differ: only a step at the edge could be seen, and then no ratio describes it.
    (inside.len() >= 2 && mean > 0.0).then(|| SeamRatio { to_mean: across / mean, to_largest: across / largest })
}
