//! Levels by the edge of their cells, as the paper chooses them. Ours are chosen otherwise ([`BakedLobes::lod`]); these are
//! what they are measured against.
//!
//! Tan et al. 2022, section 5.2.1: level λ = C_P log₂ P of a footprint P (Eq. 8), C_P = ½, between its two neighbours by
//! Eq. 9, whose weights are exchanged here: the finer's is the one that falls with λ. Read as a texture's MIP, P is an area,
//! λ the binary logarithm of its edge, and the cells of level λ are as wide.

use super::bake::BakedLobes;
use super::eval::Frame;
use super::query::{Detail, Lod, QuerySettings};

impl BakedLobes {
    /// The levels whose cells are 2^`lambda` texels wide, or next to that. Below the first stored level the map is read
    /// itself; above the last, the last.
    pub fn lod_of_edge(&self, frame: &Frame, lambda: f32) -> Lod {
        let levels = &self.params.levels;
        let first = levels[0].cell_texels.ilog2() as i32;
        let detail = |log2_edge: f32| match log2_edge as i32 - first {
            below if below < 0 => Detail::Boxes(self.box_edge(frame, &QuerySettings::default())),
            level => Detail::Cells((level as usize).min(levels.len() - 1)),
        };
        Lod { finer: detail(lambda.floor()), coarser: detail(lambda.ceil()), fraction: lambda - lambda.floor() }
    }
}
