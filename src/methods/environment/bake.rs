//! `glint-bake environment`: an equirectangular HDR image in, a verified pack of filtered radiance and levels out.

use super::args::{Args, KernelArg, LevelChoiceArg};
use crate::cli::Terminal;
use crate::commands::bake::Delivery;
use crate::exit::Failure;
use crate::input::environment::{LoadedEnvironment, load_environment};
use crate::pack;
use crate::progress::Stages;
use crate::quantities::kib;
use glint_bake_core::environment::{Environment, EnvironmentImage, bake, quality, sections};
use glint_bake_core::error::BakeError;
use glint_bake_core::progress::Silent;
use glint_formats::Codec;
use glint_formats::environment::EnvironmentParams;
use glint_formats::provenance::Provenance;
use std::path::Path;

/// What makes an environment smaller.
const SMALLER: &str = "give a smaller --face-size or fewer --levels";

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    crate::cli::on_threads(args.run.threads, || bake_pack(args, terminal))?
}

fn bake_pack(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let options = args.options();
    options.validate()?;
    let inputs = [args.input.clone()];
    let delivery = Delivery { output: &args.output, inputs: &inputs, run: &args.run };
    delivery.check()?;
    delivery.check_size(options.texture_bytes(), SMALLER)?;
    let loaded = load_environment(&args.input, args.run.max_memory)?;
    for warning in &loaded.warnings {
        terminal.warn(&format!("{}: {warning}", args.input.display()));
    }
    let needed = options.working_bytes(&loaded.image);
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
            "would write {}: {} × {} pixels into faces of {} texels, {} mips, at most {}; dry run, nothing was written",
            args.output.display(),
            loaded.image.width,
            loaded.image.height,
            options.face_size,
            options.mips(),
            kib(options.texture_bytes())
        ));
        return Ok(());
    }
    let stages = Stages::new(terminal);
    let environment = bake(&loaded.image, loaded.negative_pixels, &options, &stages)
        .map_err(|error| Failure::bake(&args.input, &error))?;
    warn_of_rounding(&environment.params, &args.input, terminal);
    let codec = if args.compress { Codec::Zstd } else { Codec::None };
    let sections = sections::to_sections(&args.name(), &environment, codec);
    let bytes = pack::seal(&args.provenance(&loaded), sections)?;
    delivery.write(bytes, SMALLER, terminal)
}

/// Half floats cannot hold every sun: says where they alone are off by more than was asked.
fn warn_of_rounding(params: &EnvironmentParams, input: &Path, terminal: Terminal) {
    for (mip, rounding) in params.measured.rounding.iter().enumerate() {
        let most = quality::allowed_error(params, mip);
        if *rounding > most {
            terminal.warn(&format!(
                "{}: mip {mip}: half floats alone make an error of {rounding:.4} of the mean, more than the {most} asked; \
                 give --format f32",
                input.display()
            ));
        }
    }
}

/// A bake that is only looked at: image and environment, and the bytes that the pack would have.
pub fn draft(args: &Args) -> Result<((EnvironmentImage, Environment), u64), Failure> {
    let options = args.options();
    options.validate()?;
    let loaded = load_environment(&args.input, args.run.max_memory)?;
    let environment = bake(&loaded.image, loaded.negative_pixels, &options, &Silent)
        .map_err(|error| Failure::bake(&args.input, &error))?;
    let codec = if args.compress { Codec::Zstd } else { Codec::None };
    let sections = sections::to_sections(&args.name(), &environment, codec);
    let bytes = pack::seal(&args.provenance(&loaded), sections)?.len() as u64;
    Ok(((loaded.image, environment), bytes))
}

impl Args {
    /// Where the pack comes from. Flags that do not change its contents are left out.
    fn provenance(&self, loaded: &LoadedEnvironment) -> Provenance {
        let named = |value: &dyn std::fmt::Debug| format!("{value:?}").to_ascii_lowercase();
        let options = [
            ("face-size", self.face_size.to_string()),
            ("min-face-size", self.min_face_size().to_string()),
            ("levels", if self.levels == 0 { "auto".into() } else { self.levels.to_string() }),
            (
                "level-choice",
                if self.level_choice == LevelChoiceArg::Optimal { "optimal" } else { "log-uniform" }.into(),
            ),
            ("floor", self.floor.to_string()),
            ("max-moment-error", self.max_moment_error.to_string()),
            ("coloured", self.coloured.to_string()),
            ("max-error", self.max_error.to_string()),
            ("kernel", if self.kernel == KernelArg::Ndf { "ndf" } else { "ggx-nl" }.into()),
            ("format", named(&self.format)),
            ("measure", self.measure.to_string()),
        ];
        Provenance {
            options: options.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
            inputs: vec![loaded.digest.clone()],
            notes: loaded.warnings.iter().map(|warning| format!("{}: {warning}", loaded.digest.name)).collect(),
            ..pack::provenance("environment")
        }
    }
}
