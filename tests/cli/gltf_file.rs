//! Small glTF files for tests, and a look into those that were written.

use image::{ImageFormat, RgbImage};
use serde_json::Value;
use std::fs;
use std::io::Cursor;
use std::path::Path;

/// An image as PNG.
pub fn png(image: &RgbImage) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A GLB of this text and these bytes.
pub fn glb(text: &str, binary: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], with: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let (text, binary) = (padded(text.as_bytes(), b' '), padded(binary, 0));
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((12 + 8 + text.len() as u32 + 8 + binary.len() as u32).to_le_bytes());
    for (kind, bytes) in [(b"JSON", text), (b"BIN\0", binary)] {
        out.extend((bytes.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(bytes);
    }
    out
}

/// A file that was read.
pub struct Gltf {
    pub text: String,
    pub json: Value,
    pub binary: Vec<u8>,
}

impl Gltf {
    /// A GLB, or a .gltf file without a binary chunk.
    pub fn read(path: &Path) -> Gltf {
        let bytes = fs::read(path).unwrap();
        let (text, binary) = if bytes.starts_with(b"glTF") {
            let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
            assert_eq!(word(8), bytes.len(), "{}", path.display());
            let end = 20 + word(12);
            assert_eq!(end % 4, 0);
            (String::from_utf8(bytes[20..end].to_vec()).unwrap(), bytes[end + 8..][..word(end)].to_vec())
        } else {
            (String::from_utf8(bytes).unwrap(), Vec::new())
        };
        let json = serde_json::from_str(&text).unwrap();
        Gltf { text, json, binary }
    }

    /// The bytes of a buffer view in the binary chunk.
    pub fn view(&self, index: usize) -> &[u8] {
        let view = &self.json["bufferViews"][index];
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        &self.binary[start..][..view["byteLength"].as_u64().unwrap() as usize]
    }

    /// The bytes of an image in the binary chunk.
    pub fn image(&self, index: usize) -> &[u8] {
        self.view(self.json["images"][index]["bufferView"].as_u64().unwrap() as usize)
    }

    /// A texture of a material by its place, as `/normalTexture`.
    pub fn texture(&self, material: usize, place: &str) -> &Value {
        let index = self.json["materials"][material].pointer(place).unwrap()["index"].as_u64().unwrap();
        &self.json["textures"][index as usize]
    }

    /// The image of a texture for loaders that know KHR_texture_basisu.
    pub fn basisu(&self, material: usize, place: &str) -> &[u8] {
        let texture = self.texture(material, place);
        self.image(texture["extensions"]["KHR_texture_basisu"]["source"].as_u64().unwrap() as usize)
    }
}

/// All levels of a KTX2 file of four channels.
pub fn levels(ktx2: &[u8]) -> Vec<Vec<[u8; 4]>> {
    let reader = ktx2::Reader::new(ktx2).unwrap();
    assert_eq!(reader.header().format, Some(ktx2::Format::R8G8B8A8_UNORM));
    let texels = |level: ktx2::Level| level.data.chunks_exact(4).map(|texel| texel.try_into().unwrap()).collect();
    reader.levels().map(texels).collect()
}

/// A quad with materials; `materials` is the JSON of their list, and textures 0, 1 and 2 have a normal map, a map of occlusion,
/// roughness and metallic, and a colour. Views of geometry lie before, between and behind those of images, and there are things that
/// nobody here knows.
pub fn quad(materials: &str) -> Vec<u8> {
    let (text, binary) = quad_parts(materials);
    glb(&text, &binary)
}

/// Its JSON and its bytes.
pub fn quad_parts(materials: &str) -> (String, Vec<u8>) {
    let normal = RgbImage::from_fn(8, 4, |i, _| image::Rgb(if i % 2 < 1 { [176, 128, 246] } else { [80, 128, 246] }));
    let orm = RgbImage::from_fn(8, 4, |i, _| image::Rgb([200, 100, if i < 4 { 0 } else { 255 }]));
    let colour = RgbImage::from_pixel(2, 2, image::Rgb([255, 0, 0]));
    quad_with(materials, [normal, orm, colour].each_ref().map(png))
}

/// The same with other images, as files.
pub fn quad_with(materials: &str, [normal, orm, colour]: [Vec<u8>; 3]) -> (String, Vec<u8>) {
    let floats = |values: &[f32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let parts = [
        floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]),
        normal,
        floats(&[0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]),
        orm,
        [0u16, 1, 2, 2, 1, 3].into_iter().flat_map(u16::to_le_bytes).collect(),
        colour,
        floats(&[0.0, 0.0, 1.0].repeat(4)),
        floats(&[1.0, 0.0, 0.0, 1.0].repeat(4)),
    ];
    let (mut binary, mut views) = (Vec::new(), Vec::new());
    for part in &parts {
        binary.resize(binary.len().next_multiple_of(4), 0);
        views.push(format!("{{\"buffer\":0, \"byteOffset\":{},\"byteLength\":{}}}", binary.len(), part.len()));
        binary.extend(part);
    }
    let count = serde_json::from_str::<Value>(materials).unwrap().as_array().unwrap().len();
    let primitive = |material: usize| {
        format!(
            "{{\"attributes\":{{\"POSITION\":0,\"TEXCOORD_0\":1,\"NORMAL\":3,\"TANGENT\":4}},\"indices\":2,\"material\":{material}}}"
        )
    };
    let primitives: Vec<String> = (0..count).map(primitive).collect();
    let text = format!(
        r#"{{
  "asset": {{"version": "2.0", "generator": "by hand", "extras": {{"odd": [1.50e0, -0.0, 1e2]}}}},
  "extensionsUsed": ["KHR_texture_transform", "ACME_unknown"],
  "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
  "meshes": [{{"primitives": [{}]}}],
  "extensions": {{"ACME_unknown": {{"z": 0.10, "a": "\u00e9", "list": [ 1 , 2 ]}}}},
  "accessors": [
    {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}},
    {{"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}},
    {{"bufferView": 4, "componentType": 5123, "count": 6, "type": "SCALAR"}},
    {{"bufferView": 6, "componentType": 5126, "count": 4, "type": "VEC3"}},
    {{"bufferView": 7, "componentType": 5126, "count": 4, "type": "VEC4"}}],
  "materials": {materials},
  "textures": [{{"source": 0, "name": "bumps"}}, {{"sampler": 0, "source": 1}}, {{"source": 2}}],
  "samplers": [{{"magFilter": 9728, "minFilter": 9728, "wrapS": 33071}}],
  "images": [{{"bufferView": 1, "mimeType": "image/png", "name": "normal"}}, {{"mimeType": "image/png", "bufferView": 3}},
    {{"bufferView": 5, "mimeType": "image/png", "extras": {{"of": "ours"}}}}],
  "bufferViews": [{}],
  "buffers": [{{"byteLength": {}}}]
}}"#,
        primitives.join(", "),
        views.join(", "),
        binary.len()
    );
    (text, binary)
}
