//! Numbers out of the buffers of a glTF file (specification, sections 3.6 and 3.11). Every index, offset and count is checked
//! before use; integer components are read too (KHR_mesh_quantization). What is read is what is asked for, element by
//! element: a count that lies costs nothing.

use super::document::{Accessor, Document};
use super::fault::Fault;
use super::mesh::MAX_TRIANGLES;
use std::collections::HashMap;

/// Elements of an accessor, at most: every corner of every triangle.
pub(super) const MAX_COUNT: u64 = 3 * MAX_TRIANGLES as u64;

const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// A document with the bytes of its buffers.
#[derive(Debug)]
pub(super) struct Source {
    pub document: Document,
    pub buffers: Vec<Vec<u8>>,
}

/// Places of one size in a buffer, at equal distances.
#[derive(Clone, Copy, Debug)]
struct Elements<'a> {
    /// From the first byte of the first element to the last of the last.
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Elements<'a> {
    fn get(&self, i: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..][..self.size]
    }
}

/// An accessor of vectors of `N` numbers.
#[derive(Debug)]
pub(super) struct Vectors<'a, const N: usize> {
    count: usize,
    elements: Option<Elements<'a>>,
    replaced: HashMap<u32, &'a [u8]>,
    component_type: u32,
    normalized: bool,
}

impl<const N: usize> Vectors<'_, N> {
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether the numbers are stored as integers.
    pub fn is_quantised(&self) -> bool {
        self.component_type != FLOAT
    }

    /// Vector `i`, which is less than [`Vectors::len`]; zeros where the file has none.
    pub fn get(&self, i: usize) -> [f32; N] {
        let replaced = self.replaced.get(&(i as u32)).copied();
        let Some(bytes) = replaced.or_else(|| Some(self.elements?.get(i))) else { return [0.0; N] };
        let size = bytes.len() / N;
        std::array::from_fn(|k| component(&bytes[k * size..][..size], self.component_type, self.normalized))
    }
}

fn bad(what: String) -> Fault {
    Fault::Bad(what)
}

/// Bytes of one component.
fn component_size(component_type: u32) -> Option<u64> {
    match component_type {
        5120 | 5121 => Some(1),
        5122 | 5123 => Some(2),
        UNSIGNED_INT | FLOAT => Some(4),
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
        (FLOAT, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
        _ => f32::NAN,
    }
}

/// An index as a number.
fn whole(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte))
}

/// Bytes of one index.
fn index_size(component_type: u32) -> Option<u64> {
    component_size(component_type).filter(|_| matches!(component_type, 5121 | 5123 | UNSIGNED_INT))
}

impl Source {
    /// `count` elements of `size` bytes from byte `offset` of a buffer view on.
    fn elements(&self, view: usize, offset: u64, count: u64, size: u64) -> Result<Elements<'_>, Fault> {
        let number = view;
        let Some(view) = self.document.buffer_views.get(view) else {
            let there = self.document.buffer_views.len();
            return Err(bad(format!("it asks for buffer view {number}, {there} are there")));
        };
        let Some(buffer) = self.buffers.get(view.buffer) else {
            let (asked, there) = (view.buffer, self.buffers.len());
            return Err(bad(format!("buffer view {number} asks for buffer {asked}, {there} are there")));
        };
        let stride = view.byte_stride.filter(|&stride| stride > 0).unwrap_or(size);
        let range = |start: u64, end: Option<u64>| Some(usize::try_from(start).ok()?..usize::try_from(end?).ok()?);
        let viewed = range(view.byte_offset, view.byte_offset.checked_add(view.byte_length));
        let Some(viewed) = viewed.and_then(|range| buffer.get(range)) else {
            let (start, length, there) = (view.byte_offset, view.byte_length, buffer.len());
            return Err(bad(format!(
                "buffer view {number} has {length} bytes from byte {start} on, buffer {} has {there}",
                view.buffer
            )));
        };
        let last = count.checked_sub(1).map(|last| last.checked_mul(stride).and_then(|at| at.checked_add(size)));
        let length = last.unwrap_or(Some(0));
        let used = range(offset, length.and_then(|length| length.checked_add(offset)));
        let Some(bytes) = used.and_then(|range| viewed.get(range)) else {
            let there = viewed.len();
            return Err(bad(format!(
                "its {count} elements of {size} bytes, {stride} apart from byte {offset} on, end after buffer view \
                 {number} of {there} bytes"
            )));
        };
        // A stride that does not fit has not more than one element.
        Ok(Elements { bytes, stride: usize::try_from(stride).unwrap_or(0), size: size as usize })
    }

    fn accessor(&self, index: usize) -> Result<&Accessor, Fault> {
        let there = self.document.accessors.len();
        let accessor = self.document.accessors.get(index);
        let accessor = accessor.ok_or_else(|| bad(format!("it asks for accessor {index}, {there} are there")))?;
        if accessor.count > MAX_COUNT {
            let found = accessor.count;
            return Err(Fault::TooLarge(format!("accessor {index} has {found} elements, {MAX_COUNT} are the limit")));
        }
        Ok(accessor)
    }

    /// Elements that a sparse accessor replaces, with what replaces them.
    fn replaced(&self, accessor: &Accessor, size: u64) -> Result<HashMap<u32, &[u8]>, Fault> {
        let Some(sparse) = &accessor.sparse else { return Ok(HashMap::new()) };
        if sparse.count > accessor.count {
            let (replaced, count) = (sparse.count, accessor.count);
            return Err(bad(format!("it replaces {replaced} elements, but has {count}")));
        }
        let Some(width) = index_size(sparse.indices.component_type) else {
            let found = sparse.indices.component_type;
            return Err(bad(format!("its sparse indices have components of type {found}, not 5121, 5123 or 5125")));
        };
        let places = self.elements(sparse.indices.buffer_view, sparse.indices.byte_offset, sparse.count, width)?;
        let values = self.elements(sparse.values.buffer_view, sparse.values.byte_offset, sparse.count, size)?;
        let mut replaced = HashMap::new();
        for i in 0..sparse.count as usize {
            let place = whole(places.get(i));
            if u64::from(place) >= accessor.count {
                return Err(bad(format!("it replaces element {place}, but has {}", accessor.count)));
            }
            replaced.insert(place, values.get(i));
        }
        Ok(replaced)
    }

    /// How many numbers of an accessor are looked at however few are used.
    pub fn replaced_count(&self, index: usize) -> u64 {
        let sparse = self.document.accessors.get(index).and_then(|accessor| accessor.sparse.as_ref());
        sparse.map_or(0, |sparse| sparse.count)
    }

    /// Vectors of `N` numbers.
    pub fn vectors<const N: usize>(&self, index: usize) -> Result<Vectors<'_, N>, Fault> {
        let accessor = self.accessor(index)?;
        let at = |fault: Fault| fault.of(&format!("accessor {index}"));
        let shape = format!("VEC{N}");
        let component_type = accessor.component_type;
        let Some(one) = component_size(component_type).filter(|_| component_type != UNSIGNED_INT) else {
            let what = format!("it has components of type {component_type}, vectors have 5120 to 5123 or 5126");
            return Err(at(bad(what)));
        };
        if accessor.shape != shape {
            return Err(at(bad(format!("it is a {}, where a {shape} is needed", accessor.shape))));
        }
        let size = one * N as u64;
        let elements = accessor.buffer_view.map(|view| self.elements(view, accessor.byte_offset, accessor.count, size));
        Ok(Vectors {
            count: accessor.count as usize,
            elements: elements.transpose().map_err(at)?,
            replaced: self.replaced(accessor, size).map_err(at)?,
            component_type,
            normalized: accessor.normalized,
        })
    }

    /// Indices of vertices.
    pub fn indices(&self, index: usize) -> Result<Vec<u32>, Fault> {
        let accessor = self.accessor(index)?;
        let at = |fault: Fault| fault.of(&format!("accessor {index}"));
        let Some(size) = index_size(accessor.component_type).filter(|_| accessor.shape == "SCALAR") else {
            let (shape, found) = (&accessor.shape, accessor.component_type);
            let what = format!("it holds no indices but {shape} of type {found}; unsigned scalars are needed");
            return Err(at(bad(what)));
        };
        let count = accessor.count as usize;
        let mut indices = match accessor.buffer_view {
            Some(view) => {
                let elements = self.elements(view, accessor.byte_offset, accessor.count, size).map_err(at)?;
                (0..count).map(|i| whole(elements.get(i))).collect()
            }
            None => vec![0; count],
        };
        for (place, value) in self.replaced(accessor, size).map_err(at)? {
            indices[place as usize] = whole(value);
        }
        Ok(indices)
    }
}
