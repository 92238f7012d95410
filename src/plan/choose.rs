//! The choice between drafts: of every pack the smallest within its error; within the bytes of all, the nearest to that.

use super::{Candidates, Point};

/// Part of an error that a plan uses up: it is measured at some places, and holds for others.
pub const USED: f64 = 0.9;

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
    pub candidates: Candidates,
    /// The one that was chosen.
    pub at: usize,
}

impl Chosen {
    /// The draft.
    pub fn point(&self) -> &Point {
        &self.candidates.points[self.at]
    }

    /// Whether it keeps the error.
    pub fn fits(&self) -> bool {
        self.point().error <= self.candidates.budget
    }

    /// The next draft of less error.
    pub fn tighter(&self) -> Option<&Point> {
        self.candidates.points.get(self.at + 1)
    }
}

impl Plan {
    /// Chooses.
    pub fn new(all: Vec<Candidates>, dropped: Vec<String>, most_bytes: Option<u64>) -> Plan {
        let packs = all.into_iter().map(|candidates| Chosen { at: cheapest(&candidates), candidates }).collect();
        let mut plan = Plan { packs, dropped, most_bytes };
        if let Some(most) = most_bytes.filter(|most| plan.bytes() > *most) {
            plan.shrink(most);
        }
        plan
    }

    /// Bytes of all packs.
    pub fn bytes(&self) -> u64 {
        self.packs.iter().map(|chosen| chosen.point().bytes).sum()
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
                next.is_some_and(|next| bytes - chosen.point().bytes + next.bytes <= most)
            };
            let excess = |k: &usize| self.packs[*k].point().error / self.packs[*k].candidates.budget;
            let worst = (0..self.packs.len()).filter(grows).max_by(|a, b| excess(a).total_cmp(&excess(b)));
            let Some(worst) = worst else { return };
            self.packs[worst].at += 1;
        }
    }
}

/// The smallest draft within the error and a margin, else the one of least error.
fn cheapest(candidates: &Candidates) -> usize {
    let fits = |point: &Point| point.error <= USED * candidates.budget;
    candidates.points.iter().position(fits).unwrap_or(candidates.points.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::project::arguments::Words;

    fn pack(budget: f64, points: &[(u64, f64)]) -> Candidates {
        let point = |&(bytes, error)| Point { options: Vec::new(), bytes, error };
        Candidates {
            name: String::new(),
            method: String::new(),
            from: (0, 0),
            words: Words::default(),
            budget,
            measure: "E₁",
            seen: String::new(),
            dropped: Vec::new(),
            points: points.iter().map(point).collect(),
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
