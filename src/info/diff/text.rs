//! The differences as text for people.

use super::{Diff, SectionChange, SectionSide};
use glint_formats::{Codec, Resource, vk_format};
use serde_json::Value;
use std::fmt::Write;

const FACES: [&str; 6] = ["+X", "-X", "+Y", "-Y", "+Z", "-Z"];

impl Diff {
    /// The whole comparison; `a` and `b` stand for the two files.
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        for (letter, side) in [("a", &self.a), ("b", &self.b)] {
            let _ = writeln!(out, "{letter}: {}, {} bytes", side.file, side.bytes);
        }
        if self.equal == Some(true) {
            out.push_str("the packs are equal\n");
        }
        for note in &self.notes {
            let _ = writeln!(out, "{note}");
        }
        let mut last = String::new();
        for change in &self.fields {
            let label = label(&change.kind.to_string(), &change.name);
            if label != last {
                let _ = writeln!(out, "\n{label}");
                last = label;
            }
            let _ = writeln!(out, "  {:<24} {} → {}", change.field, scalar(&change.a), scalar(&change.b));
        }
        if !self.sections.is_empty() {
            let _ = writeln!(out, "\nsections");
        }
        for change in &self.sections {
            section(change, &mut out);
        }
        out
    }
}

fn label(kind: &str, name: &str) -> String {
    if name.is_empty() { kind.to_owned() } else { format!("{kind} \"{name}\"") }
}

fn scalar(value: &Value) -> String {
    match value {
        Value::Null => "none".into(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

fn section(change: &SectionChange, out: &mut String) {
    let label = label(&change.kind.to_string(), &change.name);
    let _ = match (&change.a, &change.b) {
        (Some(a), None) => writeln!(out, "  {label}: only in a: {}", describe(a)),
        (None, Some(b)) => writeln!(out, "  {label}: only in b: {}", describe(b)),
        (Some(a), Some(b)) => {
            let differs = change.differs.join(", ");
            writeln!(out, "  {label}: {differs}\n    a: {}\n    b: {}", describe(a), describe(b))
        }
        (None, None) => Ok(()),
    };
    if let Some(texels) = &change.texels {
        let [mip, layer, face, column, row, component] = texels.max_at;
        let _ = writeln!(
            out,
            "    {} of {} texels differ, by {:.3e} at most (mip {mip}, layer {layer}, face {}, texel ({column}, {row}), \
             {}), {:.3e} on average",
            texels.differing,
            texels.texels,
            texels.max,
            FACES[face as usize],
            ["R", "G", "B", "A"][component as usize],
            texels.mean
        );
        if texels.not_finite > 0 {
            let _ = writeln!(out, "    {} components are not finite in one of them", texels.not_finite);
        }
    }
    if let Some(records) = &change.records {
        let _ = writeln!(
            out,
            "    {} of {} records differ, the first is number {}",
            records.differing, records.records, records.first
        );
    }
}

fn describe(side: &SectionSide) -> String {
    let resource = match side.resource {
        Resource::Parameters => "parameters".into(),
        Resource::Buffer { stride, count } => format!("{count} × {stride} bytes"),
        Resource::Texture { vk_format, width, height, layers, faces, mips } => {
            let format = vk_format::name(vk_format).map_or(format!("format {vk_format}"), str::to_owned);
            format!("{format} {width} × {height}, {layers} layers, {faces} faces, {mips} mips")
        }
    };
    let codec = if side.codec == Codec::Zstd { ", zstd" } else { "" };
    let required = if side.required { "" } else { ", optional" };
    format!("version {}, {resource}, {} bytes{codec}{required}, {}", side.version, side.raw_len, side.xxh3_128)
}
