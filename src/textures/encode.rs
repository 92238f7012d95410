//! Levels of a texture as bytes, and bytes as files: KTX2, DDS and EXR with all levels, PNG one a level.

use crate::blocks;
use crate::exit::{Exit, Failure};
use crate::exr_file;
use clap::ValueEnum;
use glint_bake_core::textures::levels::sizes;
use glint_formats::export::blocks::Blocks;
use glint_formats::export::{Texture, dds, ktx2};
use glint_formats::{Resource, vk_format};
use half::f16;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use rayon::prelude::*;

/// Kinds of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Khronos Texture 2.0
    Ktx2,
    /// DirectDraw Surface with the DX10 header
    Dds,
    /// one PNG a mip
    Png,
    /// OpenEXR in half floats, one part a mip
    Exr,
}

impl Format {
    /// How names of files end.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Ktx2 => "ktx2",
            Format::Dds => "dds",
            Format::Png => "png",
            Format::Exr => "exr",
        }
    }

    /// Whether a file holds all mips.
    pub fn has_all_mips(self) -> bool {
        self != Format::Png
    }
}

/// How a texture is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    pub format: Format,
    /// 8 or 16 bits a channel; EXR has half floats.
    pub bits: u32,
    /// Whether the levels of KTX2 are compressed with Zstandard.
    pub zstd: bool,
    /// Whether KTX2 and DDS are compressed in blocks.
    pub blocks: bool,
}

/// A texture whose levels are known.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name without what says the format.
    pub name: String,
    /// Channels that hold something: 1 to 4.
    pub channels: usize,
    /// Whether the fourth is 1 everywhere, so that PNG leaves it out.
    pub opaque: bool,
    /// Size of level 0.
    pub size: (u32, u32),
}

impl Layout {
    /// Names of the files that a texture becomes.
    pub fn files(&self, plan: &Plan) -> Vec<String> {
        let name = &plan.name;
        match self.format {
            Format::Ktx2 => vec![format!("{name}.ktx2")],
            Format::Dds => vec![format!("{name}.dds")],
            Format::Exr => vec![format!("{name}.exr")],
            Format::Png => {
                (0..sizes(plan.size.0, plan.size.1).len()).map(|mip| format!("{name}.mip{mip}.png")).collect()
            }
        }
    }

    /// The files of a texture, in the order of their names. `value` gives texel k of a level, 0 to 1 each.
    ///
    /// # Errors
    /// Unsupported, for what the format cannot hold.
    pub fn encode(
        &self,
        plan: &Plan,
        value: &(dyn Fn(usize, usize) -> [f32; 4] + Sync),
    ) -> Result<Vec<Vec<u8>>, Failure> {
        if self.format == Format::Png {
            let levels = sizes(plan.size.0, plan.size.1);
            return Ok(levels.iter().enumerate().map(|(level, size)| self.png(plan, level, *size, value)).collect());
        }
        let texture = self.texture(plan);
        let channels = stored_channels(plan.channels);
        let mut payload = Vec::with_capacity(texture.mip_range(texture.mips - 1).end);
        for level in 0..texture.mips {
            let (width, height) = texture.size(level);
            if let Some(blocks) = self.blocks_of(channels) {
                let texel = |k| value(level as usize, k).map(in_8_bits);
                payload.extend(blocks::compress(blocks, (width, height), texel));
                continue;
            }
            payload.extend(self.texels(channels, (level as usize, width as usize * height as usize), value));
        }
        let unsupported = || Failure::new(Exit::Unexpected, "a format without a writer; please report this");
        let metadata = [("KTXwriter", concat!("glint-bake ", env!("CARGO_PKG_VERSION")))];
        let bytes = match self.format {
            Format::Ktx2 if self.zstd => ktx2::write_zstd(&texture, &payload, &metadata),
            Format::Ktx2 => ktx2::write(&texture, &payload, &metadata),
            Format::Dds => dds::write(&texture, &payload),
            _ => exr_file::write(&texture, &payload)?,
        };
        Ok(vec![bytes.ok_or_else(unsupported)?])
    }

    /// Bytes of all files together, roughly, and what encoding holds: one payload.
    pub fn payload_bytes(&self, plan: &Plan) -> u64 {
        let texture = self.texture(plan);
        texture.mip_range(texture.mips - 1).end as u64
    }

    /// The format of blocks for this many channels.
    fn blocks_of(&self, channels: usize) -> Option<Blocks> {
        self.blocks.then_some(match channels {
            1 => Blocks::Bc4,
            2 => Blocks::Bc5,
            _ => Blocks::Bc7,
        })
    }

    fn texture(&self, plan: &Plan) -> Texture {
        let (width, height) = plan.size;
        if let Some(blocks) = self.blocks_of(stored_channels(plan.channels)) {
            return Texture::in_blocks(blocks, plan.size, sizes(width, height).len() as u32);
        }
        let vk_format = match (self.format, self.bits, stored_channels(plan.channels)) {
            (Format::Exr, _, 1) => vk_format::R16_SFLOAT,
            (Format::Exr, _, 2) => vk_format::R16G16_SFLOAT,
            (Format::Exr, ..) => vk_format::R16G16B16A16_SFLOAT,
            (_, 8, 1) => vk_format::R8_UNORM,
            (_, 8, 2) => vk_format::R8G8_UNORM,
            (_, 8, _) => vk_format::R8G8B8A8_UNORM,
            (_, _, 1) => vk_format::R16_UNORM,
            (_, _, 2) => vk_format::R16G16_UNORM,
            _ => vk_format::R16G16B16A16_UNORM,
        };
        let mips = sizes(width, height).len() as u32;
        let resource = Resource::Texture { vk_format, width, height, layers: 1, faces: 1, mips };
        Texture::of(&resource).expect("a format of the table")
    }

    /// A level, row by row.
    fn texels(
        &self,
        channels: usize,
        (level, count): (usize, usize),
        value: &(dyn Fn(usize, usize) -> [f32; 4] + Sync),
    ) -> Vec<u8> {
        let channel_bytes = if self.format != Format::Exr && self.bits == 8 { 1 } else { 2 };
        let texel_bytes = channels * channel_bytes;
        let mut out = vec![0; count * texel_bytes];
        out.par_chunks_mut(texel_bytes * 4096).enumerate().for_each(|(chunk, bytes)| {
            for (k, texel) in bytes.chunks_exact_mut(texel_bytes).enumerate() {
                let values = value(level, chunk * 4096 + k);
                for (value, bytes) in values.iter().zip(texel.chunks_exact_mut(channel_bytes)) {
                    match (self.format, channel_bytes) {
                        (Format::Exr, _) => bytes.copy_from_slice(&f16::from_f32(*value).to_le_bytes()),
                        (_, 1) => bytes[0] = in_8_bits(*value),
                        (_, _) => {
                            bytes.copy_from_slice(&((value.clamp(0.0, 1.0) * 65535.0).round() as u16).to_le_bytes())
                        }
                    }
                }
            }
        });
        out
    }

    /// A level as a PNG.
    pub fn png(
        &self,
        plan: &Plan,
        level: usize,
        (width, height): (u32, u32),
        value: &(dyn Fn(usize, usize) -> [f32; 4] + Sync),
    ) -> Vec<u8> {
        // PNG has no images of two colours: blue is then 0.
        let channels = if plan.opaque { 3 } else { plan.channels.max(if plan.channels == 2 { 3 } else { 1 }) };
        let two = |level: usize, k: usize| {
            let [r, g, b, a] = value(level, k);
            [r, g, if plan.channels == 2 { 0.0 } else { b }, a]
        };
        let mut pixels = self.texels(channels, (level, width as usize * height as usize), &two);
        if self.bits == 16 && cfg!(target_endian = "big") {
            pixels.chunks_exact_mut(2).for_each(<[u8]>::reverse);
        }
        let colour = match (self.bits, channels) {
            (8, 1) => ExtendedColorType::L8,
            (8, 3) => ExtendedColorType::Rgb8,
            (8, _) => ExtendedColorType::Rgba8,
            (_, 1) => ExtendedColorType::L16,
            (_, 3) => ExtendedColorType::Rgb16,
            _ => ExtendedColorType::Rgba16,
        };
        let mut out = Vec::new();
        PngEncoder::new_with_quality(&mut out, CompressionType::Fast, FilterType::Adaptive)
            .write_image(&pixels, width, height, colour)
            .expect("a vector takes every byte of a picture of the right size");
        out
    }
}

fn in_8_bits(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// Channels as they are stored: GPUs have no textures of three.
fn stored_channels(channels: usize) -> usize {
    if channels == 3 { 4 } else { channels }
}
