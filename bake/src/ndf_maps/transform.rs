//! Spatial transforms of examples: rotation, mirror, scale, stretch and shear (Xing et al. 2024, section 6.1).
//!
//! The paper's matrix M acts on positions and on normals alike. That is right for rotation, mirror and shear; for a
//! scale it is a choice: `scale` changes an example's size on the surface and leaves its normals, `stretch` widens its
//! normals and leaves its size. The paper's scaling is both together. The translation part of M is the noise map's
//! offset.

use super::bake::ROUGHNESS_RANGE;
use crate::error::{BakeError, Result};
use crate::normal_map::NormalMap;
use crate::rng::{ItemRng, Purpose};
use glam::{DMat2, DVec2};
use glint_formats::ndf_maps::TransformRecord;

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

/// One transform, example → surface, in the tangent plane (+X right, +Y up).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Acts on offsets in texels.
    pub position: DMat2,
    /// Acts on projected normals.
    pub normal: DMat2,
}

impl Transform {
    /// Transform of given angle (degrees), mirror, scale, stretch and shear.
    pub fn new(degrees: f64, mirror: bool, scale: f64, stretch: f64, shear: f64) -> Transform {
        let (sin, cos) = (libm::sin(degrees.to_radians()), libm::cos(degrees.to_radians()));
        let rotation = DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos));
        let shear = DMat2::from_cols(DVec2::X, DVec2::new(shear, 1.0));
        let mirror = DMat2::from_diagonal(DVec2::new(if mirror { -1.0 } else { 1.0 }, 1.0));
        let linear = rotation * shear * mirror;
        Transform { position: linear * scale, normal: linear * stretch }
    }

    /// As the pack holds it: inverse matrices, positions with v down.
    pub fn record(&self) -> TransformRecord {
        let flip = DMat2::from_diagonal(DVec2::new(1.0, -1.0));
        let rows = |m: DMat2| [m.x_axis.x as f32, m.y_axis.x as f32, m.x_axis.y as f32, m.y_axis.y as f32];
        TransformRecord {
            position_to_local: rows(flip * self.position.inverse() * flip),
            normal_to_local: rows(self.normal.inverse()),
        }
    }
}

/// Draws `count` transforms, stratified in every parameter, one seed one result.
pub fn draw_palette(ranges: &TransformRanges, count: u32, seed: u64) -> Vec<Transform> {
    let mut rng = ItemRng::new(seed, Purpose::NdfPalette, 0);
    let orders: Vec<Vec<u32>> = (0..4).map(|_| rng.permutation(count)).collect();
    let mirrored = rng.permutation(count);
    (0..count as usize)
        .map(|k| {
            let mut draw = |(lo, hi): (f64, f64), order: &[u32]| {
                if lo == hi { lo } else { lo + (hi - lo) * (order[k] as f64 + rng.unit()) / count as f64 }
            };
            let degrees = draw(ranges.rotate_degrees, &orders[0]);
            let scale = draw(ranges.scale, &orders[1]);
            let stretch = draw(ranges.stretch, &orders[2]);
            let shear = draw(ranges.shear, &orders[3]);
            Transform::new(degrees, ranges.mirror && mirrored[k] % 2 == 1, scale, stretch, shear)
        })
        .collect()
}

/// Refuses ranges without meaning, and ranges that would push this example's normals over the horizon.
pub fn check(ranges: &TransformRanges, map: &NormalMap, roughness: f64) -> Result<()> {
    let bad = |what: String| Err(BakeError::BadOption(what));
    for (name, (lo, hi), min, max) in [
        ("rotate", ranges.rotate_degrees, -360.0, 360.0),
        ("scale", ranges.scale, 0.05, 20.0),
        ("stretch", ranges.stretch, 0.05, 20.0),
        ("shear", ranges.shear, -4.0, 4.0),
    ] {
        if !(min <= lo && lo <= hi && hi <= max) {
            return bad(format!("transform {name} {lo}..{hi} is not an ascending range within {min} … {max}"));
        }
    }
    debug_assert!(roughness >= ROUGHNESS_RANGE.0);
    // A turn or a mirror keeps every normal's length; only stretch and shear can push one out.
    if ranges.stretch == (1.0, 1.0) && ranges.shear == (0.0, 0.0) {
        return Ok(());
    }
    let shear = ranges.shear.0.abs().max(ranges.shear.1.abs());
    let longest = map.projected.iter().map(|s| (s[0] as f64).hypot(s[1] as f64)).fold(0.0, f64::max);
    // Largest singular value of the shear matrix.
    let shear_gain = 0.5 * (shear + (shear * shear + 4.0).sqrt());
    let reach = (longest + 4.0 * roughness) * shear_gain;
    if reach * ranges.stretch.1 > 1.0 {
        return bad(format!(
            "stretch {} with shear {shear} would push normals of length {longest:.3} (and lobes of roughness \
             {roughness}) over the horizon; with this map a stretch up to {:.3} fits",
            ranges.stretch.1,
            1.0 / reach
        ));
    }
    Ok(())
}
