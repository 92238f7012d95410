//! A baked material: parameters, and textures as the bytes that the GPU reads.

use super::eval::Tables;
use super::tables::LtcTables;
use glam::Vec4;
use glint_formats::area_light::{AreaLightParams, NormalStorage};
use half::f16;

/// A baked material.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaLightMaterial {
    /// Its parameters.
    pub params: AreaLightParams,
    /// Mean normals and roughness, mip after mip.
    pub normals: Vec<u8>,
    /// Roughness by direction, laid out alike; empty for an isotropic material.
    pub roughness: Vec<u8>,
    /// The LTC tables.
    pub tables: LtcTables,
}

/// Appends a texel; values from −1 to 1.
pub fn push_texel(storage: NormalStorage, texel: [f64; 4], out: &mut Vec<u8>) {
    for value in texel {
        match storage {
            NormalStorage::F16 => out.extend(f16::from_f32(value as f32).to_le_bytes()),
            NormalStorage::Snorm8 => out.push((value.clamp(-1.0, 1.0) * 127.0).round() as i8 as u8),
        }
    }
}

/// The LTC tables as floats.
pub fn decode_tables(tables: &LtcTables) -> Tables {
    let decode = |texels: &[[u16; 4]]| -> Vec<Vec4> {
        texels.iter().map(|texel| Vec4::from_array(texel.map(|bits| f16::from_bits(bits).to_f32()))).collect()
    };
    Tables { inverse: decode(&tables.inverse), terms: decode(&tables.terms) }
}
