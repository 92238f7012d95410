//! `glint-bake ndf-maps`: normal maps in, a verified pack out. What a bake will do is checked before any of it is done:
//! names, options, inputs, output paths.

use super::args::Args;
use super::info::pixel_text;
use crate::cli::Terminal;
use crate::cli::normal_maps::{Names, check_name};
use crate::exit::{Exit, Failure};
use crate::input::{LoadedMap, load_normal_map};
use crate::methods::bake::FinishedPack;
use crate::methods::method::provenance;
use crate::pack::seal;
use crate::progress::Stages;
use crate::quantities::percent;
use glint_bake_core::error::{BakeError, Result as BakeResult};
use glint_bake_core::ndf_maps::bake as ndf_bake;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::options::{NdfMapsOptions, Options, PlacementOptions, WORST_OF_MEAN, check_size};
use glint_bake_core::ndf_maps::placement::place;
use glint_bake_core::ndf_maps::sections;
use glint_bake_core::ndf_maps::windows::levels;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::{Progress, Silent};
use glint_formats::Codec;
use glint_formats::container::MAX_NAME_BYTES;
use glint_formats::ndf_maps::{LayeredMaterial, Level};
use glint_formats::provenance::Provenance;
use std::path::PathBuf;

/// Mean errors of pixels above this are said.
const PIXEL_WARNING: f64 = 0.05;

/// A bake that is only looked at: maps and materials, and the bytes that the pack would have.
pub fn draft(args: &Args) -> Result<(Vec<(NormalMap, Material)>, u64), Failure> {
    let job = Job::unwritten(args)?;
    let (materials, bytes) = job.bake(&Silent)?;
    let made = job.sources.into_iter().zip(materials).map(|(source, baked)| (source.loaded.map, baked.material));
    Ok((made.collect(), bytes.len() as u64))
}

/// Checks everything, then bakes.
pub fn bake(args: &Args, terminal: Terminal) -> Result<Option<FinishedPack>, Failure> {
    let job = Job::new(args)?;
    for source in &job.sources {
        for warning in &source.loaded.warnings {
            terminal.warn(&format!("{}: {warning}", source.path.display()));
        }
        terminal.detail(&input_line(source));
    }
    if args.run.dry_run {
        terminal.say(&dry_run_text(&job));
        return Ok(None);
    }
    let (materials, bytes) = job.bake(&Stages::new(terminal))?;
    for (source, baked) in job.sources.iter().zip(&materials) {
        let pixel = &baked.material.maps.params.pixel;
        if pixel.mean > PIXEL_WARNING {
            terminal.warn(&format!(
                "{}: expected E1 of a pixel of at most {} on average, found {}; give a smaller --max-error or a larger --roughness",
                source.path.display(),
                percent(PIXEL_WARNING),
                pixel_text(pixel)
            ));
        }
    }
    Ok(Some(FinishedPack { bytes, smaller: "--max-error" }))
}

/// One map that becomes one material.
struct Source {
    /// The file.
    path: PathBuf,
    /// Name of the material.
    name: String,
    /// The map.
    loaded: LoadedMap,
}

/// A bake that can go ahead.
struct Job<'a> {
    /// The flags it was asked for with.
    args: &'a Args,
    /// The maps, in the order given.
    sources: Vec<Source>,
    /// Options of every map's bake.
    options: NdfMapsOptions,
    /// Options of every map's placement.
    placement: PlacementOptions,
    /// The two-layer material.
    layers: Option<LayeredMaterial>,
}

impl<'a> Job<'a> {
    /// Checks arguments, then paths, then the content of the inputs.
    fn new(args: &'a Args) -> Result<Job<'a>, Failure> {
        Job::checked(args, true)
    }

    /// The same for a bake that is only looked at.
    fn unwritten(args: &'a Args) -> Result<Job<'a>, Failure> {
        Job::checked(args, false)
    }

    fn checked(args: &'a Args, writes: bool) -> Result<Job<'a>, Failure> {
        let options = args.options()?;
        let placement = args.placement_options()?;
        let names = names(args)?;
        let layers = args.layers.as_ref().map(|text| layers(text, &names, args)).transpose()?;
        if writes {
            args.delivery().check()?;
        }
        let input = args.input.options(args.run.max_memory);
        let mut sources = Vec::new();
        for (path, name) in args.maps.iter().zip(names) {
            let loaded = load_normal_map(path, &input)?;
            check_material(&loaded.map, &options, &placement).map_err(|e| Failure::bake(path, &e))?;
            sources.push(Source { path: path.clone(), name, loaded });
        }
        Ok(Job { args, sources, options, placement, layers })
    }

    /// Bakes every map: the materials, and the bytes of the pack.
    fn bake(&self, progress: &dyn Progress) -> Result<(Vec<Baked>, Vec<u8>), Failure> {
        let mut materials = Vec::new();
        for source in &self.sources {
            let material = bake_material(&source.loaded.map, &self.options, &self.placement, progress)
                .map_err(|e| Failure::bake(&source.path, &e))?;
            self.check_error(source, &material)?;
            materials.push(Baked { name: source.name.clone(), material });
        }
        let codec = if self.args.compress { Codec::Zstd } else { Codec::None };
        let bytes = assemble(&materials, self.layers.as_ref(), &self.provenance(), codec)?;
        Ok((materials, bytes))
    }

    /// When the user named an error, missing it is a failure: on average, or by more than three times anywhere.
    fn check_error(&self, source: &Source, material: &Material) -> Result<(), Failure> {
        let Some(asked) = self.args.max_error else { return Ok(()) };
        let measured = &material.maps.params.measured;
        // The bake works with the same numbers, so only rounding can come between.
        let kept = |found: f64, most: f64| found <= most * (1.0 + 1e-6);
        if kept(measured.mean, asked) && kept(measured.worst, WORST_OF_MEAN * asked) {
            return Ok(());
        }
        let message = format!(
            "{}: expected E1 of {asked} on average and {} at the worst, found {:.5} and {:.5}; nothing was written. Raise \
             --max-error or --roughness",
            source.path.display(),
            WORST_OF_MEAN * asked,
            measured.mean,
            measured.worst
        );
        Err(Failure::new(Exit::LimitExceeded, message))
    }

    /// Where the pack comes from.
    fn provenance(&self) -> Provenance {
        let remark = |source: &Source, warning: &String| format!("{}: {warning}", source.loaded.digest.name);
        Provenance {
            seed: self.args.seed,
            inputs: self.sources.iter().map(|source| source.loaded.digest.clone()).collect(),
            normal_convention: self.args.input.normal_convention(),
            notes: self.sources.iter().flat_map(|s| s.loaded.warnings.iter().map(|w| remark(s, w))).collect(),
            ..provenance::<Args>("ndf-maps", self.args.option_list(&self.options, &self.placement))
        }
    }
}

/// One name a map: those given, then file stems made unique by a number.
fn names(args: &Args) -> Result<Vec<String>, Failure> {
    if args.name.len() > args.maps.len() {
        let (names, maps) = (args.name.len(), args.maps.len());
        return Err(Failure::usage(format!("--name: expected at most one a map, found {names} names for {maps} maps")));
    }
    let mut names: Vec<String> = Vec::new();
    let mut taken = Names::default();
    for name in &args.name {
        check_name(name)?;
        if !taken.take(name) {
            return Err(Failure::usage(format!(
                "--name: {name:?} is given twice; give each material a name of its own"
            )));
        }
        names.push(name.clone());
    }
    for path in &args.maps[names.len()..] {
        names.push(taken.of_file(path));
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
        source.loaded.digest.bytes,
        source.name
    )
}

/// What a dry run would do.
fn dry_run_text(job: &Job) -> String {
    let mut lines = Vec::new();
    for source in &job.sources {
        let (width, height) = (source.loaded.map.width, source.loaded.map.height);
        lines.push(format!(
            "would bake {} as \"{}\": {width} × {height} texels, {} nodes",
            source.path.display(),
            source.name,
            levels(width, height, job.options.finest_window).iter().map(Level::nodes).sum::<u64>()
        ));
    }
    let output = job.args.output.display();
    lines.push(format!(
        "would write {output}: σ_r {}, E₁ {} asked; dry run, nothing was written",
        job.options.roughness,
        percent(job.options.max_error)
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
    ndf_bake::bake(map, &Options { maps: options.clone(), placement: *placement }, progress)
}

/// What would stop [`bake_material`], found without the work.
fn check_material(map: &NormalMap, options: &NdfMapsOptions, placement: &PlacementOptions) -> BakeResult<()> {
    check_size(map).map_err(|error| match error {
        BakeError::LimitExceeded(why) => BakeError::LimitExceeded(format!(
            "{why} with --crop WxH+X+Y, or bake all of it with glint-bake lobes (in a project: method = \"lobes\" in a table \
             without distance)"
        )),
        other => other,
    })?;
    place(map, options.roughness, placement).map(|_| ())
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
        all.extend(sections::layer_sections(&format!("{}:{}", layers.coat, layers.base), layers));
    }
    seal(provenance, all)
}
