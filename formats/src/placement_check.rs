//! Checks the contents of placement and layer sections: indices lie in range before a shader follows them.

use crate::container::{Resource, full_mip_count};
use crate::issue::{Issue, IssueCode};
use crate::ndf_maps::{
    CLASSES, LAYERS, LayeredMaterial, NOISE, NoiseTexel, PALETTE, PARAMS, PLACEMENT, PlacementKind, PlacementParams,
    TransformRecord,
};
use crate::sections::{Loaded, Sections};
use crate::vk_format;

/// Most entries of a palette: the noise map has 8 bits for an index.
const MAX_PALETTE: u32 = 256;
/// Owners are cells of a 3 × 3 neighbourhood.
const MAX_OWNER: u32 = 8;

/// Checks every placement and every layered material.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
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
    for (i, bytes) in palette.bytes().chunks_exact(size_of::<TransformRecord>()).enumerate() {
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
    for (i, bytes) in noise.bytes().chunks_exact(size_of::<NoiseTexel>()).enumerate() {
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
