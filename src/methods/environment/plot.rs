//! Pictures of environments: faces of cubes beside each other, +X −X +Y −Y +Z −Z, a row a roughness or a level.

use crate::canvas::Canvas;
use crate::exit::Failure;
use crate::methods::plots::{WritePlot, payload, stems};
use crate::preview::tone;
use glam::{DVec3, Vec3};
use glint_formats::Pack;
use glint_formats::environment::{COLOURS, INDICATORS, MIRROR, PARAMS, RADIANCE};
use glint_formats::export::Texels;

const BACKGROUND: [u8; 3] = [16, 16, 20];
/// Edge of a face in the picture.
const FACE: u32 = 128;
/// Between faces.
const GAP: u32 = 2;
/// Most rows.
const MAX_ROWS: u32 = 10;
/// What the mean radiance of the sphere is exposed to: a middle grey.
const MIDDLE: f32 = 0.3;

/// Mip and layer of filtered roughness `index`, 0 for the least, of so many a face size.
fn place(index: u32, per_size: u32) -> (u32, u32) {
    (index / per_size, index % per_size)
}

/// Tone-mapped radiance, the mirror on top, then a row a roughness, all exposed alike.
fn radiance(mirror: &Texels, filtered: &Texels) -> Canvas {
    let colour = |texels: &Texels, mip, layer, face, i, j| {
        let [r, g, b, _] = texels.at(&texels.texture.image(mip, layer, face), i, j);
        DVec3::new(r, g, b)
    };
    let (per_size, mips) = (filtered.texture.layers, filtered.texture.mips);
    // The last roughness is the blurriest: its mean is close to that of the sphere.
    let edge = filtered.texture.size(mips - 1).0;
    let all = (0..6).flat_map(|face| (0..edge * edge).map(move |at| (face, at % edge, at / edge)));
    let mean = all.map(|(face, i, j)| colour(filtered, mips - 1, per_size - 1, face, i, j)).sum::<DVec3>();
    let exposure = MIDDLE / (mean.element_sum() as f32 / (18 * edge * edge) as f32).max(1e-12);
    let roughnesses = per_size * mips;
    let rows = roughnesses.min(MAX_ROWS - 1);
    sheet(6, 1 + rows, |row, face| {
        let (texels, (mip, layer)) = match row {
            0 => (mirror, (0, 0)),
            // The first and the last, and others evenly between them.
            _ => (filtered, place((row - 1) * (roughnesses - 1) / (rows - 1).max(1), per_size)),
        };
        let pixel = move |i, j| tone::pixel(colour(texels, mip, layer, face, i, j).as_vec3(), exposure);
        (texels.texture.size(mip).0, pixel)
    })
}

/// Shares of the levels, the darkest on top: white is the whole. Left the roughness that has colours of the largest faces, right that
/// of faces of middling size. Coloured levels are tinted as they are.
fn levels(texels: &Texels, colours: Option<&Texels>, per_size: u32) -> Canvas {
    let texture = texels.texture;
    let (layers, shown) = (texture.layers / per_size, per_size / 2);
    let share = |level: u32, mip, face, i, j| {
        let of = |level: u32| {
            let image = texture.image(mip, shown * layers + (level - 1) / 4, face);
            texels.at(&image, i, j)[((level - 1) % 4) as usize]
        };
        let others = |count: u32| (1..count).map(of).sum::<f64>();
        if level == 0 { 1.0 - others(4 * layers + 1) } else { of(level) }
    };
    let mips = [0, texture.mips / 2];
    sheet(12, level_count(texels, layers).min(MAX_ROWS), |level, column| {
        let (mip, face) = (mips[(column / 6) as usize], column % 6);
        let tint = move |i, j| match colours {
            Some(colours) if level > 0 => {
                let [r, g, b, _] = colours.at(&colours.texture.image(mip, level - 1, face), i, j);
                Vec3::new(r as f32, g as f32, b as f32)
            }
            _ => Vec3::ONE,
        };
        let pixel = move |i, j| {
            let bright = share(level, mip, face, i, j).clamp(0.0, 1.0).sqrt() as f32;
            (tint(i, j) * bright).min(Vec3::ONE).to_array().map(|c| (255.0 * c) as u8)
        };
        (texture.size(mip).0, pixel)
    })
}

/// Levels that some texel of the least roughness has a share of, at least two. Each roughness has so many layers.
fn level_count(texels: &Texels, layers: u32) -> u32 {
    let used = |layer: u32, component: usize| {
        (0..6).any(|face| {
            let image = texels.texture.image(0, layer, face);
            (0..image.width * image.height)
                .any(|at| texels.at(&image, at % image.width, at / image.width)[component] > 0.0)
        })
    };
    (1..=4 * layers).rev().find(|level| used((level - 1) / 4, ((level - 1) % 4) as usize)).unwrap_or(1) + 1
}

/// A sheet of faces. `face` gives a face's edge in texels and the colour of each.
fn sheet<P: Fn(u32, u32) -> [u8; 3]>(columns: u32, rows: u32, face: impl Fn(u32, u32) -> (u32, P)) -> Canvas {
    let pitch = FACE + GAP;
    let mut canvas = Canvas::new(columns * pitch + GAP, rows * pitch + GAP, BACKGROUND);
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let (edge, colour) = face(row, column);
        for (y, x) in (0..FACE).flat_map(|y| (0..FACE).map(move |x| (y, x))) {
            let texel = |at: u32| (u64::from(at) * u64::from(edge) / u64::from(FACE)) as u32;
            canvas.set(GAP + column * pitch + x, GAP + row * pitch + y, colour(texel(x), texel(y)));
        }
    }
    canvas
}

/// Pictures of every environment: radiance and the shares of levels.
///
/// # Errors
/// Those of `write`.
pub fn write_all(pack: &Pack, write: &mut WritePlot<'_>) -> Result<(), Failure> {
    for (stem, name) in stems(pack, PARAMS) {
        let [mirror, filtered, indicators, colours] =
            [MIRROR, RADIANCE, INDICATORS, COLOURS].map(|kind| payload(pack, kind, name));
        let [mirror, filtered, indicators, colours] = [&mirror, &filtered, &indicators, &colours]
            .map(|found| found.as_ref().and_then(|(texture, bytes)| Texels::new(*texture, bytes)));
        let (Some(mirror), Some(filtered)) = (mirror, filtered) else { continue };
        write(format!("{stem}-radiance.png"), radiance(&mirror, &filtered).to_png())?;
        if let Some(indicators) = indicators {
            let picture = levels(&indicators, colours.as_ref(), filtered.texture.layers);
            write(format!("{stem}-levels.png"), picture.to_png())?;
        }
    }
    Ok(())
}
