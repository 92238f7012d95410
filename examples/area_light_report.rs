//! Highlights of rectangle lights over distance, as markdown on stdout; every number is measured in the run.
//!
//! `area_light_report DATA [--svg FILE]` reads the real maps in `DATA/normals`, prints the tables and draws error over
//! distance. `just report` runs it.

use glam::{DVec2, Vec2};
use glint_bake::input::{InputOptions, load_normal_map};
use glint_bake_core::area_light::bake::mip_chain;
use glint_bake_core::area_light::baked::Tables;
use glint_bake_core::area_light::baked::decode_tables;
use glint_bake_core::area_light::eval::{self, LOBES, surface_radiance};
use glint_bake_core::area_light::paper::{paper_convolution, paper_meso_alpha};
use glint_bake_core::area_light::quality::*;
use glint_bake_core::area_light::rect::isotropic_radiance;
use glint_bake_core::area_light::reference::{Scene, facet_radiance, footprint_normals, footprint_radiance, lift};
use glint_bake_core::area_light::reference::{convolved_alpha, deficit};
use glint_bake_core::area_light::spread::convolve_alpha;
use glint_bake_core::area_light::spread::{alpha_from_deficit, deficit_from_alpha};
use glint_bake_core::area_light::{AreaLightOptions, pack};
use glint_bake_core::area_light::{baked::LtcTables, fit::fit_tables};
use glint_bake_core::area_light::{baked::Maps, eval::fetch};
use glint_bake_core::footprint::Footprint;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_formats::area_light::NormalStorage;
use std::fmt::Write;
use std::path::Path;

/// The maps, by what they show.
const MAPS: [(&str, &str); 5] = [
    ("brushed", "brushed_aluminium_godot_745.png"),
    ("scratched", "scratched_gold_cgbookcase_rgba.png"),
    ("leather", "leather_008_3dtextures.jpg"),
    ("wicker", "wicker_khronos_512.png"),
    ("diamond plate", "diamond_plate_pmndrs0008.jpg"),
];
/// Base roughness of the scenes.
const ALPHAS: [f64; 2] = [0.05, 0.15];
/// Places at each size of footprint: small ones see less of a map each, and cost less.
fn places(footprint_texels: f64) -> u32 {
    (8192.0 / footprint_texels).clamp(256.0, 4096.0) as u32
}
/// Points along an edge of the grids that the reference is tabulated on.
const GRID: usize = 201;

/// Whole-program optimisation of this build, for the timings.
const LTO: &str = match option_env!("CARGO_PROFILE_RELEASE_LTO") {
    Some(lto) => lto,
    None => "as in Cargo.toml",
};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [data] => report(Path::new(data), None),
        [data, "--svg", svg] => report(Path::new(data), Some(svg)),
        _ => {
            eprintln!("usage: area_light_report DATA [--svg FILE]");
            std::process::exit(2);
        }
    }
}

fn report(data: &Path, svg: Option<&str>) {
    println!("# Area lights: error over distance\n");
    println!("Written by `just report`; do not edit. The plot is [area-light-report.svg](area-light-report.svg).");
    if cfg!(debug_assertions) {
        println!("Development build, the library optimised.\n");
    } else {
        println!("Release build, lto {LTO}.\n");
    }
    let tables = decode_tables(&LtcTables::built_in());
    lobes();
    table_quality();
    let scenes: Vec<(Scene, RadianceGrid)> = ALPHAS
        .into_iter()
        .flat_map(scenes)
        .map(|scene| {
            let grid = RadianceGrid::new(&scene, GRID, 1e-3);
            (scene, grid)
        })
        .collect();
    single_facets(&tables, &scenes);
    let mut all = Vec::new();
    println!("\n## Highlights over distance\n");
    println!(
        "Root mean square error of radiance, relative to the root mean square of the reference, over {} scenes and 4096 (footprints of 1 \
         and 2 texels) to 256 (from 32 on) places spread evenly over the map (base α {} and {}; view {:?} rad from the normal; square lights 0, 0.15, 0.3 and 0.5 from the mirror \
         direction, 0.2 or 0.5 wide at distance 1). A footprint of s texels is a Gaussian of deviation s/2. *plain*: mipmapped \
         normals and the base roughness; *paper*: Eq. 5 and 7; *length*: exact inverse of the length of the mean normal and our \
         convolution; *isotropic*: ours; *one lobe* and *anisotropic*: ours with roughness by direction, one stretched lobe or \
         {LOBES}. All use the same LTC tables and, but *isotropic* and after, the same length. \
         After ±: one standard error, as places differ. Few places make most of the error of a map with deep relief: with \
         16 of them, ratios under small footprints are uncertain by a tenth.",
        scenes.len(),
        ALPHAS[0],
        ALPHAS[1],
        VIEW_ANGLES
    );
    for (name, file) in MAPS {
        let path = data.join("normals").join(file);
        let options = InputOptions { assume_linear: true, ..InputOptions::default() };
        let map = load_normal_map(&path, &options).unwrap_or_else(|e| panic!("{e}")).map;
        let rows = distances(name, &map, &tables, &scenes);
        if name == "wicker" {
            checks_of_grid(&map, &scenes);
        }
        all.push((name, rows));
    }
    summary(&all);
    if let Some(file) = svg {
        std::fs::write(file, plot(&all)).expect("writing the plot");
    }
}

/// Closed forms and fits against integrals, with the paper's beside them.
fn lobes() {
    println!("## Lobes of normals\n");
    println!(
        "Roughness from the length of the mean normal, and the convolution of two lobes, against f64 integrals.\n"
    );
    println!(
        "| α | 1 − R | closed form, relative | inverse, relative | f32 inverse, relative | paper's Eq. 5, relative |"
    );
    println!("| --: | --: | --: | --: | --: | --: |");
    for alpha in [0.001, 0.01, 0.028, 0.1, 0.3, 0.6, 0.99] {
        let exact = deficit(alpha, 4000);
        let single = f64::from(eval::alpha_from_deficit(exact as f32));
        println!(
            "| {alpha} | {exact:.4e} | {:.1e} | {:.1e} | {:.1e} | {:+.1} % |",
            (deficit_from_alpha(alpha) / exact - 1.0).abs(),
            (alpha_from_deficit(exact) / alpha - 1.0).abs(),
            (single / alpha - 1.0).abs(),
            100.0 * (paper_meso_alpha(1.0 - exact) / alpha - 1.0)
        );
    }
    let (mut ours, mut paper): (f64, f64) = (0.0, 0.0);
    for i in 0..16 {
        for j in 0..=i {
            let (a, b) = ((f64::from(i) + 0.5) / 16.0, (f64::from(j) + 0.5) / 16.0);
            let exact = convolved_alpha(a, b);
            ours = ours.max((convolve_alpha(a, b) / exact - 1.0).abs());
            for found in [paper_convolution(a, b), paper_convolution(b, a)] {
                paper = paper.max((found / exact - 1.0).abs());
            }
        }
    }
    println!(
        "\nConvolution over a grid of 16² in (0, 1)², against the nearest lobe (least squares over the sphere, α at most 1): \
         worst {:.2} % ours, {:.1} % the paper's Eq. 7.",
        100.0 * ours,
        100.0 * paper
    );
}

fn table_quality() {
    let start = cpu_seconds();
    let fitted = fit_tables();
    let seconds = cpu_seconds() - start;
    let same = fitted == LtcTables::built_in();
    let error = table_error(&fitted);
    println!("\n## LTC tables\n");
    println!(
        "Fitted in {seconds:.1} CPU-seconds; {} the built-in ones. ∫ |LTC − GGX| / ∫ GGX over 64 × 63 entries (all but \
         roughness 0), half floats, a quadrature twenty times as fine as the fit's: mean **{:.4}**, 95th percentile {:.4}, \
         worst {:.4}.",
        if same { "the same bytes as" } else { "NOT the bytes of" },
        error.mean,
        error.p95,
        error.worst
    );
}

/// One facet, so that only the LTC differs from the reference.
fn single_facets(tables: &Tables, scenes: &[(Scene, RadianceGrid)]) {
    let (mut errors, mut power) = (0.0, 0.0);
    for (scene, _) in scenes {
        for s in [DVec2::ZERO, DVec2::new(0.2, 0.1), DVec2::new(-0.1, 0.3)] {
            let exact = facet_radiance(scene, lift(s), 1e-5);
            let found = isotropic_radiance(
                tables,
                lift(s).as_vec3(),
                scene.alpha as f32,
                scene.view.as_vec3(),
                scene.f0 as f32,
                &rect_light(scene),
            );
            errors += (f64::from(found) - exact).powi(2);
            power += exact * exact;
        }
    }
    println!(
        "\nUnder the scenes below, three flat surfaces each: RMSE {:.2} % of the reference. It is what remains at distance 0.",
        100.0 * (errors / power).sqrt()
    );
}

/// How exact the tabulated reference is.
fn checks_of_grid(map: &NormalMap, scenes: &[(Scene, RadianceGrid)]) {
    let (mut errors, mut power) = (0.0, 0.0);
    for (k, (scene, grid)) in scenes.iter().enumerate().step_by(5) {
        let footprint = Footprint::new(DVec2::new(37.0 * k as f64, 100.3), 0.5, 1.0, 0.0);
        let exact = footprint_radiance(map, &footprint, scene, 1e-4);
        let found = grid.mean(&grid_weights(&footprint_normals(map, &footprint, 4.0, 256), grid.size()));
        errors += (found - exact).powi(2);
        power += exact * exact;
    }
    println!(
        "\nThe reference is tabulated over normals; against direct quadrature, facet by facet, it is off by {:.3} % (RMSE, \
         footprints of one texel of this map).",
        100.0 * (errors / power).sqrt()
    );
}

fn distances(name: &str, map: &NormalMap, tables: &Tables, scenes: &[(Scene, RadianceGrid)]) -> Vec<HighlightError> {
    let start = cpu_seconds();
    let levels = mip_chain(map, &Silent);
    let pack_as = |storage| pack(map, &levels, &AreaLightOptions { storage, anisotropic: true, ..Default::default() });
    let material = pack_as(NormalStorage::F16);
    let seconds = cpu_seconds() - start;
    let small = pack_as(NormalStorage::Snorm8);
    let (maps, maps8) = (Maps::new(&material), Maps::new(&small));
    println!("\n### {name}\n");
    println!(
        "{} × {} texels, baked in {seconds:.1} CPU-seconds. Isotropic {:.0} KiB as f16, {:.0} KiB as snorm8; anisotropic twice that; \
         plus 64 KiB of LTC tables. A query, in processor time: {}.\n",
        map.width,
        map.height,
        material.normals.len() as f64 / 1024.0,
        small.normals.len() as f64 / 1024.0,
        query_times(&maps, tables, scenes)
    );
    println!(
        "| texels | reference | {} | iso / plain | iso / paper | aniso / paper | iso / aniso | iso snorm8 | aniso snorm8 |",
        METHODS.join(" | ")
    );
    println!("| --: {}", "| --: ".repeat(METHODS.len() + 7) + "|");
    let mut rows = Vec::new();
    for power in 0..=8 {
        let size = f64::from(1 << power);
        let over = Comparison { scenes, places: places(size), lobes: LOBES, seed: 1 };
        let row = highlight_error(map, &maps, tables, size, &over);
        // The smaller format at two distances: it takes as long as the larger.
        let row8 = [4.0, 32.0].contains(&size).then(|| highlight_error(map, &maps8, tables, size, &over).rmse);
        let of8 = |method: usize| row8.map_or(String::new(), |rmse| format!("{:.3}", rmse[method]));
        let to_paper = |k: usize| format!("{:.3} ± {:.3}", row.to_paper[k], row.to_paper_error[k]);
        let e = row.rmse;
        println!(
            "| {size} | {:.4} | {} | {:.2} | {} | {} | {:.2} | {} | {} |",
            row.reference,
            e.map(|v| format!("{v:.3}")).join(" | "),
            e[3] / e[0],
            to_paper(3),
            to_paper(5),
            e[3] / e[5],
            of8(3),
            of8(5)
        );
        rows.push(row);
    }
    rows
}

/// User and system seconds of this process.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace();
    fields.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// Nanoseconds that this thread has run.
fn thread_nanoseconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    stat.split_whitespace().next().and_then(|first| first.parse().ok()).unwrap_or(f64::NAN)
}

/// Least processor time of three passes over random pixels, by number of lobes.
fn query_times(maps: &Maps<'_>, tables: &Tables, scenes: &[(Scene, RadianceGrid)]) -> String {
    let mut parts = Vec::new();
    for (lobes, name) in [(0, "isotropic"), (1, "one lobe"), (LOBES, "anisotropic")] {
        let mut least = f64::MAX;
        let mut sum = 0.0;
        for _ in 0..3 {
            let start = thread_nanoseconds();
            for k in 0..20_000u32 {
                let scene = &scenes[k as usize % scenes.len()].0;
                let at = Vec2::new((k * 7919 % 10_007) as f32, (k * 104_729 % 10_009) as f32);
                let surface = fetch(maps, at, (1 << (k % 9)) as f32);
                let light = rect_light(scene);
                sum += surface_radiance(tables, &surface, 0.1, scene.view.as_vec3(), 0.9, &light, lobes);
            }
            least = least.min(thread_nanoseconds() - start);
        }
        assert!(sum > 0.0);
        parts.push(format!("{name} {:.0} ns", least / 20_000.0));
    }
    parts.join(", ")
}

fn summary(all: &[(&str, Vec<HighlightError>)]) {
    println!("\n## Summary\n");
    let far: Vec<&HighlightError> =
        all.iter().flat_map(|(_, rows)| rows).filter(|r| r.footprint_texels >= 4.0).collect();
    let ratio = |over: usize, of: usize, rows: &[&HighlightError]| -> (f64, f64) {
        let ratios: Vec<f64> = rows.iter().map(|r| r.rmse[of] / r.rmse[over]).collect();
        (ratios.iter().sum::<f64>() / ratios.len() as f64, ratios.iter().copied().fold(0.0, f64::max))
    };
    let every: Vec<&HighlightError> = all.iter().flat_map(|(_, rows)| rows).collect();
    for (method, name) in [(3, "isotropic"), (5, "anisotropic")] {
        let (mean, worst) = ratio(0, method, &far);
        let (to_paper, worst_to_paper) = ratio(1, method, &every);
        println!(
            "- *{name}*: from 4 texels on {mean:.3} of plain's error on average, {worst:.3} at the worst; of the paper's, at all \
             sizes, {to_paper:.3} on average, {worst_to_paper:.3} at the worst."
        );
    }
    for (name, rows) in all {
        let rows: Vec<&HighlightError> = rows.iter().filter(|r| r.footprint_texels >= 4.0).collect();
        let factor = rows.iter().map(|r| r.rmse[3] / r.rmse[5]).sum::<f64>() / rows.len() as f64;
        println!("- {name}: anisotropic better than isotropic by a factor of {factor:.2}, from 4 texels on.");
    }
}

/// Error over distance, a panel a map.
fn plot(all: &[(&str, Vec<HighlightError>)]) -> String {
    let (width, height, left, top) = (250.0, 240.0, 44.0, 26.0);
    let colours = ["#888", "#d60", "#c9a", "#06c", "#6c6", "#080"];
    let total = width * all.len() as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {total} {}\" font-family=\"sans-serif\" font-size=\"10\">\n",
        height + 24.0
    );
    for (panel, (name, rows)) in all.iter().enumerate() {
        let x0 = panel as f64 * width + left;
        let x = |row: &HighlightError| x0 + row.footprint_texels.log2() * (width - left - 12.0) / 8.0;
        // Logarithmic from 0.01 to 3.
        let y = |value: f64| top + (height - top - 30.0) * (1.0 - (value.clamp(0.01, 3.0) / 0.01).ln() / 300f64.ln());
        let _ = writeln!(svg, "<text x=\"{x0}\" y=\"14\" font-weight=\"bold\">{name}</text>");
        for value in [0.01, 0.03, 0.1, 0.3, 1.0, 3.0] {
            let at = y(value);
            let _ = writeln!(svg, "<path d=\"M{x0} {at:.1}h{:.0}\" stroke=\"#ddd\"/>", width - left - 12.0);
            let _ =
                writeln!(svg, "<text x=\"{:.0}\" y=\"{:.1}\" text-anchor=\"end\">{value}</text>", x0 - 4.0, at + 3.0);
        }
        for row in rows.iter().step_by(2) {
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.0}\" text-anchor=\"middle\">{}</text>",
                x(row),
                height - 14.0,
                row.footprint_texels
            );
        }
        for (k, colour) in colours.iter().enumerate() {
            let points: Vec<String> = rows.iter().map(|r| format!("{:.1},{:.1}", x(r), y(r.rmse[k]))).collect();
            let _ = writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"/>",
                points.join(" ")
            );
        }
    }
    for (k, name) in METHODS.iter().enumerate() {
        let at = 44.0 + 130.0 * k as f64;
        let _ = writeln!(svg, "<path d=\"M{at} {height}h24\" stroke=\"{}\" stroke-width=\"3\"/>", colours[k]);
        let _ = writeln!(svg, "<text x=\"{:.0}\" y=\"{:.0}\">{name}</text>", at + 30.0, height + 4.0);
    }
    let _ =
        writeln!(svg, "<text x=\"860\" y=\"{:.0}\">relative RMSE over footprint in texels</text></svg>", height + 4.0);
    svg
}
