//! One synthesised surface, as numbers.

use super::info::LobesInfo;
use crate::quantities::{kib, percent};
use glint_bake_core::surface::sections;
use glint_bake_core::synthesis::measure::whole_share;
use glint_formats::Pack;
use glint_formats::synthesis::Layout;
use serde::Serialize;
use std::fmt::Write;

/// Blocks a side of the part of the surface that coverage is counted over.
const COUNTED: i32 = 256;

/// A surface of patches and the lobes of its sample.
#[derive(Debug, Serialize)]
pub struct SurfaceInfo {
    /// Name in the pack.
    pub name: String,
    /// Width and height in texels that were asked for; none of a surface without end.
    pub size: Option<(u32, u32)>,
    /// Edge of a patch or tile in texels.
    pub patch: u32,
    /// Texels over which patches overlap.
    pub overlap: u32,
    /// Offsets of patches are multiples of this.
    pub alignment: u32,
    /// Corner colours and tiles for the same four of them; none of a grid of patches.
    pub tiles: Option<(u32, u32)>,
    /// Offsets and seams that are stored.
    pub patches: usize,
    /// Offsets that differ.
    pub distinct_offsets: u32,
    /// Root mean square difference of normals across seams over that of neighbours in the sample.
    pub seam_ratio: f64,
    /// Share of the blocks of the finest cells that are one cell.
    pub coverage: f64,
    /// Bytes of offsets and seams once decompressed.
    pub lookup_bytes: u64,
    /// Bytes of lobes, normals, offsets and seams together.
    pub gpu_bytes: u64,
    /// The sample and its lobes.
    pub sample: LobesInfo,
}

impl SurfaceInfo {
    /// Describes every surface of a sound pack.
    pub fn all_of(pack: &Pack) -> Vec<SurfaceInfo> {
        sections::surfaces(pack).into_iter().filter_map(|name| SurfaceInfo::of(pack, name)).collect()
    }

    fn of(pack: &Pack, name: &str) -> Option<SurfaceInfo> {
        let surface = sections::from_pack(pack, name).ok()?;
        let params = &surface.synthesis.params;
        let cell = surface.lobes.params.levels.first()?.cell_texels;
        let (size, tiles) = match params.layout {
            Layout::Patches { width, height, .. } => (Some((width, height)), None),
            Layout::CornerTiles { colours, variants, .. } => (None, Some((colours, variants))),
        };
        Some(SurfaceInfo {
            name: name.to_owned(),
            size,
            patch: params.patch,
            overlap: params.overlap,
            alignment: params.alignment,
            tiles,
            patches: surface.synthesis.offsets.len(),
            distinct_offsets: params.measured.distinct_offsets,
            seam_ratio: params.measured.seam_ratio,
            coverage: whole_share(&surface.synthesis, COUNTED, (cell / 8).max(1).ilog2(), true),
            lookup_bytes: (surface.gpu_bytes() - surface.lobes.gpu_bytes()) as u64,
            gpu_bytes: surface.gpu_bytes() as u64,
            sample: LobesInfo::describe(name, &surface.lobes)?,
        })
    }

    fn size_text(&self) -> String {
        self.size.map_or_else(|| "without end".to_owned(), |(width, height)| format!("{width} × {height} texels"))
    }

    /// Size and error on one line.
    pub fn accuracy_line(&self) -> String {
        format!(
            "surface {}, lookup {}, of {}; {} together",
            self.size_text(),
            kib(self.lookup_bytes),
            self.sample.accuracy_line(),
            kib(self.gpu_bytes)
        )
    }

    /// The part of the text report that is about this surface.
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(out, "surface \"{}\"", self.name);
        let _ = writeln!(
            out,
            "  surface      {}, patches of {} texels that overlap by {}",
            self.size_text(),
            self.patch,
            self.overlap
        );
        if let Some((colours, variants)) = self.tiles {
            let _ = writeln!(out, "  tiles        {colours} corner colours, {variants} for the same four");
        }
        let _ = writeln!(
            out,
            "  lookup       {}, {} patches, {} different",
            kib(self.lookup_bytes),
            self.patches,
            self.distinct_offsets
        );
        let _ = writeln!(out, "  seams        {:.2} of the difference of neighbours", self.seam_ratio);
        let _ = writeln!(out, "  coverage     {} of the finest blocks are cells", percent(self.coverage));
        let _ = writeln!(out, "  together     {}", kib(self.gpu_bytes));
        out + &self.sample.to_text()
    }
}
