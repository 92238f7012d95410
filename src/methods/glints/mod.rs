//! Counted facets: procedural glints under every light.

mod args;
mod bake;
mod info;
mod plot;

use super::bake::{Bake, FinishedPack};
use super::contents::{Field, ParameterKind};
use super::method::{Method, command, parse};
use super::plots::WritePlot;
use crate::cli::Terminal;
use crate::delivery::Delivery;
use crate::exit::Failure;
use args::Args;
use clap::{ArgMatches, Command};
use glint_formats::Pack;
use glint_formats::glints::{GlintsParams, PARAMS};
use std::sync::Arc;

/// The method.
pub struct Glints;

impl Method for Glints {
    fn name(&self) -> &'static str {
        "glints"
    }

    fn command(&self) -> Command {
        command::<Args>(self)
    }

    fn parse(&self, matches: &ArgMatches) -> Result<Arc<dyn Bake>, clap::Error> {
        parse::<Args>(matches)
    }

    fn parameters(&self) -> &'static [ParameterKind] {
        const { &[ParameterKind::of::<GlintsParams>(PARAMS)] }
    }

    fn describe(&self, pack: Option<&Pack>) -> Vec<Field> {
        vec![Field::new("counted_facets", pack, info::GlintsInfo::all_of)]
    }

    fn plot(&self, pack: &Pack, write: &mut WritePlot<'_>) -> Result<(), Failure> {
        plot::write_all(pack, write)
    }
}

impl Bake for Args {
    fn delivery(&self) -> Delivery<'_> {
        Args::delivery(self)
    }

    fn bake(&self, terminal: Terminal) -> Result<Option<FinishedPack>, Failure> {
        bake::bake(self, terminal)
    }
}
