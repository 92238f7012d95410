//! What a GPU makes of a section: a texture, a buffer, or nothing (parameters). Lengths follow from the descriptor.

use crate::vk_format;
use serde::Serialize;

/// What a section holds, in the terms of a graphics API.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Resource {
    /// Texels: mip 0 first; within a mip layer by layer, within a layer face by face, rows tightly packed.
    Texture {
        /// `VkFormat` code, see [`crate::vk_format`].
        vk_format: u32,
        /// Width of mip 0 in texels.
        width: u32,
        /// Height of mip 0 in texels.
        height: u32,
        /// Array layers, at least 1.
        layers: u32,
        /// 1, or 6 for a cube in the order +X −X +Y −Y +Z −Z.
        faces: u32,
        /// Mip levels, at least 1.
        mips: u32,
    },
    /// Records of equal size.
    Buffer {
        /// Bytes of a record.
        stride: u32,
        /// Number of records.
        count: u64,
    },
    /// A bincode value, see [`crate::params`].
    Parameters,
}

impl Resource {
    /// Bytes of a payload of this resource; `None` where the descriptor does not say (parameters, or a texture
    /// format this version has no name for). `Err` says why the descriptor is impossible.
    pub fn byte_len(&self) -> Result<Option<u64>, String> {
        match *self {
            Resource::Texture { vk_format, width, height, layers, faces, mips } => {
                check_texture(width, height, layers, faces, mips)?;
                match vk_format::texel_bytes(vk_format) {
                    None => Ok(None),
                    Some(texel) => texture_bytes(texel, width, height, layers, faces, mips)
                        .map(Some)
                        .ok_or_else(|| String::from("the texture would be larger than 2^64 bytes")),
                }
            }
            Resource::Buffer { stride: 0, .. } => Err(String::from("a buffer stride is at least 1, found 0")),
            Resource::Buffer { stride, count } => u64::from(stride)
                .checked_mul(count)
                .map(Some)
                .ok_or_else(|| format!("{count} records of {stride} bytes would be larger than 2^64 bytes")),
            Resource::Parameters => Ok(None),
        }
    }
}

/// Levels of a full mip chain: the last has one texel.
pub fn full_mip_count(width: u32, height: u32) -> u32 {
    u32::BITS - width.max(height).leading_zeros()
}

fn check_texture(width: u32, height: u32, layers: u32, faces: u32, mips: u32) -> Result<(), String> {
    if width == 0 || height == 0 || layers == 0 {
        return Err(format!("width, height and layers are at least 1, found {width} × {height}, {layers} layers"));
    }
    if faces != 1 && faces != 6 {
        return Err(format!("a texture has 1 or 6 faces, found {faces}"));
    }
    if faces == 6 && width != height {
        return Err(format!("faces of a cube are square, found {width} × {height}"));
    }
    let full = full_mip_count(width, height);
    if mips == 0 || mips > full {
        return Err(format!("{width} × {height} texels have 1 to {full} mips, found {mips}"));
    }
    Ok(())
}

fn texture_bytes(texel: u32, width: u32, height: u32, layers: u32, faces: u32, mips: u32) -> Option<u64> {
    let mut texels_of_a_face = 0u64;
    for mip in 0..mips {
        let level = u64::from((width >> mip).max(1)).checked_mul(u64::from((height >> mip).max(1)))?;
        texels_of_a_face = texels_of_a_face.checked_add(level)?;
    }
    texels_of_a_face.checked_mul(u64::from(layers))?.checked_mul(u64::from(faces))?.checked_mul(u64::from(texel))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(width: u32, height: u32, layers: u32, faces: u32, mips: u32) -> Resource {
        Resource::Texture { vk_format: vk_format::R8G8B8A8_UNORM, width, height, layers, faces, mips }
    }

    #[test]
    fn lengths_follow_from_descriptors() {
        assert_eq!(texture(4, 2, 1, 1, 3).byte_len(), Ok(Some(4 * (8 + 2 + 1))));
        assert_eq!(texture(2, 2, 3, 6, 2).byte_len(), Ok(Some(4 * 5 * 3 * 6)));
        assert_eq!(Resource::Buffer { stride: 32, count: 3 }.byte_len(), Ok(Some(96)));
        assert_eq!(Resource::Parameters.byte_len(), Ok(None));
    }

    #[test]
    fn impossible_descriptors_are_refused() {
        assert!(texture(0, 1, 1, 1, 1).byte_len().is_err());
        assert!(texture(1, 1, 0, 1, 1).byte_len().is_err());
        assert!(texture(1, 1, 1, 2, 1).byte_len().is_err());
        assert!(texture(2, 1, 1, 6, 1).byte_len().is_err());
        assert!(texture(4, 4, 1, 1, 4).byte_len().is_err());
        assert!(texture(u32::MAX, u32::MAX, u32::MAX, 1, 1).byte_len().is_err());
        assert!(Resource::Buffer { stride: 0, count: 1 }.byte_len().is_err());
        assert!(Resource::Buffer { stride: 2, count: u64::MAX }.byte_len().is_err());
    }

    #[test]
    fn a_full_chain_ends_with_one_texel() {
        assert_eq!(full_mip_count(1, 1), 1);
        assert_eq!(full_mip_count(5, 3), 3);
        assert_eq!(full_mip_count(8, 1), 4);
    }
}
