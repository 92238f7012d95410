//! Evaluation of NDF maps in f32, as `eval.wgsl` does it: one node, one patch, and the sum of a footprint's terms.
//!
//! Xing et al. 2024, section 6.3: the P-NDF is a sum of the NDFs under the footprint, here of nodes; below the finest windows, of
//! the map's bilinear patches, which are the example's normals as they are.

use super::baked::{BakedNdfMaps, Material};
use super::ellipse::Ellipse;
use crate::erf::erf;
use glam::{IVec2, Mat2, UVec2, Vec2, Vec3, Vec4};

/// Choice between speed and accuracy at run time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvalSettings {
    /// A footprint's major axis in minor ones at most; longer ones are seen as wide as that.
    pub max_ratio: f32,
    /// Patches of the map lie within this many standard deviations of the footprint's centre: 4 % of its mass is beyond 2.5, 3e-4 beyond 4.
    pub reach: f32,
}

impl EvalSettings {
    /// What accuracy is measured with.
    pub const ACCURATE: EvalSettings = EvalSettings { max_ratio: 16.0, reach: 4.0 };
    /// What pictures are drawn with.
    pub const REAL_TIME: EvalSettings = EvalSettings { max_ratio: 4.0, reach: 2.5 };
}

impl Default for EvalSettings {
    fn default() -> EvalSettings {
        EvalSettings::ACCURATE
    }
}

/// A node's share of a footprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeTerm {
    /// Index of the node.
    pub node: u32,
    /// Palette entry of the example that shows it.
    pub class: u32,
    /// Share of the footprint times |det normal_to_local|.
    pub weight: f32,
}

/// A bilinear patch of the map, the square between four texel centres, under a footprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchTerm {
    /// Palette entry of the example that shows it.
    pub class: u32,
    /// Normals of its corners (00, 10, 01, 11).
    pub corners: [Vec2; 4],
    /// The footprint, its centre in texels from corner 00.
    pub footprint: Ellipse,
    /// Share that the footprint has of what is seen, times |det normal_to_local|.
    pub weight: f32,
}

/// Everything a footprint sees; shares sum to 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Terms {
    /// Nodes.
    pub nodes: Vec<NodeTerm>,
    /// Patches.
    pub patches: Vec<PatchTerm>,
}

impl Terms {
    /// Number of nodes and patches.
    pub fn len(&self) -> usize {
        self.nodes.len() + self.patches.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Row-major matrix of the pack.
pub fn matrix(rows: [f32; 4]) -> Mat2 {
    Mat2::from_cols(Vec2::new(rows[0], rows[2]), Vec2::new(rows[1], rows[3]))
}

impl Material {
    /// P-NDF at the projected normal `s` for the terms of a footprint: density over the disk, 0 outside it.
    pub fn density(&self, terms: &Terms, s: Vec2) -> f32 {
        if s.length_squared() > 1.0 {
            return 0.0;
        }
        let mut sum = 0.0;
        for term in &terms.nodes {
            let to_local = matrix(self.placement.palette[term.class as usize].normal_to_local);
            sum += term.weight * self.maps.node_density(term.node, to_local * s);
        }
        for term in &terms.patches {
            let to_local = matrix(self.placement.palette[term.class as usize].normal_to_local);
            sum += term.weight * self.maps.patch_density(term, to_local * s);
        }
        // Of what owners show the whole example may be taken off.
        sum.max(0.0)
    }
}

impl BakedNdfMaps {
    /// Roots of four texels of the atlas: `at`, that to the right, and the two below them.
    fn roots(&self, at: UVec2) -> Vec4 {
        let width = self.atlas_size[0] as usize;
        let first = at.y as usize * width + at.x as usize;
        let root = |k: usize| f32::from(self.atlas[k]) / 255.0;
        Vec4::new(root(first), root(first + 1), root(first + width), root(first + width + 1))
    }

    /// Density of one node at the example's projected normal `s`: the square of roots that are bilinear between texels, 0 outside the
    /// table and outside the disk.
    pub fn node_density(&self, node: u32, s: Vec2) -> f32 {
        if s.length_squared() > 1.0 {
            return 0.0;
        }
        let record = &self.nodes[node as usize];
        let steps = glint_formats::ndf_maps::STEPS_PER_ROUGHNESS / self.params.intrinsic_roughness;
        let away = (s + 1.0) * steps - UVec2::from(record.origin()).as_vec2();
        let p = away / UVec2::from(record.spacing()).as_vec2();
        let size = UVec2::from(record.size()).as_vec2();
        if !(p.cmpgt(Vec2::NEG_ONE).all() && p.cmplt(size).all()) {
            return 0.0;
        }
        let cell = p.floor();
        let f = p - cell;
        let corner = UVec2::from(record.place()).as_vec2() + cell;
        let roots = self.roots(corner.as_uvec2());
        let top = roots.x + (roots.y - roots.x) * f.x;
        let bottom = roots.z + (roots.w - roots.z) * f.x;
        let root = top + (bottom - top) * f.y;
        record.scale * root * root
    }

    /// Normals of the corners of the patch whose corner 11 is texel `at` of the example, which repeats.
    pub(super) fn patch(&self, at: IVec2) -> [Vec2; 4] {
        let (width, height) = (self.params.width as i32, self.params.height as i32);
        let normal = |i: i32, j: i32| {
            let [x, y] = self.normals[(j.rem_euclid(height) * width + i.rem_euclid(width)) as usize];
            Vec2::new(f32::from(x), f32::from(y)) / 32767.0
        };
        [normal(at.x - 1, at.y - 1), normal(at.x, at.y - 1), normal(at.x - 1, at.y), normal(at.x, at.y)]
    }

    /// Density at the example's projected normal `s` of a patch under a footprint: the integral over the patch of the footprint times the
    /// lobes of its normals. One that is twisted is divided in squares.
    pub fn patch_density(&self, term: &PatchTerm, s: Vec2) -> f32 {
        let sigma = self.params.intrinsic_roughness;
        if s.length_squared() > 1.0 || !square_reaches(term.corners, sigma, s) {
            return 0.0;
        }
        let [s00, s10, s01, s11] = term.corners;
        let twist = (s11 - s10 - s01 + s00).length();
        let parts = (twist / (TWIST * sigma)).sqrt().ceil().clamp(1.0, MOST_PARTS);
        let e = &term.footprint;
        let at = |x: f32, y: f32| bilinear(term.corners, Vec2::new(x, y) / parts);
        let mut sum = 0.0;
        let mut square = Vec2::ZERO;
        while square.y < parts {
            let Vec2 { x, y } = square;
            let corners = [at(x, y), at(x + 1.0, y), at(x, y + 1.0), at(x + 1.0, y + 1.0)];
            if square_reaches(corners, sigma, s) {
                let mean = e.mean * parts - square;
                let seen = Ellipse { mean, axis: e.axis, major: e.major * parts, minor: e.minor * parts };
                sum += square_density(corners, &seen, sigma, s);
            }
            square = if x + 1.0 < parts { Vec2::new(x + 1.0, y) } else { Vec2::new(0.0, y + 1.0) };
        }
        sum
    }
}

/// Bilinear between four corners (00, 10, 01, 11).
pub(super) fn bilinear([s00, s10, s01, s11]: [Vec2; 4], at: Vec2) -> Vec2 {
    s00.lerp(s10, at.x).lerp(s01.lerp(s11, at.x), at.y)
}

/// Squares of a patch depart from a parallelogram by no more than this many σ_r at a corner.
const TWIST: f32 = 2.0;
/// Squares along an edge of a patch at most.
const MOST_PARTS: f32 = 4.0;

/// Whether lobes of normals between four corners reach `s`.
fn square_reaches([s00, s10, s01, s11]: [Vec2; 4], sigma: f32, s: Vec2) -> bool {
    let low = s00.min(s10).min(s01.min(s11)) - CUT * sigma;
    let high = s00.max(s10).max(s01.max(s11)) + CUT * sigma;
    s.cmpgt(low).all() && s.cmplt(high).all()
}

/// Density at `s` of a square of edge 1 whose corners have these normals, under a footprint whose centre is seen from corner 00.
///
/// Where normals are n + J d, the density is a Gaussian in s and what it says of d another one (docs/methods/ndf-maps.md, *A patch
/// under a footprint*), of which the part in the square counts. The square is taken as linear around the likeliest d.
fn square_density([s00, s10, s01, s11]: [Vec2; 4], e: &Ellipse, sigma: f32, s: Vec2) -> f32 {
    let side = e.axis.perp();
    let mut at = e.mean.clamp(Vec2::ZERO, Vec2::ONE);
    let mut seen = Seen::default();
    for _ in 0..STEPS {
        let du = (s10 - s00) * (1.0 - at.y) + (s11 - s01) * at.y;
        let dv = (s01 - s00) * (1.0 - at.x) + (s11 - s10) * at.x;
        let normal = s00 + (s10 - s00) * at.x + dv * at.y;
        let a = (du * e.axis.x + dv * e.axis.y) * e.major;
        let b = (du * side.x + dv * side.y) * e.minor;
        let mean = normal + du * (e.mean.x - at.x) + dv * (e.mean.y - at.y);
        seen = self::seen(s - mean, a, b, sigma);
        seen.place = e.mean + e.axis * (seen.place.x * e.major) + side * (seen.place.y * e.minor);
        at = seen.place.clamp(Vec2::ZERO, Vec2::ONE);
    }
    // Along the square's axes: what is uncertain of the place.
    let along = Vec2::new(e.axis.x * e.major, side.x * e.minor);
    let down = Vec2::new(e.axis.y * e.major, side.y * e.minor);
    let (xx, xy, yy) = (seen.covariance(along, along), seen.covariance(along, down), seen.covariance(down, down));
    // The places within the square, along x, are about those of a product with a Gaussian of the square's mean and variance; the part
    // along y is that of the places there.
    let slope = xy / xx.max(LEAST_VARIANCE);
    let within = 1.0 / (1.0 / xx.max(LEAST_VARIANCE) + 12.0);
    let moved = (0.5 - seen.place.x) * 12.0 * within;
    let part = inside(seen.place.x, xx) * inside(seen.place.y + slope * moved, yy - slope * (xy - slope * within));
    let dv = (s01 - s00) * (1.0 - at.x) + (s11 - s10) * at.x;
    let normal = s00 + (s10 - s00) * at.x + dv * at.y;
    let mass = normal_cdf((1.0 - normal.length()) / sigma).max(1e-3);
    seen.density * part / mass
}

/// Beyond this many standard deviations the lobe of a normal is nothing.
pub(super) const CUT: f32 = 4.5;
/// Steps towards the likeliest place.
const STEPS: u32 = 2;

/// Variance of a place, in edges of a square, below which it is a point.
const LEAST_VARIANCE: f32 = 1e-12;

/// Part from 0 to 1 of a Gaussian around `place`.
fn inside(place: f32, variance: f32) -> f32 {
    let inverse = 1.0 / variance.max(LEAST_VARIANCE).sqrt();
    normal_cdf((1.0 - place) * inverse) - normal_cdf(-place * inverse)
}

/// What a projected normal says of the place it comes from, in standard deviations of the footprint along its axes: prior variance 1.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// Density of the normal.
    density: f32,
    /// Mean of the place.
    place: Vec2,
    /// Its covariance: xx, xy, yy.
    own: Vec3,
}

/// Of a normal `d` from the footprint's middle, where normals move by `a` and `b` a standard deviation, seen through a lobe of `sigma`.
fn seen(d: Vec2, a: Vec2, b: Vec2, sigma: f32) -> Seen {
    let sigma2 = sigma * sigma;
    let (aa, ab, bb) = (a.length_squared(), a.dot(b), b.length_squared());
    let crossed = a.perp_dot(b);
    // Determinants as sums of squares, so that no digits cancel.
    let det = sigma2 * (sigma2 + aa + bb) + crossed * crossed;
    // C⁻¹ d of the covariance C = σ² + a aᵀ + b bᵀ of normals.
    let xx = sigma2 + a.x * a.x + b.x * b.x;
    let xy = a.x * a.y + b.x * b.y;
    let yy = sigma2 + a.y * a.y + b.y * b.y;
    let w = Vec2::new(yy * d.x - xy * d.y, xx * d.y - xy * d.x) / det;
    Seen {
        density: (-0.5 * d.dot(w)).exp() / (std::f32::consts::TAU * det.sqrt()),
        place: Vec2::new(a.dot(w), b.dot(w)),
        // (1 + (a b)ᵀ(a b)/σ²)⁻¹, whose determinant is det/σ⁴.
        own: Vec3::new(sigma2 + bb, -ab, sigma2 + aa) * (sigma2 / det),
    }
}

impl Seen {
    /// Covariance of the place along two axes, vectors in standard deviations.
    fn covariance(&self, a: Vec2, b: Vec2) -> f32 {
        a.x * b.x * self.own.x + (a.x * b.y + a.y * b.x) * self.own.y + a.y * b.y * self.own.z
    }
}

/// Φ(x).
pub(super) fn normal_cdf(x: f32) -> f32 {
    0.5 * (1.0 + erf(x * std::f32::consts::FRAC_1_SQRT_2))
}
