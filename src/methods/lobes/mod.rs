//! MIP-mapped lobes of normal maps, and of surfaces made of patches of one.

mod args;
mod bake;
mod info;
mod plot;
mod surface;

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
use glint_formats::lobes::{self, LobesParams};
use glint_formats::synthesis::{self, SynthesisParams};
use std::sync::Arc;

/// The method.
pub struct Lobes;

impl Method for Lobes {
    fn name(&self) -> &'static str {
        "lobes"
    }

    fn command(&self) -> Command {
        command::<Args>(self)
    }

    fn parse(&self, matches: &ArgMatches) -> Result<Arc<dyn Bake>, clap::Error> {
        parse::<Args>(matches)
    }

    fn picture_flags(&self) -> &'static [&'static str] {
        &["write-normal-map"]
    }

    fn parameters(&self) -> &'static [ParameterKind] {
        const { &[ParameterKind::of::<LobesParams>(lobes::PARAMS), ParameterKind::of::<SynthesisParams>(synthesis::PARAMS)] }
    }

    fn describe(&self, pack: Option<&Pack>) -> Vec<Field> {
        vec![
            Field::new("lobes", pack, info::LobesInfo::all_of),
            Field::new("surfaces", pack, info::SurfaceInfo::all_of),
        ]
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
