//! Checks the contents of NDF map sections: what an evaluator relies on when it indexes tiles and density.

use crate::container::Resource;
use crate::issue::{Issue, IssueCode};
use crate::ndf_maps::{DENSITY, DensityStorage, Level, NORMALS, NdfMapsParams, PARAMS, PLACEMENT, TILES, TileRecord};
use crate::sections::{Loaded, Sections};
use crate::vk_format;
use half::f16;

/// Checks every example's NDF maps.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_example(sections, section, issues);
    }
    sections.report_orphans(&[TILES, DENSITY, NORMALS, PLACEMENT], PARAMS, issues);
}

fn check_example(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) {
    let tiles = sections.need(TILES, section, issues);
    let density = sections.need(DENSITY, section, issues);
    let normals = sections.need(NORMALS, section, issues);
    let Some(params) = section.parameters::<NdfMapsParams>(issues) else { return };
    if let Err(why) = check_parameters(&params) {
        issues.push(section.error(IssueCode::NdfParameters, why));
        return;
    }
    let expected_tiles = match check_levels(&params) {
        Ok(tiles) => Some(tiles),
        Err(why) => {
            issues.push(section.error(IssueCode::NdfLevels, why));
            None
        }
    };
    if let Some(normals) = normals {
        normals.expect(IssueCode::WrongDescriptor, normals_resource(&params), issues);
    }
    let texels = density.and_then(|density| density.buffer_count(params.storage.texel_bytes(), issues));
    if let Some(density) = density
        && texels.is_some()
        && let Some(why) = first_bad_density(density.bytes(), params.storage)
    {
        issues.push(density.error(IssueCode::NdfDensityValue, why));
    }
    let Some(tiles) = tiles else { return };
    let Some(count) = tiles.buffer_count(size_of::<TileRecord>() as u32, issues) else { return };
    if let Some(expected) = expected_tiles
        && expected != count
    {
        let message = format!("the levels have {expected} tiles, the section has {count}");
        issues.push(tiles.error(IssueCode::NdfTileCount, message));
    }
    check_tiles(tiles, texels, issues);
}

fn normals_resource(params: &NdfMapsParams) -> Resource {
    Resource::Texture {
        vk_format: vk_format::R16G16_SNORM,
        width: params.width,
        height: params.height,
        layers: 1,
        faces: 1,
        mips: 1,
    }
}

fn check_parameters(params: &NdfMapsParams) -> Result<(), String> {
    if params.width == 0 || params.height == 0 {
        return Err(format!("expected at least one texel, found {} × {}", params.width, params.height));
    }
    if !(params.intrinsic_roughness > 0.0 && params.intrinsic_roughness.is_finite()) {
        return Err(format!("expected a positive intrinsic roughness, found {}", params.intrinsic_roughness));
    }
    let measured = &params.measured;
    for error in [f64::from(params.max_error), measured.mean, measured.p95, measured.worst, measured.energy] {
        if !(error >= 0.0 && error.is_finite()) {
            return Err(format!("expected errors that are finite and not negative, found {error}"));
        }
    }
    Ok(())
}

/// Levels cover the example and follow each other; returns the number of tiles they have together.
fn check_levels(params: &NdfMapsParams) -> Result<u64, String> {
    let mut tiles = 0u64;
    let mut finer = 0;
    for (i, level) in params.levels.iter().enumerate() {
        check_level(params, level, tiles, finer).map_err(|why| format!("level {i}: {why}"))?;
        tiles = tiles.saturating_add(u64::from(level.tiles_x) * u64::from(level.tiles_y));
        finer = level.tile_texels;
    }
    match params.levels.last() {
        None => Err(String::from("expected at least one level, found none")),
        Some(last) if (last.tiles_x, last.tiles_y) != (1, 1) => {
            Err(format!("expected one tile in the last level, found {} × {}", last.tiles_x, last.tiles_y))
        }
        Some(_) => Ok(tiles),
    }
}

fn check_level(params: &NdfMapsParams, level: &Level, first_tile: u64, finer: u32) -> Result<(), String> {
    let tile = level.tile_texels;
    if !tile.is_power_of_two() || tile <= finer {
        return Err(format!("expected a tile of a power of two above {finer} texels, found {tile}"));
    }
    let grid = (params.width.div_ceil(tile), params.height.div_ceil(tile));
    if (level.tiles_x, level.tiles_y) != grid {
        let found = (level.tiles_x, level.tiles_y);
        return Err(format!("expected {} × {} tiles, found {} × {}", grid.0, grid.1, found.0, found.1));
    }
    if u64::from(level.first_tile) != first_tile {
        return Err(format!("expected first tile {first_tile}, found {}", level.first_tile));
    }
    Ok(())
}

/// Reports the first tile that is wrong in each way; `texels` is `None` when the density is not known.
fn check_tiles(section: Loaded<'_>, texels: Option<u64>, issues: &mut Vec<Issue>) {
    let mut outside = None;
    let mut value = None;
    for (i, bytes) in section.bytes().chunks_exact(size_of::<TileRecord>()).enumerate() {
        let tile: TileRecord = bytemuck::pod_read_unaligned(bytes);
        if value.is_none() && !tile_values_are_right(&tile) {
            value = Some(format!("tile {i}: expected finite, positive values and at least one texel, found {tile:?}"));
        }
        let end = u64::from(tile.texel_offset) + u64::from(tile.width()) * u64::from(tile.height());
        if let Some(texels) = texels
            && outside.is_none()
            && end > texels
        {
            outside = Some(format!("tile {i} ends at texel {end}, the density has {texels} texels"));
        }
    }
    issues.extend(value.map(|why| section.error(IssueCode::NdfTileValue, why)));
    issues.extend(outside.map(|why| section.error(IssueCode::NdfTileOutOfDensity, why)));
}

fn tile_values_are_right(tile: &TileRecord) -> bool {
    let positive = [tile.inv_spacing[0], tile.inv_spacing[1], tile.scale].iter().all(|v| v.is_finite() && *v > 0.0);
    let finite = tile.origin.iter().all(|v| v.is_finite());
    positive && finite && tile.error.is_finite() && tile.error >= 0.0 && tile.width() > 0 && tile.height() > 0
}

/// The first density texel that is negative or not finite; 8 bits cannot be.
fn first_bad_density(bytes: &[u8], storage: DensityStorage) -> Option<String> {
    let value = |texel: &[u8]| match storage {
        DensityStorage::SqrtU8 => 0.0,
        DensityStorage::F16 => f16::from_le_bytes([texel[0], texel[1]]).to_f32(),
        DensityStorage::PaperF32 => f32::from_le_bytes([texel[0], texel[1], texel[2], texel[3]]),
    };
    if storage == DensityStorage::SqrtU8 {
        return None;
    }
    let bad = |v: f32| !(v.is_finite() && v >= 0.0);
    let (i, found) =
        bytes.chunks_exact(storage.texel_bytes() as usize).map(value).enumerate().find(|&(_, found)| bad(found))?;
    Some(format!("texel {i}: expected a finite density that is not negative, found {found}"))
}
