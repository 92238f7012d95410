//! A texture as an OpenEXR file: one part an image, so that mips, layers and faces are all there and a reader that
//! knows only single images shows mip 0.
//!
//! No texel is lost: half and single floats keep their bits; packed floats and shared exponents fit half floats;
//! integers become 32-bit integers; normalised integers become the single floats they stand for, and rounding gives
//! the integers back.

use crate::exit::{Exit, Failure};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding as FileEncoding, FlatSamples, Image as ExrImage,
    ImageAttributes, IntegerBounds, Layer, LayerAttributes, LineOrder, Vec2, WritableImage,
};
use glint_formats::export::texel::{self, Encoding, Layout};
use glint_formats::export::{Image, Texture};
use half::f16;
use std::io::Cursor;

const FACES: [&str; 6] = ["+X", "-X", "+Y", "-Y", "+Z", "-Z"];
const CHANNELS: [&str; 4] = ["R", "G", "B", "A"];

/// Bytes of an OpenEXR file with this texture; `None` for a format packs do not use.
pub fn write(texture: &Texture, payload: &[u8]) -> Result<Option<Vec<u8>>, Failure> {
    let Some(layout) = texel::layout(texture.vk_format) else { return Ok(None) };
    let parts: Vec<Layer<AnyChannels<FlatSamples>>> =
        texture.images().map(|image| part(texture, &image, &layout, &payload[image.range.clone()])).collect();
    let window = IntegerBounds::from_dimensions(size_of_mip(texture.size(0)));
    let mut bytes = Vec::new();
    // One thread: the order of the chunks is then always the same.
    ExrImage::from_layers(ImageAttributes::new(window), parts)
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .map_err(|e| {
            Failure::new(Exit::Unsupported, format!("the EXR file cannot be made: {e}; give --to ktx2 or raw"))
        })?;
    Ok(Some(bytes))
}

fn size_of_mip((width, height): (u32, u32)) -> Vec2<usize> {
    Vec2(width as usize, height as usize)
}

fn part(texture: &Texture, image: &Image, layout: &Layout, bytes: &[u8]) -> Layer<AnyChannels<FlatSamples>> {
    let channels = (0..layout.components)
        .map(|k| {
            let texels = bytes.chunks_exact(texture.texel_bytes());
            AnyChannel::new(CHANNELS[k], samples(layout, texels, k))
        })
        .collect();
    let encoding =
        FileEncoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    Layer::new(
        size_of_mip((image.width, image.height)),
        LayerAttributes::named(part_name(texture, image).as_str()),
        encoding,
        AnyChannels::sort(channels),
    )
}

/// `mip0`, `mip0.layer2`, `mip1.layer0.+X`: what a texture has but one of is left out.
fn part_name(texture: &Texture, image: &Image) -> String {
    let mut name = format!("mip{}", image.mip);
    if texture.layers > 1 {
        name.push_str(&format!(".layer{}", image.layer));
    }
    if texture.faces == 6 {
        name.push_str(&format!(".{}", FACES[image.face as usize]));
    }
    name
}

/// Component `k` of every texel.
fn samples<'a>(layout: &Layout, texels: impl Iterator<Item = &'a [u8]>, k: usize) -> FlatSamples {
    let bytes = layout.bits as usize / 8;
    let raw = |texel: &[u8]| {
        texel[k * bytes..(k + 1) * bytes].iter().rev().fold(0, |word: u32, &byte| word << 8 | u32::from(byte))
    };
    match layout.encoding {
        Encoding::Uint => FlatSamples::U32(texels.map(raw).collect()),
        Encoding::Sfloat if layout.bits == 16 => {
            FlatSamples::F16(texels.map(|texel| f16::from_bits(raw(texel) as u16)).collect())
        }
        Encoding::Sfloat => FlatSamples::F32(texels.map(|texel| f32::from_bits(raw(texel))).collect()),
        Encoding::Unorm | Encoding::Snorm => {
            FlatSamples::F32(texels.map(|texel| layout.decode(texel)[k] as f32).collect())
        }
        Encoding::Packed11 | Encoding::SharedExponent => {
            FlatSamples::F16(texels.map(|texel| f16::from_f32(layout.decode(texel)[k] as f32)).collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{ReadChannels, ReadLayers, read};
    use glint_formats::{Resource, vk_format};

    /// The bits of a component that a sample stands for.
    fn bits(layout: &Layout, samples: &FlatSamples, at: usize) -> u32 {
        let top = f64::from(u32::MAX >> (32 - layout.bits));
        match (samples, layout.encoding) {
            (FlatSamples::U32(values), Encoding::Uint) => values[at],
            (FlatSamples::F16(values), Encoding::Sfloat) => u32::from(values[at].to_bits()),
            (FlatSamples::F32(values), Encoding::Sfloat) => values[at].to_bits(),
            (FlatSamples::F32(values), Encoding::Unorm) => (f64::from(values[at]) * top).round() as u32,
            (FlatSamples::F32(values), Encoding::Snorm) => {
                (f64::from(values[at]) * (top - 1.0) / 2.0).round() as i32 as u32
            }
            other => panic!("{other:?}"),
        }
    }

    /// Reads the file back into the payload's bytes.
    fn round_trip(texture: &Texture, payload: &[u8]) -> Vec<u8> {
        let file = write(texture, payload).unwrap().unwrap();
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_buffered(Cursor::new(file))
            .unwrap();
        let layout = texel::layout(texture.vk_format).unwrap();
        assert_eq!(image.layer_data.len(), texture.images().count());
        let mut out = Vec::new();
        for (part, image) in image.layer_data.iter().zip(texture.images()) {
            assert_eq!(part.attributes.layer_name.as_ref().unwrap().to_string(), part_name(texture, &image));
            assert_eq!(part.size, size_of_mip((image.width, image.height)));
            let channel =
                |k: usize| &part.channel_data.list.iter().find(|c| c.name.eq(CHANNELS[k])).unwrap().sample_data;
            for at in 0..image.width as usize * image.height as usize {
                for k in 0..layout.components {
                    let bits = bits(&layout, channel(k), at);
                    out.extend(&bits.to_le_bytes()[..layout.bits as usize / 8]);
                }
            }
        }
        out
    }

    fn texture(vk_format: u32, layers: u32, faces: u32) -> (Texture, usize) {
        let resource = Resource::Texture { vk_format, width: 4, height: 4, layers, faces, mips: 3 };
        (Texture::of(&resource).unwrap(), resource.byte_len().unwrap().unwrap() as usize)
    }

    /// Every half float, so NaN, infinities and the smallest numbers too, and every 8-bit and 16-bit integer.
    #[test]
    fn every_plain_format_comes_back_byte_for_byte() {
        for vk_format in (0..1000).filter(|&code| vk_format::texel_bytes(code).is_some()) {
            if [vk_format::B10G11R11_UFLOAT_PACK32, vk_format::E5B9G9R9_UFLOAT_PACK32].contains(&vk_format) {
                continue;
            }
            let resource = Resource::Texture { vk_format, width: 256, height: 256, layers: 1, faces: 1, mips: 1 };
            let all = Texture::of(&resource).unwrap();
            let payload: Vec<u8> = (0..=u16::MAX)
                .flat_map(|i| i.to_le_bytes().repeat(all.texel_bytes().div_ceil(2)))
                .collect::<Vec<u8>>()[..resource.byte_len().unwrap().unwrap() as usize]
                .to_vec();
            assert!(round_trip(&all, &payload) == payload, "VkFormat {vk_format}");
            let (texture, len) = texture(vk_format, 2, 6);
            let payload: Vec<u8> = (0..len).map(|i| (i * 7 + i / 256) as u8).collect();
            assert!(round_trip(&texture, &payload) == payload, "VkFormat {vk_format}");
        }
    }

    /// Packed texels: the halves in the file are the very numbers.
    #[test]
    fn packed_floats_and_shared_exponents_lose_nothing() {
        for vk_format in [vk_format::B10G11R11_UFLOAT_PACK32, vk_format::E5B9G9R9_UFLOAT_PACK32] {
            let layout = texel::layout(vk_format).unwrap();
            for i in 0..=u16::MAX {
                let texel = (u32::from(i).wrapping_mul(0x9e37_79b1)).to_le_bytes();
                let exact = layout.decode(&texel);
                for k in 0..3 {
                    let FlatSamples::F16(halves) = samples(&layout, [&texel[..]].into_iter(), k) else { panic!() };
                    assert!(halves[0].to_f64() == exact[k] || exact[k].is_nan() && halves[0].is_nan(), "{texel:?}");
                }
            }
        }
    }

    #[test]
    fn the_same_texture_gives_the_same_file() {
        let (texture, len) = texture(vk_format::R16G16B16A16_SFLOAT, 1, 6);
        let payload: Vec<u8> = (0..len).map(|i| i as u8).collect();
        assert_eq!(write(&texture, &payload).unwrap(), write(&texture, &payload).unwrap());
    }
}
