//! How far two payloads of the same descriptor are apart.

use glint_formats::Resource;
use glint_formats::export::{Texels, Texture};
use serde::Serialize;

/// Two textures.
#[derive(Debug, PartialEq, Serialize)]
pub struct TexelDifference {
    /// Texels of all mips, layers and faces.
    pub texels: u64,
    /// Texels whose bytes differ.
    pub differing: u64,
    /// Components of which one is NaN or infinite and the other is something else; they are in neither number below.
    pub not_finite: u64,
    /// Largest difference of a component.
    pub max: f64,
    /// Mean difference over all components.
    pub mean: f64,
    /// Where the largest is: mip, layer, face, column, row, component.
    pub max_at: [u32; 6],
}

impl TexelDifference {
    /// Compares two payloads; `None` when they are no textures of a known format.
    pub fn of(resource: &Resource, a: &[u8], b: &[u8]) -> Option<TexelDifference> {
        let texture = Texture::of(resource)?;
        let (a, b) = (Texels::new(texture, a)?, Texels::new(texture, b)?);
        let components = a.layout.components;
        let mut out = TexelDifference { texels: 0, differing: 0, not_finite: 0, max: 0.0, mean: 0.0, max_at: [0; 6] };
        let mut sum = 0.0;
        for image in texture.images() {
            for (j, i) in (0..image.height).flat_map(|j| (0..image.width).map(move |i| (j, i))) {
                out.texels += 1;
                if a.bytes(&image, i, j) == b.bytes(&image, i, j) {
                    continue;
                }
                out.differing += 1;
                let values = a.at(&image, i, j).into_iter().zip(b.at(&image, i, j));
                for (component, (a, b)) in values.take(components).enumerate() {
                    let difference = (a - b).abs();
                    if !difference.is_finite() {
                        out.not_finite += u64::from(a.to_bits() != b.to_bits());
                        continue;
                    }
                    sum += difference;
                    if difference > out.max {
                        out.max = difference;
                        out.max_at = [image.mip, image.layer, image.face, i, j, component as u32];
                    }
                }
            }
        }
        out.mean = sum / (out.texels * components as u64) as f64;
        Some(out)
    }
}

/// Two buffers.
#[derive(Debug, PartialEq, Serialize)]
pub struct RecordDifference {
    /// Records.
    pub records: u64,
    /// Records that differ.
    pub differing: u64,
    /// The first that does.
    pub first: u64,
}

impl RecordDifference {
    /// Compares two payloads that differ; `None` when they are no buffers.
    pub fn of(resource: &Resource, a: &[u8], b: &[u8]) -> Option<RecordDifference> {
        let Resource::Buffer { stride, count } = *resource else { return None };
        let pairs = a.chunks(stride as usize).zip(b.chunks(stride as usize));
        let differing: Vec<u64> = (0u64..).zip(pairs).filter(|(_, (a, b))| a != b).map(|(at, _)| at).collect();
        Some(RecordDifference { records: count, differing: differing.len() as u64, first: *differing.first()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glint_formats::vk_format;

    #[test]
    fn the_largest_difference_is_found_where_it_is() {
        let resource = Resource::Texture {
            vk_format: vk_format::R16G16_SFLOAT,
            width: 2,
            height: 2,
            layers: 1,
            faces: 6,
            mips: 2,
        };
        let halves = |values: &[f32]| -> Vec<u8> {
            values.iter().flat_map(|&value| half::f16::from_f32(value).to_le_bytes()).collect()
        };
        let a = vec![1.0; 60];
        let mut b = a.clone();
        b[9] = 1.25; // mip 0, face 1, texel (0, 0), green
        b[48 + 7] = 0.5; // mip 1, face 3, green
        b[0] = f32::NAN;
        let found = TexelDifference::of(&resource, &halves(&a), &halves(&b)).unwrap();
        let expected = TexelDifference {
            texels: 30,
            differing: 3,
            not_finite: 1,
            max: 0.5,
            mean: 0.75 / 60.0,
            max_at: [1, 0, 3, 0, 0, 1],
        };
        assert_eq!(found, expected);
    }

    #[test]
    fn records_are_counted_from_the_first_that_differs() {
        let resource = Resource::Buffer { stride: 2, count: 4 };
        let found = RecordDifference::of(&resource, &[0; 8], &[0, 0, 0, 1, 0, 0, 2, 2]).unwrap();
        assert_eq!(found, RecordDifference { records: 4, differing: 2, first: 1 });
    }
}
