//! A glTF file with other textures: what is edited in its JSON, and where new images lie.

use super::binary::{self, Images};
use super::jobs::{Job, Layer, Use};
use super::uses::Free;
use crate::gltf::container::Container;
use crate::gltf::document::{Document, missing};
use crate::gltf::fault::Fault;
use crate::gltf::json::{Edits, Span, Text, quoted};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// The extension by which textures have images in KTX2.
const BASISU: &str = "KHR_texture_basisu";

const LINEAR: u32 = 9729;
const NEAREST: u32 = 9728;
const NEAREST_MIPMAP_NEAREST: u32 = 9984;
const LINEAR_MIPMAP_LINEAR: u32 = 9987;

/// An image to write.
#[derive(Clone, Debug)]
pub struct NewImage {
    pub bytes: Vec<u8>,
    /// `image/png` or `image/ktx2`.
    pub mime: &'static str,
}

/// An image of a texture.
#[derive(Clone, Debug)]
pub enum Picture {
    New(NewImage),
    /// One of the file's own.
    Kept(usize),
}

/// What a texture is made of.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// For every loader.
    pub source: Option<Picture>,
    /// For loaders that know [`BASISU`]; the same as the source where that is none.
    pub basisu: Option<Basisu>,
}

/// What stands in [`BASISU`].
#[derive(Clone, Debug)]
pub enum Basisu {
    Own(NewImage),
    /// The image of the source, for loaders that know either place.
    Source,
}

/// The two textures of a job.
#[derive(Clone, Debug)]
pub struct Baked {
    pub normal: Pictures,
    pub roughness: Pictures,
}

/// What the textures are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Normal,
    Roughness,
}

/// Numbers of the images that a texture got.
#[derive(Clone, Copy, Debug)]
struct Sources {
    source: Option<usize>,
    basisu: Option<usize>,
}

/// The file with other textures, and the files beside it that hold images.
pub struct Rewritten {
    pub container: Container,
    pub files: Vec<(String, Vec<u8>)>,
}

/// Gives the materials of every job its textures. `stem` is what names of files beside begin with; `required` says that loaders
/// have to know [`BASISU`].
///
/// # Errors
/// A GLB whose first buffer lies elsewhere, so that there is no place for images.
pub fn rewrite(
    container: &Container,
    document: &Document,
    json: &Value,
    jobs: &[(Job, Baked)],
    stem: &str,
    required: bool,
) -> Result<Rewritten, Fault> {
    let text = Text(&container.text);
    let only_jobs: Vec<Job> = jobs.iter().map(|(job, _)| job.clone()).collect();
    let kept =
        jobs.iter().flat_map(|(_, baked)| [&baked.normal, &baked.roughness]).filter_map(|pictures| {
            match pictures.source {
                Some(Picture::Kept(image)) => Some(image),
                _ => None,
            }
        });
    let free = Free::of(document, json, &only_jobs, &kept.collect());
    let mut writer = Writer {
        document,
        text,
        is_glb: container.is_glb(),
        stem,
        edits: Edits::default(),
        top: Vec::new(),
        free,
        taken: BTreeSet::new(),
        images: Vec::new(),
        in_binary: Images::default(),
        files: Vec::new(),
        textures: Vec::new(),
        known: BTreeMap::new(),
        samplers: Vec::new(),
        meant: BTreeMap::new(),
        uses_basisu: false,
    };
    if writer.is_glb && document.buffers.first().is_some_and(|buffer| buffer.uri.is_some()) {
        let what =
            "its first buffer lies beside it, so that there is no place in it for images; embed all buffers first";
        return Err(Fault::unsupported(what));
    }
    let materials = text.list("materials")?;
    for (index, (job, baked)) in jobs.iter().enumerate() {
        let normal = writer.place(&baked.normal, Some(job.normal), &format!("{index}-normal"))?;
        let roughness = writer.place(&baked.roughness, job.map, &format!("{index}-metallic-roughness"))?;
        for place in &job.uses {
            let sampler = document.texture(place.normal)?.sampler;
            let new_normal = writer.texture((index, Kind::Normal), Some(place.normal), sampler, normal)?;
            let sampler = place.roughness.map_or(Ok(sampler), |old| document.texture(old).map(|old| old.sampler))?;
            let new_roughness = writer.texture((index, Kind::Roughness), place.roughness, sampler, roughness)?;
            let occlusion = match place.occlusion {
                Some(old) => {
                    let sampler = document.texture(old)?.sampler;
                    Some(writer.texture((index, Kind::Roughness), Some(old), sampler, roughness)?)
                }
                None => None,
            };
            let material = materials.get(place.material).cloned().unwrap_or(text.whole());
            writer.material(&material, place, (new_normal, new_roughness, occlusion))?;
        }
    }
    writer.finish(container, required)
}

/// What a texture is made of, the one in whose place it is, and its sampler.
type Made = ((usize, Kind), Option<usize>, Option<usize>);

struct Writer<'a> {
    document: &'a Document,
    text: Text<'a>,
    is_glb: bool,
    stem: &'a str,
    edits: Edits,
    /// New members of the whole.
    top: Vec<(&'static str, String)>,
    free: Free,
    /// Images whose place has been taken.
    taken: BTreeSet<usize>,
    /// New images, textures and samplers behind those that are there.
    images: Vec<String>,
    textures: Vec<String>,
    samplers: Vec<String>,
    in_binary: Images,
    files: Vec<(String, Vec<u8>)>,
    /// Textures that were made.
    known: BTreeMap<Made, usize>,
    /// The sampler with mips of each sampler.
    meant: BTreeMap<Option<usize>, usize>,
    uses_basisu: bool,
}

impl Writer<'_> {
    /// Puts the images of a texture somewhere. `old` is the image that they are made of.
    fn place(&mut self, pictures: &Pictures, old: Option<usize>, name: &str) -> Result<Sources, Fault> {
        let source = match &pictures.source {
            Some(Picture::New(image)) => Some(self.image(image, old, name)?),
            Some(Picture::Kept(image)) => Some(*image),
            None => None,
        };
        let basisu = match &pictures.basisu {
            Some(Basisu::Own(image)) => Some(self.image(image, old, name)?),
            Some(Basisu::Source) => source,
            None => None,
        };
        Ok(Sources { source, basisu })
    }

    fn image(&mut self, image: &NewImage, old: Option<usize>, name: &str) -> Result<usize, Fault> {
        let place = old.filter(|old| self.free.images.contains(old) && self.taken.insert(*old));
        let mime = ("mimeType", quoted(image.mime));
        let bytes = if self.is_glb {
            let view = place.and_then(|old| self.document.images[old].buffer_view);
            let view = view.filter(|view| self.free.views.contains(view) && binary::stands_alone(self.document, *view));
            let view = match view {
                Some(view) => {
                    self.in_binary.replaced.insert(view, image.bytes.clone());
                    view
                }
                None => {
                    self.in_binary.added.push(image.bytes.clone());
                    self.document.buffer_views.len() + self.in_binary.added.len() - 1
                }
            };
            ("bufferView", view.to_string())
        } else {
            let extension = image.mime.trim_start_matches("image/");
            let file = format!("{}-{name}.{extension}", self.stem);
            let uri = percent_encoding::utf8_percent_encode(&file, percent_encoding::NON_ALPHANUMERIC).to_string();
            // Those that every URI may have.
            let uri = uri.replace("%2D", "-").replace("%2E", ".").replace("%5F", "_").replace("%7E", "~");
            self.files.push((file, image.bytes.clone()));
            ("uri", quoted(&uri))
        };
        let members = [bytes, mime];
        let Some(old) = place else {
            self.images.push(object(&members));
            return Ok(self.document.images.len() + self.images.len() - 1);
        };
        let span = self.text.list("images")?[old].clone();
        let new = self.rebuilt(&span, &["uri", "bufferView", "mimeType"], &members)?;
        self.edits.replace(span, new);
        Ok(old)
    }

    /// A texture with these images in place of another one.
    fn texture(
        &mut self,
        of: (usize, Kind),
        old: Option<usize>,
        sampler: Option<usize>,
        sources: Sources,
    ) -> Result<usize, Fault> {
        if let Some(&known) = self.known.get(&(of, old, sampler)) {
            return Ok(known);
        }
        let mut members = vec![("sampler", self.sampler(sampler)?.to_string())];
        if let Some(source) = sources.source {
            members.push(("source", source.to_string()));
        }
        let free = old.filter(|old| self.free.textures.remove(old));
        let mut extensions = Vec::new();
        if let Some(old) = free {
            // Other extensions of the texture stay, but for those that name images.
            let span = &self.text.list("textures")?[old];
            let all = self.text.member(span, "extensions")?;
            let all = all.map_or(Ok(Vec::new()), |all| self.text.members(&all))?;
            let names_image = |name: &str| self.document.textures[old].sources().any(|(other, _)| other == name);
            let others = all.into_iter().filter(|(name, _)| name != BASISU && !names_image(name));
            extensions.extend(others.map(|(name, span)| format!("{}:{}", quoted(&name), &self.text.0[span])));
        }
        if let Some(image) = sources.basisu {
            self.uses_basisu = true;
            extensions.push(format!("\"{BASISU}\":{{\"source\":{image}}}"));
        }
        if !extensions.is_empty() {
            members.push(("extensions", format!("{{{}}}", extensions.join(","))));
        }
        let index = match free {
            Some(old) => {
                let span = self.text.list("textures")?[old].clone();
                let new = self.rebuilt(&span, &["sampler", "source", "extensions"], &members)?;
                self.edits.replace(span, new);
                old
            }
            None => {
                self.textures.push(object(&members));
                self.document.textures.len() + self.textures.len() - 1
            }
        };
        self.known.insert((of, old, sampler), index);
        Ok(index)
    }

    /// The same sampler, or one that reads mips where it does not say that it does.
    fn sampler(&mut self, old: Option<usize>) -> Result<usize, Fault> {
        let samplers = &self.document.samplers;
        let known = old.map(|old| samplers.get(old).ok_or_else(|| missing("sampler", old, samplers.len())));
        let filter = known.transpose()?.and_then(|sampler| sampler.min_filter);
        let wanted = match (filter, old) {
            (Some(NEAREST), _) => NEAREST_MIPMAP_NEAREST,
            (None | Some(LINEAR), _) | (Some(_), None) => LINEAR_MIPMAP_LINEAR,
            (Some(_), Some(old)) => return Ok(old),
        };
        if let Some(&known) = self.meant.get(&old) {
            return Ok(known);
        }
        let members = [("minFilter", wanted.to_string())];
        let new = match old {
            Some(old) => {
                let span = self.text.list("samplers")?[old].clone();
                self.rebuilt(&span, &["minFilter"], &members)?
            }
            None => object(&members),
        };
        self.samplers.push(new);
        let index = self.document.samplers.len() + self.samplers.len() - 1;
        self.meant.insert(old, index);
        Ok(index)
    }

    /// An object with members in place of those that are dropped; the others as they are.
    fn rebuilt(&self, at: &Span, dropped: &[&str], members: &[(&str, String)]) -> Result<String, Fault> {
        let old = self.text.members(at)?.into_iter().filter(|(key, _)| !dropped.contains(&key.as_str()));
        let old = old.map(|(key, span)| format!("{}:{}", quoted(&key), &self.text.0[span]));
        let new = members.iter().map(|(key, value)| format!("\"{key}\":{value}"));
        Ok(format!("{{{}}}", old.chain(new).collect::<Vec<_>>().join(",")))
    }

    /// The member of a material that lies at the end of a path; none where there is none.
    fn within(&self, at: &Span, path: &[&str]) -> Result<Option<Span>, Fault> {
        let step = |at: Option<Span>, key: &&str| at.map_or(Ok(None), |at| self.text.member(&at, key));
        path.iter().try_fold(Some(at.clone()), step)
    }

    /// Points a layer of a material to its textures, whose texels have its factors.
    fn material(
        &mut self,
        at: &Span,
        place: &Use,
        (normal, roughness, occlusion): (usize, usize, Option<usize>),
    ) -> Result<(), Fault> {
        let (text, keys) = (self.text, place.layer.keys());
        let index = |index: usize| ("index", index.to_string());
        let info = self.within(at, &[keys.normal_in, &[keys.normal]].concat())?;
        let Some(info) = info else { return Ok(()) };
        let mut members = vec![index(normal)];
        if text.member(&info, "scale")?.is_some() {
            members.push(("scale", "1".to_owned()));
        }
        self.edits.set(text, &info, &members)?;
        if let (Some(new), Some(info)) = (occlusion, text.member(at, "occlusionTexture")?) {
            self.edits.set(text, &info, &[index(new)])?;
        }
        // A layer without a map gets one that lies as its normals do.
        let mut new_info = vec![index(roughness)];
        if let Some(set) = text.member(&info, "texCoord")? {
            new_info.push(("texCoord", text.0[set].to_owned()));
        }
        let transform = text.member(&info, "extensions")?.map(|all| text.member(&all, "KHR_texture_transform"));
        if let Some(transform) = transform.transpose()?.flatten() {
            new_info.push(("extensions", format!("{{\"KHR_texture_transform\":{}}}", &text.0[transform])));
        }
        let new_info = (keys.roughness, object(&new_info));
        let Some(holder) = self.within(at, keys.roughness_in)? else {
            return self.edits.set(text, at, &[("pbrMetallicRoughness", object(&[new_info]))]);
        };
        let mut members = Vec::new();
        // A coat without a factor has none of its map.
        if place.layer == Layer::Coat || text.member(&holder, keys.factor)?.is_some() {
            members.push((keys.factor, "1".to_owned()));
        }
        match text.member(&holder, keys.roughness)?.filter(|_| place.roughness.is_some()) {
            Some(info) => self.edits.set(text, &info, &[index(roughness)])?,
            None => members.push(new_info),
        }
        self.edits.set(text, &holder, &members)
    }

    /// Adds elements to a list of the whole.
    fn append(&mut self, key: &'static str, values: &[String]) -> Result<(), Fault> {
        if values.is_empty() {
            return Ok(());
        }
        match self.text.member(&self.text.whole(), key)? {
            Some(list) => self.edits.push(self.text, &list, values)?,
            None => self.top.push((key, format!("[{}]", values.join(",")))),
        }
        Ok(())
    }

    fn finish(mut self, container: &Container, required: bool) -> Result<Rewritten, Fault> {
        let mut binary = container.binary.clone();
        if self.is_glb {
            let old = binary.as_deref().unwrap_or_default();
            let (new, views) = binary::rebuild(self.document, old, &self.in_binary, self.text, &mut self.edits)?;
            if self.document.buffers.is_empty() {
                self.append("buffers", &[format!("{{\"byteLength\":{}}}", new.len())])?;
            }
            self.append("bufferViews", &views)?;
            binary = Some(new);
        }
        for (key, values) in [
            ("images", std::mem::take(&mut self.images)),
            ("textures", std::mem::take(&mut self.textures)),
            ("samplers", std::mem::take(&mut self.samplers)),
        ] {
            self.append(key, &values)?;
        }
        let has = |list: &[String]| list.iter().any(|name| name == BASISU);
        let uses = self.uses_basisu;
        if uses && !has(&self.document.extensions_used) {
            self.append("extensionsUsed", &[quoted(BASISU)])?;
        }
        if uses && required && !has(&self.document.extensions_required) {
            self.append("extensionsRequired", &[quoted(BASISU)])?;
        }
        self.edits.set(self.text, &self.text.whole(), &self.top)?;
        let text = self.edits.apply(self.text.0);
        Ok(Rewritten { container: container.with(text, binary), files: self.files })
    }
}

/// An object of these members.
fn object(members: &[(&str, String)]) -> String {
    let members: Vec<String> = members.iter().map(|(key, value)| format!("\"{key}\":{value}")).collect();
    format!("{{{}}}", members.join(","))
}
