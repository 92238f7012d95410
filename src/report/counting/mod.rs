//! Error and cost of counting.
//!
//! Errors come from going through the random words (`counting::quality`), not from drawing; one table draws 10⁷ times as
//! a check.

mod errors;
mod radiance;
mod variants;

use super::document::Document;
use super::settings::Settings;
use super::table::Table;
use crate::exit::Failure;
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use errors::{TRIALS, WORST_COLUMNS, Worst, chances, measure_draw};
use glint_bake_core::counting::eval::count_value;
use glint_bake_core::counting::pow1m::{Elementary, LeastExact, Native, pow1m_with};
use glint_bake_core::counting::reference::ExactBinomial;
use glint_bake_core::rng::{ItemRng, Purpose};
use std::time::Instant;
use variants::{Draw, Variant, variants};

/// Measures the report.
pub fn measure(settings: &Settings) -> Result<Document, Failure> {
    let mut document = Document::new("counting", "Counting: error and cost", settings);
    let mut all = variants();
    document.plot("", "mean, variance and shape by the expected count", &figure(&all, settings.pick(40, 4)));
    by_trials(&mut document, &all[0], &all[1], settings);
    all.truncate(settings.pick(usize::MAX, 3));
    front(&mut document, &all, settings);
    cost(&mut document, &all);
    draws(&mut document, &all[0], &all[1], settings);
    radiance::table(&mut document, settings.pick(2_000_000, 20_000));
    powers(&mut document, settings);
    Ok(document)
}

/// Trials of the grid; every sixth for a quick look.
fn trials(settings: &Settings) -> impl Iterator<Item = f32> {
    TRIALS.into_iter().step_by(settings.pick(1, 6))
}

fn by_trials(document: &mut Document, paper: &Variant, ours: &Variant, settings: &Settings) {
    document.heading(2, "By number of trials");
    document.paragraph(
        "Worst over p from 1e-16 to 1 − 1e-16 with expected counts Np and Nq of at least 1e-7, of the rarer outcome, against \
         the exact distribution. Mean: (E[n] − Np)/σ, and E[n]/Np − 1 where at least 0.01 are expected, as for the variance; \
         core: N ≥ 8 and 0.5 ≤ Np ≤ N − 0.5. 10⁷ draws tell a mean error of 1.3e-3 σ (|z| = 4). Ours gives a count above 2²⁴ in \
         two f32. The paper's has one; they are σ apart when Np is near 1e14, 11 σ at N = 1e16 and p = ½. The paper's \
         columns have p ≤ ½ only: it is given no 1 − p.",
    );
    let mut table = Table::new(0, &format!("N | paper: {WORST_COLUMNS} | ours: {WORST_COLUMNS}"));
    let mut all = Worst::default();
    for n in trials(settings) {
        let mut worst = [Worst::default(); 2];
        for (p, q) in chances(n) {
            for (i, variant) in [paper, ours].into_iter().enumerate() {
                if i == 0 && p > q {
                    continue;
                }
                let (found, exact) = measure_draw(variant, n, p, q);
                worst[i].add(&found, &exact);
                if i == 1 {
                    all.add(&found, &exact);
                }
            }
        }
        let shown = if n >= 1e6 { format!("{n:.0e}") } else { format!("{n}") };
        table.row(format!("{shown} | {} | {}", worst[0].cells(), worst[1].cells()));
    }
    document.table(&table);
    document.paragraph(format!(
        "Ours, N to 1e16: mean within **{:.1e} σ**, variance within **{:.2} %**, W₁/σ at most **{:.3}**.",
        all.mean.abs(),
        100.0 * all.variance.abs(),
        all.wasserstein
    ));
}

/// Least nanoseconds a draw of each variant, over passes that take turns.
fn nanoseconds(all: &[Variant], n: f32, p: f32, q: f32) -> Vec<f64> {
    let mut rng = ItemRng::new(5, Purpose::Test(1), 0);
    let words: Vec<[u32; 2]> = (0..4096).map(|_| [rng.bits(), rng.bits()]).collect();
    let time = |draw: Draw| {
        let start = Instant::now();
        let mut sum = 0.0;
        for word in &words {
            let (n, p, q) = std::hint::black_box((n, p, q));
            let [hits, misses] = draw(n, p, q, *word);
            sum += count_value(hits) - count_value(misses);
        }
        std::hint::black_box(sum);
        start.elapsed().as_secs_f64() * 1e9 / words.len() as f64
    };
    let mut least = vec![f64::MAX; all.len()];
    for _ in 0..24 {
        for (i, variant) in all.iter().enumerate() {
            least[i] = least[i].min(time(variant.draw));
        }
    }
    least
}

/// Places where time is taken: N, and expected counts.
fn timed_places() -> Vec<(f32, f32)> {
    let mut places = vec![(0.3, 0.5), (1.5, 0.2), (3.0, 0.3), (3.0, 0.8)];
    for n in [16.0f32, 300.0, 1e4, 1e8, 1e16] {
        for expected in [0.01, 0.5, 1.5, 3.0, 5.9, 6.2] {
            places.push((n, expected / n));
        }
        places.extend([(n, 0.45), (n, 0.6)]);
    }
    places
}

fn front(document: &mut Document, all: &[Variant], settings: &Settings) {
    document.heading(2, "Variants");
    document.paragraph(format!(
        "Worst over the grid above, N from 2 to 1e6. Cost: nanoseconds a draw on one core over {} places as a ratio to the \
         paper's in the same run, mean and worst place. ★: no other row has both a lower mean cost and a lower worst \
         core variance error. Ours is in the library; the rows below it are in the report's own code and cost a little more. \
         Both ways every time is about what a GPU pays when neighbouring pixels differ.",
        timed_places().len()
    ));
    let mut table = Table::new(1, &format!("variant | {WORST_COLUMNS} | cost | worst cost | "));
    let times: Vec<Vec<f64>> = timed_places().iter().map(|&(n, p)| nanoseconds(all, n, p, 1.0 - p)).collect();
    let mut rows = Vec::new();
    for (i, variant) in all.iter().enumerate() {
        let mut worst = Worst::default();
        for n in trials(settings).filter(|n| (2.0..=1e6).contains(n)) {
            for (p, q) in chances(n).into_iter().filter(|(p, q)| i > 0 || p <= q) {
                let (found, exact) = measure_draw(variant, n, p, q);
                worst.add(&found, &exact);
            }
        }
        let ratios = times.iter().map(|t| t[i] / t[0]);
        let most = ratios.clone().fold(0.0, f64::max);
        let total = |i: usize| times.iter().map(|t| t[i]).sum::<f64>();
        rows.push((total(i) / total(0), most, worst, variant.name));
    }
    for (cost, most, worst, name) in &rows {
        let error = worst.core_variance.abs();
        let beaten = rows.iter().any(|r| {
            let other = r.2.core_variance.abs();
            r.0 <= *cost && other <= error && (r.0 < *cost || other < error)
        });
        table.row(format!("{name} | {} | {cost:.2} | {most:.2} | {}", worst.cells(), if beaten { "" } else { "★" }));
    }
    document.table(&table);
}

fn cost(document: &mut Document, all: &[Variant]) {
    document.heading(2, "Cost by place");
    document.paragraph(
        "Nanoseconds a draw on one core, least of 24 passes over 4096 pairs of words; the paths take turns.",
    );
    let mut table = Table::new(0, "N | Np | paper | ours | ratio");
    for (n, p) in timed_places() {
        let t = nanoseconds(&all[..2], n, p, 1.0 - p);
        let shown = |x: f32, digits: usize| if x < 1e6 { format!("{x:.digits$}") } else { format!("{x:.1e}") };
        table.row(format!("{} | {} | {:.0} | {:.0} | {:.2}", shown(n, 1), shown(n * p, 3), t[0], t[1], t[1] / t[0]));
    }
    document.table(&table);
}

fn draws(document: &mut Document, paper: &Variant, ours: &Variant, settings: &Settings) {
    let count = settings.pick(10_000_000, 100_000u32);
    document.heading(2, "Random draws");
    document.paragraph(format!(
        "z of the mean, and variance over the exact one with its standard error, from {count} random draws each."
    ));
    let mut table = Table::new(0, "N | p | paper: z | paper: variance | ours: z | ours: variance");
    let places = [
        (0.3f32, 0.5f32),
        (1.5, 0.7),
        (2.5, 0.3),
        (3.0, 0.2),
        (8.0, 0.1),
        (8.5, 0.5),
        (13.0, 0.48),
        (16.0, 0.9),
        (64.0, 0.05),
        (1e3, 0.0059),
        (1e3, 0.0061),
        (1e4, 1e-5),
        (1e4, 1.45e-4),
        (1e4, 3e-4),
        (1e4, 0.3),
        (1e4, 0.9995),
        (1e6, 0.5),
        (1e10, 1e-9),
        (1e16, 1e-16),
        (1e16, 8e-16),
        (1e14, 0.3),
        (1e16, 0.5),
    ];
    for (item, (n, p)) in places.into_iter().enumerate() {
        let q = 1.0 - p;
        let exact = ExactBinomial::of_f32(n, p, q);
        let mut row = format!("{n} | {p:e}");
        for variant in [paper, ours] {
            let mut rng = ItemRng::new(31, Purpose::Test(2), item as u32);
            let (mut shift, mut square, mut fourth) = (0.0, 0.0, 0.0);
            for _ in 0..count {
                let d = f64::from((variant.draw)(n, p, q, [rng.bits(), rng.bits()])[0]) - exact.mean();
                shift += d;
                square += d * d;
                fourth += d * d * d * d;
            }
            let c = f64::from(count);
            let (mean, second, fourth) = (shift / c, square / c, fourth / c);
            let z = mean / (exact.variance() / c).sqrt();
            let ratio = (second - mean * mean) / exact.variance();
            let error = ((fourth - second * second).max(0.0) / c).sqrt() / exact.variance();
            row += &format!(" | {z:+.1} | {ratio:.4} ± {error:.4}");
        }
        table.row(row);
    }
    document.table(&table);
}

/// The paper's (1 − cp)^(N/c) through given elementary functions.
fn papers_power(math: &impl Elementary, p: f32, n: f32) -> f32 {
    let c = (2.884_031_5e-4 / p).max(1.0);
    if c * p >= 1.0 { 0.0 } else { math.exp(n / c * math.log(1.0 - c * p)) }
}

fn powers(document: &mut Document, settings: &Settings) {
    document.heading(2, "Powers");
    document.paragraph(
        "Worst |error| of (1 − p)^N in f32 over N from 1 to 1e16 and p from 1e-16 to 1, against f64. Least exact WGSL: log, exp \
         and division off by all that WGSL allows, in the worst combination of directions. p^N is the same with p and q \
         exchanged, and is among the places of the last row.",
    );
    let step = settings.pick(1, 20);
    let mut places = Vec::new();
    for i in (0..=800).step_by(step) {
        let small = libm::exp10(-16.0 + f64::from(i) * 0.019_623) as f32;
        for (p, q) in [(small, 1.0 - small), (1.0 - small, small)] {
            let log = if p <= 0.5 { -libm::log1p(f64::from(-p)) } else { -libm::log(f64::from(q)) };
            for j in (0..=480).step_by(step) {
                let n = (libm::exp10(-3.0 + f64::from(j) / 96.0) / log) as f32;
                if (1.0..=1e16).contains(&n) {
                    places.push((p, q, n, libm::exp(-f64::from(n) * log)));
                }
            }
        }
    }
    let worst = |power: &dyn Fn(f32, f32, f32) -> f32, all: bool| {
        let kept = places.iter().filter(|place| all || place.0 <= 0.5);
        kept.map(|&(p, q, n, exact)| (f64::from(power(p, q, n)) - exact).abs()).fold(0.0, f64::max)
    };
    let least = |power: &dyn Fn(&LeastExact, f32, f32, f32) -> f32, all: bool| {
        LeastExact::all().iter().map(|math| worst(&|p, q, n| power(math, p, q, n), all)).fold(0.0, f64::max)
    };
    let mut table = Table::new(1, "form | this processor | least exact WGSL");
    let naive = |math: &dyn Fn(f32) -> f32, p: f32, n: f32| math(1.0 - p).powf(n);
    table.row(format!("pow(1 − p, N), p ≤ ½ | {:.1e} | ", worst(&|p, _, n| naive(&|x| x, p, n), false)));
    table.row(format!(
        "the paper's, p ≤ ½ | {:.1e} | {:.1e}",
        worst(&|p, _, n| papers_power(&Native, p, n), false),
        least(&|math, p, _, n| papers_power(math, p, n), false)
    ));
    table.row(format!(
        "ours, all p | {:.1e} | {:.1e}",
        worst(&|p, q, n| pow1m_with(&Native, p, q, n), true),
        least(&|math, p, q, n| pow1m_with(math, p, q, n), true)
    ));
    document.table(&table);
}

/// Mean, variance and shape of four draws by the expected count, at N = 10⁴, with so many points a decade.
fn figure(all: &[Variant], points: u32) -> Figure {
    const N: f32 = 1e4;
    const DECADES: u32 = 4;
    let shown = [
        (0, "paper", Colour::Vermilion),
        (3, "moved mean", Colour::Purple),
        (4, "two gates a side", Colour::Green),
        (1, "ours", Colour::Blue),
    ];
    let panel = |title: &str, range, y: &str| Panel {
        title: title.to_owned(),
        x: Axis::logarithmic(y, (0.01, 100.0)),
        y: Axis::linear("", range, 4),
        series: Vec::new(),
    };
    let mut panels = [
        panel("E[n] / Np", (0.95, 1.35), ""),
        panel("variance / Npq", (0.5, 1.5), ""),
        panel("Wasserstein distance / σ", (0.0, 0.5), "expected count Np, N = 10⁴"),
    ];
    for (index, name, colour) in shown {
        let mut curves = [const { Vec::new() }; 3];
        for i in 0..=DECADES * points {
            let expected = 10f64.powf(-2.0 + f64::from(i) / f64::from(points));
            let p = (expected / f64::from(N)) as f32;
            let (found, _) = measure_draw(&all[index], N, p, 1.0 - p);
            let values = [1.0 + found.relative_mean_error, 1.0 + found.variance_error, found.wasserstein];
            for (curve, value) in curves.iter_mut().zip(values) {
                curve.push((expected, value));
            }
        }
        for (panel, curve) in panels.iter_mut().zip(curves) {
            panel.series.push(Series::line(name, colour, curve));
        }
    }
    Figure { title: String::new(), panels: panels.into(), columns: 1, panel_size: (640, 190) }
}
