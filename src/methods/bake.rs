//! A [`Bake`]: a method whose flags are known, and the drafts that it makes for a scene.

use super::planning::{Choice, Request, unplanned};
use crate::cli::{OptionList, Terminal};
use crate::delivery::Delivery;
use crate::exit::Failure;
use glint_formats::Pack;
use std::fmt::Debug;
use std::sync::Arc;

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
