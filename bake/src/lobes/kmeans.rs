//! k-means over position and normal, the clustering of Tan et al. 2022, section 5.1.2: the baseline.
//!
//! Both position and normal are scaled by their own deviation in the cell, so that neither outweighs the other.

use super::gaussian::Gaussian4;
use crate::rng::ItemRng;

/// Rounds of reassignment at most; cells of a few hundred lobes settle in fewer.
const ROUNDS: usize = 24;

/// Groups `parts` in at most `groups` of them: the group of each part, numbered from 0.
pub fn reduce(parts: &[Gaussian4], groups: usize, rng: &mut ItemRng) -> Vec<usize> {
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

/// Means over the deviation of positions and of normals.
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
