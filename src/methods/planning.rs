//! What a scene asks of a method, and what a method may choose for it.

use crate::cli::OptionList;
use crate::exit::{Exit, Failure};
use crate::scene::{EnvironmentView, Lights, Scene, Subject, SubjectKind, SurfaceView};
use std::path::Path;

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
    /// Names of the flags that the project fixes; they are not for the plan to choose.
    pub fixed: &'a [String],
}

impl<'a> Request<'a> {
    /// Whether the project fixes a flag.
    pub fn fixes(&self, flag: &str) -> bool {
        self.fixed.iter().any(|fixed| fixed == flag)
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
        Choice { args, options: OptionList::default(), fixed: self.fixed }
    }
}

/// Flags of a draft, with a record of those that were chosen.
pub struct Choice<'a, A> {
    /// The flags.
    pub args: A,
    /// Those that were chosen, as they are typed.
    pub options: OptionList,
    fixed: &'a [String],
}

impl<A> Choice<'_, A> {
    /// Chooses the value of a flag, unless the project fixes it. `text` is the value as it is typed, and `set`
    /// puts it into the flags.
    pub fn choose(&mut self, flag: &str, text: impl ToString, set: impl FnOnce(&mut A)) {
        if !self.fixed.iter().any(|fixed| fixed == flag) {
            set(&mut self.args);
            self.options.push(flag, text);
        }
    }
}

/// The failure of a bake that is asked for a plan that its method does not make.
pub fn unplanned() -> Failure {
    Failure::new(Exit::Unexpected, "a scene does not plan this method; please report this")
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
