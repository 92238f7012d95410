//! `glint-bake textures`: normals and roughness as textures with mips, for engines without our shaders.

mod args;
mod encode;
mod gltf;
mod gltf_flags;
mod list;
mod material;
mod target;
mod texels;
mod udim;

pub use args::Args;

use crate::cli::{Terminal, on_threads};
use crate::depfile;
use crate::exit::{Exit, Failure};
use crate::input::load_normal_map;
use crate::output;
use crate::progress::Stages;
use crate::reading;
use encode::{Layout, Plan};
use glint_bake_core::textures::{self, TexturesOptions};
use glint_formats::WriteOutcome;
use list::List;
use material::Material;
use std::path::{Path, PathBuf};
use target::{AxesArg, Channel};
use texels::Texels;

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
    let list_path = args.output.join(format!("{stem}{number}.json"));
    let depends: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    let rule = args.depfile.as_ref().map(|_| depfile::rule(&list_path, &depends)).transpose()?;

    let loaded = load_normal_map(map, &args.input.options(args.max_memory))?;
    for warning in &loaded.warnings {
        terminal.warn(&format!("{}: {warning}", map.display()));
    }
    let material = Material::load(args, &loaded.map, terminal)?;
    let size = (loaded.map.width, loaded.map.height);
    let options = TexturesOptions { max_memory: args.max_memory, anisotropy: args.anisotropy.map(AxesArg::axes) };
    options.check(&loaded.map).map_err(|e| Failure::bake(map, &e))?;
    material.roughness.validate(&loaded.map).map_err(Failure::from)?;

    // BC5 has two channels.
    let two_channel = args.two_channel || args.blocks;
    let normal_plan = Plan {
        name: format!("{stem}_normal{number}"),
        channels: if two_channel { 2 } else { 4 },
        opaque: !two_channel,
        size,
    };
    let companions: Vec<(Plan, &[Channel])> = args
        .companions()
        .into_iter()
        .map(|(suffix, channels)| {
            let opaque = channels.last() == Some(&Channel::One);
            (Plan { name: format!("{stem}_{suffix}{number}"), channels: channels.len(), opaque, size }, channels)
        })
        .collect();
    let plans = || std::iter::once(&normal_plan).chain(companions.iter().map(|(plan, _)| plan));
    for plan in plans() {
        check_size(args, &layout, plan)?;
    }
    let names = plans().flat_map(|plan| layout.files(plan));
    let mut paths: Vec<PathBuf> = names.map(|name| args.output.join(name)).collect();
    paths.push(list_path.clone());
    paths.extend(args.depfile.clone());
    output::check_distinct(&paths.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &depends)?;
    if args.dry_run {
        if args.output.exists() {
            paths.iter().try_for_each(|path| output::check_writable(path))?;
        }
        for path in &paths {
            terminal.say(&format!("would write {}", path.display()));
        }
        terminal.say("dry run, nothing was written");
        return Ok(());
    }
    output::create_folder(&args.output)?;
    paths.iter().try_for_each(|path| output::check_writable(path))?;

    let stages = Stages::new(terminal);
    let baked =
        textures::bake(&loaded.map, &material.roughness, &options, &stages).map_err(|e| Failure::bake(map, &e))?;
    let texels = Texels::new(&loaded.map, &material, &baked.levels, args.target);
    let mut list = List::new(args, &loaded, &material);
    let mut write = |plan: &Plan, value: &(dyn Fn(usize, usize) -> [f32; 4] + Sync)| -> Result<(), Failure> {
        for (name, bytes) in layout.files(plan).into_iter().zip(layout.encode(plan, value)?) {
            let path = args.output.join(&name);
            let outcome = output::write(&path, &bytes)?;
            terminal.say(&format!("{}: {}", path.display(), said(outcome)));
            list.add(name, &bytes);
        }
        Ok(())
    };
    let down = args.green_down();
    write(&normal_plan, &|level, k| texels.normal(level, k, down))?;
    let stored = args.stored();
    for (plan, channels) in &companions {
        write(plan, &|level, k| texels.channels(channels, stored, level, k))?;
    }
    if let (Some(path), Some(rule)) = (&args.depfile, rule) {
        output::write(path, rule.as_bytes())?;
    }
    // The list comes last: who finds it finds the files.
    let outcome = output::write(&list_path, list.to_json().as_bytes())?;
    terminal.say(&format!("{}: {}", list_path.display(), said(outcome)));
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
