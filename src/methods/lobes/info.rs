//! One map's MIP-mapped lobes, as numbers.

use crate::quantities::{kib, percent};
use glint_bake_core::lobes::{BakedLobes, sections};
use glint_formats::Pack;
use glint_formats::Wrap;
use glint_formats::lobes::{Filter, FootprintError, LobeStorage, Merge, NormalsStorage};
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
    pub fn describe(name: &str, baked: &BakedLobes) -> Option<LobesInfo> {
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
            normal_bytes: baked.normals.len() as u64,
            measured_roughness: params.measured_roughness,
            measured: params.measured.clone(),
        })
    }

    fn levels_in_words(&self) -> String {
        if self.levels == 1 { "1 level".to_owned() } else { format!("{} levels", self.levels) }
    }

    /// Size and error on one line.
    pub fn accuracy_line(&self) -> String {
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

    /// The part of the text report that is about this map.
    pub fn to_text(&self) -> String {
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
            "  storage      lobes {} {}, normals {} bits {}",
            self.storage,
            kib(self.lobe_bytes),
            self.normal_bits,
            kib(self.normal_bytes)
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
