//! What the programs ask of a method: a [`Method`] by its name, and a [`Bake`] once its flags are known.
//!
//! Each method answers in a folder beside this file. What most methods leave out has a default here.

use super::contents::{Field, ParameterKind};
use super::planning::{Candidates, Planning, Request};
use super::plots::WritePlot;
use crate::cli::{OptionList, Terminal};
use crate::delivery::Delivery;
use crate::exit::{Exit, Failure};
use crate::pack;
use clap::{ArgMatches, Args, Command, FromArgMatches};
use glint_formats::Pack;
use glint_formats::provenance::Provenance;
use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;

/// A way of baking a pack.
pub trait Method: Sync {
    /// Name of the subcommand, as projects and provenance have it too.
    fn name(&self) -> &'static str;

    /// The subcommand with its flags and its help.
    fn command(&self) -> Command;

    /// The bake that flags stand for.
    ///
    /// # Errors
    /// What clap says of flags that [`Method::command`] did not parse.
    fn parse(&self, matches: &ArgMatches) -> Result<Arc<dyn Bake>, clap::Error>;

    /// Flags that name pictures to look at, which a project does not write.
    fn picture_flags(&self) -> &'static [&'static str] {
        &[]
    }

    /// Kinds of parameter sections, so that their fields are shown and compared by name.
    fn parameters(&self) -> &'static [ParameterKind];

    /// Fields of glint-info's JSON: what the pack holds of this method. Without a pack every field is empty.
    fn describe(&self, pack: Option<&Pack>) -> Vec<Field>;

    /// Pictures of all that the pack holds of this method.
    ///
    /// # Errors
    /// Bad input, when a section cannot be used; those of `write`.
    fn plot(&self, pack: &Pack, write: &mut WritePlot<'_>) -> Result<(), Failure>;

    /// What scenes plan this method for; none by default.
    fn planning(&self) -> Option<Planning> {
        None
    }
}

impl Debug for dyn Method {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A bake whose flags are known.
pub trait Bake: Debug + Send + Sync {
    /// Where the pack goes, what it depends on, and what is written beside it.
    fn delivery(&self) -> Delivery<'_>;

    /// Checks everything, then bakes. `None` when only a dry run was asked for, which has said what would be done.
    ///
    /// # Errors
    /// Usage, before any work; what is wrong with an input; an error that was asked for and missed.
    fn bake(&self, terminal: Terminal) -> Result<Option<FinishedPack>, Failure>;

    /// Drafts for a scene, measured at what the scene sees; only of methods that say what they are planned for.
    ///
    /// # Errors
    /// What stops a draft; limit exceeded, when the inputs are beyond what the method can bake.
    fn candidates(&self, _request: &Request<'_>) -> Result<Candidates, Failure> {
        Err(unplanned())
    }

    /// Error of a finished pack at what a scene sees, at other places than those that drafts are measured at.
    ///
    /// # Errors
    /// What is wrong with an input or with the pack.
    fn measure(&self, _pack: &Pack, _request: &Request<'_>) -> Result<f64, Failure> {
        Err(unplanned())
    }
}

/// A pack that was baked and is not written yet.
pub struct FinishedPack {
    /// The file's bytes.
    pub bytes: Vec<u8>,
    /// What would make it smaller, for a pack beyond its limit: follows "raise --max-memory or".
    pub smaller: &'static str,
}

/// The failure of a bake that is asked for a plan that its method does not make.
pub fn unplanned() -> Failure {
    Failure::new(Exit::Unexpected, "a scene does not plan this method; please report this")
}

/// The subcommand of a method with the flags `A`.
pub fn command<A: Args>(method: &dyn Method) -> Command {
    A::augment_args(Command::new(method.name()))
}

/// Parsed flags as the bake that they are.
///
/// # Errors
/// What clap says of flags that are not those of `A`.
pub fn parse<A: FromArgMatches + Bake + 'static>(matches: &ArgMatches) -> Result<Arc<dyn Bake>, clap::Error> {
    A::from_arg_matches(matches).map(|args| Arc::new(args) as Arc<dyn Bake>)
}

/// Provenance of a bake with the flags `A`: this program, the method, and the options under the names of their flags.
pub fn provenance<A: Args>(method: &str, options: OptionList) -> Provenance {
    let is_flag = |name: &str| {
        let command = A::augment_args(Command::new("flags"));
        command.get_arguments().any(|arg| arg.get_long() == Some(name))
    };
    debug_assert!(options.iter().all(|(name, _)| is_flag(name)), "{options:?} are not all flags");
    Provenance { options: options.into_pairs(), ..pack::provenance(method) }
}
