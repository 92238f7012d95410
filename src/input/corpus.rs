//! Files of strangers against another decoder: `scripts/corpus.py` writes beside each file what that decoder reads of it, and
//! `GLINT_CORPUS` names the folder. Skips, and says so, where it is not set.
//!
//! `NAME.expected` holds width, height and channels as u32, then the stored values as f32, row by row, all little-endian.

use super::environment::decode as radiance;
use super::error::InputError;
use super::guard::guarded;
use super::limits::read;
use super::normal_map::decode;
use super::options::{DEFAULT_MAX_MEMORY, InputOptions};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A file that takes longer hangs.
const LONGEST: Duration = Duration::from_secs(5);

/// How far apart two decoders of a lossy codec may be, and how many texels may be farther: sharp edges of colour, which each
/// upsamples in its own way.
const LOSSY: f32 = 12.0 / 255.0;
const STRAY: usize = 16;

struct Image {
    size: (u32, u32),
    texels: Vec<[f32; 4]>,
}

/// What another decoder reads; grey as three equal colours, alpha 1 where there is none.
fn expected(path: &Path) -> Option<Image> {
    let bytes = std::fs::read(path.with_file_name(format!("{}.expected", path.file_name()?.to_str()?))).ok()?;
    let word = |at: usize| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
    let [width, height, channels] = [0, 4, 8].map(|at| u32::from_le_bytes(word(at)));
    let values: Vec<f32> = (12..bytes.len()).step_by(4).map(|at| f32::from_le_bytes(word(at))).collect();
    let texel = |v: &[f32]| match *v {
        [grey] => [grey, grey, grey, 1.0],
        [grey, alpha] => [grey, grey, grey, alpha],
        [r, g, b] => [r, g, b, 1.0],
        [r, g, b, a] => [r, g, b, a],
        _ => panic!("{}: {channels} channels", path.display()),
    };
    Some(Image { size: (width, height), texels: values.chunks_exact(channels as usize).map(texel).collect() })
}

/// What we read: radiance of formats that only environments have, stored values of all others. And how much codecs may differ.
fn found(path: &Path) -> Result<(Image, f32), InputError> {
    let bytes = read(path, DEFAULT_MAX_MEMORY)?;
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if extension == "hdr" || extension == "exr" {
        let (width, height, pixels) =
            guarded(path, || radiance(path, &bytes, &InputOptions::default(), &mut Vec::new()))?;
        let texels = pixels.iter().map(|[r, g, b]| [*r, *g, *b, 1.0]).collect();
        return Ok((Image { size: (width, height), texels }, 0.0));
    }
    let (pixels, _) = guarded(path, || decode(path, &bytes, &InputOptions::default()))?;
    let tolerance = if pixels.stored.lossy.is_some() { LOSSY } else { 1.5e-5 };
    Ok((Image { size: (pixels.width, pixels.height), texels: pixels.values.texels().collect() }, tolerance))
}

/// Why two images differ.
fn difference(found: &Image, expected: &Image, tolerance: f32) -> Option<String> {
    if found.size != expected.size {
        return Some(format!("found {:?} texels, expected {:?}", found.size, expected.size));
    }
    let off = |a: f32, b: f32| {
        // Negative radiance is taken as 0.
        let same = a == b || (a == 0.0 && b < 0.0) || (a - b).abs() <= tolerance.max(1e-6 * b.abs());
        !(same || a.is_nan() && b.is_nan())
    };
    let differs = |(a, b): (&[f32; 4], &[f32; 4])| (0..4).any(|c| off(a[c], b[c]));
    let pairs = found.texels.iter().zip(&expected.texels);
    let at = pairs.clone().position(differs)?;
    let count = pairs.filter(|pair| differs(*pair)).count();
    if tolerance == LOSSY && count <= STRAY {
        return None;
    }
    let place = (at % found.size.0 as usize, at / found.size.0 as usize);
    Some(format!(
        "{count} texels differ, the first at {place:?}: found {:?}, expected {:?}",
        found.texels[at], expected.texels[at]
    ))
}

fn files(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_dir() {
            files(&entry, all);
        } else if entry.extension().is_none_or(|extension| extension != "expected") {
            all.push(entry);
        }
    }
}

#[test]
fn files_are_read_as_another_decoder_reads_them_or_refused() {
    let Ok(folder) = std::env::var("GLINT_CORPUS") else {
        println!("skipped: GLINT_CORPUS names no folder");
        return;
    };
    let mut all = Vec::new();
    files(Path::new(&folder), &mut all);
    all.sort();
    assert!(!all.is_empty(), "{folder} holds no files");
    let (mut counts, mut wrong) = (BTreeMap::<String, usize>::new(), Vec::new());
    for path in &all {
        let start = Instant::now();
        let outcome = found(path);
        let took = start.elapsed();
        if took > LONGEST {
            wrong.push(format!("{}: took {took:?}", path.display()));
        }
        let outcome = match (outcome, expected(path)) {
            (Err(error), _) => {
                println!("{}", error.to_string().lines().next().unwrap_or_default());
                format!("refused with {}", error.exit_code())
            }
            (Ok(_), None) => "read, unknown to the other decoder".into(),
            (Ok((found, tolerance)), Some(expected)) => match difference(&found, &expected, tolerance) {
                None => "equal".into(),
                Some(what) => {
                    wrong.push(format!("{}: {what}", path.display()));
                    "different".into()
                }
            },
        };
        *counts.entry(outcome).or_default() += 1;
    }
    println!("{} files: {counts:?}", all.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
