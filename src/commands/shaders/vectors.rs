//! Golden vectors: pixels and what a method gives for them, so that a port of the run time can prove itself.
//!
//! Of a method there are a small pack, the pixels as `example_<method>` reads them, its answers as the bake's own run time gives them, and
//! both again as JSON with names.

use super::cases::{Case, case};
use super::pixel::{Answer, Pixel};
use crate::exit::Failure;
use crate::pack::{provenance, seal};
use glam::{Vec2, Vec3};
use glint_bake_core::footprint::PixelOnSurface;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_shaders::translate::ShaderFile;
use serde::Serialize;
use std::f32::consts::TAU;

/// Pixels of a method.
const PIXELS: u32 = 256;
/// Where the schema of the JSON lives; its `$id`.
const SCHEMA: &str =
    "https://raw.githubusercontent.com/glint-bake/glint-bake/main/docs/schema/glint-vectors.schema.json";

/// The JSON of a method.
#[derive(Debug, Serialize)]
struct Vectors<'a> {
    #[serde(rename = "$schema")]
    schema: &'static str,
    tool_version: &'static str,
    method: &'a str,
    pack: &'a str,
    /// Relative to the larger of two numbers, and absolute in units of the largest of all answers.
    tolerance: [f32; 2],
    /// Share of numbers that may be off by more: counts of facets that a rounded chance changes.
    share_beyond: f32,
    pixels: &'a [Pixel],
    answers: &'a [Answer],
}

/// The files of a method.
pub fn files(method: &str) -> Result<Vec<ShaderFile>, Failure> {
    let Case { sections, answer } = case(method)?;
    let pixels = pixels(method);
    let answers: Vec<Answer> = pixels.iter().map(answer).collect();
    let pack = format!("vectors_{method}.glintpack");
    let sealed = seal(&provenance(&method.replace('_', "-")), sections)?;
    let draws = ["glints", "environment"].contains(&method);
    let vectors = Vectors {
        schema: SCHEMA,
        tool_version: env!("CARGO_PKG_VERSION"),
        method,
        pack: &pack,
        tolerance: [1e-3, 1e-5],
        share_beyond: if draws { 0.02 } else { 0.0 },
        pixels: &pixels,
        answers: &answers,
    };
    let mut text = serde_json::to_string(&vectors).expect("vectors have string keys only").replace("},{", "},\n{");
    text.push('\n');
    let file = |name: String, bytes: Vec<u8>| ShaderFile { name, bytes };
    Ok(vec![
        file(format!("vectors_{method}.json"), text.into_bytes()),
        file(format!("vectors_{method}_pixels.bin"), bytemuck::cast_slice(&pixels).to_vec()),
        file(format!("vectors_{method}_answers.bin"), bytemuck::cast_slice(&answers).to_vec()),
        file(pack.clone(), sealed),
    ])
}

/// Pixels of a quarter to eight hundredths of a unit, up to four times as long as wide, seen and lit near the mirror's direction of normals up
/// to some 20° from the plane's.
fn pixels(method: &str) -> Vec<Pixel> {
    let seed = method.bytes().fold(0u32, |sum, byte| sum.wrapping_mul(31).wrapping_add(u32::from(byte)));
    let mut rng = ItemRng::new(u64::from(seed), Purpose::Test(80), 0);
    let mut number = || rng.unit() as f32;
    let pixel = |_| {
        let around = |angle: f32| Vec2::from_angle(TAU * angle);
        let size = 0.02 * (number() * 4.0).exp2();
        let along = around(number());
        let cosine = 0.3 + 0.7 * number();
        let view = (around(number()) * (1.0 - cosine * cosine).sqrt()).extend(cosine);
        let normal = (around(number()) * (0.36 * number())).extend(1.0).normalize();
        let light = normal * (2.0 * view.dot(normal)) - view;
        let light = if light.z > 0.05 { light } else { Vec3::new(-view.x, -view.y, view.z) };
        let on = PixelOnSurface {
            position: Vec2::new(8.0 * number() - 4.0, 8.0 * number() - 4.0),
            d_dx: along * size * (1.0 + 3.0 * number()),
            d_dy: along.perp() * size,
        };
        Pixel::new(on, view, light.normalize(), [number(), number(), number()])
    };
    (0..PIXELS).map(pixel).collect()
}
