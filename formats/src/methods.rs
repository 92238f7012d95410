//! The methods, the kinds of their sections, and the checks of what is in them: the one file of this crate that a new method is
//! written into. Its folder is that of its sections.

use crate::container::KnownKind;
use crate::issue::Issue;
use crate::sections::Sections;

#[path = "area_light/mod.rs"]
pub mod area_light;
#[path = "dictionary/mod.rs"]
pub mod dictionary;
#[path = "environment/mod.rs"]
pub mod environment;
#[path = "glints/mod.rs"]
pub mod glints;
#[path = "lobes/mod.rs"]
pub mod lobes;
#[path = "ndf_maps/mod.rs"]
pub mod ndf_maps;
#[path = "provenance/mod.rs"]
pub mod provenance;
#[path = "synthesis/mod.rs"]
pub mod synthesis;

/// Every kind that this version reads, a list a method.
pub(crate) const KINDS: &[&[KnownKind]] = &[
    crate::provenance::KINDS,
    crate::ndf_maps::KINDS,
    crate::dictionary::KINDS,
    crate::environment::KINDS,
    crate::area_light::KINDS,
    crate::glints::KINDS,
    crate::lobes::KINDS,
    crate::synthesis::KINDS,
];

/// A check of the contents of a method's sections.
pub(crate) type Check = fn(&Sections<'_>, &mut Vec<Issue>);

/// Every check of contents.
pub(crate) const CHECKS: &[Check] = &[
    crate::provenance::check::check,
    crate::ndf_maps::check::check,
    crate::dictionary::check::check,
    crate::environment::check::check,
    crate::area_light::check::check,
    crate::glints::check::check,
    crate::lobes::check::check,
    crate::synthesis::check::check,
];
