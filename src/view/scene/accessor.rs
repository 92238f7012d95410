//! The part of glTF 2.0's JSON that geometry needs (specification, sections 3.6 and 3.7), and numbers out of its buffers.
//! Every index, offset and count is checked before use; integer components are read too (KHR_mesh_quantization).

use super::fault::Fault;
use super::mesh::MAX_TRIANGLES;
use serde::Deserialize;
use std::collections::HashMap;

/// Elements of an accessor, at most: every corner of every triangle.
const MAX_COUNT: u64 = 3 * MAX_TRIANGLES as u64;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document {
    pub asset: Asset,
    pub extensions_required: Vec<String>,
    pub scene: Option<usize>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Primitives>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<View>,
    pub buffers: Vec<Buffer>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Asset {
    pub version: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Scene {
    pub nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub children: Vec<usize>,
    pub mesh: Option<usize>,
    pub matrix: Option<[f32; 16]>,
    pub translation: [f32; 3],
    pub rotation: Option<[f32; 4]>,
    pub scale: Option<[f32; 3]>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Primitives {
    pub primitives: Vec<Primitive>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Primitive {
    pub attributes: HashMap<String, usize>,
    pub indices: Option<usize>,
    pub mode: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Accessor {
    pub buffer_view: Option<usize>,
    pub byte_offset: u64,
    pub component_type: u32,
    pub normalized: bool,
    pub count: u64,
    #[serde(rename = "type")]
    pub shape: String,
    pub sparse: Option<Box<Sparse>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Sparse {
    pub count: u64,
    pub indices: Accessor,
    pub values: Accessor,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct View {
    pub buffer: usize,
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: Option<u64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Buffer {
    pub uri: Option<String>,
    pub byte_length: u64,
}

/// A document with the bytes of its buffers.
#[derive(Debug)]
pub(super) struct Source {
    pub document: Document,
    pub buffers: Vec<Vec<u8>>,
}

fn bad(what: String) -> Fault {
    Fault::Bad(what)
}

/// Bytes of one component.
fn component_size(component_type: u32) -> Option<u64> {
    match component_type {
        5120 | 5121 => Some(1),
        5122 | 5123 => Some(2),
        5125 | 5126 => Some(4),
        _ => None,
    }
}

/// A component as a number; integers that are `normalized` as glTF section 3.11 says.
fn component(bytes: &[u8], component_type: u32, normalized: bool) -> f32 {
    let scaled = |value: f32, most: f32| if normalized { (value / most).max(-1.0) } else { value };
    match (component_type, bytes) {
        (5120, &[a]) => scaled(f32::from(a as i8), 127.0),
        (5121, &[a]) => scaled(f32::from(a), 255.0),
        (5122, &[a, b]) => scaled(f32::from(i16::from_le_bytes([a, b])), 32_767.0),
        (5123, &[a, b]) => scaled(f32::from(u16::from_le_bytes([a, b])), 65_535.0),
        (5126, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
        _ => f32::NAN,
    }
}

/// An index as a number.
fn whole(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte))
}

impl Source {
    /// `count` elements of `size` bytes of an accessor, one after the other.
    fn elements(&self, accessor: &Accessor, view: usize, count: u64, size: u64) -> Result<Vec<&[u8]>, Fault> {
        let Some(view) = self.document.buffer_views.get(view) else {
            return Err(bad(format!("an accessor asks for buffer view {view}, which is not there")));
        };
        let Some(buffer) = self.buffers.get(view.buffer) else {
            return Err(bad(format!("a buffer view asks for buffer {}, which is not there", view.buffer)));
        };
        let outside = || bad(format!("an accessor of {count} elements ends after its buffer view"));
        let end = view.byte_offset.checked_add(view.byte_length).ok_or_else(outside)?;
        let bytes = buffer
            .get(
                usize::try_from(view.byte_offset).map_err(|_| outside())?
                    ..usize::try_from(end).map_err(|_| outside())?,
            )
            .ok_or_else(|| bad(format!("a buffer view ends at byte {end} of a buffer of {}", buffer.len())))?;
        let stride = view.byte_stride.filter(|&stride| stride > 0).unwrap_or(size);
        let element = |i: u64| -> Option<&[u8]> {
            let start = i.checked_mul(stride)?.checked_add(accessor.byte_offset)?;
            bytes.get(usize::try_from(start).ok()?..usize::try_from(start.checked_add(size)?).ok()?)
        };
        // The last one first: a count that lies costs nothing.
        if count > 0 {
            element(count - 1).ok_or_else(outside)?;
        }
        (0..count).map(|i| element(i).ok_or_else(outside)).collect()
    }

    fn accessor(&self, index: usize) -> Result<&Accessor, Fault> {
        let accessor = self.document.accessors.get(index);
        let accessor = accessor.ok_or_else(|| bad(format!("accessor {index} is asked for, but not there")))?;
        if accessor.count > MAX_COUNT {
            let found = accessor.count;
            return Err(Fault::TooLarge(format!("accessor {index} has {found} elements, {MAX_COUNT} are the limit")));
        }
        Ok(accessor)
    }

    /// Vectors of `N` numbers.
    pub fn vectors<const N: usize>(&self, index: usize) -> Result<Vec<[f32; N]>, Fault> {
        let accessor = self.accessor(index)?;
        let shape = format!("VEC{N}");
        let Some(one) = component_size(accessor.component_type).filter(|_| accessor.component_type != 5125) else {
            let found = accessor.component_type;
            return Err(bad(format!("accessor {index} has components of type {found}, which vectors can't have")));
        };
        if accessor.shape != shape {
            return Err(bad(format!("accessor {index} is a {}, where a {shape} is needed", accessor.shape)));
        }
        let read = |bytes: &[u8]| -> [f32; N] {
            std::array::from_fn(|k| {
                let at = k * one as usize;
                component(&bytes[at..at + one as usize], accessor.component_type, accessor.normalized)
            })
        };
        let size = one * N as u64;
        let mut vectors = match accessor.buffer_view {
            Some(view) => self.elements(accessor, view, accessor.count, size)?.into_iter().map(read).collect(),
            None => vec![[0.0; N]; accessor.count as usize],
        };
        if let Some(sparse) = &accessor.sparse {
            let needed = |view: Option<usize>| view.ok_or_else(|| bad(format!("accessor {index} lacks sparse data")));
            if sparse.count > accessor.count {
                return Err(bad(format!("accessor {index} replaces more elements than it has")));
            }
            let width = component_size(sparse.indices.component_type).unwrap_or(4);
            let at = self.elements(&sparse.indices, needed(sparse.indices.buffer_view)?, sparse.count, width)?;
            let values = self.elements(&sparse.values, needed(sparse.values.buffer_view)?, sparse.count, size)?;
            for (at, value) in at.into_iter().zip(values) {
                let place = vectors.get_mut(whole(at) as usize);
                *place.ok_or_else(|| bad(format!("accessor {index} replaces an element that it has not")))? =
                    read(value);
            }
        }
        Ok(vectors)
    }

    /// Indices of vertices.
    pub fn indices(&self, index: usize) -> Result<Vec<u32>, Fault> {
        let accessor = self.accessor(index)?;
        let size = match (accessor.component_type, accessor.shape.as_str()) {
            (5121 | 5123 | 5125, "SCALAR") => component_size(accessor.component_type).unwrap_or(4),
            _ => return Err(bad(format!("accessor {index} holds no indices: unsigned scalars are needed"))),
        };
        let Some(view) = accessor.buffer_view.filter(|_| accessor.sparse.is_none()) else {
            return Err(Fault::Unsupported(format!("accessor {index} holds sparse indices; export plain ones")));
        };
        Ok(self.elements(accessor, view, accessor.count, size)?.into_iter().map(whole).collect())
    }
}
