//! From a normal map to a material: the mip chain, packed, and how far packing took it from what was computed.

use super::fetch::alpha_of_code;
use super::material::{AreaLightMaterial, push_texel};
use super::mips::{MipLevel, MipTexel, mip_chain};
use super::options::AreaLightOptions;
use super::spread::code_of;
use super::tables::{LtcTables, TABLE_MEAN_ERROR};
use crate::error::Result;
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use glam::DVec3;
use glint_formats::area_light::{AreaLightParams, MeasuredError};

/// Bakes a map. The LTC tables come with the program; `max_memory` bounds the bytes held meanwhile.
///
/// # Errors
/// `BadOption` for options out of range, `LimitExceeded` for a map too large for `max_memory`.
pub fn bake(
    map: &NormalMap,
    options: &AreaLightOptions,
    max_memory: u64,
    progress: &dyn Progress,
) -> Result<AreaLightMaterial> {
    options.validate()?;
    let levels = mip_chain(map, max_memory, progress)?;
    Ok(pack(map, &levels, options))
}

/// Packs the levels of a map. What is left when fine mips are skipped is a whole chain again, of a smaller map.
pub fn pack(map: &NormalMap, levels: &[MipLevel], options: &AreaLightOptions) -> AreaLightMaterial {
    let skipped = (options.skip_mips as usize).min(levels.len().saturating_sub(1));
    let levels = &levels[skipped..];
    let (width, height) = levels.first().map_or((map.width, map.height), |level| (level.width, level.height));
    let mut normals = Vec::new();
    let mut roughness = Vec::new();
    let mut measured = MeasuredError { table_mean: TABLE_MEAN_ERROR, ..MeasuredError::default() };
    for texel in levels.iter().flat_map(|level| &level.texels) {
        let at = normals.len();
        let n = texel.normal;
        push_texel(options.storage, [n.x, n.y, n.z, code_of(texel.alpha)], &mut normals);
        if options.anisotropic {
            let [p, q] = texel.by_direction.map(code_of);
            let (c, s) = (texel.axis.x, texel.axis.y);
            let matrix = [p * c * c + q * s * s, (p - q) * c * s, p * s * s + q * c * c, 0.0];
            push_texel(options.storage, matrix, &mut roughness);
        }
        add_error(texel, options.storage.decode(&normals[at..]), &mut measured);
    }
    AreaLightMaterial {
        params: AreaLightParams {
            width,
            height,
            wrap: map.wrap,
            base_roughness: options.base_roughness as f32,
            storage: options.storage,
            anisotropic: options.anisotropic,
            measured,
        },
        normals,
        roughness,
        tables: LtcTables::built_in(),
    }
}

fn add_error(texel: &MipTexel, stored: [f32; 4], measured: &mut MeasuredError) {
    let [x, y, z, _] = stored.map(f64::from);
    let alpha = f64::from(alpha_of_code(stored[3]));
    let stored = DVec3::new(x, y, z);
    let angle = libm::atan2(stored.cross(texel.normal).length(), stored.dot(texel.normal));
    measured.normal_angle = measured.normal_angle.max(angle);
    measured.roughness = measured.roughness.max((alpha - texel.alpha).abs());
}
