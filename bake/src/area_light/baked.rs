//! A baked material: parameters, and textures as the bytes that the GPU reads; how a sampler with linear filtering reads them.

use crate::wrap::{filtered_texels, wrapped};
use glam::{IVec2, Vec2, Vec4};
use glint_formats::Wrap;
use glint_formats::area_light::{AreaLightParams, NormalStorage, TABLE_SIZE};
use glint_formats::container::full_mip_count;
use half::f16;

/// Texels along both edges of the LTC tables.
pub const SIZE: usize = TABLE_SIZE as usize;
/// Most mips of a map.
const MAX_MIPS: usize = 15;

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

/// Both tables as half floats.
#[derive(Clone, Debug, PartialEq)]
pub struct LtcTables {
    /// Entries a, c, b, d of M⁻¹; row j is a view cosine, column i a roughness.
    pub inverse: Vec<[u16; 4]>,
    /// Magnitude, Fresnel term, 0, clipped form factor over its unclipped one.
    pub terms: Vec<[u16; 4]>,
}

/// The tables of [`fit_tables`], as `cargo run --release -p glint-bake-core --example fit_ltc_tables` wrote them. They
/// depend on nothing that a user gives, so fitting them in every bake would only cost seconds; a test fits them anew.
static BUILT_IN: &[u8; 2 * 8 * SIZE * SIZE] = include_bytes!("ltc_tables.bin");

/// Mean, over the entries of the built-in tables but the column of roughness 0, of ∫ |LTC − GGX| / ∫ GGX; the generator
/// prints it and a test measures it anew.
pub const TABLE_MEAN_ERROR: f64 = 0.0754;

impl LtcTables {
    /// The tables that come with the program.
    pub fn built_in() -> LtcTables {
        let texel = |b: &[u8]| std::array::from_fn(|k| u16::from_le_bytes([b[2 * k], b[2 * k + 1]]));
        let (inverse, terms) = BUILT_IN.split_at(8 * SIZE * SIZE);
        LtcTables {
            inverse: inverse.chunks_exact(8).map(texel).collect(),
            terms: terms.chunks_exact(8).map(texel).collect(),
        }
    }

    /// Bytes of both tables, the inverse matrices first.
    pub fn to_bytes(&self) -> Vec<u8> {
        let both = self.inverse.as_flattened().iter().chain(self.terms.as_flattened());
        both.flat_map(|bits| bits.to_le_bytes()).collect()
    }
}

/// The LTC tables, decoded.
#[derive(Clone, Debug, PartialEq)]
pub struct Tables {
    /// Entries a, c, b, d of M⁻¹.
    pub inverse: Vec<Vec4>,
    /// Magnitude, Fresnel term, 0, clipped form factor.
    pub terms: Vec<Vec4>,
}

impl Tables {
    /// M⁻¹ (a, c, b, d) at texel coordinates, by linear filtering with clamp to edge.
    pub(super) fn inverse_at(&self, place: Vec2) -> Vec4 {
        table_lookup(&self.inverse, place.x, place.y)
    }

    /// The terms, read alike.
    pub(super) fn terms_at(&self, place: Vec2) -> Vec4 {
        table_lookup(&self.terms, place.x, place.y)
    }
}

/// The LTC tables as floats.
pub fn decode_tables(tables: &LtcTables) -> Tables {
    let decode = |texels: &[[u16; 4]]| -> Vec<Vec4> {
        texels.iter().map(|texel| Vec4::from_array(texel.map(|bits| f16::from_bits(bits).to_f32()))).collect()
    };
    Tables { inverse: decode(&tables.inverse), terms: decode(&tables.terms) }
}

/// A table at texel coordinates, as linear filtering with clamp to edge reads it.
fn table_lookup(table: &[Vec4], x: f32, y: f32) -> Vec4 {
    let last = (SIZE - 1) as f32;
    let (x, y) = (x.clamp(0.0, last), y.clamp(0.0, last));
    let (i, j) = ((x as usize).min(SIZE - 2), (y as usize).min(SIZE - 2));
    let (fx, fy) = (x - i as f32, y - j as f32);
    let at = j * SIZE + i;
    let low = table[at].lerp(table[at + 1], fx);
    let high = table[at + SIZE].lerp(table[at + SIZE + 1], fx);
    low.lerp(high, fy)
}

/// The textures of a material.
#[derive(Clone, Copy, Debug)]
pub struct Maps<'a> {
    width: u32,
    height: u32,
    mips: u32,
    wrap: Wrap,
    storage: NormalStorage,
    /// First texel of each mip.
    first: [usize; MAX_MIPS],
    normals: &'a [u8],
    roughness: &'a [u8],
}

impl<'a> Maps<'a> {
    /// The textures of a material that passed verification.
    pub fn new(material: &'a AreaLightMaterial) -> Maps<'a> {
        let params = &material.params;
        let mips = full_mip_count(params.width, params.height).min(MAX_MIPS as u32);
        let mut first = [0; MAX_MIPS];
        for mip in 1..mips {
            let (width, height) = ((params.width >> (mip - 1)).max(1), (params.height >> (mip - 1)).max(1));
            first[mip as usize] = first[mip as usize - 1] + width as usize * height as usize;
        }
        Maps {
            width: params.width,
            height: params.height,
            mips,
            wrap: params.wrap,
            storage: params.storage,
            first,
            normals: &material.normals,
            roughness: &material.roughness,
        }
    }

    /// Columns and rows of the first mip that is there, over those of a map of `width` × `height` texels.
    pub fn scale(&self, width: u32, height: u32) -> Vec2 {
        Vec2::new(self.width as f32 / width as f32, self.height as f32 / height as f32)
    }

    /// Whether there is roughness by direction.
    pub fn is_anisotropic(&self) -> bool {
        !self.roughness.is_empty()
    }

    /// Mean normal and code of the roughness at `position`, in texels of the map, and `level`, from 0 to the last mip.
    pub(super) fn normals(&self, position: Vec2, level: f32) -> Vec4 {
        trilinear(self, self.normals, level, position)
    }

    /// Codes of the roughness by direction, read alike.
    pub(super) fn roughness(&self, position: Vec2, level: f32) -> Vec4 {
        trilinear(self, self.roughness, level, position)
    }

    /// Width and height of the first mip, in texels.
    pub(super) fn size(&self) -> Vec2 {
        Vec2::new(self.width as f32, self.height as f32)
    }

    /// Number of mips.
    pub(super) fn mips(&self) -> u32 {
        self.mips
    }

    /// What lies beyond the edge of the map.
    pub(super) fn wrap(&self) -> Wrap {
        self.wrap
    }
}

/// Texel of a mip from the bytes of its texture.
fn texel(maps: &Maps<'_>, bytes: &[u8], mip: u32, i: i32, j: i32) -> Vec4 {
    let (width, height) = ((maps.width >> mip).max(1) as i32, (maps.height >> mip).max(1) as i32);
    let (i, j) = (wrapped(i, width, maps.wrap), wrapped(j, height, maps.wrap));
    let size = maps.storage.texel_bytes();
    let at = (maps.first[mip as usize] + j as usize * width as usize + i as usize) * size;
    Vec4::from_array(maps.storage.decode(&bytes[at..at + size]))
}

/// Bilinear look-up in one mip at `position` in texels of the map.
fn bilinear(maps: &Maps<'_>, bytes: &[u8], mip: u32, position: Vec2) -> Vec4 {
    let size = Vec2::new((maps.width >> mip).max(1) as f32, (maps.height >> mip).max(1) as f32);
    let (IVec2 { x: i, y: j }, f) = filtered_texels(position / Vec2::new(maps.width as f32, maps.height as f32) * size);
    let low = texel(maps, bytes, mip, i, j).lerp(texel(maps, bytes, mip, i.saturating_add(1), j), f.x);
    let j = j.saturating_add(1);
    let high = texel(maps, bytes, mip, i, j).lerp(texel(maps, bytes, mip, i.saturating_add(1), j), f.x);
    low.lerp(high, f.y)
}

/// Look-up between mips.
fn trilinear(maps: &Maps<'_>, bytes: &[u8], level: f32, position: Vec2) -> Vec4 {
    let low = (level as u32).min(maps.mips - 1);
    let high = (low + 1).min(maps.mips - 1);
    let near = bilinear(maps, bytes, low, position);
    near.lerp(bilinear(maps, bytes, high, position), level - low as f32)
}
