//! Checks the contents of lobe sections: what an evaluator relies on when it walks cells and decodes lobes.

use crate::bytes::u32_at;
use crate::container::Resource;
use crate::issue::{Issue, IssueCode};
use crate::lobes::{
    HalfLobe, LOBES, LobeLevel, LobeStorage, LobesParams, LobesUniform, MAX_LAST_CELLS, MAX_LEVELS, MAX_LOBES_PER_CELL,
    MAX_SIGMA_RATIO, MAX_TEXTURE_SIZE, NORMALS, NormalsStorage, PARAMS, PackedLobe, UNIFORM,
};
use crate::sections::{Loaded, Sections};
use crate::synthesis::SynthesisUniform;
use crate::wrap::Wrap;
use half::f16;

/// Longest projected normal that rounding can make of 1.
const LONGEST: f32 = 1.02;

/// Checks every map's lobes.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_map(sections, section, issues);
    }
    sections.report_orphans(&[UNIFORM, LOBES, NORMALS], PARAMS, issues);
}

fn check_map(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) {
    let [uniform, lobes, normals] = [UNIFORM, LOBES, NORMALS].map(|kind| sections.need(kind, section, issues));
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
    if let Some(uniform) = uniform {
        check_uniform(uniform, &params, issues);
    }
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
    if !(params.rim_roughness >= 0.0 && params.rim_roughness <= 1.0) {
        let found = params.rim_roughness;
        return Err(format!("expected a roughness to leave out the rim at of 0 to 1, found {found}"));
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
    if params.levels.len() > MAX_LEVELS {
        return Err(format!("expected at most {MAX_LEVELS} levels, found {}", params.levels.len()));
    }
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
            return Err(format!("expected a range of positive standard deviations, found {low} to {high}"));
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

/// Largest difference of log₂ of a ratio from that of the parameters' numbers: they are rounded by whoever wrote them.
const LOG_ROUNDING: f32 = 1e-5;

/// Whether the uniform says what the parameters say; that of a map without a synthesis has zeros in its place. The synthesis'
/// own check compares the part of one.
fn check_uniform(section: Loaded<'_>, params: &LobesParams, issues: &mut Vec<Issue>) {
    let code = IssueCode::LobesUniform;
    if !section.expect(code, Resource::Buffer { stride: size_of::<LobesUniform>() as u32, count: 1 }, issues) {
        return;
    }
    let found: LobesUniform = bytemuck::pod_read_unaligned(section.payload);
    let synthesis = if params.step_texels == 0 { SynthesisUniform::default() } else { found.synthesis };
    let mut expected = params.uniform(synthesis);
    for (expected, found) in expected.levels.iter_mut().zip(&found.levels) {
        let close = |a: f32, b: f32| if (a - b).abs() <= LOG_ROUNDING { b } else { a };
        expected.position_log_ratio = close(expected.position_log_ratio, found.position_log_ratio);
        expected.residual_log_ratio = close(expected.residual_log_ratio, found.residual_log_ratio);
    }
    let (found, expected) = (bytemuck::bytes_of(&found), bytemuck::bytes_of(&expected));
    if let Some(word) =
        found.chunks_exact(4).zip(expected.chunks_exact(4)).position(|(found, expected)| found != expected)
    {
        let [found, expected] = [found, expected].map(|bytes| u32_at(bytes, 4 * word));
        let message = format!("byte {}: the parameters make it {expected:#010x}, found {found:#010x}", 4 * word);
        issues.push(section.error(code, message));
    }
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
    let sigmas = lobe.position_sigma.iter().chain(&lobe.residual_sigma);
    let positive = sigmas.chain([&lobe.weight]).all(|bits| float(*bits) >= 0.0 && float(*bits).is_finite());
    let why = if !positive {
        Some("a weight and standard deviations that are finite and not negative")
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
    let shape = Resource::Buffer { stride: size_of::<[u32; 2]>() as u32, count: params.pair_count() };
    if !section.expect(IssueCode::LobesNormalsShape, shape, issues) {
        return;
    }
    let word = |at: u64, second: usize| u32_at(section.payload, 8 * at as usize + 4 * second);
    let texels = u64::from(params.width) * u64::from(params.height);
    let place = |at: u64| (at % u64::from(params.width), at / u64::from(params.width));
    let normal = |word: u32| match params.normals {
        NormalsStorage::Snorm16 => [word as i16, (word >> 16) as i16].map(|c| f32::from(c) / 32767.0),
        NormalsStorage::Unorm8 => [word & 0xffff, word >> 16].map(|c| c as f32 / 255.0 * 2.0 - 1.0),
    };
    let long = (0..texels).find(|at| {
        let [x, y] = normal(word(*at, 0));
        x * x + y * y > LONGEST * LONGEST || (params.normals == NormalsStorage::Unorm8 && x.max(y) > 1.0)
    });
    if let Some(at) = long {
        let ((i, j), [x, y]) = (place(at), normal(word(at, 0)));
        let message = format!("texel ({i}, {j}): expected a projected normal of length 1 at most, found ({x}, {y})");
        issues.push(section.error(IssueCode::LobesNormal, message));
    }
    let below = |at: u64| {
        let (i, j) = place(at);
        u64::from(params.row_below(j as u32)) * u64::from(params.width) + i
    };
    if let Some(at) = (0..texels).find(|at| word(*at, 1) != word(below(*at), 0)) {
        let ((i, j), expected) = (place(at), word(below(at), 0));
        let message = format!(
            "texel ({i}, {j}): expected {expected:#010x} as the texel below it has, found {:#010x}",
            word(at, 1)
        );
        issues.push(section.error(IssueCode::LobesNormalPair, message));
    } else if (texels..params.pair_count()).any(|at| word(at, 0) != 0 || word(at, 1) != 0) {
        issues.push(section.error(IssueCode::LobesNormalPair, "expected zeros after the last texel"));
    }
}
