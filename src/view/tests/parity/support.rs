//! The adapter, random queries, and the comparison of answers.

pub use crate::adapter::gpu;
use glam::Vec3;
use glint_bake_core::normal_map::NormalMap;
use glint_formats::Wrap;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::path::{Path, PathBuf};

/// Queries a method, at least.
pub const QUERIES: usize = 10_000;

/// Random numbers of a test.
pub fn random(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

/// A number whose logarithm is uniform.
pub fn log_uniform(rng: &mut impl Rng, low: f32, high: f32) -> f32 {
    low * (high / low).powf(rng.random::<f32>())
}

/// A file of GLINT_DATA, or nothing where it is missing.
pub fn real_file(name: &str) -> Option<PathBuf> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let path = std::env::var_os("GLINT_DATA").map_or_else(default, PathBuf::from).join(name);
    if !path.is_file() {
        eprintln!("skipped: {} is not there; set GLINT_DATA", path.display());
        return None;
    }
    Some(path)
}

/// A normal map of GLINT_DATA that repeats.
pub fn real_map(name: &str) -> Option<NormalMap> {
    let image = image::open(real_file(name)?).unwrap().to_rgb8();
    let normal = |rgb: &image::Rgb<u8>| (Vec3::from_array(rgb.0.map(f32::from)) / 127.5 - 1.0).normalize().truncate();
    let projected = image.pixels().map(|rgb| normal(rgb).into()).collect();
    Some(NormalMap { width: image.width(), height: image.height(), wrap: Wrap::Repeat, projected })
}

/// Whether two numbers agree: 1e-3 of the larger, and 1e-5 where both are small.
pub fn agree(gpu: f32, cpu: f32) -> bool {
    (gpu.is_finite() && cpu.is_finite()) && (gpu - cpu).abs() <= 1e-3 * cpu.abs().max(gpu.abs()) + 1e-5
}

/// Fails with the worst of the answers if any two disagree; prints how near they are.
pub fn compare(what: &str, answers: impl Iterator<Item = (f32, f32)>) {
    let (mut count, mut nonzero, mut wrong) = (0, 0, Vec::new());
    let mut worst = 0.0f32;
    for (i, (gpu, cpu)) in answers.enumerate() {
        count += 1;
        nonzero += usize::from(cpu != 0.0);
        if !agree(gpu, cpu) {
            wrong.push((i, gpu, cpu));
        } else if cpu.abs() > 1e-2 {
            worst = worst.max((gpu - cpu).abs() / cpu.abs());
        }
    }
    println!("{what}: {count} answers, {nonzero} not zero, worst relative difference {worst:.1e}");
    assert!(count >= QUERIES, "{what}: only {count} answers");
    assert!(nonzero * 4 > count, "{what}: only {nonzero} of {count} are not zero, which shows little");
    assert!(
        wrong.is_empty(),
        "{what}: {} of {count} disagree (index, GPU, CPU): {:?}",
        wrong.len(),
        &wrong[..wrong.len().min(8)]
    );
}
