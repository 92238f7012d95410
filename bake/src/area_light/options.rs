//! What an area-light material is asked to be.

use crate::error::{BakeError, Result};
use glint_formats::area_light::NormalStorage;

/// Base roughness that the LTC tables serve.
pub const BASE_ROUGHNESS_RANGE: (f64, f64) = (0.001, 1.0);

/// Options of the area-light bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaLightOptions {
    /// GGX roughness α of the surface itself. A default for the renderer: no texture depends on it.
    pub base_roughness: f64,
    /// Whether roughness by direction is stored too.
    pub anisotropic: bool,
    /// How normals and roughness are stored.
    pub storage: NormalStorage,
    /// So many of the finest mips are left out, for maps that are never seen closer. The last mip always stays.
    pub skip_mips: u32,
    /// Bytes that the bake may hold meanwhile.
    pub max_memory: u64,
}

impl Default for AreaLightOptions {
    fn default() -> AreaLightOptions {
        AreaLightOptions {
            base_roughness: 0.1,
            anisotropic: false,
            storage: NormalStorage::F16,
            skip_mips: 0,
            max_memory: u64::MAX,
        }
    }
}

impl AreaLightOptions {
    /// Checks the options.
    ///
    /// # Errors
    /// [`BakeError::BadOption`] names the option, what was found and what would work.
    pub fn validate(&self) -> Result<()> {
        let (low, high) = BASE_ROUGHNESS_RANGE;
        if (low..=high).contains(&self.base_roughness) {
            return Ok(());
        }
        Err(BakeError::BadOption(format!("base-roughness: expected {low} to {high}, found {}", self.base_roughness)))
    }
}
