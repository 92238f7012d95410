//! Which materials of a glTF file are filtered, and with which images: materials that would get the same textures share them.

use crate::gltf::document::{Document, Material, Sampler, Texture, TextureInfo};
use crate::gltf::fault::Fault;
use glint_formats::Wrap;
use serde_json::Value;

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

/// A material, and numbers of the textures that are replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Use {
    pub material: usize,
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
        let coat = material.extensions.get("KHR_materials_clearcoat");
        if coat.is_some_and(|coat| coat.get("clearcoatNormalTexture").is_some()) {
            found
                .notes
                .push(format!("{name}: its clear coat keeps its own normals and roughness, which are not filtered"));
        }
        let Some(normal) = &material.normal_texture else { continue };
        match job(document, json, index, material, normal).map_err(|fault| fault.of(&name))? {
            Ok(job) => found.add(job),
            Err(why) => found.notes.push(format!("{name} is left as it is: {why}")),
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

/// The job of a material, or why there is none.
fn job(
    document: &Document,
    json: &Value,
    index: usize,
    material: &Material,
    normal: &TextureInfo,
) -> Result<Result<Job, String>, Fault> {
    if let Some(name) = OTHER_MODELS.iter().find(|name| material.extensions.contains_key(**name)) {
        return Ok(Err(format!("{name} says how it shines")));
    }
    if let Some(pointer) = animated(json, index) {
        return Ok(Err(format!("{pointer} is animated")));
    }
    let texture = document.texture(normal.index)?;
    let sampler = document.sampler(texture)?;
    let factor = material.pbr_metallic_roughness.roughness_factor.unwrap_or(1.0);
    if !(0.0..=1.0).contains(&factor) {
        return Err(Fault::bad(format!("expected a roughnessFactor of 0 to 1, found {factor}")));
    }
    let map = match &material.pbr_metallic_roughness.metallic_roughness_texture {
        Some(info) if info.place() != normal.place() => {
            let what = "its metallic-roughness texture lies on the surface in another way than its normal texture";
            return Ok(Err(format!("{what}; give both the same texture coordinates")));
        }
        Some(info) => Some((info.index, image_of(document, info.index)?)),
        None => None,
    };
    let occlusion = match (&material.occlusion_texture, map) {
        (Some(info), Some((_, image))) if image_of(document, info.index)? == image => Some(info.index),
        _ => None,
    };
    let use_of = Use { material: index, normal: normal.index, roughness: map.map(|(texture, _)| texture), occlusion };
    Ok(Ok(Job {
        normal: image_of(document, normal.index)?,
        scale: normal.scale.unwrap_or(1.0),
        wrap: wrap(&sampler),
        roughness: factor,
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

/// What an animation changes (KHR_animation_pointer) of the factors that would move into a material's textures.
fn animated(json: &Value, material: usize) -> Option<&str> {
    let of = ["pbrMetallicRoughness/roughnessFactor", "normalTexture/scale"];
    let factors = of.map(|factor| format!("/materials/{material}/{factor}"));
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
        let second = Use { material: 2, normal: 0, roughness: Some(2), occlusion: Some(1) };
        assert_eq!(jobs[0].uses[1], second);
    }

    #[test]
    fn what_is_left_alone_or_refused_is_said() {
        let place = r#"{"extensions":{"KHR_texture_transform":{"scale":[4,4]}},"index":1}"#;
        let other = format!(
            r#"{{"normalTexture":{{"index":0}},"pbrMetallicRoughness":{{"metallicRoughnessTexture":{place}}}}}"#
        );
        for (materials, part) in [
            (other, "material 0 is left as it is: its metallic-roughness texture lies"),
            (
                r#"{},{"name":"A","normalTexture":{"index":0}}"#.into(),
                "material 1 'A' is left as it is: /materials/1/norm",
            ),
            (r#"{"normalTexture":{"index":0},"extensions":{"KHR_materials_unlit":{}}}"#.into(), "KHR_materials_unlit"),
        ] {
            let found = gathered(&materials).unwrap();
            assert!(found.jobs.is_empty() && found.notes[0].contains(part), "{:?}", found.notes);
        }
        let coat = r#""extensions":{"KHR_materials_clearcoat":{"clearcoatNormalTexture":{"index":0}}}"#;
        let coated = gathered(&format!(r#"{{"normalTexture":{{"index":0}},{coat}}}"#)).unwrap();
        assert!(coated.jobs.len() == 1 && coated.notes[0].contains("its clear coat keeps"), "{:?}", coated.notes);
        let alone = gathered(&format!("{{{coat}}}")).unwrap();
        assert!(alone.jobs.is_empty() && alone.notes.len() == 1, "{:?}", alone.notes);
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
