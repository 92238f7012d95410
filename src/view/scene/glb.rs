//! glTF 2.0, as GLB (specification, section 4.4) or as JSON with buffers beside or inside it: the triangles of the default
//! scene. Materials, textures, skins and animations are passed over.
//!
//! The gltf crate is not used: 1.4 panics where a primitive's POSITION names an accessor that is not there, and refuses
//! files that require extensions of materials, which a viewer of geometry can pass over.

use super::accessor::{Document, Node, Primitive, Source};
use super::assemble::{Corner, MissingNormals, Part};
use super::fault::{Fault, read_file};
use super::mesh::{MAX_FILE_BYTES, MAX_TRIANGLES};
use glam::{Mat3, Mat4, Quat, Vec3, Vec4};
use std::path::Path;

/// Beginnings of the names of extensions that change no geometry, or that are read.
const HARMLESS: [&str; 7] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "KHR_mesh_quantization",
];

/// The triangles in the bytes of a `.glb` or `.gltf` file in `folder`.
pub(super) fn read(bytes: &[u8], folder: Option<&Path>) -> Result<Vec<Part>, Fault> {
    let (json, mut blob) = if bytes.starts_with(b"glTF") { chunks(bytes)? } else { (bytes, None) };
    let document: Document =
        serde_json::from_slice(json).map_err(|error| Fault::Bad(format!("its JSON is not that of glTF: {error}")))?;
    if !document.asset.version.starts_with("2.") {
        let found = &document.asset.version;
        return Err(Fault::Unsupported(format!("it is glTF version '{found}'; export it as version 2")));
    }
    if let Some(name) = document.extensions_required.iter().find(|name| !HARMLESS.iter().any(|h| name.starts_with(h))) {
        return Err(Fault::Unsupported(format!("it needs the extension {name}, which is not read; export without it")));
    }
    let mut buffers: Vec<Vec<u8>> = Vec::new();
    let mut left = MAX_FILE_BYTES;
    for (i, buffer) in document.buffers.iter().enumerate() {
        let mut data = match &buffer.uri {
            Some(uri) => fetch(uri, folder, left)?,
            None => blob
                .take()
                .map(<[u8]>::to_vec)
                .ok_or_else(|| Fault::Bad(format!("buffer {i} has no bytes in the file")))?,
        };
        if (data.len() as u64) < buffer.byte_length {
            let (found, expected) = (data.len(), buffer.byte_length);
            return Err(Fault::Bad(format!("buffer {i} has {found} bytes where {expected} are declared")));
        }
        data.truncate(buffer.byte_length as usize);
        left = left.saturating_sub(buffer.byte_length);
        buffers.push(data);
    }
    Walk { source: Source { document, buffers }, parts: Vec::new(), triangles: 0 }.run()
}

/// JSON and binary chunk of a GLB.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
    let word = |at: usize| {
        let four = bytes.get(at..at + 4).and_then(|four| four.try_into().ok());
        four.map(u32::from_le_bytes).ok_or_else(|| Fault::Bad(format!("it ends at byte {}", bytes.len())))
    };
    let version = word(4)?;
    if version != 2 {
        return Err(Fault::Unsupported(format!("it is GLB version {version}; export it as version 2")));
    }
    let length = word(8)? as usize;
    if length > bytes.len() {
        return Err(Fault::Bad(format!("it has {} bytes where its header says {length}", bytes.len())));
    }
    let chunk = |at: usize| -> Result<(u32, &[u8], usize), Fault> {
        let (size, kind) = (word(at)? as usize, word(at + 4)?);
        let data = bytes[..length].get(at + 8..).and_then(|rest| rest.get(..size));
        let data = data.ok_or_else(|| Fault::Bad(format!("its chunk at byte {at} ends after the file")))?;
        Ok((kind, data, at + 8 + size))
    };
    let (kind, json, mut next) = chunk(12)?;
    if kind != u32::from_le_bytes(*b"JSON") {
        return Err(Fault::Bad("its first chunk is not JSON".to_owned()));
    }
    while next + 8 <= length {
        let (kind, data, after) = chunk(next)?;
        if kind == u32::from_le_bytes(*b"BIN\0") {
            return Ok((json, Some(data)));
        }
        next = after;
    }
    Ok((json, None))
}

/// Bytes that a URI stands for: `data:…;base64,…`, or a file beside this one.
fn fetch(uri: &str, folder: Option<&Path>, limit: u64) -> Result<Vec<u8>, Fault> {
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        let decoded = text.and_then(base64);
        return decoded.ok_or_else(|| Fault::Bad("a buffer's data URI is not base64".to_owned()));
    }
    let name = percent_decoded(uri);
    let relative = Path::new(&name).is_relative() && !uri.contains(':');
    let (Some(folder), true) = (folder, relative) else {
        return Err(Fault::Unsupported(format!(
            "a buffer lies at '{uri}'; only files beside the .gltf are read: export as GLB"
        )));
    };
    read_file(&folder.join(name), limit)
}

/// The bytes of `text` in base64 (RFC 4648, section 4), padding optional; `None` for anything else.
fn base64(text: &str) -> Option<Vec<u8>> {
    let digits = text.trim_end_matches('=');
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 3);
    let (mut bits, mut held) = (0u32, 0);
    for digit in digits.bytes() {
        let value = match digit {
            b'A'..=b'Z' => digit - b'A',
            b'a'..=b'z' => digit - b'a' + 26,
            b'0'..=b'9' => digit - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    Some(bytes)
}

fn percent_decoded(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let code = (bytes[i] == b'%').then(|| bytes.get(i + 1..i + 3)).flatten();
        let code = code.and_then(|hex| std::str::from_utf8(hex).ok()).and_then(|hex| u8::from_str_radix(hex, 16).ok());
        decoded.push(code.unwrap_or(bytes[i]));
        i += if code.is_some() { 3 } else { 1 };
    }
    String::from_utf8_lossy(&decoded).into_owned()
}

struct Walk {
    source: Source,
    parts: Vec<Part>,
    triangles: usize,
}

impl Walk {
    fn run(mut self) -> Result<Vec<Part>, Fault> {
        let document = &self.source.document;
        let count = document.nodes.len();
        let mut waiting: Vec<(usize, Mat4)> = match document.scenes.get(document.scene.unwrap_or(0)) {
            Some(scene) => scene.nodes.iter().map(|&node| (node, Mat4::IDENTITY)).collect(),
            None => {
                // Without scenes, all nodes that are nobody's children.
                let mut child = vec![false; count];
                for &node in document.nodes.iter().flat_map(|node| &node.children) {
                    child.get_mut(node).into_iter().for_each(|child| *child = true);
                }
                (0..count).filter(|&node| !child[node]).map(|node| (node, Mat4::IDENTITY)).collect()
            }
        };
        waiting.reverse();
        let mut seen = vec![false; count];
        while let Some((index, parent)) = waiting.pop() {
            let Some(node) = self.source.document.nodes.get(index) else {
                return Err(Fault::Bad(format!("node {index} is asked for, but not there")));
            };
            if std::mem::replace(&mut seen[index], true) {
                return Err(Fault::Bad(format!("node {index} is in the scene twice: nodes are a tree")));
            }
            let world = parent * transform(node);
            waiting.extend(node.children.iter().rev().map(|&child| (child, world)));
            let Some(mesh) = node.mesh else { continue };
            let Some(mesh) = self.source.document.meshes.get(mesh) else {
                return Err(Fault::Bad(format!("mesh {mesh} is asked for, but not there")));
            };
            for primitive in &mesh.primitives {
                let part = self.part(primitive, world)?;
                self.triangles += part.triangles();
                if self.triangles > MAX_TRIANGLES {
                    return Err(Fault::TooLarge(format!("it has more than {MAX_TRIANGLES} triangles, the limit")));
                }
                self.parts.push(part);
            }
        }
        Ok(self.parts)
    }

    /// The triangles of a primitive in the world; none for points and lines.
    fn part(&self, primitive: &Primitive, world: Mat4) -> Result<Part, Fault> {
        let mut part = Part { corners: Vec::new(), missing: MissingNormals::Flat };
        let mode = primitive.mode.unwrap_or(4);
        if !(4..=6).contains(&mode) {
            return Ok(part);
        }
        let source = &self.source;
        let Some(&position) = primitive.attributes.get("POSITION") else { return Ok(part) };
        let positions = source.vectors::<3>(position)?;
        let get = |name: &str| primitive.attributes.get(name).copied();
        let normals = get("NORMAL").map(|index| source.vectors::<3>(index)).transpose()?;
        let tangents = get("TANGENT").map(|index| source.vectors::<4>(index)).transpose()?;
        let uv = get("TEXCOORD_0").map(|index| source.vectors::<2>(index)).transpose()?;
        let order = match primitive.indices {
            Some(index) => source.indices(index)?,
            None => (0..positions.len() as u32).collect(),
        };
        if let Some(&wrong) = order.iter().find(|&&index| index as usize >= positions.len()) {
            let count = positions.len();
            return Err(Fault::Bad(format!("a triangle asks for vertex {wrong} of {count}")));
        }
        let linear = Mat3::from_mat4(world);
        // Normals go with the inverse transpose, which is this but for a positive factor; it exists for flat scales too.
        let side = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
        let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
        let normal_matrix = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * side;
        let corner = |index: u32| {
            let i = index as usize;
            let normal = normals.as_ref().and_then(|n| n.get(i)).map(|&n| normal_matrix * Vec3::from(n));
            let tangent = tangents.as_ref().and_then(|t| t.get(i)).map(|&t| {
                let along = linear * Vec4::from(t).truncate();
                along.extend(t[3] * side)
            });
            Corner {
                position: world.transform_point3(positions[i].into()),
                point: index,
                normal,
                uv: uv.as_ref().and_then(|uv| uv.get(i)).map(|&uv| uv.into()),
                tangent,
            }
        };
        for [a, b, c] in triangles(&order, mode) {
            if a != b && b != c && c != a {
                let (b, c) = if side < 0.0 { (c, b) } else { (b, c) };
                part.corners.extend([corner(a), corner(b), corner(c)]);
            }
        }
        Ok(part)
    }
}

/// Triangles of a list (mode 4), strip (5) or fan (6), section 3.7.2.1.
fn triangles(order: &[u32], mode: u32) -> Vec<[u32; 3]> {
    let all = order.windows(3);
    match mode {
        4 => order.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        5 => all.enumerate().map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] }).collect(),
        _ => all.map(|t| [t[1], t[2], order[0]]).collect(),
    }
}

/// The node's own transform, section 3.5.3.
fn transform(node: &Node) -> Mat4 {
    if let Some(matrix) = node.matrix {
        return Mat4::from_cols_array(&matrix);
    }
    let rotation = Quat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    let unit = if rotation.length_squared() > 0.0 { rotation.normalize() } else { Quat::IDENTITY };
    Mat4::from_scale_rotation_translation(node.scale.unwrap_or([1.0; 3]).into(), unit, node.translation.into())
}
