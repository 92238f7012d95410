//! Highlights of rectangle lights over distance.

use super::clock::{cpu_seconds, thread_nanoseconds};
use super::document::Document;
use super::settings::Settings;
use super::table::Table;
use crate::exit::Failure;
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use glam::{DVec2, Vec2};
use glint_bake_core::area_light::bake::mip_chain;
use glint_bake_core::area_light::baked::{LtcTables, Maps, Tables, decode_tables};
use glint_bake_core::area_light::eval::{self, LOBES, fetch, surface_radiance};
use glint_bake_core::area_light::fit::fit_tables;
use glint_bake_core::area_light::paper::{paper_convolution, paper_meso_alpha};
use glint_bake_core::area_light::quality::*;
use glint_bake_core::area_light::rect::isotropic_radiance;
use glint_bake_core::area_light::reference::{
    Scene, convolved_alpha, deficit, facet_radiance, footprint_normals, footprint_radiance, lift,
};
use glint_bake_core::area_light::spread::{alpha_from_deficit, convolve_alpha, deficit_from_alpha};
use glint_bake_core::area_light::{AreaLightOptions, pack};
use glint_bake_core::footprint::Footprint;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_formats::area_light::NormalStorage;

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
/// The map that a quick look is at.
const WICKER: usize = 3;
/// Places at each size of footprint: small ones see less of a map each, and cost less.
fn places(footprint_texels: f64, settings: &Settings) -> u32 {
    let places = (8192.0 / footprint_texels).clamp(256.0, 4096.0) as u32;
    settings.pick(places, 16)
}
/// Points along an edge of the grids that the reference is tabulated on.
const GRID: usize = 201;

/// Colours of [`METHODS`].
const COLOURS: [Colour; 6] =
    [Colour::Grey, Colour::Vermilion, Colour::Orange, Colour::Blue, Colour::Sky, Colour::Green];

/// Maps that are measured, and their files.
fn maps(settings: &Settings) -> Vec<(&'static str, String)> {
    let maps = &MAPS[settings.pick(0, WICKER)..settings.pick(MAPS.len(), WICKER + 1)];
    maps.iter().map(|(name, file)| (*name, format!("normals/{file}"))).collect()
}

/// Says why the report cannot be made.
pub fn check(settings: &Settings) -> Result<(), Failure> {
    settings.check(maps(settings).iter().map(|(_, file)| file.as_str()))
}

/// Measures the report.
pub fn measure(settings: &Settings) -> Result<Document, Failure> {
    let mut document = Document::new("area-light", "Area lights: error over distance", settings);
    let tables = decode_tables(&LtcTables::built_in());
    let mut scenes: Vec<(Scene, RadianceGrid)> = ALPHAS
        .into_iter()
        .flat_map(scenes)
        .step_by(settings.pick(1, 6))
        .map(|scene| {
            let grid = RadianceGrid::new(&scene, settings.pick(GRID, 51), settings.pick(1e-3, 1e-2));
            (scene, grid)
        })
        .collect();
    scenes.truncate(settings.pick(usize::MAX, 4));
    let mut all = Vec::new();
    let mut parts = Vec::new();
    for (name, file) in maps(settings) {
        settings.terminal.say(&format!("area-light: {name}"));
        let map = settings.normal_map(&file, None)?;
        let (part, rows) = distances(&map, &tables, &scenes, settings)?;
        let check = (file.contains("wicker")).then(|| checks_of_grid(&map, &scenes));
        parts.push((name, part, check));
        all.push((name, rows));
    }
    document.plot("", "relative error of radiance over distance", &figure(&all));
    lobes(&mut document);
    table_quality(&mut document, settings);
    document.paragraph(single_facets(&tables, &scenes));
    document.heading(2, "Highlights over distance");
    document.paragraph(format!(
        "Root mean square error of radiance, relative to the root mean square of the reference, over {} scenes and {} (footprints \
         of 1 and 2 texels) to {} (from 32 on) places spread evenly over the map (base α {} and {}; view {:?} rad from the normal; \
         square lights 0, 0.15, 0.3 and 0.5 from the mirror direction, 0.2 or 0.5 wide at distance 1). A footprint of s texels is \
         a Gaussian of standard deviation s/2. *plain*: mipmapped normals and the base roughness; *paper*: Eq. 5 and 7; *length*: \
         exact inverse of the length of the mean normal and our convolution; *isotropic*: ours; *one lobe* and *anisotropic*: ours \
         with roughness by direction, one stretched lobe or {LOBES}. All use the same LTC tables and, but *isotropic* and after, \
         the same length. After ±: one standard error, as places differ. Few places make most of the error of a map with deep \
         relief: with 16 of them, ratios under small footprints are uncertain by a tenth.",
        scenes.len(),
        places(1.0, settings),
        places(32.0, settings),
        ALPHAS[0],
        ALPHAS[1],
        VIEW_ANGLES
    ));
    for (name, part, check) in parts {
        document.heading(3, name);
        document.paragraph(part.bake);
        document.table(&part.table);
        if let Some(check) = check {
            document.paragraph(check);
        }
    }
    summary(&mut document, &all);
    Ok(document)
}

/// Closed forms and fits against integrals, with the paper's beside them.
fn lobes(document: &mut Document) {
    document.heading(2, "Lobes of normals");
    document.paragraph(
        "Roughness from the length of the mean normal, and the convolution of two lobes, against f64 integrals.",
    );
    let mut table = Table::new(
        0,
        "α | 1 − R | closed form, relative | inverse, relative | f32 inverse, relative | paper's Eq. 5, relative",
    );
    for alpha in [0.001, 0.01, 0.028, 0.1, 0.3, 0.6, 0.99] {
        let exact = deficit(alpha, 4000);
        let single = f64::from(eval::alpha_from_deficit(exact as f32));
        table.row(format!(
            "{alpha} | {exact:.4e} | {:.1e} | {:.1e} | {:.1e} | {:+.1} %",
            (deficit_from_alpha(alpha) / exact - 1.0).abs(),
            (alpha_from_deficit(exact) / alpha - 1.0).abs(),
            (single / alpha - 1.0).abs(),
            100.0 * (paper_meso_alpha(1.0 - exact) / alpha - 1.0)
        ));
    }
    document.table(&table);
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
    document.paragraph(format!(
        "Convolution over a grid of 16² in (0, 1)², against the nearest lobe (least squares over the sphere, α at most 1): \
         worst {:.2} % ours, {:.1} % the paper's Eq. 7.",
        100.0 * ours,
        100.0 * paper
    ));
}

fn table_quality(document: &mut Document, settings: &Settings) {
    document.heading(2, "LTC tables");
    let (fitted, fit) = if settings.quick {
        (LtcTables::built_in(), "Built in.".to_owned())
    } else {
        let start = cpu_seconds();
        let fitted = fit_tables();
        let seconds = cpu_seconds() - start;
        let same = if fitted == LtcTables::built_in() { "the same bytes as" } else { "NOT the bytes of" };
        (fitted, format!("Fitted in {seconds:.1} CPU-seconds; {same} the built-in ones."))
    };
    let error = table_error(&fitted);
    document.paragraph(format!(
        "{fit} ∫ |LTC − GGX| / ∫ GGX over 64 × 63 entries (all but roughness 0), half floats, a quadrature twenty times as fine \
         as the fit's: mean **{:.4}**, 95th percentile {:.4}, worst {:.4}.",
        error.mean,
        error.p95,
        error.worst
    ));
}

/// One facet, so that only the LTC differs from the reference.
fn single_facets(tables: &Tables, scenes: &[(Scene, RadianceGrid)]) -> String {
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
    format!(
        "Under the scenes below, three flat surfaces each: RMSE {:.2} % of the reference. It is what remains at distance 0.",
        100.0 * (errors / power).sqrt()
    )
}

/// How exact the tabulated reference is.
fn checks_of_grid(map: &NormalMap, scenes: &[(Scene, RadianceGrid)]) -> String {
    let (mut errors, mut power) = (0.0, 0.0);
    for (k, (scene, grid)) in scenes.iter().enumerate().step_by(5) {
        let footprint = Footprint::new(DVec2::new(37.0 * k as f64, 100.3), 0.5, 1.0, 0.0);
        let exact = footprint_radiance(map, &footprint, scene, 1e-4);
        let found = grid.mean(&grid_weights(&footprint_normals(map, &footprint, 4.0, 256), grid.size()));
        errors += (found - exact).powi(2);
        power += exact * exact;
    }
    format!(
        "The reference is tabulated over normals; against direct quadrature, facet by facet, it is off by {:.3} % (RMSE, \
         footprints of one texel of this map).",
        100.0 * (errors / power).sqrt()
    )
}

/// What is said of a map.
struct Part {
    bake: String,
    table: Table,
}

fn distances(
    map: &NormalMap,
    tables: &Tables,
    scenes: &[(Scene, RadianceGrid)],
    settings: &Settings,
) -> Result<(Part, Vec<HighlightError>), Failure> {
    let start = cpu_seconds();
    let levels = mip_chain(map, &Silent);
    let pack_as = |storage| pack(map, &levels, &AreaLightOptions { storage, anisotropic: true, ..Default::default() });
    let material = pack_as(NormalStorage::F16);
    let seconds = cpu_seconds() - start;
    let small = pack_as(NormalStorage::Snorm8);
    let (maps, maps8) = (Maps::new(&material), Maps::new(&small));
    let bake = format!(
        "{} × {} texels, baked in {seconds:.1} CPU-seconds. Isotropic {:.0} KiB as f16, {:.0} KiB as snorm8; anisotropic twice that; \
         plus 64 KiB of LTC tables. A query, in processor time: {}.",
        map.width,
        map.height,
        material.normals.len() as f64 / 1024.0,
        small.normals.len() as f64 / 1024.0,
        query_times(&maps, tables, scenes)
    );
    let mut table = Table::new(
        0,
        &format!(
            "texels | reference | {} | iso / plain | iso / paper | aniso / paper | iso / aniso | iso snorm8 | aniso snorm8",
            METHODS.join(" | ")
        ),
    );
    let mut rows = Vec::new();
    for power in (0..=8).step_by(settings.pick(1, 4)) {
        let size = f64::from(1 << power);
        let over = Comparison { scenes, places: places(size, settings), lobes: LOBES, seed: 1 };
        let row = highlight_error(map, &maps, tables, size, &over);
        // The smaller format at two distances: it takes as long as the larger.
        let row8 = [4.0, 32.0].contains(&size).then(|| highlight_error(map, &maps8, tables, size, &over).rmse);
        let of8 = |method: usize| row8.map_or(String::new(), |rmse| format!("{:.3}", rmse[method]));
        let to_paper = |k: usize| format!("{:.3} ± {:.3}", row.to_paper[k], row.to_paper_error[k]);
        let e = row.rmse;
        table.row(format!(
            "{size} | {:.4} | {} | {:.2} | {} | {} | {:.2} | {} | {}",
            row.reference,
            e.map(|v| format!("{v:.3}")).join(" | "),
            e[3] / e[0],
            to_paper(3),
            to_paper(5),
            e[3] / e[5],
            of8(3),
            of8(5)
        ));
        rows.push(row);
    }
    Ok((Part { bake, table }, rows))
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

fn summary(document: &mut Document, all: &[(&str, Vec<HighlightError>)]) {
    document.heading(2, "Summary");
    let mut lines = Vec::new();
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
        lines.push(format!(
            "- *{name}*: from 4 texels on {mean:.3} of plain's error on average, {worst:.3} at the worst; of the paper's, at all \
             sizes, {to_paper:.3} on average, {worst_to_paper:.3} at the worst."
        ));
    }
    for (name, rows) in all {
        let rows: Vec<&HighlightError> = rows.iter().filter(|r| r.footprint_texels >= 4.0).collect();
        let factor = rows.iter().map(|r| r.rmse[3] / r.rmse[5]).sum::<f64>() / rows.len() as f64;
        lines
            .push(format!("- {name}: anisotropic better than isotropic by a factor of {factor:.2}, from 4 texels on."));
    }
    document.paragraph(lines.join("\n"));
}

/// Error over distance, a panel a map.
fn figure(all: &[(&str, Vec<HighlightError>)]) -> Figure {
    let panel = |(name, rows): &(&str, Vec<HighlightError>)| {
        let curve = |method: usize| rows.iter().map(|row| (row.footprint_texels, row.rmse[method])).collect();
        let series = METHODS.iter().zip(COLOURS).enumerate();
        Panel {
            title: (*name).to_owned(),
            x: Axis::logarithmic("footprint in texels", (1.0, 256.0)).ticks(&[1.0, 4.0, 16.0, 64.0, 256.0]),
            y: Axis::logarithmic("relative RMSE", (0.01, 3.0)).ticks(&[0.01, 0.03, 0.1, 0.3, 1.0, 3.0]),
            series: series.map(|(method, (name, colour))| Series::line(name, colour, curve(method))).collect(),
        }
    };
    let panels: Vec<Panel> = all.iter().map(panel).collect();
    let columns = panels.len().clamp(1, 3);
    Figure { title: String::new(), panels, columns, panel_size: (300, 260) }
}
