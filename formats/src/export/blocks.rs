//! Formats of blocks of 4 × 4 texels, which GPUs read as they are. Packs hold none; files of textures may.

/// Width and height of a block in texels.
pub const EDGE: u32 = 4;

/// A format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blocks {
    /// One channel, two values of 8 bits and 3 bits a texel.
    Bc4,
    /// Two channels, each as in BC4.
    Bc5,
    /// Three or four channels, several modes.
    Bc7,
}

impl Blocks {
    /// All of them.
    pub const ALL: [Blocks; 3] = [Blocks::Bc4, Blocks::Bc5, Blocks::Bc7];

    /// Number of the `VkFormat` whose values are 0 to 1.
    pub fn vk_format(self) -> u32 {
        match self {
            Blocks::Bc4 => 139,
            Blocks::Bc5 => 141,
            Blocks::Bc7 => 145,
        }
    }

    /// Number of the same `DXGI_FORMAT`.
    pub fn dxgi_format(self) -> u32 {
        match self {
            Blocks::Bc4 => 80,
            Blocks::Bc5 => 83,
            Blocks::Bc7 => 98,
        }
    }

    /// Bytes of a block.
    pub fn bytes(self) -> u32 {
        if self == Blocks::Bc4 { 8 } else { 16 }
    }

    /// The format of a `VkFormat`; `None` for all others.
    pub fn of(vk_format: u32) -> Option<Blocks> {
        Blocks::ALL.into_iter().find(|blocks| blocks.vk_format() == vk_format)
    }
}
