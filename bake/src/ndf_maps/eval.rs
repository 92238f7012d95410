//! Evaluation of NDF maps in f32, as `eval.wgsl` does it: one node, one patch, and the sum of a footprint's terms.
//!
//! Xing et al. 2024, section 6.3: the P-NDF is a sum of the NDFs under the footprint, here of nodes; below the finest windows, of
//! the map's bilinear patches, which are the example's normals as they are.

use super::baked::{BakedNdfMaps, Material};
use crate::windows::ellipse::Ellipse;
use crate::windows::patch::patch_density;
use glam::{IVec2, Mat2, UVec2, Vec2, Vec4};

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

    /// Density at the example's projected normal `s` of a patch under a footprint.
    pub fn patch_density(&self, term: &PatchTerm, s: Vec2) -> f32 {
        if s.length_squared() > 1.0 {
            return 0.0;
        }
        patch_density(term.corners, &term.footprint, self.params.intrinsic_roughness, s)
    }
}
