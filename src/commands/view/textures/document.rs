//! The part of glTF 2.0's JSON that says how materials look (specification, section 3.9), as it is written.

use crate::gltf::document::TextureInfo;
use crate::gltf::fault::Fault;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// All materials of a document.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Looks {
    pub materials: Vec<Material>,
}

/// A material.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Material {
    pub name: Option<String>,
    pub pbr_metallic_roughness: MetallicRoughness,
    pub normal_texture: Option<TextureInfo>,
    pub occlusion_texture: Option<Occlusion>,
    pub emissive_texture: Option<TextureInfo>,
    pub emissive_factor: [f32; 3],
    pub alpha_mode: Option<String>,
    pub extensions: BTreeMap<String, Value>,
}

/// Factors, and textures that are multiplied with them.
#[derive(Debug, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct MetallicRoughness {
    pub base_color_factor: [f32; 4],
    pub base_color_texture: Option<TextureInfo>,
    pub metallic_factor: f32,
    pub roughness_factor: f32,
    pub metallic_roughness_texture: Option<TextureInfo>,
}

impl Default for MetallicRoughness {
    fn default() -> MetallicRoughness {
        MetallicRoughness {
            base_color_factor: [1.0; 4],
            base_color_texture: None,
            metallic_factor: 1.0,
            roughness_factor: 1.0,
            metallic_roughness_texture: None,
        }
    }
}

/// The texture of occlusion.
#[derive(Debug, Deserialize)]
pub struct Occlusion {
    #[serde(flatten)]
    pub info: TextureInfo,
    /// How much of it counts, 1 where nothing says so.
    pub strength: Option<f32>,
}

impl Looks {
    /// Those of a JSON text.
    ///
    /// # Errors
    /// Bad, for other JSON.
    pub fn read(text: &str) -> Result<Looks, Fault> {
        serde_json::from_str(text)
            .map_err(|error| Fault::bad(format!("its JSON is not that of glTF: {error}; export it anew")))
    }
}

impl Material {
    /// How messages call it.
    pub fn label(&self, number: usize) -> String {
        match &self.name {
            Some(name) => format!("material {number} '{name}'"),
            None => format!("material {number}"),
        }
    }

    /// Whether all factors are from 0 to 1, or, of emission, not negative; else which is not.
    pub fn check(&self) -> Result<(), Fault> {
        let core = &self.pbr_metallic_roughness;
        let shares = [
            ("baseColorFactor", &core.base_color_factor[..]),
            ("metallicFactor", &[core.metallic_factor]),
            ("roughnessFactor", &[core.roughness_factor]),
            ("emissiveFactor", &self.emissive_factor),
        ];
        for (name, values) in shares {
            if let Some(found) = values.iter().find(|value| !(0.0..=1.0).contains(*value)) {
                return Err(Fault::bad(format!("expected a {name} of 0 to 1, found {found}; export it anew")));
            }
        }
        Ok(())
    }
}
