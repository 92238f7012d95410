//! From many lobes of a cell to k: which go together, by k-means or by Runnalls' greedy reduction, and the one lobe that stands for
//! them.

use super::gaussian::{Gaussian4, Moments, Symmetric4, determinant, merged};
use crate::rng::ItemRng;
use glam::{DMat2, DVec2};
use glint_formats::lobes::Merge;

/// How the lobes of a cell are reduced.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MergeSettings {
    /// The reduction.
    pub merge: Merge,
    /// Lobes at most.
    pub lobes: usize,
    /// Standard deviation of positions (texels) and normals that will not be told apart, for [`Merge::Runnalls`].
    pub blur: [f64; 2],
}

/// At most `settings.lobes` lobes that stand for `parts`; parts without weight are left out.
pub(crate) fn reduce(parts: &[Gaussian4], settings: &MergeSettings, rng: &mut ItemRng) -> Vec<Gaussian4> {
    let parts: Vec<Gaussian4> = parts.iter().copied().filter(|part| part.weight > 0.0).collect();
    let labels = match settings.merge {
        Merge::KMeans | Merge::Moments => kmeans(&parts, settings.lobes, rng),
        Merge::Runnalls => runnalls(&parts, settings.lobes, settings.blur.map(|sigma| sigma * sigma)),
    };
    let groups = labels.iter().max().map_or(0, |last| last + 1);
    let mut members: Vec<Vec<&Gaussian4>> = vec![Vec::new(); groups];
    for (part, label) in parts.iter().zip(labels) {
        members[label].push(part);
    }
    let one = if settings.merge == Merge::KMeans { averaged } else { matched };
    members.into_iter().filter_map(|group| one(&group)).collect()
}

/// The lobe of the same weight, mean and covariance as all together.
fn matched(group: &[&Gaussian4]) -> Option<Gaussian4> {
    let mut moments = Moments::about(group.first()?.mean);
    group.iter().for_each(|part| moments.add(part));
    moments.gaussian()
}

/// The lobe whose parameters are averages: how far the parts lie apart is lost. Tan et al. do not say how the
/// parameters of a cluster follow; this is the plain reading.
fn averaged(group: &[&Gaussian4]) -> Option<Gaussian4> {
    let weight: f64 = group.iter().map(|part| part.weight).sum();
    if weight <= 0.0 {
        return None;
    }
    let (mut position, mut normal) = (DVec2::ZERO, DVec2::ZERO);
    let (mut positions, mut jacobian, mut residual) = (DMat2::ZERO, DMat2::ZERO, DMat2::ZERO);
    for part in group {
        let share = part.weight / weight;
        let slope = part.jacobian();
        position += part.position() * share;
        normal += part.normal() * share;
        positions += part.position_covariance() * share;
        jacobian += slope * share;
        residual += part.residual(slope, part.position_covariance()) * share;
    }
    Some(Gaussian4::of_surface(weight, position, positions, normal, jacobian, residual))
}

/// Rounds of reassignment at most; cells of a few hundred lobes settle in fewer.
const ROUNDS: usize = 24;

/// Groups `parts` in at most `groups` of them by k-means over position and normal, the clustering of Tan et al. 2022, section 5.1.2:
/// the group of each part, numbered from 0. Both position and normal are scaled by their own standard deviation in the cell, so
/// that neither outweighs the other.
fn kmeans(parts: &[Gaussian4], groups: usize, rng: &mut ItemRng) -> Vec<usize> {
    if parts.len() <= groups {
        return (0..parts.len()).collect();
    }
    let points = scaled(parts);
    let mut centres = spread_out(parts, &points, groups, rng);
    let mut labels = vec![usize::MAX; parts.len()];
    for _ in 0..ROUNDS {
        let mut moved = false;
        for (label, point) in labels.iter_mut().zip(&points) {
            let nearest = nearest(point, &centres).1;
            moved |= *label != nearest;
            *label = nearest;
        }
        if !moved {
            break;
        }
        // A cluster that lost all its points keeps its centre.
        for (group, centre) in centres.iter_mut().enumerate() {
            let (mut weight, mut sum) = (0.0, [0.0; 4]);
            for (part, point) in parts.iter().zip(&points).enumerate().filter(|(k, _)| labels[*k] == group).map(|p| p.1)
            {
                weight += part.weight;
                (0..4).for_each(|k| sum[k] += part.weight * point[k]);
            }
            if weight > 0.0 {
                *centre = sum.map(|v| v / weight);
            }
        }
    }
    labels
}

/// Means over the standard deviation of positions and of normals.
fn scaled(parts: &[Gaussian4]) -> Vec<[f64; 4]> {
    let weight: f64 = parts.iter().map(|p| p.weight).sum();
    let mean: [f64; 4] = std::array::from_fn(|k| parts.iter().map(|p| p.weight * p.mean[k]).sum::<f64>() / weight);
    let scale = |axes: [usize; 2]| {
        let variance: f64 =
            parts.iter().map(|p| p.weight * axes.iter().map(|&k| (p.mean[k] - mean[k]).powi(2)).sum::<f64>()).sum();
        if variance > 0.0 { (weight / variance).sqrt() } else { 0.0 }
    };
    let (position, normal) = (scale([0, 1]), scale([2, 3]));
    parts
        .iter()
        .map(|p| std::array::from_fn(|k| (p.mean[k] - mean[k]) * if k < 2 { position } else { normal }))
        .collect()
}

/// First centres, each drawn by its squared distance from those before it (k-means++).
fn spread_out(parts: &[Gaussian4], points: &[[f64; 4]], groups: usize, rng: &mut ItemRng) -> Vec<[f64; 4]> {
    let mut centres = vec![points[rng.below(points.len() as u32) as usize]];
    while centres.len() < groups {
        let shares: Vec<f64> = points.iter().zip(parts).map(|(p, g)| g.weight * nearest(p, &centres).0).collect();
        let mut left = rng.unit() * shares.iter().sum::<f64>();
        let mut chosen = 0;
        for (k, share) in shares.iter().enumerate() {
            if *share > 0.0 {
                chosen = k;
                left -= share;
                if left <= 0.0 {
                    break;
                }
            }
        }
        centres.push(points[chosen]);
    }
    centres
}

/// Squared distance to, and index of, the nearest centre.
fn nearest(point: &[f64; 4], centres: &[[f64; 4]]) -> (f64, usize) {
    let mut best = (f64::INFINITY, 0);
    for (group, centre) in centres.iter().enumerate() {
        let distance: f64 = (0..4).map(|k| (point[k] - centre[k]).powi(2)).sum();
        if distance < best.0 {
            best = (distance, group);
        }
    }
    best
}

/// Groups `parts` in at most `groups` of them by Runnalls' greedy reduction: merge, again and again, the two Gaussians whose merging
/// costs least. Returns the group of each part, numbered from 0. `blur` is added to every covariance (variance of positions in
/// texels², of normals), since differences below it will not be seen.
///
/// Runnalls 2007, *Kullback-Leibler Approach to Gaussian Mixture Reduction*, Eq. 16: merging i and j raises the divergence
/// from the original mixture by no more than ½ ((w_i + w_j) ln |P_ij| − w_i ln |P_i| − w_j ln |P_j|).
fn runnalls(parts: &[Gaussian4], groups: usize, blur: [f64; 2]) -> Vec<usize> {
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

    fn at(x: f64, s: f64) -> Gaussian4 {
        let positions = DMat2::IDENTITY / 12.0;
        Gaussian4::of_surface(1.0, DVec2::new(x, 0.0), positions, DVec2::new(s, 0.0), DMat2::ZERO, DMat2::ZERO)
    }

    #[test]
    fn neighbours_of_like_normals_go_together() {
        let parts = [at(0.0, 0.0), at(1.0, 0.5), at(1.0, 0.0), at(0.0, 0.5), at(9.0, 0.5)];
        assert_eq!(runnalls(&parts, 3, [1.0, 4e-4]), [0, 1, 0, 1, 2]);
        assert_eq!(runnalls(&parts, 2, [1e6, 4e-4]), [0, 1, 0, 1, 1]);
        assert_eq!(runnalls(&parts, 9, [1.0, 4e-4]), [0, 1, 2, 3, 4]);
        assert_eq!(runnalls(&parts, 1, [1.0, 4e-4]), [0; 5]);
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
        let labels = runnalls(&parts, 7, blur);
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
