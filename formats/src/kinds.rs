//! The section kinds this version knows, and the checks of their contents. A new method adds its rows here.

use crate::container::{FourCc, SectionEntry};
use crate::issue::{Issue, IssueCode};
use crate::sections::Sections;
use crate::{
    area_light, area_light_check, dictionary, dictionary_check, environment, environment_check, lobes, lobes_check,
    ndf_maps, ndf_maps_check, placement_check, provenance, surface_check, synthesis, synthesis_check,
};

/// A section kind this version reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnownKind {
    /// The kind.
    pub kind: FourCc,
    /// The version of its layout that is read.
    pub version: u16,
    /// What it holds, in a few words.
    pub title: &'static str,
}

/// Every kind this version reads.
pub const KNOWN: &[KnownKind] = &[
    KnownKind { kind: provenance::PROVENANCE, version: 1, title: "provenance" },
    KnownKind { kind: ndf_maps::PARAMS, version: 1, title: "NDF map parameters" },
    KnownKind { kind: ndf_maps::TILES, version: 1, title: "NDF map tiles" },
    KnownKind { kind: ndf_maps::DENSITY, version: 1, title: "NDF map density" },
    KnownKind { kind: ndf_maps::NORMALS, version: 1, title: "example normals" },
    KnownKind { kind: ndf_maps::PLACEMENT, version: 1, title: "placement parameters" },
    KnownKind { kind: ndf_maps::PALETTE, version: 1, title: "placement palette" },
    KnownKind { kind: ndf_maps::NOISE, version: 1, title: "placement noise map" },
    KnownKind { kind: ndf_maps::CLASSES, version: 1, title: "placement class map" },
    KnownKind { kind: ndf_maps::LAYERS, version: 1, title: "layered material" },
    KnownKind { kind: dictionary::PARAMS, version: 1, title: "dictionary parameters" },
    KnownKind { kind: dictionary::TABLE, version: 1, title: "dictionary table" },
    KnownKind { kind: environment::PARAMS, version: 1, title: "environment parameters" },
    KnownKind { kind: environment::RADIANCE, version: 1, title: "environment radiance" },
    KnownKind { kind: environment::INDICATORS, version: 1, title: "environment indicators" },
    KnownKind { kind: environment::COLOURS, version: 1, title: "environment colours" },
    KnownKind { kind: environment::ALBEDO, version: 1, title: "environment albedo" },
    KnownKind { kind: area_light::PARAMS, version: 1, title: "area light parameters" },
    KnownKind { kind: area_light::NORMALS, version: 1, title: "area light normals" },
    KnownKind { kind: area_light::ROUGHNESS, version: 1, title: "area light roughness" },
    KnownKind { kind: area_light::INVERSE, version: 1, title: "LTC inverse matrices" },
    KnownKind { kind: area_light::TERMS, version: 1, title: "LTC terms" },
    KnownKind { kind: lobes::PARAMS, version: 1, title: "lobe parameters" },
    KnownKind { kind: lobes::LOBES, version: 1, title: "lobes" },
    KnownKind { kind: lobes::NORMALS, version: 1, title: "lobe normals" },
    KnownKind { kind: synthesis::PARAMS, version: 1, title: "synthesis parameters" },
    KnownKind { kind: synthesis::OFFSETS, version: 1, title: "synthesis patch offsets" },
    KnownKind { kind: synthesis::SEAMS, version: 1, title: "synthesis seam paths" },
];

/// A check of the contents of some kinds.
pub(crate) type Check = fn(&Sections<'_>, &mut Vec<Issue>);

/// Every check of contents.
pub(crate) const CHECKS: &[Check] = &[
    provenance::check,
    ndf_maps_check::check,
    placement_check::check,
    dictionary_check::check,
    environment_check::check,
    area_light_check::check,
    lobes_check::check,
    synthesis_check::check,
    surface_check::check,
];

/// What this version knows of a kind.
pub fn known(kind: FourCc) -> Option<&'static KnownKind> {
    KNOWN.iter().find(|known| known.kind == kind)
}

/// Says whether an entry is of a kind and version this program reads: an error when it is required, a warning when
/// it can be skipped.
pub(crate) fn check(entry: &SectionEntry) -> Option<Issue> {
    let (code, message) = match known(entry.kind) {
        None if entry.required => {
            (IssueCode::UnknownRequired, String::from("the pack cannot be used without it; use a newer reader"))
        }
        None => (IssueCode::UnknownOptional, String::from("it is skipped; a newer reader may use it")),
        Some(known) if known.version != entry.version => {
            let message = format!("this program reads version {}, found {}", known.version, entry.version);
            (IssueCode::UnsupportedSectionVersion, format!("{message}; use a newer reader"))
        }
        Some(_) => return None,
    };
    let issue = if entry.required { Issue::error(code, message) } else { Issue::warning(code, message) };
    Some(issue.at(entry.offset).of(entry.label()))
}
