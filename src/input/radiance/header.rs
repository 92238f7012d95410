//! The header of a Radiance file: lines of text up to an empty one, then the resolution line.
//!
//! Lines are `VARIABLE=value` or commands that made the picture; those that begin with a tab speak of an earlier picture. Only
//! variables that say what pixels mean are used, and values of others may be anything.

use super::super::error::InputError;
use super::super::primaries::Primaries;
use std::path::Path;

/// Most characters of a file that a message shows.
const SHOWN: usize = 60;

/// What a header says.
pub struct Header {
    /// Bytes up to the first scanline.
    pub length: usize,
    /// Size and order of the pixels.
    pub layout: Layout,
    /// Whether pixels are CIE XYZ instead of RGB.
    pub xyz: bool,
    /// Chromaticities of the pixels' RGB.
    pub primaries: Option<Primaries>,
    /// Factors that were applied to red, green and blue.
    pub correction: [f64; 3],
}

/// Size of an image, and where its scanlines lie.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Columns of the image.
    pub width: u64,
    /// Rows of the image.
    pub height: u64,
    /// Whether a scanline is a column; else a row.
    pub columns: bool,
    /// Whether x falls from pixel to pixel, or from scanline to scanline.
    pub leftward: bool,
    /// Whether rows come from the bottom up.
    pub upward: bool,
}

impl Layout {
    /// How many scanlines there are, and the pixels of each.
    pub fn scanlines(&self) -> (u64, u64) {
        if self.columns { (self.width, self.height) } else { (self.height, self.width) }
    }

    /// `-Y 512 +X 1024` and the seven like it: the axis from scanline to scanline first, Y up and X right.
    fn parse(line: &str) -> Option<Layout> {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let [first, first_count, second, second_count] = words[..] else { return None };
        let axis = |name: &str, count: &str| {
            let letter = name.strip_prefix(['-', '+']).filter(|letter| ["X", "Y"].contains(letter))?;
            let count = count.bytes().all(|b| b.is_ascii_digit()).then(|| count.parse::<u64>().ok())??;
            Some((letter == "X", name.starts_with('-'), count))
        };
        let (columns, first_falls, first_count) = axis(first, first_count)?;
        let (second_is_x, second_falls, second_count) = axis(second, second_count)?;
        if columns == second_is_x {
            return None;
        }
        let (x, y) = ((first_falls, first_count), (second_falls, second_count));
        let ((leftward, width), (y_falls, height)) = if columns { (x, y) } else { (y, x) };
        Some(Layout { width, height, columns, leftward, upward: !y_falls })
    }
}

/// Lines of a file and where they begin. Both ways to end a line are known.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self, path: &Path) -> Result<&'a [u8], InputError> {
        let rest = &self.bytes[self.at..];
        let Some(end) = rest.iter().position(|byte| *byte == b'\n') else {
            let what = format!(
                "the file is cut off: its header, which ends with an empty line and a line as \"-Y 512 +X 1024\", goes on at \
                 byte {} and has no end; copy or export it again",
                self.at
            );
            return Err(InputError::bad(path, what));
        };
        self.at += end + 1;
        let line = &rest[..end];
        Ok(line.strip_suffix(b"\r").unwrap_or(line))
    }
}

impl Header {
    /// The header of a file that begins with `#?`.
    pub fn parse(path: &Path, bytes: &[u8], notes: &mut Vec<String>) -> Result<Header, InputError> {
        let mut lines = Lines { bytes, at: 0 };
        lines.next(path)?;
        let mut variables = Variables::default();
        loop {
            let line = lines.next(path)?;
            if line.is_empty() {
                break;
            }
            variables.line(path, &String::from_utf8_lossy(line), notes)?;
        }
        let at = lines.at;
        let line = lines.next(path)?;
        let Some(layout) = Layout::parse(&String::from_utf8_lossy(line)) else {
            return Err(InputError::bad(
                path,
                format!(
                    "the HDR header is damaged at byte {at}: expected the size as \"-Y 512 +X 1024\", found {}; copy or \
                     export it again",
                    shown(&String::from_utf8_lossy(line))
                ),
            ));
        };
        variables.note(notes);
        let Variables { xyz, primaries, correction, .. } = variables;
        Ok(Header { length: lines.at, layout, xyz: xyz.unwrap_or(false), primaries, correction })
    }
}

/// Variables that were met.
struct Variables {
    /// What FORMAT says.
    xyz: Option<bool>,
    primaries: Option<Primaries>,
    correction: [f64; 3],
    exposure: f64,
    aspect: f64,
}

impl Default for Variables {
    fn default() -> Variables {
        Variables { xyz: None, primaries: None, correction: [1.0; 3], exposure: 1.0, aspect: 1.0 }
    }
}

impl Variables {
    fn line(&mut self, path: &Path, line: &str, notes: &mut Vec<String>) -> Result<(), InputError> {
        let Some((name, value)) = line.split_once('=') else { return Ok(()) };
        match name.trim_end() {
            "FORMAT" => self.format(path, value.trim())?,
            "EXPOSURE" => match positive::<1>(value) {
                Some([exposure]) => self.exposure *= exposure,
                None => notes.push(format!("EXPOSURE is {}, expected a number above 0; it is not used", shown(value))),
            },
            "PIXASPECT" => match positive::<1>(value) {
                Some([aspect]) => self.aspect *= aspect,
                None => notes.push(format!("PIXASPECT is {}, expected a number above 0; it is not used", shown(value))),
            },
            "COLORCORR" => match positive::<3>(value) {
                Some(factors) => (0..3).for_each(|c| self.correction[c] *= factors[c]),
                None => notes.push(format!(
                    "COLORCORR is {}, expected three numbers above 0; colours are taken as they are stored",
                    shown(value)
                )),
            },
            "PRIMARIES" => match numbers::<8>(value) {
                // What programs write that know of none.
                Some(none) if none == [0.0; 8] => {}
                Some([rx, ry, gx, gy, bx, by, wx, wy]) => {
                    self.primaries =
                        Some(Primaries { red: [rx, ry], green: [gx, gy], blue: [bx, by], white: [wx, wy] });
                }
                None => notes.push(format!(
                    "PRIMARIES is {}, expected x and y of red, green, blue and white; colours are taken as Rec. 709",
                    shown(value)
                )),
            },
            _ => {}
        }
        Ok(())
    }

    fn format(&mut self, path: &Path, value: &str) -> Result<(), InputError> {
        let xyz = match value {
            "32-bit_rle_rgbe" => false,
            "32-bit_rle_xyze" => true,
            _ => {
                return Err(InputError::unsupported(
                    path,
                    format!(
                        "FORMAT is {}; expected 32-bit_rle_rgbe or 32-bit_rle_xyze: export it as a Radiance picture",
                        shown(value)
                    ),
                ));
            }
        };
        if self.xyz.is_some_and(|before| before != xyz) {
            return Err(InputError::bad(
                path,
                "the header names two values of FORMAT, 32-bit_rle_rgbe and 32-bit_rle_xyze: remove the wrong line",
            ));
        }
        self.xyz = Some(xyz);
        Ok(())
    }

    /// Says what is not applied.
    fn note(&self, notes: &mut Vec<String>) {
        if self.exposure != 1.0 {
            notes.push(format!("the header names an exposure of {}; radiance is taken as it is stored", self.exposure));
        }
        if self.aspect != 1.0 {
            notes.push(format!(
                "the header says that pixels are {} times as high as wide (PIXASPECT); the image is taken as the whole sphere \
                 in steps of longitude and latitude",
                self.aspect
            ));
        }
        if self.xyz.is_none() {
            notes.push("the header names no FORMAT; pixels are taken as RGBE".to_owned());
        }
    }
}

/// So many finite numbers.
fn numbers<const N: usize>(value: &str) -> Option<[f64; N]> {
    let all: Option<Vec<f64>> =
        value.split_ascii_whitespace().map(|word| word.parse().ok().filter(|n: &f64| n.is_finite())).collect();
    all?.try_into().ok()
}

/// So many numbers above 0 that a float can divide by.
fn positive<const N: usize>(value: &str) -> Option<[f64; N]> {
    numbers(value).filter(|all: &[f64; N]| all.iter().all(|n| (1e-30..=1e30).contains(n)))
}

/// A piece of the file for a message, in quotes.
fn shown(text: &str) -> String {
    let mut short: String = text.trim().chars().take(SHOWN).collect();
    if text.trim().chars().nth(SHOWN).is_some() {
        short.push('…');
    }
    format!("{short:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolution_lines() {
        let of = |columns, leftward, upward| Some(Layout { width: 8, height: 4, columns, leftward, upward });
        for (line, expected) in [
            ("-Y 4 +X 8", of(false, false, false)),
            ("-Y 4 -X 8", of(false, true, false)),
            ("+Y 4 +X 8", of(false, false, true)),
            ("+Y 4 -X 8", of(false, true, true)),
            ("+X 8 -Y 4", of(true, false, false)),
            ("-X 8 -Y 4", of(true, true, false)),
            ("+X 8 +Y 4", of(true, false, true)),
            ("  -X\t8  +Y 4 ", of(true, true, true)),
            ("-Y 4 +Y 8", None),
            ("-Y 4 +X", None),
            ("-Y 4 +X 8 9", None),
            ("Y 4 X 8", None),
            ("-Y -4 +X 8", None),
            ("-Y 4 +Z 8", None),
            ("-Y 99999999999999999999999 +X 8", None),
        ] {
            assert_eq!(Layout::parse(line), expected, "{line}");
        }
    }
}
