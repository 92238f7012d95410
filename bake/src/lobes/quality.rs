//! Error of packed lobes against the f64 reference, footprint by footprint; what footprints see as lists of lobes; and how much of
//! a map lies where renderers may leave it out.

use super::baked::BakedLobes;
use super::eval::{CUT, Frame, Query, SeenLobe, inside_disk, near_rim, query, seen};
use super::query::{Detail, LEAST_SHARE, Lod, QuerySettings};
use super::reference::{GridNdf, Reference};
use crate::footprint::Footprint;
use crate::quality::metrics::{Summary, e1};
use glam::{DVec2, Vec2, Vec3};
use rayon::prelude::*;

/// Bins of the reference between points at which densities are compared: a third of σ_r.
pub const STRIDE: usize = 2;

/// What footprints of one size cost and how far off they are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FootprintErrors {
    /// E₁ over the footprints.
    pub e1: Summary,
    /// |∫D̂ − 1| over the footprints.
    pub energy: Summary,
    /// Lobes a footprint, on average.
    pub lobes: f64,
    /// Most lobes a footprint.
    pub most_lobes: usize,
}

/// What a footprint sees, as a list.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gathered {
    /// Lobes; shares sum to 1.
    pub lobes: Vec<SeenLobe>,
    /// Cells and boxes visited.
    pub cells: u32,
}

impl Gathered {
    /// The lobes of both levels of `lod`; `add` adds those of a level to a list and returns the number of cells and boxes.
    pub(crate) fn of(lod: &Lod, mut add: impl FnMut(&mut Vec<SeenLobe>, Detail) -> u32) -> Gathered {
        let mut gathered = Gathered::default();
        for (detail, weight) in lod.weighted() {
            gathered.add_level(detail, weight, &mut add);
        }
        gathered
    }

    /// Adds what a footprint sees of a level by `add`, shares summing to `weight`.
    pub(crate) fn add_level(
        &mut self,
        detail: Detail,
        weight: f32,
        mut add: impl FnMut(&mut Vec<SeenLobe>, Detail) -> u32,
    ) {
        let first = self.lobes.len();
        self.cells += add(&mut self.lobes, detail);
        let share = |list: &[SeenLobe]| list.iter().map(|seen| seen.share).sum::<f32>();
        if share(&self.lobes[first..]) < LEAST_SHARE {
            self.lobes.truncate(first);
            add(&mut self.lobes, Detail::Whole);
        }
        let scale = weight / share(&self.lobes[first..]);
        self.lobes[first..].iter_mut().for_each(|seen| seen.share *= scale);
    }

    /// Density at `s`, 0 outside the disk.
    pub fn density(&self, s: Vec2) -> f32 {
        if s.length_squared() > 1.0 { 0.0 } else { self.lobes.iter().map(|seen| seen.density(s)).sum() }
    }
}

/// What is measured: the level of detail's choice, or one level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measured {
    /// Levels as the evaluator chooses them.
    Chosen(QuerySettings),
    /// Levels whose cells are 2^λ texels wide ([`BakedLobes::lod_of_edge`]).
    Edge(f32),
    /// One level.
    At(Detail),
}

impl BakedLobes {
    /// The lobes that a footprint sees on the repeated map, shares summing to 1.
    pub fn gather(&self, footprint: &Footprint, roughness: f32, settings: &QuerySettings) -> Gathered {
        let query = query(self.frame_in_map(footprint), roughness);
        let add = |list: &mut _, detail| self.add(list, &query, detail, settings.reach_of(detail));
        Gathered::of(&self.lod(&query.frame, settings), add)
    }

    /// The lobes that a footprint of `reach` standard deviations sees at one level, shares summing to 1.
    pub fn gather_detail(&self, footprint: &Footprint, detail: Detail, roughness: f32, reach: f32) -> Gathered {
        let query = query(self.frame_in_map(footprint), roughness);
        let mut gathered = Gathered::default();
        gathered.add_level(detail, 1.0, |list, detail| self.add(list, &query, detail, reach));
        gathered
    }

    /// Adds the lobes that a footprint sees at one level to a list; returns the number of cells and boxes.
    fn add(&self, list: &mut Vec<SeenLobe>, query: &Query, detail: Detail, reach: f32) -> u32 {
        self.level_sum(query, detail, reach, &mut |seen| list.push(*seen))
    }

    /// The levels whose cells are 2^`lambda` texels wide, or next to that, as the paper chooses them. Below the first stored level the
    /// map is read itself; above the last, the last.
    ///
    /// Tan et al. 2022, section 5.2.1: level λ = C_P log₂ P of a footprint P (Eq. 8), C_P = ½, between its two neighbours by
    /// Eq. 9, whose weights are exchanged here: the finer's is the one that falls with λ. Read as a texture's MIP, P is an area,
    /// λ the binary logarithm of its edge, and the cells of level λ are as wide.
    pub fn lod_of_edge(&self, frame: &Frame, lambda: f32) -> Lod {
        let levels = &self.params.levels;
        let first = levels[0].cell_texels.ilog2() as i32;
        let detail = |log2_edge: f32| match log2_edge as i32 - first {
            below if below < 0 => Detail::Boxes(self.box_edge(frame, &QuerySettings::default())),
            level => Detail::Cells((level as usize).min(levels.len() - 1)),
        };
        Lod { finer: detail(lambda.floor()), coarser: detail(lambda.ceil()), fraction: lambda - lambda.floor() }
    }

    fn measured(&self, footprint: &Footprint, roughness: f64, measured: &Measured) -> Gathered {
        let (roughness, reach) = (roughness as f32, QuerySettings::default().reach);
        match measured {
            Measured::Chosen(settings) => self.gather(footprint, roughness, settings),
            Measured::Edge(lambda) => {
                let query = query(self.frame_in_map(footprint), roughness);
                let add = |list: &mut _, detail| self.add(list, &query, detail, reach);
                Gathered::of(&self.lod_of_edge(&query.frame, *lambda), add)
            }
            Measured::At(detail) => self.gather_detail(footprint, *detail, roughness, reach),
        }
    }
}

/// Error of several bakes of one map over `footprints`, each against the same exact P-NDFs.
pub fn footprint_errors(
    reference: &Reference<'_>,
    bakes: &[(&BakedLobes, Measured)],
    footprints: &[Footprint],
    stride: usize,
) -> Vec<FootprintErrors> {
    let rows: Vec<Vec<(f64, f64, usize)>> = footprints
        .par_iter()
        .map(|footprint| {
            let exact = reference.ndf(footprint, stride);
            let one = |(lobes, measured): &(&BakedLobes, Measured)| {
                let seen = lobes.measured(footprint, reference.roughness(), measured);
                let (e1, energy) = difference(&exact, &seen);
                (e1, energy, seen.lobes.len())
            };
            bakes.iter().map(one).collect()
        })
        .collect();
    (0..bakes.len())
        .map(|k| FootprintErrors {
            e1: Summary::of(rows.iter().map(|row| row[k].0).collect()),
            energy: Summary::of(rows.iter().map(|row| row[k].1).collect()),
            lobes: rows.iter().map(|row| row[k].2 as f64).sum::<f64>() / rows.len().max(1) as f64,
            most_lobes: rows.iter().map(|row| row[k].2).max().unwrap_or(0),
        })
        .collect()
}

/// E₁ and |∫D̂ − 1| of what is seen against the exact P-NDF. Off the grid, on the lattice that it is a part of, the exact
/// one is 0.
pub fn difference(exact: &GridNdf, seen: &Gathered) -> (f64, f64) {
    let grid = &exact.grid;
    let mut values = vec![0.0f64; exact.values.len()];
    let mut off_grid = 0.0;
    // A lobe of so small a share is nothing, and a query may hold as many of them as others.
    let least = 1e-7 * seen.lobes.iter().fold(0.0, |most: f32, lobe| most.max(lobe.share));
    for lobe in seen.lobes.iter().filter(|lobe| lobe.share > least) {
        // Half width and height of the lobe's ellipse at the distance where its density ends.
        let [a, b, c] = lobe.inverse.map(f64::from);
        let det = a * c - b * b;
        let range = |centre: f64, along: f64, origin: f64| {
            let reach = (f64::from(CUT) * along / det).sqrt();
            let at = |s: f64| (s.clamp(-1.0, 1.0) - origin) / grid.spacing;
            at(centre - reach).ceil() as i64..=at(centre + reach).floor() as i64
        };
        let mean = lobe.mean.as_dvec2();
        for j in range(mean.y, a, grid.origin.y) {
            for i in range(mean.x, c, grid.origin.x) {
                let s = grid.origin + DVec2::new(i as f64, j as f64) * grid.spacing;
                if s.length_squared() > 1.0 {
                    continue;
                }
                let value = lobe.density(s.as_vec2()) as f64;
                if (0..grid.width as i64).contains(&i) && (0..grid.height as i64).contains(&j) {
                    values[j as usize * grid.width + i as usize] += value;
                } else {
                    off_grid += value;
                }
            }
        }
    }
    let cell = grid.spacing * grid.spacing;
    let whole = exact.values.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let integral = (values.iter().sum::<f64>() + off_grid) * cell;
    (e1(&values, &exact.values) + off_grid / whole, (integral - 1.0).abs())
}

/// Intrinsic roughnesses that [`BakedLobes::rim_roughness`] tries, ascending.
const ROUGHNESSES: [f32; 7] = [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5];

impl BakedLobes {
    /// Share of the map that lobes of its texels, with `roughness` as the intrinsic one, put beyond the rim of the disk of normals; any
    /// number above `most` where it is more than that. Densities get that mass back ([`inside_disk`]), which takes a sum over strips.
    fn texels_beyond_rim(&self, roughness: f32, most: f32) -> f32 {
        let intrinsic = Vec3::new(roughness * roughness, 0.0, roughness * roughness);
        let of_texel = |s: Vec2| if near_rim(s, intrinsic) { inside_disk(s, intrinsic) } else { 1.0 };
        let parts = self.texels().map(|s| (1.0, of_texel(s)));
        share_beyond(parts, f64::from(self.params.width) * f64::from(self.params.height), most)
    }

    /// No less than [`BakedLobes::texels_beyond_rim`], for an exponential a texel: beyond the rim is outside of the circle around the
    /// normal that touches the rim, and outside of a circle of radius r lies exp(−r² / 2σ²) of an isotropic Gaussian.
    fn texels_outside_circle(&self, roughness: f32) -> f64 {
        let scale = -0.5 / (roughness * roughness);
        let outside = |s: Vec2| f64::from(libm::expf(scale * (1.0 - s.length()).max(0.0).powi(2)));
        self.texels().map(outside).sum::<f64>() / (f64::from(self.params.width) * f64::from(self.params.height))
    }

    /// The largest share that a stored level's lobes put beyond the rim, as [`BakedLobes::texels_beyond_rim`].
    fn levels_beyond_rim(&self, roughness: f32, most: f32) -> f32 {
        let frame = Frame { mean: Vec2::ZERO, axis: Vec2::X, major: f32::INFINITY, minor: f32::INFINITY };
        let alike = query(frame, roughness);
        let mut share = 0.0f32;
        for index in (0..self.params.levels.len()).rev() {
            if share > most {
                break;
            }
            let level = self.level(index);
            let count = level.cells_x * level.cells_y * self.params.lobes_per_cell;
            let lobes = (level.first_lobe..level.first_lobe + count).map(|index| self.lobe(&level, index));
            let parts = lobes.map(|lobe| (lobe.weight, seen(&alike, &lobe, Vec2::ZERO).inside));
            share = share.max(share_beyond(parts, f64::from(count) * f64::from(level.weight_scale), most));
        }
        share
    }

    /// Projected normals of all texels.
    fn texels(&self) -> impl Iterator<Item = Vec2> {
        let (width, height) = (self.params.width as i32, self.params.height as i32);
        (0..height).flat_map(move |j| (0..width).map(move |i| self.texel(i, j)))
    }

    /// The widest of a few intrinsic roughnesses at which at most `share` of the map lies beyond the rim; 0 if it is more at the least
    /// of them.
    pub(crate) fn rim_roughness(&self, share: f32) -> f32 {
        // From the widest on: one that has too much beyond the rim shows it in a few texels, one that has not takes them all.
        let within = |roughness: &f32| {
            let texels = self.texels_outside_circle(*roughness) <= f64::from(share)
                || self.texels_beyond_rim(*roughness, share) <= share;
            texels && self.levels_beyond_rim(*roughness, share) <= share
        };
        ROUGHNESSES.into_iter().rev().find(within).unwrap_or(0.0)
    }
}

/// Share beyond the rim of parts, each a weight and its mass inside; `heaviest` is a weight that all together do not exceed. Any number
/// above `most` as soon as it must be more than that.
fn share_beyond(parts: impl Iterator<Item = (f32, f32)>, heaviest: f64, most: f32) -> f32 {
    let (mut beyond, mut whole) = (0.0, 0.0);
    for (weight, inside) in parts {
        beyond += f64::from(weight * (1.0 - inside).max(0.0));
        whole += f64::from(weight);
        if beyond > f64::from(most) * heaviest {
            return f32::INFINITY;
        }
    }
    if whole > 0.0 { (beyond / whole) as f32 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use crate::lobes::{BakedLobes, LobesOptions, bake};
    use crate::normal_map::NormalMap;
    use crate::progress::Silent;
    use glint_formats::Wrap;

    /// Ramps from the middle to `steepest`, the length of the projected normal.
    fn ramps(steepest: f32) -> BakedLobes {
        let projected = (0..32 * 32).map(|k| [steepest * (k % 32) as f32 / 31.0, 0.0]).collect();
        let map = NormalMap { width: 32, height: 32, wrap: Wrap::Clamp, projected };
        bake(&map, &LobesOptions { footprints: 0, ..LobesOptions::default() }, &Silent).unwrap()
    }

    impl BakedLobes {
        /// The larger of both shares.
        fn beyond_rim(&self, roughness: f32, most: f32) -> f32 {
            self.texels_beyond_rim(roughness, most).max(self.levels_beyond_rim(roughness, most))
        }
    }

    #[test]
    fn the_circle_bounds_what_lies_beyond_the_rim() {
        for (steepest, roughness) in [(0.0, 0.2), (0.5, 0.1), (0.7, 0.5), (0.99, 0.02), (0.99, 0.5)] {
            let baked = ramps(steepest);
            let (bound, share) = (baked.texels_outside_circle(roughness), baked.texels_beyond_rim(roughness, 1.0));
            // The strips leave out what lies 4.5 standard deviations to the far side: 3.4e-6.
            assert!(f64::from(share) <= bound + 5e-6, "{steepest} {roughness}: {share} beyond, {bound} outside");
        }
    }

    #[test]
    fn gentle_maps_stay_inside_and_steep_ones_do_not() {
        assert_eq!(ramps(0.0).beyond_rim(0.02, 1.0), 0.0);
        let (gentle, steep) = (ramps(0.5), ramps(0.99));
        assert!(gentle.beyond_rim(0.05, 1.0) < 1e-5, "{}", gentle.beyond_rim(0.05, 1.0));
        assert!(steep.beyond_rim(0.05, 1.0) > 1e-2, "{}", steep.beyond_rim(0.05, 1.0));
        assert!(gentle.rim_roughness(1e-4) >= 0.05 && steep.rim_roughness(1e-4) == 0.0);
    }

    #[test]
    fn more_lies_beyond_the_rim_of_rougher_facets() {
        let baked = ramps(0.7);
        let shares = [0.01, 0.05, 0.1, 0.2, 0.5].map(|roughness| baked.beyond_rim(roughness, 1.0));
        assert!(shares.windows(2).all(|pair| pair[0] <= pair[1]), "{shares:?}");
        // A Gaussian of σ around the middle has exp(-1 / 2σ²) beyond the rim; farther out it has more.
        assert!(shares[4] > 0.135 && shares[4] < 0.5, "{shares:?}");
    }
}
