//! Which materials of a glTF file are filtered, and with which images: materials that would get the same textures share them.

use crate::gltf::document::{ClearCoat, Document, Material, Sampler, Texture, TextureInfo};
use crate::gltf::fault::Fault;
use glint_formats::Wrap;
use serde::Deserialize;
use serde_json::Value;

/// A smooth layer over the material, with normals and roughness of its own.
const CLEAR_COAT: &str = "KHR_materials_clearcoat";

/// Materials whose roughness is not the core's.
const OTHER_MODELS: [&str; 2] = ["KHR_materials_pbrSpecularGlossiness", "KHR_materials_unlit"];

const REPEAT: u32 = 10497;

/// A pair of textures to bake.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Image of the normals.
    pub normal: usize,
    /// What x and y of the normals are multiplied with.
    pub scale: f64,
    /// What lies beyond the edges of the normals.
    pub wrap: Wrap,
    /// Perceptual roughness; where there is a map, what its green is multiplied with.
    pub roughness: f64,
    /// Image whose green is roughness and whose blue is metallic.
    pub map: Option<usize>,
    /// Materials that get the pair.
    pub uses: Vec<Use>,
}

/// A layer of a material that has normals of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    Base,
    /// [`CLEAR_COAT`].
    Coat,
}

/// How the JSON calls what a layer has.
#[derive(Clone, Copy, Debug)]
pub struct Keys {
    /// Members of the material, one in the other, to that which holds the texture of normals.
    pub normal_in: &'static [&'static str],
    pub normal: &'static str,
    /// The same of roughness.
    pub roughness_in: &'static [&'static str],
    pub roughness: &'static str,
    pub factor: &'static str,
}

impl Layer {
    /// How the JSON calls what it has.
    pub fn keys(self) -> Keys {
        const COAT: [&str; 2] = ["extensions", CLEAR_COAT];
        match self {
            Layer::Base => Keys {
                normal_in: &[],
                normal: "normalTexture",
                roughness_in: &["pbrMetallicRoughness"],
                roughness: "metallicRoughnessTexture",
                factor: "roughnessFactor",
            },
            Layer::Coat => Keys {
                normal_in: &COAT,
                normal: "clearcoatNormalTexture",
                roughness_in: &COAT,
                roughness: "clearcoatRoughnessTexture",
                factor: "clearcoatRoughnessFactor",
            },
        }
    }
}

/// A layer of a material, and numbers of the textures that are replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Use {
    pub material: usize,
    pub layer: Layer,
    pub normal: usize,
    /// Metallic and roughness; none where factors say all.
    pub roughness: Option<usize>,
    /// Occlusion, where it is the red channel of the image that metallic and roughness have too.
    pub occlusion: Option<usize>,
}

/// Jobs, and what the user should know of materials that are left as they are.
#[derive(Clone, Debug, Default)]
pub struct Jobs {
    pub jobs: Vec<Job>,
    pub notes: Vec<String>,
}

/// Looks through all materials. `json` is the whole document.
///
/// # Errors
/// Indices that lead nowhere, factors out of range, images of kinds that are not read.
pub fn gather(document: &Document, json: &Value) -> Result<Jobs, Fault> {
    let mut found = Jobs::default();
    for (index, material) in document.materials.iter().enumerate() {
        let name = match &material.name {
            Some(name) => format!("material {index} '{name}'"),
            None => format!("material {index}"),
        };
        for layer in [Layer::Base, Layer::Coat] {
            let name = if layer == Layer::Base { name.clone() } else { format!("the clear coat of {name}") };
            let Some(parts) = parts(material, layer).map_err(|fault| fault.of(&name))? else { continue };
            match job(document, json, (index, material), &parts).map_err(|fault| fault.of(&name))? {
                Ok(job) => found.add(job),
                Err(why) => found.notes.push(format!("{name} is left as it is: {why}")),
            }
        }
    }
    Ok(found)
}

impl Jobs {
    fn add(&mut self, job: Job) {
        let uses = |job: &Job| Job { uses: Vec::new(), ..job.clone() };
        match self.jobs.iter_mut().find(|other| uses(other) == uses(&job)) {
            Some(other) => other.uses.extend(job.uses),
            None => self.jobs.push(job),
        }
    }
}

/// What a layer's highlight is made of.
struct Parts {
    layer: Layer,
    normal: TextureInfo,
    factor: f64,
    map: Option<TextureInfo>,
    occlusion: Option<TextureInfo>,
}

/// The parts of a layer with normals; none where it has none.
fn parts(material: &Material, layer: Layer) -> Result<Option<Parts>, Fault> {
    if layer == Layer::Base {
        let base = &material.pbr_metallic_roughness;
        let of = |normal: TextureInfo| Parts {
            layer,
            normal,
            factor: base.roughness_factor.unwrap_or(1.0),
            map: base.metallic_roughness_texture.clone(),
            occlusion: material.occlusion_texture.clone(),
        };
        return Ok(material.normal_texture.clone().map(of));
    }
    let Some(coat) = material.extensions.get(CLEAR_COAT) else { return Ok(None) };
    let coat = ClearCoat::deserialize(coat).map_err(|error| Fault::bad(format!("{CLEAR_COAT}: {error}")))?;
    let of = |normal: TextureInfo| Parts {
        layer,
        normal,
        factor: coat.clearcoat_roughness_factor,
        map: coat.clearcoat_roughness_texture,
        occlusion: None,
    };
    Ok(coat.clearcoat_normal_texture.map(of))
}

/// The job of a layer, or why there is none.
fn job(
    document: &Document,
    json: &Value,
    (index, material): (usize, &Material),
    parts: &Parts,
) -> Result<Result<Job, String>, Fault> {
    let Parts { layer, normal, factor, map, occlusion } = parts;
    if let Some(name) = OTHER_MODELS.iter().find(|name| material.extensions.contains_key(**name)) {
        return Ok(Err(format!("{name} says how it shines")));
    }
    if let Some(pointer) = animated(json, index, *layer) {
        return Ok(Err(format!("{pointer} is animated")));
    }
    let texture = document.texture(normal.index)?;
    let sampler = document.sampler(texture)?;
    if !(0.0..=1.0).contains(factor) {
        return Err(Fault::bad(format!("expected a {} of 0 to 1, found {factor}", layer.keys().factor)));
    }
    let map = match map {
        Some(info) if info.place() != normal.place() => {
            let what = "its roughness texture lies on the surface in another way than its normal texture";
            return Ok(Err(format!("{what}; give both the same texture coordinates")));
        }
        Some(info) => Some((info.index, image_of(document, info.index)?)),
        None => None,
    };
    let occlusion = match (occlusion, map) {
        (Some(info), Some((_, image))) if image_of(document, info.index)? == image => Some(info.index),
        _ => None,
    };
    let roughness = map.map(|(texture, _)| texture);
    let use_of = Use { material: index, layer: *layer, normal: normal.index, roughness, occlusion };
    Ok(Ok(Job {
        normal: image_of(document, normal.index)?,
        scale: normal.scale.unwrap_or(1.0),
        wrap: wrap(&sampler),
        roughness: *factor,
        map: map.map(|(_, image)| image),
        uses: vec![use_of],
    }))
}

/// The image of a texture that can be read here.
fn image_of(document: &Document, index: usize) -> Result<usize, Fault> {
    let texture: &Texture = document.texture(index)?;
    let webp = || texture.sources().find(|(name, _)| *name == "EXT_texture_webp").map(|(_, image)| image);
    let image = texture.source.or_else(webp).ok_or_else(|| {
        let names: Vec<&str> = texture.sources().map(|(name, _)| name).collect();
        let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        Fault::unsupported(format!(
            "texture {index} has no PNG, JPEG or WebP image, only: {names}; give the file as it was before its textures were compressed"
        ))
    })?;
    document.image(image).map(|_| image)
}

/// A mirrored edge goes on with the edge's texel, as a clamped one.
fn wrap(sampler: &Sampler) -> Wrap {
    let repeats = |wrap: Option<u32>| wrap.unwrap_or(REPEAT) == REPEAT;
    if repeats(sampler.wrap_s) && repeats(sampler.wrap_t) { Wrap::Repeat } else { Wrap::Clamp }
}

/// What an animation changes (KHR_animation_pointer) of the factors that would move into a layer's textures.
fn animated(json: &Value, material: usize, layer: Layer) -> Option<&str> {
    let keys = layer.keys();
    let pointer = |within: &[&str], rest: &[&str]| {
        let path: Vec<&str> = within.iter().chain(rest).copied().collect();
        format!("/materials/{material}/{}", path.join("/"))
    };
    let factors = [pointer(keys.roughness_in, &[keys.factor]), pointer(keys.normal_in, &[keys.normal, "scale"])];
    let animations = json.get("animations").and_then(Value::as_array).into_iter().flatten();
    let channels = animations.filter_map(|animation| animation.get("channels")?.as_array()).flatten();
    let pointers = channels.filter_map(|channel| {
        channel.get("target")?.get("extensions")?.get("KHR_animation_pointer")?.get("pointer")?.as_str()
    });
    pointers.into_iter().find(|pointer| factors.iter().any(|factor| factor == pointer))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gathered(materials: &str) -> Result<Jobs, Fault> {
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"materials":[{materials}],"images":[{{}},{{}}],
            "textures":[{{"source":0}},{{"source":1,"sampler":0}},{{"source":1}},{{"extensions":{{"KHR_texture_basisu":{{"source":1}}}}}}],
            "samplers":[{{"wrapS":33648}}],
            "animations":[{{"channels":[{{"target":{{"extensions":{{"KHR_animation_pointer":{{"pointer":"/materials/1/normalTexture/scale"}}}}}}}}]}}]}}"#
        );
        gather(&Document::read(&text).unwrap(), &serde_json::from_str(&text).unwrap())
    }

    #[test]
    fn materials_that_get_the_same_share_a_job() {
        let normal = r#""normalTexture":{"index":0}"#;
        let rough = |index: usize, factor: f64| {
            format!(
                r#""pbrMetallicRoughness":{{"metallicRoughnessTexture":{{"index":{index}}},"roughnessFactor":{factor}}}"#
            )
        };
        let still = "{}";
        let all = [
            format!("{{{normal},{}}}", rough(1, 0.5)),
            still.to_owned(),
            // The same image with another sampler.
            format!("{{{normal},{},\"occlusionTexture\":{{\"index\":1}}}}", rough(2, 0.5)),
            format!("{{{normal},{}}}", rough(1, 0.25)),
            format!("{{{normal}}}"),
        ];
        let jobs = gathered(&all.join(",")).unwrap().jobs;
        let seen: Vec<(f64, Option<usize>, usize)> =
            jobs.iter().map(|job| (job.roughness, job.map, job.uses.len())).collect();
        assert_eq!(seen, [(0.5, Some(1), 2), (0.25, Some(1), 1), (1.0, None, 1)]);
        let second = Use { material: 2, layer: Layer::Base, normal: 0, roughness: Some(2), occlusion: Some(1) };
        assert_eq!(jobs[0].uses[1], second);
    }

    #[test]
    fn clear_coats_are_layers_of_their_own() {
        let coat = |members: &str| format!(r#""extensions":{{"KHR_materials_clearcoat":{{{members}}}}}"#);
        let normal = r#""clearcoatNormalTexture":{"index":0}"#;
        let seen = |materials: &str| {
            let jobs = gathered(materials).unwrap().jobs;
            let layers = |job: &Job| job.uses.iter().map(|place| place.layer).collect::<Vec<_>>();
            jobs.iter().map(|job| (job.roughness, job.map, layers(job))).collect::<Vec<_>>()
        };
        // Without a factor it is 0, and alone it needs no normals below it.
        assert_eq!(seen(&format!("{{{}}}", coat(normal))), [(0.0, None, vec![Layer::Coat])]);
        let rough = format!(r#"{normal},"clearcoatRoughnessFactor":0.5,"clearcoatRoughnessTexture":{{"index":1}}"#);
        let both = format!(r#"{{"normalTexture":{{"index":0}},{}}}"#, coat(&rough));
        assert_eq!(seen(&both), [(1.0, None, vec![Layer::Base]), (0.5, Some(1), vec![Layer::Coat])]);
        let same = format!(
            r#"{{"normalTexture":{{"index":0}},"pbrMetallicRoughness":{{"roughnessFactor":0}},{}}}"#,
            coat(normal)
        );
        assert_eq!(seen(&same), [(0.0, None, vec![Layer::Base, Layer::Coat])]);
        assert!(seen(&format!("{{{}}}", coat(r#""clearcoatFactor":1"#))).is_empty());
        for members in [r#""clearcoatNormalTexture":7"#, &format!(r#"{normal},"clearcoatRoughnessFactor":1.5"#)] {
            assert!(gathered(&format!("{{{}}}", coat(members))).is_err(), "{members}");
        }
        let animated = format!("{{}},{{{}}}", coat(normal));
        let text = gathered(&animated).unwrap();
        assert_eq!(text.jobs.len(), 1, "the animation is of the base's scale: {:?}", text.notes);
    }

    #[test]
    fn what_is_left_alone_or_refused_is_said() {
        let place = r#"{"extensions":{"KHR_texture_transform":{"scale":[4,4]}},"index":1}"#;
        let other = format!(
            r#"{{"normalTexture":{{"index":0}},"pbrMetallicRoughness":{{"metallicRoughnessTexture":{place}}}}}"#
        );
        for (materials, part) in [
            (other, "material 0 is left as it is: its roughness texture lies"),
            (
                r#"{},{"name":"A","normalTexture":{"index":0}}"#.into(),
                "material 1 'A' is left as it is: /materials/1/norm",
            ),
            (r#"{"normalTexture":{"index":0},"extensions":{"KHR_materials_unlit":{}}}"#.into(), "KHR_materials_unlit"),
        ] {
            let found = gathered(&materials).unwrap();
            assert!(found.jobs.is_empty() && found.notes[0].contains(part), "{:?}", found.notes);
        }
        assert_eq!(gathered(r#"{"normalTexture":{"index":1}}"#).unwrap().jobs[0].wrap, Wrap::Clamp);
        for materials in [
            r#"{"normalTexture":{"index":7}}"#,
            r#"{"normalTexture":{"index":3}}"#,
            r#"{"normalTexture":{"index":0},"pbrMetallicRoughness":{"roughnessFactor":1.5}}"#,
        ] {
            assert!(gathered(materials).is_err(), "{materials}");
        }
    }
}
