//! Checks the contents of NDF map, placement and layer sections: what an evaluator relies on when it indexes tiles, density
//! and transforms.

use crate::bytes::{f16_at, f32_at};
use crate::container::{Resource, full_mip_count};
use crate::issue::{Issue, IssueCode};
use crate::ndf_maps::{
    CLASSES, DENSITY, DensityStorage, LAYERS, LayeredMaterial, Level, NOISE, NORMALS, NdfMapsParams, NoiseTexel,
    PALETTE, PARAMS, PLACEMENT, PlacementKind, PlacementParams, TILES, TileRecord, TransformRecord,
};
use crate::sections::{Loaded, Sections};
use crate::vk_format;

/// Most entries of a palette: the noise map has 8 bits for an index.
const MAX_PALETTE: u32 = 256;
/// Owners are cells of a 3 × 3 neighbourhood.
const MAX_OWNER: u32 = 8;

/// Checks every example's NDF maps.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_example(sections, section, issues);
    }
    sections.report_orphans(&[TILES, DENSITY, NORMALS, PLACEMENT], PARAMS, issues);
    check_placements(sections, issues);
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
        && let Some(why) = first_bad_density(density.payload, params.storage)
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
    for (i, bytes) in section.payload.chunks_exact(size_of::<TileRecord>()).enumerate() {
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
        DensityStorage::F16 => f16_at(texel, 0),
        DensityStorage::PaperF32 => f32_at(texel, 0),
    };
    if storage == DensityStorage::SqrtU8 {
        return None;
    }
    let bad = |v: f32| !(v.is_finite() && v >= 0.0);
    let (i, found) =
        bytes.chunks_exact(storage.texel_bytes() as usize).map(value).enumerate().find(|&(_, found)| bad(found))?;
    Some(format!("texel {i}: expected a finite density that is not negative, found {found}"))
}

/// Checks every placement and every layered material: indices lie in range before a shader follows them.
fn check_placements(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PLACEMENT) {
        check_placement(sections, section, issues);
    }
    sections.report_orphans(&[PALETTE, NOISE, CLASSES], PLACEMENT, issues);
    for section in sections.of_kind(LAYERS) {
        if let Some(layers) = section.parameters::<LayeredMaterial>(issues) {
            check_layers(sections, section, &layers, issues);
        }
    }
}

fn check_placement(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) {
    let palette = sections.need(PALETTE, section, issues);
    let Some(params) = section.parameters::<PlacementParams>(issues) else { return };
    if let Some(palette) = palette {
        check_palette(palette, params.palette_len, issues);
    }
    let PlacementKind::Stochastic { cells_x, cells_y, cell_texels, .. } = params.kind else { return };
    let noise = sections.need(NOISE, section, issues);
    let classes = sections.need(CLASSES, section, issues);
    if !(cells_x.is_power_of_two() && cells_y.is_power_of_two() && cell_texels.is_finite() && cell_texels > 0.0) {
        let message = format!(
            "expected powers of two and a positive edge, found {cells_x} × {cells_y} cells of {cell_texels} texels"
        );
        issues.push(section.error(IssueCode::PlacementGrid, message));
        return;
    }
    if let Some(noise) = noise
        && noise.expect(IssueCode::NoiseDescriptor, noise_resource(cells_x, cells_y), issues)
    {
        check_noise(noise, params.palette_len, issues);
    }
    if let Some(classes) = classes {
        classes.expect(IssueCode::ClassesDescriptor, classes_resource(cells_x, cells_y, params.palette_len), issues);
    }
}

fn noise_resource(width: u32, height: u32) -> Resource {
    Resource::Texture { vk_format: vk_format::R32G32B32A32_UINT, width, height, layers: 1, faces: 1, mips: 1 }
}

fn classes_resource(width: u32, height: u32, palette_len: u32) -> Resource {
    Resource::Texture {
        vk_format: vk_format::R8G8B8A8_UNORM,
        width,
        height,
        layers: palette_len.div_ceil(4),
        faces: 1,
        mips: full_mip_count(width, height),
    }
}

fn check_palette(palette: Loaded<'_>, palette_len: u32, issues: &mut Vec<Issue>) {
    let Some(count) = palette.buffer_count(size_of::<TransformRecord>() as u32, issues) else { return };
    if palette_len == 0 || palette_len > MAX_PALETTE || count != u64::from(palette_len) {
        let message = format!(
            "expected 1 to {MAX_PALETTE} entries, as many as the parameters state, found {count} and {palette_len}"
        );
        issues.push(palette.error(IssueCode::PaletteLength, message));
    }
    for (i, bytes) in palette.payload.chunks_exact(size_of::<TransformRecord>()).enumerate() {
        let transform: TransformRecord = bytemuck::pod_read_unaligned(bytes);
        if !(is_usable(transform.position_to_local) && is_usable(transform.normal_to_local)) {
            let message = format!("entry {i}: expected finite matrices that can be inverted, found {transform:?}");
            issues.push(palette.error(IssueCode::PaletteValue, message));
            return;
        }
    }
}

/// A 2 × 2 matrix that is finite and can be inverted.
fn is_usable(m: [f32; 4]) -> bool {
    let determinant = f64::from(m[0]) * f64::from(m[3]) - f64::from(m[1]) * f64::from(m[2]);
    m.iter().all(|v| v.is_finite()) && determinant != 0.0
}

/// Reports the first cell that is wrong in each way.
fn check_noise(noise: Loaded<'_>, palette_len: u32, issues: &mut Vec<Issue>) {
    let mut class_issue = None;
    let mut owner_issue = None;
    let mut reserved_issue = None;
    for (i, bytes) in noise.payload.chunks_exact(size_of::<NoiseTexel>()).enumerate() {
        let texel: NoiseTexel = bytemuck::pod_read_unaligned(bytes);
        let class = texel.class_and_owners & 0xff;
        if class_issue.is_none() && class >= palette_len {
            class_issue = Some(format!("cell {i}: expected a class below {palette_len}, found {class}"));
        }
        for region in 0..4 {
            let owner = texel.class_and_owners >> (16 + 4 * region) & 0xf;
            if owner_issue.is_none() && owner > MAX_OWNER {
                owner_issue =
                    Some(format!("cell {i}, sub-region {region}: expected at most {MAX_OWNER}, found {owner}"));
            }
        }
        if reserved_issue.is_none() && (texel.reserved != 0 || texel.class_and_owners & 0xff00 != 0) {
            reserved_issue = Some(format!("cell {i}: expected zeros, found {texel:?}"));
        }
    }
    issues.extend(class_issue.map(|why| noise.error(IssueCode::NoiseClass, why)));
    issues.extend(owner_issue.map(|why| noise.error(IssueCode::NoiseOwner, why)));
    issues.extend(reserved_issue.map(|why| noise.error(IssueCode::NoiseReserved, why)));
}

fn check_layers(sections: &Sections<'_>, section: Loaded<'_>, layers: &LayeredMaterial, issues: &mut Vec<Issue>) {
    for (layer, name) in [("coat", &layers.coat), ("base", &layers.base)] {
        if !sections.has(PARAMS, name) {
            let message = format!("expected NDF maps for the {layer}, found none named {name:?}");
            issues.push(section.error(IssueCode::LayerName, message));
        }
    }
    let reflectances = [layers.coat_f0, layers.base_f0[0], layers.base_f0[1], layers.base_f0[2]];
    if let Some(found) = reflectances.iter().find(|f0| !(0.0..=1.0).contains(*f0)) {
        issues.push(section.error(IssueCode::LayerValue, format!("expected 0 to 1, found {found}")));
    }
}
