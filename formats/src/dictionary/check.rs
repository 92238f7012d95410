//! Checks the contents of dictionary sections: what a sampler relies on when it reads a marginal.

use crate::bytes::f16_at;
use crate::container::Resource;
use crate::dictionary::{DictionaryParams, MAX_TEXTURE_SIZE, PARAMS, ROW_TOLERANCE, TABLE, TABLE_VK_FORMAT};
use crate::issue::{Issue, IssueCode};
use crate::sections::{Loaded, Sections};

/// Checks every dictionary.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_dictionary(sections, section, issues);
    }
    sections.report_orphans(&[TABLE], PARAMS, issues);
}

fn check_dictionary(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) {
    let table = sections.need(TABLE, section, issues);
    let Some(params) = section.parameters::<DictionaryParams>(issues) else { return };
    if let Err(why) = check_parameters(&params) {
        issues.push(section.error(IssueCode::DictionaryParameters, why));
        return;
    }
    if let Some(table) = table
        && table.expect(IssueCode::DictionaryShape, table_resource(&params), issues)
    {
        check_rows(table, &params, issues);
    }
}

fn table_resource(params: &DictionaryParams) -> Resource {
    Resource::Texture {
        vk_format: TABLE_VK_FORMAT,
        width: params.entries,
        height: params.levels * params.marginals,
        layers: 1,
        faces: 1,
        mips: 1,
    }
}

fn check_parameters(params: &DictionaryParams) -> Result<(), String> {
    let rows = u64::from(params.marginals) * u64::from(params.levels);
    for (what, found) in [("rows", rows), ("entries", u64::from(params.entries))] {
        if !(1..=u64::from(MAX_TEXTURE_SIZE)).contains(&found) {
            return Err(format!("expected 1 to {MAX_TEXTURE_SIZE} {what}, found {found}"));
        }
    }
    let positive = [("roughness", params.alpha_dict), ("lobe deviation", params.lobe_std), ("domain", params.domain)];
    for (what, found) in positive {
        if !(found > 0.0 && found.is_finite()) {
            return Err(format!("expected a positive {what}, found {found}"));
        }
    }
    let measured = &params.measured;
    for error in [measured.normalisation, measured.mean_l1_first_level, measured.ks_last_level] {
        if !(error >= 0.0 && error.is_finite()) {
            return Err(format!("expected errors that are finite and not negative, found {error}"));
        }
    }
    Ok(())
}

/// Reports the first texel that is no density, else the first row whose integral over the whole line is not 1.
fn check_rows(table: Loaded<'_>, params: &DictionaryParams, issues: &mut Vec<Issue>) {
    let spacing = params.domain / f64::from(params.entries);
    let mut first_unequal = None;
    for (row, bytes) in table.payload.chunks_exact(2 * params.entries as usize).enumerate() {
        let mut sum = 0.0;
        for (texel, bytes) in bytes.chunks_exact(2).enumerate() {
            let value = f64::from(f16_at(bytes, 0));
            if !(value >= 0.0 && value.is_finite()) {
                let message = format!(
                    "texel {texel} of row {row}: expected a finite density that is not negative, found {value}"
                );
                issues.push(table.error(IssueCode::DictionaryValue, message));
                return;
            }
            sum += value;
        }
        let integral = 2.0 * spacing * sum;
        if first_unequal.is_none() && (integral - 1.0).abs() > ROW_TOLERANCE {
            first_unequal =
                Some(format!("row {row}: expected an integral within {ROW_TOLERANCE} of 1, found {integral}"));
        }
    }
    issues.extend(first_unequal.map(|why| table.error(IssueCode::DictionaryRow, why)));
}
