//! Which way up the rows and columns of a file are shown: TIFF's tag 274, and the same eight values in EXIF.
//!
//! The tag moves texels, but whether the vectors in them move along depends on who wrote it. A writer whose rows begin at the
//! bottom, as those of graphics cards do, stores vectors that are right in the picture as it is shown. A program that turns a
//! finished map by its tag leaves vectors that are right in the rows as they are stored, so they must be turned with the texels.
//! A surface has no curl, and that tells one from the other. Where it does not (a half turn, a flat map, noise), the
//! vectors are turned.

use super::options::InputOptions;
use glint_bake_core::normal_map::{GreenAxis, NormalMap, NormalOptions, RawNormals};

/// Correlations of curl as different as this tell one reading from the other; those of real maps are ±0.6 to ±1.
const TELLING_DIFFERENCE: f64 = 0.5;
/// Fewer texels than these may correlate by chance.
const ENOUGH_TEXELS: usize = 64;

/// How a stored picture becomes the one that is shown: x and y change places, then axes are mirrored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Orientation {
    /// Columns are shown as rows.
    swaps: bool,
    /// Shown from right to left, from bottom to top.
    mirrors: [bool; 2],
}

impl Orientation {
    /// The meaning of a tag's value; values that are none of the eight mean nothing, as in most programs.
    pub fn of_tag(value: u64) -> Orientation {
        let (swaps, mirrors) = match value {
            2 => (false, [true, false]),
            3 => (false, [true, true]),
            4 => (false, [false, true]),
            5 => (true, [false, false]),
            6 => (true, [true, false]),
            7 => (true, [true, true]),
            8 => (true, [false, true]),
            _ => (false, [false, false]),
        };
        Orientation { swaps, mirrors }
    }

    /// Whether the picture is shown as it is stored.
    pub fn is_as_stored(self) -> bool {
        self == Orientation::default()
    }

    /// The tag's value.
    fn tag(self) -> u8 {
        match (self.swaps, self.mirrors) {
            (false, [false, false]) => 1,
            (false, [true, false]) => 2,
            (false, [true, true]) => 3,
            (false, [false, true]) => 4,
            (true, [false, false]) => 5,
            (true, [true, false]) => 6,
            (true, [true, true]) => 7,
            (true, [false, true]) => 8,
        }
    }

    /// What it does, in words.
    fn words(self) -> &'static str {
        match self.tag() {
            1 => "as stored",
            2 => "mirrored left to right",
            3 => "turned by 180°",
            4 => "mirrored top to bottom",
            5 => "mirrored along the falling diagonal",
            6 => "turned clockwise by 90°",
            7 => "mirrored along the rising diagonal",
            _ => "turned anticlockwise by 90°",
        }
    }

    /// Width and height of the picture as it is shown.
    pub fn size(self, (width, height): (u32, u32)) -> (u32, u32) {
        if self.swaps { (height, width) } else { (width, height) }
    }

    /// Texels of the picture as it is shown.
    pub fn texels<T: Copy>(self, (width, height): (u32, u32), stored: Vec<T>) -> Vec<T> {
        if self.is_as_stored() {
            return stored;
        }
        let (columns, rows) = self.size((width, height));
        let mut shown = Vec::with_capacity(stored.len());
        for j in 0..rows {
            for i in 0..columns {
                let i = if self.mirrors[0] { columns - 1 - i } else { i };
                let j = if self.mirrors[1] { rows - 1 - j } else { j };
                let (i, j) = if self.swaps { (j, i) } else { (i, j) };
                shown.push(stored[j as usize * width as usize + i as usize]);
            }
        }
        shown
    }

    /// A vector turned with the texels; `up` is which way its y points.
    fn turned(self, [x, y, z]: [f32; 3], up: GreenAxis) -> [f32; 3] {
        let flip = |y: f32| if up == GreenAxis::Up { -y } else { y };
        let (x, y) = if self.swaps { (flip(y), x) } else { (x, flip(y)) };
        let mirror = |v: f32, mirrors: bool| if mirrors { -v } else { v };
        [mirror(x, self.mirrors[0]), flip(mirror(y, self.mirrors[1])), z]
    }

    /// The note for heights, whose texels move and nothing else.
    pub fn say_moved(self, notes: &mut Vec<String>) {
        if !self.is_as_stored() {
            notes.push(format!("an orientation tag of {}: shown {}, as the tag says", self.tag(), self.words()));
        }
    }

    /// Normals of a picture whose texels were moved already: vectors that are right in the stored rows are turned too.
    pub fn settle(self, raw: RawNormals, options: &InputOptions, notes: &mut Vec<String>) -> RawNormals {
        if self.is_as_stored() {
            return raw;
        }
        let vectors = raw.vectors.iter().map(|v| self.turned(*v, options.y)).collect();
        let turned = RawNormals { vectors, ..raw };
        let why = match (curl_correlation(&raw, options), curl_correlation(&turned, options)) {
            (Some(kept), Some(moved)) if kept > moved + TELLING_DIFFERENCE => {
                notes.push(format!(
                    "an orientation tag of {}: shown {}; x and y of the normals fit the picture as it is shown, and are kept",
                    self.tag(),
                    self.words()
                ));
                return raw;
            }
            (Some(kept), Some(moved)) if moved > kept + TELLING_DIFFERENCE => "they fit the rows as they are stored",
            _ => "the map does not tell whether that was done already",
        };
        notes.push(format!(
            "an orientation tag of {}: shown {}, and x and y of the normals are turned likewise: {why}",
            self.tag(),
            self.words()
        ));
        turned
    }
}

/// How far the normals are those of a surface; `None` where they cannot tell, or are refused later.
fn curl_correlation(raw: &RawNormals, options: &InputOptions) -> Option<f64> {
    if raw.vectors.len() < ENOUGH_TEXELS {
        return None;
    }
    let options = NormalOptions { wrap: options.wrap, y: options.y };
    NormalMap::from_vectors(raw, &options).ok()?.1.curl_correlation
}
