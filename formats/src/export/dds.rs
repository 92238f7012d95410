//! A texture as a DDS file with the DX10 header (Microsoft's DDS programming guide). Here a layer's face comes with all
//! its mips before the next, so the images of a pack are put in another order.

use super::blocks::Blocks;
use super::image::Texture;
use crate::vk_format::*;

const FLAGS: u32 = 0x1 | 0x2 | 0x4 | 0x1000; // caps, height, width, pixel format
const FLAG_PITCH: u32 = 0x8;
/// In place of the pitch: bytes of the largest mip in blocks.
const FLAG_LINEAR_SIZE: u32 = 0x8_0000;
const FLAG_MIPS: u32 = 0x2_0000;
const FOUR_CC: u32 = 0x4;
const CAPS_TEXTURE: u32 = 0x1000;
const CAPS_COMPLEX: u32 = 0x8;
const CAPS_MIPS: u32 = 0x40_0000;
const CAPS2_CUBE_ALL_FACES: u32 = 0x200 | 0xfc00;
const DIMENSION_2D: u32 = 3;
const MISC_CUBE: u32 = 0x4;

/// `DXGI_FORMAT` with the same bytes; every format of packs and every one of [`Blocks`] has one.
pub fn dxgi_format(vk_format: u32) -> Option<u32> {
    Some(match vk_format {
        R32G32B32A32_SFLOAT => 2,
        R32G32B32A32_UINT => 3,
        R16G16B16A16_SFLOAT => 10,
        R16G16B16A16_UNORM => 11,
        R16G16B16A16_UINT => 12,
        R16G16B16A16_SNORM => 13,
        R32G32_SFLOAT => 16,
        R32G32_UINT => 17,
        B10G11R11_UFLOAT_PACK32 => 26,
        R8G8B8A8_UNORM => 28,
        R8G8B8A8_UINT => 30,
        R8G8B8A8_SNORM => 31,
        R16G16_SFLOAT => 34,
        R16G16_UNORM => 35,
        R16G16_UINT => 36,
        R16G16_SNORM => 37,
        R32_SFLOAT => 41,
        R32_UINT => 42,
        R8G8_UNORM => 49,
        R8G8_SNORM => 51,
        R16_SFLOAT => 54,
        R16_UNORM => 56,
        R16_UINT => 57,
        R16_SNORM => 58,
        R8_UNORM => 61,
        R8_UINT => 62,
        R8_SNORM => 63,
        E5B9G9R9_UFLOAT_PACK32 => 67,
        _ => return Blocks::of(vk_format).map(Blocks::dxgi_format),
    })
}

/// Bytes of a DDS file with this texture. `None` for a format that neither packs nor [`Blocks`] have.
pub fn write(texture: &Texture, payload: &[u8]) -> Option<Vec<u8>> {
    let dxgi = dxgi_format(texture.vk_format)?;
    let many_mips = texture.mips > 1;
    let cube = texture.faces == 6;
    let complex = many_mips || cube || texture.layers > 1;
    let mut out = Vec::with_capacity(148 + payload.len());
    let mut words = |values: &[u32]| values.iter().for_each(|value| out.extend(value.to_le_bytes()));
    let (flag, length) = match Blocks::of(texture.vk_format) {
        Some(_) => (FLAG_LINEAR_SIZE, texture.image(0, 0, 0).range.len() as u32),
        None => (FLAG_PITCH, texture.width * texture.texel_bytes() as u32),
    };
    words(&[u32::from_le_bytes(*b"DDS "), 124, FLAGS | flag | if many_mips { FLAG_MIPS } else { 0 }]);
    words(&[texture.height, texture.width, length, 0, texture.mips]);
    words(&[0; 11]);
    words(&[32, FOUR_CC, u32::from_le_bytes(*b"DX10"), 0, 0, 0, 0, 0]);
    let caps = CAPS_TEXTURE | if complex { CAPS_COMPLEX } else { 0 } | if many_mips { CAPS_MIPS } else { 0 };
    words(&[caps, if cube { CAPS2_CUBE_ALL_FACES } else { 0 }, 0, 0, 0]);
    words(&[dxgi, DIMENSION_2D, if cube { MISC_CUBE } else { 0 }, texture.layers, 0]);
    for layer in 0..texture.layers {
        for face in 0..texture.faces {
            for mip in 0..texture.mips {
                out.extend(&payload[texture.image(mip, layer, face).range]);
            }
        }
    }
    Some(out)
}
