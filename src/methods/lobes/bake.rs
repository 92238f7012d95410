//! `glint-bake lobes`: one normal map in, a verified pack out. First everything is checked, then work begins.

use super::args::Args;
use crate::cli::Terminal;
use crate::exit::{Exit, Failure};
use crate::input::{LoadedMap, load_normal_map};
use crate::methods::bake::FinishedPack;
use crate::methods::method::provenance;
use crate::pack;
use crate::progress::Stages;
use crate::quantities::kib;
use glint_bake_core::lobes::options::LobesOptions;
use glint_bake_core::lobes::{self, sections};
use glint_bake_core::surface::{self, SurfaceOptions};
use glint_bake_core::synthesis::SynthesisOptions;
use glint_formats::Codec;
use glint_formats::Section;
use glint_formats::lobes::FootprintError;
use glint_formats::provenance::Provenance;
use std::path::{Path, PathBuf};

/// What makes a pack smaller.
const SMALLER: &str = "give a larger --cell, fewer lobes with --k, or a part of the map with --crop";

/// Edge of a surface's finest cells in texels.
const SURFACE_CELL: u32 = 8;

/// Checks everything, then bakes.
pub fn bake(args: &Args, terminal: Terminal) -> Result<Option<FinishedPack>, Failure> {
    args.reduction.options(1, 1).validate()?;
    let synthesis = args.surface.options(args.reduction.seed)?;
    if let Some(synthesis) = &synthesis {
        synthesis.validate()?;
    }
    let name = args.name()?;
    let delivery = args.delivery();
    delivery.check()?;
    args.check_normal_map()?;
    let loaded = load_normal_map(&args.map, &args.input.options(args.run.max_memory))?;
    for warning in &loaded.warnings {
        terminal.warn(&format!("{}: {warning}", args.map.display()));
    }
    let (width, height) = (loaded.map.width, loaded.map.height);
    let mut options = args.reduction.options(width, height);
    let bytes = match &synthesis {
        None => {
            options.check(&loaded.map).map_err(|e| Failure::bake(&args.map, &e))?;
            options.most_bytes(width, height)
        }
        Some(synthesis) => {
            options.cell_texels = args.reduction.cell.unwrap_or(SURFACE_CELL);
            let options = SurfaceOptions { lobes: options.clone(), synthesis: *synthesis };
            options.check(&loaded.map).map_err(|e| Failure::bake(&args.map, &e))?;
            options.most_bytes(width, height)
        }
    };
    delivery.check_size(bytes, SMALLER)?;
    let line = format!(
        "{width} × {height} texels, {} lobes a cell of {} texels, {} at most",
        options.lobes_per_cell,
        options.cell_texels,
        kib(bytes)
    );
    let line = match &synthesis {
        None => line,
        Some(_) => format!("{}, sample of {line}", args.surface.size_text()),
    };
    if args.run.dry_run {
        let output = args.output.display();
        terminal.say(&format!("would write {output}: \"{name}\", {line}; dry run, nothing was written"));
        return Ok(None);
    }
    terminal.detail(&format!("{}: {line}, {}", args.map.display(), loaded.convention));
    let sections = args.sections(&name, &loaded, &options, synthesis.as_ref(), terminal)?;
    let bytes = pack::seal(&args.provenance(&options, synthesis.as_ref(), &loaded), sections)?;
    Ok(Some(FinishedPack { bytes, smaller: SMALLER }))
}

impl Args {
    /// Says whether the surface's normal map can be written beside the other outputs.
    fn check_normal_map(&self) -> Result<(), Failure> {
        let outputs = [Some(&self.output), self.run.report.as_ref(), self.run.depfile.as_ref()];
        let outputs: Vec<&Path> = outputs.into_iter().flatten().map(PathBuf::as_path).collect();
        self.surface.check_writable(&outputs, &[&self.map])
    }

    /// Bakes the map, or the surface that is made of it. The surface's normal map is written on the way.
    fn sections(
        &self,
        name: &str,
        loaded: &LoadedMap,
        options: &LobesOptions,
        synthesis: Option<&SynthesisOptions>,
        terminal: Terminal,
    ) -> Result<Vec<Section>, Failure> {
        let codec = if self.compress { Codec::Zstd } else { Codec::None };
        let (map, progress) = (&loaded.map, Stages::new(terminal));
        let Some(synthesis) = synthesis else {
            let baked = lobes::bake(map, options, &progress).map_err(|e| Failure::bake(&self.map, &e))?;
            self.check_error(&baked.params.measured)?;
            return Ok(sections::to_sections(name, &baked, codec));
        };
        let options = SurfaceOptions { lobes: options.clone(), synthesis: *synthesis };
        let baked = surface::bake(map, &options, &progress).map_err(|e| Failure::bake(&self.map, &e))?;
        self.check_error(&baked.lobes.params.measured)?;
        self.surface.write_normal_map(&baked, map)?;
        Ok(surface::sections::to_sections(name, &baked, codec))
    }

    /// When the user named an error, missing it at any size is a failure.
    fn check_error(&self, measured: &[FootprintError]) -> Result<(), Failure> {
        let Some(asked) = self.reduction.max_error else { return Ok(()) };
        let Some(missed) = measured.iter().find(|row| f64::from(row.mean) > asked) else { return Ok(()) };
        let message = format!(
            "{}: expected E1 of {asked} on average at every footprint size, found {:.5} at {} texels; nothing was written. \
             Raise --max-error, --k or --roughness, or give --storage f16",
            self.map.display(),
            missed.mean,
            missed.sigma_texels
        );
        Err(Failure::new(Exit::LimitExceeded, message))
    }

    /// Where the pack comes from.
    fn provenance(&self, used: &LobesOptions, synthesis: Option<&SynthesisOptions>, loaded: &LoadedMap) -> Provenance {
        let notes = loaded.warnings.iter().map(|warning| format!("{}: {warning}", loaded.digest.name)).collect();
        Provenance {
            seed: self.reduction.seed,
            inputs: vec![loaded.digest.clone()],
            normal_convention: self.input.normal_convention(),
            notes,
            ..provenance::<Args>("lobes", self.option_list(used, synthesis))
        }
    }
}
