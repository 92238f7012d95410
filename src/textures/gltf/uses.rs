//! Which textures, images and buffer views of a glTF file nothing needs any more once materials have new textures. New ones take
//! their places, so that files do not grow by what nobody reads, and no number of anything changes.

use super::jobs::Job;
use crate::gltf::document::Document;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// How often each texture and buffer view is named anywhere in the JSON, in extensions that nobody here knows too.
#[derive(Default)]
struct Counts {
    textures: BTreeMap<usize, usize>,
    views: BTreeMap<usize, usize>,
}

impl Counts {
    fn add(&mut self, key: &str, value: &Value) {
        match value {
            Value::Object(members) => {
                let index = members.get("index").and_then(index_of);
                if let Some(index) = index.filter(|_| key.ends_with("Texture") || key.ends_with("texture")) {
                    *self.textures.entry(index).or_default() += 1;
                }
                if let Some(index) = members.get("bufferView").and_then(index_of) {
                    *self.views.entry(index).or_default() += 1;
                }
                members.iter().for_each(|(key, value)| self.add(key, value));
            }
            Value::Array(elements) => elements.iter().for_each(|value| self.add(key, value)),
            _ => {}
        }
    }
}

fn index_of(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

/// What nothing needs any more.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Free {
    pub textures: BTreeSet<usize>,
    pub images: BTreeSet<usize>,
    pub views: BTreeSet<usize>,
}

impl Free {
    /// Of a document whose materials get the textures of these jobs. Images of `kept` stay in use.
    pub fn of(document: &Document, json: &Value, jobs: &[Job], kept: &BTreeSet<usize>) -> Free {
        let mut counts = Counts::default();
        counts.add("", json);
        let mut replaced: BTreeMap<usize, usize> = BTreeMap::new();
        for place in jobs.iter().flat_map(|job| &job.uses) {
            for texture in [Some(place.normal), place.roughness, place.occlusion].into_iter().flatten() {
                *replaced.entry(texture).or_default() += 1;
            }
        }
        let textures: BTreeSet<usize> = replaced
            .into_iter()
            .filter(|(texture, count)| counts.textures.get(texture) == Some(count))
            .map(|(texture, _)| texture)
            .collect();
        let (mut images, mut needed) = (BTreeSet::new(), kept.clone());
        for (index, texture) in document.textures.iter().enumerate() {
            let set = if textures.contains(&index) { &mut images } else { &mut needed };
            set.extend(texture.sources().map(|(_, image)| image));
        }
        images.retain(|image| !needed.contains(image) && document.images.get(*image).is_some());
        let views = images.iter().filter_map(|&image| document.images[image].buffer_view);
        let views = views.filter(|view| counts.views.get(view) == Some(&1)).collect();
        Free { textures, images, views }
    }
}

#[cfg(test)]
mod tests {
    use super::super::jobs::gather;
    use super::*;

    #[test]
    fn what_something_else_needs_is_not_free() {
        let text = r#"{"asset":{"version":"2.0"},
            "materials":[{"normalTexture":{"index":0},"pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":1}}},
                {"emissiveTexture":{"index":1},"extensions":{"X":{"list":[{"ownTexture":{"index":2}}]}}},
                {"normalTexture":{"index":2}}, {"normalTexture":{"index":3}}],
            "textures":[{"source":0},{"source":1},{"source":2},{"source":3},{"source":0,"extensions":{"Y":{"source":3}}}],
            "images":[{"bufferView":0},{"bufferView":1},{"bufferView":2},{"bufferView":3}],
            "accessors":[{"bufferView":3}]}"#;
        let (document, json) = (Document::read(text).unwrap(), serde_json::from_str(text).unwrap());
        let jobs = gather(&document, &json).unwrap().jobs;
        let free = Free::of(&document, &json, &jobs, &BTreeSet::new());
        // Image 0 is texture 4's too, and 3 as well; texture 1 is emissive, texture 2 somebody's own.
        assert_eq!(free, Free { textures: [0, 3].into(), ..Free::default() });
        let text = text.replace(r#",{"source":0,"extensions":{"Y":{"source":3}}}"#, "");
        let (document, json) = (Document::read(&text).unwrap(), serde_json::from_str(&text).unwrap());
        let free = Free::of(&document, &json, &jobs, &BTreeSet::new());
        assert_eq!(free, Free { textures: [0, 3].into(), images: [0, 3].into(), views: [0].into() });
        assert_eq!(Free::of(&document, &json, &jobs, &[0].into()).images, [3].into());
    }
}
