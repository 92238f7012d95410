//! Image-based lighting of glints, f32, as in WGSL: filtered radiance, probabilities of the radiance levels, and one draw for the
//! facets of a pixel.
//!
//! Paper: Kneiphof and Klein 2025, sections 4 and 5, Eq. 11, 15, 17 and 21. Glint radiance is L_o · Σ L_k M_k / (N Σ L_k p_k) with M
//! multinomial, drawn by [`multinomial`]. Twin: `eval.wgsl`; what that asks of the including program is in `lookup.rs`. Deviations:
//! - what the levels give is brought to the variance that was filtered besides radiance by [`std_factor`], so the variance of
//!   glints is right for any levels: each facet that is there takes part of the mean, and part of its level. No facet, no light;
//! - the lobe of a surface seen at an angle is that of one to three fitted look-ups (`fitted.rs`), and the facets that reflect are as many
//!   as give the variance that their different reflectances have ([`visible_share`]);
//! - coloured levels: every channel is a mean of its own, so a red lamp's glints are red and their mean stays the smooth
//!   reflection.

use super::baked::Environment;
use super::lookup::{albedo_at, colour_at, indicators_at, mirror_at, radiance_at};
use crate::counting::eval::{count_value, multinomial};
use glam::Vec3;
use glint_formats::environment::MAX_LEVELS;

/// A point of a glittering surface as a pixel sees it, in the environment's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Surface normal, unit length.
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
pub struct Chances {
    /// Smooth reflection, linear RGB.
    pub smooth_radiance: [f32; 3],
    /// Chance that a facet reflects each level.
    pub p: [f32; MAX_LEVELS],
    /// Σ L_k p_k and Σ L_k² p_k.
    pub moments: [f32; 2],
    /// Factor on the standard deviation of what the levels give, 0 to 1.
    pub std_factor: f32,
    /// Where the first look-up looks, unit length.
    pub towards: Vec3,
    /// Mip of the colours of levels, 0 to the last.
    pub colour_mip: f32,
}

/// The two filtered roughnesses that a roughness lies between, and the shares of what it reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Mip and layer of the sharper one.
    pub low: [u32; 2],
    /// Mip and layer of the rougher one.
    pub high: [u32; 2],
    /// Share of the rougher one in what is filtered.
    pub share: f32,
    /// Share of the mirror in all; above 0 below the least filtered roughness.
    pub mirror: f32,
    /// Mip of the colours of levels, 0 to the last.
    pub colour_mip: f32,
}

/// One of the round look-ups that stand for the lobe of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookUp {
    /// Where it looks, unit length.
    pub direction: Vec3,
    /// What roughness it reads.
    pub roughness: Roughness,
}

/// Mip and layer of filtered roughness `index`, 0 for the least.
fn environment_place(environment: &Environment, index: f32) -> [u32; 2] {
    let per_size = environment.uniform.per_size;
    let mip = ((index + 0.5) / per_size).floor();
    [mip as u32, (index - mip * per_size) as u32]
}

/// Where roughness α is read: the inverse of what the bake gives each roughness.
pub fn environment_roughness(environment: &Environment, alpha: f32) -> Roughness {
    let uniform = &environment.uniform;
    let last = uniform.roughnesses - 1.0;
    let rough = 1.0 - alpha.clamp(uniform.first_alpha, 1.0).log2() * uniform.inverse_log;
    let index = (last * rough * (1.0 + uniform.bend * (1.0 - rough))).clamp(0.0, last);
    let low = index.floor();
    let colours = (index - (0.5 * uniform.per_size).floor()) / uniform.per_size;
    Roughness {
        low: environment_place(environment, low),
        high: environment_place(environment, (low + 1.0).min(last)),
        share: index - low,
        mirror: 1.0 - (alpha / uniform.first_alpha).clamp(0.0, 1.0),
        colour_mip: colours.clamp(0.0, uniform.roughnesses / uniform.per_size - 1.0),
    }
}

/// Filtered radiance of a roughness around a direction, without the mirror: R, G, B and root mean square luminance.
pub fn environment_filtered(environment: &Environment, direction: Vec3, roughness: &Roughness) -> [f32; 4] {
    let ([low_mip, low_layer], [high_mip, high_layer]) = (roughness.low, roughness.high);
    let low = radiance_at(environment, low_layer, direction, low_mip);
    let high = radiance_at(environment, high_layer, direction, high_mip);
    [0, 1, 2, 3].map(|c| (1.0 - roughness.share) * low[c] + roughness.share * high[c])
}

/// Radiance of a roughness around a direction, linear RGB; `filtered` is that of [`environment_filtered`].
pub fn environment_radiance(
    environment: &Environment,
    direction: Vec3,
    roughness: &Roughness,
    filtered: [f32; 3],
) -> [f32; 3] {
    let mirror = mirror_at(environment, direction);
    [0, 1, 2].map(|c| (1.0 - roughness.mirror) * filtered[c] + roughness.mirror * mirror[c])
}

/// Layer `layer` of the table by view cosine and roughness.
pub fn environment_table(environment: &Environment, layer: u32, surface: &Surface) -> [f32; 4] {
    let cos_o = surface.normal.dot(surface.view);
    albedo_at(environment, layer, [cos_o.clamp(0.0, 1.0), surface.alpha.clamp(0.0, 1.0).sqrt()])
}

/// A look-up of shift κ and a ratio of roughnesses: in the plane of incidence, κ above 0 towards the normal.
pub fn environment_look_up(environment: &Environment, surface: &Surface, shift: f32, ratio: f32) -> LookUp {
    let cos_o = surface.normal.dot(surface.view);
    let mirror = 2.0 * cos_o * surface.normal - surface.view;
    let direction = (mirror + shift * surface.alpha * (surface.normal - cos_o * mirror)).normalize();
    LookUp { direction, roughness: environment_roughness(environment, ratio * surface.alpha) }
}

/// Filtered radiance of the look-ups of a surface, of which `first` is the first: R, G, B and mean square luminance.
pub fn environment_lobe(environment: &Environment, surface: &Surface, first: &LookUp) -> [f32; 4] {
    let squared = |[r, g, b, root]: [f32; 4]| [r, g, b, root * root];
    let alone = squared(environment_filtered(environment, first.direction, &first.roughness));
    let mut sum = alone;
    for layer in 2..=environment.uniform.look_ups {
        let [shift, ratio, share, _] = environment_table(environment, layer, surface);
        let look_up = environment_look_up(environment, surface, shift, ratio);
        let filtered = squared(environment_filtered(environment, look_up.direction, &look_up.roughness));
        (0..4).for_each(|c| sum[c] += share * (filtered[c] - alone[c]));
    }
    // Rounding may leave a little less than nothing of the first.
    sum.map(|c| c.max(0.0))
}

/// Image-based light without glints: the smooth reflection (Eq. 11), linear RGB.
pub fn environment_smooth(environment: &Environment, surface: &Surface) -> [f32; 3] {
    let [scale, bias, shift, ratio] = environment_table(environment, 0, surface);
    let first = environment_look_up(environment, surface, shift, ratio);
    let [r, g, b, _] = environment_lobe(environment, surface, &first);
    let radiance = environment_radiance(environment, first.direction, &first.roughness, [r, g, b]);
    radiance.map(|c| (surface.f0 * scale + bias) * c)
}

/// Sum of a list over the first `count` levels.
fn levels_sum(levels: &[f32; MAX_LEVELS], count: usize) -> f32 {
    levels[..count].iter().sum()
}

/// Sum of the products of two lists over the first `count` levels.
fn levels_dot(x: &[f32; MAX_LEVELS], y: &[f32; MAX_LEVELS], count: usize) -> f32 {
    x[..count].iter().zip(y).map(|(x, y)| x * y).sum()
}

/// Shares of levels 4 `layer` + 1 to 4 `layer` + 4 of a roughness around a direction; of the least filtered one below it.
fn environment_indicators(environment: &Environment, layer: u32, direction: Vec3, roughness: &Roughness) -> [f32; 4] {
    let layers = environment.params.indicator_layers();
    let ([low_mip, low_layer], [high_mip, high_layer]) = (roughness.low, roughness.high);
    let low = indicators_at(environment, low_layer * layers + layer, direction, low_mip);
    let high = indicators_at(environment, high_layer * layers + layer, direction, high_mip);
    [0, 1, 2, 3].map(|c| (1.0 - roughness.share) * low[c] + roughness.share * high[c])
}

/// Probabilities that a facet reflects each level around a direction (Eq. 15 and 21), with `visible` the share of facets that reflect at
/// all. Level 0 also takes the facets that reflect nothing.
pub fn level_probabilities(
    environment: &Environment,
    direction: Vec3,
    roughness: &Roughness,
    visible: f32,
) -> [f32; MAX_LEVELS] {
    let count = environment.params.levels.len();
    let mut p = [0.0; MAX_LEVELS];
    if count == 1 {
        p[0] = visible;
        return p;
    }
    // Component c of layer l is level 4 l + c + 1, so lists are shifted by one.
    for layer in 0..environment.params.indicator_layers() {
        let indicators = environment_indicators(environment, layer, direction, roughness);
        for (p, indicator) in p[..count].iter_mut().skip(4 * layer as usize + 1).zip(indicators) {
            *p = indicator * visible;
        }
    }
    p[0] = (1.0 - levels_sum(&p, count)).max(0.0);
    p
}

/// Probabilities that a facet reflects each level by all look-ups of a surface, of which `first` is the first.
pub fn lobe_probabilities(
    environment: &Environment,
    surface: &Surface,
    first: &LookUp,
    visible: f32,
) -> [f32; MAX_LEVELS] {
    let alone = level_probabilities(environment, first.direction, &first.roughness, visible);
    let mut p = alone;
    for layer in 2..=environment.uniform.look_ups {
        let [shift, ratio, share, _] = environment_table(environment, layer, surface);
        let look_up = environment_look_up(environment, surface, shift, ratio);
        let other = level_probabilities(environment, look_up.direction, &look_up.roughness, visible);
        for ((p, alone), other) in p.iter_mut().zip(alone).zip(other) {
            *p += share * (other - alone);
        }
    }
    p.map(|p| p.max(0.0))
}

/// Share of facets that all reflect alike and have the mean and the mean square of those that there are, 0 to 1; `areas` and `squares` are
/// the first two layers of the table.
pub fn visible_share(areas: [f32; 4], squares: [f32; 4], f0: f32) -> f32 {
    let [scaled, bias] = [f0 * areas[0], areas[1]];
    let x = scaled / (scaled + bias).max(1e-37);
    let y = 1.0 - x;
    1.0 / (squares[0] * x * x + 2.0 * squares[1] * x * y + squares[2] * y * y).max(1.0)
}

/// Mean and second moment of what one facet reflects.
pub fn facet_moments(environment: &Environment, p: &[f32; MAX_LEVELS]) -> [f32; 2] {
    let level = &environment.uniform.level;
    let light = std::array::from_fn(|k| p[k] * level[k]);
    let count = environment.params.levels.len();
    [levels_sum(&light, count), levels_dot(&light, level, count)]
}

/// Factor s for which n/N + s (X − n/N) has the variance that the unsorted facets have, n of N expected facets being
/// there, X = Σ L_k M_k / (N Σ L_k p_k): `square` is ⟨L²⟩ as filtered, `moments` those of the levels. At most 1: levels never vary too little.
pub fn std_factor(moments: [f32; 2], square: f32, visible: f32) -> f32 {
    let mean2 = moments[0] * moments[0];
    let of_levels = moments[1] - mean2;
    if of_levels > 0.0 { ((visible * square - mean2) / of_levels).clamp(0.0, 1.0).sqrt() } else { 1.0 }
}

/// The smooth reflection and the chances of the levels at a surface point.
pub fn chances(environment: &Environment, surface: &Surface) -> Chances {
    let areas = environment_table(environment, 0, surface);
    let [scale, bias, shift, ratio] = areas;
    let first = environment_look_up(environment, surface, shift, ratio);
    let [r, g, b, square] = environment_lobe(environment, surface, &first);
    let radiance = environment_radiance(environment, first.direction, &first.roughness, [r, g, b]);
    let visible = visible_share(areas, environment_table(environment, 1, surface), surface.f0);
    let p = lobe_probabilities(environment, surface, &first, visible);
    let moments = facet_moments(environment, &p);
    // Levels are filtered, so the moment beside them is that of what is filtered.
    let std_factor = std_factor(moments, square, visible);
    let smooth_radiance = radiance.map(|c| (surface.f0 * scale + bias) * c);
    let LookUp { direction, roughness } = first;
    Chances { smooth_radiance, p, moments, std_factor, towards: direction, colour_mip: roughness.colour_mip }
}

/// Drawn over expected light, channel by channel.
fn coloured_ratios(environment: &Environment, chances: &Chances, facets: f32, counts: &[f32; MAX_LEVELS]) -> [f32; 3] {
    let (mut drawn, mut expected) = ([0.0; 3], [0.0; 3]);
    for k in 1..environment.params.levels.len() {
        let colour = colour_at(environment, k as u32 - 1, chances.towards, chances.colour_mip)
            .map(|c| c * environment.uniform.level[k]);
        for c in 0..3 {
            drawn[c] += colour[c] * counts[k];
            expected[c] += colour[c] * (chances.p[k] * facets);
        }
    }
    [0, 1, 2].map(|c| if expected[c] > 0.0 { drawn[c] / expected[c] } else { 1.0 })
}

/// Radiance towards the eye of one draw of facets (Eq. 17), linear RGB, of chances that [`chances`] has found; `words` are the random
/// words of the pixel, see [`multinomial`].
pub fn environment_draw(
    environment: &Environment,
    chances: &Chances,
    facets: f32,
    words: &[f32; MAX_LEVELS],
) -> [f32; 3] {
    // Without light or facets there is nothing to draw.
    if !(chances.moments[0] > 0.0 && facets > 0.0) {
        return if facets > 0.0 { chances.smooth_radiance } else { [0.0; 3] };
    }
    let levels = environment.params.levels.len();
    let mut p = chances.p;
    if levels == 1 {
        // A single level needs a second one for the facets that reflect nothing.
        p[1] = 1.0 - p[0];
    }
    let counts = multinomial(facets, &p, levels.max(2), words).map(count_value);
    let share = 1.0 / (facets * chances.moments[0]);
    let there = levels_sum(&counts, levels.max(2)) * chances.moments[0] * share;
    let ratios = if environment.params.coloured {
        coloured_ratios(environment, chances, facets, &counts)
    } else {
        [levels_dot(&environment.uniform.level, &counts, levels) * share; 3]
    };
    let drawn = ratios.map(|ratio| (there + chances.std_factor * (ratio - there)).max(0.0));
    [0, 1, 2].map(|c| chances.smooth_radiance[c] * drawn[c])
}

/// Radiance towards the eye of one draw of facets, linear RGB; `words` are the random words of the pixel, see [`multinomial`].
pub fn environment_glints(environment: &Environment, surface: &Surface, words: &[f32; MAX_LEVELS]) -> [f32; 3] {
    environment_draw(environment, &chances(environment, surface), surface.facets, words)
}
