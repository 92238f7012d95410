//! The methods that bake a pack: subcommands of glint-bake, and what a material of a project may name as its method.
//!
//! A new method is a folder here and a row in [`ALL`]; projects, plans, glint-info and plots follow from what it answers
//! to [`method::Method`].

mod area_light;
pub mod bake;
pub mod contents;
mod dictionary;
mod environment;
mod glints;
mod lobes;
pub mod method;
pub mod ndf_maps;
pub mod planning;
pub mod plots;

use bake::Bake;
use clap::error::ErrorKind;
use clap::{ArgMatches, Command, FromArgMatches, Subcommand};
use contents::{Contents, Field, ParameterKind};
use glint_formats::{FourCc, Pack};
use method::Method;
use std::sync::Arc;

/// Every method, in the order that help and reports have.
pub static ALL: &[&dyn Method] = &[
    &ndf_maps::NdfMaps,
    &dictionary::Dictionary,
    &glints::Glints,
    &environment::Environment,
    &area_light::AreaLight,
    &lobes::Lobes,
];

/// The method of a name.
pub fn find(name: &str) -> Option<&'static dyn Method> {
    ALL.iter().copied().find(|method| method.name() == name)
}

/// What a pack holds of all methods; without a pack every field is empty.
pub fn describe(pack: Option<&Pack>) -> Contents {
    Contents(ALL.iter().flat_map(|method| method.describe(pack)).collect::<Vec<Field>>())
}

/// How sections of a kind are read as parameters, when they are known.
pub fn parameter_kind(kind: FourCc) -> Option<&'static ParameterKind> {
    ALL.iter().flat_map(|method| method.parameters()).find(|known| known.kind == kind)
}

/// The bake that a subcommand stands for.
#[derive(Clone, Debug)]
pub struct MethodCommand(pub Arc<dyn Bake>);

impl FromArgMatches for MethodCommand {
    fn from_arg_matches(matches: &ArgMatches) -> Result<MethodCommand, clap::Error> {
        let found = matches.subcommand().and_then(|(name, flags)| Some((find(name)?, flags)));
        let (method, flags) = found.ok_or_else(|| clap::Error::new(ErrorKind::MissingSubcommand))?;
        method.parse(flags).map(MethodCommand)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = MethodCommand::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Subcommand for MethodCommand {
    fn augment_subcommands(command: Command) -> Command {
        ALL.iter().fold(command, |command, method| command.subcommand(method.command()))
    }

    fn augment_subcommands_for_update(command: Command) -> Command {
        MethodCommand::augment_subcommands(command)
    }

    fn has_subcommand(name: &str) -> bool {
        find(name).is_some()
    }
}
