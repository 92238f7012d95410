//! Texels that nobody painted: exactly black, or transparent. They are flat, counted and said.
//!
//! A colour of exactly (0, 0, 0) is never a normal: 0…1 gives (−1, −1, −1), which points down and is √3 long; −1…1 gives a
//! vector of no length. So a black texel is background, whatever alpha says; in a lossy file, black but for the codec's
//! noise. On −1…1, two channels of 0 are a flat normal, and are left to be that.
//!
//! Alpha often holds roughness, height or a mask, so alpha 0 says "unpainted" only where both hold: alpha is coverage by
//! its values (0 and 1 both occur, and nearly no others, which would be the edges), and the colours below alpha 0 are no
//! normals (their lengths are off by more than 5 %, and by half more than those of the others). Where they are normals,
//! alpha is a mask of something else, and they are kept. With two channels lengths tell nothing, so that only black counts.

use super::lengths::Fit;
use super::scale::Scale;
use crate::input::error::InputError;
use crate::input::options::{AlphaUse, Channels, InputOptions};
use crate::input::pixels::{Stored, Values, unorm8};
use std::path::Path;

/// Largest value of 8 bits that a lossy codec makes of black.
const NEARLY_BLACK: u8 = 8;

/// Share of texels with an alpha of 0 or 1 from which on alpha can be coverage.
const COVERAGE: f64 = 0.9;

/// Median deviation from unit length up to which vectors are normals.
const UNIT: f64 = 0.05;

/// Share of unpainted texels above which a picture is no normal map.
pub(super) const MAX_UNPAINTED: f64 = 0.99;

/// Which texels are unpainted.
pub(super) struct Coverage {
    /// Columns that must all be black.
    black: Option<Black>,
    /// Whether alpha 0 is unpainted.
    transparent: bool,
    /// Number of black texels.
    black_texels: u64,
    /// Number of transparent ones that are not black.
    transparent_texels: u64,
    /// Number of all texels.
    texels: u64,
}

/// When a texel is black.
struct Black {
    columns: [usize; 3],
    /// Largest black value of 8 bits.
    tolerance: u8,
}

impl Black {
    fn is(&self, texel: &[f32; 4]) -> bool {
        let tolerance = unorm8(self.tolerance);
        self.columns.iter().all(|&column| texel[column].abs() <= tolerance)
    }

    /// Number of black texels.
    fn count(&self, values: &Values) -> u64 {
        match values {
            Values::Rgb8(texels) if self.columns == [0, 1, 2] => {
                // Without a branch, so that many texels are compared at once.
                let is = |[r, g, b]: &[u8; 3]| (*r.max(g).max(b) <= self.tolerance) as u32;
                texels.chunks(1 << 16).map(|texels| u64::from(texels.iter().map(is).sum::<u32>())).sum()
            }
            values => values.texels().map(|texel| u64::from(self.is(&texel))).sum(),
        }
    }
}

impl Coverage {
    /// Looks at a file of which all colours, or these two columns, are used.
    pub fn of(values: &Values, stored: &Stored, scale: Scale, two: Option<[usize; 2]>) -> Coverage {
        let columns = two.map_or([0, 1, 2], |[x, y]| [x, y, y]);
        let tolerance = if stored.lossy.is_some() { NEARLY_BLACK } else { 0 };
        let black = (two.is_none() || scale == Scale::Unsigned).then_some(Black { columns, tolerance });
        let is_black = |texel: &[f32; 4]| black.as_ref().is_some_and(|black| black.is(texel));
        let transparent = two.is_none() && values.has_alpha() && alpha_is_coverage(values, scale, is_black);
        let black_texels = black.as_ref().map_or(0, |black| black.count(values));
        let transparent_texels = match transparent {
            true => values.texels().filter(|texel| texel[3] == 0.0 && !is_black(texel)).count() as u64,
            false => 0,
        };
        Coverage { black, transparent, black_texels, transparent_texels, texels: values.len() as u64 }
    }

    /// Whether all texels are painted.
    pub fn is_whole(&self) -> bool {
        self.black_texels + self.transparent_texels == 0
    }

    /// Whether a texel of this file is unpainted.
    pub fn is_unpainted(&self, texel: &[f32; 4]) -> bool {
        self.transparent && texel[3] == 0.0 || self.black.as_ref().is_some_and(|black| black.is(texel))
    }

    /// Counts unpainted texels in a note, and refuses a picture that has nothing else.
    pub fn check(&self, path: &Path, notes: &mut Vec<String>) -> Result<(), InputError> {
        let unpainted = self.black_texels + self.transparent_texels;
        if self.is_whole() {
            return Ok(());
        }
        let (texels, black, transparent) = (self.texels, self.black_texels, self.transparent_texels);
        if unpainted as f64 > MAX_UNPAINTED * texels as f64 {
            return Err(InputError::bad(
                path,
                format!(
                    "this is not a normal map: {unpainted} of {texels} texels are unpainted ({black} black, \
                     {transparent} with alpha 0), at most {:.0} % may be; is it the right file?",
                    MAX_UNPAINTED * 100.0
                ),
            ));
        }
        let kinds = [(black, "black"), (transparent, "alpha 0")].map(|(count, kind)| (count > 0).then_some(kind));
        let kinds = kinds.into_iter().flatten().collect::<Vec<_>>().join(" or ");
        notes.push(format!("{unpainted} of {texels} texels are unpainted ({kinds}); taken as flat"));
        Ok(())
    }

    /// Says that alpha is not used, where it holds something and nobody asked for that.
    pub fn note_alpha(&self, values: &Values, options: &InputOptions, notes: &mut Vec<String>) {
        if !options.channels.is_some_and(Channels::uses_alpha) {
            note_alpha(values, |texel| self.is_unpainted(texel), options.alpha, notes);
        }
    }
}

/// Says of texels that are painted that their alpha is not used.
pub(super) fn note_alpha(
    values: &Values,
    is_unpainted: impl Fn(&[f32; 4]) -> bool,
    alpha: AlphaUse,
    notes: &mut Vec<String>,
) {
    let AlphaUse::Ignored { flag } = alpha else { return };
    let holds_data = |texel: [f32; 4]| texel[3] != 1.0 && !is_unpainted(&texel);
    if values.has_alpha() && values.texels().any(holds_data) {
        let what = "the alpha channel holds data (often roughness or height); ignored";
        notes.push(flag.map_or(what.to_owned(), |flag| format!("{what}, unless {flag} says what it is")));
    }
}

/// Whether alpha says where the map is painted.
fn alpha_is_coverage(values: &Values, scale: Scale, is_black: impl Fn(&[f32; 4]) -> bool) -> bool {
    let (mut zero, mut one) = (0u64, 0u64);
    for [.., alpha] in values.texels() {
        zero += u64::from(alpha == 0.0);
        one += u64::from(alpha == 1.0);
    }
    if zero == 0 || one == 0 || ((zero + one) as f64) < COVERAGE * values.len() as f64 {
        return false;
    }
    let fit = |alpha: f32| {
        let chosen = values.texels().filter(|texel| texel[3] == alpha && !is_black(texel));
        Fit::of(chosen.map(|[r, g, b, _]| [r, g, b].map(|v| scale.signed(v))))
    };
    match (fit(0.0), fit(1.0)) {
        (Some(below), Some(painted)) => below.deviation > UNIT.max(1.5 * painted.deviation),
        _ => false,
    }
}
