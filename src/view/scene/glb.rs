//! glTF 2.0, as GLB (specification, section 4.4) or as JSON with buffers beside or inside it: the triangles of the default
//! scene, and which material each has. Of materials only the uv of their textures are read; skins and animations are passed over.
//!
//! The gltf crate is not used: 1.4 panics where a primitive's POSITION names an accessor that is not there, and refuses
//! files that require extensions of materials, which a viewer of geometry can pass over.

use super::accessor::{MAX_COUNT, Source};
use super::assemble::{Corner, MissingNormals, Part, Parts};
use super::document::{Document, Node, Primitive};
use super::fault::{Fault, without_mark};
use super::mesh::{Look, MAX_FILE_BYTES, MAX_TRIANGLES};
use super::{texture, uri};
use glam::{Mat3, Mat4, Quat, Vec2, Vec3, Vec4};
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
pub(super) fn read(bytes: &[u8], folder: Option<&Path>) -> Result<Parts, Fault> {
    let (json, mut blob) = if bytes.starts_with(b"glTF") { chunks(bytes)? } else { (bytes, None) };
    let document: Document = serde_json::from_slice(without_mark(json)?)
        .map_err(|error| Fault::Bad(format!("its JSON is not that of glTF: {error}")))?;
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
        let bytes = match &buffer.uri {
            Some(uri) => uri::fetch(uri, folder, left),
            None => blob.take().map(<[u8]>::to_vec).ok_or_else(|| Fault::Bad("it has no bytes in the file".to_owned())),
        };
        let mut data = bytes.map_err(|fault| fault.of(&format!("buffer {i}")))?;
        left = left.saturating_sub(data.len() as u64);
        if (data.len() as u64) < buffer.byte_length {
            let (found, expected) = (data.len(), buffer.byte_length);
            return Err(Fault::Bad(format!("buffer {i} has {found} bytes where {expected} are declared")));
        }
        data.truncate(buffer.byte_length as usize);
        buffers.push(data);
    }
    let source = Source { document, buffers };
    let mut walk = Walk { source: &source, read: Parts::default(), triangles: 0, replaced: 0, passed: None };
    walk.run()?;
    match walk.passed {
        Some(passed) if walk.read.parts.iter().all(|part| part.order.is_empty()) => {
            Err(Fault::Bad(format!("there are no triangles in it: {passed}")))
        }
        _ => Ok(walk.read),
    }
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

struct Walk<'a> {
    source: &'a Source,
    read: Parts,
    /// Triangles so far, those that are dropped included: they cost time too.
    triangles: usize,
    /// Elements of sparse accessors so far, which are looked at for each primitive.
    replaced: u64,
    /// The first primitive without triangles, and why.
    passed: Option<String>,
}

impl Walk<'_> {
    fn run(&mut self) -> Result<(), Fault> {
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
            let Some(node) = document.nodes.get(index) else {
                return Err(Fault::Bad(format!("the scene asks for node {index}, {count} are there")));
            };
            if std::mem::replace(&mut seen[index], true) {
                return Err(Fault::Bad(format!("node {index} is in the scene twice: nodes are a tree")));
            }
            let world = parent * transform(node);
            waiting.extend(node.children.iter().rev().map(|&child| (child, world)));
            let Some(number) = node.mesh else { continue };
            let Some(mesh) = document.meshes.get(number) else {
                let there = document.meshes.len();
                return Err(Fault::Bad(format!("node {index} asks for mesh {number}, {there} are there")));
            };
            for (i, primitive) in mesh.primitives.iter().enumerate() {
                let name = mesh.name.as_ref().map(|name| format!(" '{name}'")).unwrap_or_default();
                let name = format!("mesh {number}{name}, primitive {i}");
                let part = self.part(primitive, world, &name).map_err(|fault| fault.of(&name))?;
                self.read.parts.extend(part);
            }
        }
        Ok(())
    }

    /// A primitive's indices of vertices.
    fn order(&mut self, primitive: &Primitive, position: usize) -> Result<Vec<u32>, Fault> {
        // Compressed data may come with plain data beside them, which are read then.
        let plain = |index: usize| self.source.document.accessors.get(index).is_none_or(|a| a.buffer_view.is_some());
        if primitive.extensions.draco.is_some() && !plain(position) {
            let what = "its data are compressed by KHR_draco_mesh_compression, which is not read; export without it";
            return Err(Fault::Unsupported(what.to_owned()));
        }
        let accessors = primitive.attributes.values().copied().chain(primitive.indices);
        self.replaced += accessors.map(|index| self.source.replaced_count(index)).sum::<u64>();
        if self.replaced > MAX_COUNT {
            let what = format!("sparse accessors up to here have more than {MAX_COUNT} elements, the limit");
            return Err(Fault::TooLarge(what));
        }
        let count = self.source.vectors::<3>(position)?.len();
        let order = match primitive.indices {
            Some(index) => self.source.indices(index)?,
            None => (0..count as u32).collect(),
        };
        if let Some(at) = order.iter().position(|&index| index as usize >= count) {
            let wrong = order[at];
            return Err(Fault::Bad(format!("index {at} asks for vertex {wrong}, {count} are there")));
        }
        Ok(order)
    }

    /// The triangles of a primitive in the world; none for points and lines.
    fn part(&mut self, primitive: &Primitive, world: Mat4, name: &str) -> Result<Option<Part>, Fault> {
        let mode = primitive.mode.unwrap_or(4);
        let position = match (mode, primitive.attributes.get("POSITION")) {
            (4..=6, Some(&position)) => position,
            (0..=6, _) => {
                let why = match mode {
                    0 => "it has points",
                    1..=3 => "it has lines",
                    _ => "it has no POSITION",
                };
                self.passed.get_or_insert_with(|| format!("{name}: {why}"));
                return Ok(None);
            }
            _ => return Err(Fault::Bad(format!("its mode is {mode}, 0 to 6 are known"))),
        };
        let order = self.order(primitive, position)?;
        let source = self.source;
        self.triangles += if mode == 4 { order.len() / 3 } else { order.len().saturating_sub(2) };
        if self.triangles > MAX_TRIANGLES {
            let what = format!("up to here there are {} triangles, {MAX_TRIANGLES} are the limit", self.triangles);
            return Err(Fault::TooLarge(what));
        }
        let positions = source.vectors::<3>(position)?;
        let get = |name: &str| primitive.attributes.get(name).copied();
        let normals = get("NORMAL").map(|index| source.vectors::<3>(index)).transpose()?;
        let tangents = get("TANGENT").map(|index| source.vectors::<4>(index)).transpose()?;
        let first = get("TEXCOORD_0").map(|index| source.vectors::<2>(index)).transpose()?;
        let material = match primitive.material {
            Some(number) => Some(source.document.materials.get(number).ok_or_else(|| {
                let there = source.document.materials.len();
                Fault::Bad(format!("it asks for material {number}, {there} are there"))
            })?),
            None => None,
        };
        let (place, note) = texture::place(material, first.as_ref().is_some_and(|uv| uv.is_quantised()));
        self.read.notes.extend(note);
        let attribute = format!("TEXCOORD_{}", place.set);
        let uv =
            if place.set == 0 { first } else { get(&attribute).map(|index| source.vectors::<2>(index)).transpose()? };
        if uv.is_none() && place.set != 0 {
            self.read.notes.push(format!("{name}: its texture asks for {attribute}, which is missing"));
        }
        // Tangents of a file point along its own uv.
        let tangents = tangents.filter(|_| {
            if place.turns() {
                self.read.notes.push("a texture transform turns uv: tangents are computed".to_owned());
            }
            !place.turns()
        });
        let counts = [
            ("NORMAL", normals.as_ref().map(|normals| normals.len())),
            ("TANGENT", tangents.as_ref().map(|tangents| tangents.len())),
            (attribute.as_str(), uv.as_ref().map(|uv| uv.len())),
        ];
        for (attribute, found) in counts {
            let expected = positions.len();
            if let Some(found) = found.filter(|&found| found != expected) {
                return Err(Fault::Bad(format!("{attribute} has {found} elements, POSITION has {expected}")));
            }
        }
        let linear = Mat3::from_mat4(world);
        // Normals go with the inverse transpose, which is this but for a positive factor; it exists for flat scales too.
        let side = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
        let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
        let normal_matrix = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * side;
        let corner = |&index: &u32| {
            let i = index as usize;
            Corner {
                position: world.transform_point3(positions.get(i).into()),
                point: index,
                normal: normals.as_ref().map(|normals| normal_matrix * Vec3::from(normals.get(i))),
                uv: uv.as_ref().map(|uv| place.apply(Vec2::from(uv.get(i)))),
                tangent: tangents.as_ref().map(|tangents| {
                    let tangent = Vec4::from(tangents.get(i));
                    (linear * tangent.truncate()).extend(tangent.w * side)
                }),
            }
        };
        // Vertices that a triangle has, once each.
        let mut used = order.clone();
        used.sort_unstable();
        used.dedup();
        let place_of = |index: u32| used.binary_search(&index).unwrap_or_default() as u32;
        let corners: Vec<Corner> = used.iter().map(corner).collect();
        corners.iter().try_for_each(Corner::check).map_err(Fault::Bad)?;
        let look = Look { material: primitive.material, uv_set: place.set, uv: place.affine() };
        let mut part = Part { corners, order: Vec::new(), missing: MissingNormals::Flat, look };
        for [a, b, c] in triangles(&order, mode) {
            if a != b && b != c && c != a {
                let (b, c) = if side < 0.0 { (c, b) } else { (b, c) };
                part.order.extend([a, b, c].map(place_of));
            }
        }
        if part.order.is_empty() {
            self.passed.get_or_insert_with(|| format!("{name}: no three of its vertices are a triangle"));
        }
        Ok(Some(part))
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
