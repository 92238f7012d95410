//! Pictures of environments: faces of cubes beside each other, +X −X +Y −Y +Z −Z, a row a mip or a level.

use crate::canvas::Canvas;
use crate::exit::Failure;
use crate::methods::plots::{WritePlot, payload, picture_of, stems};
use crate::preview::tone;
use glam::{DVec3, Vec3};
use glint_formats::Pack;
use glint_formats::environment::{COLOURS, INDICATORS, PARAMS, RADIANCE};
use glint_formats::export::Texels;

const BACKGROUND: [u8; 3] = [16, 16, 20];
/// Edge of a face in the picture.
const FACE: u32 = 128;
/// Between faces.
const GAP: u32 = 2;
/// Most rows; further mips are almost of one colour.
const MAX_ROWS: u32 = 10;
/// What the mean radiance of the sphere is exposed to: a middle grey.
const MIDDLE: f32 = 0.3;

/// Tone-mapped radiance, a row a mip, all exposed alike.
fn radiance(texels: &Texels) -> Canvas {
    let colour = |mip, face, i, j| {
        let image = texels.texture.image(mip, 0, face);
        let [r, g, b, _] = texels.at(&image, i, j);
        DVec3::new(r, g, b)
    };
    // The last mip is the blurriest: its mean is close to that of the sphere.
    let last = texels.texture.mips - 1;
    let edge = texels.texture.size(last).0;
    let all = (0..6).flat_map(|face| (0..edge * edge).map(move |at| (face, at % edge, at / edge)));
    let mean = all.map(|(face, i, j)| colour(last, face, i, j)).sum::<DVec3>() / f64::from(6 * edge * edge);
    let exposure = MIDDLE / (mean.element_sum() as f32 / 3.0).max(1e-12);
    let rows = texels.texture.mips.min(MAX_ROWS);
    sheet(6, rows, |row, face| {
        (texels.texture.size(row).0, move |i, j| tone::pixel(colour(row, face, i, j).as_vec3(), exposure))
    })
}

/// Shares of the levels, the darkest on top: white is the whole. Left the first mip, right one of middling roughness.
/// Coloured levels are tinted as they are.
fn levels(texels: &Texels, colours: Option<&Texels>) -> Canvas {
    let texture = texels.texture;
    let share = |level: u32, mip, face, i, j| {
        let of = |level: u32| {
            let image = texture.image(mip, (level - 1) / 4, face);
            texels.at(&image, i, j)[((level - 1) % 4) as usize]
        };
        let others = |count: u32| (1..count).map(of).sum::<f64>();
        if level == 0 { 1.0 - others(4 * texture.layers + 1) } else { of(level) }
    };
    let count = level_count(texels);
    let mips = [0, texture.mips / 2];
    sheet(12, count.min(MAX_ROWS), |level, column| {
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

/// Levels that some texel of the first mip has a share of, at least two.
fn level_count(texels: &Texels) -> u32 {
    let used = |layer: u32, component: usize| {
        (0..6).any(|face| {
            let image = texels.texture.image(0, layer, face);
            (0..image.width * image.height)
                .any(|at| texels.at(&image, at % image.width, at / image.width)[component] > 0.0)
        })
    };
    let levels = 4 * texels.texture.layers;
    (1..=levels).rev().find(|level| used((level - 1) / 4, ((level - 1) % 4) as usize)).unwrap_or(1) + 1
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
        if let Some(picture) = picture_of(pack, RADIANCE, name, radiance) {
            write(format!("{stem}-radiance.png"), picture.to_png())?;
        }
        let colours = payload(pack, COLOURS, name);
        let colours = colours.as_ref().and_then(|(texture, bytes)| Texels::new(*texture, bytes));
        if let Some(picture) = picture_of(pack, INDICATORS, name, |texels| levels(texels, colours.as_ref())) {
            write(format!("{stem}-levels.png"), picture.to_png())?;
        }
    }
    Ok(())
}
