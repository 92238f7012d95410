//! Bad packs whose container is right: G2xxx and G3xxx, a file a method.

mod area_light;
mod dictionary;
mod environment;
mod glints;
mod lobes;
mod ndf_maps;
mod surface;
mod synthesis;

use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::ndf_maps::*;
use glint_formats::provenance::{PROVENANCE, Provenance};
use glint_formats::{IssueCode, Resource, Section, params};

pub fn cases() -> Vec<Case> {
    let mut cases = parameter_cases();
    cases.extend(group_cases());
    cases.extend(ndf_maps::ndf_cases());
    cases.extend(ndf_maps::placement_cases());
    cases.extend(ndf_maps::noise_cases());
    cases.extend(ndf_maps::layer_cases());
    cases.extend(dictionary::cases());
    cases.extend(environment::cases());
    cases.extend(glints::cases());
    cases.extend(area_light::cases());
    cases.extend(lobes::cases());
    cases.extend(synthesis::cases());
    cases.push(case(IssueCode::SurfaceMismatch, surface::with(|_, surface| surface.alignment = 2)));
    cases
}

/// A provenance section with these bytes.
fn raw_provenance(payload: Vec<u8>) -> Section {
    Section { payload, ..provenance_section() }
}

/// Parameters above the decode limit, which the writer refuses: a compressed buffer whose entry says otherwise.
fn too_large() -> Vec<u8> {
    let zeros = vec![0u8; params::MAX_BYTES + 1];
    let bytes = pack(vec![Section::buffer(PROVENANCE, "", &zeros).compressed()]);
    patched(bytes, entry_at(0, 40), &[0; 32])
}

fn with_path() -> Section {
    let mut provenance: Provenance = provenance();
    provenance.inputs[0].name = String::from("textures/rock.png");
    Section::parameters(PROVENANCE, "", &provenance)
}

fn parameter_cases() -> Vec<Case> {
    let mut trailing = params::encode(&provenance());
    trailing.push(0);
    vec![
        case(IssueCode::ParametersMalformed, pack(vec![raw_provenance(vec![0xff; 8])])),
        case(IssueCode::ParametersTrailing, pack(vec![raw_provenance(trailing)])),
        case(IssueCode::ParametersTooLarge, too_large()),
        case(IssueCode::BadProvenance, pack(vec![with_path()])),
    ]
}

pub fn without(sections: Vec<Section>, kind: glint_formats::FourCc) -> Vec<Section> {
    sections.into_iter().filter(|section| section.kind != kind).collect()
}

fn group_cases() -> Vec<Case> {
    let mut normals = normals_section();
    normals.payload.truncate(48);
    if let Resource::Texture { height, .. } = &mut normals.resource {
        *height = 1;
    }
    let mut wrong_size = without(good_ndf_maps(), NORMALS);
    wrong_size.push(normals);
    vec![
        case(IssueCode::MissingSection, pack(without(good_ndf_maps(), NORMALS))),
        case(IssueCode::OrphanSection, pack(vec![normals_section()])),
        case(IssueCode::WrongDescriptor, pack(wrong_size)),
    ]
}
