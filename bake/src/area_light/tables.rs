//! The LTC tables: M⁻¹, magnitude, Fresnel term and clipped form factor, in the layout that engines know.
//!
//! Heitz et al. 2016 and Heitz and Hill 2016. Texel (i, j) of [`SIZE`]² stands for roughness α = (i / 63)² and view
//! cosine 1 − (j / 63)². The first texture holds a, c, b, d of M⁻¹ = [[a, 0, b], [0, 1, 0], [c, 0, d]] (column by
//! column), the second magnitude, Fresnel term, 0, and the clipped form factor of a sphere.

use super::fit::{DiskSet, Target, fit};
use glam::{DMat3, DVec3};
use half::f16;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Texels along both edges.
pub const SIZE: usize = 64;
/// Least roughness that is fitted; row 0 stands for it.
pub const MIN_ALPHA: f64 = 1e-5;
/// Least view cosine that is fitted; the last row stands for it.
pub const MIN_COSINE: f64 = 1e-3;

/// Both tables as half floats.
#[derive(Clone, Debug, PartialEq)]
pub struct LtcTables {
    /// Entries a, c, b, d of M⁻¹; row j is a view cosine, column i a roughness.
    pub inverse: Vec<[u16; 4]>,
    /// Magnitude, Fresnel term, 0, clipped form factor over its unclipped one.
    pub terms: Vec<[u16; 4]>,
}

/// The tables of [`fit_tables`], as `cargo run --release -p glint-bake-core --example fit_ltc_tables` wrote them. They
/// depend on nothing that a user gives, so fitting them in every bake would only cost seconds; a test fits them anew.
static BUILT_IN: &[u8; 2 * 8 * SIZE * SIZE] = include_bytes!("ltc_tables.bin");

/// Mean, over the entries of the built-in tables but the column of roughness 0, of ∫ |LTC − GGX| / ∫ GGX; the generator
/// prints it and a test measures it anew.
pub const TABLE_MEAN_ERROR: f64 = 0.0754;

impl LtcTables {
    /// The tables that come with the program.
    pub fn built_in() -> LtcTables {
        let texel = |b: &[u8]| std::array::from_fn(|k| u16::from_le_bytes([b[2 * k], b[2 * k + 1]]));
        let (inverse, terms) = BUILT_IN.split_at(8 * SIZE * SIZE);
        LtcTables {
            inverse: inverse.chunks_exact(8).map(texel).collect(),
            terms: terms.chunks_exact(8).map(texel).collect(),
        }
    }

    /// Bytes of both tables, the inverse matrices first.
    pub fn to_bytes(&self) -> Vec<u8> {
        let both = self.inverse.as_flattened().iter().chain(self.terms.as_flattened());
        both.flat_map(|bits| bits.to_le_bytes()).collect()
    }
}

/// Roughness of column i.
pub fn alpha_of(i: usize) -> f64 {
    let x = i as f64 / (SIZE - 1) as f64;
    (x * x).max(MIN_ALPHA)
}

/// View cosine of row j.
pub fn cosine_of(j: usize) -> f64 {
    let y = j as f64 / (SIZE - 1) as f64;
    (1.0 - y * y).max(MIN_COSINE)
}

/// Fits all entries. The same bits on every platform and for any number of threads.
pub fn fit_tables() -> LtcTables {
    let coarse = DiskSet::new(24, 16);
    // Many rings: lights below the horizon begin somewhere in the tail, and the magnitude is what lies before.
    let fine = DiskSet::new(384, 24);
    let columns: Vec<Vec<[[u16; 4]; 2]>> =
        (0..SIZE).into_par_iter().map(|i| fit_column(alpha_of(i), &coarse, &fine)).collect();
    let mut tables = LtcTables { inverse: Vec::new(), terms: Vec::new() };
    for j in 0..SIZE {
        for i in 0..SIZE {
            let [inverse, mut terms] = columns[i][j];
            terms[3] = half(clipped_sphere(i as f64 / (SIZE - 1) as f64 * 2.0 - 1.0, j as f64 / (SIZE - 1) as f64));
            tables.inverse.push(inverse);
            tables.terms.push(terms);
        }
    }
    tables
}

/// All view cosines of one roughness, each from the fit before.
fn fit_column(alpha: f64, coarse: &DiskSet, fine: &DiskSet) -> Vec<[[u16; 4]; 2]> {
    let mut shape = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 2.0 * alpha));
    let mut column = Vec::with_capacity(SIZE);
    for j in 0..SIZE {
        let cosine = cosine_of(j);
        let (inverse, next) = fit(&Target::new(cosine, alpha, coarse), shape, j == 0);
        shape = next;
        let exact = Target::new(cosine, alpha, fine);
        let [a, b, c, d] = inverse.entries;
        column.push([[half(a), half(c), half(b), half(d)], [half(exact.magnitude), half(exact.fresnel), 0, 0]]);
    }
    column
}

fn half(value: f64) -> u16 {
    f16::from_f32(value as f32).to_bits()
}

/// Form factor of a sphere cut by the horizon, over that of the whole one: `cosine` of its centre, and its unclipped
/// form factor seen head-on, sin² of its angular radius.
///
/// Lambert's formula for the part of the cap's edge above the horizon, from −φ₀ to φ₀, and the arc of the horizon that
/// closes it: F = (φ₀ z sin²σ − sinσ cosσ √(1−z²) sinφ₀ + ψ₀) / π.
pub fn clipped_sphere(cosine: f64, form_factor: f64) -> f64 {
    let z = cosine.clamp(-1.0, 1.0);
    let form_factor = form_factor.clamp(1e-6, 1.0);
    let sin = form_factor.sqrt();
    let cos = (1.0 - form_factor).max(0.0).sqrt();
    let w = (1.0 - z * z).max(0.0).sqrt();
    let edge = cos * z;
    if edge >= sin * w && z > 0.0 {
        return z;
    }
    if -edge >= sin * w {
        return 0.0;
    }
    let cos_phi = (-edge / (sin * w)).clamp(-1.0, 1.0);
    let phi = libm::acos(cos_phi);
    let sin_phi = (1.0 - cos_phi * cos_phi).max(0.0).sqrt();
    let psi = libm::atan2(sin * sin_phi, cos * w - sin * cos_phi * z);
    let found = (phi * z * form_factor - sin * cos * w * sin_phi + psi) / PI;
    (found / form_factor).clamp(0.0, 1.0)
}
