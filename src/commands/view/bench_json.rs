//! The JSON of `glint-view --bench --json`: where it was measured, and a row a method, material and direction.

use glint_view::bench::{BenchRow, BenchSettings};
use glint_view::gpu::Gpu;
use serde::Serialize;

/// Where the schema of the JSON lives; its `$id`.
const SCHEMA: &str = "https://raw.githubusercontent.com/glint-bake/glint-bake/main/docs/schema/glint-bench.schema.json";

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Bench<'a> {
    #[serde(rename = "$schema")]
    schema: &'static str,
    /// Version of this program.
    tool_version: &'static str,
    /// Name and driver of the adapter.
    adapter: String,
    /// Pixels of the pictures that were timed.
    size: [u32; 2],
    /// Frames of each; their median counts.
    frames: u32,
    /// Pixels of the pictures in which errors were taken and work was counted.
    error_size: [u32; 2],
    /// Samples of the reference.
    reference_samples: u32,
    /// One a method, material and direction.
    rows: Vec<Row<'a>>,
}

/// One method of one material from one direction.
#[derive(Debug, Serialize)]
struct Row<'a> {
    method: &'static str,
    material: &'a str,
    from: &'static str,
    lights: &'static str,
    baseline: &'static str,
    milliseconds: f64,
    ratio: f64,
    surface_ratio: f64,
    operations: f64,
    baseline_operations: f64,
    look_ups: f64,
    instructions: usize,
    bytes: u64,
    error: Option<f64>,
    noise: Option<f64>,
}

/// The rows as one JSON document, with a line end.
pub fn to_json(gpu: &Gpu, settings: BenchSettings, rows: &[BenchRow]) -> String {
    let document = Bench {
        schema: SCHEMA,
        tool_version: env!("CARGO_PKG_VERSION"),
        adapter: gpu.adapter_line(),
        size: settings.size,
        frames: settings.frames,
        error_size: settings.error_size,
        reference_samples: settings.reference_samples,
        rows: rows.iter().map(row).collect(),
    };
    let mut text = serde_json::to_string_pretty(&document).expect("documents have string keys only");
    text.push('\n');
    text
}

fn row(row: &BenchRow) -> Row<'_> {
    Row {
        method: row.method,
        material: &row.name,
        from: row.view,
        lights: row.lights,
        baseline: row.baseline,
        milliseconds: 1e3 * row.frame,
        ratio: row.frame_ratio,
        surface_ratio: row.surface_ratio,
        operations: row.operations,
        baseline_operations: row.baseline_operations,
        look_ups: row.loads,
        instructions: row.instructions,
        bytes: row.bytes,
        error: row.error.map(|error| error.error),
        noise: row.error.map(|error| error.noise),
    }
}
