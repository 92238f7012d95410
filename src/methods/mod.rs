//! The methods that bake a pack: subcommands of glint-bake, and what a material of a project may name as its method.
//!
//! A new method is one variant here; projects, their options and ninja edges follow from its flags.

pub mod area_light;
pub mod dictionary;
pub mod environment;
pub mod lobes;
pub mod ndf_maps;

use crate::cli::Terminal;
use crate::exit::Failure;
use clap::Subcommand;
use glint_bake_core::area_light::AreaLightMaterial;
use glint_bake_core::environment::{Environment, EnvironmentImage};
use glint_bake_core::ndf_maps::eval::Material;
use glint_bake_core::normal_map::NormalMap;

/// A bake with its flags.
#[derive(Subcommand, Clone, Debug)]
#[allow(missing_docs)] // The help of the flags says it.
pub enum Method {
    NdfMaps(Box<ndf_maps::Args>),
    Lobes(Box<lobes::Args>),
    Dictionary(dictionary::Args),
    Environment(environment::Args),
    AreaLight(Box<area_light::Args>),
}

impl Method {
    /// Bakes the pack.
    pub fn run(self, terminal: Terminal) -> Result<(), Failure> {
        match self {
            Method::NdfMaps(args) => ndf_maps::bake::run(*args, terminal),
            Method::Lobes(args) => lobes::bake::run(*args, terminal),
            Method::Dictionary(args) => dictionary::bake::run(&args, terminal),
            Method::Environment(args) => environment::bake::run(&args, terminal),
            Method::AreaLight(args) => area_light::bake::run(*args, terminal),
        }
    }
}

/// What a bake would put into its pack, and what it was made from.
pub enum Draft {
    /// Materials of NDF maps.
    NdfMaps(Vec<(NormalMap, Material)>),
    /// A material for rectangle lights.
    AreaLight(Box<(NormalMap, AreaLightMaterial)>),
    /// An environment.
    Environment(Box<(EnvironmentImage, Environment)>),
    /// Of a method that scenes do not plan.
    Unplanned,
}

impl Method {
    /// Bakes without writing: the draft and the bytes of its pack.
    pub fn draft(self) -> Result<(Draft, u64), Failure> {
        match self {
            Method::NdfMaps(args) => ndf_maps::bake::draft(*args).map(|(made, bytes)| (Draft::NdfMaps(made), bytes)),
            Method::AreaLight(args) => {
                area_light::bake::draft(&args).map(|(made, bytes)| (Draft::AreaLight(Box::new(made)), bytes))
            }
            Method::Environment(args) => {
                environment::bake::draft(&args).map(|(made, bytes)| (Draft::Environment(Box::new(made)), bytes))
            }
            Method::Lobes(_) | Method::Dictionary(_) => Ok((Draft::Unplanned, 0)),
        }
    }
}
