//! Materials of a glTF file: which images they have, how these lie on the mesh, and what is not drawn of them.

use super::document::{Looks, Material};
use super::images::{Image, bytes_of, image_of};
use crate::exit::{Exit, Failure};
use crate::gltf::container::Container;
use crate::gltf::document::{Document, TextureInfo, missing};
use crate::gltf::fault::Fault;
use crate::gltf::source::Source;
use crate::output;
use glam::{Affine2, DMat2, DVec2};
use glint_view::methods::textures::{Edge, SLOTS, Texture, Textured, TexturedMaterial};
use glint_view::scene::{Look, Mesh};
use std::collections::BTreeMap;
use std::path::Path;

/// What is said of a file, at most: it may have any number of materials.
const MOST_NOTES: usize = 20;

/// Where glTF's images in KTX2 stand.
const BASISU: &str = "KHR_texture_basisu";
const EMISSIVE_STRENGTH: &str = "KHR_materials_emissive_strength";

/// The materials of the file that `mesh` was read from, and what the user should know of them. At most `limit` bytes are read of each
/// file, and decompressed of each image.
///
/// # Errors
/// What is wrong with the file or with an image that a material of the mesh has.
pub fn materials_of(path: &Path, mesh: &Mesh, limit: u64) -> Result<(Textured, Vec<String>), Failure> {
    let at = |fault: Fault| fault.at(path);
    let container = Container::read(&bytes_of(path, limit)?).map_err(at)?;
    let document = Document::read(&container.text).map_err(at)?;
    let looks = Looks::read(&container.text).map_err(at)?;
    let folder = output::folder_of(path);
    let source = Source { document: &document, binary: container.binary.as_deref(), folder, limit };
    let mut reader = Reader { path, source, looks: &looks, images: BTreeMap::new(), notes: Vec::new() };
    // Parts with the same material may lie on it in another way.
    let mut seen: Vec<Look> = Vec::new();
    let mut materials = Vec::new();
    let mut parts = Vec::new();
    for part in &mesh.parts {
        let known = seen.iter().position(|look| *look == part.look);
        parts.push(match known {
            Some(index) => index,
            None => {
                materials.push(reader.material(&part.look)?);
                seen.push(part.look);
                seen.len() - 1
            }
        });
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut notes = reader.notes;
    notes.sort();
    notes.dedup();
    if notes.len() > MOST_NOTES {
        let more = notes.len() - MOST_NOTES;
        notes.truncate(MOST_NOTES);
        notes.push(format!("and {more} more of such notes"));
    }
    Ok((Textured { name, materials, parts }, notes))
}

struct Reader<'a> {
    path: &'a Path,
    source: Source<'a>,
    looks: &'a Looks,
    /// Images by their number and whether they hold encoded colours; what is wrong with those that are not read.
    images: BTreeMap<(usize, bool), Result<Image, Failure>>,
    notes: Vec<String>,
}

/// Where a texture of a material stands.
struct Slot<'a> {
    name: &'static str,
    info: Option<&'a TextureInfo>,
    /// Whether it holds encoded colours.
    srgb: bool,
}

impl Reader<'_> {
    fn material(&mut self, look: &Look) -> Result<TexturedMaterial, Failure> {
        let Some(number) = look.material else { return Ok(TexturedMaterial::default()) };
        let looks = self.looks;
        let there = looks.materials.len();
        let material = looks.materials.get(number).ok_or_else(|| missing("material", number, there).at(self.path))?;
        let label = material.label(number);
        material.check().map_err(|fault| fault.of(&label).at(self.path))?;
        self.say_what_is_not_drawn(material, &label);
        let core = &material.pbr_metallic_roughness;
        let occlusion = material.occlusion_texture.as_ref();
        let slot = |name, info, srgb| Slot { name, info, srgb };
        let slots: [Slot<'_>; SLOTS] = [
            slot("baseColorTexture", core.base_color_texture.as_ref(), true),
            slot("normalTexture", material.normal_texture.as_ref(), false),
            slot("metallicRoughnessTexture", core.metallic_roughness_texture.as_ref(), false),
            slot("occlusionTexture", occlusion.map(|occlusion| &occlusion.info), false),
            slot("emissiveTexture", material.emissive_texture.as_ref(), true),
        ];
        let mut textures = [const { None }; SLOTS];
        for (texture, slot) in textures.iter_mut().zip(slots) {
            if let Some(info) = slot.info {
                *texture = self.texture(look, info, &slot, &label)?;
            }
        }
        let strength = material.extensions.get(EMISSIVE_STRENGTH).and_then(|of| of.get("emissiveStrength")?.as_f64());
        let [r, g, b, _] = core.base_color_factor;
        Ok(TexturedMaterial {
            base_colour: Some([r, g, b]),
            metallic: core.metallic_factor,
            roughness: core.roughness_factor,
            normal_scale: material.normal_texture.as_ref().and_then(|info| info.scale).unwrap_or(1.0) as f32,
            occlusion_strength: occlusion.and_then(|occlusion| occlusion.strength).unwrap_or(1.0),
            emissive: material.emissive_factor.map(|factor| factor * strength.unwrap_or(1.0) as f32),
            textures,
        })
    }

    fn say_what_is_not_drawn(&mut self, material: &Material, label: &str) {
        let named = material.extensions.keys().filter(|name| *name != EMISSIVE_STRENGTH);
        let names: Vec<&str> = named.map(String::as_str).collect();
        if !names.is_empty() {
            self.notes.push(format!("{label} is drawn without {}", names.join(", ")));
        }
        if let Some(mode) = material.alpha_mode.as_deref().filter(|mode| *mode != "OPAQUE") {
            self.notes.push(format!("{label} is drawn opaque, its alphaMode is {mode}"));
        }
    }

    /// A texture of a material; none where it cannot lie on the mesh.
    fn texture(
        &mut self,
        look: &Look,
        info: &TextureInfo,
        slot: &Slot<'_>,
        label: &str,
    ) -> Result<Option<Texture>, Failure> {
        let (set, transform) = info.place();
        let turn = DMat2::from_cols(
            DVec2::new(transform.rotation.cos(), -transform.rotation.sin()),
            DVec2::new(transform.rotation.sin(), transform.rotation.cos()),
        );
        let linear = turn * DMat2::from_diagonal(transform.scale.into());
        let own = Affine2::from_mat2_translation(linear.as_mat2(), DVec2::from(transform.offset).as_vec2());
        let uv = if own == look.uv { Affine2::IDENTITY } else { own * look.uv.inverse() };
        if set != look.uv_set || !uv.is_finite() {
            self.notes.push(format!(
                "{label} is drawn without its {}, which does not lie on the texture coordinates of its normal texture",
                slot.name
            ));
            return Ok(None);
        }
        let place = format!("{label}, {}", slot.name);
        let texture = self.source.document.texture(info.index).map_err(|fault| fault.of(&place).at(self.path))?;
        let sampler = self.source.document.sampler(texture).map_err(|fault| fault.of(&place).at(self.path))?;
        let Image { image, plain } = self.image(info.index, slot.srgb, &place)?;
        Ok(Some(Texture { image, plain, edges: [edge(sampler.wrap_s), edge(sampler.wrap_t)], uv }))
    }

    /// The image of a texture: the one with mips where it is read, else the one for all loaders.
    fn image(&mut self, texture: usize, srgb: bool, place: &str) -> Result<Image, Failure> {
        let sources: Vec<(String, usize)> = {
            let texture = &self.source.document.textures[texture];
            let named = |wanted: &str| texture.sources().find(|(name, _)| *name == wanted);
            let all = [BASISU, "", "EXT_texture_webp"].into_iter().filter_map(named);
            all.map(|(name, image)| (name.to_owned(), image)).collect()
        };
        let mut first_failure = None;
        for (name, number) in sources {
            match self.read_image(number, srgb) {
                Ok(image) => {
                    if let Some(Failure { message, .. }) = first_failure {
                        self.notes.push(format!("{place}: its other image is drawn, since {message}"));
                    }
                    return Ok(image);
                }
                // Only kinds that other loaders know, too, have another image for those that do not.
                Err(failure) if failure.exit == Exit::Unsupported && name == BASISU => first_failure = Some(failure),
                Err(failure) => return Err(failure),
            }
        }
        Err(first_failure.unwrap_or_else(|| {
            let what = "has no image that is read; export it with PNG, JPEG or plain KTX2";
            Fault::unsupported(format!("{place}: texture {texture} {what}")).at(self.path)
        }))
    }

    fn read_image(&mut self, number: usize, srgb: bool) -> Result<Image, Failure> {
        if let Some(read) = self.images.get(&(number, srgb)) {
            return read.clone();
        }
        let label = format!("image {number}");
        let bytes = self.source.image(number).map_err(|fault| fault.at(self.path));
        let image = bytes.and_then(|bytes| image_of(self.path, &label, &bytes, srgb, self.source.limit));
        self.images.insert((number, srgb), image.clone());
        image
    }
}

/// What a sampler says of an axis.
fn edge(wrap: Option<u32>) -> Edge {
    match wrap {
        Some(33071) => Edge::Clamp,
        Some(33648) => Edge::Mirror,
        _ => Edge::Repeat,
    }
}
