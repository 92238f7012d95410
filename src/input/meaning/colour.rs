//! Are the values encoded colours? A tag is a claim, and the data decide.
//!
//! Exporters tag normal maps as sRGB by habit, and glTF tells loaders to ignore it; a few maps really were encoded. A right
//! reading gives normals: unit length (the median is off by at most 5 %), or at least, since maps that were filtered from
//! larger ones are shorter, a mean that leans by at most 20° from z with lengths off by at most 20 %. Undoing a curve that
//! was never applied moves the neutral ½ to 0.21, so that the mean leans by 32° to 66°; leaving one on moves it to 0.74 and
//! the mean to 33° and more. Real maps as they are meant lean by at most 13° with medians off by at most 13 %.
//!
//! With a tag: values are taken as they are when that reading is right; decoded when only the other is; refused when
//! neither is. When both are, that with the better lengths is taken. Without a tag nothing is decoded; when only the
//! decoded reading is right, that is said. Two channels and heights have no lengths: they are taken as they are, and said.

use super::lengths::Fit;
use super::scale::Scale;
use crate::input::colour_tag::Claim;
use crate::input::error::InputError;
use crate::input::options::{Channels, ColourSpace, InputOptions};
use crate::input::pixels::Stored;
use crate::input::transfer::Transfer;
use std::path::Path;

/// Median deviation from unit length of unit vectors.
const UNIT: f64 = 0.05;

/// Most that the mean of normals leans, degrees, and most that their lengths are then off.
const MAX_LEAN: f64 = 20.0;
const MAX_DEVIATION: f64 = 0.2;

/// Degrees that the mean of a sample may lean away from that of all.
const LEAN_OF_SAMPLE: f64 = 5.0;

const NO_FIT: Fit = Fit { deviation: 1.0, lean: 180.0 };

fn is_right(fit: Fit) -> bool {
    fit.deviation <= UNIT || (fit.lean <= MAX_LEAN && fit.deviation <= MAX_DEVIATION)
}

/// The curve to undo, decided for the texels that are painted, of which `sample` has some.
pub(super) fn transfer<T: Iterator<Item = [f32; 4]>>(
    path: &Path,
    sample: impl Iterator<Item = [f32; 4]>,
    painted: impl Fn() -> T,
    stored: &Stored,
    scale: Scale,
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<Transfer, InputError> {
    let claim = stored.tag.0.as_ref().filter(|claim| claim.transfer != Transfer::Linear);
    if scale == Scale::Signed {
        return signed(path, claim, options, notes);
    }
    if let Some(transfer) = asked(claim, options, notes) {
        return Ok(transfer);
    }
    if options.channels.and_then(Channels::two).is_some() {
        notes.extend(claim.map(|claim| unjudged(claim, "two channels have no lengths to judge that by")));
        return Ok(Transfer::Linear);
    }
    let vector = |[r, g, b, _]: [f32; 4], transfer: &Transfer| [r, g, b].map(|v| scale.signed(transfer.decode(v)));
    // Nearly all maps end here. Lengths that are told are those of all texels.
    let of_sample = |fit: Fit| is_right(Fit { lean: fit.lean + LEAN_OF_SAMPLE, ..fit });
    if claim.is_none() && Fit::cautious(sample.map(|texel| vector(texel, &Transfer::Linear))).is_some_and(of_sample) {
        return Ok(Transfer::Linear);
    }
    let fit = |transfer: &Transfer| Fit::of(painted().map(|texel| vector(texel, transfer))).unwrap_or(NO_FIT);
    let plain = fit(&Transfer::Linear);
    let percent = |fit: Fit| format!("{:.1} %", 100.0 * fit.deviation);
    let Some(Claim { tag, transfer }) = claim else {
        if !is_right(plain) {
            let decoded = fit(&Transfer::Srgb);
            if is_right(decoded) {
                notes.push(format!(
                    "the values look encoded: their lengths are off by {} in the median, decoded as sRGB by {}; taken as \
                     they are, give --colour-space srgb to decode them",
                    percent(plain),
                    percent(decoded)
                ));
            }
        }
        return Ok(Transfer::Linear);
    };
    let decoded = if *transfer == Transfer::Unknown { NO_FIT } else { fit(transfer) };
    let lengths = format!("lengths are off by {} in the median, decoded by {}", percent(plain), percent(decoded));
    match (is_right(plain), is_right(decoded)) {
        (_, true) if !is_right(plain) || decoded.deviation < plain.deviation => {
            notes.push(format!("carries {tag}, and the data bear it out ({lengths}); decoded"));
            Ok(transfer.clone())
        }
        (true, _) => {
            let lengths = if *transfer == Transfer::Unknown { "they are normals as they are".into() } else { lengths };
            notes.push(format!("carries {tag}, but the values are not encoded ({lengths}); taken as they are"));
            Ok(Transfer::Linear)
        }
        _ => Err(InputError::bad(
            path,
            format!(
                "the file carries {tag}, and its values are no normals, neither as they are nor decoded ({lengths}); \
                 expected a normal map. If it is one, say how it is stored: --colour-space linear, or --colour-space srgb"
            ),
        )),
    }
}

/// The curve to undo for heights.
pub(super) fn transfer_of_heights(stored: &Stored, options: &InputOptions, notes: &mut Vec<String>) -> Transfer {
    let claim = stored.tag.0.as_ref().filter(|claim| claim.transfer != Transfer::Linear);
    if let Some(transfer) = asked(claim, options, notes) {
        return transfer;
    }
    notes.extend(claim.map(|claim| unjudged(claim, "heights have no lengths to judge that by")));
    Transfer::Linear
}

/// What the user asks for, if anything.
fn asked(claim: Option<&Claim>, options: &InputOptions, notes: &mut Vec<String>) -> Option<Transfer> {
    match options.colour_space {
        ColourSpace::Auto => None,
        ColourSpace::Linear => {
            notes.extend(claim.map(|claim| format!("carries {}; taken as linear, as asked", claim.tag)));
            Some(Transfer::Linear)
        }
        ColourSpace::Srgb => {
            notes.push("decoded by the sRGB curve, as asked".into());
            Some(Transfer::Srgb)
        }
    }
}

/// Signed floats are no colours, which are never negative.
fn signed(
    path: &Path,
    claim: Option<&Claim>,
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<Transfer, InputError> {
    if options.colour_space == ColourSpace::Srgb {
        return Err(InputError::bad(path, "--colour-space srgb is for values 0…1, and these are −1…1; leave it out"));
    }
    notes.extend(claim.map(|claim| format!("carries {}; signed values are no colours, taken as they are", claim.tag)));
    Ok(Transfer::Linear)
}

fn unjudged(claim: &Claim, why: &str) -> String {
    format!("carries {}; taken as they are, for {why}: give --colour-space srgb if they were encoded", claim.tag)
}
