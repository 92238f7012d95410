//! Drafts for a scene: what a method may choose, what it chose, and how good that is at what the scene sees.

use super::method::{Bake, unplanned};
use crate::cli::OptionList;
use crate::exit::Failure;
use crate::scene::{EnvironmentView, Lights, Scene, Subject, SubjectKind, SurfaceView};
use std::path::Path;
use std::sync::Arc;

/// Part of an error that a plan uses up: it is measured at some places, and holds for others.
pub const USED: f64 = 0.9;

/// What scenes plan a method for.
#[derive(Clone, Copy)]
pub struct Planning {
    /// What it is made from.
    pub subject: SubjectKind,
    /// What it makes, in the plural: `glints`.
    pub product: &'static str,
    /// The light that it is for: `point or directional light`.
    pub light: &'static str,
    /// Whether a scene has such a light.
    pub is_lit: fn(Lights) -> bool,
    /// Name of the error that is measured.
    pub measure: &'static str,
}

/// What is asked of a bake: a pack for one material or environment of a scene.
pub struct Request<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// How the material or environment is seen in it.
    pub subject: &'a Subject,
    /// Error that the pack may have.
    pub budget: f64,
    /// Where the pack will lie.
    pub output: &'a Path,
    /// Names of the flags that the project gives itself; they are not for the plan to choose.
    pub given: &'a [String],
}

impl<'a> Request<'a> {
    /// Whether the project gives a flag itself.
    pub fn gives(&self, flag: &str) -> bool {
        self.given.iter().any(|given| given == flag)
    }

    /// The surface that is seen.
    ///
    /// # Errors
    /// A fault of this program, when it is none.
    pub fn surface(&self) -> Result<&'a SurfaceView, Failure> {
        match self.subject {
            Subject::Surface(view) => Ok(view),
            Subject::Environment(_) => Err(unplanned()),
        }
    }

    /// The environment that is looked up.
    ///
    /// # Errors
    /// A fault of this program, when it is none.
    pub fn environment(&self) -> Result<&'a EnvironmentView, Failure> {
        match self.subject {
            Subject::Environment(view) => Ok(view),
            Subject::Surface(_) => Err(unplanned()),
        }
    }

    /// The project's flags, of which some may be chosen.
    pub fn choice<A>(&self, args: A) -> Choice<'a, A> {
        Choice { args, options: OptionList::default(), given: self.given }
    }
}

/// Flags of a draft, with a record of those that were chosen.
pub struct Choice<'a, A> {
    /// The flags.
    pub args: A,
    /// Those that were chosen, as they are typed.
    pub options: OptionList,
    given: &'a [String],
}

impl<A> Choice<'_, A> {
    /// Chooses the value of a flag, unless the project gives it itself. `text` is the value as it is typed, and `set`
    /// puts it into the flags.
    pub fn choose(&mut self, flag: &str, text: impl ToString, set: impl FnOnce(&mut A)) {
        if !self.given.iter().any(|given| given == flag) {
            set(&mut self.args);
            self.options.push(flag, text);
        }
    }
}

/// A draft that was made and measured.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The bake that makes it.
    pub bake: Arc<dyn Bake>,
    /// Flags that were chosen, as they are typed; one that takes no value has an empty one.
    pub options: OptionList,
    /// Bytes of the pack.
    pub bytes: u64,
    /// Error at what the scene sees.
    pub error: f64,
}

/// All drafts of one pack.
#[derive(Clone, Debug)]
pub struct Candidates {
    /// How it is seen, in words.
    pub view: String,
    /// What no look-up of the scene reads, and so is left out.
    pub dropped: Vec<String>,
    /// The drafts.
    pub drafts: Vec<Candidate>,
}

impl Candidates {
    /// None yet.
    pub fn new(view: String) -> Candidates {
        Candidates { view, dropped: Vec::new(), drafts: Vec::new() }
    }

    /// Whether there is a draft with these choices.
    pub fn has(&self, options: &OptionList) -> bool {
        self.drafts.iter().any(|draft| draft.options == *options)
    }

    /// Adds a draft.
    pub fn push<A: Bake + 'static>(&mut self, choice: Choice<'_, A>, bytes: u64, error: f64) {
        let Choice { args, options, .. } = choice;
        self.drafts.push(Candidate { bake: Arc::new(args), options, bytes, error });
    }
}

/// `count` sizes from one end of a range to the other, evenly by their logarithm; one for a range that is a point.
pub fn sizes((low, high): (f64, f64), most: usize) -> Vec<f64> {
    let octaves = libm::log2(high / low);
    let steps = (octaves.ceil() as usize).clamp(if octaves > 0.1 { 1 } else { 0 }, most - 1);
    (0..=steps).map(|k| low * libm::exp2(octaves * k as f64 / steps.max(1) as f64)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_reach_from_end_to_end() {
        assert_eq!(sizes((2.0, 2.0), 4), [2.0]);
        let all = sizes((0.5, 32.0), 4);
        assert_eq!((all.len(), all[0]), (4, 0.5));
        assert!((all[3] - 32.0).abs() < 1e-9);
        assert_eq!(sizes((1.0, 2.0), 4).len(), 2);
    }
}
