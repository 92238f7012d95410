//! Checks the contents of NDF map, placement and layer sections: what an evaluator relies on when it indexes nodes, the atlas
//! and transforms.

use crate::binding::TABLE_WIDTH;
use crate::container::Resource;
use crate::issue::{Issue, IssueCode};
use crate::ndf_maps::{
    CLASSES, DENSITY, LAYERS, LAYERS_UNIFORM, LayeredMaterial, LayersUniform, Level, MAX_EDGE, MAX_LEVELS, MAX_PALETTE,
    MaterialUniform, MomentsRecord, NODES, NOISE, NORMALS, NdfMapsParams, NodeRecord, NoiseTexel, PARAMS, PLACEMENT,
    PlacementKind, PlacementParams, REACH_CELLS, TransformRecord, UNIFORM, UNIFORM_BYTES, atlas_resource,
    classes_resource, noise_resource, table,
};
use crate::sections::{Loaded, Sections};
use crate::vk_format;

/// Owners are cells of a 3 × 3 neighbourhood.
const MAX_OWNER: u32 = 8;
/// Bytes of a record of the uniform.
const RECORD: usize = 16;
/// Nodes that fit in a table.
const MAX_NODES: u64 = TABLE_WIDTH as u64 * MAX_EDGE as u64;

/// Checks every example's NDF maps and placement, and every layered material.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_material(sections, section, issues);
    }
    sections.report_orphans(&[UNIFORM, NODES, DENSITY, NORMALS, PLACEMENT], PARAMS, issues);
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
    let nodes = sections.need(NODES, section, issues);
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
    let atlas = density.and_then(|density| Atlas::read(density, issues));
    if let Err(why) = check_levels(&params) {
        issues.push(section.error(IssueCode::NdfLevels, why));
        return;
    }
    let (count, errors) = (params.node_count(), params.node_errors.len());
    if errors as u64 != count {
        let message = format!("expected an error for each of {count} nodes, found {errors}");
        issues.push(section.error(IssueCode::NdfNodeCount, message));
    }
    let nodes = nodes.filter(|nodes| check_node_table(*nodes, &params, issues));
    let Some(atlas) = atlas else { return };
    if let Some(nodes) = nodes {
        check_nodes(nodes, count, &atlas, issues);
    }
    let (Some(uniform), Some(placed)) = (uniform, placed) else { return };
    let expected = Resource::Buffer { stride: UNIFORM_BYTES as u32, count: 1 };
    if uniform.expect(IssueCode::WrongDescriptor, expected, issues) {
        check_uniform(uniform, &params, &placed, &atlas, issues);
    }
}

/// The uniform says what the parameters say, and holds a palette of usable transforms.
fn check_uniform(
    uniform: Loaded<'_>,
    params: &NdfMapsParams,
    placed: &PlacementParams,
    atlas: &Atlas<'_>,
    issues: &mut Vec<Issue>,
) {
    let (header, records) = uniform.payload.split_at(size_of::<MaterialUniform>());
    // What the palette says is known only when the palette can be trusted.
    let most_texels = bytemuck::pod_read_unaligned::<MaterialUniform>(header).most_texels;
    let expected = MaterialUniform::new(params, placed, atlas.size, most_texels);
    let mut differs = |message: String| issues.push(uniform.error(IssueCode::NdfUniform, message));
    if header != bytemuck::bytes_of(&expected) {
        let found: MaterialUniform = bytemuck::pod_read_unaligned(header);
        return differs(format!("expected {expected:?}, found {found:?}"));
    }
    for (i, (level, record)) in params.levels.iter().zip(records.chunks_exact(RECORD)).enumerate() {
        let expected = [level.nodes_x, level.nodes_y, level.first_node, 0];
        let found: [u32; 4] = bytemuck::pod_read_unaligned(record);
        if found != expected {
            return differs(format!("level {i}: expected {expected:?}, found {found:?}"));
        }
    }
    let used = (expected.reach_records as usize + REACH_CELLS) * RECORD;
    if let Some(at) = records[used..].iter().position(|byte| *byte != 0) {
        let found = records[used + at];
        return differs(format!(
            "expected zeros after the records, found {found} at byte {}",
            header.len() + used + at
        ));
    }
    let palette = &records[expected.palette_records as usize * RECORD..expected.reach_records as usize * RECORD];
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
    if !(-1e-3 * most..=1e-3 * most).contains(&(f64::from(most_texels) - most)) {
        differs(format!("expected {most} example texels a surface texel, found {most_texels}"));
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
    // Of a number that is not normal the inverse, which evaluators use, may be infinite.
    if !(params.intrinsic_roughness > 0.0 && params.intrinsic_roughness.is_normal()) {
        return Err(format!("expected a positive intrinsic roughness, found {}", params.intrinsic_roughness));
    }
    if !(params.finest_variance > 0.0 && params.finest_variance.is_finite()) {
        return Err(format!("expected a positive variance of the finest windows, found {}", params.finest_variance));
    }
    let (measured, pixel) = (&params.measured, &params.pixel);
    let is_error = |error: f64| error >= 0.0 && error.is_finite();
    let of_nodes = [f64::from(params.max_error), measured.mean, measured.p95, measured.worst, measured.energy];
    for error in of_nodes.into_iter().chain([pixel.mean, pixel.worst]) {
        if !is_error(error) {
            return Err(format!("expected errors that are finite and not negative, found {error}"));
        }
    }
    let sigma = pixel.worst_sigma_texels;
    if !(sigma > 0.0 && sigma.is_finite()) {
        return Err(format!("expected a positive standard deviation of the pixels that are worst, found {sigma}"));
    }
    match params.node_errors.iter().enumerate().find(|&(_, error)| !is_error(f64::from(*error))) {
        Some((i, error)) => Err(format!("node {i}: expected an error that is finite and not negative, found {error}")),
        None => Ok(()),
    }
}

/// Levels follow each other, from fine to coarse, and their nodes fit in a table.
fn check_levels(params: &NdfMapsParams) -> Result<(), String> {
    let levels = params.levels.len();
    if !(1..=MAX_LEVELS).contains(&levels) {
        return Err(format!("expected 1 to {MAX_LEVELS} levels, found {levels}"));
    }
    let mut first_node = 0u64;
    let mut finer = [u32::MAX; 2];
    for (i, level) in params.levels.iter().enumerate() {
        check_level(level, first_node, finer).map_err(|why| format!("level {i}: {why}"))?;
        first_node = first_node.saturating_add(level.nodes());
        finer = [level.nodes_x, level.nodes_y];
    }
    if finer != [1, 1] {
        return Err(format!("expected one node in the last level, found {} × {}", finer[0], finer[1]));
    }
    if first_node > MAX_NODES {
        return Err(format!("expected at most {MAX_NODES} nodes, as a table holds, found {first_node}"));
    }
    Ok(())
}

fn check_level(level: &Level, first_node: u64, finer: [u32; 2]) -> Result<(), String> {
    let grid = [level.nodes_x, level.nodes_y];
    if grid.contains(&0) {
        return Err(format!("expected at least one node, found {} × {}", grid[0], grid[1]));
    }
    // Every second row is shifted by half a column, so that two go around together.
    if grid[1] > 1 && grid[1] % 2 == 1 {
        return Err(format!("expected one row of nodes or an even number, found {}", grid[1]));
    }
    if grid[0] > finer[0] || grid[1] > finer[1] {
        let [x, y] = finer;
        return Err(format!(
            "expected at most the {x} × {y} nodes of the finer level, found {} × {}",
            grid[0], grid[1]
        ));
    }
    if u64::from(level.first_node) != first_node {
        return Err(format!("expected first node {first_node}, found {}", level.first_node));
    }
    Ok(())
}

/// Whether the table has a record a node and nothing else; reports it when it has not.
fn check_node_table(nodes: Loaded<'_>, params: &NdfMapsParams, issues: &mut Vec<Issue>) -> bool {
    let shape = table(vk_format::R32G32B32A32_UINT, params.node_elements());
    if !nodes.expect(IssueCode::NdfNodeCount, shape, issues) {
        return false;
    }
    let count = params.node_count();
    let used = count as usize * (size_of::<NodeRecord>() + size_of::<MomentsRecord>());
    let rest = nodes.payload[used..].iter().position(|byte| *byte != 0);
    if let Some(at) = rest {
        let message = format!(
            "expected zeros after {count} nodes and their moments, found {} at byte {}",
            nodes.payload[used + at],
            used + at
        );
        issues.push(nodes.error(IssueCode::NdfNodeCount, message));
    }
    rest.is_none()
}

/// What a density section holds.
struct Atlas<'a> {
    /// Width and height in texels.
    size: [u32; 2],
    /// Texels row by row.
    texels: &'a [u8],
}

impl<'a> Atlas<'a> {
    /// Of a section that has the right descriptor; reports another.
    fn read(density: Loaded<'a>, issues: &mut Vec<Issue>) -> Option<Atlas<'a>> {
        let size = match density.entry.resource {
            Resource::Texture { width, height, .. } => [width.min(MAX_EDGE), height.min(MAX_EDGE)],
            _ => [MAX_EDGE; 2],
        };
        let right = density.expect(IssueCode::WrongDescriptor, atlas_resource(size), issues);
        right.then_some(Atlas { size, texels: density.payload })
    }

    fn texel(&self, [x, y]: [u32; 2]) -> u8 {
        self.texels[y as usize * self.size[0] as usize + x as usize]
    }

    /// Whether the table of a node and the texels around it lie in the atlas.
    fn holds(&self, node: &NodeRecord) -> bool {
        let (place, size) = (node.place(), node.size());
        (0..2).all(|axis| place[axis] >= 1 && place[axis] + size[axis] < self.size[axis])
    }

    /// The first texel around the table of a node that is not zero; the atlas holds the node.
    fn not_zero_around(&self, node: &NodeRecord) -> Option<[u32; 2]> {
        let ([x, y], [width, height]) = (node.place(), node.size());
        let (left, right, top, bottom) = (x - 1, x + width, y - 1, y + height);
        let rows = (left..=right).flat_map(|x| [[x, top], [x, bottom]]);
        let columns = (y..bottom).flat_map(|y| [[left, y], [right, y]]);
        rows.chain(columns).find(|&at| self.texel(at) != 0)
    }
}

/// Reports the first node that is wrong in each way.
fn check_nodes(section: Loaded<'_>, count: u64, atlas: &Atlas<'_>, issues: &mut Vec<Issue>) {
    let mut outside = None;
    let mut value = None;
    let mut border = None;
    let records = section.payload.chunks_exact(size_of::<NodeRecord>()).take(count as usize);
    for (i, bytes) in records.enumerate() {
        let node: NodeRecord = bytemuck::pod_read_unaligned(bytes);
        let ([x, y], [width, height]) = (node.place(), node.size());
        if !node_values_are_right(&node) {
            let ([dx, dy], scale) = (node.spacing(), node.scale);
            value.get_or_insert_with(|| {
                format!(
                    "node {i}: expected at least one texel, a spacing of at least one step and a finite, positive scale, found \
                     {width} × {height} texels, a spacing of {dx} × {dy} steps and scale {scale}"
                )
            });
        } else if !atlas.holds(&node) {
            outside.get_or_insert_with(|| {
                let [atlas_width, atlas_height] = atlas.size;
                format!(
                    "node {i}: expected its {width} × {height} texels and one more on every side in an atlas of {atlas_width} × \
                     {atlas_height} texels, found them at ({x}, {y})"
                )
            });
        } else if border.is_none()
            && let Some(at) = atlas.not_zero_around(&node)
        {
            border = Some(format!(
                "node {i}: expected zeros around its {width} × {height} texels at ({x}, {y}), found {} at ({}, {})",
                atlas.texel(at),
                at[0],
                at[1]
            ));
        }
    }
    issues.extend(value.map(|why| section.error(IssueCode::NdfNodeValue, why)));
    issues.extend(outside.map(|why| section.error(IssueCode::NdfNodeOutOfAtlas, why)));
    issues.extend(border.map(|why| section.error(IssueCode::NdfNodeBorder, why)));
}

fn node_values_are_right(node: &NodeRecord) -> bool {
    let is_whole = !node.size().contains(&0) && !node.spacing().contains(&0);
    is_whole && node.scale.is_finite() && node.scale > 0.0
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
        classes.expect(IssueCode::ClassesDescriptor, classes_resource(cells_x), issues);
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
