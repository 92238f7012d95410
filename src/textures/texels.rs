//! Texels of the textures, from what was read and what was baked.

use super::material::{Averaged, Material};
use super::target::{Channel, Stored, Target};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::textures::{Anisotropy, Level};

/// All levels: level 0 is what was read, the others are baked or averaged.
pub struct Texels<'a> {
    map: &'a NormalMap,
    material: &'a Material,
    levels: &'a [Level],
    target: Target,
    occlusion: Averaged<'a>,
    metallic: Averaged<'a>,
    alpha: Averaged<'a>,
}

impl<'a> Texels<'a> {
    /// Those of a map and its material.
    pub fn new(map: &'a NormalMap, material: &'a Material, levels: &'a [Level], target: Target) -> Texels<'a> {
        let averaged = |values: &'a Option<Vec<f32>>| material.levels(values.as_deref(), (map.width, map.height));
        let (occlusion, metallic) = (averaged(&material.occlusion), averaged(&material.metallic));
        let alpha = averaged(&material.alpha);
        Texels { map, material, levels, target, occlusion, metallic, alpha }
    }

    /// The normal of texel k of a level as a colour, and its alpha.
    pub fn normal(&self, level: usize, k: usize, green_down: bool) -> [f32; 4] {
        let [x, y] = if level == 0 { self.map.projected[k] } else { self.levels[level - 1].normals[k] };
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        [
            0.5 + 0.5 * x,
            if green_down { 0.5 - 0.5 * y } else { 0.5 + 0.5 * y },
            0.5 + 0.5 * z,
            self.alpha.value(level, k),
        ]
    }

    /// The channels of texel k of a level, those that are not named 0.
    pub fn channels(&self, channels: &[Channel], stored: Stored, level: usize, k: usize) -> [f32; 4] {
        let (alpha, Anisotropy { strength, direction: [x, y] }) = self.highlight(level, k);
        let mut texel = [0.0; 4];
        for (value, channel) in texel.iter_mut().zip(channels) {
            *value = match channel {
                Channel::Roughness => stored.of_alpha(alpha),
                Channel::Occlusion => self.occlusion.value(level, k),
                Channel::Metallic => self.metallic.value(level, k),
                Channel::Along => 0.5 + 0.5 * x,
                Channel::Up => 0.5 + 0.5 * y,
                Channel::Strength => strength,
                Channel::One => 1.0,
            };
        }
        texel
    }

    /// α and anisotropy of texel k of a level, as the target has them. The map itself has no strength, and the direction of the level
    /// below, so that mips blend.
    fn highlight(&self, level: usize, k: usize) -> (f32, Anisotropy) {
        let Some(below) = level.checked_sub(1).map(|level| &self.levels[level]) else {
            let alpha = self.material.roughness.texel(k).powi(2);
            let direction = self.levels.first().and_then(|level| {
                let (i, j) = (k as u64 % u64::from(self.map.width), k as u64 / u64::from(self.map.width));
                let row = j * u64::from(level.height) / u64::from(self.map.height);
                let column = i * u64::from(level.width) / u64::from(self.map.width);
                level.anisotropies.get((row * u64::from(level.width) + column) as usize)
            });
            return (alpha, direction.map_or(Anisotropy::NONE, |of| Anisotropy { strength: 0.0, ..*of }));
        };
        let across = below.alphas[k];
        let Some(of) = below.anisotropies.get(k) else { return (across, Anisotropy::NONE) };
        let along = across + (1.0 - across) * of.strength * of.strength;
        let (alpha, strength) = self.target.anisotropic(along, across).unwrap_or((across, of.strength));
        (alpha, Anisotropy { strength, ..*of })
    }
}
