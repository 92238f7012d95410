//! The numbers in a texture, by mip, layer, face and texel.

use super::image::{Image, Texture};
use super::texel::{Layout, layout};

/// A texture and its payload.
#[derive(Clone, Copy, Debug)]
pub struct Texels<'a> {
    /// The texture.
    pub texture: Texture,
    /// How its texels are laid out.
    pub layout: Layout,
    payload: &'a [u8],
}

impl<'a> Texels<'a> {
    /// The texels of a payload; `None` when it is shorter than the texture.
    pub fn new(texture: Texture, payload: &'a [u8]) -> Option<Texels<'a>> {
        let bytes = texture.mip_range(texture.mips - 1).end;
        Some(Texels { texture, layout: layout(texture.vk_format)?, payload: payload.get(..bytes)? })
    }

    /// Texel (i, j) of an image, i to the right and j down. The components it does not have are 0.
    pub fn at(&self, image: &Image, i: u32, j: u32) -> [f64; 4] {
        self.layout.decode(self.bytes(image, i, j))
    }

    /// Its bytes.
    pub fn bytes(&self, image: &Image, i: u32, j: u32) -> &'a [u8] {
        let texel = (j as usize * image.width as usize + i as usize) * self.texture.texel_bytes();
        &self.payload[image.range.start + texel..][..self.texture.texel_bytes()]
    }
}
