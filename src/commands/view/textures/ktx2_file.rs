//! KTX2 files with the mips that they have: plain channels of 8 or 16 bits, as they are or under Zstandard.

use crate::gltf::fault::Fault;
use crate::input::Texels;
use ktx2::{Format, Reader, SupercompressionScheme};
use std::io::Read;

/// What to write instead of what is not read.
const ADVICE: &str = "write it as plain R, RG or RGBA in 8 or 16 bits";

/// An image with its mips, four channels a texel: green and blue of one channel are 0, blue of two is 0, alpha is 1.
#[derive(Clone, Debug)]
pub struct Mips {
    pub size: (u32, u32),
    /// Channels that the file has.
    pub channels: usize,
    /// One, where the file leaves the others to its reader.
    pub levels: Vec<Texels>,
}

/// Whether the bytes begin as KTX2.
pub fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(&ktx2::MAGIC)
}

/// The image in a file of at most `limit` bytes, decompressed.
///
/// # Errors
/// Bad, for damage; unsupported, for formats that are not read, and for what is no image; limit, for one that is too large.
pub fn read(bytes: &[u8], limit: u64) -> Result<Mips, Fault> {
    let reader =
        Reader::new(bytes).map_err(|error| Fault::bad(format!("its KTX2 is damaged: {error}; write it anew")))?;
    let header = reader.header();
    if header.pixel_height == 0 || header.pixel_depth > 0 || header.layer_count > 1 || header.face_count != 1 {
        let (depth, layers, faces) = (header.pixel_depth, header.layer_count, header.face_count);
        return Err(Fault::unsupported(format!(
            "its KTX2 is no image: {} × {} × {depth} texels, {layers} layers, {faces} faces; write one layer and one face",
            header.pixel_width, header.pixel_height
        )));
    }
    let zstd = match header.supercompression_scheme {
        None => false,
        Some(SupercompressionScheme::Zstandard) => true,
        Some(SupercompressionScheme::BasisLZ) => {
            return Err(Fault::unsupported(format!(
                "its KTX2 is compressed by Basis Universal, which is not read; {ADVICE}"
            )));
        }
        Some(other) => {
            return Err(Fault::unsupported(format!(
                "its KTX2 is compressed by {other:?}, which is not read; {ADVICE}"
            )));
        }
    };
    let (channels, channel_bytes) = match header.format {
        Some(Format::R8_UNORM | Format::R8_SRGB) => (1, 1),
        Some(Format::R8G8_UNORM | Format::R8G8_SRGB) => (2, 1),
        Some(Format::R8G8B8A8_UNORM | Format::R8G8B8A8_SRGB) => (4, 1),
        Some(Format::R16_UNORM) => (1, 2),
        Some(Format::R16G16_UNORM) => (2, 2),
        Some(Format::R16G16B16A16_UNORM) => (4, 2),
        Some(other) => {
            return Err(Fault::unsupported(format!("its KTX2 has the format {other:?}, which is not read; {ADVICE}")));
        }
        None => {
            let what = "its KTX2 has a format of Basis Universal (UASTC), which is not read";
            return Err(Fault::unsupported(format!("{what}; {ADVICE}")));
        }
    };
    let (width, height) = (header.pixel_width, header.pixel_height);
    let texel_bytes = (channels * channel_bytes) as u64;
    // Twice: as they are stored, and as four channels.
    let needed =
        u64::from(width).saturating_mul(u64::from(height)).saturating_mul(texel_bytes + 4 * channel_bytes as u64);
    if needed > limit {
        return Err(Fault::limit(format!(
            "its KTX2 of {width} × {height} texels needs {needed} bytes, the limit is {limit}; raise --max-memory or scale it down"
        )));
    }
    let mut levels = Vec::new();
    for (number, level) in reader.levels().enumerate() {
        let shifted = |side: u32| side.checked_shr(number as u32).unwrap_or(0).max(1);
        if number > 0 && (shifted(width), shifted(height)) == (1, 1) && number as u32 > width.max(height).ilog2() {
            return Err(Fault::bad(format!(
                "its KTX2 has more levels than an image of {width} × {height} texels; write it anew"
            )));
        }
        let expected = u64::from(shifted(width)) * u64::from(shifted(height)) * texel_bytes;
        let data = if zstd { decompressed(level.data, expected) } else { Some(level.data.to_vec()) };
        let data = data.filter(|data| data.len() as u64 == expected).ok_or_else(|| {
            Fault::bad(format!(
                "level {number} of its KTX2 is damaged: expected {expected} bytes of texels; write it anew"
            ))
        })?;
        levels.push(texels(&data, channels, channel_bytes));
    }
    Ok(Mips { size: (width, height), channels, levels })
}

/// Exactly `expected` bytes that are compressed, or none.
fn decompressed(bytes: &[u8], expected: u64) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    // One byte more tells that there are too many.
    zstd::Decoder::new(bytes).ok()?.take(expected + 1).read_to_end(&mut out).ok()?;
    Some(out)
}

fn texels(data: &[u8], channels: usize, channel_bytes: usize) -> Texels {
    if channel_bytes == 1 {
        let texel = |bytes: &[u8]| {
            let mut texel = [0, 0, 0, 255];
            texel[..channels].copy_from_slice(bytes);
            texel
        };
        return Texels::Bytes(data.chunks_exact(channels).map(texel).collect());
    }
    let texel = |bytes: &[u8]| {
        let mut texel = [0.0, 0.0, 0.0, 1.0];
        for (value, two) in texel.iter_mut().zip(bytes.chunks_exact(2)) {
            *value = f32::from(u16::from_le_bytes([two[0], two[1]])) / 65535.0;
        }
        texel
    };
    Texels::Floats(data.chunks_exact(2 * channels).map(texel).collect())
}
