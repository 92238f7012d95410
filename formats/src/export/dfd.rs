//! The basic data format descriptor that a KTX2 file has for its format (Khronos Data Format 1.3, chapter 5).
//!
//! Linear colours with BT.709 primaries, as Khronos's own tools write for the same `VkFormat`. Integers that are not
//! normalised have an upper value of 1, floats reach from −1 (0 without sign) to 1: that says what 1.0 is stored as.

use super::blocks::{self, Blocks};
use super::texel::{Encoding, Layout};

const MODEL_RGBSDA: u8 = 1;
const MODEL_BC4: u8 = 131;
const MODEL_BC5: u8 = 132;
const MODEL_BC7: u8 = 134;
const PRIMARIES_BT709: u8 = 1;
const TRANSFER_LINEAR: u8 = 1;
const ALPHA: u8 = 15;
const EXPONENT: u8 = 0x20;
const SIGNED: u8 = 0x40;
const FLOAT: u8 = 0x80;
/// Exponent bias and largest exponent of E5B9G9R9.
const SHARED_EXPONENT: (u32, u32) = (15, 31);
/// The mantissa that is 1.0 at the bias, as the specification's example of this format gives it.
const SHARED_UPPER: u32 = 8448;

/// Some bits of a texel.
struct Sample {
    bit_offset: u16,
    bits: u8,
    /// Channel and qualifiers.
    channel: u8,
    lower: u32,
    upper: u32,
}

/// The whole DFD section: its length, then one basic descriptor block.
pub fn descriptor(layout: &Layout, texel_bytes: u8) -> Vec<u8> {
    section(MODEL_RGBSDA, 1, texel_bytes, &samples(layout))
}

/// The DFD section of a format of blocks: each sample is all bits of a block that say a channel, or all channels.
pub fn of_blocks(blocks: Blocks) -> Vec<u8> {
    let (model, bits): (u8, &[(u16, u8)]) = match blocks {
        Blocks::Bc4 => (MODEL_BC4, &[(0, 64)]),
        Blocks::Bc5 => (MODEL_BC5, &[(0, 64), (64, 64)]),
        Blocks::Bc7 => (MODEL_BC7, &[(0, 128)]),
    };
    let sample = |(channel, &(bit_offset, bits)): (usize, &(u16, u8))| Sample {
        bit_offset,
        bits,
        channel: channel as u8,
        lower: 0,
        upper: u32::MAX,
    };
    let samples: Vec<Sample> = bits.iter().enumerate().map(sample).collect();
    section(model, blocks::EDGE as u8, blocks.bytes() as u8, &samples)
}

/// A section of one descriptor, for texels or blocks of `edge`² texels.
fn section(model: u8, edge: u8, texel_bytes: u8, samples: &[Sample]) -> Vec<u8> {
    let block = 24 + 16 * samples.len();
    let mut out = Vec::new();
    out.extend((block as u32 + 4).to_le_bytes());
    // Vendor Khronos, type basic.
    out.extend(0u32.to_le_bytes());
    out.extend(2u16.to_le_bytes());
    out.extend((block as u16).to_le_bytes());
    // No flags: alpha is straight.
    out.extend([model, PRIMARIES_BT709, TRANSFER_LINEAR, 0, edge - 1, edge - 1, 0, 0]);
    out.extend([texel_bytes, 0, 0, 0, 0, 0, 0, 0]);
    for sample in samples {
        out.extend(sample.bit_offset.to_le_bytes());
        out.extend([sample.bits - 1, sample.channel, 0, 0, 0, 0]);
        out.extend(sample.lower.to_le_bytes());
        out.extend(sample.upper.to_le_bytes());
    }
    out
}

fn samples(layout: &Layout) -> Vec<Sample> {
    let one = 1.0f32.to_bits();
    match layout.encoding {
        Encoding::Packed11 => [(0, 11), (11, 11), (22, 10)]
            .into_iter()
            .enumerate()
            .map(|(k, (bit_offset, bits))| Sample { bit_offset, bits, channel: k as u8 | FLOAT, lower: 0, upper: one })
            .collect(),
        Encoding::SharedExponent => (0..3u8)
            .flat_map(|k| {
                let (lower, upper) = SHARED_EXPONENT;
                [
                    Sample { bit_offset: 9 * u16::from(k), bits: 9, channel: k, lower: 0, upper: SHARED_UPPER },
                    Sample { bit_offset: 27, bits: 5, channel: k | EXPONENT, lower, upper },
                ]
            })
            .collect(),
        Encoding::Unorm | Encoding::Snorm | Encoding::Uint | Encoding::Sfloat => {
            let top = u32::MAX >> (32 - layout.bits);
            let (qualifiers, lower, upper) = match layout.encoding {
                Encoding::Unorm => (0, 0, top),
                Encoding::Snorm => (SIGNED, (top >> 1).wrapping_neg(), top >> 1),
                Encoding::Sfloat => (SIGNED | FLOAT, (-1.0f32).to_bits(), one),
                _ => (0, 0, 1),
            };
            (0..layout.components)
                .map(|k| Sample {
                    bit_offset: (k as u32 * layout.bits) as u16,
                    bits: layout.bits as u8,
                    channel: if k == 3 { ALPHA } else { k as u8 } | qualifiers,
                    lower,
                    upper,
                })
                .collect()
        }
    }
}
