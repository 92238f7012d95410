//! The NDF of a footprint on a surface covered with examples, by its definition: the normal map that the placement
//! describes, point by point, under the Gaussian footprint.
//!
//! Owners are found anew from the centres (nearest centre to each sub-region's, among the cells around), and local
//! positions from the transforms. A sub-texel lattice holds the example's normals, as an explicit map of higher
//! resolution would; footprints under two texels are integrated without it.

use super::baked::Material;
use super::reference::{DiskMass, MicroNormal, ReferenceNdf};
use crate::footprint::Footprint;
use crate::normal_map::NormalMap;
use glam::{DMat2, DVec2};
use glint_formats::Wrap;
use glint_formats::ndf_maps::PlacementKind;

/// Width in which neighbouring sub-regions fade into each other, in edges of one.
const FADE: f64 = 1.0;
/// Footprints reach this far, in standard deviations (4e-5 of their mass is farther out).
const REACH: f64 = 4.5;

/// A surface: the example as it was before the bake, repeating, and the placement of a material.
pub struct SurfaceReference<'a> {
    map: NormalMap,
    material: &'a Material,
    roughness: f64,
    mass: DiskMass,
    /// Largest length of ∂s/∂u on the example, per texel.
    steepest: f64,
    /// What every sub-region of the repeating surface shows, row by row; empty when tiled.
    owners: Vec<Owner>,
}

/// Whose example a sub-region shows.
struct Owner {
    class: usize,
    /// The owner's centre on the surface, from the sub-region's middle.
    centre: DVec2,
    /// Example point that lies at the centre.
    offset: DVec2,
}

/// What shows at a point of the surface: palette entry, position in the example in texels within its bounds, and its part.
pub type Shown = (usize, DVec2, f64);

impl<'a> SurfaceReference<'a> {
    /// Reference for `material`, baked from `map`.
    pub fn new(map: &'a NormalMap, material: &'a Material) -> SurfaceReference<'a> {
        let roughness = material.maps.params.intrinsic_roughness as f64;
        let mut steepest = 0.0f64;
        for j in 0..map.height as i64 {
            for i in 0..map.width as i64 {
                let s = map.texel(i, j);
                steepest = steepest.max(s.distance(map.texel(i + 1, j))).max(s.distance(map.texel(i, j + 1)));
            }
        }
        let owners = find_owners(map, material);
        let map = NormalMap { wrap: Wrap::Repeat, ..map.clone() };
        SurfaceReference { map, material, roughness, mass: DiskMass::new(roughness), steepest, owners }
    }

    /// The material.
    pub fn material(&self) -> &'a Material {
        self.material
    }

    /// What shows at the surface point `u`: one example where they are tiled; those of the four sub-regions around, whose weights fall
    /// by smoothstep across the borders between them.
    pub fn shown_at(&self, u: DVec2) -> Vec<Shown> {
        let size = example_size(&self.map);
        let within = |x: DVec2| x - (x / size).floor() * size;
        let PlacementKind::Stochastic { cells_x, cells_y, cell_texels, .. } = self.material.placement.params.kind
        else {
            return vec![(0, within(self.to_local(0) * u), 1.0)];
        };
        let edge = 0.5 * cell_texels as f64;
        let first = (u / edge - 0.5).floor();
        let of_region = |(dx, dy): (f64, f64)| {
            let region = first + DVec2::new(dx, dy);
            let x = (region.x as i64).rem_euclid(2 * cells_x as i64);
            let y = (region.y as i64).rem_euclid(2 * cells_y as i64);
            let owner = &self.owners[(y * 2 * cells_x as i64 + x) as usize];
            let away = u - (region + 0.5) * edge;
            let part = ((0.5 - away.abs() / edge) / FADE + 0.5).clamp(DVec2::ZERO, DVec2::ONE);
            let part = part * part * (3.0 - 2.0 * part);
            let from_centre = away - owner.centre;
            (owner.class, within(self.to_local(owner.class) * from_centre + owner.offset), part.x * part.y)
        };
        [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(of_region).to_vec()
    }

    /// The NDF of a footprint.
    pub fn ndf(&self, footprint: &Footprint) -> ReferenceNdf {
        let (minor, major, axis) = footprint.principal();
        let covariances: Vec<DMat2> = (0..self.material.placement.palette.len())
            .map(|class| {
                let m = self.to_surface_normal(class);
                m * m.transpose() * (self.roughness * self.roughness)
            })
            .collect();
        let micro_normals = if minor < 2.0 {
            let fine = self.roughness / self.steepest.max(1e-9);
            let pitch = |sigma: f64| (sigma / 4.0).min(fine).max(sigma / 400.0).max(1e-12);
            let mut list = Vec::new();
            self.for_each_point(footprint, axis, [major, minor], [pitch(major), pitch(minor)], |u, weight| {
                for (class, local, part) in self.shown_at(u) {
                    list.push(self.micro_normal(class, self.map.bilinear(local).0, weight * part));
                }
            });
            list
        } else {
            self.binned(footprint, axis, [major, minor])
        };
        ReferenceNdf::new(&covariances, micro_normals)
    }

    /// Micro-normals of a larger footprint: shares of the cells of a sub-texel lattice under each palette entry.
    fn binned(&self, footprint: &Footprint, axis: DVec2, sigmas: [f64; 2]) -> Vec<MicroNormal> {
        let per_texel = (2.0 * self.steepest / self.roughness).ceil().clamp(4.0, 16.0);
        let (w, h) = (self.map.width as usize * per_texel as usize, self.map.height as usize * per_texel as usize);
        let mut shares = vec![0.0; w * h * self.material.placement.palette.len()];
        let pitch = sigmas.map(|sigma| (1.0 / per_texel).max(sigma / 400.0));
        self.for_each_point(footprint, axis, sigmas, pitch, |u, weight| {
            for (class, local, part) in self.shown_at(u) {
                let (i, j) = ((local.x * per_texel) as usize, (local.y * per_texel) as usize);
                shares[(class * h + j.min(h - 1)) * w + i.min(w - 1)] += weight * part;
            }
        });
        let mut list = Vec::new();
        for (at, share) in shares.into_iter().enumerate() {
            if share > 0.0 {
                let local = DVec2::new((at % w) as f64 + 0.5, (at / w % h) as f64 + 0.5) / per_texel;
                list.push(self.micro_normal(at / (w * h), self.map.bilinear(local).0, share));
            }
        }
        list
    }

    /// Calls `visit(u, share)` for points of a lattice along the footprint's axes; shares sum to 1.
    fn for_each_point(
        &self,
        footprint: &Footprint,
        axis: DVec2,
        sigmas: [f64; 2],
        pitch: [f64; 2],
        mut visit: impl FnMut(DVec2, f64),
    ) {
        let line = |sigma: f64, pitch: f64| {
            let half = (REACH * sigma / pitch).ceil() as i64;
            let points: Vec<(f64, f64)> = (-half..=half)
                .map(|k| {
                    let x = k as f64 * pitch;
                    (x, if sigma > 0.0 { libm::exp(-0.5 * (x / sigma).powi(2)) } else { 1.0 })
                })
                .collect();
            let total: f64 = points.iter().map(|p| p.1).sum();
            points.into_iter().map(move |(x, w)| (x, w / total))
        };
        let across: Vec<(f64, f64)> = line(sigmas[1], pitch[1]).collect();
        for (x, wx) in line(sigmas[0], pitch[0]) {
            for (y, wy) in &across {
                visit(footprint.mean + axis * x + axis.perp() * *y, wx * wy);
            }
        }
    }

    fn micro_normal(&self, class: usize, local: DVec2, share: f64) -> MicroNormal {
        MicroNormal {
            mean: self.to_surface_normal(class) * local,
            weight: share / self.mass.inside(local.length()),
            kernel: class,
        }
    }

    fn to_local(&self, class: usize) -> DMat2 {
        rows(self.material.placement.palette[class].position_to_local)
    }

    fn to_surface_normal(&self, class: usize) -> DMat2 {
        rows(self.material.placement.palette[class].normal_to_local).inverse()
    }
}

/// The owner of every sub-region: the nearest centre, among the cells around, to the sub-region's middle.
fn find_owners(map: &NormalMap, material: &Material) -> Vec<Owner> {
    let PlacementKind::Stochastic { cells_x, cells_y, cell_texels, .. } = material.placement.params.kind else {
        return Vec::new();
    };
    let edge = cell_texels as f64;
    // Cells of which any sub-region shows the example; no other is nearest to one.
    let noise = &material.placement.noise;
    let mut cells = vec![None; (cells_x * cells_y) as usize];
    for (k, texel) in noise.iter().enumerate() {
        let (x, y) = (k as i64 % i64::from(2 * cells_x) / 2, k as i64 / i64::from(2 * cells_x) / 2);
        let [dx, dy] = texel.neighbour().map(i64::from);
        let (x, y) = ((x + dx).rem_euclid(cells_x as i64), (y + dy).rem_euclid(cells_y as i64));
        cells[(y * cells_x as i64 + x) as usize] = Some(*texel);
    }
    let mut owners = Vec::new();
    for j in 0..2 * cells_y {
        for i in 0..2 * cells_x {
            let middle = (DVec2::new(i as f64, j as f64) + 0.5) * (0.5 * edge);
            let home = (middle / edge).floor();
            let mut best = (f64::INFINITY, noise[0], DVec2::ZERO);
            for dy in -2..=2 {
                for dx in -2..=2 {
                    let cell = home + DVec2::new(dx as f64, dy as f64);
                    let x = (cell.x as i64).rem_euclid(cells_x as i64);
                    let y = (cell.y as i64).rem_euclid(cells_y as i64);
                    let Some(texel) = cells[(y * cells_x as i64 + x) as usize] else { continue };
                    let centre = (cell + unorm_pair(texel.centre)) * edge;
                    let distance = centre.distance(middle);
                    if distance < best.0 {
                        best = (distance, texel, centre);
                    }
                }
            }
            let owner = best.1;
            owners.push(Owner {
                class: owner.class() as usize,
                centre: best.2 - middle,
                offset: unorm_pair(owner.offset) * example_size(map),
            });
        }
    }
    owners
}

fn example_size(map: &NormalMap) -> DVec2 {
    DVec2::new(map.width as f64, map.height as f64)
}

fn rows(m: [f32; 4]) -> DMat2 {
    let [a, b, c, d] = m.map(f64::from);
    DMat2::from_cols(DVec2::new(a, c), DVec2::new(b, d))
}

fn unorm_pair(packed: u32) -> DVec2 {
    DVec2::new((packed & 0xffff) as f64, (packed >> 16) as f64) / 65535.0
}
