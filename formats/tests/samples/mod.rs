//! Small good packs, and the means to make bad ones of them.

mod area_light;
mod dictionary;
mod environment;
mod glints;
mod lobes;
mod ndf_maps;
mod seals;
mod surface;
mod synthesis;

pub use area_light::*;
pub use dictionary::*;
pub use environment::*;
use glint_formats::container::{FourCc, Limits};
use glint_formats::provenance::{InputDigest, PROVENANCE, Provenance};
use glint_formats::{IssueCode, PackBuilder, Section, validate};
pub use glints::*;
pub use lobes::*;
pub use ndf_maps::*;
pub use seals::*;
pub use surface::*;
pub use synthesis::*;

/// Name of the sample material.
pub const ROCK: &str = "rock";

pub fn pack(sections: Vec<Section>) -> Vec<u8> {
    let mut builder = PackBuilder::new();
    for section in sections {
        builder.push(section).unwrap();
    }
    builder.finish().unwrap()
}

pub fn codes(bytes: &[u8]) -> Vec<IssueCode> {
    validate(bytes, &Limits::default()).iter().map(|issue| issue.code).collect()
}

pub fn provenance() -> Provenance {
    Provenance {
        tool_version: String::from("0.1.0"),
        method: String::from("ndf-maps"),
        options: vec![(String::from("preset"), String::from("draft"))],
        seed: 7,
        inputs: vec![InputDigest::of("rock.png", b"pixels")],
        normal_convention: String::from("y-up"),
        ..Provenance::default()
    }
}

pub fn provenance_section() -> Section {
    Section::parameters(PROVENANCE, "", &provenance()).optional()
}

/// A pack with every kind of section, one of them compressed.
pub fn full_pack() -> Vec<u8> {
    let mut sections = vec![provenance_section()];
    sections.extend(placed(&noise_texels()));
    sections.extend(layer_sections(&layered()));
    sections.extend(good_dictionary());
    sections.extend(environment_sections(&environment_params(), &environment_indicators(), 0x3c00));
    sections.extend(good_area_light());
    sections.extend(good_glints());
    sections.extend(good_lobes());
    sections.extend(good_synthesis());
    pack(sections)
}

/// A section of four bytes that the checks of contents do not look at.
pub fn plain_section(name: &str) -> Section {
    Section::buffer(FourCc(*b"test"), name, &[1u8, 2, 3, 4]).optional()
}
