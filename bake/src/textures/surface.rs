//! The bilinear surface under a texel of a level, as facets that each stand for a part of it.
//!
//! Under fine levels these are cells of the patches between texels' centres. Normals within a cell vary evenly along both of its axes,
//! with a variance of a twelfth of the squared change; the facet is broadened by that. Under coarse levels these are points, one in
//! each of n² boxes, moved about so that no period of the map is met again and again.

use super::fit::{Facet, Lobe};
use super::options::{LEAST_ALPHA, Roughness};
use crate::normal_map::NormalMap;
use glint_formats::Wrap;

/// The bilinear surface.
#[derive(Clone, Copy)]
pub(super) struct Surface<'a> {
    pub map: &'a NormalMap,
    pub roughness: &'a Roughness,
}

/// A place along an axis.
#[derive(Clone, Copy)]
struct Place {
    /// The texel before it and the one after.
    texels: [u32; 2],
    /// How far it is from the one to the other.
    along: f32,
    /// Length of the cell that it stands for, in texels of the map; 0 for a point.
    width: f32,
}

impl Place {
    /// At `u` texels from the edge of the map.
    fn at(u: f64, width: f64, size: u32, wrap: Wrap) -> Place {
        let before = (u - 0.5).floor();
        let size = i64::from(size);
        let texel = |i: i64| match wrap {
            Wrap::Repeat => i.rem_euclid(size) as u32,
            Wrap::Clamp => i.clamp(0, size - 1) as u32,
        };
        let texels = [texel(before as i64), texel(before as i64 + 1)];
        Place { texels, along: (u - 0.5 - before) as f32, width: width as f32 }
    }
}

/// Where facets lie under the texels of a level.
pub(super) struct Layout(Kind);

enum Kind {
    /// Cells of each column and of each row.
    Cells([Vec<Vec<Place>>; 2]),
    /// Points in each texel, in texels of the level from its upper left corner.
    Points(Vec<[f32; 2]>),
}

impl Layout {
    /// Cells under the texels of a level of this size, each patch in `split`² of them.
    pub fn cells(map: &NormalMap, level: (u32, u32), split: u32) -> Layout {
        let parts = f64::from(split);
        let along = |fine: u32, coarse: u32| {
            let ratio = f64::from(fine) / f64::from(coarse);
            let of_texel = |i: u32| {
                let (mut from, end) = (f64::from(i) * ratio, f64::from(i + 1) * ratio);
                let mut places = Vec::new();
                while from < end - 1e-6 {
                    // Patches end at the centres of texels.
                    let part = ((from - 0.5) * parts + 1e-6).floor() + 1.0;
                    let to = (part / parts + 0.5).min(end);
                    places.push(Place::at(0.5 * (from + to), to - from, fine, map.wrap));
                    from = to;
                }
                places
            };
            (0..coarse).map(of_texel).collect()
        };
        Layout(Kind::Cells([along(map.width, level.0), along(map.height, level.1)]))
    }

    /// Points in `edge`² boxes.
    pub fn points(edge: usize) -> Layout {
        let at = |i: usize, within: f64| ((i as f64 + within.fract()) / edge as f64) as f32;
        let point = |k: usize| {
            let t = k as f64 + 0.5;
            [at(k % edge, t * 0.754_877_666_246_692_7), at(k / edge, t * 0.569_840_290_998_053_2)]
        };
        Layout(Kind::Points((0..edge * edge).map(point).collect()))
    }
}

impl Surface<'_> {
    /// Facets under texel (i, j) of a level of this layout. `mean` is the mean normal under it, not renormalised.
    pub fn facets(
        &self,
        layout: &Layout,
        level: (u32, u32),
        (i, j): (usize, usize),
        mean: [f32; 3],
        out: &mut Vec<Facet>,
    ) {
        out.clear();
        match &layout.0 {
            Kind::Cells([columns, rows]) => self.cells(&columns[i], &rows[j], out),
            Kind::Points(points) => {
                let (width, height) = (self.map.width, self.map.height);
                let size = [width as f32 / level.0 as f32, height as f32 / level.1 as f32];
                let corner = [i as f32 * size[0], j as f32 * size[1]];
                let weight = 1.0 / points.len() as f32;
                for point in points {
                    let [u, v] = [0, 1].map(|c| f64::from(corner[c] + size[c] * point[c]));
                    let column = Place::at(u, 0.0, width, self.map.wrap);
                    let row = Place::at(v, 0.0, height, self.map.wrap);
                    out.push(Facet { lobe: self.lobe(&column, &row), weight });
                }
                centre(out, mean);
            }
        }
    }

    fn cells(&self, columns: &[Place], rows: &[Place], out: &mut Vec<Facet>) {
        let length = |places: &[Place]| places.iter().map(|place| place.width).sum::<f32>();
        let share = 1.0 / (length(columns) * length(rows));
        for row in rows {
            for column in columns {
                out.push(Facet { lobe: self.lobe(column, row), weight: share * row.width * column.width });
            }
        }
    }

    #[inline(always)]
    fn lobe(&self, column: &Place, row: &Place) -> Lobe {
        let (fx, fy) = (column.along, row.along);
        let rows = row.texels.map(|row| row as usize * self.map.width as usize);
        let columns = column.texels.map(|column| column as usize);
        let at = [rows[0] + columns[0], rows[0] + columns[1], rows[1] + columns[0], rows[1] + columns[1]];
        // The value, and its changes along both axes.
        let mix = |a: f32, b: f32, c: f32, d: f32| {
            let (top, bottom) = (a + (b - a) * fx, c + (d - c) * fx);
            (top + (bottom - top) * fy, (b - a) + ((d - c) - (b - a)) * fy, bottom - top)
        };
        let [a, b, c, d] = at.map(|at| self.map.projected[at]);
        let (x, x_u, x_v) = mix(a[0], b[0], c[0], d[0]);
        let (y, y_u, y_v) = mix(a[1], b[1], c[1], d[1]);
        let perceptual = match self.roughness {
            Roughness::Constant(value) => *value,
            Roughness::Map(values) => {
                let [a, b, c, d] = at.map(|at| values[at]);
                mix(a, b, c, d).0
            }
        };
        let alpha = (perceptual * perceptual).clamp(LEAST_ALPHA, 1.0);
        let (a2, z2) = (alpha * alpha, (1.0 - x * x - y * y).max(0.0));
        // z dz = −x dx − y dy.
        let change = |dx: f32, dy: f32| {
            let across = x * dx + y * dy;
            dx * dx + dy * dy + across * across / z2.max(0.01)
        };
        let along = column.width * column.width * change(x_u, y_u) + row.width * row.width * change(x_v, y_v);
        let rest = 1.0 - a2;
        Lobe { normal: [x, y, z2.sqrt()], a2: (a2 + along * (1.0 / 12.0) * (rest * rest)).min(1.0) }
    }
}

/// Part of the variance of n points by n that each is broadened by: it stands for what lies between it and the next ones.
const KERNEL: f32 = 3.0;

/// Moves points so that their mean is that of all normals, and broadens them: noise of points would tilt every fit, and peaks of
/// narrow ones are none of the surface.
fn centre(facets: &mut [Facet], mean: [f32; 3]) {
    let mut off = [mean[0], mean[1]];
    for facet in facets.iter() {
        off[0] -= facet.weight * facet.lobe.normal[0];
        off[1] -= facet.weight * facet.lobe.normal[1];
    }
    let mut variance = 0.0;
    for Facet { lobe, weight } in facets.iter() {
        let (x, y) = (lobe.normal[0] + off[0] - mean[0], lobe.normal[1] + off[1] - mean[1]);
        variance += weight * (x * x + y * y);
    }
    let broadening = KERNEL * variance / facets.len() as f32;
    for Facet { lobe, .. } in facets {
        let rest = 1.0 - lobe.a2;
        lobe.a2 = (lobe.a2 + broadening * rest * rest).min(1.0);
        let (x, y) = (lobe.normal[0] + off[0], lobe.normal[1] + off[1]);
        let z2 = 1.0 - x * x - y * y;
        if z2 > 0.01 {
            lobe.normal = [x, y, z2.sqrt()];
        }
    }
}
