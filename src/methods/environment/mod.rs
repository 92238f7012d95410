//! Environments for image-based lighting of glints.

mod args;
mod bake;
mod info;
mod plan;
mod plot;

use super::bake::{Bake, Candidates, FinishedPack};
use super::contents::{Field, ParameterKind};
use super::method::{Method, command, parse};
use super::planning::{Planning, Request};
use super::plots::WritePlot;
use crate::cli::Terminal;
use crate::delivery::Delivery;
use crate::exit::Failure;
use crate::scene::SubjectKind;
use args::Args;
use clap::{ArgMatches, Command};
use glint_formats::Pack;
use glint_formats::environment::{EnvironmentParams, PARAMS};
use std::sync::Arc;

/// The method.
pub struct Environment;

impl Method for Environment {
    fn name(&self) -> &'static str {
        "environment"
    }

    fn command(&self) -> Command {
        command::<Args>(self)
    }

    fn parse(&self, matches: &ArgMatches) -> Result<Arc<dyn Bake>, clap::Error> {
        parse::<Args>(matches)
    }

    fn parameters(&self) -> &'static [ParameterKind] {
        const { &[ParameterKind::of::<EnvironmentParams>(PARAMS)] }
    }

    fn describe(&self, pack: Option<&Pack>) -> Vec<Field> {
        vec![Field::new("environments", pack, info::EnvironmentInfo::all_of)]
    }

    fn plot(&self, pack: &Pack, write: &mut WritePlot<'_>) -> Result<(), Failure> {
        plot::write_all(pack, write)
    }

    fn planning(&self) -> Option<Planning> {
        Some(Planning {
            subject: SubjectKind::Environment,
            product: "environments",
            light: "environment light",
            is_lit: |lights| lights.environment,
            measure: "relative error of radiance",
        })
    }
}

impl Bake for Args {
    fn delivery(&self) -> Delivery<'_> {
        Args::delivery(self)
    }

    fn bake(&self, terminal: Terminal) -> Result<Option<FinishedPack>, Failure> {
        bake::bake(self, terminal)
    }

    fn candidates(&self, request: &Request<'_>) -> Result<Candidates, Failure> {
        plan::candidates(self, request)
    }

    fn measure(&self, pack: &Pack, request: &Request<'_>) -> Result<f64, Failure> {
        plan::measure(self, pack, request)
    }
}
