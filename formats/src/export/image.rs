//! Where the images of a texture lie in its payload: by mip, then layer, then face (docs/FORMAT.md). Blocks of compressed textures lie
//! there as texels do.

use super::blocks::{self, Blocks};
use crate::container::Resource;
use crate::vk_format;
use std::ops::Range;

/// A texture whose format this version knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texture {
    /// `VkFormat` code.
    pub vk_format: u32,
    /// Width of mip 0 in texels.
    pub width: u32,
    /// Height of mip 0 in texels.
    pub height: u32,
    /// Array layers.
    pub layers: u32,
    /// 1, or 6 for a cube.
    pub faces: u32,
    /// Mip levels.
    pub mips: u32,
    texel_bytes: u32,
    /// Texels along an edge of what `texel_bytes` hold: more than one in blocks.
    edge: u32,
}

/// One image: a mip of a face of a layer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Mip.
    pub mip: u32,
    /// Layer.
    pub layer: u32,
    /// Face, in the order +X −X +Y −Y +Z −Z; 0 when there is one.
    pub face: u32,
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Its bytes in the payload, rows of texels or blocks tightly packed.
    pub range: Range<usize>,
}

impl Texture {
    /// The texture of a descriptor that was checked, as those of an opened pack are. `None` for other resources and
    /// for formats this version has no name for.
    pub fn of(resource: &Resource) -> Option<Texture> {
        match *resource {
            Resource::Texture { vk_format, width, height, layers, faces, mips } => {
                let texel_bytes = vk_format::texel_bytes(vk_format)?;
                Some(Texture { vk_format, width, height, layers, faces, mips, texel_bytes, edge: 1 })
            }
            Resource::Buffer { .. } | Resource::Parameters => None,
        }
    }

    /// A texture of one layer in blocks.
    pub fn in_blocks(blocks: Blocks, (width, height): (u32, u32), mips: u32) -> Texture {
        let (vk_format, texel_bytes) = (blocks.vk_format(), blocks.bytes());
        Texture { vk_format, width, height, layers: 1, faces: 1, mips, texel_bytes, edge: blocks::EDGE }
    }

    /// Bytes of a texel, or of a block.
    pub fn texel_bytes(&self) -> usize {
        self.texel_bytes as usize
    }

    /// Width and height of a mip in texels.
    pub fn size(&self, mip: u32) -> (u32, u32) {
        ((self.width >> mip).max(1), (self.height >> mip).max(1))
    }

    /// Bytes of all layers and faces of a mip.
    pub fn mip_bytes(&self, mip: u32) -> usize {
        self.image_bytes(mip) * self.layers as usize * self.faces as usize
    }

    fn image_bytes(&self, mip: u32) -> usize {
        let (width, height) = self.size(mip);
        width.div_ceil(self.edge) as usize * height.div_ceil(self.edge) as usize * self.texel_bytes()
    }

    /// Where a mip lies in the payload.
    pub fn mip_range(&self, mip: u32) -> Range<usize> {
        let start: usize = (0..mip).map(|finer| self.mip_bytes(finer)).sum();
        start..start + self.mip_bytes(mip)
    }

    /// One image.
    pub fn image(&self, mip: u32, layer: u32, face: u32) -> Image {
        let (width, height) = self.size(mip);
        let bytes = self.image_bytes(mip);
        let start = self.mip_range(mip).start + (layer * self.faces + face) as usize * bytes;
        Image { mip, layer, face, width, height, range: start..start + bytes }
    }

    /// Every image in the order of the payload.
    pub fn images(&self) -> impl Iterator<Item = Image> {
        let texture = *self;
        (0..texture.mips).flat_map(move |mip| {
            (0..texture.layers)
                .flat_map(move |layer| (0..texture.faces).map(move |face| texture.image(mip, layer, face)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_follow_each_other_and_fill_the_payload() {
        let resource =
            Resource::Texture { vk_format: vk_format::R16_SFLOAT, width: 4, height: 4, layers: 2, faces: 6, mips: 3 };
        let texture = Texture::of(&resource).unwrap();
        let mut end = 0;
        for image in texture.images() {
            assert_eq!(image.range.start, end);
            end = image.range.end;
        }
        assert_eq!(resource.byte_len(), Ok(Some(end as u64)));
        assert_eq!(texture.images().count(), 3 * 2 * 6);
    }
}
