//! Runnalls' greedy reduction: merge, again and again, the two Gaussians whose merging costs least.
//!
//! Runnalls 2007, *Kullback-Leibler Approach to Gaussian Mixture Reduction*, Eq. 16: merging i and j raises the divergence
//! from the original mixture by no more than ½ ((w_i + w_j) ln |P_ij| − w_i ln |P_i| − w_j ln |P_j|).

use super::gaussian::{Gaussian4, Symmetric4, determinant, merged};

/// Groups `parts` in at most `groups` of them: the group of each part, numbered from 0. `blur` is added to every
/// covariance (variance of positions, of normals), since differences below it will not be seen.
pub fn reduce(parts: &[Gaussian4], groups: usize, blur: [f64; 2]) -> Vec<usize> {
    let mut state = State::new(parts, blur);
    for _ in groups.max(1)..parts.len() {
        state.merge_cheapest();
    }
    state.labels()
}

/// What is left of the parts. Slot i stands for the group whose first part is i.
struct State {
    /// Gaussians of groups, blur included.
    groups: Vec<Gaussian4>,
    /// ½ w ln |P| of groups.
    entropy: Vec<f64>,
    /// Slots in use, ascending.
    active: Vec<usize>,
    /// Slot that a part, or the group that it headed, went to; itself while in use.
    parent: Vec<usize>,
    /// Cost of merging i with j > i, row by row.
    costs: Vec<f64>,
    /// Cheapest partner j > i and its cost.
    best: Vec<(f64, usize)>,
}

impl State {
    fn new(parts: &[Gaussian4], blur: [f64; 2]) -> State {
        let n = parts.len();
        let groups: Vec<Gaussian4> = parts
            .iter()
            .map(|part| {
                let mut part = *part;
                for (at, extra) in [(0, blur[0]), (4, blur[0]), (7, blur[1]), (9, blur[1])] {
                    part.covariance[at] += extra;
                }
                part
            })
            .collect();
        let entropy = groups.iter().map(|g| half_entropy(g.weight, &g.covariance)).collect();
        let mut state = State {
            groups,
            entropy,
            active: (0..n).collect(),
            parent: (0..n).collect(),
            costs: vec![0.0; n * n],
            best: vec![(f64::INFINITY, 0); n],
        };
        for i in 0..n {
            for j in i + 1..n {
                state.costs[i * n + j] = state.cost(i, j);
            }
            state.find_best(i);
        }
        state
    }

    fn cost(&self, i: usize, j: usize) -> f64 {
        let both = merged(&self.groups[i], &self.groups[j]);
        half_entropy(both.weight, &both.covariance) - self.entropy[i] - self.entropy[j]
    }

    fn find_best(&mut self, i: usize) {
        let row = &self.costs[i * self.groups.len()..];
        let mut best = (f64::INFINITY, i);
        for &j in self.active.iter().rev() {
            if j <= i {
                break;
            }
            if row[j] <= best.0 {
                best = (row[j], j);
            }
        }
        self.best[i] = best;
    }

    fn merge_cheapest(&mut self) {
        let n = self.groups.len();
        let mut i = self.active[0];
        for &slot in &self.active {
            if self.best[slot].0 < self.best[i].0 {
                i = slot;
            }
        }
        let j = self.best[i].1;
        self.groups[i] = merged(&self.groups[i], &self.groups[j]);
        self.entropy[i] = half_entropy(self.groups[i].weight, &self.groups[i].covariance);
        self.parent[j] = i;
        self.active.retain(|&slot| slot != j);
        for at in 0..self.active.len() {
            let other = self.active[at];
            if other != i {
                let (low, high) = (other.min(i), other.max(i));
                self.costs[low * n + high] = self.cost(low, high);
            }
        }
        for at in 0..self.active.len() {
            let other = self.active[at];
            if other == i || self.best[other].1 == i || self.best[other].1 == j {
                self.find_best(other);
            } else if other < i && self.costs[other * n + i] < self.best[other].0 {
                self.best[other] = (self.costs[other * n + i], i);
            }
        }
    }

    fn labels(&self) -> Vec<usize> {
        let mut label = vec![0; self.parent.len()];
        let mut next = 0;
        for part in 0..self.parent.len() {
            // A group's head comes before its members.
            if self.parent[part] == part {
                label[part] = next;
                next += 1;
            } else {
                label[part] = label[self.parent[part]];
            }
        }
        label
    }
}

fn half_entropy(weight: f64, covariance: &Symmetric4) -> f64 {
    0.5 * weight * libm::log(determinant(covariance).max(f64::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat2, DVec2};

    fn at(x: f64, s: f64) -> Gaussian4 {
        let spread = DMat2::IDENTITY / 12.0;
        Gaussian4::of_surface(1.0, DVec2::new(x, 0.0), spread, DVec2::new(s, 0.0), DMat2::ZERO, DMat2::ZERO)
    }

    #[test]
    fn neighbours_of_like_normals_go_together() {
        let parts = [at(0.0, 0.0), at(1.0, 0.5), at(1.0, 0.0), at(0.0, 0.5), at(9.0, 0.5)];
        assert_eq!(reduce(&parts, 3, [1.0, 4e-4]), [0, 1, 0, 1, 2]);
        assert_eq!(reduce(&parts, 2, [1e6, 4e-4]), [0, 1, 0, 1, 1]);
        assert_eq!(reduce(&parts, 9, [1.0, 4e-4]), [0, 1, 2, 3, 4]);
        assert_eq!(reduce(&parts, 1, [1.0, 4e-4]), [0; 5]);
    }

    #[test]
    fn the_cached_costs_find_what_a_full_search_finds() {
        let parts: Vec<Gaussian4> = (0..40u32)
            .map(|k| {
                let h = |m: u32| (k.wrapping_mul(m) % 101) as f64 / 101.0;
                let mut g = at(8.0 * h(37), h(59) - 0.5);
                g.mean[1] = 8.0 * h(71);
                g.mean[3] = 0.3 * h(13);
                g.weight = 0.5 + h(29);
                g
            })
            .collect();
        let blur = [4.0, 1e-3];
        let labels = reduce(&parts, 7, blur);
        let mut groups: Vec<(Gaussian4, Vec<usize>)> = parts.iter().enumerate().map(|(k, g)| (*g, vec![k])).collect();
        while groups.len() > 7 {
            let mut best = (f64::INFINITY, 0, 0);
            for i in 0..groups.len() {
                for j in i + 1..groups.len() {
                    let entropy = |g: &Gaussian4| {
                        let mut c = g.covariance;
                        [(0, 0), (4, 0), (7, 1), (9, 1)].into_iter().for_each(|(at, b)| c[at] += blur[b]);
                        half_entropy(g.weight, &c)
                    };
                    let both = merged(&groups[i].0, &groups[j].0);
                    let cost = entropy(&both) - entropy(&groups[i].0) - entropy(&groups[j].0);
                    if cost < best.0 {
                        best = (cost, i, j);
                    }
                }
            }
            let (other, members) = groups.remove(best.2);
            groups[best.1].0 = merged(&groups[best.1].0, &other);
            groups[best.1].1.extend(members);
        }
        for (_, members) in groups {
            assert!(members.iter().all(|&k| labels[k] == labels[members[0]]), "{members:?} {labels:?}");
        }
    }
}
