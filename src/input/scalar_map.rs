//! Maps of one number a texel that go with a normal map, 0 to 1: roughness, occlusion, metallic. Linear data, whatever a file's
//! colour tag says, as glTF and engines have it.

use super::error::InputError;
use super::guard::guarded;
use super::limits::{digest, read};
use super::normal_map::decode;
use super::one_channel::{checked, one_channel};
use super::options::{AlphaUse, Crop, InputOptions};
use super::pixels::Pixels;
use glint_bake_core::textures::levels::shares;
use glint_formats::Wrap;
use glint_formats::provenance::InputDigest;
use std::path::Path;

/// A map with where it came from and what was noticed.
#[derive(Clone, Debug)]
pub struct LoadedScalar {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Row-major, each 0 to 1.
    pub values: Vec<f32>,
    /// Name without folders, size and digest of the bytes that were read.
    pub digest: InputDigest,
    /// What the user should know, one sentence each.
    pub warnings: Vec<String>,
}

/// Loads a map. `channel` is the column of red, green, blue, alpha to use; without one the image has to be grey. `flag` is what
/// chooses it, for messages.
///
/// # Errors
/// [`InputError`]: a file that cannot be read, colours without a channel, a channel that is not there, a value that is not 0 to 1,
/// whose texel is named.
pub fn load_scalar_map(
    path: &Path,
    channel: Option<usize>,
    flag: &str,
    crop: Option<Crop>,
    max_memory: u64,
) -> Result<LoadedScalar, InputError> {
    let bytes = read(path, max_memory)?;
    scalar_map_of(path, &bytes, channel, flag, crop, max_memory)
}

/// The same for bytes that are there already; `path` is what messages call them.
///
/// # Errors
/// Those of [`load_scalar_map`].
pub fn scalar_map_of(
    path: &Path,
    bytes: &[u8],
    channel: Option<usize>,
    flag: &str,
    crop: Option<Crop>,
    max_memory: u64,
) -> Result<LoadedScalar, InputError> {
    let alpha = if channel == Some(3) { AlphaUse::Taken { flag: None } } else { AlphaUse::default() };
    let options = InputOptions { max_memory, alpha, ..InputOptions::default() };
    let (pixels, mut warnings) = guarded(path, || decode(path, bytes, &options))?;
    let Pixels { width, height, values, .. } = pixels;
    let numbers = one_channel(path, width, &values, channel, flag)?;
    drop(values);
    let (values, (width, height)) = checked(path, "texel", numbers, (width, height), crop)?;
    Ok(LoadedScalar { width, height, values, digest: digest(path, bytes, &mut warnings), warnings })
}

impl LoadedScalar {
    /// The map at another size: averaged where that is smaller, linear between texels where it is larger.
    pub fn resized(mut self, (width, height): (u32, u32), wrap: Wrap) -> LoadedScalar {
        if (self.width, self.height) == (width, height) {
            return self;
        }
        let (columns, rows) = (taps(self.width, width, wrap), taps(self.height, height, wrap));
        let value = |j: usize, i: usize| -> f32 {
            let row = |at: &usize| -> f32 {
                let line = &self.values[at * self.width as usize..][..self.width as usize];
                columns[i].iter().map(|(at, share)| share * line[*at]).sum()
            };
            rows[j].iter().map(|(at, share)| share * row(at)).sum::<f32>().clamp(0.0, 1.0)
        };
        let values = (0..height as usize).flat_map(|j| (0..width as usize).map(move |i| (j, i)));
        let values = values.map(|(j, i)| value(j, i)).collect();
        self.warnings.push(format!("{} × {} texels, used at {width} × {height}", self.width, self.height));
        LoadedScalar { width, height, values, ..self }
    }
}

/// For each texel of an axis of `to`, those of the axis of `from` that it is made of, with shares that add up to 1.
fn taps(from: u32, to: u32, wrap: Wrap) -> Vec<Vec<(usize, f32)>> {
    if to <= from {
        let of = |(first, shares): (u32, Vec<f32>)| (first as usize..).zip(shares).collect();
        return shares(from, to).into_iter().map(of).collect();
    }
    let inside = |i: i64| match wrap {
        Wrap::Repeat => i.rem_euclid(i64::from(from)) as usize,
        Wrap::Clamp => i.clamp(0, i64::from(from) - 1) as usize,
    };
    let of = |i: u32| {
        let at = (f64::from(i) + 0.5) * f64::from(from) / f64::from(to) - 0.5;
        let part = (at - at.floor()) as f32;
        vec![(inside(at.floor() as i64), 1.0 - part), (inside(at.floor() as i64 + 1), part)]
    };
    (0..to).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(width: u32, height: u32, values: &[f32]) -> LoadedScalar {
        let digest = InputDigest::of("a.png", b"");
        LoadedScalar { width, height, values: values.to_vec(), digest, warnings: Vec::new() }
    }

    #[test]
    fn sizes_change_as_textures_do() {
        let small = map(4, 1, &[0.0, 1.0, 0.5, 0.5]).resized((2, 1), Wrap::Clamp);
        assert_eq!(small.values, [0.5, 0.5]);
        let large = map(2, 1, &[0.0, 1.0]).resized((4, 1), Wrap::Clamp);
        assert_eq!(large.values, [0.0, 0.25, 0.75, 1.0]);
        let around = map(2, 1, &[0.0, 1.0]).resized((4, 1), Wrap::Repeat);
        assert_eq!(around.values, [0.25, 0.25, 0.75, 0.75]);
    }
}
