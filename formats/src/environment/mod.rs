//! Typed sections of a prefiltered environment: parameters, radiance, indicators of radiance levels, their colours, and
//! the two view-dependent areas that scale them.
//!
//! Method: Kneiphof and Klein 2025, sections 3.4 and 5; what we store differs from the paper as
//! `docs/methods/environment.md` says.

pub(crate) mod check;

use crate::binding::{Binding, View};
use crate::container::{FourCc, KnownKind, Resource};
use crate::vk_format;
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Parameters of an environment: [`EnvironmentParams`], bincode.
pub const PARAMS: FourCc = FourCc(*b"ENPP");
/// What shaders bind of the parameters: buffer of one [`EnvironmentUniform`].
pub const UNIFORM: FourCc = FourCc(*b"ENUB");
/// Prefiltered radiance: cube texture of half floats, R G B over [`EnvironmentParams::radiance_scale`]; alpha is the root mean square
/// of the luminance under the same filter, on the same scale.
pub const RADIANCE: FourCc = FourCc(*b"ENRA");
/// Prefiltered indicators of levels 1, 2, …: cube texture of half floats, component c of layer l is level 4 l + c + 1. The darkest
/// level, level 0, is what is left of 1.
pub const INDICATORS: FourCc = FourCc(*b"ENIN");
/// Mean colour of levels 1, 2, … under the filter, each of luminance 1: cube texture, layer l is level l + 1.
pub const COLOURS: FourCc = FourCc(*b"ENCO");
/// Directional albedo and visible reflecting area: texture of [`ALBEDO_VK_FORMAT`], `albedo_size` texels square.
///
/// Column i is cos θ_o = (i + ½) / size, row j is roughness α = ((j + ½) / size)². R and G: albedo is F₀ R + G under
/// Schlick's Fresnel factor. B: visible reflecting area E_D. A: whole facet area D_H.
pub const ALBEDO: FourCc = FourCc(*b"ENAL");

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] = &[
    KnownKind::first(PARAMS, "environment parameters"),
    KnownKind::first(UNIFORM, "environment uniform"),
    KnownKind::first(RADIANCE, "environment radiance"),
    KnownKind::first(INDICATORS, "environment indicators"),
    KnownKind::first(COLOURS, "environment colours"),
    KnownKind::first(ALBEDO, "environment albedo"),
];
/// The bind group of `bind_environment.wgsl`.
pub const BINDINGS: &[Binding] = &[
    Binding::Uniform(UNIFORM),
    Binding::Texture(RADIANCE, View::FloatCube),
    Binding::Texture(INDICATORS, View::FloatCubeArray),
    Binding::Texture(COLOURS, View::FloatCubeArray),
    Binding::Texture(ALBEDO, View::Float2d),
    Binding::ClampSampler,
];
/// VkFormat of radiance and indicators: R16G16B16A16_SFLOAT.
pub const CUBE_VK_FORMAT: u32 = vk_format::R16G16B16A16_SFLOAT;
/// VkFormat of the albedo table: R16G16B16A16_SFLOAT.
pub const ALBEDO_VK_FORMAT: u32 = vk_format::R16G16B16A16_SFLOAT;
/// VkFormat of level colours: E5B9G9R9_UFLOAT_PACK32.
pub const COLOURS_VK_FORMAT: u32 = vk_format::E5B9G9R9_UFLOAT_PACK32;
/// Most radiance levels.
pub const MAX_LEVELS: usize = 16;
/// Largest edge of a face: what every WebGPU device offers.
pub const MAX_FACE_SIZE: u32 = 8192;

/// What radiance is weighted with. c is the cosine to the texel's direction, h the half vector of that direction
/// and the light's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// The paper's, ρ̃ at N = V = R: D(h) · G₁(c) over the hemisphere.
    Ndf,
    /// The usual one of engines: D(h) · c over the hemisphere.
    GgxNl,
}

/// How the radiance levels were chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LevelChoice {
    /// Least mean relative error of the second moment.
    Optimal,
    /// The paper's: evenly in the logarithm of radiance.
    LogUniform,
}

/// Error of the stored texels against sums over the source image in f64.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredMip {
    /// Root mean square error of luminance over the measured texels, over the mean luminance of the mip.
    pub rmse: f64,
    /// Largest |error| of luminance of a measured texel, over its exact value.
    pub worst: f64,
}

/// Error as the bake measured it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredError {
    /// One entry a mip; empty when nothing was measured.
    pub mips: Vec<MeasuredMip>,
    /// Texels measured a mip, at most.
    pub texels: u32,
    /// Luminance summed over the first mip's texels by solid angle, against the source: |ratio − 1|.
    pub energy: f64,
    /// Relative error of the second moment of a facet's radiance with these levels: mean over directions and
    /// roughnesses, by the bake's own estimate.
    pub second_moment: f64,
    /// A mip: root mean square error of luminance that rounding to the storage makes, over all texels, over the mean.
    pub rounding: Vec<f64>,
}

/// Parameters of an environment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnvironmentParams {
    /// Edge of a face of mip 0 in texels, a power of two.
    pub face_size: u32,
    /// Filter.
    pub kernel: Kernel,
    /// GGX roughness α of each mip, rising from 0.
    pub roughness: Vec<f64>,
    /// Stored radiance times this is radiance; exact in f32. Where a sun is a few texels, it is chosen so that they round
    /// well.
    pub radiance_scale: f64,
    /// Radiance (luminance) of each level, rising; the first is 0 unless it is the only one.
    pub levels: Vec<f64>,
    /// How they were chosen.
    pub level_choice: LevelChoice,
    /// Whether levels have colours of their own.
    pub coloured: bool,
    /// Edge of the albedo table.
    pub albedo_size: u32,
    /// Width of the source image.
    pub source_width: u32,
    /// Height of the source image.
    pub source_height: u32,
    /// Pixels with a negative channel, which was taken as 0.
    pub negative_pixels: u64,
    /// Mean radiance over the sphere.
    pub mean_radiance: [f64; 3],
    /// Error of radiance that was asked of every mip.
    pub max_error: f64,
    /// Error as the bake measured it.
    pub measured: MeasuredError,
}

/// `GlintEnvironment` of the shaders: what they bind of the parameters.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct EnvironmentUniform {
    /// Radiance (luminance) of each level, rising; zeros beyond them.
    pub level: [f32; MAX_LEVELS],
    /// 1 for each level that there is, else 0.
    pub present: [f32; MAX_LEVELS],
    /// Number of levels, 1 to [`MAX_LEVELS`].
    pub levels: u32,
    /// Number of mips.
    pub mips: u32,
    /// 1 where levels have colours of their own, else 0.
    pub coloured: u32,
    /// Stored radiance times this is radiance.
    pub radiance_scale: f32,
}

impl EnvironmentParams {
    /// What shaders bind of these parameters. Levels beyond [`MAX_LEVELS`] are left out.
    pub fn uniform(&self) -> EnvironmentUniform {
        let mut uniform = EnvironmentUniform {
            levels: self.levels.len() as u32,
            mips: self.mips(),
            coloured: u32::from(self.coloured),
            radiance_scale: self.radiance_scale as f32,
            ..EnvironmentUniform::default()
        };
        for (k, level) in self.levels.iter().take(MAX_LEVELS).enumerate() {
            uniform.level[k] = *level as f32;
            uniform.present[k] = 1.0;
        }
        uniform
    }

    /// Mips.
    pub fn mips(&self) -> u32 {
        self.roughness.len() as u32
    }

    /// Layers of the indicator texture; 0 when one level needs none.
    pub fn indicator_layers(&self) -> u32 {
        (self.levels.len().max(1) as u32 - 1).div_ceil(4)
    }

    /// Descriptor of the uniform.
    pub fn uniform_resource(&self) -> Resource {
        Resource::Buffer { stride: size_of::<EnvironmentUniform>() as u32, count: 1 }
    }

    /// Descriptor of the radiance.
    pub fn radiance_resource(&self) -> Resource {
        self.cube(CUBE_VK_FORMAT, 1)
    }

    /// Descriptor of the indicators.
    pub fn indicators_resource(&self) -> Resource {
        self.cube(CUBE_VK_FORMAT, self.indicator_layers())
    }

    /// Descriptor of the level colours.
    pub fn colours_resource(&self) -> Resource {
        self.cube(COLOURS_VK_FORMAT, self.levels.len().max(1) as u32 - 1)
    }

    /// Descriptor of the albedo table.
    pub fn albedo_resource(&self) -> Resource {
        let size = self.albedo_size;
        Resource::Texture { vk_format: ALBEDO_VK_FORMAT, width: size, height: size, layers: 1, faces: 1, mips: 1 }
    }

    fn cube(&self, vk_format: u32, layers: u32) -> Resource {
        let size = self.face_size;
        Resource::Texture { vk_format, width: size, height: size, layers, faces: 6, mips: self.mips() }
    }
}
