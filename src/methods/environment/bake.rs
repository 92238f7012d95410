//! `glint-bake environment`: an equirectangular HDR image in, a verified pack of filtered radiance and levels out.

use super::args::Args;
use crate::cli::Terminal;
use crate::exit::Failure;
use crate::input::environment::{LoadedEnvironment, load_environment};
use crate::methods::bake::FinishedPack;
use crate::methods::method::provenance;
use crate::pack;
use crate::progress::Stages;
use crate::quantities::kib;
use glint_bake_core::environment::{
    Environment, EnvironmentImage, EnvironmentOptions, bake as bake_environment, quality, sections,
};
use glint_bake_core::error::BakeError;
use glint_bake_core::progress::Silent;
use glint_formats::Codec;
use glint_formats::environment::EnvironmentParams;
use glint_formats::provenance::Provenance;
use std::path::Path;

/// What makes an environment smaller.
const SMALLER: &str = "give a smaller --face-size or fewer --levels";

/// Checks everything, then bakes.
pub fn bake(args: &Args, terminal: Terminal) -> Result<Option<FinishedPack>, Failure> {
    let options = checked_options(args)?;
    let delivery = args.delivery();
    delivery.check()?;
    delivery.check_size(options.texture_bytes(), SMALLER)?;
    let loaded = load_environment(&args.input, args.layer.as_deref(), args.run.max_memory)?;
    for warning in &loaded.warnings {
        terminal.warn(&format!("{}: {warning}", args.input.display()));
    }
    let needed = options.working_bytes(&loaded.image, rayon::current_num_threads() as u64);
    if needed > args.run.max_memory {
        return Err(Failure::bake(
            &args.input,
            &BakeError::LimitExceeded(format!(
                "the bake needs about {needed} bytes, the limit is {}; raise --max-memory, scale the image down, or {SMALLER}",
                args.run.max_memory
            )),
        ));
    }
    if args.run.dry_run {
        terminal.say(&format!(
            "would write {}: {} × {} pixels into a mirror of {} texels and {} filtered roughnesses, at most {}, with about {} of \
             memory; dry run, nothing was written",
            args.output.display(),
            loaded.image.width,
            loaded.image.height,
            options.face_size,
            options.filtered(),
            kib(options.texture_bytes()),
            kib(needed)
        ));
        return Ok(None);
    }
    let stages = Stages::new(terminal);
    let environment =
        bake_environment(&loaded.image, &options, &stages).map_err(|error| Failure::bake(&args.input, &error))?;
    warn_of_rounding(&environment.params, &args.input, terminal);
    let bytes = sealed(args, &loaded, &environment)?;
    Ok(Some(FinishedPack { bytes, smaller: SMALLER }))
}

/// Half floats cannot hold every sun: says where they alone are off by more than was asked.
fn warn_of_rounding(params: &EnvironmentParams, input: &Path, terminal: Terminal) {
    for (index, rounding) in params.measured.rounding.iter().enumerate() {
        let most = quality::allowed_error(params, index);
        if *rounding > most {
            terminal.warn(&format!(
                "{}: roughness {:.4}: half floats alone make an error of {rounding:.4} of the mean, more than the {most} asked; \
                 give a larger --filter-error",
                input.display(),
                params.roughness[index]
            ));
        }
    }
}

/// A bake that is only looked at: image and environment, and the bytes that the pack would have.
pub fn draft(args: &Args) -> Result<((EnvironmentImage, Environment), u64), Failure> {
    let options = checked_options(args)?;
    let loaded = load_environment(&args.input, args.layer.as_deref(), args.run.max_memory)?;
    let environment =
        bake_environment(&loaded.image, &options, &Silent).map_err(|error| Failure::bake(&args.input, &error))?;
    let bytes = sealed(args, &loaded, &environment)?.len() as u64;
    Ok(((loaded.image, environment), bytes))
}

/// The options, once they are known to make sense. Flags have the names of the options.
fn checked_options(args: &Args) -> Result<EnvironmentOptions, Failure> {
    let options = args.options();
    options.validate().map_err(|error| Failure::usage(format!("--{error}")))?;
    Ok(options)
}

/// The bytes of the pack.
fn sealed(args: &Args, loaded: &LoadedEnvironment, environment: &Environment) -> Result<Vec<u8>, Failure> {
    let codec = if args.compress { Codec::Zstd } else { Codec::None };
    let sections = sections::to_sections(&args.name(), environment, codec);
    let provenance = Provenance {
        inputs: vec![loaded.digest.clone()],
        notes: loaded.warnings.iter().map(|warning| format!("{}: {warning}", loaded.digest.name)).collect(),
        ..provenance::<Args>("environment", args.option_list())
    };
    pack::seal(&provenance, sections)
}
