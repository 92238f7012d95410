//! Checks that lobes and synthesis of one name are one surface: that a query may read the cells that a look-up names.

use crate::issue::{Issue, IssueCode};
use crate::lobes::{self, LobesParams};
use crate::params;
use crate::sections::Sections;
use crate::synthesis::{self, SynthesisParams};
use serde::de::DeserializeOwned;

/// Checks every sample of a surface. Sections that do not decode are reported by their own checks.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(lobes::PARAMS) {
        let Some(params) = decoded::<LobesParams>(section.payload) else { continue };
        if params.step_texels == 0 {
            continue;
        }
        let Some(surface) = sections.need(synthesis::PARAMS, section, issues) else { continue };
        let Some(surface) = decoded::<SynthesisParams>(surface.payload) else { continue };
        if let Err(why) = fits(&params, &surface) {
            issues.push(section.error(IssueCode::SurfaceMismatch, why));
        }
    }
}

fn decoded<T: DeserializeOwned>(payload: Option<&[u8]>) -> Option<T> {
    params::decode(payload?).ok()
}

fn fits(params: &LobesParams, surface: &SynthesisParams) -> Result<(), String> {
    let (sample, map) = ((surface.sample_width, surface.sample_height), (params.width, params.height));
    if sample != map {
        return Err(format!(
            "the surface is of a sample of {} × {}, the lobes of {} × {}",
            sample.0, sample.1, map.0, map.1
        ));
    }
    if surface.wrap != params.wrap {
        return Err(format!(
            "the surface is of a sample that is {:?}, the lobes of one {:?}",
            surface.wrap, params.wrap
        ));
    }
    if surface.alignment != params.step_texels {
        let (alignment, step) = (surface.alignment, params.step_texels);
        return Err(format!("offsets of patches are multiples of {alignment}, cells of {step}"));
    }
    let Some((_, cells)) = params.levels.split_last() else { return Ok(()) };
    match cells.iter().find(|level| level.cell_texels == 0 || !surface.patch.is_multiple_of(level.cell_texels)) {
        Some(level) => Err(format!("a patch of {} is no multiple of a cell of {}", surface.patch, level.cell_texels)),
        None if cells.is_empty() => Err(String::from("expected a level of cells before that of the whole surface")),
        None => Ok(()),
    }
}
