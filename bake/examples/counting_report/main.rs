//! Error and cost of counting, as markdown on stdout; every number is measured in the run.
//!
//! `counting_report [--svg FILE]` prints the tables and draws mean, variance and shape by the expected count. Errors
//! come from going through the random words (`counting::quality`), not from drawing; one table draws 10⁷ times as a
//! check.

mod plot;
mod radiance;
mod variants;

use glint_bake_core::counting::eval::{FEW, count_value};
use glint_bake_core::counting::pow1m::{Elementary, LeastExact, Native, pow1m_with};
use glint_bake_core::counting::quality::{CountingQuality, SecondWord, compare, outcomes};
use glint_bake_core::counting::reference::ExactBinomial;
use glint_bake_core::rng::{ItemRng, Purpose};
use std::time::Instant;
use variants::{Draw, Variant, variants};

/// Whole-program optimisation of this build, for the timings.
const LTO: &str = match option_env!("CARGO_PROFILE_RELEASE_LTO") {
    Some(lto) => lto,
    None => "as in Cargo.toml",
};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let svg = match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [] => None,
        ["--svg", svg] => Some(svg.to_string()),
        _ => return eprintln!("usage: counting_report [--svg FILE]"),
    };
    println!("# Counting: error and cost\n");
    println!("Written by `just report`; do not edit. The plot is [counting-report.svg](counting-report.svg).");
    if cfg!(debug_assertions) {
        println!("Development build, the library optimised.\n");
    } else {
        println!("Release build, lto {LTO}.\n");
    }
    let all = variants();
    by_trials(&all[0], &all[1]);
    front(&all);
    cost(&all);
    draws(&all[0], &all[1]);
    radiance::table();
    powers();
    if let Some(file) = svg {
        std::fs::write(file, plot::plot(&all)).expect("writing the plot");
    }
}

/// Trials of the grid.
const TRIALS: [f32; 24] = [
    0.01, 0.3, 0.9, 1.0, 1.5, 2.0, 2.5, 3.0, 5.0, 8.0, 8.5, 11.0, 13.0, 16.0, 64.0, 300.0, 1e3, 1e4, 1e6, 1e8, 1e10,
    1e12, 1e14, 1e16,
];

/// (p, q) of the grid for n trials: fixed ones and fixed expected counts, each also exchanged; expected counts from
/// 1e-7.
fn chances(n: f32) -> Vec<(f32, f32)> {
    let mut rare = vec![1e-16, 1e-12, 1e-9, 1e-7, 1e-5, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5];
    for count in
        [1e-6, 1e-3, 0.1, 0.5, 1.0, 1.45, 2.0, 2.1, 3.0, 4.1, 5.1, 0.99 * FEW, 1.01 * FEW, 8.1, 12.1, 20.0, 100.0]
    {
        rare.push(count / n);
    }
    rare.retain(|p| *p <= 0.5 && n * p >= 1e-7);
    rare.into_iter().flat_map(|p| [(p, 1.0 - p), (1.0 - p, p)]).collect()
}

/// Errors of a draw at one place.
pub fn measure(variant: &Variant, n: f32, p: f32, q: f32) -> (CountingQuality, ExactBinomial) {
    let exact = ExactBinomial::of_f32(n, p, q);
    let bisected = variant.whole && exact.variance() < 4e4;
    let second = if bisected { SecondWord::Bisected } else { SecondWord::Shares(1 << 14) };
    (compare(&outcomes(|bits| (variant.draw)(n, p, q, bits), second), &exact), exact)
}

/// Worst figures over places.
#[derive(Clone, Copy, Default)]
struct Worst {
    mean: f64,
    relative_mean: f64,
    variance: f64,
    core_variance: f64,
    wasserstein: f64,
}

impl Worst {
    fn add(&mut self, found: &CountingQuality, exact: &ExactBinomial) {
        let worse = |old: f64, new: f64| if new.abs() > old.abs() { new } else { old };
        let expected = exact.trials * exact.p.min(exact.q);
        self.mean = worse(self.mean, found.mean_error);
        if expected >= 0.01 {
            self.relative_mean = worse(self.relative_mean, found.relative_mean_error);
            self.variance = worse(self.variance, found.variance_error);
        }
        if exact.trials >= 8.0 && expected >= 0.5 {
            self.core_variance = worse(self.core_variance, found.variance_error);
        }
        self.wasserstein = worse(self.wasserstein, found.wasserstein);
    }

    fn cells(&self) -> String {
        format!(
            "{:+.1e} | {:+.2} % | {:+.2} % | {:+.2} % | {:.4}",
            self.mean,
            100.0 * self.relative_mean,
            100.0 * self.variance,
            100.0 * self.core_variance,
            self.wasserstein
        )
    }
}

const WORST_COLUMNS: &str = "mean, σ | mean, relative | variance | variance, core | W₁/σ";

fn by_trials(paper: &Variant, ours: &Variant) {
    println!("## By number of trials\n");
    println!(
        "Worst over p from 1e-16 to 1 − 1e-16 with expected counts Np and Nq of at least 1e-7, of the rarer outcome, against \
         the exact distribution. Mean: (E[n] − Np)/σ, and E[n]/Np − 1 where at least 0.01 are expected, as for the variance; \
         core: N ≥ 8 and 0.5 ≤ Np ≤ N − 0.5. 10⁷ draws tell a mean error of 1.3e-3 σ (|z| = 4). Ours gives a count above 2²⁴ in \
         two f32. The paper's has one; they are σ apart when Np is near 1e14, 11 σ at N = 1e16 and p = ½. The paper's \
         columns have p ≤ ½ only: it is given no 1 − p.\n"
    );
    println!("| N | paper: {WORST_COLUMNS} | ours: {WORST_COLUMNS} |");
    println!("| --: {}|", "| --: ".repeat(10));
    let mut all = Worst::default();
    for n in TRIALS {
        let mut worst = [Worst::default(); 2];
        for (p, q) in chances(n) {
            for (i, variant) in [paper, ours].into_iter().enumerate() {
                if i == 0 && p > q {
                    continue;
                }
                let (found, exact) = measure(variant, n, p, q);
                worst[i].add(&found, &exact);
                if i == 1 {
                    all.add(&found, &exact);
                }
            }
        }
        let shown = if n >= 1e6 { format!("{n:.0e}") } else { format!("{n}") };
        println!("| {shown} | {} | {} |", worst[0].cells(), worst[1].cells());
    }
    println!(
        "\nOurs, N to 1e16: mean within **{:.1e} σ**, variance within **{:.2} %**, W₁/σ at most **{:.3}**.",
        all.mean.abs(),
        100.0 * all.variance.abs(),
        all.wasserstein
    );
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

fn front(all: &[Variant]) {
    println!("\n## Variants\n");
    println!(
        "Worst over the grid above, N from 2 to 1e6. Cost: nanoseconds a draw on one core over {} places as a ratio to the \
         paper's in the same run, mean and worst place. ★: no other row has both a lower mean cost and a lower worst \
         core variance error. Ours is in the library; the rows below it are in the report's own code and cost a little more. \
         Both ways every time is about what a GPU pays when neighbouring pixels differ.\n",
        timed_places().len()
    );
    println!("| variant | {WORST_COLUMNS} | cost | worst cost | |");
    println!("| --- {}| --- |", "| --: ".repeat(7));
    let times: Vec<Vec<f64>> = timed_places().iter().map(|&(n, p)| nanoseconds(all, n, p, 1.0 - p)).collect();
    let mut rows = Vec::new();
    for (i, variant) in all.iter().enumerate() {
        let mut worst = Worst::default();
        for n in TRIALS.into_iter().filter(|n| (2.0..=1e6).contains(n)) {
            for (p, q) in chances(n).into_iter().filter(|(p, q)| i > 0 || p <= q) {
                let (found, exact) = measure(variant, n, p, q);
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
        println!("| {name} | {} | {cost:.2} | {most:.2} | {} |", worst.cells(), if beaten { "" } else { "★" });
    }
}

fn cost(all: &[Variant]) {
    println!("\n## Cost by place\n");
    println!("Nanoseconds a draw on one core, least of 24 passes over 4096 pairs of words; the paths take turns.\n");
    println!("| N | Np | paper | ours | ratio |\n| --: | --: | --: | --: | --: |");
    for (n, p) in timed_places() {
        let t = nanoseconds(&all[..2], n, p, 1.0 - p);
        let shown = |x: f32, digits: usize| if x < 1e6 { format!("{x:.digits$}") } else { format!("{x:.1e}") };
        println!("| {} | {} | {:.0} | {:.0} | {:.2} |", shown(n, 1), shown(n * p, 3), t[0], t[1], t[1] / t[0]);
    }
}

fn draws(paper: &Variant, ours: &Variant) {
    let count = 10_000_000u32;
    println!("\n## Ten million draws\n");
    println!(
        "z of the mean, and variance over the exact one with its standard error, from {count} random draws each.\n"
    );
    println!("| N | p | paper: z | paper: variance | ours: z | ours: variance |");
    println!("| --: | --: | --: | --: | --: | --: |");
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
        let mut row = format!("| {n} | {p:e} |");
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
            row += &format!(" {z:+.1} | {ratio:.4} ± {error:.4} |");
        }
        println!("{row}");
    }
}

/// The paper's (1 − cp)^(N/c) through given elementary functions.
fn papers_power(math: &impl Elementary, p: f32, n: f32) -> f32 {
    let c = (2.884_031_5e-4 / p).max(1.0);
    if c * p >= 1.0 { 0.0 } else { math.exp(n / c * math.log(1.0 - c * p)) }
}

fn powers() {
    println!("\n## Powers\n");
    println!(
        "Worst |error| of (1 − p)^N in f32 over N from 1 to 1e16 and p from 1e-16 to 1, against f64. Least exact WGSL: log, exp \
         and division off by all that WGSL allows, in the worst combination of directions. p^N is the same with p and q \
         exchanged, and is among the places of the last row.\n"
    );
    let mut places = Vec::new();
    for i in 0..=800 {
        let small = libm::exp10(-16.0 + f64::from(i) * 0.019_623) as f32;
        for (p, q) in [(small, 1.0 - small), (1.0 - small, small)] {
            let log = if p <= 0.5 { -libm::log1p(f64::from(-p)) } else { -libm::log(f64::from(q)) };
            for j in 0..=480 {
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
    println!("| form | this processor | least exact WGSL |\n| --- | --: | --: |");
    let naive = |math: &dyn Fn(f32) -> f32, p: f32, n: f32| math(1.0 - p).powf(n);
    println!("| pow(1 − p, N), p ≤ ½ | {:.1e} | |", worst(&|p, _, n| naive(&|x| x, p, n), false));
    println!(
        "| the paper's, p ≤ ½ | {:.1e} | {:.1e} |",
        worst(&|p, _, n| papers_power(&Native, p, n), false),
        least(&|math, p, _, n| papers_power(math, p, n), false)
    );
    println!(
        "| ours, all p | {:.1e} | {:.1e} |",
        worst(&|p, q, n| pow1m_with(&Native, p, q, n), true),
        least(&|math, p, q, n| pow1m_with(math, p, q, n), true)
    );
}
