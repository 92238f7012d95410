//! What a bake of NDF maps may be asked for: limits, and why an option is refused.

use crate::error::{BakeError, Result};
use crate::normal_map::NormalMap;
use glint_formats::ndf_maps::{MAX_EDGE, MAX_PALETTE};

/// Texels of an example at most; larger maps belong to other methods, or are cropped.
pub const MAX_EXAMPLE_TEXELS: u64 = 128 * 128;
/// Smallest and largest intrinsic roughness σ_r.
pub const ROUGHNESS_RANGE: (f64, f64) = (1e-4, 1.0);
/// Error of one node at most, relative to what is asked of the mean.
pub const WORST_OF_MEAN: f64 = 3.0;
/// Standard deviations that the finest windows may have, in example texels.
pub const FINEST_WINDOW_RANGE: (f64, f64) = (0.25, 8192.0);

/// Options of a material's bake: its maps and how they cover the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// NDF maps of the example.
    pub maps: NdfMapsOptions,
    /// Placement on the surface.
    pub placement: PlacementOptions,
}

/// Options of one example's maps.
#[derive(Clone, Debug, PartialEq)]
pub struct NdfMapsOptions {
    /// Intrinsic roughness σ_r, a standard deviation in the projected-normal disk.
    pub roughness: f64,
    /// Mean E₁ of nodes against what they stand for; no node has more than [`WORST_OF_MEAN`] times that.
    pub max_error: f64,
    /// Standard deviation of the finest windows in texels, [`FINEST_WINDOW_RANGE`]. Narrower footprints see the
    /// patches of the example itself, which cost more the more there are under them.
    pub finest_window: f64,
}

impl Default for NdfMapsOptions {
    fn default() -> NdfMapsOptions {
        NdfMapsOptions { roughness: 0.02, max_error: 0.03, finest_window: 0.85 }
    }
}

impl NdfMapsOptions {
    /// Refuses values out of range, and an example that is too large.
    pub(super) fn check(&self, map: &NormalMap) -> Result<()> {
        let (low, high) = ROUGHNESS_RANGE;
        if !(low..=high).contains(&self.roughness) {
            return Err(BakeError::BadOption(format!(
                "expected an intrinsic roughness from {low} to {high}, found {}",
                self.roughness
            )));
        }
        if self.max_error.is_nan() || self.max_error <= 0.0 {
            return Err(BakeError::BadOption(format!("expected a maximum error above 0, found {}", self.max_error)));
        }
        let (low, high) = FINEST_WINDOW_RANGE;
        if !(low..=high).contains(&self.finest_window) {
            return Err(BakeError::BadOption(format!(
                "expected a finest window of {low} to {high} texels, found {}",
                self.finest_window
            )));
        }
        check_size(map)
    }
}

/// Refuses an example of more than [`MAX_EXAMPLE_TEXELS`] texels, or of more than [`MAX_EDGE`] along an edge.
pub fn check_size(map: &NormalMap) -> Result<()> {
    let (width, height) = (map.width, map.height);
    if u64::from(width) * u64::from(height) <= MAX_EXAMPLE_TEXELS && width.max(height) <= MAX_EDGE {
        return Ok(());
    }
    Err(BakeError::LimitExceeded(format!(
        "expected an example of at most {MAX_EXAMPLE_TEXELS} texels and {MAX_EDGE} along an edge, found {width} × \
         {height}; NDF maps are for small examples: use a part of it"
    )))
}

/// Options of a placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacementOptions {
    /// Examples side by side under one transform, the ranges' lower ends.
    Tiled(TransformRanges),
    /// Examples around random centres.
    Stochastic(StochasticOptions),
}

/// Options of a stochastic placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StochasticOptions {
    /// Ranges of the palette's transforms.
    pub ranges: TransformRanges,
    /// Transforms in the palette, 1 … [`MAX_PALETTE`].
    pub palette: u32,
    /// Cells along both axes before the surface repeats, a power of two from 2 to 1024.
    pub cells: u32,
    /// Edge of a cell relative to the example's longer edge.
    pub spacing: f64,
    /// Seed of centres, offsets and transforms.
    pub seed: u64,
}

impl Default for StochasticOptions {
    fn default() -> StochasticOptions {
        let ranges = TransformRanges { rotate_degrees: (0.0, 360.0), mirror: true, ..TransformRanges::default() };
        StochasticOptions { ranges, palette: 8, cells: 32, spacing: 2.0, seed: 1 }
    }
}

impl StochasticOptions {
    /// Refuses values out of range.
    pub(super) fn check(&self) -> Result<()> {
        let bad = |what: String| Err(BakeError::BadOption(what));
        if !(1..=MAX_PALETTE).contains(&self.palette) {
            return bad(format!("expected a palette of 1 to {MAX_PALETTE} transforms, found {}", self.palette));
        }
        if !self.cells.is_power_of_two() || !(2..=1024).contains(&self.cells) {
            return bad(format!("expected cells of a power of two from 2 to 1024, found {}", self.cells));
        }
        if !(0.25..=8.0).contains(&self.spacing) {
            return bad(format!("expected a spacing of 0.25 to 8 example edges, found {}", self.spacing));
        }
        Ok(())
    }
}

/// Ranges from which transforms are drawn; a single value has both ends equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransformRanges {
    /// Rotation in degrees, counter-clockwise as seen with +X right and +Y up.
    pub rotate_degrees: (f64, f64),
    /// Whether half of the transforms mirror the example (x → −x) first.
    pub mirror: bool,
    /// Size on the surface, relative.
    pub scale: (f64, f64),
    /// Factor on projected normals.
    pub stretch: (f64, f64),
    /// Shear h of (x, y) → (x + h·y, y), positions and normals.
    pub shear: (f64, f64),
}

impl Default for TransformRanges {
    fn default() -> TransformRanges {
        TransformRanges {
            rotate_degrees: (0.0, 0.0),
            mirror: false,
            scale: (1.0, 1.0),
            stretch: (1.0, 1.0),
            shear: (0.0, 0.0),
        }
    }
}

impl TransformRanges {
    /// Refuses ranges without meaning, and ranges that would push this example's normals, with lobes of `roughness`, over the
    /// horizon.
    pub(super) fn check(&self, map: &NormalMap, roughness: f64) -> Result<()> {
        let bad = |what: String| Err(BakeError::BadOption(what));
        for (name, (low, high), min, max) in [
            ("rotate", self.rotate_degrees, -360.0, 360.0),
            ("scale", self.scale, 0.05, 20.0),
            ("stretch", self.stretch, 0.05, 20.0),
            ("shear", self.shear, -4.0, 4.0),
        ] {
            if !(min <= low && low <= high && high <= max) {
                return bad(format!(
                    "expected an ascending range of transform {name} within {min} … {max}, found {low}..{high}"
                ));
            }
        }
        debug_assert!(roughness >= ROUGHNESS_RANGE.0);
        // A turn or a mirror keeps every normal's length; only stretch and shear can push one out.
        if self.stretch == (1.0, 1.0) && self.shear == (0.0, 0.0) {
            return Ok(());
        }
        let shear = self.shear.0.abs().max(self.shear.1.abs());
        let longest = map.projected.iter().map(|s| (s[0] as f64).hypot(s[1] as f64)).fold(0.0, f64::max);
        // Largest singular value of the shear matrix.
        let shear_gain = 0.5 * (shear + (shear * shear + 4.0).sqrt());
        let reach = (longest + 4.0 * roughness) * shear_gain;
        if reach * self.stretch.1 > 1.0 {
            return bad(format!(
                "stretch {} with shear {shear} would push normals of length {longest:.3} (and lobes of roughness \
                 {roughness}) over the horizon; with this map a stretch up to {:.3} fits",
                self.stretch.1,
                1.0 / reach
            ));
        }
        Ok(())
    }
}
