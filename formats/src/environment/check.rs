//! Checks the contents of environment sections: what a sampler and a counting model rely on.

use crate::bytes::f16_at;
use crate::environment::{
    ALBEDO, COLOURS, EnvironmentParams, INDICATORS, MAX_FACE_SIZE, MAX_LEVELS, MAX_LOOK_UPS, MAX_PER_SIZE, MIRROR,
    PARAMS, RADIANCE, UNIFORM, roughness_of,
};
use crate::issue::{Issue, IssueCode};
use crate::sections::{Loaded, Sections};

/// Checks every environment.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_environment(sections, section, issues);
    }
    sections.report_orphans(&[UNIFORM, MIRROR, RADIANCE, INDICATORS, COLOURS, ALBEDO], PARAMS, issues);
}

fn check_environment(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) {
    let uniform = sections.need(UNIFORM, section, issues);
    let mirror = sections.need(MIRROR, section, issues);
    let radiance = sections.need(RADIANCE, section, issues);
    let albedo = sections.need(ALBEDO, section, issues);
    let Some(params) = section.parameters::<EnvironmentParams>(issues) else { return };
    if let Err(why) = check_parameters(&params) {
        issues.push(section.error(IssueCode::EnvironmentParameters, why));
        return;
    }
    if let Err(why) = check_levels(&params.levels) {
        issues.push(section.error(IssueCode::EnvironmentLevels, why));
        return;
    }
    let shape = IssueCode::EnvironmentShape;
    if let Some(uniform) = uniform
        && uniform.expect(shape, params.uniform_resource(), issues)
    {
        check_uniform(uniform, &params, issues);
    }
    for (section, resource) in [(mirror, params.mirror_resource()), (radiance, params.radiance_resource())] {
        if let Some(section) = section
            && section.expect(shape, resource, issues)
        {
            check_values(section, IssueCode::EnvironmentRadiance, issues);
        }
    }
    if let Some(albedo) = albedo
        && albedo.expect(shape, params.albedo_resource(), issues)
    {
        check_albedo(albedo, &params, issues);
    }
    if params.levels.len() > 1
        && let Some(indicators) = sections.need(INDICATORS, section, issues)
        && indicators.expect(shape, params.indicators_resource(), issues)
    {
        check_indicators(indicators, &params, issues);
    }
    if params.coloured
        && let Some(colours) = sections.need(COLOURS, section, issues)
    {
        // Every bit pattern of the shared-exponent format is a finite colour that is not negative.
        colours.expect(shape, params.colours_resource(), issues);
    }
}

fn check_parameters(params: &EnvironmentParams) -> Result<(), String> {
    let size = params.face_size;
    if !(size.is_power_of_two() && size <= MAX_FACE_SIZE) {
        return Err(format!("expected a face size that is a power of two up to {MAX_FACE_SIZE}, found {size}"));
    }
    if !(1..=MAX_PER_SIZE).contains(&params.per_size) {
        return Err(format!("expected 1 to {MAX_PER_SIZE} roughnesses of a face size, found {}", params.per_size));
    }
    let (filtered, most) = (params.roughness.len().saturating_sub(1), size.ilog2() * params.per_size);
    if filtered == 0 || filtered > most as usize || !params.filtered().is_multiple_of(params.per_size) {
        return Err(format!(
            "expected a roughness of 0 and {} to {most} others, {0} of each face size, found {} in all",
            params.per_size,
            params.roughness.len()
        ));
    }
    let expected = roughness_of(size, params.filtered());
    if !params.roughness.iter().zip(&expected).all(|(found, expected)| (found - expected).abs() <= 1e-9) {
        return Err(format!("expected roughnesses {expected:?}, found {:?}", params.roughness));
    }
    if !(1..=1024).contains(&params.albedo_size) {
        return Err(format!("expected an albedo table of 1 to 1024 texels square, found {}", params.albedo_size));
    }
    if !(1..=MAX_LOOK_UPS as u32).contains(&params.look_ups) {
        return Err(format!("expected 1 to {MAX_LOOK_UPS} look-ups, found {}", params.look_ups));
    }
    let positive = |value: f64| value > 0.0 && value.is_finite();
    let asked = [Some(params.filter_error), params.max_error];
    if !positive(params.radiance_scale) || !asked.into_iter().flatten().all(positive) {
        return Err(String::from("expected a positive radiance scale and errors"));
    }
    if params.coloured && params.levels.len() < 2 {
        return Err(String::from("expected two levels or more where levels have colours"));
    }
    let measured = &params.measured;
    let reads = measured.reads.iter().flat_map(|reads| [reads.relative, reads.of_mean, reads.worst]);
    let errors = measured.texels.iter().flat_map(|texels| [texels.rmse, texels.worst]);
    let all = errors.chain(reads).chain([measured.energy, measured.second_moment]).chain(params.mean_radiance);
    let all = all.chain(measured.rounding.iter().copied());
    for value in all {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(format!("expected means and errors that are finite and not negative, found {value}"));
        }
    }
    Ok(())
}

fn check_levels(levels: &[f64]) -> Result<(), String> {
    if !(1..=MAX_LEVELS).contains(&levels.len()) {
        return Err(format!("expected 1 to {MAX_LEVELS} levels, found {}", levels.len()));
    }
    if !levels.iter().all(|level| *level >= 0.0 && level.is_finite()) {
        return Err(String::from("expected finite levels that are not negative"));
    }
    if levels.len() > 1 && levels[0] != 0.0 {
        return Err(format!("expected a darkest level of 0, found {}", levels[0]));
    }
    if levels.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err(String::from("expected levels that rise"));
    }
    Ok(())
}

/// Reports the first number of the uniform that is not what the parameters say. Numbers are compared by their bits.
fn check_uniform(section: Loaded<'_>, params: &EnvironmentParams, issues: &mut Vec<Issue>) {
    let expected = params.uniform();
    let differs = |(found, expected): (&[u8], &[u8])| found != expected;
    let pairs = section.payload.chunks_exact(4).zip(bytemuck::bytes_of(&expected).chunks_exact(4));
    if let Some(at) = pairs.map(differs).position(|differs| differs) {
        let message = format!("expected what the parameters say, found another number at byte {}", 4 * at);
        issues.push(section.error(IssueCode::EnvironmentUniform, message));
    }
}

/// Reports the first number that is negative or not finite.
fn check_values(section: Loaded<'_>, code: IssueCode, issues: &mut Vec<Issue>) {
    for (i, chunk) in section.payload.chunks_exact(2).enumerate() {
        let value = f16_at(chunk, 0);
        if !(value >= 0.0 && value.is_finite()) {
            let message = format!(
                "component {} of texel {}: expected a finite number that is not negative, found {value}",
                i % 4,
                i / 4
            );
            issues.push(section.error(code, message));
            return;
        }
    }
}

/// Reports the first number of the albedo table that is not finite, or negative and no shift; else the first texel whose look-ups
/// after the first take more than all.
fn check_albedo(section: Loaded<'_>, params: &EnvironmentParams, issues: &mut Vec<Issue>) {
    let texels = (params.albedo_size as usize).pow(2);
    let value = |layer: usize, texel: usize, c: usize| f16_at(section.payload, 8 * (layer * texels + texel) + 2 * c);
    let shift_of = |layer: usize| match layer {
        0 => Some(2),
        1 => None,
        _ => Some(0),
    };
    for layer in 0..=params.look_ups as usize {
        for (texel, c) in (0..texels).flat_map(|texel| (0..4).map(move |c| (texel, c))) {
            let found = value(layer, texel, c);
            if !(found.is_finite() && (found >= 0.0 || shift_of(layer) == Some(c))) {
                let message = format!(
                    "component {c} of texel {texel} of layer {layer}: expected a finite number that is not negative unless a shift, \
                     found {found}"
                );
                issues.push(section.error(IssueCode::EnvironmentAlbedo, message));
                return;
            }
        }
    }
    for texel in 0..texels {
        let shares: f32 = (2..=params.look_ups as usize).map(|layer| value(layer, texel, 2)).sum();
        if shares > 1.0 {
            let message =
                format!("texel {texel}: expected shares of look-ups that add up to 1 at most, found a sum of {shares}");
            issues.push(section.error(IssueCode::EnvironmentAlbedo, message));
            return;
        }
    }
}

/// Reports the first texel whose indicators are no shares of a whole. What is left of 1 is the darkest level's.
fn check_indicators(section: Loaded<'_>, params: &EnvironmentParams, issues: &mut Vec<Issue>) {
    let layers = params.indicator_layers() as usize;
    let bytes = section.payload;
    let value = |texel: usize, c: usize| f64::from(f16_at(bytes, 2 * (4 * texel + c)));
    let mut first = 0;
    for index in 1..=params.filtered() {
        let texels = 6 * (params.size(index) as usize).pow(2);
        for texel in 0..texels {
            let mut sum = 0.0;
            let mut sound = true;
            for layer in 0..layers {
                for c in 0..4 {
                    let share = value(first + layer * texels + texel, c);
                    let used = 4 * layer + c + 1 < params.levels.len();
                    sound &= share >= 0.0 && (used || share == 0.0);
                    sum += share;
                }
            }
            if !sound || sum > 1.0 {
                let message = format!(
                    "texel {texel} of roughness {index}: expected shares that are not negative and add up to 1 at most, \
                     found a sum of {sum}"
                );
                issues.push(section.error(IssueCode::EnvironmentIndicators, message));
                return;
            }
        }
        first += layers * texels;
    }
}
