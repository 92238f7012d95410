//! Radiance HDR: from bytes to linear RGB with the primaries of Rec. 709, in the order of an image, top left first.
//!
//! Greg Ward, *Real Pixels* (Graphics Gems II, 1991), and the Radiance manual's "Picture file format". A component is its
//! mantissa / 256 · 2^(exponent − 128), which a float holds exactly. Radiance's own library adds half a step to the mantissa;
//! other programs do not, and neither is done here.
//!
//! What a header says of the pixels:
//! - EXPOSURE is a factor that was applied, and several multiply. It is not undone, as in most programs, and noted.
//! - COLORCORR is such a factor of each colour, 1 in the mean: undone, so that lights have their own colours again.
//! - PRIMARIES, and the format XYZE, are converted. Radiance's XYZ has white at equal energy.

mod header;
mod scanlines;

use super::error::InputError;
use super::limits::check_size;
use super::primaries::Primaries;
use glam::{DMat3, DVec3};
use header::{Header, Layout};
use scanlines::{Fault, Scanlines};
use std::path::Path;

/// What every such file begins with; a program's name follows.
pub(super) const MAGIC: &[u8] = b"#?";

/// Width, height and pixels of a Radiance file. What the header says beyond that goes to `notes`.
pub(super) fn decode(
    path: &Path,
    bytes: &[u8],
    max_memory: u64,
    notes: &mut Vec<String>,
) -> Result<(u32, u32, Vec<[f32; 3]>), InputError> {
    let header = Header::parse(path, bytes, notes)?;
    let layout = &header.layout;
    check_size(path, (layout.width, layout.height), 0, max_memory)?;
    let data = &bytes[header.length..];
    let (count, length) = layout.scanlines();
    // The shortest scanline is a pixel and a run; what repeats the run further is longer.
    if (data.len() as u64) < count * if length == 1 { 4 } else { 8 } {
        let found = data.len();
        return Err(cut_off(path, format!("{found} bytes cannot hold {count} scanlines of {length} pixels")));
    }
    let colour = Colour::new(&header, notes);
    let pixels = all_pixels(path, &header, data, &colour, notes)?;
    Ok((layout.width as u32, layout.height as u32, pixels))
}

fn all_pixels(
    path: &Path,
    header: &Header,
    data: &[u8],
    colour: &Colour,
    notes: &mut Vec<String>,
) -> Result<Vec<[f32; 3]>, InputError> {
    let layout = &header.layout;
    let (count, length) = layout.scanlines();
    let mut pixels = vec![[0.0f32; 3]; (layout.width * layout.height) as usize];
    let mut scanlines = Scanlines::new(data);
    let mut line = vec![[0u8; 4]; length as usize];
    for k in 0..count {
        scanlines.next(&mut line).map_err(|fault| match fault {
            Fault::CutOff => cut_off(path, format!("it ends in scanline {} of {count}", k + 1)),
            Fault::Damaged { at, what } => InputError::bad(
                path,
                format!(
                    "the HDR image is damaged at byte {}, in scanline {} of {count}: {what}; copy or export it again",
                    header.length + at,
                    k + 1
                ),
            ),
        })?;
        let (first, step) = layout.places(k);
        for (i, rgbe) in line.iter().enumerate() {
            pixels[(first + step * i as i64) as usize] = colour.of(*rgbe);
        }
    }
    let rest = scanlines.rest();
    if rest.iter().any(|byte| !byte.is_ascii_whitespace() && *byte != 0) {
        notes.push(format!("the file goes on for {} bytes after its last scanline; they are not read", rest.len()));
    }
    Ok(pixels)
}

fn cut_off(path: &Path, what: String) -> InputError {
    InputError::bad(path, format!("the file is cut off: {what}; copy or export it again"))
}

impl Layout {
    /// Index of a scanline's first pixel in the image, and the step to each next one.
    fn places(&self, scanline: u64) -> (i64, i64) {
        let (width, height) = (self.width as i64, self.height as i64);
        // Along x and y: where the first is, and the step of the index to the next.
        let x = if self.leftward { (width - 1, -1) } else { (0, 1) };
        let y = if self.upward { (height - 1, -width) } else { (0, width) };
        let ((across, across_step), (along, along_step)) = if self.columns { (x, y) } else { (y, x) };
        let start = |axis: i64, step: i64| if step.abs() == 1 { axis } else { axis * width };
        (start(across, across_step) + scanline as i64 * across_step + start(along, along_step), along_step)
    }
}

/// How stored components become radiance.
struct Colour {
    /// 2^(exponent − 136); 0 for exponent 0.
    units: [f32; 256],
    /// What takes colours to Rec. 709, where they are of other primaries.
    to_rec_709: Option<DMat3>,
}

impl Colour {
    fn new(header: &Header, notes: &mut Vec<String>) -> Colour {
        let units = std::array::from_fn(|e| if e == 0 { 0.0 } else { libm::ldexpf(1.0, e as i32 - 136) });
        let primaries = if header.xyz { Some(Primaries::XYZ) } else { header.primaries };
        if header.xyz && header.primaries.is_some() {
            notes.push("the header names PRIMARIES, which CIE XYZ has not; they are not used".to_owned());
        }
        let mut matrix = None;
        if let Some(primaries) = primaries.filter(|primaries| !primaries.is_rec_709()) {
            matrix = primaries.to_rec_709();
            notes.push(match matrix {
                Some(_) => format!("colours were converted to Rec. 709 from {}", primaries.name()),
                None => format!(
                    "the header's PRIMARIES, {}, span no colours; colours are taken as Rec. 709",
                    primaries.name()
                ),
            });
        }
        let correction = DVec3::from(header.correction);
        if correction != DVec3::ONE {
            let named =
                format!("a colour correction (COLORCORR) of {} {} {}", correction.x, correction.y, correction.z);
            if header.xyz {
                notes.push(format!("the header names {named}, which CIE XYZ has not; it is not used"));
            } else {
                notes.push(format!("{named} was undone"));
                let undone = DMat3::from_diagonal(correction.recip());
                matrix = Some(matrix.map_or(undone, |matrix| matrix * undone));
            }
        }
        Colour { units, to_rec_709: matrix }
    }

    fn of(&self, [r, g, b, e]: [u8; 4]) -> [f32; 3] {
        let rgb = [r, g, b].map(|mantissa| f32::from(mantissa) * self.units[usize::from(e)]);
        match self.to_rec_709 {
            None => rgb,
            Some(matrix) => (matrix * DVec3::from(rgb.map(f64::from))).as_vec3().to_array(),
        }
    }
}
