//! The methods that bake a pack: subcommands of glint-bake, and what a material of a project may name as its method.
//!
//! A new method is one variant here; projects, their options and ninja edges follow from its flags.

use super::{area_light, dictionary, environment, ndf_maps};
use crate::cli::Terminal;
use crate::exit::Failure;
use clap::Subcommand;

/// A bake with its flags.
#[derive(Subcommand, Clone, Debug)]
#[allow(missing_docs)] // The help of the flags says it.
pub enum Method {
    NdfMaps(Box<ndf_maps::Args>),
    Dictionary(dictionary::Args),
    Environment(environment::Args),
    AreaLight(Box<area_light::Args>),
}

impl Method {
    /// Bakes the pack.
    pub fn run(self, terminal: Terminal) -> Result<(), Failure> {
        match self {
            Method::NdfMaps(args) => ndf_maps::run(*args, terminal),
            Method::Dictionary(args) => dictionary::run(&args, terminal),
            Method::Environment(args) => environment::run(&args, terminal),
            Method::AreaLight(args) => area_light::run(*args, terminal),
        }
    }
}
