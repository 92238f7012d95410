//! Checks the contents of sections of counted facets: what a shader relies on when it draws them.

use crate::area_light::check::check_tables;
use crate::container::Resource;
use crate::glints::{
    ALPHA_RANGE, COLOURS, FACET_SPREAD_RANGE, GlintsParams, GlintsUniform, INVERSE, MAX_COLOURS, MAX_DENSITY, PARAMS,
    TERMS, UNIFORM,
};
use crate::issue::{Issue, IssueCode};
use crate::sections::{Loaded, Sections};
use std::ops::RangeInclusive;

/// Checks every material of counted facets.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_material(sections, section, issues);
    }
    sections.report_orphans(&[UNIFORM, COLOURS, INVERSE, TERMS], PARAMS, issues);
}

fn check_material(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) {
    let [uniform, colours, inverse, terms] =
        [UNIFORM, COLOURS, INVERSE, TERMS].map(|kind| sections.need(kind, section, issues));
    let Some(params) = section.parameters::<GlintsParams>(issues) else { return };
    if let Err(why) = check_parameters(&params) {
        issues.push(section.error(IssueCode::GlintsParameters, why));
        return;
    }
    if let Some(uniform) = uniform {
        check_uniform(uniform, &params, issues);
    }
    if let Some(colours) = colours {
        check_colours(colours, &params, issues);
    }
    check_tables(inverse, terms, issues);
}

fn check_parameters(params: &GlintsParams) -> Result<(), String> {
    let turn = std::f32::consts::PI;
    let (alpha, spread) = (ALPHA_RANGE.0..=ALPHA_RANGE.1, FACET_SPREAD_RANGE.0..=FACET_SPREAD_RANGE.1);
    let ranges: [(&str, &[f32], RangeInclusive<f32>); 11] = [
        ("roughness", &params.alpha, alpha),
        ("turn", &[params.turn], -turn..=turn),
        ("reflectance", &params.f0, 0.0..=1.0),
        ("density", &[params.density], f32::MIN_POSITIVE..=MAX_DENSITY),
        ("share of the surface", &[params.relative_area], 0.0..=1.0),
        ("facet area", &[params.facet_area], 1.0..=2.0),
        ("spread of a facet", &[params.facet_spread], spread),
        ("spread under a sky", &[params.sky_spread], 0.0..=3.2),
        ("diffuse albedo", &params.diffuse, 0.0..=1.0),
        ("weight of the coat", &[params.coat], 0.0..=1.0),
        ("roughness of the coat", &[params.coat_alpha], ALPHA_RANGE.0..=ALPHA_RANGE.1),
    ];
    for (what, found, range) in ranges {
        // A range holds no NaN.
        if let Some(found) = found.iter().find(|value| !range.contains(value)) {
            return Err(format!("expected a {what} from {} to {}, found {found}", range.start(), range.end()));
        }
    }
    if params.colours.len() > MAX_COLOURS {
        return Err(format!("expected at most {MAX_COLOURS} colours, found {}", params.colours.len()));
    }
    if let Some(found) = params.colours.iter().flatten().find(|value| !(0.0..=f32::MAX).contains(*value)) {
        return Err(format!("expected colours that are finite and not negative, found {found}"));
    }
    if !(0.0..=f64::MAX).contains(&params.table_mean_error) {
        return Err(format!("expected errors that are finite and not negative, found {}", params.table_mean_error));
    }
    Ok(())
}

fn check_uniform(uniform: Loaded<'_>, params: &GlintsParams, issues: &mut Vec<Issue>) {
    let resource = Resource::Buffer { stride: size_of::<GlintsUniform>() as u32, count: 1 };
    if !uniform.expect(IssueCode::GlintsShape, resource, issues) {
        return;
    }
    let expected = params.uniform();
    if uniform.payload != bytemuck::bytes_of(&expected) {
        let found: GlintsUniform = bytemuck::pod_read_unaligned(uniform.payload);
        let message = format!("expected what follows from the parameters, {expected:?}, found {found:?}");
        issues.push(uniform.error(IssueCode::GlintsUniform, message));
    }
}

fn check_colours(colours: Loaded<'_>, params: &GlintsParams, issues: &mut Vec<Issue>) {
    let expected = params.palette();
    let resource = Resource::Buffer { stride: 16, count: expected.len() as u64 };
    if !colours.expect(IssueCode::GlintsShape, resource, issues) {
        return;
    }
    for (index, (found, expected)) in colours.payload.chunks_exact(16).zip(&expected).enumerate() {
        if found != bytemuck::bytes_of(expected) {
            let found: [f32; 4] = bytemuck::pod_read_unaligned(found);
            let message = format!("colour {index}: expected {expected:?} as in the parameters, found {found:?}");
            issues.push(colours.error(IssueCode::GlintsColours, message));
            return;
        }
    }
}
