//! `glint-bake area-light`: one normal map in, a verified pack out. First everything is checked, then work begins.

use super::args::Args;
use crate::cli::Terminal;
use crate::exit::Failure;
use crate::input::{LoadedMap, load_normal_map};
use crate::methods::bake::FinishedPack;
use crate::methods::method::provenance;
use crate::pack;
use crate::progress::Stages;
use crate::quantities::kib;
use glint_bake_core::area_light::{self, AreaLightMaterial, sections};
use glint_bake_core::error::BakeError;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_formats::Codec;
use glint_formats::container::full_mip_count;
use glint_formats::provenance::Provenance;

/// What makes a pack smaller.
const SMALLER: &str = "give --format snorm8, or a part of the map with --crop";

/// A bake that is only looked at: map and material, and the bytes that the pack would have.
pub fn draft(args: &Args) -> Result<((NormalMap, AreaLightMaterial), u64), Failure> {
    let options = args.options();
    options.validate()?;
    let name = args.name()?;
    let loaded = load_normal_map(&args.map, &args.input.options(args.run.max_memory))?;
    let material = area_light::bake(&loaded.map, &options, &Silent).map_err(|e| Failure::bake(&args.map, &e))?;
    let codec = if args.compress { Codec::Zstd } else { Codec::None };
    let sections = sections::to_sections(&name, &material, codec);
    let bytes = pack::seal(&provenance_of(args, &loaded), sections)?.len() as u64;
    Ok(((loaded.map, material), bytes))
}

/// Checks everything, then bakes.
pub fn bake(args: &Args, terminal: Terminal) -> Result<Option<FinishedPack>, Failure> {
    let options = args.options();
    options.validate()?;
    let name = args.name()?;
    let delivery = args.delivery();
    delivery.check()?;
    let loaded = load_normal_map(&args.map, &args.input.options(args.run.max_memory))?;
    for warning in &loaded.warnings {
        terminal.warn(&format!("{}: {warning}", args.map.display()));
    }
    let (width, height) = (loaded.map.width, loaded.map.height);
    let bytes = map_bytes(args, width, height);
    area_light::bake::check(&loaded.map, &options).map_err(|e| refusal(args, &e))?;
    delivery.check_size(bytes, SMALLER)?;
    let line = {
        let skipped = args.skip_mips.min(full_mip_count(width, height) - 1);
        let (width, height) = ((width >> skipped).max(1), (height >> skipped).max(1));
        format!("{width} × {height} texels, {} mips, {}", full_mip_count(width, height), kib(bytes))
    };
    if args.run.dry_run {
        let output = args.output.display();
        terminal.say(&format!("would write {output}: \"{name}\", {line}; dry run, nothing was written"));
        return Ok(None);
    }
    terminal.detail(&format!("{}: {line}, {}", args.map.display(), loaded.convention));
    let stages = Stages::new(terminal);
    let material = area_light::bake(&loaded.map, &options, &stages).map_err(|e| Failure::bake(&args.map, &e))?;
    let codec = if args.compress { Codec::Zstd } else { Codec::None };
    let sections = sections::to_sections(&name, &material, codec);
    drop(material);
    let bytes = pack::seal(&provenance_of(args, &loaded), sections)?;
    Ok(Some(FinishedPack { bytes, smaller: SMALLER }))
}

/// Why a map is refused, and which flags would help.
fn refusal(args: &Args, error: &BakeError) -> Failure {
    let failure = Failure::bake(&args.map, error);
    let flags = match error {
        BakeError::LimitExceeded(_) => "; raise --max-memory, or use --crop WxH+X+Y",
        BakeError::BadInput(_) => "; see --skip-mips and --crop",
        BakeError::BadOption(_) => "",
    };
    Failure { message: failure.message + flags, ..failure }
}

/// Bytes of the textures of a map.
fn map_bytes(args: &Args, width: u32, height: u32) -> u64 {
    let mips = full_mip_count(width, height);
    let texels: u64 = (args.skip_mips.min(mips - 1)..mips)
        .map(|mip| u64::from((width >> mip).max(1)) * u64::from((height >> mip).max(1)))
        .sum();
    let textures = if args.anisotropic { 2 } else { 1 };
    texels * textures * args.options().storage.texel_bytes() as u64
}

/// Where the pack comes from.
fn provenance_of(args: &Args, loaded: &LoadedMap) -> Provenance {
    let notes = loaded.warnings.iter().map(|warning| format!("{}: {warning}", loaded.digest.name)).collect();
    Provenance {
        inputs: vec![loaded.digest.clone()],
        normal_convention: args.input.normal_convention(),
        notes,
        ..provenance::<Args>("area-light", args.option_list())
    }
}
