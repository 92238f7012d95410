//! Small materials made by formula: brushed metal, scratches, paint flakes, leather. For the demo and the tests.
//!
//! Every map tiles, has +Y up, and is the same on every platform: the formulas hold nothing but arithmetic and roots.
//! Each stroke, scratch or cell draws from its own random stream (seed, index). Slope deviations are close to those
//! measured on real materials of the kind.

use glint_bake_core::normal_map::RawNormals;
use glint_formats::Wrap;
use image::{Rgb, RgbImage};
use rand::RngExt;
use rand_pcg::Pcg32;

/// A material: width and height in texels (at least 1), seed.
pub type Material = fn(u32, u32, u64) -> RgbImage;

/// All materials with their names.
pub const MATERIALS: [(&str, Material); 4] =
    [("brushed", brushed), ("scratches", scratches), ("flakes", flakes), ("leather", leather)];

/// Metal brushed along u: grooves one texel wide, up to the whole width long, tapered at both ends.
pub fn brushed(width: u32, height: u32, seed: u64) -> RgbImage {
    let mut field = Field::flat(width, height);
    let strokes_a_row = 8;
    for stroke in 0..height as u64 * strokes_a_row {
        let mut rng = Pcg32::new(seed, stroke);
        let row = rng.random_range(0..height) as i64;
        let start = rng.random_range(0..width) as i64;
        let length = (width as f32 * (0.2 + 0.8 * rng.random::<f32>())).ceil() as i64;
        let depth = rng.random::<f32>();
        for i in 0..length {
            let along = (i as f32 + 0.5) / length as f32;
            let taper = (6.0 * along.min(1.0 - along)).min(1.0);
            *field.at(start + i, row) -= 0.45 * depth * taper;
        }
    }
    field.normals()
}

/// A polished plate with straight scratches at all angles: a V-shaped groove between two raised lips.
pub fn scratches(width: u32, height: u32, seed: u64) -> RgbImage {
    let mut field = Field::flat(width, height);
    for scratch in 0..(width as u64 * height as u64).div_ceil(500) {
        let mut rng = Pcg32::new(seed, scratch);
        let (u, v) = (width as f32 * rng.random::<f32>(), height as f32 * rng.random::<f32>());
        let [du, dv] = direction(&mut rng);
        let shallow = rng.random::<f32>();
        // Most scratches are shallow hairlines, a few cut deep.
        let depth = 0.06 + 0.7 * shallow * shallow * shallow;
        let length = 15.0 + 100.0 * rng.random::<f32>();
        let half_width = 0.8 + 0.8 * shallow;
        // Texels of the square around the scratch, each seen once, so that a scratch does not deepen itself.
        let reach = (length / 2.0 + 3.0).ceil() as i64;
        for j in -reach..=reach {
            for i in -reach..=reach {
                let (x, y) = (i as f32, j as f32);
                let (along, across) = ((x * du + y * dv).abs(), (x * dv - y * du).abs() / half_width);
                if along < length / 2.0 && across < 2.0 {
                    let groove = (across - 1.0).max(-1.0).min(0.6 * (2.0 - across));
                    let taper = (8.0 * (0.5 - along / length)).min(1.0);
                    *field.at(u as i64 + i, v as i64 + j) += depth * groove * taper;
                }
            }
        }
    }
    field.normals()
}

/// Metallic paint: flakes about four texels across, each flat and tilted at random.
pub fn flakes(width: u32, height: u32, seed: u64) -> RgbImage {
    let cells = Cells::new(width, height, 4.0, seed);
    RgbImage::from_fn(width, height, |i, j| {
        let mut rng = Pcg32::new(seed ^ 0x5eed, cells.nearest(i, j).cell);
        // The sum of four uniform numbers is close to a Gaussian.
        let mut slope = || 0.27 * 1.732 * ((0..4).map(|_| rng.random::<f32>()).sum::<f32>() - 2.0);
        encode([-slope(), -slope(), 1.0])
    })
}

/// Leather: domed grains about 16 texels across with creases between them, and fine pores.
pub fn leather(width: u32, height: u32, seed: u64) -> RgbImage {
    let grains = Cells::new(width, height, 16.0, seed);
    let pores = Cells::new(width, height, 4.0, seed ^ 0x90e5);
    let mut field = Field::flat(width, height);
    for j in 0..height {
        for i in 0..width {
            let grain = grains.nearest(i, j);
            // Distance to the crease, where two grains are equally near; flat in the middle of a grain.
            let crease = ((grain.second - grain.first) / 7.0).min(1.0);
            let dome = 1.0 - (1.0 - crease) * (1.0 - crease);
            let pore = (1.0 - pores.nearest(i, j).first / 2.0).max(0.0);
            *field.at(i as i64, j as i64) = 0.8 * dome - 0.16 * pore * crease;
        }
    }
    field.normals()
}

/// A tiling height field, heights in texels.
struct Field {
    width: u32,
    height: u32,
    heights: Vec<f32>,
}

impl Field {
    fn flat(width: u32, height: u32) -> Field {
        Field { width, height, heights: vec![0.0; width as usize * height as usize] }
    }

    /// The height of a texel of the repeated field.
    fn at(&mut self, i: i64, j: i64) -> &mut f32 {
        let (i, j) = (i.rem_euclid(self.width as i64), j.rem_euclid(self.height as i64));
        &mut self.heights[j as usize * self.width as usize + i as usize]
    }

    fn normals(&self) -> RgbImage {
        let raw = RawNormals::from_heights(self.width, self.height, &self.heights, 1.0, Wrap::Repeat)
            .expect("the formulas give finite heights, one a texel");
        RgbImage::from_fn(self.width, self.height, |i, j| encode(raw.vectors[(j * self.width + i) as usize]))
    }
}

/// A tiling grid of cells with one jittered point in each.
struct Cells {
    columns: i64,
    rows: i64,
    /// Texels a cell in u and v.
    size: [f32; 2],
    seed: u64,
}

/// What the points around a texel are like.
struct Nearest {
    /// Index of the cell whose point is nearest.
    cell: u64,
    /// Distance to that point, texels.
    first: f32,
    /// Distance to the next one.
    second: f32,
}

impl Cells {
    fn new(width: u32, height: u32, size_texels: f32, seed: u64) -> Cells {
        let count = |n: u32| (n as f32 / size_texels).round().max(1.0) as i64;
        let (columns, rows) = (count(width), count(height));
        Cells { columns, rows, size: [width as f32 / columns as f32, height as f32 / rows as f32], seed }
    }

    fn nearest(&self, i: u32, j: u32) -> Nearest {
        let (x, y) = ((i as f32 + 0.5) / self.size[0], (j as f32 + 0.5) / self.size[1]);
        let mut found = Nearest { cell: 0, first: f32::INFINITY, second: f32::INFINITY };
        for row in y as i64 - 2..=y as i64 + 2 {
            for column in x as i64 - 2..=x as i64 + 2 {
                let cell = (row.rem_euclid(self.rows) * self.columns + column.rem_euclid(self.columns)) as u64;
                let mut rng = Pcg32::new(self.seed, cell);
                let dx = (column as f32 + rng.random::<f32>() - x) * self.size[0];
                let dy = (row as f32 + rng.random::<f32>() - y) * self.size[1];
                let distance = (dx * dx + dy * dy).sqrt();
                if distance < found.first {
                    found = Nearest { cell, first: distance, second: found.first };
                } else if distance < found.second {
                    found.second = distance;
                }
            }
        }
        found
    }
}

/// A random direction in the plane, without trigonometry: points outside the unit disk are drawn again.
fn direction(rng: &mut Pcg32) -> [f32; 2] {
    loop {
        let [x, y] = [2.0 * rng.random::<f32>() - 1.0, 2.0 * rng.random::<f32>() - 1.0];
        let length = (x * x + y * y).sqrt();
        if length > 0.1 && length <= 1.0 {
            return [x / length, y / length];
        }
    }
}

/// A vector of any length as an 8-bit normal.
fn encode(v: [f32; 3]) -> Rgb<u8> {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    Rgb(v.map(|c| ((c / length * 0.5 + 0.5) * 255.0).round() as u8))
}
