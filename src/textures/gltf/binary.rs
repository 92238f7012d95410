//! The binary chunk of a GLB with new images in it: each in place of the one that it replaces, or at the end. All other buffer views
//! keep their bytes; those behind a change move by a multiple of eight bytes, which keeps every alignment.

use crate::gltf::document::Document;
use crate::gltf::fault::Fault;
use crate::gltf::json::{Edits, Text};
use std::collections::BTreeMap;

/// Bytes by which views may be moved.
const STEP: usize = 8;

/// New images: in which view they lie, and their bytes.
#[derive(Default)]
pub struct Images {
    /// Views that there are already.
    pub replaced: BTreeMap<usize, Vec<u8>>,
    /// Views that come after the others.
    pub added: Vec<Vec<u8>>,
}

/// A part of the buffer that a number in the JSON says the beginning of.
struct Part {
    start: usize,
    end: usize,
}

/// Whether a view lies in the binary chunk and shares no byte with another one.
pub fn stands_alone(document: &Document, view: usize) -> bool {
    let Some(own) = document.buffer_views.get(view).filter(|view| view.buffer == 0) else { return false };
    let own = Part { start: own.byte_offset as usize, end: own.byte_offset.saturating_add(own.byte_length) as usize };
    let apart = |other: Part| other.end <= own.start || own.end <= other.start;
    let others = document.buffer_views.iter().enumerate().filter(|(index, _)| *index != view);
    let parts = others.filter(|(_, other)| other.buffer == 0).map(|(_, other)| Part {
        start: other.byte_offset as usize,
        end: other.byte_offset.saturating_add(other.byte_length) as usize,
    });
    own.start < own.end && parts.chain(extension_parts(document).map(|(_, _, part)| part)).all(apart)
}

/// Parts that extensions of views say, as meshopt's do: view, extension, part.
fn extension_parts(document: &Document) -> impl Iterator<Item = (usize, &str, Part)> {
    document.buffer_views.iter().enumerate().flat_map(|(index, view)| {
        view.extensions.iter().filter_map(move |(name, value)| {
            let number = |key: &str| value.get(key).and_then(serde_json::Value::as_u64);
            let start = number("byteOffset").unwrap_or(0);
            let end = start.saturating_add(number("byteLength").unwrap_or(0));
            let part = Part { start: start as usize, end: end as usize };
            (number("buffer") == Some(0)).then_some((index, name.as_str(), part))
        })
    })
}

/// The new chunk. Views that move or that are replaced are edited, and the buffer's length; the texts of added views are given back.
///
/// # Errors
/// Bad, where the JSON is not what the document was read from.
pub fn rebuild(
    document: &Document,
    binary: &[u8],
    images: &Images,
    text: Text<'_>,
    edits: &mut Edits,
) -> Result<(Vec<u8>, Vec<String>), Fault> {
    // A chunk is padded; what its buffer has is its own length.
    let used = document.buffers.first().map_or(0, |buffer| buffer.byte_length as usize).min(binary.len());
    let mut replaced: Vec<(usize, Part, &Vec<u8>)> = Vec::new();
    for (&index, bytes) in &images.replaced {
        let view = &document.buffer_views[index];
        let start = view.byte_offset as usize;
        replaced.push((index, Part { start, end: start + view.byte_length as usize }, bytes));
    }
    replaced.sort_by_key(|(_, part, _)| part.start);
    let mut out = Vec::with_capacity(binary.len());
    let mut at = 0;
    // Where what lies behind each replaced part moves to.
    let mut moves: Vec<(usize, usize)> = Vec::new();
    let mut places: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
    for (index, part, bytes) in replaced {
        out.extend(&binary[at..part.start]);
        places.insert(index, (out.len(), bytes.len()));
        out.extend(bytes);
        // Zeros, until what follows lies as it lay before, but for whole steps.
        while out.len() % STEP != part.end % STEP {
            out.push(0);
        }
        moves.push((part.end, out.len()));
        at = part.end;
    }
    out.extend(&binary[at..used]);
    let moved = |from: usize| match moves.iter().rev().find(|(end, _)| *end <= from) {
        Some((end, to)) => (from - end).saturating_add(*to),
        None => from,
    };
    let views = text.list("bufferViews")?;
    for (index, view) in document.buffer_views.iter().enumerate().filter(|(_, view)| view.buffer == 0) {
        let old = (view.byte_offset as usize, view.byte_length as usize);
        let (start, length) = places.get(&index).copied().unwrap_or((moved(old.0), old.1));
        if (start, length) != old {
            edits.set(text, &views[index], &[("byteOffset", start.to_string()), ("byteLength", length.to_string())])?;
        }
    }
    for (index, name, part) in extension_parts(document).filter(|(_, _, part)| moved(part.start) != part.start) {
        let all = text.member(&views[index], "extensions")?;
        let own = all.map(|all| text.member(&all, name)).transpose()?.flatten();
        if let Some(own) = own {
            edits.set(text, &own, &[("byteOffset", moved(part.start).to_string())])?;
        }
    }
    let mut added = Vec::new();
    for bytes in &images.added {
        out.resize(out.len().next_multiple_of(STEP), 0);
        added.push(format!("{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}}}", out.len(), bytes.len()));
        out.extend(bytes);
    }
    if let Some(buffer) = text.list("buffers")?.first() {
        edits.set(text, buffer, &[("byteLength", out.len().to_string())])?;
    }
    Ok((out, added))
}
