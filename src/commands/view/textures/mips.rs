//! Images with mips: their own, or means of the texels below, as engines make them.

use crate::input::Texels;
use crate::srgb::{decode, encode};
use glint_bake_core::textures::levels::{shares, sizes};
use glint_view::methods::textures::{ImageFormat, MipImage};
use half::f16;
use rayon::prelude::*;

/// An image whose mips are these. `srgb` says that colours are encoded.
pub fn as_they_are(size: (u32, u32), mips: &[Texels], srgb: bool) -> MipImage {
    let format = mips.first().map_or(ImageFormat::Linear8, |texels| format_of(texels, srgb));
    MipImage { format, size: size.into(), mips: mips.iter().map(|texels| stored(texels, srgb)).collect() }
}

/// An image whose first mip is this, and whose others are means of the one before, each rounded as it is stored. Colours that are
/// encoded (`srgb`) are averaged as light.
pub fn averaged(size: (u32, u32), texels: &Texels, srgb: bool) -> MipImage {
    let format = format_of(texels, srgb);
    let mut mips = vec![stored(texels, srgb)];
    let mut level: Vec<[f32; 4]> = Vec::new();
    for (below, pair) in sizes(size.0, size.1).windows(2).enumerate() {
        level = match below {
            // Not as floats: the finest is the largest.
            0 => reduced(|k| light(texels.texel(k), srgb), pair[0], pair[1]),
            _ => reduced(|k| level[k], pair[0], pair[1]),
        };
        mips.push(encoded(&level, format));
    }
    MipImage { format, size: size.into(), mips }
}

fn format_of(texels: &Texels, srgb: bool) -> ImageFormat {
    match (texels, srgb) {
        (Texels::Bytes(_), false) => ImageFormat::Linear8,
        (Texels::Bytes(_), true) => ImageFormat::Srgb8,
        (Texels::Floats(_), _) => ImageFormat::Half,
    }
}

/// Bytes of texels; half floats, which GPUs do not decode, hold light.
fn stored(texels: &Texels, srgb: bool) -> Vec<u8> {
    match texels {
        Texels::Bytes(texels) => texels.as_flattened().to_vec(),
        Texels::Floats(texels) => {
            let light: Vec<[f32; 4]> = texels.iter().map(|texel| light(*texel, srgb)).collect();
            encoded(&light, ImageFormat::Half)
        }
    }
}

fn encoded(level: &[[f32; 4]], format: ImageFormat) -> Vec<u8> {
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    match format {
        ImageFormat::Linear8 => level.iter().flat_map(|texel| texel.map(byte)).collect(),
        ImageFormat::Srgb8 => {
            level.iter().flat_map(|&[r, g, b, a]| [encode(r), encode(g), encode(b), a].map(byte)).collect()
        }
        ImageFormat::Half => {
            level.iter().flat_map(|texel| texel.map(|value| f16::from_f32(value).to_ne_bytes())).flatten().collect()
        }
    }
}

/// A level by the texels of the one before: texel i of w′ covers texels i w/w′ to (i + 1) w/w′ of w.
fn reduced(
    texel_at: impl Fn(usize) -> [f32; 4] + Sync,
    (width, height): (u32, u32),
    (to_width, to_height): (u32, u32),
) -> Vec<[f32; 4]> {
    let (columns, rows) = (shares(width, to_width), shares(height, to_height));
    let row_of = |(first, weights): &(u32, Vec<f32>)| -> Vec<[f32; 4]> {
        let mut out = vec![[0.0; 4]; to_width as usize];
        for (row, weight) in (*first..).zip(weights) {
            let start = row as usize * width as usize;
            for (texel, (first, shares)) in out.iter_mut().zip(&columns) {
                for (column, share) in (*first as usize..).zip(shares) {
                    let from = texel_at(start + column);
                    for c in 0..4 {
                        texel[c] += weight * share * from[c];
                    }
                }
            }
        }
        out
    };
    rows.par_iter().flat_map_iter(row_of).collect()
}

/// Light of a colour that may be encoded; alpha never is.
fn light([r, g, b, a]: [f32; 4], srgb: bool) -> [f32; 4] {
    if srgb { [decode(r), decode(g), decode(b), a] } else { [r, g, b, a] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_averaged_as_light_and_other_numbers_as_they_are() {
        let texels = Texels::Bytes(vec![[0, 0, 255, 0], [255, 255, 255, 255]]);
        let linear = averaged((2, 1), &texels, false);
        assert_eq!((linear.format, linear.mips[1].as_slice()), (ImageFormat::Linear8, &[128, 128, 255, 128][..]));
        let colour = averaged((2, 1), &texels, true);
        assert_eq!((colour.format, colour.mips[1].as_slice()), (ImageFormat::Srgb8, &[188, 188, 255, 128][..]));
        assert_eq!(colour.mips[0], [0, 0, 255, 0, 255, 255, 255, 255]);
    }

    #[test]
    fn sides_of_any_length_keep_their_mean() {
        let values: Vec<[f32; 4]> = (0..15).map(|k| [k as f32 / 14.0; 4]).collect();
        let image = averaged((5, 3), &Texels::Floats(values), false);
        let sizes: Vec<usize> = image.mips.iter().map(|mip| mip.len() / 8).collect();
        assert_eq!((image.format, sizes), (ImageFormat::Half, vec![15, 2, 1]));
        let last = f16::from_ne_bytes([image.mips[2][0], image.mips[2][1]]).to_f32();
        assert!((last - 0.5).abs() < 1e-3, "{last}");
    }
}
