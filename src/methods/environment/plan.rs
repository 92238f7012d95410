//! Drafts of environments: the smallest faces and the fewest levels that keep an error over the scene's roughnesses.

use super::args::{Args, LEVELS_AUTO};
use super::bake::draft;
use crate::exit::Failure;
use crate::methods::bake::Candidates;
use crate::methods::planning::{Request, USED};
use glint_bake_core::environment::reads::{self, Read};
use glint_bake_core::environment::{Environment, EnvironmentImage, sections};
use glint_formats::Pack;

/// Edges of faces, from few bytes to many.
const FACE_SIZES: [u32; 5] = [16, 32, 64, 128, 256];
/// Look-ups that are measured.
const READS: u32 = 144;
const SEED: u64 = 23;
/// Seed of the look-ups that a finished pack is measured at.
const MEASURED_SEED: u64 = 1021;

/// What was measured of one environment. Larger faces are not tried once an error is met.
pub fn candidates(args: &Args, request: &Request<'_>) -> Result<Candidates, Failure> {
    let (low, high) = request.environment()?.alpha;
    let base = Args { output: request.output.to_owned(), ..args.clone() };
    let mut found = Candidates::new(format!("roughness α {low} to {high}"));
    let mut lookups: Option<Vec<Read>> = None;
    for size in FACE_SIZES {
        let mut choice = request.choice(base.clone());
        choice.choose("face-size", size, |args| args.face_size = size);
        // A number of levels leaves no error to ask for.
        if !request.fixes("levels") {
            choice.choose("levels", LEVELS_AUTO, |args| args.levels = 0);
            choice.choose("max-moment-error", request.budget, |args| args.max_moment_error = request.budget);
        }
        if found.has(&choice.options) {
            continue;
        }
        let ((image, environment), bytes) = draft(&choice.args)?;
        let lookups = lookups.get_or_insert_with(|| exact(&image, &environment, (low, high), SEED));
        let error = error(&environment, lookups);
        found.push(choice, bytes, error);
        if error <= USED * request.budget {
            break;
        }
    }
    Ok(found)
}

/// The error of a baked environment, at other directions than those that the plan was made at.
pub fn measure(args: &Args, pack: &Pack, request: &Request<'_>) -> Result<f64, Failure> {
    let alpha = request.environment()?.alpha;
    // The draft is made for its image; what is measured is the file.
    let ((image, _), _) = draft(args)?;
    let name = sections::environments(pack).first().copied().unwrap_or_default();
    let baked = sections::from_pack(pack, name).map_err(|e| Failure::bake(request.output, &e))?;
    Ok(error(&baked, &exact(&image, &baked, alpha, MEASURED_SEED)))
}

fn exact(image: &EnvironmentImage, environment: &Environment, alpha: (f64, f64), seed: u64) -> Vec<Read> {
    reads::random(image, environment, alpha, seed, READS)
}

/// Root mean square of the relative errors of what is read.
fn error(environment: &Environment, lookups: &[Read]) -> f64 {
    let pairs: Vec<(f64, f64)> = lookups.iter().map(|read| (read.found(environment), read.exact)).collect();
    reads::error_of(&pairs).relative
}
