//! The report as text for people.

use super::Report;
use crate::methods::ndf_maps::info::{MaterialInfo, PlacementInfo};
use crate::quantities::{kib, percent};
use glint_formats::provenance::Provenance;
use glint_formats::{Codec, Resource, SectionEntry, kinds, vk_format};
use std::fmt::Write;

impl Report {
    /// The whole report.
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        let line = |out: &mut String, text: String| {
            out.push_str(text.trim_end());
            out.push('\n');
        };
        let version =
            self.version.map_or("unknown version".into(), |(major, minor)| format!("version {major}.{minor}"));
        line(&mut out, format!("{}: glintpack {version}, {} ({} bytes)", self.file, kib(self.bytes), self.bytes));
        line(&mut out, String::new());
        line(&mut out, format!("{} sections", self.sections.len()));
        let width = self.sections.iter().map(|section| section.label().chars().count()).max().unwrap_or(0);
        for section in &self.sections {
            line(&mut out, section_line(section, width));
        }
        for material in &self.materials {
            line(&mut out, String::new());
            material_lines(material, &mut out);
        }
        for layers in &self.layers {
            let [r, g, b] = layers.base_f0;
            line(&mut out, String::new());
            line(&mut out, format!("two layers: \"{}\" over \"{}\"", layers.coat, layers.base));
            line(&mut out, format!("  F0 of the coat  {}", layers.coat_f0));
            line(&mut out, format!("  F0 of the base  {r}, {g}, {b}"));
        }
        for dictionary in &self.dictionaries {
            line(&mut out, String::new());
            out.push_str(&dictionary.to_text());
        }
        for environment in &self.environments {
            line(&mut out, String::new());
            out.push_str(&environment.to_text());
        }
        for material in &self.area_lights {
            line(&mut out, String::new());
            out.push_str(&material.to_text());
        }
        for map in &self.lobes {
            line(&mut out, String::new());
            out.push_str(&map.to_text());
        }
        for surface in &self.surfaces {
            line(&mut out, String::new());
            out.push_str(&surface.to_text());
        }
        for provenance in &self.provenance {
            line(&mut out, String::new());
            provenance_lines(provenance, &mut out);
        }
        out
    }
}

fn section_line(section: &SectionEntry, label_width: usize) -> String {
    let title = kinds::known(section.kind).map_or("unknown", |known| known.title);
    let resource = match section.resource {
        Resource::Parameters => "parameters".into(),
        Resource::Buffer { stride, count } => format!("{count} × {stride} bytes"),
        Resource::Texture { vk_format, width, height, layers, faces, mips } => {
            let format = vk_format::name(vk_format).map_or(format!("format {vk_format}"), str::to_owned);
            let layers = if layers > 1 { format!(" × {layers} layers") } else { String::new() };
            let mips = if mips > 1 { format!(", {mips} mips") } else { String::new() };
            let cube = if faces == 6 { " × 6 faces" } else { "" };
            format!("{format} {width} × {height}{cube}{layers}{mips}")
        }
    };
    let stored = match section.codec {
        Codec::None => format!("{} bytes", section.raw_len),
        Codec::Zstd => format!("{} bytes, {} stored", section.raw_len, section.stored_len),
    };
    format!("  {:<label_width$}  {title:<21}  {resource:<41}  {stored:<12}  {:016x}", section.label(), section.checksum)
}

fn material_lines(material: &MaterialInfo, out: &mut String) {
    let bytes = &material.bytes;
    let mut line = |text: String| {
        out.push_str(&text);
        out.push('\n');
    };
    line(format!("material \"{}\"", material.name));
    line(format!("  example      {} × {} texels, {}", material.width, material.height, material.wrap));
    line(format!("  σ_r          {}", material.intrinsic_roughness));
    line(format!("  storage      {}, E₁ {} asked", material.storage, percent(f64::from(material.max_error))));
    line("  levels       tile      tiles   density texels   E₁ mean     worst".into());
    for level in &material.levels {
        let grid = format!("{} × {}", level.tiles_x, level.tiles_y);
        let (mean, worst) = (percent(level.mean_error), percent(level.worst_error));
        line(format!(
            "           {:>8} {grid:>10} {:>16} {mean:>9} {worst:>9}",
            level.tile_texels, level.density_texels
        ));
    }
    line(format!("  accuracy     {}", material.accuracy_line()));
    line(format!("  energy       {:.1e} at most from 1", material.measured.energy));
    line(format!(
        "  bytes        tiles {}, density {}, normals {}, placement {}",
        bytes.tiles, bytes.density, bytes.normals, bytes.placement
    ));
    line(match material.placement {
        PlacementInfo::Tiled => "  placement    tiled".into(),
        PlacementInfo::Stochastic { cells_x, cells_y, cell_texels, seed, palette } => format!(
            "  placement    stochastic, {cells_x} × {cells_y} cells of {cell_texels} texels, {palette} transforms, seed {seed}"
        ),
    });
}

fn provenance_lines(provenance: &Provenance, out: &mut String) {
    let git = if provenance.git_hash.is_empty() { "unknown" } else { &provenance.git_hash };
    // Writing to a string cannot fail.
    let _ = writeln!(out, "baked by glint-bake {} (git {git}), {}", provenance.tool_version, provenance.method);
    let options: Vec<String> = provenance.options.iter().map(|(name, value)| format!("{name} {value}")).collect();
    let _ = writeln!(out, "  options      {}", options.join(", "));
    let _ = writeln!(out, "  seed         {}", provenance.seed);
    if !provenance.normal_convention.is_empty() {
        let _ = writeln!(out, "  convention   {}", provenance.normal_convention);
    }
    for input in &provenance.inputs {
        let _ = writeln!(out, "  input        {} {}, {} bytes", input.xxh3_128, input.name, input.bytes);
    }
    for note in &provenance.notes {
        let _ = writeln!(out, "  note         {note}");
    }
}
