//! From many lobes of a cell to k: which go together, and the one lobe that stands for them.

use super::gaussian::{Gaussian4, Moments};
use super::{kmeans, runnalls};
use crate::rng::ItemRng;
use glam::{DMat2, DVec2};
use glint_formats::lobes::Merge;

/// How the lobes of a cell are reduced.
#[derive(Clone, Copy, Debug)]
pub struct MergeSettings {
    /// The reduction.
    pub merge: Merge,
    /// Lobes at most.
    pub lobes: usize,
    /// Deviation of positions (texels) and normals that will not be told apart: see [`runnalls::reduce`].
    pub blur: [f64; 2],
}

/// At most `settings.lobes` lobes that stand for `parts`; parts without weight are left out.
pub fn reduce(parts: &[Gaussian4], settings: &MergeSettings, rng: &mut ItemRng) -> Vec<Gaussian4> {
    let parts: Vec<Gaussian4> = parts.iter().copied().filter(|part| part.weight > 0.0).collect();
    let labels = match settings.merge {
        Merge::KMeans | Merge::Moments => kmeans::reduce(&parts, settings.lobes, rng),
        Merge::Runnalls => runnalls::reduce(&parts, settings.lobes, settings.blur.map(|sigma| sigma * sigma)),
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
    let (mut spread, mut jacobian, mut residual) = (DMat2::ZERO, DMat2::ZERO, DMat2::ZERO);
    for part in group {
        let share = part.weight / weight;
        let slope = part.jacobian();
        position += part.position() * share;
        normal += part.normal() * share;
        spread += part.spread() * share;
        jacobian += slope * share;
        residual += part.residual(slope, part.spread()) * share;
    }
    Some(Gaussian4::of_surface(weight, position, spread, normal, jacobian, residual))
}
