//! Radiance of glints under an environment: one draw for the facets of a pixel, f32, as in WGSL.
//!
//! Paper: Eq. 17 with the probabilities of Eq. 15 and 21. Deviations:
//! - what the levels give is brought to the variance that was filtered besides radiance by
//!   [`spread_factor`](super::eval::spread_factor): each facet that is there takes part of the mean, and part of its
//!   level. No facet, no light;
//! - coloured levels: every channel is a mean of its own, so a red lamp's glints are red and their mean stays the smooth
//!   reflection.

use super::eval::{
    environment_areas, environment_levels, environment_radiance, facet_moments, level_colour, level_probabilities,
    spread_factor,
};
use super::tables::Environment;
use crate::counting::eval::{count_value, multinomial};
use glam::Vec3;
use glint_formats::environment::MAX_LEVELS;

/// A point of a glittering surface as a pixel sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlintSurface {
    /// Surface normal, unit length, in the environment's frame.
    pub normal: Vec3,
    /// Direction to the eye, unit length.
    pub view: Vec3,
    /// GGX roughness α.
    pub alpha: f32,
    /// Reflectance at normal incidence.
    pub f0: f32,
    /// Facets under the pixel, any number ≥ 0; no facets reflect nothing.
    pub facets: f32,
}

/// What a draw starts from: the smooth reflection and the chances of every level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlintChances {
    /// Smooth reflection, linear RGB.
    pub smooth: [f32; 3],
    /// Chance that a facet reflects each level.
    pub p: [f32; MAX_LEVELS],
    /// Σ L_k p_k and Σ L_k² p_k.
    pub moments: [f32; 2],
    /// How far glints vary from the smooth reflection, 0 to 1, against what the levels give.
    pub spread: f32,
}

/// The smooth reflection and the chances of the levels at a surface point.
pub fn glint_chances(environment: &Environment, surface: &GlintSurface) -> GlintChances {
    let cos_o = surface.normal.dot(surface.view);
    let mirror = 2.0 * cos_o * surface.normal - surface.view;
    let [scale, bias, reflecting, whole] = environment_areas(environment, cos_o, surface.alpha);
    let radiance = environment_radiance(environment, mirror, surface.alpha);
    let shares = environment_levels(environment, mirror, surface.alpha);
    let levels = &environment.params.levels;
    let visible = (reflecting / whole).min(1.0);
    let p = level_probabilities(&shares, levels.len(), visible);
    let moments = facet_moments(levels, &p);
    let albedo = surface.f0 * scale + bias;
    GlintChances {
        smooth: [albedo * radiance[0], albedo * radiance[1], albedo * radiance[2]],
        p,
        moments,
        spread: spread_factor(moments, radiance[3] * radiance[3], visible),
    }
}

/// Radiance towards the eye of one draw of facets, linear RGB; `words` are the random words of the pixel, see
/// [`multinomial`](crate::counting::multinomial()).
pub fn environment_glints(environment: &Environment, surface: &GlintSurface, words: &[f32; MAX_LEVELS]) -> [f32; 3] {
    let chances = glint_chances(environment, surface);
    if !(chances.moments[0] > 0.0 && surface.facets > 0.0) {
        return if surface.facets > 0.0 { chances.smooth } else { [0.0; 3] };
    }
    let mut ratios = [0.0; 3];
    let counts = level_counts(environment, &chances, surface.facets, words);
    let present = counts.iter().sum::<f32>() / surface.facets;
    if environment.params.coloured {
        let cos_o = surface.normal.dot(surface.view);
        let mirror = 2.0 * cos_o * surface.normal - surface.view;
        ratios = coloured_ratios(environment, &chances, surface, mirror, &counts);
    } else {
        let mut light = 0.0;
        for (level, count) in environment.params.levels.iter().zip(counts) {
            light += *level as f32 * count;
        }
        ratios.fill(light / (surface.facets * chances.moments[0]));
    }
    let mut radiance = [0.0; 3];
    for c in 0..3 {
        radiance[c] = chances.smooth[c] * (present + chances.spread * (ratios[c] - present)).max(0.0);
    }
    radiance
}

/// Facets at each level. A single level needs a second one for the facets that reflect nothing.
fn level_counts(
    environment: &Environment,
    chances: &GlintChances,
    facets: f32,
    words: &[f32; MAX_LEVELS],
) -> [f32; MAX_LEVELS] {
    let levels = environment.params.levels.len();
    let mut p = chances.p;
    if levels == 1 {
        p[1] = 1.0 - p[0];
    }
    multinomial(facets, &p, levels.max(2), words).map(count_value)
}

/// Drawn over expected light, channel by channel.
fn coloured_ratios(
    environment: &Environment,
    chances: &GlintChances,
    surface: &GlintSurface,
    mirror: Vec3,
    counts: &[f32; MAX_LEVELS],
) -> [f32; 3] {
    let (mut drawn, mut expected) = ([0.0; 3], [0.0; 3]);
    for level in 1..environment.params.levels.len() {
        let colour = level_colour(environment, level, mirror, surface.alpha);
        let light = environment.params.levels[level] as f32;
        for c in 0..3 {
            drawn[c] += light * colour[c] * counts[level];
            expected[c] += light * colour[c] * chances.p[level] * surface.facets;
        }
    }
    let mut ratios = [1.0; 3];
    for c in 0..3 {
        if expected[c] > 0.0 {
            ratios[c] = drawn[c] / expected[c];
        }
    }
    ratios
}

/// Variance of [`environment_glints`] in luminance over the square of its mean, for facets as `counting` makes them whole.
pub fn glint_relative_variance(chances: &GlintChances, facets: f32) -> f32 {
    let mean2 = chances.moments[0] * chances.moments[0];
    if !(mean2 > 0.0 && facets > 0.0) {
        return 0.0;
    }
    let part = facets - facets.floor();
    let per_facet = (chances.moments[1] / mean2 - 1.0).max(0.0);
    chances.spread * chances.spread * per_facet / facets + part * (1.0 - part) / (facets * facets)
}
