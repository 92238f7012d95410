//! The part of glTF 2.0's JSON that says which images a material has (specification, section 3.8 and 3.9), as it is written: indices
//! are checked where they are used.

use super::fault::Fault;
use super::uri::file_of;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A document.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Document {
    pub asset: Asset,
    pub extensions_used: Vec<String>,
    pub extensions_required: Vec<String>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub images: Vec<Image>,
    pub samplers: Vec<Sampler>,
    pub buffer_views: Vec<View>,
    pub buffers: Vec<Buffer>,
}

/// Version of the format.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Asset {
    pub version: String,
}

/// A material.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Material {
    pub name: Option<String>,
    pub pbr_metallic_roughness: MetallicRoughness,
    pub normal_texture: Option<TextureInfo>,
    pub occlusion_texture: Option<TextureInfo>,
    pub extensions: BTreeMap<String, Value>,
}

/// The part of a material that says its roughness.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct MetallicRoughness {
    pub roughness_factor: Option<f64>,
    pub metallic_roughness_texture: Option<TextureInfo>,
}

/// KHR_materials_clearcoat: the part that says how the coat shines.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct ClearCoat {
    pub clearcoat_roughness_factor: f64,
    pub clearcoat_roughness_texture: Option<TextureInfo>,
    pub clearcoat_normal_texture: Option<TextureInfo>,
}

/// A texture of a material.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct TextureInfo {
    pub index: usize,
    #[serde(default)]
    pub tex_coord: u32,
    /// Of normal textures.
    pub scale: Option<f64>,
    #[serde(default)]
    pub extensions: InfoExtensions,
}

/// What may stand at a texture of a material.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct InfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub transform: Option<Transform>,
}

/// KHR_texture_transform; its `texCoord` replaces that of the texture.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(default, rename_all = "camelCase")]
pub struct Transform {
    pub offset: [f64; 2],
    pub rotation: f64,
    pub scale: [f64; 2],
    pub tex_coord: Option<u32>,
}

impl Default for Transform {
    fn default() -> Transform {
        Transform { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None }
    }
}

impl TextureInfo {
    /// Set of texture coordinates, and what is done to them.
    pub fn place(&self) -> (u32, Transform) {
        let transform = self.extensions.transform.unwrap_or_default();
        (transform.tex_coord.unwrap_or(self.tex_coord), Transform { tex_coord: None, ..transform })
    }
}

/// An image with a sampler.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Texture {
    pub sampler: Option<usize>,
    pub source: Option<usize>,
    pub extensions: BTreeMap<String, Value>,
}

impl Texture {
    /// Every image that it names: its own, and those of extensions for loaders that know them.
    pub fn sources(&self) -> impl Iterator<Item = (&str, usize)> {
        let own = self.source.map(|source| ("", source));
        let others = self
            .extensions
            .iter()
            .filter_map(|(name, value)| Some((name.as_str(), usize::try_from(value.get("source")?.as_u64()?).ok()?)));
        own.into_iter().chain(others)
    }
}

/// Where the bytes of an image lie.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Image {
    pub name: Option<String>,
    pub uri: Option<String>,
    pub buffer_view: Option<usize>,
}

/// How a texture is read.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Sampler {
    pub min_filter: Option<u32>,
    pub wrap_s: Option<u32>,
    pub wrap_t: Option<u32>,
}

/// A part of a buffer.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct View {
    pub buffer: usize,
    pub byte_offset: u64,
    pub byte_length: u64,
    pub extensions: BTreeMap<String, Value>,
}

/// Bytes beside or in the file.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Buffer {
    pub uri: Option<String>,
    pub byte_length: u64,
}

impl Document {
    /// The document of a JSON text.
    ///
    /// # Errors
    /// Bad, for other JSON; unsupported, for another version.
    pub fn read(text: &str) -> Result<Document, Fault> {
        let read: Result<Document, _> = serde_json::from_str(text);
        let document =
            read.map_err(|error| Fault::bad(format!("its JSON is not that of glTF: {error}; export it anew")))?;
        if !document.asset.version.starts_with("2.") {
            let found = &document.asset.version;
            return Err(Fault::unsupported(format!("it is glTF version '{found}'; export it as version 2")));
        }
        Ok(document)
    }

    /// Files beside the document that it names, each once.
    ///
    /// # Errors
    /// Unsupported, for what lies elsewhere.
    pub fn files(&self) -> Result<Vec<PathBuf>, Fault> {
        let buffers = self.buffers.iter().map(|buffer| &buffer.uri);
        let uris = buffers.chain(self.images.iter().map(|image| &image.uri)).flatten();
        let mut files = Vec::new();
        for uri in uris.filter(|uri| !uri.starts_with("data:")) {
            let file = file_of(uri)?;
            if !files.contains(&file) {
                files.push(file);
            }
        }
        Ok(files)
    }

    /// A texture by its number.
    ///
    /// # Errors
    /// Bad, when there is none.
    pub fn texture(&self, index: usize) -> Result<&Texture, Fault> {
        self.textures.get(index).ok_or_else(|| missing("texture", index, self.textures.len()))
    }

    /// An image by its number.
    ///
    /// # Errors
    /// Bad, when there is none.
    pub fn image(&self, index: usize) -> Result<&Image, Fault> {
        self.images.get(index).ok_or_else(|| missing("image", index, self.images.len()))
    }

    /// The sampler of a texture; that of all defaults where it names none.
    ///
    /// # Errors
    /// Bad, when there is none of its number.
    pub fn sampler(&self, texture: &Texture) -> Result<Sampler, Fault> {
        let Some(index) = texture.sampler else { return Ok(Sampler::default()) };
        self.samplers.get(index).cloned().ok_or_else(|| missing("sampler", index, self.samplers.len()))
    }
}

/// Of something that is asked for and not there.
pub fn missing(what: &str, index: usize, there: usize) -> Fault {
    Fault::bad(format!("it asks for {what} {index}, {there} are there; export it anew"))
}
