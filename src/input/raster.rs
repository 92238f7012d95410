//! PNG, JPEG, TGA, TIFF and WebP through the image crate: limits and tags first, then the pixels.

use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use super::colour_tag::ColourTag;
use super::error::InputError;
use super::limits::check_size;
use super::options::InputOptions;
use super::pixels::{Pixels, Stored, Values};

/// Bytes of decoded pixels that one byte of file can stand for: deflate reaches 1032, LZW 2730, TGA runs 128. A file
/// that promises more is cut off, and need not be allocated for.
const MAX_EXPANSION: u64 = 4096;

/// Decodes a file whose content was found to be `format`.
pub(super) fn decode(
    path: &Path,
    bytes: &[u8],
    format: ImageFormat,
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<Pixels, InputError> {
    check_header(path, bytes, format)?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(options.max_memory);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(|e| from_image(path, e))?;

    let (width, height) = decoder.dimensions();
    let colour = decoder.color_type();
    check_size(path, (width as u64, height as u64), colour.bytes_per_pixel() as u64, options.max_memory)?;
    check_not_cut_off(path, bytes, format, decoder.total_bytes())?;
    // Colour type 3 of the IHDR chunk.
    if format == ImageFormat::Png && bytes.get(25) == Some(&3) {
        notes.push("a palette image: at most 256 different normals".into());
    }
    let stored = Stored {
        bits: bits(decoder.original_color_type()),
        lossy: (format == ImageFormat::Jpeg).then_some("JPEG"),
        tag: tag(bytes, format, &mut decoder),
    };

    let image = DynamicImage::from_decoder(decoder).map_err(|e| from_image(path, e))?;
    Ok(Pixels { width, height, values: values(path, image)?, stored })
}

/// Damage that the decoders would word badly or let pass.
fn check_header(path: &Path, bytes: &[u8], format: ImageFormat) -> Result<(), InputError> {
    let size = match format {
        // Width and height of the IHDR chunk, which must come first.
        ImageFormat::Png if bytes.len() >= 24 && &bytes[12..16] == b"IHDR" => {
            let word = |at: usize| u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]) as u64;
            Some((word(16), word(20)))
        }
        ImageFormat::Tga if bytes.len() >= 18 => {
            let word = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]) as u64;
            Some((word(12), word(14)))
        }
        _ => None,
    };
    if let Some(size) = size {
        // The memory is looked at again once the pixel type is known.
        check_size(path, size, 0, u64::MAX)?;
    }
    if format == ImageFormat::Jpeg && !jpeg_has_end(bytes) {
        return Err(cut_off(path));
    }
    Ok(())
}

/// Whether the end marker follows the first scan; the decoder would fill the missing rest with grey.
fn jpeg_has_end(bytes: &[u8]) -> bool {
    const SOS: u8 = 0xda;
    let mut at = 2;
    while at + 4 <= bytes.len() {
        if bytes[at] != 0xff {
            return true; // Not a marker: let the decoder say what is wrong.
        }
        if bytes[at + 1] == 0xff {
            at += 1; // Fill byte.
            continue;
        }
        let length = u16::from_be_bytes([bytes[at + 2], bytes[at + 3]]) as usize;
        if bytes[at + 1] == SOS {
            return bytes[at..].windows(2).any(|w| w == [0xff, 0xd9]);
        }
        at += 2 + length;
    }
    false
}

fn check_not_cut_off(path: &Path, bytes: &[u8], format: ImageFormat, decoded: u64) -> Result<(), InputError> {
    // JPEG and WebP can say "all the same" in next to no bytes.
    let bounded = matches!(format, ImageFormat::Png | ImageFormat::Tga | ImageFormat::Tiff);
    if bounded && decoded / MAX_EXPANSION > bytes.len() as u64 {
        return Err(cut_off(path));
    }
    Ok(())
}

fn cut_off(path: &Path) -> InputError {
    InputError::bad(path, "the file is cut off: it ends before the image does; copy or export it again")
}

/// What the file says of its colours.
fn tag(bytes: &[u8], format: ImageFormat, decoder: &mut impl ImageDecoder) -> ColourTag {
    if format == ImageFormat::Png {
        return ColourTag::of_png(bytes);
    }
    // A profile that cannot be taken out of its file is no claim.
    decoder.icc_profile().ok().flatten().map(|profile| ColourTag::of_profile(&profile)).unwrap_or_default()
}

/// Bits of a whole number; `None` for floats.
fn bits(stored: ExtendedColorType) -> Option<u8> {
    match stored {
        ExtendedColorType::Rgb32F | ExtendedColorType::Rgba32F => None,
        _ => Some((stored.bits_per_pixel() / u16::from(stored.channel_count())) as u8),
    }
}

/// Channels as floats.
fn values(path: &Path, image: DynamicImage) -> Result<Values, InputError> {
    let unorm8 = |v: u8| v as f32 / 255.0;
    let unorm16 = |v: u16| v as f32 / 65535.0;
    Ok(match image {
        DynamicImage::ImageLuma8(i) => Values::Grey(i.pixels().map(|p| unorm8(p[0])).collect()),
        DynamicImage::ImageLumaA8(i) => Values::GreyAlpha(i.pixels().map(|p| p.0.map(unorm8)).collect()),
        DynamicImage::ImageLuma16(i) => Values::Grey(i.pixels().map(|p| unorm16(p[0])).collect()),
        DynamicImage::ImageLumaA16(i) => Values::GreyAlpha(i.pixels().map(|p| p.0.map(unorm16)).collect()),
        DynamicImage::ImageRgb8(i) => Values::Rgb(i.pixels().map(|p| p.0.map(unorm8)).collect()),
        DynamicImage::ImageRgba8(i) => Values::Rgba(i.pixels().map(|p| p.0.map(unorm8)).collect()),
        DynamicImage::ImageRgb16(i) => Values::Rgb(i.pixels().map(|p| p.0.map(unorm16)).collect()),
        DynamicImage::ImageRgba16(i) => Values::Rgba(i.pixels().map(|p| p.0.map(unorm16)).collect()),
        DynamicImage::ImageRgb32F(i) => Values::Rgb(i.pixels().map(|p| p.0).collect()),
        DynamicImage::ImageRgba32F(i) => Values::Rgba(i.pixels().map(|p| p.0).collect()),
        other => {
            return Err(InputError::unsupported(
                path,
                format!("pixels of type {:?} are not read; expected 8 or 16 bits or float, grey or RGB", other.color()),
            ));
        }
    })
}

fn from_image(path: &Path, error: ImageError) -> InputError {
    match error {
        ImageError::Unsupported(e) => {
            InputError::unsupported(path, format!("{e}; export it as plain 8- or 16-bit RGB"))
        }
        ImageError::Limits(e) => InputError::limit(path, format!("{e}; raise --max-memory or scale the image down")),
        ImageError::IoError(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => cut_off(path),
        other => InputError::bad(path, format!("the image is damaged: {other}; copy or export it again")),
    }
}
