//! Checks the contents of dictionary sections: what a shader relies on when it reads a marginal.

use crate::bytes::{u16_at, u32_at};
use crate::container::Resource;
use crate::dictionary::{
    DictionaryParams, DictionaryUniform, MAX_TABLE_SIDE, MAX_TABLE_WORDS, PARAMS, ROW_TOLERANCE, TABLE, UNIFORM,
};
use crate::issue::{Issue, IssueCode};
use crate::sections::{Loaded, Sections};
use half::f16;
use half::slice::HalfFloatSliceExt;

/// Checks every dictionary.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_dictionary(sections, section, issues);
    }
    sections.report_orphans(&[UNIFORM, TABLE], PARAMS, issues);
}

fn check_dictionary(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) {
    let [uniform, table] = [UNIFORM, TABLE].map(|kind| sections.need(kind, section, issues));
    let Some(params) = section.parameters::<DictionaryParams>(issues) else { return };
    if let Err(why) = check_parameters(&params) {
        issues.push(section.error(IssueCode::DictionaryParameters, why));
        return;
    }
    if let Some(uniform) = uniform {
        check_uniform(uniform, &params, issues);
    }
    let words = Resource::Buffer { stride: 4, count: params.table_entries().next_multiple_of(4) };
    if let Some(table) = table
        && table.expect(IssueCode::DictionaryShape, words, issues)
    {
        check_table(table, &params, issues);
    }
}

fn check_uniform(uniform: Loaded<'_>, params: &DictionaryParams, issues: &mut Vec<Issue>) {
    let resource = Resource::Buffer { stride: size_of::<DictionaryUniform>() as u32, count: 1 };
    if !uniform.expect(IssueCode::DictionaryShape, resource, issues) {
        return;
    }
    let expected = params.uniform();
    if uniform.payload != bytemuck::bytes_of(&expected) {
        let found: DictionaryUniform = bytemuck::pod_read_unaligned(uniform.payload);
        let message = format!("expected what follows from the parameters, {expected:?}, found {found:?}");
        issues.push(uniform.error(IssueCode::DictionaryUniform, message));
    }
}

fn check_parameters(params: &DictionaryParams) -> Result<(), String> {
    let rows = u64::from(params.marginals) * u64::from(params.levels);
    for (what, found) in [("rows", rows), ("entries", u64::from(params.entries))] {
        if !(1..=u64::from(MAX_TABLE_SIDE)).contains(&found) {
            return Err(format!("expected 1 to {MAX_TABLE_SIDE} {what}, found {found}"));
        }
    }
    if params.table_entries() > MAX_TABLE_WORDS {
        return Err(format!(
            "expected at most {MAX_TABLE_WORDS} entries of all rows, found {}",
            params.table_entries()
        ));
    }
    let positive = [
        ("roughness", params.alpha_dict),
        ("standard deviation of a lobe", params.lobe_std),
        ("domain", params.domain),
    ];
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

/// Reports the first entry that is no density or stands otherwise in the pair before it, else the first row whose integral over
/// the whole line is not 1.
fn check_table(table: Loaded<'_>, params: &DictionaryParams, issues: &mut Vec<Issue>) {
    let spacing = params.domain / f64::from(params.entries);
    let (rows, end) = table.payload.split_at(4 * params.table_entries() as usize);
    let mut first_unequal = None;
    let entries = params.entries as usize;
    let mut halves = vec![f16::ZERO; entries + 1];
    let mut values = vec![0.0; entries];
    for (row, bytes) in rows.chunks_exact(4 * entries).enumerate() {
        for (half, pair) in halves.iter_mut().zip(bytes.chunks_exact(4)) {
            *half = f16::from_bits(u16_at(pair, 0));
        }
        // The last entry is its own neighbour.
        halves[entries] = halves[entries - 1];
        // A row at once: each call asks the processor what it can do.
        halves[..entries].convert_to_f32_slice(&mut values);
        let mut sum = 0.0;
        for (entry, pair) in bytes.chunks_exact(4).enumerate() {
            let value = f64::from(values[entry]);
            if !(value >= 0.0 && value.is_finite()) {
                let message = format!(
                    "entry {entry} of row {row}: expected a finite density that is not negative, found {value}"
                );
                issues.push(table.error(IssueCode::DictionaryValue, message));
                return;
            }
            let next = halves[entry + 1].to_bits();
            if u16_at(pair, 2) != next {
                let word = u32_at(pair, 0);
                let message = format!(
                    "entry {entry} of row {row}: expected the next one, {next:#06x}, in the upper half, found {word:#010x}"
                );
                issues.push(table.error(IssueCode::DictionaryPair, message));
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
    if end.iter().any(|byte| *byte != 0) {
        issues.push(table.error(IssueCode::DictionaryPair, "expected zeros after the last row"));
    }
    issues.extend(first_unequal.map(|why| table.error(IssueCode::DictionaryRow, why)));
}
