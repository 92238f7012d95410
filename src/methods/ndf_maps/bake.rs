//! `glint-bake ndf-maps`: normal maps in, a verified pack out. What a bake will do is checked before any of it is done:
//! names, options, inputs, output paths.

use super::args::{Args, PlacementArg};
use super::info::{PAPER_TILE_BYTES, storage_name};
use crate::cli::Terminal;
use crate::cli::normal_maps::{check_name, unique_name};
use crate::commands::bake::Delivery;
use crate::exit::{Exit, Failure};
use crate::input::{LoadedMap, digest, load_normal_map};
use crate::pack::{self, seal};
use crate::progress::Stages;
use crate::quantities::percent;
use glint_bake_core::error::{BakeError, Result as BakeResult};
use glint_bake_core::ndf_maps::bake::{self, FINEST_TILE, NdfMapsOptions, ROUGHNESS_RANGE, WORST_OF_MEAN};
use glint_bake_core::ndf_maps::eval::Material;
use glint_bake_core::ndf_maps::placement::{self, PlacementOptions, StochasticOptions};
use glint_bake_core::ndf_maps::sections;
use glint_bake_core::ndf_maps::transform::TransformRanges;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::{Progress, Silent};
use glint_formats::container::MAX_NAME_BYTES;
use glint_formats::ndf_maps::{DensityStorage, LAYERS, LayeredMaterial};
use glint_formats::provenance::{InputDigest, Provenance};
use glint_formats::{Codec, Section};
use std::path::PathBuf;

/// Runs the subcommand.
pub fn run(args: Args, terminal: Terminal) -> Result<(), Failure> {
    let threads = args.run.threads;
    crate::cli::on_threads(threads, || bake_pack(args, terminal))?
}

/// A bake that is only looked at: maps and materials, and the bytes that the pack would have.
pub fn draft(args: Args) -> Result<(Vec<(NormalMap, Material)>, u64), Failure> {
    let job = Job::unwritten(args)?;
    let mut materials = Vec::new();
    for source in &job.sources {
        let material = bake_material(&source.loaded.map, &job.bake, &job.placement, &Silent)
            .map_err(|e| Failure::bake(&source.path, &e))?;
        job.check_error(source, &material)?;
        materials.push(Baked { name: source.name.clone(), material });
    }
    let bytes = assemble(&materials, job.layers.as_ref(), &job.provenance(), job.codec())?;
    let made = job.sources.into_iter().zip(materials).map(|(source, baked)| (source.loaded.map, baked.material));
    Ok((made.collect(), bytes.len() as u64))
}

fn bake_pack(args: Args, terminal: Terminal) -> Result<(), Failure> {
    let job = Job::new(args)?;
    for source in &job.sources {
        for warning in &source.loaded.warnings {
            terminal.warn(&format!("{}: {warning}", source.path.display()));
        }
        terminal.detail(&input_line(source));
    }
    if job.args.run.dry_run {
        terminal.say(&dry_run_text(&job));
        return Ok(());
    }
    let stages = Stages::new(terminal);
    let mut materials = Vec::new();
    for source in &job.sources {
        let material = bake_material(&source.loaded.map, &job.bake, &job.placement, &stages)
            .map_err(|e| Failure::bake(&source.path, &e))?;
        job.check_error(source, &material)?;
        materials.push(Baked { name: source.name.clone(), material });
    }
    let bytes = assemble(&materials, job.layers.as_ref(), &job.provenance(), job.codec())?;
    job.delivery().write(bytes, "--max-error", terminal)
}

/// One map that becomes one material.
pub struct Source {
    /// The file.
    pub path: PathBuf,
    /// Name of the material.
    pub name: String,
    /// The map.
    pub loaded: LoadedMap,
    /// What provenance says of the file.
    digest: InputDigest,
}

/// A bake that can go ahead.
pub struct Job {
    /// The flags it was asked for with.
    pub args: Args,
    /// The maps, in the order given.
    pub sources: Vec<Source>,
    /// Options of every map's bake.
    pub bake: NdfMapsOptions,
    /// Options of every map's placement.
    pub placement: PlacementOptions,
    /// The two-layer material.
    pub layers: Option<LayeredMaterial>,
}

impl Job {
    /// Checks arguments, then paths, then the content of the inputs.
    pub fn new(args: Args) -> Result<Job, Failure> {
        Job::checked(args, true)
    }

    /// The same for a bake that is only looked at.
    pub fn unwritten(args: Args) -> Result<Job, Failure> {
        Job::checked(args, false)
    }

    fn checked(args: Args, writes: bool) -> Result<Job, Failure> {
        let bake = bake_options(&args)?;
        let placement = placement_options(&args)?;
        let names = names(&args)?;
        let layers = args.layers.as_ref().map(|text| layers(text, &names, &args)).transpose()?;
        if writes {
            delivery(&args).check()?;
        }
        let input = args.input.options(args.run.max_memory);
        let mut sources = Vec::new();
        for (path, name) in args.maps.iter().zip(names) {
            let loaded = load_normal_map(path, &input)?;
            let digest = digest(path, &loaded)?;
            check_material(&loaded.map, &bake, &placement, args.run.max_memory).map_err(|e| Failure::bake(path, &e))?;
            sources.push(Source { path: path.clone(), name, loaded, digest });
        }
        Ok(Job { args, sources, bake, placement, layers })
    }

    /// How sections are stored.
    pub fn codec(&self) -> Codec {
        if self.args.compress { Codec::Zstd } else { Codec::None }
    }

    /// Where the pack goes.
    pub fn delivery(&self) -> Delivery<'_> {
        delivery(&self.args)
    }

    /// When the user named an error, missing it is a failure: on average, or by more than three times anywhere.
    pub fn check_error(&self, source: &Source, material: &Material) -> Result<(), Failure> {
        let Some(asked) = self.args.max_error else { return Ok(()) };
        let measured = &material.maps.params.measured;
        // The bake works with the same numbers, so only rounding can come between.
        let kept = |found: f64, most: f64| found <= most * (1.0 + 1e-6);
        if kept(measured.mean, asked) && kept(measured.worst, WORST_OF_MEAN * asked) {
            return Ok(());
        }
        let message = format!(
            "{}: expected E1 of {asked} on average and {} at the worst, found {:.5} and {:.5}; nothing was written. Raise \
             --max-error or --roughness, or give --storage f16",
            source.path.display(),
            WORST_OF_MEAN * asked,
            measured.mean,
            measured.worst
        );
        Err(Failure::new(Exit::LimitExceeded, message))
    }

    /// Where the pack comes from. Flags that do not change its bytes are left out.
    pub fn provenance(&self) -> Provenance {
        let args = &self.args;
        let mut options = vec![
            ("roughness", args.roughness.to_string()),
            ("max-error", self.bake.max_error.to_string()),
            ("storage", storage_name(self.bake.storage).to_owned()),
        ];
        options.extend(args.input.provenance());
        options.push(("placement", format!("{:?}", args.placement).to_ascii_lowercase()));
        options.push(("transforms", transforms_text(ranges(&self.placement))));
        if args.placement == PlacementArg::Stochastic {
            options.push(("palette", args.palette.to_string()));
            options.push(("cells", args.cells.to_string()));
            options.push(("spacing", args.spacing.to_string()));
        }
        if args.min_tile != FINEST_TILE {
            options.push(("min-tile", args.min_tile.to_string()));
        }
        let remark = |source: &Source, warning: &String| format!("{}: {warning}", source.digest.name);
        Provenance {
            options: options.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
            seed: args.seed,
            inputs: self.sources.iter().map(|source| source.digest.clone()).collect(),
            normal_convention: args.input.normal_convention(),
            notes: self.sources.iter().flat_map(|s| s.loaded.warnings.iter().map(|w| remark(s, w))).collect(),
            ..pack::provenance("ndf-maps")
        }
    }
}

fn delivery(args: &Args) -> Delivery<'_> {
    Delivery { output: &args.output, inputs: &args.maps, run: &args.run }
}

fn bake_options(args: &Args) -> Result<NdfMapsOptions, Failure> {
    let (low, high) = ROUGHNESS_RANGE;
    if !(low..=high).contains(&args.roughness) {
        return Err(Failure::usage(format!("--roughness: expected {low} to {high}, found {}", args.roughness)));
    }
    Ok(NdfMapsOptions {
        roughness: args.roughness,
        max_error: args.wanted_error(),
        storage: args.wanted_storage(),
        min_tile: args.min_tile,
    })
}

fn placement_options(args: &Args) -> Result<PlacementOptions, Failure> {
    if args.placement == PlacementArg::Tiled {
        let ranges = args.transforms.unwrap_or_default();
        // One transform serves every copy, so a range would silently become its lower end.
        let varies = [ranges.rotate_degrees, ranges.scale, ranges.stretch, ranges.shear].iter().any(|(a, b)| a != b);
        if varies || ranges.mirror {
            return Err(Failure::usage(
                "--transforms: a tiled placement has one transform for all copies; expected single values such as \
                 rotate=30, found a range or mirror. Give --placement stochastic for different ones",
            ));
        }
        return Ok(PlacementOptions::Tiled(ranges));
    }
    if !(0.25..=8.0).contains(&args.spacing) {
        return Err(Failure::usage(format!("--spacing: expected 0.25 to 8, found {}", args.spacing)));
    }
    Ok(PlacementOptions::Stochastic(StochasticOptions {
        ranges: args.transforms.unwrap_or(StochasticOptions::default().ranges),
        palette: args.palette,
        cells: args.cells,
        spacing: args.spacing,
        seed: args.seed,
    }))
}

/// One name a map: those given, then file stems made unique by a number.
fn names(args: &Args) -> Result<Vec<String>, Failure> {
    if args.name.len() > args.maps.len() {
        let (names, maps) = (args.name.len(), args.maps.len());
        return Err(Failure::usage(format!("--name: expected at most one a map, found {names} names for {maps} maps")));
    }
    let mut names: Vec<String> = Vec::new();
    for name in &args.name {
        check_name(name)?;
        if names.contains(name) {
            return Err(Failure::usage(format!(
                "--name: {name:?} is given twice; give each material a name of its own"
            )));
        }
        names.push(name.clone());
    }
    for path in &args.maps[names.len()..] {
        names.push(unique_name(path, &names));
    }
    Ok(names)
}

/// `COAT:BASE`; names may hold colons themselves, so every one is tried.
fn layers(text: &str, names: &[String], args: &Args) -> Result<LayeredMaterial, Failure> {
    let known = |name: &str| names.iter().any(|other| other == name);
    for (at, _) in text.match_indices(':') {
        let (coat, base) = (&text[..at], &text[at + 1..]);
        if known(coat) && known(base) {
            if text.len() > MAX_NAME_BYTES {
                return Err(Failure::usage(format!(
                    "--layers: both names together have at most {} bytes, found {}; give shorter ones with --name",
                    MAX_NAME_BYTES - 1,
                    text.len() - 1
                )));
            }
            return Ok(LayeredMaterial {
                coat: coat.to_owned(),
                base: base.to_owned(),
                coat_f0: args.coat_f0,
                base_f0: args.base_f0,
            });
        }
    }
    let known = names.join(", ");
    Err(Failure::usage(format!(
        "--layers: expected COAT:BASE with two materials of this pack ({known}), found {text:?}"
    )))
}

/// One input, for `--verbose`.
fn input_line(source: &Source) -> String {
    let report = &source.loaded.report;
    let [su, sv] = report.slope_std;
    format!(
        "{}: {} × {} texels, {}, {} bytes, slope standard deviation {su:.3} {sv:.3}, material \"{}\"",
        source.path.display(),
        source.loaded.map.width,
        source.loaded.map.height,
        source.loaded.convention,
        source.loaded.bytes,
        source.name
    )
}

/// What a dry run would do.
fn dry_run_text(job: &Job) -> String {
    let mut lines = Vec::new();
    for source in &job.sources {
        let (width, height) = (source.loaded.map.width, source.loaded.map.height);
        lines.push(format!(
            "would bake {} as \"{}\": {width} × {height} texels, {} tiles",
            source.path.display(),
            source.name,
            tile_count(width, height, job.bake.min_tile)
        ));
    }
    let output = job.args.output.display();
    lines.push(format!(
        "would write {output}: σ_r {}, E₁ {} asked, {} storage; dry run, nothing was written",
        job.bake.roughness,
        percent(job.bake.max_error),
        storage_name(job.bake.storage)
    ));
    lines.join("\n")
}

/// A material with its name.
pub struct Baked {
    /// Name in the pack.
    pub name: String,
    /// What was baked.
    pub material: Material,
}

/// Bakes one material.
pub fn bake_material(
    map: &NormalMap,
    options: &NdfMapsOptions,
    placement: &PlacementOptions,
    progress: &dyn Progress,
) -> BakeResult<Material> {
    let placement = placement::bake(map, options.roughness, placement)?;
    let maps = bake::bake(map, options, progress)?;
    Ok(Material { maps, placement })
}

/// What would stop [`bake_material`], found without the work.
fn check_material(
    map: &NormalMap,
    options: &NdfMapsOptions,
    placement: &PlacementOptions,
    max_memory: u64,
) -> BakeResult<()> {
    if u64::from(map.width) * u64::from(map.height) > bake::MAX_EXAMPLE_TEXELS {
        return Err(BakeError::LimitExceeded(format!(
            "expected at most {} texels, found {} × {}; NDF maps are for small examples: use a part of it with --crop WxH+X+Y",
            bake::MAX_EXAMPLE_TEXELS,
            map.width,
            map.height
        )));
    }
    let needed = tile_count(map.width, map.height, options.min_tile) * PAPER_TILE_BYTES;
    if options.storage == DensityStorage::PaperF32 && needed > max_memory {
        return Err(BakeError::LimitExceeded(format!(
            "the paper's layout needs {needed} bytes, the limit is {max_memory}; raise --max-memory or give --storage u8"
        )));
    }
    placement::bake(map, options.roughness, placement).map(|_| ())
}

/// Tiles of all levels of an example, from tiles of `min_tile` texels on.
fn tile_count(width: u32, height: u32, min_tile: u32) -> u64 {
    bake::levels_from(width, height, min_tile)
        .iter()
        .map(|level| u64::from(level.tiles_x) * u64::from(level.tiles_y))
        .sum()
}

/// The bytes of a pack of materials.
pub fn assemble(
    materials: &[Baked],
    layers: Option<&LayeredMaterial>,
    provenance: &Provenance,
    codec: Codec,
) -> Result<Vec<u8>, Failure> {
    let mut all = Vec::new();
    for baked in materials {
        all.extend(sections::to_sections(&baked.name, &baked.material, codec));
    }
    if let Some(layers) = layers {
        all.push(Section::parameters(LAYERS, &format!("{}:{}", layers.coat, layers.base), layers));
    }
    seal(provenance, all)
}

/// The ranges of a placement.
fn ranges(placement: &PlacementOptions) -> &TransformRanges {
    match placement {
        PlacementOptions::Tiled(ranges) => ranges,
        PlacementOptions::Stochastic(options) => &options.ranges,
    }
}

/// Ranges as the flag takes them.
fn transforms_text(ranges: &TransformRanges) -> String {
    let mut parts = Vec::new();
    let mut add = |name: &str, (low, high): (f64, f64), neutral: f64| {
        if low != high {
            parts.push(format!("{name}={low}..{high}"));
        } else if low != neutral {
            parts.push(format!("{name}={low}"));
        }
    };
    add("rotate", ranges.rotate_degrees, 0.0);
    add("scale", ranges.scale, 1.0);
    add("stretch", ranges.stretch, 1.0);
    add("shear", ranges.shear, 0.0);
    if ranges.mirror {
        parts.push("mirror".into());
    }
    if parts.is_empty() { "none".into() } else { parts.join(",") }
}
