//! Pictures of lobes: the NDF of a whole map or surface, and which patch shows each texel of a surface.

use crate::canvas::{Canvas, colour_wheel, heat};
use crate::exit::{Exit, Failure};
use crate::methods::plots::{WritePlot, stems};
use glam::DVec2;
use glam::Vec2;
use glint_bake_core::error::BakeError;
use glint_bake_core::footprint::Footprint;
use glint_bake_core::lobes::query::QuerySettings;
use glint_bake_core::lobes::sections;
use glint_bake_core::surface::{self, SurfaceSettings};
use glint_bake_core::synthesis::Synthesis;
use glint_formats::{Pack, lobes, synthesis};

/// Edge of the pictures in pixels.
const EDGE: u32 = 512;
/// Roughness below which a lobe could fall between two pixels.
const LEAST_ROUGHNESS: f32 = 2.5 / EDGE as f32;

/// A density over the disk of projected normals, +Y up: the square root of its share of the greatest one.
fn density(p_ndf: impl Fn(Vec2) -> f32) -> Canvas {
    let at = |x: u32, y: u32| Vec2::new(x as f32 + 0.5, EDGE as f32 - 0.5 - y as f32) * (2.0 / EDGE as f32) - 1.0;
    let values: Vec<f32> = (0..EDGE * EDGE).map(|k| p_ndf(at(k % EDGE, k / EDGE))).collect();
    let most = values.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    let mut canvas = Canvas::new(EDGE, EDGE, [0; 3]);
    for (k, value) in (0..).zip(values) {
        let (x, y) = (k % EDGE, k / EDGE);
        if at(x, y).length_squared() <= 1.0 {
            canvas.set(x, y, heat((value / most).sqrt()));
        }
    }
    canvas
}

/// The first texels of a surface, a colour a patch: borders between colours are its seams.
fn patches(synthesis: &Synthesis) -> Canvas {
    // Steps of the golden ratio keep the hues of neighbours apart.
    const STEP: f32 = 0.618_034;
    let mut canvas = Canvas::new(EDGE, EDGE, [0; 3]);
    for (x, y) in (0..EDGE).flat_map(|y| (0..EDGE).map(move |x| (x, y))) {
        let patch = synthesis.place(x as i32, y as i32).patch_index;
        canvas.set(x, y, colour_wheel((patch as f32 * STEP).fract()));
    }
    canvas
}

/// Pictures of the lobes of every map and surface: the NDF of all of it, and the patches of a surface.
///
/// # Errors
/// Bad input, when a section cannot be used; those of `write`.
pub fn write_all(pack: &Pack, write: &mut WritePlot<'_>) -> Result<(), Failure> {
    for (stem, name) in stems(pack, lobes::PARAMS) {
        let damaged = |e: BakeError| Failure::new(Exit::BadInput, format!("lobes {name}: {e}"));
        let picture = if pack.find(synthesis::PARAMS, name).is_some() {
            let surface = surface::sections::from_pack(pack, name).map_err(damaged)?;
            write(format!("{stem}-patches.png"), patches(&surface.synthesis).to_png())?;
            let roughness = surface.lobes.params.intrinsic_roughness.max(LEAST_ROUGHNESS);
            density(|s| surface.p_ndf(&whole(), s, roughness, &SurfaceSettings::default()))
        } else {
            let map = sections::from_pack(pack, name).map_err(damaged)?;
            let roughness = map.params.intrinsic_roughness.max(LEAST_ROUGHNESS);
            density(|s| map.p_ndf(&whole(), s, roughness, &QuerySettings::default()))
        };
        write(format!("{stem}-ndf.png"), picture.to_png())?;
    }
    Ok(())
}

/// A footprint that sees every place of a map or surface.
fn whole() -> Footprint {
    Footprint::new(DVec2::ZERO, 1e6, 1.0, 0.0)
}
