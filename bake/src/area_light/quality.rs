//! How good tables are, and how near highlights come to the reference.

use super::fit::{DiskSet, Inverse, Target};
use super::tables::{LtcTables, SIZE, alpha_of, cosine_of};
use crate::quality::metrics::Summary;
use half::f16;
use rayon::prelude::*;

/// ∫ |magnitude · LTC − GGX| / ∫ GGX of every entry but those of roughness 0, by a quadrature sixteen times as fine as the
/// fit's.
pub fn table_error(tables: &LtcTables) -> Summary {
    let set = DiskSet::new(96, 64);
    let error = |at: usize| {
        let target = Target::new(cosine_of(at / SIZE), alpha_of(at % SIZE), &set);
        let [a, c, b, d] = tables.inverse[at].map(|bits| f16::from_bits(bits).to_f64());
        let magnitude = f16::from_bits(tables.terms[at][0]).to_f64();
        target.l1_scaled(&Inverse { entries: [a, b, c, d] }, magnitude / target.magnitude)
    };
    Summary::of((0..SIZE * SIZE).into_par_iter().filter(|at| at % SIZE > 0).map(error).collect())
}
