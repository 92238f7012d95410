//! Checks the contents of area-light sections: what a shader relies on when it reads them.

use crate::area_light::{
    AreaLightParams, AreaLightUniform, INVERSE, MAX_TEXTURE_SIZE, NORMALS, PARAMS, ROUGHNESS, TABLE_SIZE,
    TABLE_VK_FORMAT, TERMS, UNIFORM,
};
use crate::bytes::f16_at;
use crate::container::{Resource, full_mip_count};
use crate::issue::{Issue, IssueCode};
use crate::sections::{Loaded, Sections};

/// Longest mean normal, and largest eigenvalue of a roughness, that rounding can make of 1.
const LONGEST: f32 = 1.02;
/// How far below 0 rounding can take an eigenvalue of a roughness.
const ROUNDING: f32 = 0.02;

/// Checks every area-light material.
pub(crate) fn check(sections: &Sections<'_>, issues: &mut Vec<Issue>) {
    for section in sections.of_kind(PARAMS) {
        check_material(sections, section, issues);
    }
    sections.report_orphans(&[UNIFORM, NORMALS, ROUGHNESS, INVERSE, TERMS], PARAMS, issues);
}

fn check_material(sections: &Sections<'_>, section: Loaded<'_>, issues: &mut Vec<Issue>) {
    let [uniform, normals, inverse, terms] =
        [UNIFORM, NORMALS, INVERSE, TERMS].map(|kind| sections.need(kind, section, issues));
    let Some(params) = section.parameters::<AreaLightParams>(issues) else { return };
    if let Err(why) = check_parameters(&params) {
        issues.push(section.error(IssueCode::AreaLightParameters, why));
        return;
    }
    if let Some(uniform) = uniform {
        check_uniform(uniform, &params, issues);
    }
    let shape = texture(params.storage.vk_format(), params.width, params.height);
    if let Some(normals) = normals
        && normals.expect(IssueCode::AreaLightShape, shape, issues)
    {
        check_texels(normals, &params, IssueCode::AreaLightNormal, normal_fault, issues);
    }
    if params.anisotropic {
        if let Some(roughness) = sections.need(ROUGHNESS, section, issues)
            && roughness.expect(IssueCode::AreaLightShape, shape, issues)
        {
            check_texels(roughness, &params, IssueCode::AreaLightRoughness, roughness_fault, issues);
        }
    } else if let Some(roughness) = sections.get(ROUGHNESS, &section.entry.name) {
        let message = "the parameters say that the material is isotropic, yet there is this section";
        issues.push(roughness.error(IssueCode::AreaLightShape, message));
    }
    check_tables(inverse, terms, issues);
}

/// Checks the LTC tables of a material, those that are there.
pub(crate) fn check_tables(inverse: Option<Loaded<'_>>, terms: Option<Loaded<'_>>, issues: &mut Vec<Issue>) {
    let table = Resource::Texture {
        vk_format: TABLE_VK_FORMAT,
        width: TABLE_SIZE,
        height: TABLE_SIZE,
        layers: 1,
        faces: 1,
        mips: 1,
    };
    for (found, fault) in [(inverse, inverse_fault as Fault), (terms, terms_fault)] {
        if let Some(found) = found
            && found.expect(IssueCode::LtcShape, table, issues)
        {
            check_table(found, fault, issues);
        }
    }
}

fn check_uniform(uniform: Loaded<'_>, params: &AreaLightParams, issues: &mut Vec<Issue>) {
    let resource = Resource::Buffer { stride: size_of::<AreaLightUniform>() as u32, count: 1 };
    if !uniform.expect(IssueCode::AreaLightShape, resource, issues) {
        return;
    }
    let expected = params.uniform();
    if uniform.payload != bytemuck::bytes_of(&expected) {
        let found: AreaLightUniform = bytemuck::pod_read_unaligned(uniform.payload);
        let message = format!("expected what follows from the parameters, {expected:?}, found {found:?}");
        issues.push(uniform.error(IssueCode::AreaLightUniform, message));
    }
}

/// What is wrong with a texel.
type Fault = fn([f32; 4]) -> Option<&'static str>;

fn texture(vk_format: u32, width: u32, height: u32) -> Resource {
    Resource::Texture { vk_format, width, height, layers: 1, faces: 1, mips: full_mip_count(width, height) }
}

fn check_parameters(params: &AreaLightParams) -> Result<(), String> {
    for (what, found) in [("width", params.width), ("height", params.height)] {
        if !(1..=MAX_TEXTURE_SIZE).contains(&found) {
            return Err(format!("expected a {what} of 1 to {MAX_TEXTURE_SIZE} texels, found {found}"));
        }
    }
    if !(0.001..=1.0).contains(&params.base_roughness) {
        return Err(format!("expected a base roughness from 0.001 to 1, found {}", params.base_roughness));
    }
    let measured = &params.measured;
    for error in [measured.normal_angle, measured.roughness, measured.table_mean] {
        if !(error >= 0.0 && error.is_finite()) {
            return Err(format!("expected errors that are finite and not negative, found {error}"));
        }
    }
    Ok(())
}

fn normal_fault(texel: [f32; 4]) -> Option<&'static str> {
    let [x, y, z, alpha] = texel;
    // A range holds no NaN.
    if !(0.0..=LONGEST * LONGEST).contains(&(x * x + y * y + z * z)) {
        return Some("a mean normal of length 1 at most");
    }
    if !(0.0..=LONGEST).contains(&z) {
        return Some("a mean normal above the surface");
    }
    if !(0.0..=1.0).contains(&alpha) {
        return Some("a roughness from 0 to 1");
    }
    None
}

fn roughness_fault(texel: [f32; 4]) -> Option<&'static str> {
    let [xx, xy, yy, unused] = texel;
    let (middle, gap) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    if !(middle - gap >= -ROUNDING && middle + gap <= LONGEST) {
        return Some("a symmetric matrix of eigenvalues from 0 to 1");
    }
    if unused != 0.0 {
        return Some("0 in the fourth channel");
    }
    None
}

fn check_texels(section: Loaded<'_>, params: &AreaLightParams, code: IssueCode, fault: Fault, issues: &mut Vec<Issue>) {
    let mut bytes = section.payload.chunks_exact(params.storage.texel_bytes());
    for mip in 0..full_mip_count(params.width, params.height) {
        let (width, height) = ((params.width >> mip).max(1), (params.height >> mip).max(1));
        for (at, bytes) in bytes.by_ref().take(width as usize * height as usize).enumerate() {
            let texel = params.storage.decode(bytes);
            if let Some(expected) = fault(texel) {
                let (x, y) = (at % width as usize, at / width as usize);
                issues.push(
                    section.error(code, format!("mip {mip}, texel ({x}, {y}): expected {expected}, found {texel:?}")),
                );
                return;
            }
        }
    }
}

fn inverse_fault(texel: [f32; 4]) -> Option<&'static str> {
    let [a, c, b, d] = texel;
    if !texel.iter().all(|v| v.is_finite()) {
        return Some("finite entries");
    }
    if !(0.0..=f32::INFINITY).contains(&(a * d - b * c)) {
        return Some("a matrix that does not mirror");
    }
    None
}

fn terms_fault(texel: [f32; 4]) -> Option<&'static str> {
    texel.iter().any(|v| !(0.0..=LONGEST).contains(v)).then_some("terms from 0 to 1")
}

fn check_table(section: Loaded<'_>, fault: Fault, issues: &mut Vec<Issue>) {
    for (at, bytes) in section.payload.chunks_exact(8).enumerate() {
        let texel: [f32; 4] = std::array::from_fn(|k| f16_at(bytes, 2 * k));
        if let Some(expected) = fault(texel) {
            let (x, y) = (at % TABLE_SIZE as usize, at / TABLE_SIZE as usize);
            issues.push(
                section.error(IssueCode::LtcValue, format!("texel ({x}, {y}): expected {expected}, found {texel:?}")),
            );
            return;
        }
    }
}
