//! Reports: speed against error of every method, as one Markdown page each with plots beside it.
//!
//! A report is one function from settings (data folder, scale) to a document, and one that says before any work why it
//! cannot be made here. Timings are of the machine that runs it.

mod area_light;
mod clock;
mod counting;
mod dictionary;
mod document;
mod environment;
mod environment_glints;
mod frames;
mod glints;
mod lobes;
mod ndf_maps;
mod settings;
mod surface;
mod table;
mod textures;

pub use dictionary::HEADLINE;
pub use document::Document;
pub use settings::Settings;

use crate::exit::Failure;

/// One report.
pub struct Report {
    /// Name on the command line and of its files.
    pub name: &'static str,
    /// What it measures.
    pub about: &'static str,
    /// Says why it cannot be made here.
    pub check: fn(&Settings) -> Result<(), Failure>,
    /// Makes it.
    pub measure: fn(&Settings) -> Result<Document, Failure>,
}

/// All reports, in the order in which they are made.
pub const REPORTS: [Report; 11] = [
    Report {
        name: "ndf-maps",
        about: "NDF maps of small examples: bytes, time and error of nodes, footprints and run-time settings",
        check: ndf_maps::check,
        measure: ndf_maps::measure,
    },
    Report {
        name: "dictionary",
        about: "slope dictionaries: error by level and size, time of a query, white furnace",
        check: |_| Ok(()),
        measure: dictionary::measure,
    },
    Report {
        name: "counting",
        about: "binomial draws: error and cost against the paper's and against variants",
        check: |_| Ok(()),
        measure: counting::measure,
    },
    Report {
        name: "glints",
        about: "counted facets: chances against quadrature, hits against placed facets, time by lights",
        check: |_| Ok(()),
        measure: glints::measure,
    },
    Report {
        name: "environment",
        about: "environments: time and error of the filter, second moment by number of levels",
        check: environment::check,
        measure: environment::measure,
    },
    Report {
        name: "environment-glints",
        about: "glints under environments: mean and variance against placed facets",
        check: environment_glints::check,
        measure: environment_glints::measure,
    },
    Report {
        name: "area-light",
        about: "area lights: error of highlights over distance",
        check: area_light::check,
        measure: area_light::measure,
    },
    Report {
        name: "lobes",
        about: "lobes: error by footprint, setting, roughness and size of the map",
        check: lobes::check,
        measure: lobes::measure,
    },
    Report {
        name: "surface",
        about: "surfaces of patches: error across seams and inside patches",
        check: surface::check,
        measure: surface::measure,
    },
    Report {
        name: "textures",
        about: "textures with filtered mips: error of highlights and flicker by mip, against closed forms",
        check: textures::check,
        measure: textures::measure,
    },
    Report {
        name: "frames",
        about: "frame times of the viewer over smooth baselines; needs a GPU adapter and a build with the viewer",
        check: frames::check,
        measure: frames::measure,
    },
];
