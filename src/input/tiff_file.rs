//! TIFF through the tiff crate, strip by strip or tile by tile: grey and RGB of whole numbers and floats of any width, in planes
//! or not, big-endian and BigTIFF too. What would have to be guessed (palettes, CMYK, Lab, signed numbers) is refused by name.

use std::io::Cursor;
use std::path::Path;

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::{CompressionMethod, PhotometricInterpretation as Photometric, Tag};
use tiff::{ColorType, TiffError};

use super::chunks::Jpeg;
use super::colour_tag::ColourTag;
use super::error::InputError;
use super::limits::check_size;
use super::options::InputOptions;
use super::orientation::Orientation;
use super::pixels::{Pixels, Stored, Values};
use super::raster::{MAX_EXPANSION, cut_off};

type Reader<'a> = Decoder<Cursor<&'a [u8]>>;

/// Planar configuration: channels one after the other.
const PLANAR: u64 = 2;
/// Sample format: floats.
const FLOAT: u64 = 3;
/// Extra sample: alpha, by which the colours are multiplied.
const ASSOCIATED_ALPHA: u64 = 1;

/// Decodes the first picture of a file.
pub(super) fn decode(
    path: &Path,
    bytes: &[u8],
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<Pixels, InputError> {
    let mut reader = Decoder::new(Cursor::new(bytes)).map_err(|e| from_tiff(path, e))?;
    let layout = Layout::of(&mut reader).map_err(|e| from_tiff(path, e))?;
    let (width, height) = layout.size;
    check_size(path, (width.into(), height.into()), 0, u64::MAX)?;
    layout.check(path)?;
    let (across, down) = reader.chunk_dimensions();
    // Strips may claim more rows than there are; tiles are decoded whole.
    let largest = u64::from(across) * u64::from(if layout.tiled { down } else { down.min(height) });
    let texel = u64::from(layout.samples) * u64::from(layout.bits).div_ceil(8);
    let held = largest.div_ceil(u64::from(width) * u64::from(height)).saturating_mul(texel).min(u32::MAX.into());
    check_size(path, (width.into(), height.into()), held, options.max_memory)?;
    let runs = [CompressionMethod::None, CompressionMethod::LZW, CompressionMethod::PackBits];
    let deflate = [CompressionMethod::Deflate, CompressionMethod::OldDeflate];
    let bounded = runs.contains(&layout.compression) || deflate.contains(&layout.compression);
    let decoded = u64::from(width) * u64::from(height) * texel;
    if bounded && decoded / MAX_EXPANSION > bytes.len() as u64 {
        return Err(cut_off(path));
    }
    let mut limits = Limits::default();
    limits.decoding_buffer_size = usize::try_from(options.max_memory).unwrap_or(usize::MAX);
    limits.intermediate_buffer_size = limits.decoding_buffer_size;
    let mut reader = reader.with_limits(limits);

    if layout.compression == CompressionMethod::ModernJPEG {
        layout.check_jpegs(path, bytes, &mut reader)?;
    }
    let values = layout.values(&mut reader, notes).map_err(|e| from_tiff(path, e))?;
    if reader.more_images() {
        notes.push("the file holds further pictures (pages, layers or smaller copies); the first one is read".into());
    }
    let stored = Stored {
        bits: (layout.format != FLOAT).then_some(layout.bits),
        lossy: layout.lossy(bytes),
        tag: reader.get_tag_u8_vec(Tag::IccProfile).map_or(ColourTag::default(), |p| ColourTag::of_profile(&p)),
        orientation: layout.orientation,
    };
    Ok(Pixels { width, height, values, stored })
}

/// What the tags say of the first picture.
struct Layout {
    size: (u32, u32),
    colour: Result<ColorType, TiffError>,
    photometric: Photometric,
    compression: CompressionMethod,
    samples: u16,
    bits: u8,
    format: u64,
    planar: bool,
    tiled: bool,
    predictor: u64,
    fill_order: u64,
    /// What the channels beyond those of the colour are.
    extra: Vec<u64>,
    orientation: Orientation,
}

impl Layout {
    fn of(reader: &mut Reader) -> Result<Layout, TiffError> {
        let mut first = |tag: Tag, default: u64| {
            Ok::<u64, TiffError>(
                reader.find_tag_unsigned_vec(tag)?.and_then(|all: Vec<u64>| all.first().copied()).unwrap_or(default),
            )
        };
        let small = |value: u64| u16::try_from(value).unwrap_or(u16::MAX);
        Ok(Layout {
            photometric: Photometric::from_u16(small(first(Tag::PhotometricInterpretation, 0)?))
                .unwrap_or(Photometric::TransparencyMask),
            compression: CompressionMethod::from_u16_exhaustive(small(first(Tag::Compression, 1)?)),
            samples: small(first(Tag::SamplesPerPixel, 1)?),
            bits: u8::try_from(first(Tag::BitsPerSample, 1)?).unwrap_or(u8::MAX),
            format: first(Tag::SampleFormat, 1)?,
            planar: first(Tag::PlanarConfiguration, 1)? == PLANAR,
            predictor: first(Tag::Predictor, 1)?,
            fill_order: first(Tag::FillOrder, 1)?,
            orientation: Orientation::of_tag(first(Tag::Orientation, 1)?),
            extra: reader.find_tag_unsigned_vec(Tag::ExtraSamples)?.unwrap_or_default(),
            size: reader.dimensions()?,
            colour: reader.colortype(),
            tiled: reader.get_chunk_type() == tiff::decoder::ChunkType::Tile,
        })
    }

    /// Refuses what is not read, by name.
    fn check(&self, path: &Path) -> Result<(), InputError> {
        let refuse = |what: String| {
            let advice = "expected grey or RGB of whole numbers without sign, or floats: export it as such";
            Err(InputError::unsupported(path, format!("the TIFF holds {what}, which is not read; {advice}")))
        };
        let kind = match self.photometric {
            Photometric::RGBPalette => "palette colours",
            Photometric::TransparencyMask => "a mask or an unknown kind of colour",
            Photometric::CMYK => "CMYK colours",
            Photometric::CIELab | Photometric::IccLab | Photometric::ItuLab => "Lab colours",
            Photometric::YCbCr if self.compression != CompressionMethod::ModernJPEG => {
                "YCbCr colours that are not a JPEG's"
            }
            _ => "",
        };
        if !kind.is_empty() {
            return refuse(kind.into());
        }
        match (self.format, self.bits) {
            (1, 1 | 2 | 4 | 8 | 16 | 32 | 64) | (FLOAT, 16 | 32 | 64) => {}
            (1, bits) => return refuse(format!("whole numbers of {bits} bits")),
            (2, _) => return refuse("whole numbers with a sign".into()),
            (FLOAT, bits) => return refuse(format!("floats of {bits} bits")),
            (other, _) => return refuse(format!("values of the format {other} (undefined or complex)")),
        }
        if self.fill_order != 1 {
            return refuse("bits in reverse order (tag 266)".into());
        }
        let read = match &self.colour {
            Ok(colour) => colour.num_samples(),
            Err(_) => return refuse(format!("{} channels as {:?}", self.samples, self.photometric)),
        };
        // The decoder adds up the differences of neighbours after it has left the others out.
        if !self.planar && self.samples > read && self.predictor != 1 {
            return refuse(format!("{} channels with a predictor", self.samples));
        }
        Ok(())
    }

    /// Looks that the JPEGs of the strips or tiles are as large as these: the decoder takes what they hold for it.
    fn check_jpegs(&self, path: &Path, bytes: &[u8], reader: &mut Reader) -> Result<(), InputError> {
        let (at, length) = match self.tiled {
            true => (Tag::TileOffsets, Tag::TileByteCounts),
            false => (Tag::StripOffsets, Tag::StripByteCounts),
        };
        let offsets = reader.get_tag_u64_vec(at).map_err(|e| from_tiff(path, e))?;
        let lengths = reader.get_tag_u64_vec(length).map_err(|e| from_tiff(path, e))?;
        let (across, down) = reader.chunk_dimensions();
        let channels = if self.planar { 1 } else { self.samples };
        for (k, (&at, &length)) in offsets.iter().zip(&lengths).enumerate() {
            let part = usize::try_from(at).ok().zip(usize::try_from(at.saturating_add(length)).ok());
            let Some(part) = part.and_then(|(from, to)| bytes.get(from..to)) else { return Err(cut_off(path)) };
            let Some(frame) = Jpeg::of(part).frame else { continue };
            let (wide, high) = (u32::from(frame.size.0), u32::from(frame.size.1));
            if wide != across || high > down || u16::from(frame.channels) != channels {
                return Err(InputError::bad(
                    path,
                    format!(
                        "the TIFF is damaged: part {k} holds a JPEG of {wide}×{high} texels and {} channels; expected {across} \
                         columns, at most {down} rows and {channels} channels: export it again",
                        frame.channels
                    ),
                ));
            }
        }
        Ok(())
    }

    /// The codec that lost precision.
    fn lossy(&self, bytes: &[u8]) -> Option<&'static str> {
        match self.compression {
            CompressionMethod::ModernJPEG => Some("JPEG"),
            // Strips hold whole WebP files; those of one TIFF are written alike.
            CompressionMethod::WebP if bytes.windows(8).any(|w| w == b"WEBPVP8 ") => Some("lossy WebP"),
            _ => None,
        }
    }

    fn values(&self, reader: &mut Reader, notes: &mut Vec<String>) -> Result<Values, TiffError> {
        if self.photometric == Photometric::WhiteIsZero {
            notes.push("the file says that its white is 0 (tag 262); its values are inverted".into());
        }
        let grey = matches!(self.photometric, Photometric::BlackIsZero | Photometric::WhiteIsZero);
        let alpha = matches!(self.extra.first(), Some(1 | 2)) || (self.extra.is_empty() && self.samples == 4);
        match self.samples {
            2 if self.photometric == Photometric::BlackIsZero => Ok(Values::GreyAlpha(self.channels::<2>(reader)?)),
            1 | 2 => Ok(Values::Grey(self.channels::<1>(reader)?.into_iter().map(|[v]| v).collect())),
            4.. if alpha && self.photometric == Photometric::RGB => {
                let mut values = self.channels::<4>(reader)?;
                if self.extra.first() == Some(&ASSOCIATED_ALPHA) && values.iter().any(|v| v[3] != 1.0) {
                    notes.push("the colours are multiplied by alpha (tag 338); they are divided by it".into());
                    values.iter_mut().filter(|v| v[3] > 0.0).for_each(|v| {
                        let [r, g, b, a] = *v;
                        *v = [r / a, g / a, b / a, a];
                    });
                }
                Ok(Values::Rgba(values))
            }
            _ => {
                if grey {
                    notes.push("the file calls its channels grey and extra ones; taken as red, green, blue".into());
                }
                if self.samples > 3 {
                    notes.push(format!("the file has {} channels; the first three are read", self.samples));
                }
                let mut values = self.channels::<3>(reader)?;
                if self.photometric == Photometric::YCbCr {
                    values.iter_mut().for_each(|v| *v = rgb_of_ycbcr(*v));
                }
                Ok(Values::Rgb(values))
            }
        }
    }

    /// The first `N` channels of all texels.
    fn channels<const N: usize>(&self, reader: &mut Reader) -> Result<Vec<[f32; N]>, TiffError> {
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let (across, down) = reader.chunk_dimensions();
        let columns = self.size.0.div_ceil(across);
        let a_plane = columns * self.size.1.div_ceil(down);
        let a_texel = if self.planar { 1 } else { reader.colortype()?.num_samples() as usize };
        // Rows are read as wide as they are stored: the LZW decoder may end early when it is asked for less than whole chunks.
        let mut samples =
            Samples { values: DecodingResult::U8(Vec::new()), bits: self.bits, a_row: across as usize * a_texel };
        let row_bytes = samples.row_bytes();
        let mut texels = vec![[0.0; N]; width * height];
        for chunk in 0..a_plane {
            let left = (chunk % columns) as usize * across as usize;
            let top = (chunk / columns) as usize * down as usize;
            // Chunks of later planes come with the rows that stick out of the picture.
            let wide = (across as usize).min(width - left);
            let high = (down as usize).min(height - top);
            for plane in 0..if self.planar { N } else { 1 } {
                reader.read_chunk_to_buffer(&mut samples.values, chunk + plane as u32 * a_plane, row_bytes)?;
                for (j, row) in texels.chunks_exact_mut(width).skip(top).take(high).enumerate() {
                    for (i, texel) in row[left..left + wide].iter_mut().enumerate() {
                        if self.planar {
                            texel[plane] = samples.at(j, i);
                        } else {
                            *texel = std::array::from_fn(|c| samples.at(j, i * a_texel + c));
                        }
                    }
                }
            }
        }
        Ok(texels)
    }
}

/// Samples of a chunk; rows of less than a byte each are padded to whole bytes.
struct Samples {
    values: DecodingResult,
    bits: u8,
    a_row: usize,
}

impl Samples {
    fn row_bytes(&self) -> usize {
        (self.a_row * usize::from(self.bits)).div_ceil(8)
    }

    /// The value of a sample of a row: whole numbers as 0…1, floats as they are.
    fn at(&self, row: usize, index: usize) -> f32 {
        let at = row * self.a_row + index;
        match &self.values {
            DecodingResult::U8(v) if self.bits < 8 => {
                let bits = usize::from(self.bits);
                let bit = index * bits;
                let byte = v[row * self.row_bytes() + bit / 8];
                let most = (1u8 << bits) - 1;
                f32::from(byte >> (8 - bits - bit % 8) & most) / f32::from(most)
            }
            DecodingResult::U8(v) => f32::from(v[at]) / 255.0,
            DecodingResult::U16(v) => f32::from(v[at]) / 65535.0,
            DecodingResult::U32(v) => (f64::from(v[at]) / f64::from(u32::MAX)) as f32,
            DecodingResult::U64(v) => (v[at] as f64 / u64::MAX as f64) as f32,
            DecodingResult::F16(v) => v[at].to_f32(),
            DecodingResult::F32(v) => v[at],
            DecodingResult::F64(v) => v[at] as f32,
            DecodingResult::I8(_) | DecodingResult::I16(_) | DecodingResult::I32(_) | DecodingResult::I64(_) => {
                unreachable!("numbers with a sign are refused before")
            }
        }
    }
}

/// Full-range YCbCr of ITU-R BT.601 as RGB, which is what a JPEG in a TIFF holds.
fn rgb_of_ycbcr([y, cb, cr]: [f32; 3]) -> [f32; 3] {
    let (cb, cr) = (cb - 128.0 / 255.0, cr - 128.0 / 255.0);
    [y + 1.402 * cr, y - 0.344_136_3 * cb - 0.714_136_3 * cr, y + 1.772 * cb].map(|v| v.clamp(0.0, 1.0))
}

fn from_tiff(path: &Path, error: TiffError) -> InputError {
    match error {
        TiffError::UnsupportedError(e) => {
            InputError::unsupported(path, format!("the TIFF is of a kind that is not read: {e}; export it plainly"))
        }
        TiffError::LimitsExceeded => InputError::limit(
            path,
            "the TIFF needs more memory than the limit, or its tables of strips are too long; raise --max-memory or \
             export it in larger strips",
        ),
        TiffError::IoError(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => cut_off(path),
        other => InputError::bad(path, format!("the TIFF is damaged: {other}; copy or export it again")),
    }
}
