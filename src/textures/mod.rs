//! `glint-bake textures`: normals and roughness as textures with mips, for engines without our shaders.

mod args;
mod encode;
mod files;
mod gltf;
mod gltf_flags;
mod leaning;
mod list;
mod material;
mod target;
mod texels;
mod tile_names;
mod udim;
mod wanted;

pub use args::Args;
pub use files::files_of;

use crate::cli::{Terminal, on_threads};
use crate::depfile;
use crate::exit::{Exit, Failure};
use crate::input::{InputOptions, load_normal_map};
use crate::output;
use crate::progress::Stages;
use crate::reading;
use encode::{Layout, Plan};
use glint_bake_core::textures::{self, TexturesOptions};
use glint_formats::WriteOutcome;
use list::List;
use material::Material;
use std::path::{Path, PathBuf};
use target::AxesArg;
use texels::Texels;

/// Name of the subcommand.
pub const NAME: &str = "textures";

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    args.check()?;
    on_threads(args.threads, || match (&args.gltf.gltf, &args.map) {
        (Some(file), _) => gltf::run(file, args, terminal),
        (None, Some(map)) => match udim::tiles(args)? {
            None => bake(map, args, terminal),
            Some(tiles) => tiles.iter().try_for_each(|tile| bake(tile.map.as_deref().unwrap_or(map), tile, terminal)),
        },
        (None, None) => Err(Failure::usage("expected a normal map, or a glTF file as --gltf FILE, found neither")),
    })?
}

/// Checks everything, then bakes and writes.
fn bake(map: &Path, args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let (stem, number, layout) = (args.stem(map)?, args.number(), args.layout()?);
    let inputs = args.inputs();
    check_streams(args, &inputs)?;
    for path in &inputs {
        reading::check_readable(path).map_err(|e| Failure::io(path, "cannot be read", &e))?;
    }
    let file = wanted::file(args, &layout)?;
    let list_path = args.output.join(format!("{stem}{number}.json"));
    // What is written last: one file has no list.
    let last = file.unwrap_or(&list_path);
    let depends: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    let rule = args.depfile.as_ref().map(|_| depfile::rule(last, &depends)).transpose()?;

    let input = InputOptions { alpha: args.alpha_use(), ..args.input.options(args.max_memory) };
    let mut loaded = load_normal_map(map, &input)?;
    if args.blocks && args.keeps_alpha() {
        loaded.warnings.push("normals with alpha are in BC7 instead of BC5, which has none".into());
    }
    for warning in &loaded.warnings {
        terminal.warn(&format!("{}: {warning}", map.display()));
    }
    let material = Material::load(args, &loaded.map, loaded.alpha.take(), terminal)?;
    let size = (loaded.map.width, loaded.map.height);
    let options = TexturesOptions { max_memory: args.max_memory, anisotropy: args.anisotropy.map(AxesArg::axes) };
    options.check(&loaded.map).map_err(|e| Failure::bake(map, &e))?;
    material.roughness.validate(&loaded.map).map_err(Failure::from)?;

    let wanted = wanted::textures(args, &stem, &number, size)?;
    for texture in &wanted {
        check_size(args, &layout, &texture.plan)?;
    }
    let mut paths: Vec<PathBuf> =
        wanted.iter().flat_map(|texture| wanted::paths(args, &layout, file, texture)).collect();
    if file.is_none() {
        paths.push(list_path.clone());
    }
    paths.extend(args.depfile.clone());
    output::check_distinct(&paths.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &depends)?;
    if args.dry_run {
        if args.output.exists() || file.is_some() {
            paths.iter().try_for_each(|path| output::check_writable(path))?;
        }
        for path in &paths {
            terminal.say(&format!("would write {}", path.display()));
        }
        terminal.say("dry run, nothing was written");
        return Ok(());
    }
    if file.is_none() {
        output::create_folder(&args.output)?;
    }
    paths.iter().try_for_each(|path| output::check_writable(path))?;

    let stages = Stages::new(terminal);
    let baked =
        textures::bake(&loaded.map, &material.roughness, &options, &stages).map_err(|e| Failure::bake(map, &e))?;
    let texels = Texels::new(&loaded.map, &material, &baked.levels, args.target);
    let mut list = List::new(args, &loaded, &material);
    if let Some(warning) = leaning::warning(&baked.against_round) {
        terminal.warn(&format!("{}: {warning}", map.display()));
        list.note(warning);
    }
    let (down, stored) = (args.green_down(), args.stored());
    for texture in &wanted {
        let bytes = match texture.channels {
            None => layout.encode(&texture.plan, &|level, k| texels.normal(level, k, down))?,
            Some(channels) => layout.encode(&texture.plan, &|level, k| texels.channels(channels, stored, level, k))?,
        };
        for (path, bytes) in wanted::paths(args, &layout, file, texture).iter().zip(bytes) {
            let outcome = output::write(path, &bytes)?;
            terminal.say(&format!("{}: {}", path.display(), said(outcome)));
            list.add(reading::file_name(path).to_string_lossy().into_owned(), &bytes);
        }
    }
    if let (Some(path), Some(rule)) = (&args.depfile, rule) {
        output::write(path, rule.as_bytes())?;
    }
    // The list comes last: who finds it finds the files.
    if file.is_none() {
        let outcome = output::write(&list_path, list.to_json().as_bytes())?;
        terminal.say(&format!("{}: {}", list_path.display(), said(outcome)));
    }
    if args.json {
        output::print(&list.to_json())?;
    }
    Ok(())
}

/// Pipes are read once, and nothing depends on them.
fn check_streams(args: &Args, inputs: &[PathBuf]) -> Result<(), Failure> {
    if reading::is_standard(&args.output) {
        return Err(Failure::usage(
            "-: expected a folder, since there are several files to write; one of this name is ./-",
        ));
    }
    if args.depfile.as_deref().is_some_and(reading::is_standard) {
        return Err(Failure::usage("--depfile: - is not taken; name a file"));
    }
    let stream = inputs.iter().find(|path| reading::is_stream(path));
    if let Some(path) = stream {
        if args.depfile.is_some() {
            return Err(Failure::usage("--depfile: nothing can depend on a pipe or on standard input; name files"));
        }
        let uses = [args.map.as_ref(), args.roughness_map.as_ref(), args.occlusion.as_ref(), args.metallic.as_ref()];
        if uses.iter().flatten().filter(|other| **other == path).count() > 1 {
            let message =
                format!("{}: is given twice, and can be read once only; save it as a file first", path.display());
            return Err(Failure::usage(message));
        }
    }
    Ok(())
}

fn check_size(args: &Args, layout: &Layout, plan: &Plan) -> Result<(), Failure> {
    let (found, limit) = (layout.payload_bytes(plan), args.max_memory);
    if found <= limit {
        return Ok(());
    }
    let message = format!(
        "{} has {found} bytes, the limit is {limit}; raise --max-memory, or use a part of the map with --crop",
        plan.name
    );
    Err(Failure::new(Exit::LimitExceeded, message))
}

fn said(outcome: WriteOutcome) -> &'static str {
    match outcome {
        WriteOutcome::Written => "written",
        WriteOutcome::Unchanged => "unchanged",
    }
}
