//! The error of a pixel: what the run time reads at [`EvalSettings::REAL_TIME`] against the exact NDF of the footprint, over a sweep of
//! sizes.
//!
//! The exact NDF is a node's: bins of the map's parts, here under the footprint in place of a window, on a fine grid. What a shader reads
//! is evaluated at the corners of some of the grid's cells (docs/methods/ndf-maps.md, *Error of a pixel*).

use super::baked::{BakedNdfMaps, Material};
use super::eval::EvalSettings;
use super::fine_grid::FineGrid;
use super::options::{PlacementOptions, ROUGHNESS_RANGE, TransformRanges};
use super::placement::place;
use super::table_fit::mean_size;
use super::windows::Window;
use crate::error::Result;
use crate::footprint::Footprint;
use crate::normal_map::NormalMap;
use crate::quality::sweep;
use glam::DVec2;
use glint_formats::ndf_maps::PixelError;
use rayon::prelude::*;

/// Sizes of footprints: half octaves.
const SIZES: u32 = 9;
/// Places of each size, and the seed that they are drawn with.
const PLACES: u32 = 4;
const SEED: u64 = 33;
/// Cells of the fine grid below this part of the brightest are dim: a few normals far from the others make many of them.
const DIM: f32 = 0.01;
/// Cells of either kind that are evaluated, about.
const BRIGHT_CELLS: usize = 400;
const DIM_CELLS: usize = 100;
/// Errors are rounded to this: they are known less well, and shaders' functions differ by their last bits between platforms.
const STEP: f64 = 1e-4;

/// A round footprint of the sweep.
#[derive(Clone, Copy, Debug)]
pub struct SweptFootprint {
    /// Standard deviation in texels.
    pub sigma_texels: f64,
    /// The same as a footprint on the example's copies side by side.
    pub footprint: Footprint,
}

impl SweptFootprint {
    /// All that the bake measures on an example, size by size, each as often: from half a texel on, or from the finest windows on where
    /// these are wider than a texel, as then no pixel is narrower.
    pub fn all(map: &NormalMap, finest_window: f64) -> Vec<SweptFootprint> {
        let narrowest = if finest_window > 1.0 { finest_window } else { 0.5 };
        let extent = DVec2::new(f64::from(map.width), f64::from(map.height));
        let of_size = |size: u32| {
            let sigma_texels = narrowest * libm::exp2(0.5 * f64::from(size));
            let places = sweep::footprints(sigma_texels, 1.0, extent, PLACES, SEED + u64::from(size));
            places.into_iter().map(move |footprint| SweptFootprint { sigma_texels, footprint })
        };
        (0..SIZES).flat_map(of_size).collect()
    }

    /// What it sees of the example.
    pub(super) fn window(&self) -> Window {
        Window::round(self.footprint.mean, self.sigma_texels * self.sigma_texels)
    }
}

/// The maps of `map` with the error of their pixels; `exact` is the fine grid under one of `footprints`, which are all of the sweep.
pub(super) fn measured(
    map: &NormalMap,
    maps: BakedNdfMaps,
    footprints: &[SweptFootprint],
    exact: impl Fn(usize) -> FineGrid + Sync,
) -> Result<BakedNdfMaps> {
    let side_by_side = PlacementOptions::Tiled(TransformRanges::default());
    // The pack's f32 of the smallest roughness is a little smaller.
    let roughness = f64::from(maps.params.intrinsic_roughness).max(ROUGHNESS_RANGE.0);
    let placement = place(map, roughness, &side_by_side)?;
    let mut material = Material { maps, placement };
    let error = |(k, swept): (usize, &SweptFootprint)| pixel_error(&material, &swept.footprint, &exact(k));
    let errors: Vec<f64> = footprints.par_iter().enumerate().map(error).collect();
    material.maps.params.pixel = of_sweep(footprints, &errors);
    Ok(material.maps)
}

/// E₁ of one pixel.
fn pixel_error(material: &Material, footprint: &Footprint, exact: &FineGrid) -> f64 {
    let terms = material.gather(footprint, EvalSettings::REAL_TIME);
    let inside: Vec<_> = (0..exact.height).map(|j| exact.columns_inside(j).unwrap_or(0..0)).collect();
    let corners = |[i, j]: [usize; 2]| {
        [[i, j], [i + 1, j], [i, j + 1], [i + 1, j + 1]].map(|[i, j]| inside[j].contains(&i).then_some([i, j]))
    };
    let density = |corner: Option<[usize; 2]>| corner.map_or(0.0, |[i, j]| exact.density[j * exact.width + i]);
    let mean = |cell| 0.25 * corners(cell).map(density).iter().sum::<f32>();
    let cells = (0..exact.height - 1).flat_map(|j| (0..exact.width - 1).map(move |i| [i, j]));
    let weighed: Vec<([usize; 2], f32)> = cells.map(|cell| (cell, mean(cell))).collect();
    let total: f64 = weighed.iter().map(|(_, mean)| f64::from(*mean)).sum();
    let peak = weighed.iter().map(|(_, mean)| *mean).fold(0.0, f32::max);
    let (bright, dim): (Vec<_>, Vec<_>) = weighed.into_iter().partition(|(_, mean)| *mean > DIM * peak);
    let difference = |cell| {
        f64::from(mean_size(corners(cell).map(|corner| {
            let found = corner.map_or(0.0, |[i, j]| {
                let s = exact.origin + DVec2::new(i as f64, j as f64) * exact.spacing;
                material.density(&terms, s.as_vec2())
            });
            found - density(corner)
        })))
    };
    (sum_of_some(&bright, BRIGHT_CELLS, difference) + sum_of_some(&dim, DIM_CELLS, difference))
        / total.max(f64::MIN_POSITIVE)
}

/// The sum over all cells of `value`, from `count` of them, about. They are staggered, so that they do not keep step with texels of tables.
fn sum_of_some(cells: &[([usize; 2], f32)], count: usize, value: impl Fn([usize; 2]) -> f64) -> f64 {
    let stride = cells.len().div_ceil(count).max(1);
    let some = (0..).map(|k| k * stride + 5 * k % stride).take_while(|at| *at < cells.len());
    let (sum, seen) = some.fold((0.0, 0usize), |(sum, seen), at| (sum + value(cells[at].0), seen + 1));
    sum * cells.len() as f64 / seen.max(1) as f64
}

/// Mean over places, then mean and worst over sizes.
fn of_sweep(footprints: &[SweptFootprint], errors: &[f64]) -> PixelError {
    let places = PLACES as usize;
    let of_size = |(swept, errors): (&[SweptFootprint], &[f64])| {
        let mean = errors.iter().sum::<f64>() / places as f64;
        (swept[0].sigma_texels, (mean / STEP).round() * STEP)
    };
    let sizes: Vec<(f64, f64)> =
        footprints.chunks_exact(places).zip(errors.chunks_exact(places)).map(of_size).collect();
    let worst = sizes.iter().fold(sizes[0], |worst, size| if size.1 > worst.1 { *size } else { worst });
    let mean = sizes.iter().map(|size| size.1).sum::<f64>() / sizes.len() as f64;
    PixelError { mean: (mean / STEP).round() * STEP, worst: worst.1, worst_sigma_texels: worst.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ndf_maps::bake::bake_maps;
    use crate::ndf_maps::options::NdfMapsOptions;
    use crate::progress::Silent;
    use glint_formats::Wrap;

    /// Of a fine grid of a small part of the disk that shines, and much that does not, both are seen.
    #[test]
    fn a_spike_on_a_flat_map_is_measured() {
        let mut projected = vec![[0.0, 0.0]; 64];
        projected[27] = [0.9, 0.1];
        let map = NormalMap { width: 8, height: 8, wrap: Wrap::Repeat, projected };
        let options = NdfMapsOptions { roughness: 0.005, ..NdfMapsOptions::default() };
        let pixel = bake_maps(&map, &options, &Silent).unwrap().params.pixel;
        assert!(pixel.mean > 1e-3 && pixel.worst < 0.2, "{pixel:?}");
        assert!((0.5..=8.0).contains(&pixel.worst_sigma_texels), "{pixel:?}");
    }
}
