//! Which channels hold the normal, and how maps of two channels give themselves away.
//!
//! A map of two channels leaves the others constant (BC5: blue 0, ½ or 1) or copies one into them (DXT5nm: x in alpha, y in
//! green; grey with alpha). In a map of three, blue is z: it varies with x and y. So a map is refused when blue is constant
//! and yet not the z that x and y ask for, neither as they are nor decoded as sRGB, or when alpha varies and the colours hold
//! one channel only. A map that is flat, whose z rounds to one step, or whose alpha holds something else, is neither.

use super::coverage::Coverage;
use super::scale::Scale;
use crate::input::error::InputError;
use crate::input::options::Channels;
use crate::input::pixels::{Stored, Values};
use crate::input::transfer::Transfer;
use glint_bake_core::normal_map::lifted;
use std::path::Path;

/// Range of stored values up to which a channel is constant: the rounding of 8 bits, and what a lossy codec adds.
const CONSTANT: f32 = 2.5 / 255.0;
const CONSTANT_LOSSY: f32 = 10.0 / 255.0;

/// Largest error of z that is left to a constant blue: what 8 bits of x and y are off by.
const MAX_Z_ERROR: f32 = 0.02;

/// Share of texels that tells something from stray ones.
const STRAY: f64 = 0.01;

/// Error of length above which a vector is no normal.
const MAX_LENGTH_ERROR: f32 = 0.05;

/// Refuses files that have not the channels that are asked for.
pub(super) fn check_there(path: &Path, values: &Values, channels: Option<Channels>) -> Result<(), InputError> {
    let two = channels.and_then(Channels::two);
    if values.is_grey() && !two.is_some_and(|columns| columns.contains(&3)) {
        let advice = match values.has_alpha() {
            true => "; for x in grey and y in alpha give --channels ra, the other way round --channels ar",
            false => "",
        };
        return Err(InputError::bad(
            path,
            format!(
                "the image has one channel (grey); expected a normal map in red, green, blue{advice}. For a height map \
                 give --height SCALE, the height in texels of white"
            ),
        ));
    }
    if two.is_some_and(|columns| columns.contains(&3)) && !values.has_alpha() {
        return Err(InputError::bad(
            path,
            "--channels names alpha, which the image has not; expected red and green: give --channels xy",
        ));
    }
    Ok(())
}

/// What the channels of all painted texels span.
struct Ranges {
    least: [f32; 4],
    most: [f32; 4],
    /// Largest difference between two of the three colours.
    colourful: f32,
    texels: u64,
}

impl Ranges {
    fn of(painted: impl Iterator<Item = [f32; 4]>) -> Ranges {
        let mut ranges = Ranges { least: [f32::INFINITY; 4], most: [f32::NEG_INFINITY; 4], colourful: 0.0, texels: 0 };
        for texel in painted {
            for (channel, &v) in texel.iter().enumerate() {
                ranges.least[channel] = ranges.least[channel].min(v);
                ranges.most[channel] = ranges.most[channel].max(v);
            }
            let [r, g, b, _] = texel;
            ranges.colourful = ranges.colourful.max((r - g).abs()).max((g - b).abs());
            ranges.texels += 1;
        }
        ranges
    }

    fn of_channel(&self, channel: usize) -> f32 {
        self.most[channel] - self.least[channel]
    }

    fn share(&self, count: u64) -> f64 {
        count as f64 / self.texels as f64
    }
}

/// Painted texels that cannot be what some channels would make them.
#[derive(Default)]
struct Misfits {
    /// Texels that are no unit vectors.
    wrong_length: u64,
    /// Texels whose red and green, alpha and red, alpha and green are too long for two components.
    too_long: [u64; 3],
}

impl Misfits {
    fn of(values: &Values, scale: Scale, coverage: &Coverage) -> Misfits {
        let mut misfits = Misfits::default();
        for texel in values.texels().filter(|texel| !coverage.is_unpainted(texel)) {
            let [x, y, z, w] = texel.map(|v| scale.signed(v));
            misfits.wrong_length += u64::from(((x * x + y * y + z * z).sqrt() - 1.0).abs() > MAX_LENGTH_ERROR);
            for (count, (x, y)) in misfits.too_long.iter_mut().zip([(x, y), (w, x), (w, y)]) {
                *count += u64::from(x.hypot(y) > 1.0 + MAX_Z_ERROR);
            }
        }
        misfits
    }
}

/// Painted texels whose x and y, in red and green, ask for another z than blue.
fn wrong_z(values: &Values, scale: Scale, coverage: &Coverage, transfer: &Transfer) -> u64 {
    let painted = values.texels().filter(|texel| !coverage.is_unpainted(texel));
    let is_wrong = |[r, g, b, _]: [f32; 4]| {
        let [x, y, z] = [r, g, b].map(|v| scale.signed(transfer.decode(v)));
        (lifted([x, y])[2] - z).abs() > MAX_Z_ERROR
    };
    painted.map(|texel| u64::from(is_wrong(texel))).sum()
}

/// Refuses maps of two channels that are to be read as three; `sample` has some of the painted texels.
pub(super) fn refuse_two(
    path: &Path,
    values: &Values,
    sample: &[[f32; 4]],
    stored: &Stored,
    scale: Scale,
    coverage: &Coverage,
) -> Result<(), InputError> {
    let tolerance = if stored.lossy.is_some() { CONSTANT_LOSSY } else { CONSTANT };
    // Nearly all maps end here. Other texels can only widen the ranges: what varies here varies.
    let of_sample = Ranges::of(sample.iter().copied());
    if of_sample.of_channel(2) > tolerance && !(values.has_alpha() && of_sample.colourful <= tolerance) {
        return Ok(());
    }
    let ranges = Ranges::of(values.texels().filter(|texel| !coverage.is_unpainted(texel)));
    let constant = |channel: usize| ranges.of_channel(channel) <= tolerance;
    let one_colour = ranges.colourful <= tolerance;
    let rest_is_constant = constant(2) && (constant(0) || constant(1));
    let in_alpha = values.has_alpha() && !constant(3) && (one_colour || rest_is_constant);
    let pair = constant(2) && (!constant(0) || !constant(1));
    if ranges.texels == 0 || !(in_alpha || pair) {
        return Ok(());
    }
    let misfits = Misfits::of(values, scale, coverage);
    let no_vectors = ranges.share(misfits.wrong_length) > 0.5;
    let fits = ranges.share(misfits.too_long[1].min(misfits.too_long[2])) <= STRAY;
    if in_alpha && no_vectors && fits {
        let found = if one_colour { "red, green and blue are the same" } else { "all colours but one are constant" };
        return Err(InputError::bad(
            path,
            format!(
                "this looks like a map of two channels with one in alpha: alpha varies and {found}, so that they are no \
                 normals of three. Give --channels ag (x in alpha, y in green: DXT5nm, Unity), ga, ra or ar, as it was \
                 made; if red, green and blue are the normal after all, --channels xyz"
            ),
        ));
    }
    let pair = pair && ranges.share(misfits.too_long[0]) <= STRAY;
    // A shallow map that was encoded by the sRGB curve has the right z once it is decoded.
    let wrong = |transfer: Transfer| ranges.share(wrong_z(values, scale, coverage, &transfer)) > STRAY;
    if pair && wrong(Transfer::Linear) && (scale == Scale::Signed || wrong(Transfer::Srgb)) {
        return Err(InputError::bad(
            path,
            format!(
                "this looks like a map of two channels: blue is {:.2} everywhere, which is not the z of red and green. Give \
                 --channels xy (BC5; z is computed), or yx; if blue is z after all, --channels xyz",
                (ranges.least[2] + ranges.most[2]) / 2.0
            ),
        ));
    }
    Ok(())
}
