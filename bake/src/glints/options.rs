//! What a material of counted facets is asked to be.

use crate::error::{BakeError, Result};
use crate::microfacet::{BECKMANN, GGX, SmoothSurface};
use glam::Vec2;
use glint_formats::glints::{ALPHA_RANGE, FACET_SPREAD_RANGE, MAX_COLOURS, MAX_DENSITY, Slopes};
use std::f32::consts::PI;
use std::ops::RangeInclusive;

/// Options of the bake.
#[derive(Clone, Debug, PartialEq)]
pub struct GlintsOptions {
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
    /// Share of the surface that glints, 0 to 1.
    pub relative_area: f32,
    /// Half angle of the cone that a facet reflects a point into, in radians, 1e-4 to 0.5.
    pub facet_spread: f32,
    /// By how much the eye turns, in radians, until facets under a sky are others, 0 (never) to π.
    pub sky_spread: f32,
    /// Colours of the facets, linear RGB, 0 to 1 each; none means white.
    pub colours: Vec<[f32; 3]>,
    /// Seed of the facets.
    pub seed: u32,
    /// Albedo of what is scattered below the facets, linear RGB, 0 to 1; black for metals.
    pub diffuse: [f32; 3],
    /// Weight of a clear coat over the facets, 0 for none to 1.
    pub coat: f32,
    /// GGX roughness α of the coat, 0.001 to 1.
    pub coat_alpha: f32,
}

impl Default for GlintsOptions {
    fn default() -> GlintsOptions {
        GlintsOptions {
            slopes: Slopes::Ggx,
            alpha: [0.3; 2],
            turn: 0.0,
            f0: [0.95, 0.93, 0.88],
            density: 1e6,
            relative_area: 1.0,
            // That of the sun's disk.
            facet_spread: 0.004_65,
            sky_spread: 0.0,
            colours: Vec::new(),
            seed: 1,
            diffuse: [0.0; 3],
            coat: 0.0,
            coat_alpha: 0.03,
        }
    }
}

impl GlintsOptions {
    /// Checks the options.
    ///
    /// # Errors
    /// [`BakeError::BadOption`] names the option, what was found and what would work.
    pub fn validate(&self) -> Result<()> {
        let colours: Vec<f32> = self.colours.as_flattened().to_vec();
        let ranges: [(&str, &[f32], RangeInclusive<f32>); 11] = [
            ("alpha", &self.alpha, ALPHA_RANGE.0..=ALPHA_RANGE.1),
            ("turn", &[self.turn], -PI..=PI),
            ("f0", &self.f0, 0.0..=1.0),
            ("density", &[self.density], f32::MIN_POSITIVE..=MAX_DENSITY),
            ("relative-area", &[self.relative_area], 0.0..=1.0),
            ("facet-spread", &[self.facet_spread], FACET_SPREAD_RANGE.0..=FACET_SPREAD_RANGE.1),
            ("sky-spread", &[self.sky_spread], 0.0..=PI),
            ("colour", &colours, 0.0..=1.0),
            ("diffuse", &self.diffuse, 0.0..=1.0),
            ("coat", &[self.coat], 0.0..=1.0),
            ("coat-alpha", &[self.coat_alpha], ALPHA_RANGE.0..=ALPHA_RANGE.1),
        ];
        for (option, found, range) in ranges {
            if let Some(found) = found.iter().find(|value| !range.contains(value)) {
                let (low, high) = (range.start(), range.end());
                return Err(BakeError::BadOption(format!("{option}: expected {low} to {high}, found {found}")));
            }
        }
        if self.colours.len() > MAX_COLOURS {
            let found = self.colours.len();
            return Err(BakeError::BadOption(format!("colour: expected at most {MAX_COLOURS}, found {found}")));
        }
        Ok(())
    }

    /// The smooth surface that the facets converge to.
    pub fn smooth(&self) -> SmoothSurface {
        let normal_target = match self.slopes {
            Slopes::Beckmann => BECKMANN,
            Slopes::Ggx => GGX,
        };
        let alpha = Vec2::from_array(self.alpha);
        SmoothSurface { alpha2: alpha * alpha, normal_target }
    }
}
