//! Round look-ups that stand for the lobe of a surface seen at an angle.
//!
//! Not in the paper, whose one look-up in the mirror direction at the surface's own roughness (section 3.4, N = V = R) is the lobe of
//! a surface seen along its normal. At an angle θ facets tilted by δ in the plane of incidence turn the reflection by 2δ, those tilted
//! across it by 2δ cos θ, masking and the horizon cut it, and its middle lies nearer to the normal than the mirror direction. One to
//! three look-ups of the same filtered maps, all in the plane of incidence, are fitted to it:
//!
//! - the target is the mean of ρ̃ and, for the glints' variance, of what facets add in the square, in shares of [`OF_SQUARE`];
//! - differences count over the mean of the target around the mirror direction plus [`FLOOR`], by their squares: under a sun besides an
//!   even sky every pixel counts by its relative error, those far from the highlight as much as those within;
//! - Levenberg–Marquardt, begun at the fits of the angle and the roughness beside, which it is also drawn to a little, so that look-ups go
//!   smoothly over the table and none changes its place with another.
//!
//! Targets and kernels are summed over rings around the mirror direction, even in ln(1 + t b/a), which both follow.

use super::albedo::masking;
use super::kernel::Lobe;
use super::reference::ggx;
use glam::DVec3;
use glint_formats::environment::{Kernel, MAX_LOOK_UPS};
use std::f64::consts::PI;

/// Share of the lobe of the square in the target.
const OF_SQUARE: f64 = 0.25;
/// What is added to the mean of a ring, in 1/sr; even light has 1/4π.
const FLOOR: f64 = 0.3;
/// Reflectance at normal incidence of the surface that look-ups are fitted to.
const F0: f64 = 0.5;
/// Rings around the mirror direction, and directions of half a ring; the other half is the same.
const RINGS: usize = 40;
const PER_RING: usize = 20;
/// Columns and rows of fits, even in cos θ from [`LEAST_COSINE`] to 1 and in √α from [`LEAST_ROOT`] to 1. Entries of the table lie
/// between them.
const COLUMNS: usize = 17;
const ROWS: usize = 13;
/// Column that a row begins with, near 60°.
const MIDDLE: usize = 8;
/// √α of the least roughness that is fitted; below it lobes differ by their size only.
const LEAST_ROOT: f64 = 0.1;
/// Least cos θ that is fitted.
const LEAST_COSINE: f64 = 0.04;
/// Weight of the squared difference to the fits beside.
const DRAWN: f64 = 1e-4;
/// Most steps of a fit.
const STEPS: usize = 40;
/// What the first step adds to the diagonal of its equations, over it.
const DAMPING: f64 = 0.01;
/// Change of the sum of squares, over it, that ends a fit.
const ENOUGH: f64 = 1e-6;
/// Difference of a parameter that slopes are taken over.
const SLOPE_STEP: f64 = 1e-5;
/// Longest step of a parameter.
const LONGEST: f64 = 0.3;
/// Most shortenings of a step.
const SHORTENINGS: usize = 8;
/// Least logarithm of a ratio of roughnesses; the largest is that of a roughness of 1.
const LEAST_RATIO: f64 = -2.3;
/// Parameters of a fit: shifts, logarithms of ratios, logarithms of shares over that of the first.
const PARAMETERS: usize = 3 * MAX_LOOK_UPS;

/// A round look-up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FittedLookUp {
    /// κ of its direction m + κ α (n − (n·m) m), m being the mirror direction and n the normal: above 0 towards the normal.
    pub shift: f64,
    /// Its roughness over α, above 0.
    pub ratio: f64,
    /// Its share of what is read, 0 to 1; those of an entry add up to 1.
    pub share: f64,
}

/// The look-ups of an entry; those beyond the count asked are zero.
pub type Fitted = [FittedLookUp; MAX_LOOK_UPS];

/// What look-ups are fitted to, at one angle and roughness, in the frame of the mirror direction (0, 0, 1) with the normal at x ≥ 0.
struct Target {
    kernel: Kernel,
    alpha: f64,
    /// sin θ.
    sine: f64,
    directions: Vec<DVec3>,
    /// Solid angle of each, in steradians.
    solid_angles: Vec<f64>,
    /// The lobe at each, of integral 1.
    lobe: Vec<f64>,
    /// Root of the weight of squared differences at each.
    weights: Vec<f64>,
}

impl Target {
    fn new(kernel: Kernel, cos_o: f64, alpha: f64) -> Target {
        let sine = (1.0 - cos_o * cos_o).max(0.0).sqrt();
        let (directions, solid_angles) = rings(alpha);
        let normal = DVec3::new(sine, 0.0, cos_o);
        let view = DVec3::new(2.0 * sine * cos_o, 0.0, 2.0 * cos_o * cos_o - 1.0);
        let facets: Vec<[f64; 2]> = directions.iter().map(|&light| reflected(normal, view, light, alpha)).collect();
        let whole = [0, 1].map(|k| facets.iter().zip(&solid_angles).map(|(facet, part)| facet[k] * part).sum::<f64>());
        let lobe: Vec<f64> = facets
            .iter()
            .map(|[mean, square]| (1.0 - OF_SQUARE) * mean / whole[0] + OF_SQUARE * square / whole[1])
            .collect();
        let around = lobe.chunks(PER_RING).map(|ring| ring.iter().sum::<f64>() / PER_RING as f64);
        let scales = around.flat_map(|mean| [mean + FLOOR; PER_RING]);
        let weights = scales.zip(&solid_angles).map(|(scale, part)| part.sqrt() / scale).collect();
        Target { kernel, alpha, sine, directions, solid_angles, lobe, weights }
    }

    /// What `count` look-ups make of the lobe less the lobe, weighted.
    fn differences(&self, count: usize, x: &[f64; PARAMETERS]) -> Vec<f64> {
        let mut sum: Vec<f64> = self.lobe.iter().map(|value| -value).collect();
        for look_up in &fitted_of(count, x)[..count] {
            let towards = DVec3::new(look_up.shift * self.alpha * self.sine, 0.0, 1.0).normalize();
            let kernel = Lobe::shape(self.kernel, look_up.ratio * self.alpha);
            let values: Vec<f64> = self.directions.iter().map(|&d| kernel.weight(1.0 - towards.dot(d))).collect();
            let whole: f64 = values.iter().zip(&self.solid_angles).map(|(value, part)| value * part).sum();
            let factor = look_up.share / whole.max(1e-300);
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
        }
        sum.iter().zip(&self.weights).map(|(sum, weight)| sum * weight).collect()
    }
}

/// Directions around the mirror direction and their solid angles, ring by ring; both halves of a ring count.
fn rings(alpha: f64) -> (Vec<DVec3>, Vec<f64>) {
    let a = alpha * alpha;
    let stretch = 1.0 + 0.5 * (1.0 - a) / a;
    let end = libm::log1p(2.0 * stretch);
    let (mut directions, mut solid_angles) = (Vec::new(), Vec::new());
    for i in 0..RINGS {
        let grown = libm::exp(end * (i as f64 + 0.5) / RINGS as f64);
        let t = (grown - 1.0) / stretch;
        let thick = grown / stretch * end / RINGS as f64;
        let across = (t * (2.0 - t)).max(0.0).sqrt();
        for j in 0..PER_RING {
            let azimuth = PI * (j as f64 + 0.5) / PER_RING as f64;
            directions.push(DVec3::new(across * libm::cos(azimuth), across * libm::sin(azimuth), 1.0 - t));
            solid_angles.push(2.0 * PI / PER_RING as f64 * thick);
        }
    }
    (directions, solid_angles)
}

/// ρ̃ and its square over the density of facets, up to a factor each, of light from `light`; zeros below the horizon.
fn reflected(normal: DVec3, view: DVec3, light: DVec3, alpha: f64) -> [f64; 2] {
    let half = (light + view).normalize_or_zero();
    let (cos_o, cos_i, oh) = (normal.dot(view), normal.dot(light), view.dot(half));
    if cos_i <= 0.0 || oh <= 0.0 {
        return [0.0; 2];
    }
    let facet = (F0 + (1.0 - F0) * (1.0 - oh).powi(5)) * masking(cos_o, cos_i, alpha * alpha) * oh;
    let facets = ggx(normal.dot(half), alpha) / oh;
    [facets * facet, facets * facet * facet]
}

/// The look-ups of parameters: `count` shifts, logarithms of ratios, and logarithms of shares over that of the first.
fn fitted_of(count: usize, x: &[f64; PARAMETERS]) -> Fitted {
    let share = |i: usize| if i == 0 { 1.0 } else { libm::exp(x[2 * count + i - 1]) };
    let whole: f64 = (0..count).map(share).sum();
    let look_up = |i: usize| FittedLookUp { shift: x[i], ratio: libm::exp(x[count + i]), share: share(i) / whole };
    std::array::from_fn(|i| if i < count { look_up(i) } else { FittedLookUp::default() })
}

/// What the first fit begins with: the middle, then one towards the normal, which is also the wide one, then one towards the
/// horizon.
fn first_of(count: usize) -> [f64; PARAMETERS] {
    let (shifts, ratios) = match count {
        1 => ([0.0; MAX_LOOK_UPS], [0.0; MAX_LOOK_UPS]),
        2 => ([-0.5, 0.5, 0.0], [-0.1, 0.3, 0.0]),
        _ => ([0.0, 1.0, -1.0], [-0.1, 0.3, 0.0]),
    };
    let mut x = [0.0; PARAMETERS];
    x[..count].copy_from_slice(&shifts[..count]);
    x[count..2 * count].copy_from_slice(&ratios[..count]);
    x
}

/// The best parameters of `count` look-ups near `prior`.
fn fit(target: &Target, count: usize, prior: &[f64; PARAMETERS]) -> [f64; PARAMETERS] {
    let used = 3 * count - 1;
    let differences = |x: &[f64; PARAMETERS]| {
        let mut all = target.differences(count, x);
        all.extend((0..used).map(|k| DRAWN.sqrt() * (x[k] - prior[k])));
        all
    };
    let widest = -libm::log(target.alpha);
    let bounded = |x: f64, k: usize| if (count..2 * count).contains(&k) { x.clamp(LEAST_RATIO, widest) } else { x };
    let mut x = std::array::from_fn(|k| bounded(prior[k], k));
    let mut now = differences(&x);
    let mut damping = DAMPING;
    for _ in 0..STEPS {
        let before = square(&now);
        let slopes: Vec<Vec<f64>> = (0..used)
            .map(|k| {
                let mut beside = x;
                beside[k] += SLOPE_STEP;
                differences(&beside).iter().zip(&now).map(|(there, here)| (there - here) / SLOPE_STEP).collect()
            })
            .collect();
        let Some((next, found)) = step(&slopes, &now, &x, &mut damping, &bounded, &differences) else { break };
        let after = square(&found);
        (x, now) = (next, found);
        if before - after < ENOUGH * before {
            break;
        }
    }
    x
}

/// A step that makes the sum of squares less, shortened until it does; none where none does.
fn step(
    slopes: &[Vec<f64>],
    now: &[f64],
    x: &[f64; PARAMETERS],
    damping: &mut f64,
    bounded: &impl Fn(f64, usize) -> f64,
    differences: &impl Fn(&[f64; PARAMETERS]) -> Vec<f64>,
) -> Option<([f64; PARAMETERS], Vec<f64>)> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let before = square(now);
    for _ in 0..SHORTENINGS {
        let mut matrix: Vec<Vec<f64>> = slopes
            .iter()
            .map(|row| slopes.iter().map(|column| dot(row, column)).chain([-dot(row, now)]).collect())
            .collect();
        (0..slopes.len()).for_each(|k| matrix[k][k] *= 1.0 + *damping);
        let mut next = *x;
        for (k, change) in solved(matrix).into_iter().enumerate() {
            next[k] = bounded(x[k] + change.clamp(-LONGEST, LONGEST), k);
        }
        let found = differences(&next);
        if square(&found) < before {
            *damping = (0.3 * *damping).max(1e-7);
            return Some((next, found));
        }
        *damping *= 4.0;
    }
    None
}

fn square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// Solution of linear equations of a positive definite matrix, whose right sides are the last column, by elimination.
fn solved(mut matrix: Vec<Vec<f64>>) -> Vec<f64> {
    let size = matrix.len();
    for k in 0..size {
        let (above, below) = matrix.split_at_mut(k + 1);
        let pivot = &above[k];
        for row in below {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(pivot).skip(k).for_each(|(value, pivot)| *value -= factor * pivot);
        }
    }
    let mut x = vec![0.0; size];
    for k in (0..size).rev() {
        let known: f64 = (k + 1..size).map(|i| matrix[k][i] * x[i]).sum();
        x[k] = (matrix[k][size] - known) / matrix[k][k];
    }
    x
}

/// View cosine and roughness α of a column and a row of fits.
fn arguments(column: f64, row: f64) -> (f64, f64) {
    let part = |least: f64, place: f64, count: usize| least + (1.0 - least) * place / (count - 1) as f64;
    (part(LEAST_COSINE, column, COLUMNS), part(LEAST_ROOT, row, ROWS).powi(2))
}

/// Fits of `count` look-ups, 1 to [`MAX_LOOK_UPS`], of a kernel's maps.
pub struct Fits {
    count: usize,
    /// Row by row, the least roughness first, each from the least cosine on.
    fits: Vec<[f64; PARAMETERS]>,
}

impl Fits {
    /// Fits all angles and roughnesses: each row from its middle to both sides.
    pub fn new(kernel: Kernel, count: usize) -> Fits {
        let mut fits = vec![first_of(count); COLUMNS * ROWS];
        let (left, right) = ((0..MIDDLE).rev().map(|k| (k, k + 1)), (MIDDLE + 1..COLUMNS).map(|k| (k, k - 1)));
        let order: Vec<(usize, usize)> = [(MIDDLE, MIDDLE)].into_iter().chain(left).chain(right).collect();
        for row in 0..ROWS {
            for &(column, beside) in &order {
                let (cosine, alpha) = arguments(column as f64, row as f64);
                let found = [row * COLUMNS + beside, row.saturating_sub(1) * COLUMNS + column].map(|at| fits[at]);
                // The first of a row has none beside it, the first row none before it.
                let prior = match (row, column == beside) {
                    (0, _) => found[0],
                    (_, true) => found[1],
                    _ => std::array::from_fn(|k| 0.5 * (found[0][k] + found[1][k])),
                };
                fits[row * COLUMNS + column] = fit(&Target::new(kernel, cosine, alpha), count, &prior);
            }
        }
        Fits { count, fits }
    }

    /// The look-ups at a view cosine and roughness α, each 0 to 1.
    pub fn at(&self, cos_o: f64, alpha: f64) -> Fitted {
        fitted_of(self.count, &self.between(cos_o, alpha))
    }

    /// Parameters between those of four fits.
    fn between(&self, cos_o: f64, alpha: f64) -> [f64; PARAMETERS] {
        let place = |part: f64, count: usize| part.clamp(0.0, 1.0) * (count - 1) as f64;
        let (u, v) = (
            place((cos_o - LEAST_COSINE) / (1.0 - LEAST_COSINE), COLUMNS),
            place((alpha.sqrt() - LEAST_ROOT) / (1.0 - LEAST_ROOT), ROWS),
        );
        let (i, j) = ((u as usize).min(COLUMNS - 2), (v as usize).min(ROWS - 2));
        let (fu, fv) = (u - i as f64, v - j as f64);
        let mut x = [0.0; PARAMETERS];
        for (column, row, weight) in [
            (i, j, (1.0 - fu) * (1.0 - fv)),
            (i + 1, j, fu * (1.0 - fv)),
            (i, j + 1, (1.0 - fu) * fv),
            (i + 1, j + 1, fu * fv),
        ] {
            x.iter_mut().zip(&self.fits[row * COLUMNS + column]).for_each(|(x, fit)| *x += weight * fit);
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries between four fits are nearly as good as a fit of their own, and more look-ups are nearer to the lobe.
    #[test]
    fn look_ups_go_smoothly_between_fits() {
        for (count, most_left, most_worse) in [(1, 0.6, 0.01), (2, 0.38, 0.25), (3, 0.275, 0.28)] {
            let fits = Fits::new(Kernel::GgxSoft, count);
            let (mut worst, mut left) = (0.0f64, 0.0);
            for (row, column) in (0..ROWS - 1).flat_map(|row| (0..COLUMNS - 1).map(move |column| (row, column))) {
                let (cosine, alpha) = arguments(column as f64 + 0.5, row as f64 + 0.5);
                let target = Target::new(Kernel::GgxSoft, cosine, alpha);
                let of = |count: usize, x: &[f64; PARAMETERS]| square(&target.differences(count, x)).sqrt();
                let between = fits.between(cosine, alpha);
                let mirror = of(1, &[0.0; PARAMETERS]);
                let [found, best] = [between, fit(&target, count, &between)].map(|x| of(count, &x) / mirror);
                worst = worst.max(found - best);
                left += found / ((ROWS - 1) * (COLUMNS - 1)) as f64;
            }
            println!(
                "{count} look-ups leave {left:.3} of what the mirror direction leaves, {worst:.3} more at worst between fits"
            );
            assert!(left <= most_left && worst <= most_worse, "{count} look-ups: {left} {worst}");
        }
    }
}
