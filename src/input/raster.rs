//! PNG, JPEG, TGA and WebP through the image crate: limits and tags first, then the pixels; TIFF has a file of its own.

use std::io::Cursor;
use std::path::Path;

use image::{
    ColorType, DynamicImage, ExtendedColorType, GrayImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits,
    RgbImage,
};

use super::chunks::{self, Jpeg};
use super::colour_tag::ColourTag;
use super::error::InputError;
use super::limits::check_size;
use super::options::InputOptions;
use super::orientation::Orientation;
use super::pixels::{Pixels, Stored, Values, unorm8};
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

/// Bytes of decoded pixels that one byte of file can stand for: deflate reaches 1032, LZW 2730, TGA runs 128. A file
/// that promises more is cut off, and need not be allocated for.
pub(super) const MAX_EXPANSION: u64 = 4096;

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
    notes.extend(what_else(bytes, format).map(str::to_owned));
    let stored = Stored {
        bits: bits(bytes, format, decoder.original_color_type()),
        lossy: lossy(bytes, format),
        tag: tag(bytes, format, &mut decoder),
        orientation: orientation(bytes, format, &mut decoder),
    };

    let strict = match format {
        ImageFormat::Jpeg => strict_jpeg(path, bytes, colour, (width, height))?,
        _ => None,
    };
    let image = match strict {
        Some(image) => image,
        None => DynamicImage::from_decoder(decoder).map_err(|e| from_image(path, e))?,
    };
    let values = match values(path, image)? {
        // The fourth byte of such a texel is padding.
        Values::Rgba8(v) if format == ImageFormat::Tga && !tga_has_alpha(bytes) => {
            Values::Rgb8(v.into_iter().map(|[r, g, b, _]| [r, g, b]).collect())
        }
        values => values,
    };
    Ok(Pixels { width, height, values, stored })
}

/// Damage that the decoders would word badly or let pass, and kinds that they would misread.
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
    if format == ImageFormat::Jpeg { check_jpeg(path, bytes) } else { Ok(()) }
}

fn check_jpeg(path: &Path, bytes: &[u8]) -> Result<(), InputError> {
    let jpeg = Jpeg::of(bytes);
    let kind = match jpeg.frame.map(|frame| (frame.kind, frame.bits, frame.channels)) {
        Some((0xf7, _, _)) => "a JPEG-LS".to_owned(),
        Some((0xc3 | 0xc7 | 0xcb | 0xcf, _, _)) => "a lossless JPEG".to_owned(),
        Some((0xc9..=0xcf, _, _)) => "a JPEG with arithmetic coding".to_owned(),
        Some((0xc5..=0xc7, _, _)) => "a hierarchical JPEG".to_owned(),
        Some((_, bits, _)) if bits != 8 => format!("a JPEG of {bits} bits a channel"),
        Some((_, _, 4)) => "a CMYK or YCCK JPEG".to_owned(),
        _ => String::new(),
    };
    if !kind.is_empty() {
        return Err(InputError::unsupported(
            path,
            format!("the file is {kind}, which is not read; expected 8 bits, grey or RGB: export it as PNG"),
        ));
    }
    if jpeg.has_end { Ok(()) } else { Err(cut_off(path)) }
}

/// The pixels of a JPEG; None where strict mode minds what belongs to no pixel, such as bytes between headers. By itself the decoder
/// fills what it cannot read with grey or black, and says nothing; in its strict mode it names the first such place.
fn strict_jpeg(
    path: &Path,
    bytes: &[u8],
    colour: ColorType,
    (width, height): (u32, u32),
) -> Result<Option<DynamicImage>, InputError> {
    let space = if colour == ColorType::L8 { ColorSpace::Luma } else { ColorSpace::RGB };
    let strict = DecoderOptions::default().set_strict_mode(true).jpeg_set_out_colorspace(space);
    match JpegDecoder::new_with_options(ZCursor::new(bytes), strict).decode() {
        Ok(pixels) if colour == ColorType::L8 => {
            Ok(GrayImage::from_raw(width, height, pixels).map(DynamicImage::ImageLuma8))
        }
        Ok(pixels) => Ok(RgbImage::from_raw(width, height, pixels).map(DynamicImage::ImageRgb8)),
        Err(error) if error.to_string().contains("[strict-mode]") => Ok(None),
        Err(error) => {
            let error = format!("{error:?}");
            let what = error.trim_matches('"').split_whitespace().collect::<Vec<_>>().join(" ");
            Err(InputError::bad(path, format!("the image is damaged: {what}; copy or export it again")))
        }
    }
}

fn check_not_cut_off(path: &Path, bytes: &[u8], format: ImageFormat, decoded: u64) -> Result<(), InputError> {
    // JPEG and WebP can say "all the same" in next to no bytes.
    let bounded = matches!(format, ImageFormat::Png | ImageFormat::Tga);
    if bounded && decoded / MAX_EXPANSION > bytes.len() as u64 {
        return Err(cut_off(path));
    }
    Ok(())
}

pub(super) fn cut_off(path: &Path) -> InputError {
    InputError::bad(path, "the file is cut off: it ends before the image does; copy or export it again")
}

/// What there is to be said of the file besides its pixels.
fn what_else(bytes: &[u8], format: ImageFormat) -> impl Iterator<Item = &'static str> {
    // Colour type 3 of the IHDR chunk.
    let palette = format == ImageFormat::Png && bytes.get(25) == Some(&3);
    let animated = match format {
        ImageFormat::Png => chunks::png(bytes).any(|(kind, _)| &kind == b"acTL"),
        ImageFormat::WebP => chunks::webp(bytes).any(|(kind, _)| &kind == b"ANMF"),
        _ => false,
    };
    let palette = palette.then_some("a palette image: at most 256 different normals");
    let animated = animated.then_some("an animation; its first picture is read");
    palette.into_iter().chain(animated)
}

/// The codec that lost precision.
fn lossy(bytes: &[u8], format: ImageFormat) -> Option<&'static str> {
    // A frame of an animation holds chunks of its own after 16 bytes.
    let in_frame = |content: &[u8]| content.get(16..).is_some_and(|frame| frame.windows(4).any(|w| w == b"VP8 "));
    let is_vp8 = |(kind, content): ([u8; 4], &[u8])| &kind == b"VP8 " || (&kind == b"ANMF" && in_frame(content));
    match format {
        ImageFormat::Jpeg => Some("JPEG"),
        ImageFormat::WebP if chunks::webp(bytes).any(is_vp8) => Some("lossy WebP"),
        _ => None,
    }
}

/// What EXIF says of the rows and columns.
fn orientation(bytes: &[u8], format: ImageFormat, decoder: &mut impl ImageDecoder) -> Orientation {
    // In PNG it may come after the pixels, where the decoder has not been yet.
    let exif = match format {
        ImageFormat::Png => chunks::png(bytes).find(|(kind, _)| kind == b"eXIf").map(|(_, content)| content.to_vec()),
        // EXIF that cannot be read says nothing.
        _ => decoder.exif_metadata().ok().flatten(),
    };
    let exif = exif.unwrap_or_default();
    // Some writers leave JPEG's introduction in.
    let exif = exif.strip_prefix(b"Exif\0\0").unwrap_or(&exif);
    let tag = image::metadata::Orientation::from_exif_chunk(exif).map(|orientation| orientation.to_exif());
    Orientation::of_tag(tag.unwrap_or(1).into())
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
fn bits(bytes: &[u8], format: ImageFormat, stored: ExtendedColorType) -> Option<u8> {
    match (format, stored) {
        (_, ExtendedColorType::Rgb32F | ExtendedColorType::Rgba32F) => None,
        // The decoder widens grey of 1, 2 and 4 bits to 8, without a word. Palettes hold 8 bits whatever their indices have.
        (ImageFormat::Png, _) => bytes.get(24).map(|&depth| if bytes.get(25) == Some(&3) { 8 } else { depth }),
        (_, ExtendedColorType::Rgb5x1) => Some(5),
        _ => Some((stored.bits_per_pixel() / u16::from(stored.channel_count())) as u8),
    }
}

/// Whether the fourth channel of a TGA is alpha: the header has bits for it, and the extension area, where there is one, does
/// not call them undefined.
fn tga_has_alpha(bytes: &[u8]) -> bool {
    const FOOTER: usize = 26;
    /// Where the kind of alpha is in the extension area.
    const KIND: usize = 494;
    if bytes.get(17).is_none_or(|descriptor| descriptor & 0x0f == 0) {
        return false;
    }
    let kind = || {
        let footer = bytes.get(bytes.len().checked_sub(FOOTER)?..)?;
        let area = u32::from_le_bytes(*footer.first_chunk()?) as usize;
        let known = footer.ends_with(b"TRUEVISION-XFILE.\0") && area != 0;
        known.then(|| bytes.get(area.checked_add(KIND)?).copied()).flatten()
    };
    kind().is_none_or(|kind| kind >= 3)
}

/// Channels, as floats where they are none of the usual 8 bits.
fn values(path: &Path, image: DynamicImage) -> Result<Values, InputError> {
    let unorm16 = |v: u16| v as f32 / 65535.0;
    let texels = image.width() as usize * image.height() as usize;
    Ok(match image {
        DynamicImage::ImageLuma8(i) => Values::Grey(i.pixels().map(|p| unorm8(p[0])).collect()),
        DynamicImage::ImageLumaA8(i) => Values::GreyAlpha(i.pixels().map(|p| p.0.map(unorm8)).collect()),
        DynamicImage::ImageLuma16(i) => Values::Grey(i.pixels().map(|p| unorm16(p[0])).collect()),
        DynamicImage::ImageLumaA16(i) => Values::GreyAlpha(i.pixels().map(|p| p.0.map(unorm16)).collect()),
        DynamicImage::ImageRgb8(i) => Values::Rgb8(i.as_raw().as_chunks().0[..texels].to_vec()),
        DynamicImage::ImageRgba8(i) => Values::Rgba8(i.as_raw().as_chunks().0[..texels].to_vec()),
        DynamicImage::ImageRgb16(i) => Values::Rgb(i.pixels().map(|p| p.0.map(unorm16)).collect()),
        DynamicImage::ImageRgba16(i) => Values::Rgba(i.pixels().map(|p| p.0.map(unorm16)).collect()),
        other => {
            return Err(InputError::unsupported(
                path,
                format!("pixels of type {:?} are not read; expected 8 or 16 bits, grey or RGB", other.color()),
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
