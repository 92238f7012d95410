//! How good a pack of a scene is once it is built: read back, and measured at other places than the plan's.

use crate::exit::{Exit, Failure};
use crate::methods::bake::Bake;
use crate::methods::planning::{Planning, Request, unplanned};
use crate::scene::{Scene, Subject};
use glint_formats::{Limits, Pack};
use std::path::Path;

/// A pack and its error at the scene's footprints.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Name of the error.
    pub measure: &'static str,
    /// Error as it is in the pack.
    pub error: f64,
    /// Error that was asked.
    pub budget: f64,
    /// Bytes of the file.
    pub bytes: u64,
}

/// Measures the pack at `path`, which `bake` has made.
///
/// # Errors
/// A pack that is not built or does not verify; inputs that cannot be read.
pub fn measure(
    path: &Path,
    bake: &dyn Bake,
    planning: Option<Planning>,
    scene: &Scene,
    subject: &Subject,
) -> Result<Measured, Failure> {
    let planning = planning.ok_or_else(unplanned)?;
    let pack = open(path)?;
    let budget = subject.error().unwrap_or(scene.error);
    let error = bake.measure(&pack, &Request { scene, subject, budget, output: path, fixed: &[] })?;
    let bytes = std::fs::metadata(path).map_or(0, |meta| meta.len());
    Ok(Measured { measure: planning.measure, error, budget, bytes })
}

fn open(path: &Path) -> Result<Pack, Failure> {
    let bytes = std::fs::read(path).map_err(|e| Failure::io(path, "cannot be read; run glint-bake build first", &e))?;
    let damaged = |what: String| Failure::new(Exit::BadInput, format!("{}: {what}", path.display()));
    let pack = Pack::from_bytes(bytes, &Limits::default())
        .map_err(|issues| damaged(issues.first().map_or(String::new(), ToString::to_string)))?;
    match pack.verify().first() {
        Some(issue) => Err(damaged(issue.to_string())),
        None => Ok(pack),
    }
}
