//! MIP-mapped lobes of maps, and of surfaces made of patches of one, as numbers.

use crate::methods::contents::Item;
use crate::quantities::{kib, percent};
use glint_bake_core::lobes::{BakedLobes, sections};
use glint_bake_core::surface::sections as surface_sections;
use glint_bake_core::synthesis::quality::whole_share;
use glint_formats::Pack;
use glint_formats::Wrap;
use glint_formats::lobes::{Filter, FootprintError, LobeStorage, Merge, NormalsStorage};
use glint_formats::synthesis::Layout;
use serde::Serialize;
use std::fmt::Write;

/// MIP-mapped lobes of one map.
#[derive(Debug, Serialize)]
pub struct LobesInfo {
    /// Name in the pack.
    pub name: String,
    /// Width of the map in texels.
    pub width: u32,
    /// Height of the map in texels.
    pub height: u32,
    /// What lies beyond the edge: `repeat` or `clamp`.
    pub wrap: &'static str,
    /// `linear` or `nearest`.
    pub filter: &'static str,
    /// Intrinsic roughness that lobes were merged for.
    pub intrinsic_roughness: f32,
    /// Lobes a cell.
    pub lobes_per_cell: u32,
    /// Edge of the finest cells in texels.
    pub cell_texels: u32,
    /// Stored levels.
    pub levels: usize,
    /// `kmeans`, `moments` or `runnalls`.
    pub merge: &'static str,
    /// Lobes a texel that the reduction began with.
    pub seeds: u32,
    /// `packed` or `f16`.
    pub storage: &'static str,
    /// Bits a channel of the normals.
    pub normal_bits: u32,
    /// Bytes of all lobes once decompressed.
    pub lobe_bytes: u64,
    /// Bytes of the normals once decompressed.
    pub normal_bytes: u64,
    /// Bytes that a GPU holds of this map: lobes, normals and what shaders read of the parameters. Of a surface's sample too.
    pub gpu_bytes: u64,
    /// Intrinsic roughness up to which renderers may leave out what lies beyond the rim of the disk of normals.
    pub rim_roughness: f32,
    /// Roughness that the error was measured at.
    pub measured_roughness: f32,
    /// Error as the bake measured it, a row a footprint size.
    pub measured: Vec<FootprintError>,
}

impl LobesInfo {
    /// Describes the lobes of every map of a sound pack.
    pub fn all_of(pack: &Pack) -> Vec<LobesInfo> {
        sections::maps(pack).into_iter().filter_map(|name| LobesInfo::of(pack, name)).collect()
    }

    fn of(pack: &Pack, name: &str) -> Option<LobesInfo> {
        LobesInfo::describe(name, &sections::from_pack(pack, name).ok()?)
    }

    /// Describes lobes of either kind.
    fn describe(name: &str, baked: &BakedLobes) -> Option<LobesInfo> {
        let params = &baked.params;
        Some(LobesInfo {
            name: name.to_owned(),
            width: params.width,
            height: params.height,
            wrap: match params.wrap {
                Wrap::Repeat => "repeat",
                Wrap::Clamp => "clamp",
            },
            filter: match params.filter {
                Filter::Linear => "linear",
                Filter::Nearest => "nearest",
            },
            intrinsic_roughness: params.intrinsic_roughness,
            lobes_per_cell: params.lobes_per_cell,
            cell_texels: params.levels.first()?.cell_texels,
            levels: params.levels.len(),
            merge: match params.merge {
                Merge::KMeans => "kmeans",
                Merge::Moments => "moments",
                Merge::Runnalls => "runnalls",
            },
            seeds: params.seeds,
            storage: match params.storage {
                LobeStorage::Packed => "packed",
                LobeStorage::Half => "f16",
            },
            normal_bits: match params.normals {
                NormalsStorage::Snorm16 => 16,
                NormalsStorage::Unorm8 => 8,
            },
            lobe_bytes: baked.lobes.len() as u64,
            normal_bytes: size_of_val(&baked.normals[..]) as u64,
            gpu_bytes: baked.gpu_bytes() as u64,
            rim_roughness: params.rim_roughness,
            measured_roughness: params.measured_roughness,
            measured: params.measured.clone(),
        })
    }

    fn levels_in_words(&self) -> String {
        if self.levels == 1 { "1 level".to_owned() } else { format!("{} levels", self.levels) }
    }

    /// Size and error on one line.
    fn size_and_error(&self) -> String {
        let errors: Vec<String> = self
            .measured
            .iter()
            .map(|row| format!("{} at σ {}", percent(f64::from(row.mean)), row.sigma_texels))
            .collect();
        let errors = if errors.is_empty() { "not measured".to_owned() } else { errors.join(", ") };
        format!(
            "{} × {} texels, {}, lobes {} and normals {}, E₁ {errors}",
            self.width,
            self.height,
            self.levels_in_words(),
            kib(self.lobe_bytes),
            kib(self.normal_bytes)
        )
    }
}

impl Item for LobesInfo {
    fn name(&self) -> &str {
        &self.name
    }

    fn accuracy_line(&self) -> Option<String> {
        Some(self.size_and_error())
    }

    fn to_text(&self) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(out, "lobes of \"{}\"", self.name);
        let _ = writeln!(out, "  map          {} × {} texels, {}, {}", self.width, self.height, self.wrap, self.filter);
        let _ = writeln!(out, "  roughness    merged for σ_r {}", self.intrinsic_roughness);
        let _ = writeln!(
            out,
            "  lobes        {} a cell, {} from {} texels on, {} from {} a texel",
            self.lobes_per_cell,
            self.levels_in_words(),
            self.cell_texels,
            self.merge,
            self.seeds
        );
        let _ = writeln!(
            out,
            "  storage      lobes {} {}, normals {} bits {}, on a GPU {} together",
            self.storage,
            kib(self.lobe_bytes),
            self.normal_bits,
            kib(self.normal_bytes),
            kib(self.gpu_bytes)
        );
        for row in &self.measured {
            let _ = writeln!(
                out,
                "  error        E₁ {} on average, {} at the worst, footprints of {} texels, σ_r {}",
                percent(f64::from(row.mean)),
                percent(f64::from(row.worst)),
                row.sigma_texels,
                self.measured_roughness
            );
        }
        out
    }
}

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
        surface_sections::surfaces(pack).into_iter().filter_map(|name| SurfaceInfo::of(pack, name)).collect()
    }

    fn of(pack: &Pack, name: &str) -> Option<SurfaceInfo> {
        let surface = surface_sections::from_pack(pack, name).ok()?;
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
    fn size_and_error(&self) -> String {
        format!(
            "surface {}, lookup {}, of {}; {} together",
            self.size_text(),
            kib(self.lookup_bytes),
            self.sample.size_and_error(),
            kib(self.gpu_bytes)
        )
    }
}

impl Item for SurfaceInfo {
    fn name(&self) -> &str {
        &self.name
    }

    fn accuracy_line(&self) -> Option<String> {
        Some(self.size_and_error())
    }

    fn to_text(&self) -> String {
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
