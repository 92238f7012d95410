//! Checks the contents of lobe sections: what an evaluator relies on when it walks cells and decodes lobes.

use crate::bytes::u16_at;
use crate::issue::{Issue, IssueCode};
use crate::lobes::{
    HalfLobe, LOBES, LobeLevel, LobeStorage, LobesParams, MAX_LAST_CELLS, MAX_LOBES_PER_CELL, MAX_SIGMA_RATIO,
    MAX_TEXTURE_SIZE, NORMALS, NormalsStorage, PARAMS, PackedLobe,
};
use crate::sections::{Loaded, Sections};
use crate::wrap::Wrap;
use half::f16;

/// Longest projected normal that rounding can make of 1.
const LONGEST: f32 = 1.02;

/// Checks every map's lobes.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_map(sections, section, issues);
    }
    sections.report_orphans(&[LOBES, NORMALS], PARAMS, issues);
}

fn check_map(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) {
    let [lobes, normals] = [LOBES, NORMALS].map(|kind| sections.need(kind, section, issues));
    let Some(params) = section.parameters::<LobesParams>(issues) else { return };
    if let Err(why) = check_parameters(&params) {
        issues.push(section.error(IssueCode::LobesParameters, why));
        return;
    }
    if let Some(normals) = normals {
        check_normals(normals, &params, issues);
    }
    let count = match check_levels(&params) {
        Ok(count) => count,
        Err(why) => {
            issues.push(section.error(IssueCode::LobesLevels, why));
            return;
        }
    };
    let Some(lobes) = lobes else { return };
    let Some(found) = lobes.buffer_count(params.storage.stride(), issues) else { return };
    if found != count {
        issues.push(lobes.error(IssueCode::LobesCount, format!("the levels have {count} lobes, the section {found}")));
        return;
    }
    check_lobes(lobes, &params, issues);
}

fn check_parameters(params: &LobesParams) -> Result<(), String> {
    for (what, found, most) in [
        ("width", params.width, MAX_TEXTURE_SIZE),
        ("height", params.height, MAX_TEXTURE_SIZE),
        ("number of lobes a cell", params.lobes_per_cell, MAX_LOBES_PER_CELL),
    ] {
        if !(1..=most).contains(&found) {
            return Err(format!("expected a {what} of 1 to {most}, found {found}"));
        }
    }
    if ![1, 4].contains(&params.seeds) {
        return Err(format!("expected 1 or 4 seeds, found {}", params.seeds));
    }
    if !(params.intrinsic_roughness > 0.0 && params.intrinsic_roughness <= 1.0) {
        return Err(format!(
            "expected an intrinsic roughness above 0, at most 1, found {}",
            params.intrinsic_roughness
        ));
    }
    if !(params.measured_roughness >= params.intrinsic_roughness && params.measured_roughness <= 1.0) {
        let found = params.measured_roughness;
        return Err(format!("expected an error measured at the intrinsic roughness or above, up to 1, found {found}"));
    }
    for k in 0..2 {
        let (low, extent) = (params.normal_low[k], params.normal_extent[k]);
        if !(low >= -LONGEST && extent >= 0.0 && low + extent <= LONGEST) {
            return Err(format!("expected normals between -1 and 1, found {low} and {extent} more"));
        }
    }
    let step = params.step_texels;
    let in_steps = |side: u32| side.is_multiple_of(step.max(1));
    let whole_steps = params.wrap == Wrap::Clamp || (in_steps(params.width) && in_steps(params.height));
    if step != 0 && !(step.is_power_of_two() && whole_steps) {
        return Err(format!(
            "expected cells in steps of a power of two that a repeated map is a multiple of, found {step}"
        ));
    }
    for row in &params.measured {
        if !([row.sigma_texels, row.mean, row.worst].iter().all(|v| *v >= 0.0 && v.is_finite())) {
            return Err(format!("expected errors that are finite and not negative, found {row:?}"));
        }
    }
    Ok(())
}

/// Levels cover the map and follow each other; returns the number of lobes they have together.
fn check_levels(params: &LobesParams) -> Result<u64, String> {
    let mut lobes = 0u64;
    let mut finer = None;
    for (i, level) in params.levels.iter().enumerate() {
        let whole = params.step_texels != 0 && i > 0 && i + 1 == params.levels.len();
        let grid = if whole { (level.cells_x, level.cells_y) } else { params.grid(level.cell_texels) };
        check_level(level, grid, lobes, finer).map_err(|why| format!("level {i}: {why}"))?;
        let cells = u64::from(level.cells_x) * u64::from(level.cells_y);
        lobes += cells * u64::from(params.lobes_per_cell);
        if lobes > u64::from(u32::MAX) {
            return Err(format!("level {i}: more than {} lobes", u32::MAX));
        }
        finer = Some(level.cell_texels);
    }
    match params.levels.last() {
        None => Err(String::from("expected at least one level, found none")),
        Some(last) if last.cells_x.max(last.cells_y) > MAX_LAST_CELLS => {
            let (x, y) = (last.cells_x, last.cells_y);
            Err(format!(
                "expected at most {MAX_LAST_CELLS} × {MAX_LAST_CELLS} cells in the last level, found {x} × {y}"
            ))
        }
        Some(_) => Ok(lobes),
    }
}

fn check_level(level: &LobeLevel, grid: (u32, u32), first: u64, finer: Option<u32>) -> Result<(), String> {
    let cell = level.cell_texels;
    let follows = finer.is_none_or(|finer| finer.checked_mul(2) == Some(cell));
    if !cell.is_power_of_two() || !follows || cell > 2 * MAX_TEXTURE_SIZE {
        return Err(format!("expected cells of a power of two, twice those of the level before, found {cell} texels"));
    }
    if (level.cells_x, level.cells_y) != grid || grid.0 == 0 || grid.1 == 0 {
        let found = (level.cells_x, level.cells_y);
        return Err(format!("expected {} × {} cells, found {} × {}", grid.0, grid.1, found.0, found.1));
    }
    if u64::from(level.first_lobe) != first {
        return Err(format!("expected first lobe {first}, found {}", level.first_lobe));
    }
    for [low, high] in [level.position_sigma, level.residual_sigma] {
        if !(low > 0.0 && low <= high && high <= low * (1.001 * MAX_SIGMA_RATIO) && high.is_finite()) {
            return Err(format!("expected a range of positive deviations, found {low} to {high}"));
        }
    }
    if !(level.weight_scale > 0.0 && level.weight_scale.is_finite()) {
        return Err(format!("expected a positive weight, found {}", level.weight_scale));
    }
    if !(level.jacobian_scale >= 0.0 && level.jacobian_scale.is_finite()) {
        return Err(format!("expected a finite Jacobian that is not negative, found {}", level.jacobian_scale));
    }
    Ok(())
}

/// Reports the first lobe that is wrong, and the first cell that has none.
fn check_lobes(section: Loaded<'_>, params: &LobesParams, issues: &mut Vec<Issue>) {
    let mut fault = None;
    let mut empty = None;
    let cell_bytes = params.lobes_per_cell as usize * params.storage.stride() as usize;
    for (cell, bytes) in section.payload.chunks_exact(cell_bytes).enumerate() {
        let mut lobes = 0;
        for (k, bytes) in bytes.chunks_exact(params.storage.stride() as usize).enumerate() {
            let (weight, why) = match params.storage {
                LobeStorage::Packed => packed_fault(&bytemuck::pod_read_unaligned(bytes)),
                LobeStorage::Half => half_fault(&bytemuck::pod_read_unaligned(bytes)),
            };
            lobes += u32::from(weight);
            if let Some(why) = why
                && fault.is_none()
            {
                fault = Some(format!("lobe {}: expected {why}", cell * params.lobes_per_cell as usize + k));
            }
        }
        if lobes == 0 && empty.is_none() {
            empty =
                Some(format!("cell {cell}, counted over all levels, has no lobe with weight; expected at least one"));
        }
    }
    issues.extend(fault.map(|why| section.error(IssueCode::LobeValue, why)));
    issues.extend(empty.map(|why| section.error(IssueCode::LobeCellEmpty, why)));
}

/// Whether a lobe has weight, and what is wrong with it.
fn packed_fault(lobe: &PackedLobe) -> (bool, Option<&'static str>) {
    let codes = lobe.jacobian.iter().chain(&lobe.correlation);
    (lobe.normal_weight >> 24 != 0, codes.into_iter().any(|c| *c == i8::MIN).then_some("codes from -127 to 127"))
}

fn half_fault(lobe: &HalfLobe) -> (bool, Option<&'static str>) {
    let float = |bits: u16| f16::from_bits(bits).to_f32();
    let weight = float(lobe.weight);
    let deviations = lobe.position_sigma.iter().chain(&lobe.residual_sigma);
    let positive = deviations.chain([&lobe.weight]).all(|bits| float(*bits) >= 0.0 && float(*bits).is_finite());
    let why = if !positive {
        Some("a weight and deviations that are finite and not negative")
    } else if !lobe.jacobian.iter().all(|bits| float(*bits).is_finite()) {
        Some("a finite Jacobian")
    } else if lobe.correlation.contains(&i16::MIN) {
        Some("correlations from -32767 to 32767")
    } else if lobe.reserved != 0 {
        Some("0 in the reserved bytes")
    } else {
        None
    };
    (weight > 0.0, why)
}

fn check_normals(section: Loaded<'_>, params: &LobesParams, issues: &mut Vec<Issue>) {
    let shape = params.normals_resource();
    if !section.expect(IssueCode::LobesNormalsShape, shape, issues) {
        return;
    }
    for (at, bytes) in section.payload.chunks_exact(params.normals.texel_bytes()).enumerate() {
        let [x, y] = match params.normals {
            NormalsStorage::Snorm16 => [0, 2].map(|k| f32::from(u16_at(bytes, k) as i16) / 32767.0),
            NormalsStorage::Unorm8 => [0, 1].map(|k| f32::from(bytes[k]) / 255.0 * 2.0 - 1.0),
        };
        if x * x + y * y > LONGEST * LONGEST {
            let (i, j) = (at % params.width as usize, at / params.width as usize);
            let message =
                format!("texel ({i}, {j}): expected a projected normal of length 1 at most, found ({x}, {y})");
            issues.push(section.error(IssueCode::LobesNormal, message));
            return;
        }
    }
}
