//! Typed sections of a prefiltered environment: parameters, radiance, indicators of radiance levels, their colours, and
//! what depends on view angle and roughness alone: albedo and look-ups.
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
/// The source as a mirror shows it: cube texture of half floats without mips, each texel the mean over its solid angle. R G B over
/// [`EnvironmentParams::radiance_scale`]; alpha is the root mean square of the luminance, on the same scale.
pub const MIRROR: FourCc = FourCc(*b"ENMI");
/// Filtered radiance: cube array texture of half floats, R G B A as those of [`MIRROR`] under the filter of each roughness. Mip m has
/// the roughnesses of its face size, one a layer, see [`EnvironmentParams::place`].
pub const RADIANCE: FourCc = FourCc(*b"ENRA");
/// Filtered indicators of levels 1, 2, …: cube array texture of half floats with the mips of [`RADIANCE`]. Layer
/// s · [`EnvironmentParams::indicator_layers`] + l belongs to layer s of the radiance; its component c is level 4 l + c + 1. The darkest
/// level, level 0, is what is left of 1.
pub const INDICATORS: FourCc = FourCc(*b"ENIN");
/// Mean colour of levels 1, 2, … under the filter, each of luminance 1: cube array texture with the mips of [`RADIANCE`], layer l is
/// level l + 1. Of the roughnesses of a face size it has one, that of layer [`EnvironmentParams::colour_layer`].
pub const COLOURS: FourCc = FourCc(*b"ENCO");
/// Directional albedo and look-ups by view angle and roughness: array texture of [`ALBEDO_VK_FORMAT`], `albedo_size` texels square,
/// one layer more than [`EnvironmentParams::look_ups`].
///
/// Column i is cos θ_o = (i + ½) / size, row j is roughness α = ((j + ½) / size)². With the mirror direction m and the normal n, a look-up
/// of shift κ and ratio r is in the direction m + κ α (n − cos θ_o m), at roughness r α.
/// - Layer 0: albedo is E_ρ = F₀ R + G under Schlick's Fresnel factor; κ and r of the first look-up are B and A.
/// - Layer 1: mean square ⟨ρ²⟩ of what a facet adds under even light over (E_ρ)²: R x² + 2 G x (1 − x) + B (1 − x)², x = F₀ R₀ / E_ρ with
///   R₀ of layer 0. A: share E_D / D_H of facets that reflect to above the horizon.
/// - Layer 1 + i, look-up i from 1 on: κ, r, its share of what is read, 0. The first has what they leave of 1.
pub const ALBEDO: FourCc = FourCc(*b"ENAL");

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] = &[
    KnownKind::first(PARAMS, "environment parameters"),
    KnownKind::first(UNIFORM, "environment uniform"),
    KnownKind::first(MIRROR, "environment mirror"),
    KnownKind::first(RADIANCE, "environment radiance"),
    KnownKind::first(INDICATORS, "environment indicators"),
    KnownKind::first(COLOURS, "environment colours"),
    KnownKind::first(ALBEDO, "environment albedo"),
];
/// The bind group of `bind_environment.wgsl`.
pub const BINDINGS: &[Binding] = &[
    Binding::Uniform(UNIFORM),
    Binding::Texture(MIRROR, View::FloatCube),
    Binding::Texture(RADIANCE, View::FloatCubeArray),
    Binding::Texture(INDICATORS, View::FloatCubeArray),
    Binding::Texture(COLOURS, View::FloatCubeArray),
    Binding::Texture(ALBEDO, View::Float2dArray),
    Binding::ClampSampler,
];
/// VkFormat of radiance and indicators: R16G16B16A16_SFLOAT.
pub const CUBE_VK_FORMAT: u32 = vk_format::R16G16B16A16_SFLOAT;
/// VkFormat of the albedo table: R16G16B16A16_SFLOAT.
pub const ALBEDO_VK_FORMAT: u32 = vk_format::R16G16B16A16_SFLOAT;
/// VkFormat of level colours: E5B9G9R9_UFLOAT_PACK32.
pub const COLOURS_VK_FORMAT: u32 = vk_format::E5B9G9R9_UFLOAT_PACK32;
/// Roughness below which a lobe is no wider than some texels: errors of what is read there are kept apart.
pub const SHARP: f64 = 0.04;
/// Most look-ups of a surface.
pub const MAX_LOOK_UPS: usize = 3;
/// Most radiance levels.
pub const MAX_LEVELS: usize = 16;
/// Largest edge of a face: what every WebGPU device offers.
pub const MAX_FACE_SIZE: u32 = 8192;
/// Most roughnesses of one face size: with four layers of indicators each they stay within 256 array layers of six faces, which
/// every WebGPU device offers.
pub const MAX_PER_SIZE: u32 = 8;
/// The least filtered roughness times the edge of a face of the mirror: its lobe is some five texels of the filtered faces wide.
const FIRST_TEXELS: f64 = 2.56;
/// Largest value of the least filtered roughness, where there is more than one.
const LARGEST_FIRST: f64 = 0.5;
/// How much denser rough roughnesses lie than sharp ones, in the logarithm of α: see [`roughness_of`]. Chosen by the error of what
/// is read between them.
const BEND: f64 = -0.4;

/// What radiance is weighted with. c is the cosine to the texel's direction, h the half vector of that direction
/// and the light's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// The paper's, ρ̃ at N = V = R: D(h) · G₁(c) over the hemisphere.
    Ndf,
    /// The usual one of engines: D(h) · c over the hemisphere.
    GgxNl,
    /// The same without a kink at the horizon: D(h) · s(c), s(c) = (c + τ)² / 4τ where |c| < τ = [`SOFT_TOE`], c above, 0 below.
    GgxSoft,
}

/// Half the range of cosines over which [`Kernel::GgxSoft`] ends.
pub const SOFT_TOE: f64 = 0.2;

/// GGX roughness α of the mirror, 0, and of `filtered` filtered roughnesses under faces of `face_size` texels: rising, 1 last.
///
/// With α₁ the first of them and u = 1 − ln α / ln α₁, roughness i of n is where 1 + (n − 1) u (1 + q (1 − u)) = i, q = −.4.
pub fn roughness_of(face_size: u32, filtered: u32) -> Vec<f64> {
    let first = if filtered < 2 { 1.0 } else { (FIRST_TEXELS / f64::from(face_size)).min(LARGEST_FIRST) };
    let alpha = |i: u32| {
        if i == 0 {
            return 0.0;
        }
        if i == filtered {
            return 1.0;
        }
        let place = f64::from(i - 1) / f64::from(filtered - 1);
        // The root of q u² − (1 + q) u + place = 0 in 0 … 1.
        let half = 0.5 * (1.0 + BEND);
        let u = (half - (half * half - BEND * place).sqrt()) / BEND;
        libm::pow(first, 1.0 - u)
    };
    (0..=filtered).map(alpha).collect()
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

/// Error of the stored texels of a roughness against sums over the source image in f64.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredTexels {
    /// Root mean square error of luminance over the measured texels, over the mean luminance of the source.
    pub rmse: f64,
    /// Largest |error| of luminance of a measured texel, over its exact value.
    pub worst: f64,
}

/// Error of what a shader reads, by look-ups in random directions at random roughnesses, against sums over the source image in f64.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredReads {
    /// Look-ups.
    pub count: u32,
    /// Root mean square of the errors of luminance, each over its exact value.
    pub relative: f64,
    /// Root mean square error of luminance over the mean of the exact values.
    pub of_mean: f64,
    /// Largest |error| of luminance of a look-up, over its exact value.
    pub worst: f64,
}

/// Error as the bake measured it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredError {
    /// What is read where α is below [`SHARP`], and elsewhere; empty when nothing was measured.
    pub reads: Vec<MeasuredReads>,
    /// One entry a roughness; empty when nothing was measured.
    pub texels: Vec<MeasuredTexels>,
    /// Texels measured a roughness, at most.
    pub texels_measured: u32,
    /// Luminance summed over the mirror's texels by solid angle, against the source: |ratio − 1|.
    pub energy: f64,
    /// Relative error of the second moment of a facet's radiance with these levels: mean over directions and
    /// roughnesses, by the bake's own estimate.
    pub second_moment: f64,
    /// A roughness: root mean square error of luminance that rounding to the storage makes, over all texels, over the mean.
    pub rounding: Vec<f64>,
}

/// Parameters of an environment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnvironmentParams {
    /// Edge of a face of the mirror in texels, a power of two. Those of the first filtered roughnesses are half as large.
    pub face_size: u32,
    /// Filtered roughnesses of each face size, 1 to [`MAX_PER_SIZE`].
    pub per_size: u32,
    /// Filter.
    pub kernel: Kernel,
    /// GGX roughness α of the mirror, 0, and of every filtered roughness, rising, as [`roughness_of`] gives them.
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
    /// Look-ups of a surface, 1 to [`MAX_LOOK_UPS`].
    pub look_ups: u32,
    /// Width of the source image.
    pub source_width: u32,
    /// Height of the source image.
    pub source_height: u32,
    /// Pixels with a negative channel, which was taken as 0.
    pub negative_pixels: u64,
    /// Mean radiance over the sphere.
    pub mean_radiance: [f64; 3],
    /// Error of radiance that the filter was asked to keep in the texels of every roughness.
    pub filter_error: f64,
    /// [`MeasuredReads::relative`] that was asked of the reads; none when none was.
    pub max_error: Option<f64>,
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
    /// 1 where levels have colours of their own, else 0.
    pub coloured: u32,
    /// Stored radiance times this is radiance.
    pub radiance_scale: f32,
    /// Number of filtered roughnesses.
    pub roughnesses: f32,
    /// How many of them each face size has.
    pub per_size: f32,
    /// The least of them, α₁.
    pub first_alpha: f32,
    /// 1 / log₂ α₁; 0 where α₁ is 1.
    pub inverse_log: f32,
    /// q of [`roughness_of`].
    pub bend: f32,
    /// Look-ups of a surface, 1 to [`MAX_LOOK_UPS`].
    pub look_ups: u32,
    /// Zeros, so that the record is a whole number of vectors.
    pub unused: [u32; 3],
}

impl EnvironmentParams {
    /// What shaders bind of these parameters. Levels beyond [`MAX_LEVELS`] are left out.
    pub fn uniform(&self) -> EnvironmentUniform {
        let first = self.roughness.get(1).copied().unwrap_or(1.0);
        let mut uniform = EnvironmentUniform {
            levels: self.levels.len() as u32,
            coloured: u32::from(self.coloured),
            radiance_scale: self.radiance_scale as f32,
            roughnesses: self.filtered() as f32,
            per_size: self.per_size as f32,
            first_alpha: first as f32,
            inverse_log: if first < 1.0 { (1.0 / libm::log2(first)) as f32 } else { 0.0 },
            bend: BEND as f32,
            look_ups: self.look_ups,
            ..EnvironmentUniform::default()
        };
        for (k, level) in self.levels.iter().take(MAX_LEVELS).enumerate() {
            uniform.level[k] = *level as f32;
            uniform.present[k] = 1.0;
        }
        uniform
    }

    /// Filtered roughnesses.
    pub fn filtered(&self) -> u32 {
        (self.roughness.len() as u32).max(1) - 1
    }

    /// Face sizes of the filtered roughnesses, which are the mips of [`RADIANCE`].
    pub fn mips(&self) -> u32 {
        self.filtered() / self.per_size.max(1)
    }

    /// Mip and layer of [`RADIANCE`] that hold filtered roughness `index`, 1 for the least.
    pub fn place(&self, index: u32) -> (u32, u32) {
        ((index - 1) / self.per_size, (index - 1) % self.per_size)
    }

    /// Edge of a face in texels: of the mirror for index 0, of filtered roughness `index` else.
    pub fn size(&self, index: u32) -> u32 {
        if index == 0 { self.face_size } else { self.face_size >> (1 + self.place(index).0) }
    }

    /// Layer of [`RADIANCE`] whose roughnesses the colours of levels have.
    pub fn colour_layer(&self) -> u32 {
        self.per_size / 2
    }

    /// Layers of indicators of one roughness; 0 when one level needs none.
    pub fn indicator_layers(&self) -> u32 {
        (self.levels.len().max(1) as u32 - 1).div_ceil(4)
    }

    /// Descriptor of the uniform.
    pub fn uniform_resource(&self) -> Resource {
        Resource::Buffer { stride: size_of::<EnvironmentUniform>() as u32, count: 1 }
    }

    /// Descriptor of the mirror.
    pub fn mirror_resource(&self) -> Resource {
        let size = self.face_size;
        Resource::Texture { vk_format: CUBE_VK_FORMAT, width: size, height: size, layers: 1, faces: 6, mips: 1 }
    }

    /// Descriptor of the filtered radiance.
    pub fn radiance_resource(&self) -> Resource {
        self.filtered_resource(CUBE_VK_FORMAT, self.per_size)
    }

    /// Descriptor of the indicators.
    pub fn indicators_resource(&self) -> Resource {
        self.filtered_resource(CUBE_VK_FORMAT, self.per_size * self.indicator_layers())
    }

    /// Descriptor of the level colours.
    pub fn colours_resource(&self) -> Resource {
        self.filtered_resource(COLOURS_VK_FORMAT, self.levels.len().max(1) as u32 - 1)
    }

    /// Descriptor of the albedo table.
    pub fn albedo_resource(&self) -> Resource {
        let (size, layers) = (self.albedo_size, self.look_ups + 1);
        Resource::Texture { vk_format: ALBEDO_VK_FORMAT, width: size, height: size, layers, faces: 1, mips: 1 }
    }

    fn filtered_resource(&self, vk_format: u32, layers: u32) -> Resource {
        let size = self.face_size / 2;
        Resource::Texture { vk_format, width: size, height: size, layers, faces: 6, mips: self.mips() }
    }
}
