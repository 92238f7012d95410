//! What stored values mean: which of them are a normal or a height, on which scale and by which curve.
//!
//! Each question has a file: is a texel painted at all (`coverage`), which channels hold the normal (`channels`), are values
//! encoded colours (`colour`), 0…1 or −1…1 (`scale`), in tangent space (`space`), what did a lossy codec do (`noise`), and
//! what does a height map hold (`heights`). What is taken is noted; what is ambiguous is refused, with the flags that say it.
//! Most maps leave no doubt, and some of their texels (`sample`) tell that.

mod channels;
mod colour;
mod coverage;
mod heights;
mod lengths;
mod noise;
mod sample;
mod scale;
mod space;

use super::error::InputError;
use super::limits::from_bake;
use super::options::{Crop, InputOptions};
use super::pixels::{Pixels, Stored, Values, unorm8};
use super::transfer::Transfer;
use coverage::Coverage;
use glint_bake_core::normal_map::{RawNormals, lifted};
use sample::sample;
use scale::Scale;
use std::path::Path;

/// Pixels as raw normals, all of them or `part`; heights are turned into normals before anything is cut off.
pub(super) fn raw_normals(
    path: &Path,
    pixels: Pixels,
    part: Option<Crop>,
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<RawNormals, InputError> {
    let Pixels { width, height, values, stored } = pixels;
    if let Some(scale) = options.height {
        coverage::note_alpha(&values, |_| false, options.alpha, notes);
        let heights = heights::heights(path, width, values, &stored, options, notes)?;
        let raw = RawNormals::from_heights(width, height, &heights, scale, options.wrap);
        let raw = match part {
            Some(Crop { x, y, w, h }) => raw.and_then(|raw| raw.crop(x, y, w, h)),
            None => raw,
        };
        return raw.map_err(|e| from_bake(path, e));
    }
    // What the map is is asked of the whole of it.
    let meaning = Meaning::of(path, &values, &stored, options, notes)?;
    let Some(part) = part else {
        return Ok(RawNormals { width, height, vectors: meaning.vectors(&values) });
    };
    let values = values.crop((width, height), part).map_err(|e| from_bake(path, e))?;
    Ok(RawNormals { width: part.w, height: part.h, vectors: meaning.vectors(&values) })
}

/// How a map's values become vectors.
struct Meaning {
    two: Option<[usize; 2]>,
    scale: Scale,
    coverage: Coverage,
    transfer: Transfer,
}

impl Meaning {
    /// Decides what a map is, or refuses it.
    fn of(
        path: &Path,
        values: &Values,
        stored: &Stored,
        options: &InputOptions,
        notes: &mut Vec<String>,
    ) -> Result<Meaning, InputError> {
        let two = options.channels.and_then(|channels| channels.two());
        channels::check_there(path, values, options.channels)?;
        let scale = Scale::of(values, stored, notes);
        let coverage = Coverage::of(values, stored, scale, two);
        let sample = sample(values, |texel| !coverage.is_unpainted(texel));
        if options.channels.is_none() {
            channels::refuse_two(path, values, &sample, stored, scale, &coverage)?;
        }
        coverage.check(path, notes)?;
        coverage.note_alpha(values, options, notes);
        let painted = || values.texels().filter(|texel| !coverage.is_unpainted(texel));
        let chosen = sample.iter().copied();
        let transfer = colour::transfer(path, chosen, painted, stored, scale, options, notes)?;
        let meaning = Meaning { two, scale, coverage, transfer };
        let painted = || values.texels().filter(|texel| !meaning.coverage.is_unpainted(texel));
        let measured = || sample.iter().map(|texel| meaning.vector(*texel));
        if options.channels.is_none() {
            space::refuse_other_spaces(path, measured(), || painted().map(|texel| meaning.vector(texel)))?;
        }
        if let Some(codec) = stored.lossy {
            notes.push(noise::note(codec, two.is_some(), measured()));
        }
        Ok(meaning)
    }

    fn colour(&self, v: f32) -> f32 {
        self.scale.signed(self.transfer.decode(v))
    }

    /// The vector of a texel.
    fn vector(&self, texel: [f32; 4]) -> [f32; 3] {
        if self.coverage.is_unpainted(&texel) {
            return [0.0, 0.0, 1.0];
        }
        let [r, g, b, a] = texel;
        match self.two {
            None => [r, g, b].map(|v| self.colour(v)),
            Some(columns) => {
                // Alpha is linear whatever the colours are.
                let signed = [self.colour(r), self.colour(g), self.colour(b), self.scale.signed(a)];
                lifted(columns.map(|column| signed[column]))
            }
        }
    }

    /// One vector a texel.
    fn vectors(&self, values: &Values) -> Vec<[f32; 3]> {
        match values {
            Values::Rgb8(texels) if self.two.is_none() && self.coverage.is_whole() => {
                let colours: [f32; 256] = std::array::from_fn(|v| self.colour(unorm8(v as u8)));
                texels.iter().map(|texel| texel.map(|v| colours[v as usize])).collect()
            }
            values => values.texels().map(|texel| self.vector(texel)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (1024, 512);
    const ALL: usize = (SIZE.0 * SIZE.1) as usize;

    /// Reads the corner of a flat map whose last `count` texels are of this colour.
    fn read(count: usize, colour: [u8; 3]) -> (Result<RawNormals, InputError>, Vec<String>) {
        let mut texels = vec![[128, 128, 255]; ALL];
        texels[ALL - count..].fill(colour);
        let stored = Stored { bits: Some(8), ..Stored::default() };
        let pixels = Pixels { width: SIZE.0, height: SIZE.1, values: Values::Rgb8(texels), stored };
        let part = Some(Crop { x: 3, y: 5, w: 2, h: 1 });
        let mut notes = Vec::new();
        (raw_normals(Path::new("map.png"), pixels, part, &InputOptions::default(), &mut notes), notes)
    }

    #[test]
    fn large_maps_are_judged_as_a_whole_and_to_the_texel() {
        let most = ALL / 50;
        let (raw, notes) = read(most, [128, 128, 0]);
        assert_eq!(notes, Vec::<String>::new());
        let up = 128.0 / 255.0 * 2.0 - 1.0;
        assert_eq!(raw.unwrap(), RawNormals { width: 2, height: 1, vectors: vec![[up, up, 1.0]; 2] });
        for count in [most + 1, ALL / 4] {
            let error = read(count, [128, 128, 0]).0.unwrap_err().to_string();
            assert!(error.contains(&format!("{count} of {ALL} normals point below")), "{error}");
        }
    }

    #[test]
    fn one_black_texel_of_many_is_found() {
        let (raw, notes) = read(1, [0, 0, 0]);
        assert!(raw.is_ok());
        assert_eq!(notes, [format!("1 of {ALL} texels are unpainted (black); taken as flat")]);
    }

    #[test]
    fn few_painted_texels_of_a_large_map_are_all_asked() {
        // Painted as a map of two channels: blue is no z.
        let count = ALL / 50;
        let mut texels = vec![[0; 3]; ALL];
        for (at, texel) in texels[..count].iter_mut().enumerate() {
            *texel = [(at % 256) as u8, 128, 128];
        }
        let stored = Stored { bits: Some(8), ..Stored::default() };
        let pixels = Pixels { width: SIZE.0, height: SIZE.1, values: Values::Rgb8(texels), stored };
        let raw = raw_normals(Path::new("map.png"), pixels, None, &InputOptions::default(), &mut Vec::new());
        let error = raw.unwrap_err().to_string();
        assert!(error.contains("blue is 0.50 everywhere"), "{error}");
    }
}
