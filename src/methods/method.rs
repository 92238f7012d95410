//! What the programs ask of a [`Method`]. Each answers in a folder beside this file; what most leave out has a default here.

use super::bake::Bake;
use super::contents::{Field, ParameterKind};
use super::planning::Planning;
use super::plots::WritePlot;
use crate::cli::OptionList;
use crate::exit::Failure;
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
