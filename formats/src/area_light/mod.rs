//! Typed sections of multi-scale area lights: a mip chain of averaged normals with their meso roughness, and LTC tables.
//!
//! Method: Tao et al. 2021, with the tables of Heitz et al. 2016; what we store differs from the paper as
//! `docs/methods/area-light.md` says. The tables are the same in every pack and depend on nothing but GGX.

pub(crate) mod check;

use crate::binding::{Binding, View};
use crate::bytes::f16_at;
use crate::container::{FourCc, KnownKind, full_mip_count};
use crate::vk_format;
use crate::wrap::Wrap;
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Parameters of an area-light material: [`AreaLightParams`], bincode.
pub const PARAMS: FourCc = FourCc(*b"ALPP");
/// What a shader binds as uniforms: buffer of one [`AreaLightUniform`].
pub const UNIFORM: FourCc = FourCc(*b"ALUB");
/// Averaged normals: texture of the format of [`NormalStorage`], the full mip chain of the map.
///
/// x, y, z are the mean normal over the texel, +X right, +Y up, not renormalised: 1 less their length is how far the
/// normals there disagree. w is the code t / (1 + t), t = (α / 0.12)^1.4, of the meso roughness α under the texel's
/// footprint. To be read with linear filtering within and between mips, and decoded after.
pub const NORMALS: FourCc = FourCc(*b"ALNM");
/// Anisotropic meso roughness: texture of the same format and size; only where the parameters say so.
///
/// x, y, z are xx, xy, yy of a symmetric matrix whose eigenvalues are codes of α as in [`NORMALS`], in the frame that the
/// shortest turn from +Z to the mean normal takes +X and +Y to; w is 0.
pub const ROUGHNESS: FourCc = FourCc(*b"ALRO");
/// M⁻¹ of the LTC fits: texture of [`TABLE_VK_FORMAT`], [`TABLE_SIZE`]², one mip. See `docs/FORMAT.md`.
pub const INVERSE: FourCc = FourCc(*b"ALLI");
/// Magnitude, Fresnel term, 0 and clipped form factor: texture like [`INVERSE`].
pub const TERMS: FourCc = FourCc(*b"ALLT");

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] = &[
    KnownKind::first(PARAMS, "area light parameters"),
    KnownKind::first(UNIFORM, "area light uniforms"),
    KnownKind::first(NORMALS, "area light normals"),
    KnownKind::first(ROUGHNESS, "area light roughness"),
    KnownKind::first(INVERSE, "LTC inverse matrices"),
    KnownKind::first(TERMS, "LTC terms"),
];
/// How a material is bound. An isotropic one has no [`ROUGHNESS`].
pub const BINDINGS: &[Binding] = &[
    Binding::Uniform(UNIFORM),
    Binding::Texture(NORMALS, View::Float2d),
    Binding::Texture(ROUGHNESS, View::Float2d),
    Binding::Texture(INVERSE, View::Float2d),
    Binding::Texture(TERMS, View::Float2d),
    Binding::MapSampler,
    Binding::ClampSampler,
];
/// VkFormat of the LTC tables: R16G16B16A16_SFLOAT.
pub const TABLE_VK_FORMAT: u32 = vk_format::R16G16B16A16_SFLOAT;
/// Width and height of the LTC tables.
pub const TABLE_SIZE: u32 = 64;
/// Largest width or height of the first mip: what every WebGPU device offers.
pub const MAX_TEXTURE_SIZE: u32 = 8192;

/// What a shader binds as uniforms: `GlintAreaLightMaps` of `area_light::eval`, 32 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct AreaLightUniform {
    /// Width and height of the first mip, in texels.
    pub size: [f32; 2],
    /// Number of mips.
    pub mips: u32,
    /// What lies beyond the edge: 0 repeats, 1 clamps.
    pub wrap: u32,
    /// 1 where there is roughness by direction, else 0.
    pub anisotropic: u32,
    /// 0.
    pub unused_0: u32,
    /// 0.
    pub unused_1: u32,
    /// 0.
    pub unused_2: u32,
}

/// How normals and roughness are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NormalStorage {
    /// R16G16B16A16_SFLOAT, 8 bytes a texel.
    F16,
    /// R8G8B8A8_SNORM, 4 bytes a texel.
    Snorm8,
}

impl NormalStorage {
    /// VkFormat of the textures.
    pub fn vk_format(self) -> u32 {
        match self {
            NormalStorage::F16 => vk_format::R16G16B16A16_SFLOAT,
            NormalStorage::Snorm8 => vk_format::R8G8B8A8_SNORM,
        }
    }

    /// Bytes of a texel.
    #[inline]
    pub fn texel_bytes(self) -> usize {
        match self {
            NormalStorage::F16 => 8,
            NormalStorage::Snorm8 => 4,
        }
    }

    /// A texel from its bytes, as a GPU decodes it.
    #[inline]
    pub fn decode(self, bytes: &[u8]) -> [f32; 4] {
        std::array::from_fn(|k| match self {
            NormalStorage::F16 => f16_at(bytes, 2 * k),
            NormalStorage::Snorm8 => (f32::from(bytes[k] as i8) / 127.0).max(-1.0),
        })
    }
}

/// Error as the bake measured it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredError {
    /// Largest angle, in radians, between a stored mean normal and the exact one, over all levels.
    pub normal_angle: f64,
    /// Largest difference of a stored meso roughness α to the exact one.
    pub roughness: f64,
    /// Mean, over the entries of the LTC tables, of ∫ |LTC − GGX| / ∫ GGX.
    pub table_mean: f64,
}

/// Parameters of an area-light material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AreaLightParams {
    /// Width of the map in texels.
    pub width: u32,
    /// Height of the map in texels.
    pub height: u32,
    /// What lies beyond the edge.
    pub wrap: Wrap,
    /// GGX roughness α of the surface itself that the material asks for, 0.001 to 1. It is a default: nothing in the
    /// textures depends on it.
    pub base_roughness: f32,
    /// How normals and roughness are stored.
    pub storage: NormalStorage,
    /// Whether there is a section [`ROUGHNESS`].
    pub anisotropic: bool,
    /// Error as the bake measured it.
    pub measured: MeasuredError,
}

impl AreaLightParams {
    /// The uniforms that go with these parameters.
    pub fn uniform(&self) -> AreaLightUniform {
        AreaLightUniform {
            size: [self.width as f32, self.height as f32],
            mips: full_mip_count(self.width, self.height),
            wrap: match self.wrap {
                Wrap::Repeat => 0,
                Wrap::Clamp => 1,
            },
            anisotropic: u32::from(self.anisotropic),
            unused_0: 0,
            unused_1: 0,
            unused_2: 0,
        }
    }
}
