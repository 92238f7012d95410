//! A surface of counted facets under suns, points, rectangles and skies, f32; twin: `eval.wgsl`.
//!
//! Paper: Kneiphof and Klein 2025, Eq. 7 to 9 and 17: of N facets under a pixel a number n reflects a light, with the chance
//! p = ∫ D(h) / (4 h·ω) dω / D_H over the light's directions each, and the light's smooth reflection is multiplied by n / (N p). What of it is
//! our own:
//! - One cell of the surface is found for a pixel ([`counted_surface`]); every light draws from it. A light's word depends on the direction
//!   in which facets would have to lie, in cells as wide as the light ([`light_place`]): lights that lie together take the same facets,
//!   lights apart take others, and turning the light or the eye makes facets come and go as explicit ones do.
//! - Facets reflect a cone, not a line ([`CountedMaterial::facet_spread`]): a light without extent is as wide as that cone, so its
//!   facets are few and bright but never so few that none is seen. Extents add up as squares.
//! - Four small lights are drawn at a time, as four nodes of [`binomial`](crate::counting::binomial()) in a shader are.
//! - A rectangle that is small beside the lobe has the chance of a cone. That of a wide one is its share of the linearly transformed cosine
//!   that stands for GGX's lobe, with masking taken back at its middle: facets reflect what is masked, too. On Beckmann surfaces, whose lobes the tables
//!   do not hold, every rectangle has the chance of a cone.
//! - Lights are drawn one by one, a sky's levels together. Facets of two lights in one cell of directions are the same; others are drawn
//!   as if a facet could reflect both, which the paper's multinomial forbids: the covariance that is left out is −N p q for chances p and q.
//! - Facets may have colours of a palette ([`facet_colour`]), and share the surface with a smooth part ([`CountedMaterial::relative_area`]).

use super::layers::{Layers, coat_through, cone_layers, rect_layers};
use crate::area_light::baked::Tables;
use crate::area_light::rect::{RectLight, Roughness, faces, lobe_light, rect_solid_angle};
use crate::brdf::{fresnel, half_vector};
use crate::counting::eval::{Count, MAX_LEVELS, count_value, unit_from_bits, whole_binomial, whole_count};
use crate::counting::query::{
    angle_state, cell_bits, cell_words, facet_cell, footprint_area, footprint_box, footprint_facets,
};
use crate::hash::CellState;
use crate::microfacet::{
    GGX, SmoothSurface, microfacet_lambda, microfacet_masked, microfacet_ndf, microfacet_under_cone,
};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// Draw of a cell's whole number of facets.
const WHOLE_DRAW: u32 = 0;
/// Draw of a light's count, from the state of the cell towards the light.
const COUNT_DRAW: u32 = 1;
/// Draw of the colour of a light's facets.
const COLOUR_DRAW: u32 = 2;
/// Least expected count: less counts as none.
const LEAST_EXPECTED: f32 = 1e-37;
/// Least cosine of a direction and the half vector.
const LEAST_COSINE: f32 = 1e-4;
/// Widest cone of a light, in steradians: a hemisphere.
const WIDEST: f32 = 2.0 * PI;
/// From where to where the chance of a rectangle goes over from that of a cone to its share of the lobe, by solid angles over the lobe's.
const WIDE_RECT: [f32; 2] = [0.06, 0.15];
/// Least part of that share that is a chance: where a lobe without tails is all but 0, the tables' lobe has tails.
const LEAST_SHARE: f32 = 0.05;

/// A material of counted facets. Roughness, density and turn may differ from pixel to pixel; `facet_area` goes with the roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CountedMaterial {
    /// Reflectance at normal incidence, linear RGB.
    pub f0: Vec3,
    /// [`BECKMANN`](crate::microfacet::BECKMANN) or [`GGX`](crate::microfacet::GGX).
    pub normal_target: u32,
    /// Roughness α along both axes, 1e-3 to 1.
    pub alpha: Vec2,
    /// Cosine and sine of the angle from the tangent to the first axis of roughness.
    pub turn: Vec2,
    /// Mean of the facets' colours, linear RGB; white where there are none.
    pub mean_colour: Vec3,
    /// Number of colours; 0 means white.
    pub colours: u32,
    /// Facets on one surface unit squared of what glints.
    pub density: f32,
    /// Share of the surface that glints, 0 to 1; the rest is smooth.
    pub relative_area: f32,
    /// Whole facet area over surface area, [`microfacet_area`](crate::microfacet::microfacet_area).
    pub facet_area: f32,
    /// Half angle of the cone that a facet reflects a point into, in radians, above 0.
    pub facet_spread: f32,
    /// By how much the eye turns, in radians, until facets under a sky are others; 0 for never.
    pub sky_spread: f32,
    /// Surfaces with different seeds have different glints.
    pub seed: u32,
    /// What facets lie on and under.
    pub layers: Layers,
}

/// A pixel of a material: its facets, in the frame of the roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CountedSurface {
    /// The material.
    pub material: CountedMaterial,
    /// Expected number of facets under the pixel.
    pub facets: f32,
    /// That made whole.
    pub whole: f32,
    /// The cell that they come from.
    pub cell: CellState,
    /// Unit direction to the eye in the frame of the roughness.
    pub view: Vec3,
}

/// A light that is a small cone as seen from the surface: a sun, or a sphere far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeLight {
    /// Unit direction towards it in the tangent frame.
    pub direction: Vec3,
    /// Irradiance of a surface that faces it, linear RGB.
    pub irradiance: Vec3,
    /// Solid angle, in steradians; 0 for lights without extent.
    pub solid_angle_sr: f32,
}

/// What one light does: the smooth reflection of facets, what other layers add, and the chance and the random state of its facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetLight {
    /// Radiance of the smooth surface that facets converge to, through the coat, linear RGB.
    pub radiance: Vec3,
    /// Chance that a facet reflects the light.
    pub chance: f32,
    /// Radiance of what is scattered below the facets and of the coat, linear RGB.
    pub beside: Vec3,
    /// State of the cell towards the light.
    pub state: CellState,
}

/// No light at all: what stands for the lights that are missing to four.
pub fn no_light() -> FacetLight {
    FacetLight { radiance: Vec3::ZERO, chance: 0.0, beside: Vec3::ZERO, state: CellState { a: 0, b: 0 } }
}

/// The smooth surface that a material's facets converge to.
pub(super) fn smooth_surface(material: CountedMaterial) -> SmoothSurface {
    SmoothSurface { alpha2: material.alpha * material.alpha, normal_target: material.normal_target }
}

/// From the tangent frame to that of the roughness.
pub(super) fn turned(turn: Vec2, v: Vec3) -> Vec3 {
    Vec3::new(turn.x * v.x + turn.y * v.y, turn.x * v.y - turn.y * v.x, v.z)
}

/// The facets of the pixel at `position` (surface units) whose derivatives along the screen's axes are `d_dx` and `d_dy`, seen from the
/// unit direction `view` (tangent frame).
pub fn counted_surface(
    material: CountedMaterial,
    position: Vec2,
    d_dx: Vec2,
    d_dy: Vec2,
    view: Vec3,
) -> CountedSurface {
    let area = footprint_area(d_dx, d_dy);
    let facets = footprint_facets(area, material.density * material.relative_area);
    let cell = facet_cell(footprint_box(d_dx, d_dy), position, material.seed);
    let whole = whole_count(facets, unit_from_bits(cell_bits(cell, WHOLE_DRAW)));
    CountedSurface { material, facets, whole, cell, view: turned(material.turn, view) }
}

/// Solid angle of a light as facets see it that reflect cones themselves, at most a hemisphere.
fn seen_solid_angle(material: CountedMaterial, solid_angle: f32) -> f32 {
    (solid_angle + PI * material.facet_spread * material.facet_spread).min(WIDEST)
}

/// Place, in cells as wide as a light of `solid_angle`, of the normal `half` that facets need to reflect it.
///
/// A cone of half angle γ is reflected by normals in an ellipse: γ along the plane of incidence and γ / h·o across, in diameter. Places
/// across are shortened by h·o, which makes it a disk; cells are squares of the disk's area, which overlap as disks do within a tenth.
pub fn light_place(view: Vec3, half: Vec3, solid_angle: f32) -> Vec2 {
    let flat = Vec2::new(view.x, view.y);
    // The same quotient as in `microfacet_under_cone`.
    let inverse = 1.0 / flat.dot(flat).max(1e-12);
    let across = Vec2::new(-flat.y, flat.x);
    let normal = Vec2::new(half.x, half.y);
    let shortened = normal - across * ((1.0 - view.dot(half)) * across.dot(normal) * inverse);
    shortened * (2.0 / solid_angle.sqrt())
}

/// A small cone on the surface.
pub fn cone_light(surface: CountedSurface, light: ConeLight) -> FacetLight {
    let material = surface.material;
    let smooth_surface = smooth_surface(material);
    let direction = turned(material.turn, light.direction);
    let half = half_vector(surface.view, direction);
    let solid_angle = seen_solid_angle(material, light.solid_angle_sr);
    let cos_h = surface.view.dot(half);
    let seen = microfacet_under_cone(smooth_surface, surface.view, solid_angle, cos_h);
    let density = microfacet_ndf(seen, half);
    // Eq. 9.
    let chance = density * solid_angle / (4.0 * cos_h.max(LEAST_COSINE) * material.facet_area);
    let reflected = density * microfacet_masked(seen, surface.view, direction);
    let through = coat_through(material.layers, surface.view.z);
    let beside = cone_layers(material.layers, material.f0, surface.view, direction, light.solid_angle_sr);
    FacetLight {
        radiance: fresnel(material.f0, cos_h) * light.irradiance * (reflected * through),
        chance: chance.min(1.0),
        beside: beside * light.irradiance,
        state: angle_state(surface.cell, light_place(surface.view, half, solid_angle)),
    }
}

/// A rectangle on the surface, `light` in the tangent frame.
pub fn rect_facets(tables: &Tables, surface: CountedSurface, light: &RectLight) -> FacetLight {
    let material = surface.material;
    let alpha = material.alpha;
    let corners = light.corners.map(|corner| turned(material.turn, corner));
    let rect = RectLight { corners, ..*light };
    let swapped = alpha.y > alpha.x;
    let axis = if swapped { Vec2::Y } else { Vec2::X };
    let lobe = Roughness { major: alpha.max_element(), minor: alpha.min_element(), axis };
    let found = lobe_light(tables, Vec3::Z, lobe, surface.view, &rect);
    let form_factor = if faces(&rect) { found.form_factor } else { 0.0 };
    let [a, b, c, d] = rect.corners;
    let middle = (a + b + c + d) * 0.25;
    let direction = middle / middle.dot(middle).max(1e-20).sqrt();
    let half = half_vector(surface.view, direction);
    let solid_angle = seen_solid_angle(material, rect_solid_angle(&rect));
    let place = light_place(surface.view, half, solid_angle);
    let reflectance = material.f0 * found.terms.x + (Vec3::ONE - material.f0) * found.terms.y;
    // From what reaches the eye to what facets reflect: masking and the view's cosine, at the rectangle's middle.
    let smooth_surface = smooth_surface(material);
    let masked = 1.0 + microfacet_lambda(smooth_surface, surface.view) + microfacet_lambda(smooth_surface, direction);
    let cos_h = surface.view.dot(half).max(LEAST_COSINE);
    let facets = found.terms.x * surface.view.z.max(LEAST_COSINE) * masked / (cos_h * material.facet_area);
    let share = form_factor * facets;
    // As a cone.
    let seen = microfacet_under_cone(smooth_surface, surface.view, solid_angle, cos_h);
    let cone = microfacet_ndf(seen, half) * solid_angle / (4.0 * cos_h * material.facet_area);
    let chance = if material.normal_target == GGX {
        let width = solid_angle / (4.0 * PI * alpha.x * alpha.y);
        let wide = ((width - WIDE_RECT[0]) / (WIDE_RECT[1] - WIDE_RECT[0])).clamp(0.0, 1.0);
        cone + (share - cone) * wide
    } else {
        cone.max(LEAST_SHARE * share)
    };
    FacetLight {
        radiance: reflectance * (form_factor * light.radiance * coat_through(material.layers, surface.view.z)),
        chance: chance.min(1.0),
        beside: rect_layers(tables, material.layers, material.f0, surface.view, &rect),
        state: angle_state(surface.cell, place),
    }
}

/// Hits of four lights over their expected number; of a light that no facet can reflect, 0.
pub fn hit_ratios(surface: CountedSurface, lights: [FacetLight; 4]) -> [f32; 4] {
    lights.map(|light| {
        let bits = cell_bits(light.state, COUNT_DRAW);
        let whole = Count { high: surface.whole, low: 0.0 };
        let [hits, _] =
            whole_binomial(whole, light.chance, 1.0 - light.chance, unit_from_bits(bits), unit_from_bits(!bits));
        count_value(hits) / (surface.facets * light.chance).max(LEAST_EXPECTED)
    })
}

/// Colour of `hits` facets, of `colours` by their index: one facet has one of them, many have nearly the mean.
pub fn facet_colour(material: CountedMaterial, colours: &[Vec3], state: CellState, hits: f32) -> Vec3 {
    if material.colours == 0 {
        return Vec3::ONE;
    }
    let index = ((cell_bits(state, COLOUR_DRAW) >> 16) * material.colours) >> 16;
    material.mean_colour + (colours[index as usize] - material.mean_colour) / hits.max(1.0).sqrt()
}

/// Radiance of a light, linear RGB: of the facets, `ratio` times what is expected of them, of the smooth part, and of other layers.
fn facet_radiance(surface: CountedSurface, colours: &[Vec3], light: FacetLight, ratio: f32) -> Vec3 {
    let share = surface.material.relative_area;
    let colour = facet_colour(surface.material, colours, light.state, ratio * (surface.facets * light.chance));
    light.radiance * (colour * (share * ratio) + (1.0 - share)) + light.beside
}

/// Radiance towards the eye from up to four lights, linear RGB.
pub fn four_lights(surface: CountedSurface, colours: &[Vec3], lights: [FacetLight; 4]) -> Vec3 {
    let ratios = hit_ratios(surface, lights);
    (0..4).map(|k| facet_radiance(surface, colours, lights[k], ratios[k])).sum()
}

/// Radiance of the mean over seeds, linear RGB, where the smooth reflection is `radiance`: what facets converge to.
pub fn mean_radiance(material: CountedMaterial, radiance: Vec3) -> Vec3 {
    radiance * (material.mean_colour * material.relative_area + (1.0 - material.relative_area))
}

/// State of the cell towards the sky.
fn sky_state(surface: CountedSurface) -> CellState {
    let spread = surface.material.sky_spread;
    // Normals turn half as much as the eye.
    let scale = if spread > 0.0 { 0.5 / spread } else { 0.0 };
    angle_state(surface.cell, Vec2::new(surface.view.x, surface.view.y) * scale)
}

/// Radiance of a sky, linear RGB: `drawn` of its facets, `smooth_radiance` without any, and the first two moments of what a facet reflects, see
/// [`Chances`](crate::environment::eval::Chances). The facets of its draw are as many as those of one level with these moments. Other
/// layers add [`sky_layers`](super::layers::sky_layers).
pub fn sky_radiance(
    surface: CountedSurface,
    colours: &[Vec3],
    drawn: Vec3,
    smooth_radiance: Vec3,
    moments: [f32; 2],
) -> Vec3 {
    let share = surface.material.relative_area;
    let hits = surface.facets * moments[0] * moments[0] / moments[1].max(LEAST_EXPECTED);
    let colour = facet_colour(surface.material, colours, sky_state(surface), hits);
    (drawn * colour * share + smooth_radiance * (1.0 - share)) * coat_through(surface.material.layers, surface.view.z)
}

/// The words of a draw under a sky, of a tree with `leaves` leaves: word 0 is that of the whole number of facets, which all lights share.
pub fn sky_words(surface: CountedSurface, leaves: usize) -> [f32; MAX_LEVELS] {
    let mut words = cell_words(sky_state(surface), leaves);
    words[0] = unit_from_bits(cell_bits(surface.cell, WHOLE_DRAW));
    words
}
