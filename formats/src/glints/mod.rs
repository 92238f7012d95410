//! Typed sections of counted facets: a material's parameters, its palette, and the two tables that rectangle lights need.
//!
//! Method: Kneiphof and Klein 2025 for the counting, Heitz et al. 2016 for the tables. Facets are not stored: which of them a pixel sees
//! follows from its place, the material and a seed.

pub(crate) mod check;

use crate::binding::{Binding, View};
use crate::container::{FourCc, KnownKind};
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Parameters of a material of counted facets: [`GlintsParams`], bincode.
pub const PARAMS: FourCc = FourCc(*b"GLPP");
/// What a shader binds as uniforms: buffer of one [`GlintsUniform`].
pub const UNIFORM: FourCc = FourCc(*b"GLUB");
/// Colours of the facets: buffer of four f32 a colour, linear RGB and 1; one white one where the parameters name none.
pub const COLOURS: FourCc = FourCc(*b"GLCO");
/// M⁻¹ of the LTC fits: texture of the format, size and content of [`area_light::INVERSE`](crate::area_light::INVERSE).
pub const INVERSE: FourCc = FourCc(*b"GLLI");
/// Magnitude, Fresnel term, 0 and clipped form factor: texture like [`INVERSE`].
pub const TERMS: FourCc = FourCc(*b"GLLT");

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] = &[
    KnownKind::first(PARAMS, "counted facets parameters"),
    KnownKind::first(UNIFORM, "counted facets uniforms"),
    KnownKind::first(COLOURS, "counted facets colours"),
    KnownKind::first(INVERSE, "LTC inverse matrices of facets"),
    KnownKind::first(TERMS, "LTC terms of facets"),
];
/// How a material is bound.
pub const BINDINGS: &[Binding] = &[
    Binding::Uniform(UNIFORM),
    Binding::Storage(COLOURS),
    Binding::Texture(INVERSE, View::Float2d),
    Binding::Texture(TERMS, View::Float2d),
    Binding::ClampSampler,
];
/// Most colours of a palette.
pub const MAX_COLOURS: usize = 256;
/// Most facets on a surface unit squared.
pub const MAX_DENSITY: f32 = 1e16;
/// Roughness along an axis, least and most.
pub const ALPHA_RANGE: (f32, f32) = (0.001, 1.0);
/// Half angle of the cone that a facet reflects a point into, in radians, least and most.
pub const FACET_SPREAD_RANGE: (f32, f32) = (1e-4, 0.5);

/// Distribution of the facets' slopes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Slopes {
    /// Beckmann.
    Beckmann,
    /// GGX.
    Ggx,
}

/// What a shader binds as uniforms: `GlintCountedMaterial` of `glints::eval`, 112 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GlintsUniform {
    /// Reflectance at normal incidence, linear RGB.
    pub f0: [f32; 3],
    /// 0 Beckmann, 1 GGX.
    pub normal_target: u32,
    /// Roughness along both axes.
    pub alpha: [f32; 2],
    /// Cosine and sine of the angle from the tangent to the first axis.
    pub turn: [f32; 2],
    /// Mean of the colours, linear RGB; white without any.
    pub mean_colour: [f32; 3],
    /// Number of colours; 0 means white.
    pub colours: u32,
    /// Facets on one surface unit squared of what glints.
    pub density: f32,
    /// Share of the surface that glints.
    pub relative_area: f32,
    /// Whole facet area over surface area.
    pub facet_area: f32,
    /// Half angle of the cone that a facet reflects a point into, in radians.
    pub facet_spread: f32,
    /// By how much the eye turns, in radians, until facets under a sky are others; 0 for never.
    pub sky_spread: f32,
    /// Seed of the facets.
    pub seed: u32,
    /// 0.
    pub unused: [u32; 2],
    /// What facets lie on and under.
    pub layers: LayersUniform,
}

/// `GlintLayers` of `glints::layers`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct LayersUniform {
    /// Albedo of what is scattered below the facets, linear RGB.
    pub diffuse: [f32; 3],
    /// Weight of the coat.
    pub coat: f32,
    /// GGX roughness of the coat.
    pub coat_alpha: f32,
    /// 0.
    pub unused: [u32; 3],
}

/// Parameters of a material of counted facets.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GlintsParams {
    /// Distribution of slopes.
    pub slopes: Slopes,
    /// Roughness α along both axes, 0.001 to 1.
    pub alpha: [f32; 2],
    /// Angle from the tangent to the first axis, in radians, −π to π.
    pub turn: f32,
    /// Reflectance at normal incidence, linear RGB, 0 to 1.
    pub f0: [f32; 3],
    /// Facets on one surface unit squared of what glints, above 0, at most 1e16.
    pub density: f32,
    /// Share of the surface that glints, 0 to 1; the rest is smooth.
    pub relative_area: f32,
    /// Whole facet area over surface area, 1 to 2: follows from slopes and roughness.
    pub facet_area: f32,
    /// Half angle of the cone that a facet reflects a point into, in radians, 1e-4 to 0.5.
    pub facet_spread: f32,
    /// By how much the eye turns, in radians, until facets under a sky are others, 0 (never) to 3.2.
    pub sky_spread: f32,
    /// Seed of the facets.
    pub seed: u32,
    /// Albedo of what is scattered below the facets, linear RGB, 0 to 1; black for metals.
    pub diffuse: [f32; 3],
    /// Weight of a clear coat over the facets, 0 for none to 1.
    pub coat: f32,
    /// GGX roughness α of the coat, 0.001 to 1.
    pub coat_alpha: f32,
    /// Colours of the facets, linear RGB, each component from 0; none means white.
    pub colours: Vec<[f32; 3]>,
    /// Mean, over the entries of the tables, of ∫ |LTC − GGX| / ∫ GGX.
    pub table_mean_error: f64,
}

impl GlintsParams {
    /// Mean of the colours, linear RGB; white without any.
    pub fn mean_colour(&self) -> [f32; 3] {
        if self.colours.is_empty() {
            return [1.0; 3];
        }
        [0, 1, 2].map(|c| {
            let sum: f64 = self.colours.iter().map(|colour| f64::from(colour[c])).sum();
            (sum / self.colours.len() as f64) as f32
        })
    }

    /// The uniforms that go with these parameters.
    pub fn uniform(&self) -> GlintsUniform {
        GlintsUniform {
            f0: self.f0,
            normal_target: match self.slopes {
                Slopes::Beckmann => 0,
                Slopes::Ggx => 1,
            },
            alpha: self.alpha,
            // The same on every platform.
            turn: [libm::cosf(self.turn), libm::sinf(self.turn)],
            mean_colour: self.mean_colour(),
            colours: self.colours.len() as u32,
            density: self.density,
            relative_area: self.relative_area,
            facet_area: self.facet_area,
            facet_spread: self.facet_spread,
            sky_spread: self.sky_spread,
            seed: self.seed,
            unused: [0; 2],
            layers: LayersUniform {
                diffuse: self.diffuse,
                coat: self.coat,
                coat_alpha: self.coat_alpha,
                unused: [0; 3],
            },
        }
    }

    /// The section [`COLOURS`] as a shader reads it.
    pub fn palette(&self) -> Vec<[f32; 4]> {
        let colours = self.colours.iter().map(|[r, g, b]| [*r, *g, *b, 1.0]);
        if self.colours.is_empty() { vec![[1.0; 4]] } else { colours.collect() }
    }
}
