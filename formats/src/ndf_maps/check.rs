//! Checks the contents of NDF map, placement and layer sections: what an evaluator relies on when it indexes tiles, density
//! and transforms.

use crate::binding::TABLE_WIDTH;
use crate::bytes::{f16_at, f32_at};
use crate::container::Resource;
use crate::issue::{Issue, IssueCode};
use crate::ndf_maps::{
    CLASSES, DENSITY, DensityStorage, LAYERS, LAYERS_UNIFORM, LayeredMaterial, LayersUniform, Level, MAX_EDGE,
    MAX_PALETTE, MaterialUniform, NOISE, NORMALS, NdfMapsParams, NoiseTexel, PARAMS, PLACEMENT, PlacementKind,
    PlacementParams, REACH_CELLS, TILES, TileRecord, TransformRecord, UNIFORM, UNIFORM_BYTES, classes_resource,
    few_tiles, noise_resource, table,
};
use crate::sections::{Loaded, Sections};
use crate::vk_format;

/// Owners are cells of a 3 × 3 neighbourhood.
const MAX_OWNER: u32 = 8;
/// Bytes of a record of the uniform, or of an element of the tables of tiles and blocks.
const RECORD: usize = 16;

/// Checks every example's NDF maps and placement, and every layered material.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_material(sections, section, issues);
    }
    sections.report_orphans(&[UNIFORM, TILES, DENSITY, NORMALS, PLACEMENT], PARAMS, issues);
    sections.report_orphans(&[NOISE, CLASSES], PLACEMENT, issues);
    for section in sections.of_kind(LAYERS) {
        let uniform = sections.need(LAYERS_UNIFORM, section, issues);
        if let Some(layers) = section.parameters::<LayeredMaterial>(issues) {
            check_layers(sections, section, &layers, uniform, issues);
        }
    }
    sections.report_orphans(&[LAYERS_UNIFORM], LAYERS, issues);
}

fn check_material(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) {
    let uniform = sections.need(UNIFORM, section, issues);
    let density = sections.need(DENSITY, section, issues);
    let normals = sections.need(NORMALS, section, issues);
    let placement = sections.need(PLACEMENT, section, issues);
    let placed = placement.and_then(|placement| check_placement(sections, placement, issues));
    let Some(params) = section.parameters::<NdfMapsParams>(issues) else { return };
    if let Err(why) = check_parameters(&params) {
        issues.push(section.error(IssueCode::NdfParameters, why));
        return;
    }
    if let Some(normals) = normals {
        normals.expect(IssueCode::WrongDescriptor, params.normals_resource(), issues);
    }
    let texels = density.and_then(|density| check_density(density, params.storage, issues));
    if let Err(why) = check_levels(&params) {
        issues.push(section.error(IssueCode::NdfLevels, why));
        return;
    }
    let (Some(uniform), Some(placed)) = (uniform, placed) else { return };
    let expected = Resource::Buffer { stride: UNIFORM_BYTES as u32, count: 1 };
    if !uniform.expect(IssueCode::WrongDescriptor, expected, issues) {
        return;
    }
    let table = check_tile_table(sections, section, &params, &placed, issues);
    check_uniform(uniform, &params, &placed, texels.as_ref().map(|texels| texels.in_blocks), issues);
    let count = params.tile_count() as usize;
    let tiles = if few_tiles(&params, &placed) {
        let header = MaterialUniform::new(&params, &placed, false, 0.0);
        let first = size_of::<MaterialUniform>() + header.tile_records as usize * RECORD;
        Some((uniform, &uniform.payload[first..first + count * size_of::<TileRecord>()]))
    } else {
        table.map(|table| (table, &table.payload[..count * size_of::<TileRecord>()]))
    };
    if let Some((section, tiles)) = tiles {
        check_tiles(section, tiles, texels.as_ref(), issues);
    }
}

/// What a density section holds.
struct Texels {
    in_blocks: bool,
    /// Texels, or blocks, that its table has room for.
    count: u64,
}

/// A table of blocks or words with densities that are numbers.
fn check_density(density: Loaded<'_>, storage: DensityStorage, issues: &mut Vec<Issue>) -> Option<Texels> {
    let bytes = density.payload.len() as u64;
    let in_blocks = matches!(
        density.entry.resource,
        Resource::Texture { vk_format: vk_format::R32G32B32A32_UINT, .. } if storage == DensityStorage::SqrtU8
    );
    let (format, element) = if in_blocks { (vk_format::R32G32B32A32_UINT, 16) } else { (vk_format::R32_UINT, 4) };
    if !density.expect(IssueCode::WrongDescriptor, table(format, bytes / element), issues) {
        return None;
    }
    if let Some(why) = first_bad_density(density.payload, storage) {
        issues.push(density.error(IssueCode::NdfDensityValue, why));
    }
    let count = if in_blocks { bytes / element } else { bytes / u64::from(storage.texel_bytes()) };
    Some(Texels { in_blocks, count })
}

/// The table of tiles, which is there where they do not fit among the records.
fn check_tile_table<'a>(
    sections: &'a Sections<'_>,
    section: Loaded<'_>,
    params: &NdfMapsParams,
    placed: &PlacementParams,
    issues: &mut Vec<Issue>,
) -> Option<Loaded<'a>> {
    if few_tiles(params, placed) {
        if let Some(tiles) = sections.get(TILES, &section.entry.name) {
            let message = format!("expected no table of {} tiles, which fit in {UNIFORM}", params.tile_count());
            issues.push(tiles.error(IssueCode::NdfTileCount, message));
        }
        return None;
    }
    let tiles = sections.need(TILES, section, issues)?;
    let expected = table(vk_format::R32G32B32A32_UINT, 2 * params.tile_count());
    tiles.expect(IssueCode::NdfTileCount, expected, issues).then_some(tiles)
}

/// The uniform says what the parameters say, and holds a palette of usable transforms.
fn check_uniform(
    uniform: Loaded<'_>,
    params: &NdfMapsParams,
    placed: &PlacementParams,
    in_blocks: Option<bool>,
    issues: &mut Vec<Issue>,
) {
    let (header, records) = uniform.payload.split_at(size_of::<MaterialUniform>());
    let found: MaterialUniform = bytemuck::pod_read_unaligned(header);
    let mut differs = |message: String| issues.push(uniform.error(IssueCode::NdfUniform, message));
    let expected = MaterialUniform::new(params, placed, in_blocks.unwrap_or(found.blocks == 1), found.most_texels);
    if found != expected {
        return differs(format!("expected {expected:?}, found {found:?}"));
    }
    for (i, (level, record)) in params.levels.iter().zip(records.chunks_exact(RECORD)).enumerate() {
        let expected = [level.tile_texels, level.tiles_x, level.tiles_y, level.first_tile];
        let found: [u32; 4] = bytemuck::pod_read_unaligned(record);
        if found != expected {
            return differs(format!("level {i}: expected {expected:?}, found {found:?}"));
        }
    }
    let first = found.palette_records as usize * RECORD;
    let palette = &records[first..found.reach_records as usize * RECORD];
    let mut most = 0.0f64;
    for (i, bytes) in palette.chunks_exact(size_of::<TransformRecord>()).enumerate() {
        let transform: TransformRecord = bytemuck::pod_read_unaligned(bytes);
        if !(is_usable(transform.position_to_local) && is_usable(transform.normal_to_local)) {
            let message = format!("entry {i}: expected finite matrices that can be inverted, found {transform:?}");
            issues.push(uniform.error(IssueCode::PaletteValue, message));
            return;
        }
        most = most.max(determinant(transform.position_to_local).abs().sqrt());
    }
    // A range holds no NaN.
    if !(-1e-3 * most..=1e-3 * most).contains(&(f64::from(found.most_texels) - most)) {
        return differs(format!("expected {most} example texels a surface texel, found {}", found.most_texels));
    }
    let tiles = if found.few_tiles == 1 { 2 * params.tile_count() as usize } else { 0 };
    let used = (found.reach_records as usize + REACH_CELLS + tiles) * RECORD;
    if let Some(at) = records[used..].iter().position(|byte| *byte != 0) {
        differs(format!(
            "expected zeros after the records, found {} at byte {}",
            records[used + at],
            header.len() + used + at
        ));
    }
}

fn check_parameters(params: &NdfMapsParams) -> Result<(), String> {
    if params.width == 0 || params.height == 0 {
        return Err(format!("expected at least one texel, found {} × {}", params.width, params.height));
    }
    if params.width.max(params.height) > MAX_EDGE {
        let (width, height) = (params.width, params.height);
        return Err(format!("expected at most {MAX_EDGE} texels along an edge, found {width} × {height}"));
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

/// Levels cover the example and follow each other, and their tiles fit in a table.
fn check_levels(params: &NdfMapsParams) -> Result<(), String> {
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
        Some(_) if tiles.saturating_mul(2) > u64::from(TABLE_WIDTH) * u64::from(MAX_EDGE) => {
            Err(format!("expected tiles that fit in a table, found {tiles}"))
        }
        Some(_) => Ok(()),
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
fn check_tiles(section: Loaded<'_>, tiles: &[u8], texels: Option<&Texels>, issues: &mut Vec<Issue>) {
    let mut outside = None;
    let mut value = None;
    for (i, bytes) in tiles.chunks_exact(size_of::<TileRecord>()).enumerate() {
        let tile: TileRecord = bytemuck::pod_read_unaligned(bytes);
        if value.is_none() && !tile_values_are_right(&tile) {
            value = Some(format!("tile {i}: expected finite, positive values and at least one texel, found {tile:?}"));
        }
        let Some(texels) = texels else { continue };
        let (width, height) = (u64::from(tile.width()), u64::from(tile.height()));
        let (pieces, what) =
            if texels.in_blocks { ((width + 2) * (height + 2), "block") } else { (width * height, "texel") };
        let end = u64::from(tile.first) + pieces;
        if outside.is_none() && end > texels.count {
            outside = Some(format!("tile {i} ends at {what} {end}, the density has {}", texels.count));
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

/// A placement: indices lie in range before a shader follows them. Returns it if maps can be checked with it.
fn check_placement(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) -> Option<PlacementParams> {
    let params = section.parameters::<PlacementParams>(issues)?;
    if !(1..=MAX_PALETTE).contains(&params.palette_len) {
        let message = format!("expected 1 to {MAX_PALETTE} entries, found {}", params.palette_len);
        issues.push(section.error(IssueCode::PaletteLength, message));
        return None;
    }
    let PlacementKind::Stochastic { cells_x, cells_y, cell_texels, .. } = params.kind else { return Some(params) };
    let noise = sections.need(NOISE, section, issues);
    let classes = sections.need(CLASSES, section, issues);
    let is_grid = cells_x == cells_y && cells_x.is_power_of_two() && cells_x <= MAX_EDGE / 2;
    if !(is_grid && cell_texels.is_finite() && cell_texels > 0.0) {
        let message = format!(
            "expected a square grid of a power of two, {} at most, and a positive edge, found {cells_x} × {cells_y} cells of \
             {cell_texels} texels",
            MAX_EDGE / 2
        );
        issues.push(section.error(IssueCode::PlacementGrid, message));
        return None;
    }
    if let Some(noise) = noise
        && noise.expect(IssueCode::NoiseDescriptor, noise_resource(cells_x), issues)
    {
        check_noise(noise, params.palette_len, issues);
    }
    if let Some(classes) = classes {
        classes.expect(IssueCode::ClassesDescriptor, classes_resource(cells_x, params.palette_len), issues);
    }
    Some(params)
}

/// A 2 × 2 matrix that is finite and can be inverted.
fn is_usable(m: [f32; 4]) -> bool {
    m.iter().all(|v| v.is_finite()) && determinant(m) != 0.0
}

fn determinant(m: [f32; 4]) -> f64 {
    f64::from(m[0]) * f64::from(m[3]) - f64::from(m[1]) * f64::from(m[2])
}

/// Reports the first sub-region that is wrong in each way.
fn check_noise(noise: Loaded<'_>, palette_len: u32, issues: &mut Vec<Issue>) {
    let mut class_issue = None;
    let mut owner_issue = None;
    let mut reserved_issue = None;
    for (i, bytes) in noise.payload.chunks_exact(size_of::<NoiseTexel>()).enumerate() {
        let texel: NoiseTexel = bytemuck::pod_read_unaligned(bytes);
        let class = texel.class();
        if class_issue.is_none() && class >= palette_len {
            class_issue = Some(format!("sub-region {i}: expected a class below {palette_len}, found {class}"));
        }
        let owner = texel.class_and_neighbour >> 16;
        if owner_issue.is_none() && owner > MAX_OWNER {
            owner_issue = Some(format!("sub-region {i}: expected at most {MAX_OWNER}, found {owner}"));
        }
        if reserved_issue.is_none() && (texel.reserved != 0 || texel.class_and_neighbour & 0xff00 != 0) {
            reserved_issue = Some(format!("sub-region {i}: expected zeros, found {texel:?}"));
        }
    }
    issues.extend(class_issue.map(|why| noise.error(IssueCode::NoiseClass, why)));
    issues.extend(owner_issue.map(|why| noise.error(IssueCode::NoiseOwner, why)));
    issues.extend(reserved_issue.map(|why| noise.error(IssueCode::NoiseReserved, why)));
}

fn check_layers(
    sections: &Sections<'_>,
    section: Loaded<'_>,
    layers: &LayeredMaterial,
    uniform: Option<Loaded<'_>>,
    issues: &mut Vec<Issue>,
) {
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
    let Some(uniform) = uniform else { return };
    let stride = size_of::<LayersUniform>() as u32;
    if !uniform.expect(IssueCode::WrongDescriptor, Resource::Buffer { stride, count: 1 }, issues) {
        return;
    }
    let expected = LayersUniform::of(layers);
    let found: LayersUniform = bytemuck::pod_read_unaligned(uniform.payload);
    if bytemuck::bytes_of(&found) != bytemuck::bytes_of(&expected) {
        issues.push(uniform.error(IssueCode::LayerUniform, format!("expected {expected:?}, found {found:?}")));
    }
}
