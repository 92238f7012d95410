//! `glint-bake area-light`: one normal map in, a verified pack out. First everything is checked, then work begins.

use super::args::Args;
use crate::cli::Terminal;
use crate::commands::bake::Delivery;
use crate::exit::Failure;
use crate::input::{LoadedMap, digest, load_normal_map};
use crate::pack;
use crate::progress::Stages;
use crate::quantities::kib;
use glint_bake_core::area_light::{self, AreaLightMaterial, sections};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_formats::Codec;
use glint_formats::container::full_mip_count;
use glint_formats::provenance::{InputDigest, Provenance};

/// What makes a pack smaller.
const SMALLER: &str = "give --format snorm8, or a part of the map with --crop";

/// Runs the subcommand.
pub fn run(args: Args, terminal: Terminal) -> Result<(), Failure> {
    let threads = args.run.threads;
    crate::cli::on_threads(threads, || bake(&args, terminal))?
}

/// A bake that is only looked at: map and material, and the bytes that the pack would have.
pub fn draft(args: &Args) -> Result<((NormalMap, AreaLightMaterial), u64), Failure> {
    let options = args.options();
    options.validate()?;
    let name = args.name()?;
    let loaded = load_normal_map(&args.map, &args.input.options(args.run.max_memory))?;
    let digest = digest(&args.map, &loaded)?;
    let material = area_light::bake(&loaded.map, &options, &Silent).map_err(|e| Failure::bake(&args.map, &e))?;
    let codec = if args.compress { Codec::Zstd } else { Codec::None };
    let sections = sections::to_sections(&name, &material, codec);
    let bytes = pack::seal(&args.provenance(&loaded, digest), sections)?.len() as u64;
    Ok(((loaded.map, material), bytes))
}

fn bake(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let options = args.options();
    options.validate()?;
    let name = args.name()?;
    let inputs = [args.map.clone()];
    let delivery = Delivery { output: &args.output, inputs: &inputs, run: &args.run };
    delivery.check()?;
    let loaded = load_normal_map(&args.map, &args.input.options(args.run.max_memory))?;
    let digest = digest(&args.map, &loaded)?;
    for warning in &loaded.warnings {
        terminal.warn(&format!("{}: {warning}", args.map.display()));
    }
    let (width, height) = (loaded.map.width, loaded.map.height);
    let bytes = args.map_bytes(width, height);
    area_light::bake::check(&loaded.map, &options).map_err(|e| Failure::bake(&args.map, &e))?;
    delivery.check_size(bytes, SMALLER)?;
    let line = {
        let skipped = args.skip_mips.min(full_mip_count(width, height) - 1);
        let (width, height) = ((width >> skipped).max(1), (height >> skipped).max(1));
        format!("{width} × {height} texels, {} mips, {}", full_mip_count(width, height), kib(bytes))
    };
    if args.run.dry_run {
        let output = args.output.display();
        terminal.say(&format!("would write {output}: \"{name}\", {line}; dry run, nothing was written"));
        return Ok(());
    }
    terminal.detail(&format!("{}: {line}, {}", args.map.display(), loaded.convention));
    let stages = Stages::new(terminal);
    let material = area_light::bake(&loaded.map, &options, &stages).map_err(|e| Failure::bake(&args.map, &e))?;
    let codec = if args.compress { Codec::Zstd } else { Codec::None };
    let sections = sections::to_sections(&name, &material, codec);
    drop(material);
    let bytes = pack::seal(&args.provenance(&loaded, digest), sections)?;
    delivery.write(bytes, SMALLER, terminal)
}

impl Args {
    /// Bytes of the textures of a map.
    fn map_bytes(&self, width: u32, height: u32) -> u64 {
        let mips = full_mip_count(width, height);
        let texels: u64 = (self.skip_mips.min(mips - 1)..mips)
            .map(|mip| u64::from((width >> mip).max(1)) * u64::from((height >> mip).max(1)))
            .sum();
        let textures = if self.anisotropic { 2 } else { 1 };
        texels * textures * self.options().storage.texel_bytes() as u64
    }

    /// Where the pack comes from. Flags that do not change its bytes are left out.
    fn provenance(&self, loaded: &LoadedMap, digest: InputDigest) -> Provenance {
        let mut options = vec![
            ("base-roughness", self.base_roughness.to_string()),
            ("anisotropic", self.anisotropic.to_string()),
            ("format", format!("{:?}", self.format).to_ascii_lowercase()),
        ];
        if self.skip_mips > 0 {
            options.push(("skip-mips", self.skip_mips.to_string()));
        }
        options.extend(self.input.provenance());
        let notes = loaded.warnings.iter().map(|warning| format!("{}: {warning}", digest.name)).collect();
        Provenance {
            options: options.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
            inputs: vec![digest],
            normal_convention: self.input.normal_convention(),
            notes,
            ..pack::provenance("area-light")
        }
    }
}
