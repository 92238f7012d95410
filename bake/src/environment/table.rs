//! The table by view angle and roughness, as the section ENAL holds it.

use super::albedo::{Areas, areas};
use super::fitted::{Fits, Fitted};
use super::rounding::{half_bits, indicators};
use glint_formats::environment::Kernel;
use half::f16;
use rayon::prelude::*;

/// Edge of the table.
pub const SIZE: u32 = 64;

/// View cosine of a column and roughness of a row.
fn arguments(column: u32, row: u32) -> (f64, f64) {
    let [u, v] = [column, row].map(|k| (f64::from(k) + 0.5) / f64::from(SIZE));
    (u, v * v)
}

/// Half floats of the table for `look_ups` look-ups of a kernel's maps, layer by layer.
pub fn albedo(kernel: Kernel, look_ups: u32) -> Vec<u16> {
    let fits = Fits::new(kernel, look_ups as usize);
    let entries: Vec<(Areas, Fitted)> = (0..SIZE * SIZE)
        .into_par_iter()
        .map(|k| {
            let (cos_o, alpha) = arguments(k % SIZE, k / SIZE);
            (areas(cos_o, alpha), fits.at(cos_o, alpha))
        })
        .collect();
    let layers = 0..=look_ups as usize;
    layers.flat_map(|layer| entries.iter().flat_map(move |(areas, fitted)| texel(layer, areas, fitted))).collect()
}

/// What a layer holds of an entry.
fn texel(layer: usize, areas: &Areas, fitted: &Fitted) -> [u16; 4] {
    match layer {
        0 => [areas.scale, areas.bias, fitted[0].shift, fitted[0].ratio].map(half_bits),
        1 => {
            let [first, crossed, bias] = areas.dispersion();
            [first, crossed, bias, areas.reflecting / areas.whole].map(half_bits)
        }
        _ => {
            let others: Vec<f64> = fitted[1..].iter().map(|look_up| look_up.share).collect();
            let look_up = &fitted[layer - 1];
            [half_bits(look_up.shift), half_bits(look_up.ratio), indicators(&others)[layer - 2], f16::ZERO.to_bits()]
        }
    }
}
