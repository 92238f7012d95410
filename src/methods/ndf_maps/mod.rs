//! NDF maps of small normal maps.

pub mod args;
pub mod bake;
mod histogram;
pub mod info;
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
use glint_formats::ndf_maps::{LAYERS, LayeredMaterial, NdfMapsParams, PARAMS, PLACEMENT, PlacementParams};
use std::sync::Arc;

/// The method.
pub struct NdfMaps;

impl Method for NdfMaps {
    fn name(&self) -> &'static str {
        "ndf-maps"
    }

    fn command(&self) -> Command {
        command::<Args>(self)
    }

    fn parse(&self, matches: &ArgMatches) -> Result<Arc<dyn Bake>, clap::Error> {
        parse::<Args>(matches)
    }

    fn parameters(&self) -> &'static [ParameterKind] {
        const {
            &[
                ParameterKind::of::<NdfMapsParams>(PARAMS),
                ParameterKind::of::<PlacementParams>(PLACEMENT),
                ParameterKind::of::<LayeredMaterial>(LAYERS),
            ]
        }
    }

    fn describe(&self, pack: Option<&Pack>) -> Vec<Field> {
        vec![
            Field::new("materials", pack, info::MaterialInfo::all_of),
            Field::new("layers", pack, info::LayersInfo::all_of),
        ]
    }

    fn plot(&self, pack: &Pack, write: &mut WritePlot<'_>) -> Result<(), Failure> {
        plot::write_all(pack, write)
    }

    fn planning(&self) -> Option<Planning> {
        Some(Planning {
            subject: SubjectKind::Surface,
            product: "glints",
            light: "point or directional light",
            is_lit: |lights| lights.point,
            measure: "E₁",
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
