//! Mean and variance of Σ L_k n_k, the radiance of glints, for K log-uniform levels: ours and the paper's tree against
//! the multinomial's own moments.

use crate::report::document::Document;
use crate::report::table::Table;
use glint_bake_core::counting::eval::{count_value, unit_from_bits};
use glint_bake_core::counting::{MAX_LEVELS, multinomial, paper};
use glint_bake_core::rng::{ItemRng, Purpose};
use std::time::Instant;

/// Radiances of K levels from 1 to 10⁴ and chances that fall as L^−0.9; half of the facets see level 0, which is black.
fn levels(count: usize) -> ([f32; MAX_LEVELS], [f32; MAX_LEVELS]) {
    let (mut radiance, mut weight) = ([0.0; MAX_LEVELS], [0.0; MAX_LEVELS]);
    let mut sum = 0.0;
    for k in 1..count {
        radiance[k] = 10f32.powf(4.0 * k as f32 / (count - 1) as f32);
        weight[k] = radiance[k].powf(-0.9);
        sum += weight[k];
    }
    weight[0] = sum.max(1.0);
    if count == 1 {
        radiance[0] = 1.0;
    }
    (radiance, weight)
}

/// Adds the table, of so many draws.
pub fn table(document: &mut Document, draws: u32) {
    document.heading(2, "Radiance of glints");
    document.paragraph(format!(
        "Σ L_k n_k of K levels, L from 0 and 10^(4/(K − 1)) to 10⁴, chances falling as L^−0.9, half of the facets black. Mean and \
         variance over the multinomial's, from {draws} draws; ± is one standard error of ours. Nanoseconds for one draw of all K."
    ));
    let mut table = Table::new(
        0,
        "K | N | paper: mean | ours: mean | ± | paper: variance | ours: variance | ± | paper ns | ours ns",
    );
    for count in [1, 2, 4, 8, 16] {
        let (radiance, weight) = levels(count);
        let total: f64 = weight.iter().map(|w| f64::from(*w)).sum();
        let moment = |power: i32| {
            (0..count).map(|k| f64::from(weight[k]) / total * f64::from(radiance[k]).powi(power)).sum::<f64>()
        };
        for (item, n) in [0.2f32, 2.5, 50.0, 1e4, 1e7].into_iter().enumerate() {
            let (trials, fraction) = (f64::from(n), f64::from(n.fract()));
            let mean = trials * moment(1);
            let variance =
                trials * (moment(2) - moment(1) * moment(1)) + fraction * (1.0 - fraction) * moment(1) * moment(1);
            let run = |ours: bool| {
                let mut rng = ItemRng::new(41, Purpose::Test(ours.into()), item as u32);
                let (mut shift, mut square, mut fourth) = (0.0, 0.0, 0.0);
                for _ in 0..draws {
                    let counts = if ours {
                        let words = std::array::from_fn(|_| unit_from_bits(rng.bits()));
                        multinomial(n, &weight, count, &words).map(count_value)
                    } else {
                        let bits: [u32; 2 * MAX_LEVELS] = std::array::from_fn(|_| rng.bits());
                        paper::multinomial(n, &weight, count, &bits)
                    };
                    let light: f64 = (0..count).map(|k| f64::from(radiance[k]) * f64::from(counts[k])).sum();
                    let d = light - mean;
                    shift += d;
                    square += d * d;
                    fourth += d * d * d * d;
                }
                let c = f64::from(draws);
                let (shift, square) = (shift / c, square / c);
                let error = ((fourth / c - square * square).max(0.0) / c).sqrt();
                [shift / mean + 1.0, (square / c).sqrt() / mean, square - shift * shift, error]
            };
            let (theirs, ours) = (run(false), run(true));
            let ratio = |x: f64| if variance > 0.0 { format!("{:.3}", x / variance) } else { format!("{x:.1e} / 0") };
            table.row(format!(
                "{count} | {n} | {:.3} | {:.3} | {:.3} | {} | {} | {} | {:.0} | {:.0}",
                theirs[0],
                ours[0],
                ours[1],
                ratio(theirs[2]),
                ratio(ours[2]),
                if variance > 0.0 { format!("{:.3}", ours[3] / variance) } else { String::new() },
                nanoseconds(|rng| rng.bits(), |bits| paper::multinomial(n, &weight, count, bits)),
                nanoseconds(|rng| unit_from_bits(rng.bits()), |words| multinomial(n, &weight, count, words))
            ));
        }
    }
    document.table(&table);
}

/// Least nanoseconds a draw over passes; `word` makes one of the random words that it reads.
fn nanoseconds<W, C, const WORDS: usize>(
    word: impl Fn(&mut ItemRng) -> W,
    draw: impl Fn(&[W; WORDS]) -> [C; MAX_LEVELS],
) -> f64 {
    let mut rng = ItemRng::new(5, Purpose::Test(3), 0);
    let words: Vec<[W; WORDS]> = (0..1024).map(|_| std::array::from_fn(|_| word(&mut rng))).collect();
    let mut least = f64::MAX;
    for _ in 0..12 {
        let start = Instant::now();
        for word in &words {
            std::hint::black_box(draw(std::hint::black_box(word)));
        }
        least = least.min(start.elapsed().as_secs_f64() * 1e9 / words.len() as f64);
    }
    least
}
