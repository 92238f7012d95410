//! Pictures of the mips of area-light maps: all mips beside each other, each as large as the first.

use crate::canvas::{Canvas, heat};
use crate::exit::Failure;
use crate::methods::plots::{WritePlot, picture_of, stems};
use glint_formats::area_light::{NORMALS, PARAMS, ROUGHNESS};
use glint_formats::export::Texels;
use glint_formats::{FourCc, Pack};

const BACKGROUND: [u8; 3] = [16, 16, 20];
/// Longer edge of a mip in the picture.
const EDGE: u32 = 192;
const GAP: u32 = 4;
/// Mips in a row.
const COLUMNS: u32 = 4;

/// Mean normals in the usual colours. They are not renormalised: where normals spread, colours turn grey.
fn normals(texels: &Texels) -> Canvas {
    sheet(texels, |[x, y, z, _]| [x, y, z].map(|c| (127.5 * c + 127.5).clamp(0.0, 255.0) as u8))
}

/// Meso roughness α from black (0) over red and yellow to white (1).
fn roughness(texels: &Texels) -> Canvas {
    sheet(texels, |[_, _, _, code]| heat(alpha(code) as f32))
}

/// Roughness by direction: brightness is α along the direction in which normals vary most, the hue is that direction,
/// grey has none.
fn directions(texels: &Texels) -> Canvas {
    sheet(texels, |[xx, xy, yy, _]| {
        let mean = 0.5 * (xx + yy);
        let (a, b) = (0.5 * (xx - yy), xy);
        let spread = a.hypot(b);
        let bright = alpha((mean + spread).clamp(0.0, 1.0)).sqrt();
        let saturation = if mean > 0.0 { (spread / mean).min(1.0) } else { 0.0 };
        // The angle is twice that of the direction, so a turn by 180° is the same hue.
        let hue = b.atan2(a);
        [0.0, 1.0, 2.0].map(|third| {
            let wave = 0.5 + 0.5 * (hue - third * std::f64::consts::TAU / 3.0).cos();
            (255.0 * bright * (1.0 - saturation + saturation * wave)) as u8
        })
    })
}

/// Roughness α of a code, see docs/FORMAT.md.
fn alpha(code: f64) -> f64 {
    (0.12 * (code / (1.0 - code).max(1e-9)).powf(1.0 / 1.4)).clamp(0.0, 1.0)
}

fn sheet(texels: &Texels, colour: impl Fn([f64; 4]) -> [u8; 3]) -> Canvas {
    let texture = texels.texture;
    let longer = texture.width.max(texture.height);
    let shown = |edge: u32| (u64::from(EDGE) * u64::from(edge)).div_ceil(u64::from(longer)) as u32;
    let (width, height) = (shown(texture.width).max(8), shown(texture.height).max(8));
    let (columns, rows) = (texture.mips.min(COLUMNS), texture.mips.div_ceil(COLUMNS));
    let mut canvas = Canvas::new(columns * (width + GAP) + GAP, rows * (height + GAP) + GAP, BACKGROUND);
    for mip in 0..texture.mips {
        let image = texture.image(mip, 0, 0);
        let (left, top) = (GAP + mip % COLUMNS * (width + GAP), GAP + mip / COLUMNS * (height + GAP));
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let texel = |at: u32, shown: u32, edge: u32| (u64::from(at) * u64::from(edge) / u64::from(shown)) as u32;
            let value = texels.at(&image, texel(x, width, image.width), texel(y, height, image.height));
            canvas.set(left + x, top + y, colour(value));
        }
    }
    canvas
}

/// Makes a picture of a texture.
type Draw = fn(&Texels) -> Canvas;

/// Pictures of every material: mean normals, roughness, and roughness by direction.
///
/// # Errors
/// Those of `write`.
pub fn write_all(pack: &Pack, write: &mut WritePlot<'_>) -> Result<(), Failure> {
    let pictures: [(FourCc, &str, Draw); 3] =
        [(NORMALS, "mean-normals", normals), (NORMALS, "roughness", roughness), (ROUGHNESS, "directions", directions)];
    for (stem, name) in stems(pack, PARAMS) {
        for (kind, what, draw) in pictures {
            if let Some(picture) = picture_of(pack, kind, name, draw) {
                write(format!("{stem}-{what}.png"), picture.to_png())?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_mean_what_the_bake_says() {
        assert_eq!(alpha(0.0), 0.0);
        assert!((alpha(0.5) - 0.12).abs() < 1e-12);
        assert_eq!(alpha(1.0), 1.0);
    }
}
