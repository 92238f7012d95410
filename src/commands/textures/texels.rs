//! Texels of the textures, from what was read and what was baked.

use super::material::{Averaged, Material};
use super::target::{Channel, Stored};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::textures::Level;

/// All levels: level 0 is what was read, the others are baked or averaged.
pub struct Texels<'a> {
    map: &'a NormalMap,
    material: &'a Material,
    levels: &'a [Level],
    occlusion: Averaged<'a>,
    metallic: Averaged<'a>,
}

impl<'a> Texels<'a> {
    /// Those of a map and its material.
    pub fn new(map: &'a NormalMap, material: &'a Material, levels: &'a [Level]) -> Texels<'a> {
        let averaged = |values: &'a Option<Vec<f32>>| material.levels(values.as_deref(), (map.width, map.height));
        let (occlusion, metallic) = (averaged(&material.occlusion), averaged(&material.metallic));
        Texels { map, material, levels, occlusion, metallic }
    }

    /// The normal of texel k of a level as a colour.
    pub fn normal(&self, level: usize, k: usize, green_down: bool) -> [f32; 4] {
        let [x, y] = if level == 0 { self.map.projected[k] } else { self.levels[level - 1].normals[k] };
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        [0.5 + 0.5 * x, if green_down { 0.5 - 0.5 * y } else { 0.5 + 0.5 * y }, 0.5 + 0.5 * z, 1.0]
    }

    /// The channels of texel k of a level, those that are not named 0.
    pub fn channels(&self, channels: &[Channel], stored: Stored, level: usize, k: usize) -> [f32; 4] {
        let mut texel = [0.0; 4];
        for (value, channel) in texel.iter_mut().zip(channels) {
            *value = match channel {
                Channel::Roughness => stored.of_alpha(self.alpha(level, k)),
                Channel::Occlusion => self.occlusion.value(level, k),
                Channel::Metallic => self.metallic.value(level, k),
                Channel::One => 1.0,
            };
        }
        texel
    }

    fn alpha(&self, level: usize, k: usize) -> f32 {
        match level {
            0 => self.material.roughness.texel(k).powi(2),
            _ => self.levels[level - 1].alphas[k],
        }
    }
}
