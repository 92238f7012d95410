//! The microfacet BRDF with D from the pack, in one or two layers.
//!
//! f = F D G / (4 (n·l)(n·v)), D(h) the density of the projected half vector, G the V-cavity masking
//! min(1, 2 (n·h)(n·v)/(v·h), 2 (n·h)(n·l)/(v·h)), F Schlick's approximation. Two layers after Xing et al. 2024, Eq. 3:
//! f = f_base (1 − F_coat) + f_coat.

use glam::{Vec2, Vec3};
use glint_bake_core::footprint::Footprint;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::eval::{EvalSettings, matrix};
use glint_formats::ndf_maps::TransformRecord;

/// Mean density of a placed example below which nothing is looked up: even its rare glints would be faint.
const FAINT: f32 = 0.004;

/// One layer: a material and its reflectance at normal incidence.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// NDF maps and placement.
    pub material: &'a Material,
    /// Reflectance at normal incidence, linear RGB.
    pub f0: Vec3,
}

/// What an object is made of.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// The only layer, or the lower one.
    pub base: Layer<'a>,
    /// The clear coat.
    pub coat: Option<Layer<'a>>,
    /// Surface texels in a unit of length.
    pub texels_per_unit: f32,
}

/// Directions of a reflection in tangent space: +X along u, +Y against v, +Z the normal.
#[derive(Clone, Copy, Debug)]
pub struct Geometry {
    /// Half vector.
    pub half: Vec3,
    /// n·l.
    pub n_l: f32,
    /// n·v.
    pub n_v: f32,
    /// v·h.
    pub v_h: f32,
}

impl Surface<'_> {
    /// f · (n·l) for light from one direction.
    pub fn reflect(&self, footprint: &Footprint, geometry: &Geometry) -> Vec3 {
        let base = self.base.reflect(footprint, geometry);
        match &self.coat {
            None => base,
            Some(coat) => {
                let through = Vec3::ONE - schlick(coat.f0, geometry.v_h);
                base * through + coat.reflect(footprint, geometry)
            }
        }
    }

    /// Share of light from all around that is reflected toward n·v, as by a mirror.
    pub fn ambient(&self, n_v: f32) -> Vec3 {
        let base = schlick(self.base.f0, n_v);
        match &self.coat {
            None => base,
            Some(coat) => {
                let coat = schlick(coat.f0, n_v);
                base * (Vec3::ONE - coat) + coat
            }
        }
    }
}

impl Layer<'_> {
    /// Whether any placed example has normals near `s`: what the node of the whole example lacks, no part of it has.
    /// Most of a picture lies outside the highlight and is done with here.
    fn reaches(&self, s: Vec2) -> bool {
        let Material { maps, placement } = self.material;
        let Some(top) = maps.params.levels.last() else { return false };
        let seen = |transform: &TransformRecord| {
            maps.node_density(top.first_node, matrix(transform.normal_to_local) * s) > FAINT
        };
        placement.palette.iter().any(seen)
    }

    fn reflect(&self, footprint: &Footprint, g: &Geometry) -> Vec3 {
        let s = Vec2::new(g.half.x, g.half.y);
        if !self.reaches(s) {
            return Vec3::ZERO;
        }
        let terms = self.material.gather(footprint, EvalSettings::REAL_TIME);
        let density = self.material.density(&terms, s);
        let n_h = g.half.z;
        let masking = (2.0 * n_h * g.n_v / g.v_h).min(2.0 * n_h * g.n_l / g.v_h).min(1.0);
        schlick(self.f0, g.v_h) * (density * masking / (4.0 * g.n_v))
    }
}

fn schlick(f0: Vec3, cosine: f32) -> Vec3 {
    let x = (1.0 - cosine).clamp(0.0, 1.0);
    f0 + (Vec3::ONE - f0) * (x * x * x * x * x)
}
