//! The choice between drafts: of every pack the smallest within its error; within the bytes of all, the nearest to that.

use crate::methods::bake::Candidate;
use crate::methods::planning::USED;

/// A pack to plan, with what was measured of its drafts.
#[derive(Clone, Debug)]
pub struct PackDrafts {
    /// Name of the pack.
    pub name: String,
    /// Method.
    pub method: &'static str,
    /// Number of the table among those that are planned, and of the alternative among the table's.
    pub from: (usize, usize),
    /// Error that it may have.
    pub budget: f64,
    /// Name of that error.
    pub measure: &'static str,
    /// How it is seen.
    pub view: String,
    /// What no look-up of the scene reads, and so is left out.
    pub dropped: Vec<String>,
    /// Drafts that no other one beats in bytes and error, the smallest first. Never empty.
    pub drafts: Vec<Candidate>,
}

/// What is baked for a scene.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Packs with the draft that was chosen of each.
    pub packs: Vec<Chosen>,
    /// What is not baked, and why.
    pub dropped: Vec<String>,
    /// Bytes that all may have together.
    pub most_bytes: Option<u64>,
}

/// A pack and its draft.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// The pack with all drafts.
    pub pack: PackDrafts,
    /// The one that was chosen.
    pub at: usize,
}

impl Chosen {
    /// The draft.
    pub fn draft(&self) -> &Candidate {
        &self.pack.drafts[self.at]
    }

    /// Whether it keeps the error.
    pub fn fits(&self) -> bool {
        self.draft().error <= self.pack.budget
    }

    /// The next draft of less error.
    pub fn tighter(&self) -> Option<&Candidate> {
        self.pack.drafts.get(self.at + 1)
    }
}

impl Plan {
    /// Chooses.
    pub fn new(all: Vec<PackDrafts>, dropped: Vec<String>, most_bytes: Option<u64>) -> Plan {
        let packs = all.into_iter().map(|pack| Chosen { at: cheapest(&pack), pack }).collect();
        let mut plan = Plan { packs, dropped, most_bytes };
        if let Some(most) = most_bytes.filter(|most| plan.bytes() > *most) {
            plan.shrink(most);
        }
        plan
    }

    /// Bytes of all packs.
    pub fn bytes(&self) -> u64 {
        self.packs.iter().map(|chosen| chosen.draft().bytes).sum()
    }

    /// Whether every budget is kept.
    pub fn fits(&self) -> bool {
        self.packs.iter().all(Chosen::fits) && self.most_bytes.is_none_or(|most| self.bytes() <= most)
    }

    /// Starts from the smallest drafts, and lets the pack that is farthest beyond its error grow while all fit.
    fn shrink(&mut self, most: u64) {
        let goal: Vec<usize> = self.packs.iter().map(|chosen| chosen.at).collect();
        self.packs.iter_mut().for_each(|chosen| chosen.at = 0);
        loop {
            let bytes = self.bytes();
            let grows = |k: &usize| {
                let chosen = &self.packs[*k];
                let next = chosen.tighter().filter(|_| chosen.at < goal[*k]);
                next.is_some_and(|next| bytes - chosen.draft().bytes + next.bytes <= most)
            };
            let excess = |k: &usize| self.packs[*k].draft().error / self.packs[*k].pack.budget;
            let worst = (0..self.packs.len()).filter(grows).max_by(|a, b| excess(a).total_cmp(&excess(b)));
            let Some(worst) = worst else { return };
            self.packs[worst].at += 1;
        }
    }
}

/// The smallest draft within the error and a margin, else the one of least error.
fn cheapest(pack: &PackDrafts) -> usize {
    let fits = |draft: &Candidate| draft.error <= USED * pack.budget;
    pack.drafts.iter().position(fits).unwrap_or(pack.drafts.len() - 1)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::cli::{OptionList, RunFlags, Terminal};
    use crate::delivery::Delivery;
    use crate::exit::Failure;
    use crate::methods::bake::{Bake, FinishedPack};
    use clap::Parser;
    use std::path::Path;
    use std::sync::Arc;

    /// A bake that makes nothing.
    #[derive(Parser, Debug)]
    struct Idle {
        #[command(flatten)]
        run: RunFlags,
    }

    impl Bake for Idle {
        fn delivery(&self) -> Delivery<'_> {
            Delivery { output: Path::new("idle"), inputs: &[], run: &self.run }
        }

        fn bake(&self, _terminal: Terminal) -> Result<Option<FinishedPack>, Failure> {
            Ok(None)
        }
    }

    /// A draft of this size and error.
    pub fn candidate((bytes, error): (u64, f64)) -> Candidate {
        let bake = Arc::new(Idle::parse_from(["idle"]));
        Candidate { bake, options: OptionList::default(), bytes, error }
    }

    fn pack(budget: f64, drafts: &[(u64, f64)]) -> PackDrafts {
        PackDrafts {
            name: String::new(),
            method: "",
            from: (0, 0),
            budget,
            measure: "E₁",
            view: String::new(),
            dropped: Vec::new(),
            drafts: drafts.iter().copied().map(candidate).collect(),
        }
    }

    #[test]
    fn the_smallest_within_its_error() {
        let plan = Plan::new(vec![pack(0.1, &[(10, 0.2), (20, 0.08), (30, 0.01)])], Vec::new(), None);
        assert_eq!((plan.bytes(), plan.fits()), (20, true));
        let plan = Plan::new(vec![pack(0.001, &[(10, 0.2), (20, 0.08), (30, 0.01)])], Vec::new(), None);
        assert_eq!((plan.bytes(), plan.fits()), (30, false));
    }

    #[test]
    fn bytes_win_over_errors_and_go_to_the_worst() {
        let packs = || vec![pack(0.1, &[(10, 0.5), (20, 0.05)]), pack(0.1, &[(10, 0.2), (25, 0.05)])];
        let plan = Plan::new(packs(), Vec::new(), Some(45));
        assert_eq!((plan.bytes(), plan.fits()), (45, true));
        let plan = Plan::new(packs(), Vec::new(), Some(40));
        assert_eq!((plan.packs[0].at, plan.packs[1].at, plan.fits()), (1, 0, false));
        let plan = Plan::new(packs(), Vec::new(), Some(5));
        assert_eq!((plan.bytes(), plan.fits()), (20, false));
    }
}
