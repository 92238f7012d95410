//! Checks the contents of synthesis sections: what a look-up relies on when it finds the sample texel of a surface texel.

use crate::bytes::{u16_at, u32_at};
use crate::container::Resource;
use crate::issue::{Issue, IssueCode};
use crate::lobes::{self, LobesParams, LobesUniform};
use crate::params;
use crate::sections::{Loaded, Sections};
use crate::synthesis::{
    Layout, MAX_COLOURS, MAX_OVERLAP, MAX_PATCHES, MAX_SAMPLE_SIZE, MAX_SEAM_BYTES, MAX_VARIANTS, OFFSETS, PARAMS,
    PATCH_RANGE, PathShape, SEAMS, SynthesisParams,
};
use crate::wrap::Wrap;
use serde::de::DeserializeOwned;

/// Checks every synthesis.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_synthesis(sections, section, issues);
    }
    sections.report_orphans(&[OFFSETS, SEAMS], PARAMS, issues);
    check_surfaces(sections, issues);
}

fn check_synthesis(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) {
    let [offsets, seams] = [OFFSETS, SEAMS].map(|kind| sections.need(kind, section, issues));
    let Some(params) = section.parameters::<SynthesisParams>(issues) else { return };
    if let Err(why) = check_parameters(&params).and_then(|()| check_layout(&params)) {
        issues.push(section.error(IssueCode::SynthesisParameters, why));
        return;
    }
    let shape = IssueCode::SynthesisShape;
    if let Some(offsets) = offsets
        && offsets.expect(shape, Resource::Buffer { stride: 4, count: params.stored_offsets() }, issues)
    {
        check_offsets(offsets, &params, issues);
        check_end(offsets, params.offset_count(), issues);
    }
    if let Some(seams) = seams
        && seams.expect(shape, Resource::Buffer { stride: 4, count: params.stored_seam_words() }, issues)
    {
        check_seams(seams, &params, issues);
        check_end(seams, params.seam_words(), issues);
    }
}

fn in_range(what: &str, (low, high): (u32, u32), found: u32) -> Result<(), String> {
    if (low..=high).contains(&found) {
        Ok(())
    } else {
        Err(format!("expected {what} of {low} to {high}, found {found}"))
    }
}

fn check_parameters(params: &SynthesisParams) -> Result<(), String> {
    in_range("a sample width", (1, MAX_SAMPLE_SIZE), params.sample_width)?;
    in_range("a sample height", (1, MAX_SAMPLE_SIZE), params.sample_height)?;
    in_range("a patch", PATCH_RANGE, params.patch)?;
    in_range("an overlap", (0, MAX_OVERLAP.min(params.patch / 2)), params.overlap)?;
    let needed = params.patch + if params.wrap == Wrap::Clamp { params.overlap } else { 0 };
    if params.sample_width.min(params.sample_height) < needed {
        let (width, height) = (params.sample_width, params.sample_height);
        return Err(format!("expected a sample of {needed} texels a side at least, found {width} × {height}"));
    }
    if params.alignment == 0 || !params.patch.is_multiple_of(params.alignment) {
        let (patch, found) = (params.patch, params.alignment);
        return Err(format!("expected an alignment that divides the patch of {patch}, found {found}"));
    }
    if !(0.0..=1.0).contains(&params.alpha) {
        return Err(format!("expected a weight of normals from 0 to 1, found {}", params.alpha));
    }
    let tolerance = f64::from(params.error_tolerance);
    for (what, found) in [("tolerance", tolerance), ("seam ratio", params.measured.seam_ratio)] {
        if !(found >= 0.0 && found.is_finite()) {
            return Err(format!("expected a {what} that is finite and not negative, found {found}"));
        }
    }
    Ok(())
}

fn check_layout(params: &SynthesisParams) -> Result<(), String> {
    match params.layout {
        Layout::Patches { width, height, columns, rows } => {
            if width == 0 || height == 0 {
                return Err(format!("expected a surface of one texel or more, found {width} × {height}"));
            }
            let (across, down) = (width.div_ceil(params.patch), height.div_ceil(params.patch));
            if (columns, rows) != (across, down) {
                return Err(format!("expected {across} × {down} patches, found {columns} × {rows}"));
            }
        }
        Layout::CornerTiles { colours, variants, margin, .. } => {
            in_range("corner colours", (1, MAX_COLOURS), colours)?;
            in_range("variants", (1, MAX_VARIANTS), variants)?;
            let half = params.patch / 2;
            if !params.patch.is_multiple_of(2) {
                return Err(format!("expected tiles of an even edge, found {}", params.patch));
            }
            if margin == 0 || u64::from(margin) + 2 * u64::from(params.overlap) > u64::from(half) {
                let overlap = params.overlap;
                return Err(format!(
                    "expected a margin from 1 to {half} less twice the overlap of {overlap}, found {margin}"
                ));
            }
        }
    }
    if params.offset_count() > MAX_PATCHES {
        return Err(format!("expected {MAX_PATCHES} patches at most, found {}", params.offset_count()));
    }
    if 4 * params.stored_seam_words() > MAX_SEAM_BYTES {
        let found = 4 * params.stored_seam_words();
        return Err(format!("expected {MAX_SEAM_BYTES} bytes of seam paths at most, found {found}"));
    }
    Ok(())
}

/// Reports bytes after the `count` words of a buffer that are not 0.
fn check_end(section: Loaded<'_>, count: u64, issues: &mut Vec<Issue>) {
    if section.payload.iter().skip(4 * count as usize).any(|byte| *byte != 0) {
        let message = format!("expected zeros after {count} records of 4 bytes");
        issues.push(section.error(IssueCode::SynthesisPadding, message));
    }
}

/// Reports the first offset whose patch does not lie in the sample.
fn check_offsets(section: Loaded<'_>, params: &SynthesisParams, issues: &mut Vec<Issue>) {
    let sides = [params.sample_width, params.sample_height];
    for (at, bytes) in section.payload.chunks_exact(4).take(params.offset_count() as usize).enumerate() {
        let offset = [u16_at(bytes, 0), u16_at(bytes, 2)];
        let sound = offset.iter().zip(sides).all(|(&found, side)| {
            let found = u32::from(found);
            let (first, last) = match params.wrap {
                Wrap::Repeat => (0, side - 1),
                Wrap::Clamp => (params.overlap, side - params.patch),
            };
            (first..=last).contains(&found) && found.is_multiple_of(params.alignment)
        });
        if !sound {
            let message = format!(
                "patch {at}: expected an offset inside the sample that is a multiple of {}, found ({}, {})",
                params.alignment, offset[0], offset[1]
            );
            issues.push(section.error(IssueCode::SynthesisOffset, message));
            return;
        }
    }
}

/// Reports the first path that jumps, leaves the overlap, or has bits set that mean nothing.
fn check_seams(section: Loaded<'_>, params: &SynthesisParams, issues: &mut Vec<Issue>) {
    let mut words = section.payload.chunks_exact(4).map(|bytes| u32_at(bytes, 0));
    let groups = match params.layout {
        Layout::Patches { .. } => vec![(2 * params.offset_count(), params.patch_path())],
        Layout::CornerTiles { colours, margin, .. } => {
            let tiles = params.offset_count() - u64::from(colours);
            vec![(2 * u64::from(colours).pow(2), params.colour_path(margin)), (4 * tiles, params.middle_path(margin))]
        }
    };
    let mut path = 0u64;
    for (paths, shape) in groups.into_iter().filter(|(_, shape)| shape.words > 0) {
        for _ in 0..paths {
            if let Some(why) = path_fault(&mut words, shape, params.overlap) {
                issues.push(section.error(IssueCode::SynthesisSeam, format!("path {path}: {why}")));
                return;
            }
            path += 1;
        }
    }
}

fn path_fault(words: &mut impl Iterator<Item = u32>, shape: PathShape, overlap: u32) -> Option<String> {
    let mut last = None;
    for word in 0..shape.words {
        let mut rest = words.next().unwrap_or(0);
        for entry in word * shape.per_word..shape.entries.min((word + 1) * shape.per_word) {
            let found = rest & ((1 << shape.bits) - 1);
            rest >>= shape.bits;
            if found >= overlap {
                return Some(format!("entry {entry}: expected less than the overlap of {overlap}, found {found}"));
            }
            if last.is_some_and(|last: u32| last.abs_diff(found) > 1) {
                return Some(format!("entry {entry}: expected a step of 1 at most, found {last:?} then {found}"));
            }
            last = Some(found);
        }
        if rest != 0 {
            return Some(format!("word {word}: expected 0 in the bits after the last entry, found {rest:#x}"));
        }
    }
    None
}

/// Checks that lobes and synthesis of one name are one surface, so that a query may read the cells that a look-up names. Sections that do not decode are reported by their own checks.
fn check_surfaces(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(lobes::PARAMS) {
        let Some(params) = decoded::<LobesParams>(section.payload) else { continue };
        if params.step_texels == 0 {
            continue;
        }
        let Some(surface) = sections.need(PARAMS, section, issues) else { continue };
        let Some(surface) = decoded::<SynthesisParams>(surface.payload) else { continue };
        if let Err(why) = check_surface(&params, &surface) {
            issues.push(section.error(IssueCode::SurfaceMismatch, why));
            continue;
        }
        let Some(uniform) = sections.get(lobes::UNIFORM, &section.entry.name) else { continue };
        let found = bytemuck::try_pod_read_unaligned::<LobesUniform>(uniform.payload);
        if found.is_ok_and(|found| found.synthesis != surface.uniform()) {
            let message = "the part of the synthesis differs from the parameters of the synthesis";
            issues.push(uniform.error(IssueCode::LobesUniform, message));
        }
    }
}

fn decoded<T: DeserializeOwned>(payload: &[u8]) -> Option<T> {
    params::decode(payload).ok()
}

fn check_surface(params: &LobesParams, surface: &SynthesisParams) -> Result<(), String> {
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
