//! The dictionary and its run time from the definitions, in f64: slow, and sharing nothing with the fast path but the
//! random numbers ([`super::bake::Draws`], [`crate::hash`]) and the options.
//!
//! - A marginal is the sum of its lobes and their mirror images, each an exact Gaussian, cut at the domain and divided by
//!   what is left inside (paper, sections 4.2 to 4.4). Lobe means are quantiles found by bisection.
//! - The slope distribution of a pixel is the sum over all cells of a square around the footprint, whose weights are
//!   taken along the principal axes (Eq. 8 to 12).
//! - GGX's radial map comes from the two radial distribution functions, its Jacobian from a difference quotient.

use super::bake::Draws;
use super::eval::{DictionaryMaterial, TARGET_GGX};
use super::options::DictionaryOptions;
use crate::footprint::PixelOnSurface;
use crate::hash::{cell_state, draw_bits, draw_uniform};
use glam::DVec2;
use std::f64::consts::{PI, SQRT_2};

/// A marginal at one level: the means of its even lobes.
#[derive(Clone, Debug, PartialEq)]
pub struct ExactMarginal {
    lobe_std: f64,
    domain: f64,
    means: Vec<f64>,
    inside: f64,
}

impl ExactMarginal {
    /// Density at slope x, on the whole line; 0 beyond the domain.
    pub fn density(&self, x: f64) -> f64 {
        if x.abs() > self.domain {
            return 0.0;
        }
        let mut sum = 0.0;
        for mean in &self.means {
            sum += 0.5 * (self.lobe(x - mean) + self.lobe(x + mean));
        }
        sum / self.inside
    }

    fn lobe(&self, distance: f64) -> f64 {
        let z = distance / self.lobe_std;
        libm::exp(-0.5 * z * z) / (self.lobe_std * (2.0 * PI).sqrt())
    }
}

/// All marginals of one level. Memory and time grow with 2^level · marginals.
pub fn exact_level(options: &DictionaryOptions, level: u32) -> Vec<ExactMarginal> {
    let mut draws = Draws::new(options.seed, options.marginals);
    let mut means = vec![Vec::new(); options.marginals as usize];
    for lobe in 0..1u32 << level {
        let uniform = draws.lobe(lobe);
        for i in 0..means.len() {
            means[i].push(mean_quantile(options, (f64::from(uniform[i]) + 0.5) / 4_294_967_296.0));
        }
    }
    let mut marginals = Vec::new();
    for list in means {
        let share = |edge: f64| 0.5 * libm::erf(edge / (options.lobe_std * SQRT_2));
        let mut sum = 0.0;
        for mean in &list {
            sum += share(options.domain() - mean) + share(options.domain() + mean);
        }
        marginals.push(ExactMarginal {
            lobe_std: options.lobe_std,
            domain: options.domain(),
            inside: sum,
            means: list,
        });
    }
    marginals
}

/// Lobe mean below which a share `u` of the truncated half Gaussian lies.
pub fn mean_quantile(options: &DictionaryOptions, u: f64) -> f64 {
    let scale = options.mean_variance().sqrt() * SQRT_2;
    let whole = libm::erf(options.domain() / scale);
    let (mut low, mut high) = (0.0, options.domain());
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if libm::erf(middle / scale) < u * whole {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Share of facets whose slope is within r of the mean, in units of the roughness.
fn radial_share(ggx: bool, r: f64) -> f64 {
    if ggx { r * r / (1.0 + r * r) } else { -libm::expm1(-r * r) }
}

/// Beckmann (`ggx` false) or GGX density over slopes, for roughness (α_x, α_y).
pub fn smooth_density(ggx: bool, alpha: DVec2, slope: DVec2) -> f64 {
    let q = (slope / alpha).length_squared();
    let shape = if ggx { (1.0 + q).powi(-2) } else { libm::exp(-q) };
    shape / (PI * alpha.x * alpha.y)
}

/// Radius at which Beckmann of roughness 1 holds the share that GGX of roughness 1 holds within r.
fn beckmann_radius(r: f64) -> f64 {
    libm::sqrt(-libm::log1p(-radial_share(true, r)))
}

/// Slope distribution of a pixel by colour, and its coverage: sum over every cell near the footprint. `tables` holds
/// the stored marginals, row `level · N + marginal`, decoded to f64.
pub fn patch_sdf(
    options: &DictionaryOptions,
    tables: &[Vec<f64>],
    material: &DictionaryMaterial,
    pixel: PixelOnSurface,
    slope: DVec2,
) -> ([f64; 3], f64) {
    let unit = f64::from(1u32 << (options.levels - 1));
    let (dx, dy) = (pixel.d_dx.as_dvec2() * unit, pixel.d_dy.as_dvec2() * unit);
    // Axes of the ellipse that the unit circle of the screen becomes: turn the screen until its images are orthogonal.
    let turn = 0.5 * libm::atan2(2.0 * dx.dot(dy), dx.length_squared() - dy.length_squared());
    let major_axis = dx * libm::cos(turn) + dy * libm::sin(turn);
    let minor_axis = dy * libm::cos(turn) - dx * libm::sin(turn);
    let ratio = f64::from(material.max_anisotropy);
    let major = major_axis.length();
    let minor = minor_axis.length().max(major / ratio);
    let direction = major_axis.normalize_or(DVec2::X);

    // The finer of two levels has cells of one to two pixels.
    let lod = (2.0 * minor).max(1.0).log2();
    let fine = lod.floor();
    let mut sum = [0.0; 3];
    let mut coverage = 0.0;
    for (level, share) in [(fine, 1.0 - (lod - fine)), (fine + 1.0, lod - fine)] {
        let cell = level.exp2();
        let centre = pixel.position.as_dvec2() * unit / cell;
        // A weight of squared radius 2/3 has the variance of a square pixel, an eighth of it.
        let radius = |axis: f64| ((axis / cell).powi(4) * 4.0 / 9.0 + 0.36).powf(0.25);
        let (long, short) = (radius(major), radius(minor));
        let reach = long.ceil() as i64 + 1;
        let (mut level_sum, mut level_coverage, mut total) = ([0.0; 3], 0.0, 0.0);
        for j in -reach..=reach {
            for i in -reach..=reach {
                let index = (centre.floor().x as i64 + i, centre.floor().y as i64 + j);
                let offset = DVec2::new(index.0 as f64 + 0.5, index.1 as f64 + 0.5) - centre;
                let along = offset.dot(direction) / long;
                let across = offset.perp_dot(direction) / short;
                let weight = (1.0 - along * along - across * across).max(0.0).powi(2);
                if weight == 0.0 {
                    continue;
                }
                let first = ((index.0 << level as i64) as u32, (index.1 << level as i64) as u32);
                let facets = f64::from(material.density) * (cell / unit).powi(2);
                if let Some(value) = cell_density(options, tables, material, first, facets, slope) {
                    for c in 0..3 {
                        level_sum[c] += weight * value[c];
                    }
                    level_coverage += weight;
                }
                total += weight;
            }
        }
        for c in 0..3 {
            sum[c] += share * level_sum[c] / total;
        }
        coverage += share * level_coverage / total;
    }
    (sum, coverage)
}

/// Density of one cell by colour (algorithm 3, transforms in the order that converges); none if the cell has no glints.
fn cell_density(
    options: &DictionaryOptions,
    tables: &[Vec<f64>],
    material: &DictionaryMaterial,
    cell: (u32, u32),
    facets: f64,
    slope: DVec2,
) -> Option<[f64; 3]> {
    let state = cell_state(cell.0, cell.1, material.seed);
    let uniform = |draw: u32| f64::from(draw_uniform(state, draw));
    if uniform(0) >= f64::from(material.relative_area) {
        return None;
    }
    let normal = (-2.0 * (1.0 - uniform(1)).ln()).sqrt() * (2.0 * PI * uniform(2)).cos();
    let wished = facets.max(1e-300).log2() / 2.0 + f64::from(material.density_randomisation) * normal;
    let level = (wished + 0.5).floor().clamp(0.0, f64::from(options.levels)) as u32;
    let alpha = material.alpha.as_dvec2();
    let ggx = material.normal_target == TARGET_GGX;
    let mean = material.mean_colour.as_dvec3();
    if level == options.levels {
        return Some((mean * smooth_density(ggx, alpha, slope)).to_array());
    }

    let isotropic = slope / alpha;
    let r = isotropic.length();
    let (mut radius, mut jacobian) = (r, 1.0);
    if ggx {
        let step = 1e-4 * r.max(1e-3);
        radius = beckmann_radius(r);
        let rise = beckmann_radius(r + step).powi(2) - beckmann_radius((r - step).abs()).powi(2);
        jacobian = rise / ((r + step).powi(2) - (r - step).powi(2));
    }
    // An eighth of a turn either way.
    let share = f64::from(state.a >> 8) / f64::from(1 << 24);
    let turned = DVec2::from_angle(PI * (0.25 - 0.5 * share)).rotate(isotropic.normalize_or_zero() * radius);
    let at = turned * options.alpha_dict;
    let pick = |half: u32| ((u64::from(half) * u64::from(options.marginals)) >> 16) as u32;
    let row = |marginal: u32| &tables[(level * options.marginals + marginal) as usize];
    let density = filtered(options, row(pick(state.b >> 16)), at.x.abs())
        * filtered(options, row(pick(state.b & 0xffff)), at.y.abs());
    let density = density * jacobian * options.alpha_dict.powi(2) / (alpha.x * alpha.y);

    let mut colour = mean;
    if material.colours.is_empty() {
        colour = glam::DVec3::ONE;
    } else {
        let count = material.colours.len() as u64;
        let own = material.colours[((u64::from(draw_bits(state, 3) >> 16) * count) >> 16) as usize].as_dvec3();
        let lobes = 4f64.powi(level as i32 + 1);
        let lobe_area = 4.0 * PI * options.lobe_std.powi(2);
        let lit = lobes * lobe_area * smooth_density(false, DVec2::splat(options.alpha_dict), at);
        colour += (own - mean) / lit.max(1.0).sqrt();
    }
    Some((colour * density).to_array())
}

/// A stored table with linear filtering: the tents of the entries, those of the first and last reaching to the ends.
fn filtered(options: &DictionaryOptions, table: &[f64], x: f64) -> f64 {
    let h = options.spacing();
    if x >= options.domain() {
        return 0.0;
    }
    if x <= 0.5 * h {
        return table[0];
    }
    if x >= options.domain() - 0.5 * h {
        return table[table.len() - 1];
    }
    let mut sum = 0.0;
    for b in 0..table.len() {
        let distance = (x / h - (b as f64 + 0.5)).abs();
        sum += (1.0 - distance).max(0.0) * table[b];
    }
    sum
}
