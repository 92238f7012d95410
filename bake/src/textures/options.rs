//! What textures are made of, and the limits of that.

use crate::error::{BakeError, Result};
use crate::normal_map::NormalMap;

/// Least GGX α that is written: below it, 8 bits of perceptual roughness have no steps left.
pub const LEAST_ALPHA: f32 = 1e-3;

/// Roughness of the material itself, perceptual: GGX α is its square.
#[derive(Clone, Debug, PartialEq)]
pub enum Roughness {
    /// The same everywhere, 0 to 1.
    Constant(f32),
    /// One value a texel of the normal map, row-major, 0 to 1.
    Map(Vec<f32>),
}

/// Options of the bake of textures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexturesOptions {
    /// Bytes that the bake may hold meanwhile.
    pub max_memory: u64,
    /// Where highlights are fitted by the anisotropic lobes of KHR_materials_anisotropy: what the engine takes their axes from.
    pub anisotropy: Option<Axes>,
}

/// What an engine takes the axes of an anisotropic lobe from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// The surface, as the extension's own code does: the highlight lies around the surface's normal.
    Surface,
    /// The normal that it shades with, around which the highlight lies.
    Normal,
}

impl Default for TexturesOptions {
    fn default() -> TexturesOptions {
        TexturesOptions { max_memory: u64::MAX, anisotropy: None }
    }
}

/// Bytes that a bake holds for each texel of the map, map and roughness included.
pub const BYTES_PER_TEXEL: u64 = 24;
/// Bytes more with anisotropy.
const BYTES_OF_ANISOTROPY: u64 = 4;

impl Roughness {
    /// Checks the roughness against the map that it belongs to.
    ///
    /// # Errors
    /// `BadOption` for a constant out of range; `BadInput` for a map of another size or with a value that is no roughness, whose
    /// texel is named.
    pub fn validate(&self, map: &NormalMap) -> Result<()> {
        match self {
            Roughness::Constant(value) if (0.0..=1.0).contains(value) => Ok(()),
            Roughness::Constant(value) => {
                Err(BakeError::BadOption(format!("roughness: expected 0 to 1, found {value}")))
            }
            Roughness::Map(values) => {
                let expected = map.width as usize * map.height as usize;
                if values.len() != expected {
                    let found = values.len();
                    return Err(BakeError::BadInput(format!("expected {expected} texels of roughness, found {found}")));
                }
                match values.iter().position(|value| !(0.0..=1.0).contains(value)) {
                    None => Ok(()),
                    Some(at) => Err(BakeError::BadInput(format!(
                        "the roughness at texel ({}, {}) is {}; expected 0 to 1",
                        at % map.width as usize,
                        at / map.width as usize,
                        values[at]
                    ))),
                }
            }
        }
    }

    /// Perceptual roughness of texel `at`, counted row by row.
    #[inline]
    pub fn texel(&self, at: usize) -> f32 {
        match self {
            Roughness::Constant(value) => *value,
            Roughness::Map(values) => values[at],
        }
    }
}

impl TexturesOptions {
    /// Whether a map can be baked, before any work.
    ///
    /// # Errors
    /// `LimitExceeded` for a map that needs more than [`TexturesOptions::max_memory`].
    pub fn check(&self, map: &NormalMap) -> Result<()> {
        let bytes = BYTES_PER_TEXEL + if self.anisotropy.is_some() { BYTES_OF_ANISOTROPY } else { 0 };
        let needed = u64::from(map.width) * u64::from(map.height) * bytes;
        if needed > self.max_memory {
            return Err(BakeError::LimitExceeded(format!(
                "max-memory: the mips of {} × {} texels need {needed} bytes, the limit is {}; allow more, or use a part of the map",
                map.width, map.height, self.max_memory
            )));
        }
        Ok(())
    }
}
