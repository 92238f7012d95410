//! What the bytes of a texel mean: the numbers in it, as a GPU would read them.

use crate::vk_format::*;

/// How the components of a texel are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Unsigned integers that stand for 0 to 1.
    Unorm,
    /// Signed integers that stand for −1 to 1.
    Snorm,
    /// Unsigned integers as they are.
    Uint,
    /// Half or single floats.
    Sfloat,
    /// Floats without sign of 11, 11 and 10 bits: five of exponent each.
    Packed11,
    /// Three mantissas of 9 bits that share an exponent of 5.
    SharedExponent,
}

/// How a texel is laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Components: the first ones of R, G, B, A.
    pub components: usize,
    /// Bits of a component; of the mantissa with a shared exponent, of the first one where they differ.
    pub bits: u32,
    /// How components are stored.
    pub encoding: Encoding,
}

/// Layout of a format; `None` for a format packs of this version do not use.
pub fn layout(vk_format: u32) -> Option<Layout> {
    use Encoding::{Packed11, Sfloat, SharedExponent, Snorm, Uint, Unorm};
    let (components, bits, encoding) = match vk_format {
        R8_UNORM => (1, 8, Unorm),
        R8_SNORM => (1, 8, Snorm),
        R8_UINT => (1, 8, Uint),
        R8G8_UNORM => (2, 8, Unorm),
        R8G8_SNORM => (2, 8, Snorm),
        R8G8B8A8_UNORM => (4, 8, Unorm),
        R8G8B8A8_SNORM => (4, 8, Snorm),
        R8G8B8A8_UINT => (4, 8, Uint),
        R16_UNORM => (1, 16, Unorm),
        R16_SNORM => (1, 16, Snorm),
        R16_UINT => (1, 16, Uint),
        R16_SFLOAT => (1, 16, Sfloat),
        R16G16_UNORM => (2, 16, Unorm),
        R16G16_SNORM => (2, 16, Snorm),
        R16G16_UINT => (2, 16, Uint),
        R16G16_SFLOAT => (2, 16, Sfloat),
        R16G16B16A16_UNORM => (4, 16, Unorm),
        R16G16B16A16_SNORM => (4, 16, Snorm),
        R16G16B16A16_UINT => (4, 16, Uint),
        R16G16B16A16_SFLOAT => (4, 16, Sfloat),
        R32_UINT => (1, 32, Uint),
        R32_SFLOAT => (1, 32, Sfloat),
        R32G32_UINT => (2, 32, Uint),
        R32G32_SFLOAT => (2, 32, Sfloat),
        R32G32B32A32_UINT => (4, 32, Uint),
        R32G32B32A32_SFLOAT => (4, 32, Sfloat),
        B10G11R11_UFLOAT_PACK32 => (3, 11, Packed11),
        E5B9G9R9_UFLOAT_PACK32 => (3, 9, SharedExponent),
        _ => return None,
    };
    Some(Layout { components, bits, encoding })
}

impl Layout {
    /// The components of a texel; those it does not have are 0. No two texels of different bytes decode alike, but for
    /// NaN, the zeros, and shared exponents: the lowest SNORM is not raised to −1, as a GPU does.
    pub fn decode(&self, texel: &[u8]) -> [f64; 4] {
        let mut out = [0.0; 4];
        match self.encoding {
            Encoding::Packed11 => {
                let word = little_endian(texel);
                out[..3].copy_from_slice(&[
                    ufloat(word & 0x7ff, 6),
                    ufloat(word >> 11 & 0x7ff, 6),
                    ufloat(word >> 22, 5),
                ]);
            }
            Encoding::SharedExponent => {
                let word = little_endian(texel);
                let scale = power_of_two((word >> 27) as i32 - 24);
                for (k, value) in out.iter_mut().take(3).enumerate() {
                    *value = f64::from(word >> (9 * k) & 0x1ff) * scale;
                }
            }
            _ => {
                let bytes = self.bits as usize / 8;
                for (value, component) in out.iter_mut().zip(texel.chunks_exact(bytes)) {
                    *value = self.component(little_endian(component));
                }
            }
        }
        out
    }

    /// One component of whole bytes.
    fn component(&self, raw: u32) -> f64 {
        match self.encoding {
            Encoding::Unorm => f64::from(raw) / f64::from(u32::MAX >> (32 - self.bits)),
            Encoding::Snorm => {
                let unused = 32 - self.bits;
                f64::from((raw << unused) as i32 >> unused) / f64::from(i32::MAX >> unused)
            }
            Encoding::Sfloat if self.bits == 16 => half::f16::from_bits(raw as u16).to_f64(),
            Encoding::Sfloat => f64::from(f32::from_bits(raw)),
            Encoding::Uint | Encoding::Packed11 | Encoding::SharedExponent => f64::from(raw),
        }
    }
}

/// Up to four bytes as a number.
fn little_endian(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte))
}

/// A float without sign: five bits of exponent above `mantissa_bits`. It is a half float with a shorter mantissa.
fn ufloat(raw: u32, mantissa_bits: u32) -> f64 {
    half::f16::from_bits((raw << (10 - mantissa_bits)) as u16).to_f64()
}

/// 2^exponent, exactly, for the exponents of a shared one.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vk_format;

    #[test]
    fn every_format_has_a_layout_of_its_size() {
        for code in 0..1000 {
            let Some(bytes) = vk_format::texel_bytes(code) else {
                assert_eq!(layout(code), None);
                continue;
            };
            let layout = layout(code).unwrap_or_else(|| panic!("VkFormat {code} has no layout"));
            if !matches!(layout.encoding, Encoding::Packed11 | Encoding::SharedExponent) {
                assert_eq!(layout.components as u32 * layout.bits, 8 * bytes, "VkFormat {code}");
            }
        }
    }

    #[test]
    fn texels_decode_to_what_the_formats_say() {
        let decode = |code, bytes: &[u8]| layout(code).unwrap().decode(bytes);
        assert_eq!(decode(R8G8B8A8_UNORM, &[0, 255, 51, 102]), [0.0, 1.0, 0.2, 0.4]);
        assert_eq!(decode(R8G8_SNORM, &[127, 0x81])[..2], [1.0, -1.0]);
        assert_eq!(decode(R16_UINT, &[0x34, 0x12])[0], 4660.0);
        assert_eq!(decode(R16_SFLOAT, &[0x00, 0x3c])[0], 1.0);
        assert_eq!(decode(R32_SFLOAT, &(-2.5f32).to_le_bytes())[0], -2.5);
        // One in 11, 11 and 10 bits: exponent 15 (the bias), mantissa 0.
        let one = (15u32 << 6) | (15 << 6) << 11 | (15 << 5) << 22;
        assert_eq!(decode(B10G11R11_UFLOAT_PACK32, &one.to_le_bytes())[..3], [1.0, 1.0, 1.0]);
        // Mantissas 256, 128, 1 of 512 at exponent 16, which stands for 2^1.
        let shared = 256u32 | 128 << 9 | 1 << 18 | 16 << 27;
        assert_eq!(decode(E5B9G9R9_UFLOAT_PACK32, &shared.to_le_bytes())[..3], [1.0, 0.5, 1.0 / 256.0]);
    }
}
