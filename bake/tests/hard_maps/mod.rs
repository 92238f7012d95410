//! Maps that every method of normal maps must survive.

use glint_bake_core::normal_map::NormalMap;
use glint_formats::Wrap;

/// A repeated map of projected normals.
pub fn map(width: u32, height: u32, normal: impl Fn(u32, u32) -> [f32; 2]) -> NormalMap {
    let projected = (0..width * height).map(|k| normal(k % width, k / width)).collect();
    NormalMap { width, height, wrap: Wrap::Repeat, projected }
}

/// Maps that have broken glint code before.
pub fn hard_maps() -> Vec<(&'static str, NormalMap)> {
    let code = |v: i32| (2.0 * v as f32 / 255.0) - 1.0;
    vec![
        ("constant", map(8, 8, |_, _| [0.1, -0.2])),
        ("one texel", map(1, 1, |_, _| [0.0, 0.0])),
        ("one row", map(37, 1, |i, _| [(i as f32 * 0.7).sin() * 0.5, 0.0])),
        ("one column", map(1, 6, |_, j| [0.0, 0.1 * j as f32 - 0.3])),
        ("odd size", map(13, 7, |i, j| [(i as f32).sin() * 0.3, (j as f32).cos() * 0.3])),
        ("one-texel steps", map(8, 8, |i, j| if (i + j) % 2 == 0 { [0.9, 0.0] } else { [-0.9, 0.0] })),
        ("ramp of one texel", map(16, 16, |i, _| if i < 8 { [-0.5, 0.1] } else { [0.5, 0.1] })),
        ("on the rim", map(4, 4, |i, _| if i % 2 == 0 { [0.9999, 0.0] } else { [0.0, -0.9999] })),
        ("flat but for one code", map(16, 16, |i, j| [code(127 + ((i * 7 + j * 3) % 2) as i32), code(128)])),
        ("a single flake", map(8, 8, |i, j| if (i, j) == (3, 3) { [0.5, 0.5] } else { [0.0, 0.0] })),
    ]
}
