//! The report as text for people.

use super::report::Report;
use crate::quantities::kib;
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
        if !self.gpu_bytes.is_empty() {
            line(&mut out, String::new());
            line(&mut out, "on the GPU".into());
            let width = self.gpu_bytes.iter().map(|of| of.name.chars().count()).max().unwrap_or(0);
            for of in &self.gpu_bytes {
                line(&mut out, format!("  {:<width$}  {} bytes", of.name, of.bytes));
            }
        }
        for item in self.contents.items() {
            line(&mut out, String::new());
            out.push_str(&item.to_text());
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
