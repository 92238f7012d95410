//! Highlights of textures with filtered mips, against closed forms.

use super::clock::{children_cpu_seconds, peak_mib_of};
use super::document::Document;
use super::settings::Settings;
use super::table::Table;
use crate::blocks;
use crate::exit::{Exit, Failure};
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use glam::{DVec2, DVec3};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::textures::levels::sizes;
use glint_bake_core::textures::paper::{ClosedForm, moments};
use glint_bake_core::textures::quality::{Sums, VIEWS, measure as highlights, probes};
use glint_bake_core::textures::reference::{Facet, Stretched};
use glint_bake_core::textures::{Axes, Level, Roughness, TexturesOptions, bake};
use glint_formats::export::blocks::Blocks;
use std::process::Command;

/// The maps, by what they show.
const MAPS: [(&str, &str); 8] = [
    ("brushed", "brushed_aluminium_godot_745.png"),
    ("scratched", "scratched_gold_cgbookcase_rgba.png"),
    ("leather", "leather_008_3dtextures.jpg"),
    ("wicker", "wicker_khronos_512.png"),
    ("diamond plate", "diamond_plate_pmndrs0008.jpg"),
    ("ground", "ground054_ambientcg_gl.jpg"),
    ("metal", "metal049a_ambientcg_gl.jpg"),
    ("snow", "snow_02_polyhaven_gl.jpg"),
];
/// Perceptual roughness of the materials: α is 0.04, 0.16 and 0.36.
const ROUGHNESS: [f32; 3] = [0.2, 0.4, 0.6];
/// Maps whose cost is measured: two whose normals spread widely everywhere, and one with flat parts.
const COSTLY: [&str; 3] = ["ground", "snow", "scratched"];
/// The map that a quick look is at.
const WICKER: usize = 3;
/// The last mip that is measured.
const LAST_MIP: u32 = 8;
/// Texels of each mip, and half vectors at each, a view.
const PLACES: u32 = 32;
const LIGHTS: u32 = 192;
/// Methods before the closed forms: ours, ours as 8 bits hold it, ours in blocks.
const OURS: usize = 3;
const METHODS: usize = OURS + ClosedForm::ALL.len();
/// What engines take the axes of anisotropic highlights from.
const AXES: [(Axes, &str); 2] = [(Axes::Normal, "anisotropic, axes of the normal"), (Axes::Surface, "of the surface")];
/// Errors below this are of maps that are flat to a mip; ratios of them say nothing that could be seen.
const FLAT: f64 = 0.005;

/// One mip of one map at one roughness.
struct Row {
    map: &'static str,
    roughness: f32,
    mip: u32,
    sums: [Sums; METHODS],
    /// Ours with anisotropy, by [`AXES`].
    stretched: [f64; 2],
}

impl Row {
    fn errors(&self) -> [f64; METHODS] {
        self.sums.map(|sums| sums.error())
    }

    /// Error of ours over that of the best closed form.
    fn ratio(&self) -> f64 {
        let errors = self.errors();
        errors[0] / errors[OURS..].iter().copied().fold(f64::INFINITY, f64::min)
    }
}

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
    let mut document = Document::new("textures", "Textures: error of highlights by mip", settings);
    let mut rows = Vec::new();
    for (name, file) in maps(settings) {
        settings.terminal.say(&format!("textures: {name}"));
        let map = settings.normal_map(&file, None)?;
        for roughness in ROUGHNESS {
            rows.extend(of_map(name, &map, roughness, settings)?);
        }
    }
    document.plot("", "error of highlights by mip", &figure(&rows));
    document.paragraph(format!(
        "∫|L̂ − L| over lights in all directions, as a part of ∫L, summed over {} views ({} rad from the normal) and {} texels of each \
         mip, {} half vectors a view and texel. L is the mean radiance of 256 to 4096 facets of the bilinear surface under the texel, \
         each of the material's roughness. *ours*: what `glint-bake textures` makes; *8 bits*: the same as its files hold it; *blocks*: the same with `--blocks`, \
         BC5 for normals and BC7 for roughness beside occlusion and metallic of 1; *plain*: \
         mean normals and constant roughness, whether renormalised or not, as shaders renormalise; the closed forms are made of the same \
         texels.",
        VIEWS.len(),
        VIEWS.map(|[polar, _]| polar.to_string()).join(", "),
        places(settings),
        LIGHTS
    ));
    summary(&mut document, &rows);
    anisotropy(&mut document, &rows, settings);
    cost(&mut document, settings)?;
    document.heading(2, "Every mip");
    document.paragraph(
        "*beside*: the error half a texel beside a texel's centre, where an engine reads the mean of two. *flicker*: the change of the \
         highlight over that half texel, as a part of it. The last column is that of the reference.",
    );
    for (name, _) in maps(settings) {
        document.heading(3, name);
        document.table(&table(rows.iter().filter(|row| row.map == name)));
    }
    Ok(document)
}

fn places(settings: &Settings) -> u32 {
    settings.pick(PLACES, 4)
}

fn of_map(name: &'static str, map: &NormalMap, roughness: f32, settings: &Settings) -> Result<Vec<Row>, Failure> {
    let material = Roughness::Constant(roughness);
    let textures = bake(map, &material, &TexturesOptions::default(), &Silent)?;
    let stretched = AXES.map(|(anisotropy, _)| {
        bake(map, &material, &TexturesOptions { anisotropy: Some(anisotropy), ..TexturesOptions::default() }, &Silent)
    });
    let [normal, surface] = stretched;
    let stretched = [normal?, surface?];
    let all = sizes(map.width, map.height);
    let mips = 1..=settings.pick(LAST_MIP, 4).min(all.len() as u32 - 1);
    let row = |mip: u32| {
        let probes = probes(map, &material, mip, places(settings), LIGHTS);
        let level = &textures.levels[mip as usize - 1];
        let mut sums = [Sums::default(); METHODS];
        sums[0] = highlights(&probes, |i, j| texel(level, i, j));
        sums[1] = highlights(&probes, |i, j| in_8_bits(texel(level, i, j)));
        let decoded = in_blocks(level);
        sums[2] = highlights(&probes, |i, j| decoded[(j * level.width + i) as usize]);
        for (sums, form) in sums[OURS..].iter_mut().zip(ClosedForm::ALL) {
            *sums = highlights(&probes, |i, j| form.texel(&moments(map, &material, all[mip as usize], (i, j))));
        }
        let stretched = [0, 1].map(|k: usize| {
            let level = &stretched[k].levels[mip as usize - 1];
            highlights(&probes, |i, j| stretched_texel(level, AXES[k].0, i, j)).error()
        });
        Row { map: name, roughness, mip, sums, stretched }
    };
    Ok(mips.map(row).collect())
}

fn texel(level: &Level, i: u32, j: u32) -> Facet {
    let at = (j * level.width + i) as usize;
    let [x, y] = level.normals[at].map(f64::from);
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    Facet { normal: DVec3::new(x, y, z).normalize(), alpha: f64::from(level.alphas[at]) }
}

fn stretched_texel(level: &Level, axes: Axes, i: u32, j: u32) -> Stretched {
    let Facet { normal, alpha } = texel(level, i, j);
    let of = level.anisotropies[(j * level.width + i) as usize];
    let direction = DVec2::from_array(of.direction.map(f64::from));
    Stretched { normal, roughness: alpha.sqrt(), strength: f64::from(of.strength), direction, axes }
}

/// A texel as files of 8 bits a channel hold it.
fn in_8_bits(texel: Facet) -> Facet {
    let stored = |value: f64| (255.0 * value).round() / 255.0;
    let normal = texel.normal.to_array().map(|component| 2.0 * stored(0.5 + 0.5 * component) - 1.0);
    let alpha = stored(texel.alpha.sqrt()).powi(2).max(1e-3);
    Facet { normal: DVec3::from_array(normal).normalize(), alpha }
}

/// A level as files of blocks hold it, BC5 and BC7.
fn in_blocks(level: &Level) -> Vec<Facet> {
    let stored = |value: f32| (255.0 * value).round() as u8;
    let size = (level.width, level.height);
    let through = |format: Blocks, texel: &(dyn Fn(usize) -> [u8; 4] + Sync)| {
        blocks::decompress(format, size, &blocks::compress(format, size, texel))
    };
    let normals = through(Blocks::Bc5, &|k| {
        let [x, y] = level.normals[k].map(|component| stored(0.5 + 0.5 * component));
        [x, y, 0, 255]
    });
    let roughness = through(Blocks::Bc7, &|k| [255, stored(level.alphas[k].sqrt()), 255, 255]);
    let texel = |(normal, roughness): (&[u8; 4], &[u8; 4])| {
        let [x, y] = [normal[0], normal[1]].map(|stored| f64::from(stored) / 127.5 - 1.0);
        let normal = DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt()).normalize();
        Facet { normal, alpha: (f64::from(roughness[1]) / 255.0).powi(2).max(1e-3) }
    };
    normals.iter().zip(&roughness).map(texel).collect()
}

/// Names of the methods.
fn names() -> [&'static str; METHODS] {
    let mut names = ["ours", "ours, 8 bits", "ours, blocks", "", "", "", ""];
    for (name, form) in names[OURS..].iter_mut().zip(ClosedForm::ALL) {
        *name = form.name();
    }
    names
}

/// Means over all rows of a quantity by method.
fn means(rows: &[&Row], of: impl Fn(&Sums) -> f64) -> [f64; METHODS] {
    let mut means = [0.0; METHODS];
    for row in rows {
        for (mean, sums) in means.iter_mut().zip(&row.sums) {
            *mean += of(sums) / rows.len() as f64;
        }
    }
    means
}

fn summary(document: &mut Document, rows: &[Row]) {
    document.heading(2, "Means over maps and mips");
    let mut table = Table::new(1, &format!("| {} | ours / plain | ours / best closed form", names().join(" | ")));
    let mut add = |label: String, of: [f64; METHODS], ratios: bool| {
        let numbers = of.map(|value| format!("{value:.4}")).join(" | ");
        let best = of[OURS..].iter().copied().fold(f64::INFINITY, f64::min);
        let ratios = if ratios { format!("{:.3} | {:.3}", of[0] / of[OURS], of[0] / best) } else { " | ".into() };
        table.row(format!("{label} | {numbers} | {ratios}"));
    };
    let all: Vec<&Row> = rows.iter().collect();
    for roughness in ROUGHNESS {
        let some: Vec<&Row> = rows.iter().filter(|row| row.roughness == roughness).collect();
        add(format!("error, roughness {roughness}"), means(&some, Sums::error), true);
    }
    add("**error, all**".into(), means(&all, Sums::error), true);
    add("error beside".into(), means(&all, Sums::error_beside), true);
    add("flicker".into(), means(&all, Sums::flicker), false);
    document.table(&table);
    let exact = all.iter().map(|row| row.sums[0].exact_flicker()).sum::<f64>() / all.len() as f64;
    let seen: Vec<&&Row> = all.iter().filter(|row| row.errors()[0] >= FLAT).collect();
    let beyond = seen.iter().filter(|row| row.ratio() > 1.02).count();
    let blocks_cost = |rows: &[&&Row]| {
        let sum = |k: usize| rows.iter().map(|row| row.errors()[k]).sum::<f64>();
        100.0 * (sum(2) / sum(1) - 1.0)
    };
    let worst = |rows: &[&&Row]| rows.iter().map(|row| row.ratio()).fold(0.0, f64::max);
    document.paragraph(format!(
        "Flicker of the reference: {exact:.4}. Of {} mips with an error of {FLAT} or more, ours is worse than the best closed form of that \
         mip by more than 2 % in {beyond}; the worst ratio is {:.3}. The other {} mips are flat: the worst ratio there is {:.3}. Blocks cost \
         {:.1} % more error than 8 bits on average, {:.1} % without the flat mips.",
        seen.len(),
        worst(&seen),
        all.len() - seen.len(),
        worst(&all.iter().filter(|row| row.errors()[0] < FLAT).collect::<Vec<_>>()),
        blocks_cost(&all.iter().collect::<Vec<_>>()),
        blocks_cost(&seen)
    ));
}

fn table<'a>(rows: impl Iterator<Item = &'a Row>) -> Table {
    let mut table = Table::new(
        0,
        &format!(
            "roughness | mip | {} | ours / best | ours beside | plain beside | our flicker | plain flicker | exact",
            names().join(" | ")
        ),
    );
    for row in rows {
        let errors = row.errors().map(|error| format!("{error:.4}")).join(" | ");
        let (ours, plain) = (&row.sums[0], &row.sums[OURS]);
        table.row(format!(
            "{} | {} | {errors} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3}",
            row.roughness,
            row.mip,
            row.ratio(),
            ours.error_beside(),
            plain.error_beside(),
            ours.flicker(),
            plain.flicker(),
            ours.exact_flicker()
        ));
    }
    table
}

/// Errors with anisotropy by map and mip.
fn anisotropy(document: &mut Document, rows: &[Row], settings: &Settings) {
    document.heading(2, "Anisotropy");
    document.paragraph(
        "Errors with `--anisotropy`, means over roughness. Engines that take the axes of the lobe from the surface, as the code of \
         KHR_materials_anisotropy does, show the highlight around the surface's normal: where mean normals of a mip lean, no texture helps.",
    );
    let last = rows.iter().map(|row| row.mip).max().unwrap_or(1);
    let mips: Vec<String> = (1..=last).map(|mip| format!("mip {mip}")).collect();
    let mut table = Table::new(2, &format!("map | ours | all mips | {}", mips.join(" | ")));
    for (name, _) in maps(settings) {
        let mut add = |label: &str, error: &dyn Fn(&Row) -> f64| {
            let mean = |is: &dyn Fn(&Row) -> bool| {
                let some: Vec<f64> = rows.iter().filter(|row| row.map == name && is(row)).map(error).collect();
                format!("{:.3}", some.iter().sum::<f64>() / some.len() as f64)
            };
            let by_mip: Vec<String> = (1..=last).map(|mip| mean(&|row| row.mip == mip)).collect();
            table.row(format!("{name} | {label} | {} | {}", mean(&|_| true), by_mip.join(" | ")));
        };
        add("round", &|row| row.errors()[0]);
        for (k, (_, label)) in AXES.iter().enumerate() {
            add(label, &|row| row.stretched[k]);
        }
    }
    document.table(&table);
}

/// Processor time and memory of the whole command for a large map.
fn cost(document: &mut Document, settings: &Settings) -> Result<(), Failure> {
    let edge = settings.pick(4096, 512);
    document.heading(2, "Cost");
    let mut table = Table::new(1, "map | roughness | CPU-seconds | most memory, MiB");
    for (name, file) in maps(settings).into_iter().filter(|(name, _)| settings.quick || COSTLY.contains(name)) {
        let small = settings.normal_map(&file, None)?;
        let map = tiled(&small, edge);
        for roughness in [ROUGHNESS[0], 0.5] {
            let (seconds, peak_mib) = command(&map, roughness)?;
            table.row(format!("{name} | {roughness} | {seconds:.1} | {peak_mib:.0}"));
        }
    }
    document.paragraph(format!(
        "`glint-bake textures NORMAL.png --roughness-map ROUGHNESS.png -o DIR`, reading and writing included; maps repeated to {edge} × \
         {edge} texels, the roughness a fifth more or less where normals lean to the right or to the left."
    ));
    document.table(&table);
    Ok(())
}

/// CPU-seconds and most memory in MiB of a run of the command on a map.
fn command(map: &NormalMap, roughness: f32) -> Result<(f64, f64), Failure> {
    let failed = |e: &dyn std::fmt::Display| Failure::new(Exit::InputOutput, format!("textures: the command: {e}"));
    let folder = tempfile::tempdir().map_err(|e| failed(&e))?;
    let stored = |value: f32| (255.0 * value).round() as u8;
    let texel = |i: u32, j: u32| map.projected[(j * map.width + i) as usize];
    let normals = image::RgbImage::from_fn(map.width, map.height, |i, j| {
        let [x, y] = texel(i, j);
        image::Rgb([x, y, (1.0 - x * x - y * y).max(0.0).sqrt()].map(|component| stored(0.5 + 0.5 * component)))
    });
    let rough = |i, j| image::Luma([stored((roughness * (1.0 + 0.2 * texel(i, j)[0])).clamp(0.0, 1.0))]);
    let rough = image::GrayImage::from_fn(map.width, map.height, rough);
    normals.save(folder.path().join("normal.png")).map_err(|e| failed(&e))?;
    rough.save(folder.path().join("roughness.png")).map_err(|e| failed(&e))?;
    let begin = children_cpu_seconds();
    let program = std::env::current_exe().map_err(|e| failed(&e))?;
    let mut child = Command::new(program)
        .args(["textures", "normal.png", "--roughness-map", "roughness.png", "-o", "textures", "-q"])
        .current_dir(folder.path())
        .spawn()
        .map_err(|e| failed(&e))?;
    let (process, mut peak_mib) = (child.id().to_string(), 0.0_f64);
    let status = loop {
        peak_mib = peak_mib.max(peak_mib_of(&process));
        match child.try_wait().map_err(|e| failed(&e))? {
            Some(status) => break status,
            None => std::thread::sleep(std::time::Duration::from_millis(5)),
        }
    };
    if !status.success() {
        return Err(failed(&status));
    }
    Ok((children_cpu_seconds() - begin, peak_mib))
}

/// A map repeated to a size.
fn tiled(map: &NormalMap, edge: u32) -> NormalMap {
    let texel = |k: u32| map.projected[((k / edge % map.height) * map.width + k % edge % map.width) as usize];
    NormalMap { width: edge, height: edge, wrap: map.wrap, projected: (0..edge * edge).map(texel).collect() }
}

/// Error by mip, the mean of all maps and of all roughness.
fn figure(rows: &[Row]) -> Figure {
    const COLOURS: [Colour; METHODS] =
        [Colour::Blue, Colour::Sky, Colour::Sky, Colour::Grey, Colour::Orange, Colour::Vermilion, Colour::Green];
    let last = rows.iter().map(|row| row.mip).max().unwrap_or(1);
    let series = names().into_iter().zip(COLOURS).enumerate().filter(|(k, _)| *k == 0 || *k >= OURS).map(
        |(k, (name, colour))| {
            let point = |mip: u32| {
                let some: Vec<&Row> = rows.iter().filter(|row| row.mip == mip).collect();
                (f64::from(mip), means(&some, Sums::error)[k])
            };
            Series::line(name, colour, (1..=last).map(point).collect()).marked()
        },
    );
    let most = rows.iter().flat_map(|row| row.errors()).fold(0.0, f64::max).min(0.8);
    let x = Axis::linear("mip", (1.0, f64::from(last)), last.max(2) - 1);
    let y = Axis::linear("error of highlights, mean over maps and roughness", (0.0, most), 8);
    Figure::of(Panel { title: String::new(), x, y, series: series.collect() })
}
