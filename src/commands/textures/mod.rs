//! `glint-bake textures`: normals and roughness as textures with mips, for engines without our shaders.

mod args;
mod encode;
mod list;
mod material;
mod target;

pub use args::Args;

use crate::cli::{Terminal, on_threads};
use crate::depfile;
use crate::exit::{Exit, Failure};
use crate::input::load_normal_map;
use crate::output;
use crate::progress::Stages;
use crate::reading;
use encode::{Layout, Plan};
use glint_bake_core::textures::{self, Level, TexturesOptions};
use glint_formats::WriteOutcome;
use list::List;
use material::Material;
use std::path::{Path, PathBuf};
use target::Channel;

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    on_threads(args.threads, || bake(args, terminal))?
}

/// Checks everything, then bakes and writes.
fn bake(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let (stem, layout) = (args.stem()?, args.layout()?);
    let inputs = args.inputs();
    check_streams(args, &inputs)?;
    for path in &inputs {
        reading::check_readable(path).map_err(|e| Failure::io(path, "cannot be read", &e))?;
    }
    let list_path = args.output.join(format!("{stem}.json"));
    let depends: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    let rule = args.depfile.as_ref().map(|_| depfile::rule(&list_path, &depends)).transpose()?;

    let loaded = load_normal_map(&args.map, &args.input.options(args.max_memory))?;
    for warning in &loaded.warnings {
        terminal.warn(&format!("{}: {warning}", args.map.display()));
    }
    let material = Material::load(args, &loaded.map, terminal)?;
    let size = (loaded.map.width, loaded.map.height);
    let options = TexturesOptions { max_memory: args.max_memory };
    options.check(&loaded.map).map_err(|e| Failure::bake(&args.map, &e))?;
    material.roughness.validate(&loaded.map).map_err(Failure::from)?;

    // BC5 has two channels.
    let two_channel = args.two_channel || args.blocks;
    let normal_plan =
        Plan { name: format!("{stem}_normal"), channels: if two_channel { 2 } else { 4 }, opaque: !two_channel, size };
    let companions: Vec<(Plan, &[Channel])> = args
        .companions()
        .into_iter()
        .map(|(suffix, channels)| {
            let opaque = channels.last() == Some(&Channel::One);
            (Plan { name: format!("{stem}_{suffix}"), channels: channels.len(), opaque, size }, channels)
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
    let baked = textures::bake(&loaded.map, &material.roughness, &options, &stages)
        .map_err(|e| Failure::bake(&args.map, &e))?;
    let finest = Finest { map: &loaded.map, material: &material };
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
    write(&normal_plan, &|level, k| {
        let [x, y] = if level == 0 { finest.map.projected[k] } else { baked.levels[level - 1].normals[k] };
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        [0.5 + 0.5 * x, if down { 0.5 - 0.5 * y } else { 0.5 + 0.5 * y }, 0.5 + 0.5 * z, 1.0]
    })?;
    let occlusion = material.levels(material.occlusion.as_deref(), size);
    let metallic = material.levels(material.metallic.as_deref(), size);
    let stored = args.stored();
    for (plan, channels) in &companions {
        write(plan, &|level, k| {
            let mut texel = [0.0; 4];
            for (value, channel) in texel.iter_mut().zip(*channels) {
                *value = match channel {
                    Channel::Roughness => stored.of_alpha(finest.alpha(&baked.levels, level, k)),
                    Channel::Occlusion => occlusion.value(level, k),
                    Channel::Metallic => metallic.value(level, k),
                    Channel::One => 1.0,
                };
            }
            texel
        })?;
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

/// Level 0.
struct Finest<'a> {
    map: &'a glint_bake_core::normal_map::NormalMap,
    material: &'a Material,
}

impl Finest<'_> {
    fn alpha(&self, levels: &[Level], level: usize, k: usize) -> f32 {
        match level {
            0 => self.material.roughness.texel(k).powi(2),
            _ => levels[level - 1].alphas[k],
        }
    }
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
        let uses = [Some(&args.map), args.roughness_map.as_ref(), args.occlusion.as_ref(), args.metallic.as_ref()];
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
