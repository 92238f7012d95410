//! Drafts of environments: the smallest faces and the fewest levels that keep an error over the scene's roughnesses.

use super::args::{Args, LEVELS_AUTO};
use super::bake::draft;
use crate::exit::Failure;
use crate::methods::bake::Candidates;
use crate::methods::planning::{Request, USED};
use glam::DVec3;
use glint_bake_core::environment::eval::environment_mip;
use glint_bake_core::environment::image::luminance;
use glint_bake_core::environment::lookup::radiance_at;
use glint_bake_core::environment::reference::filtered;
use glint_bake_core::environment::{Environment, EnvironmentImage, sections};
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_formats::Pack;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Edges of faces, from few bytes to many.
const FACE_SIZES: [u32; 5] = [16, 32, 64, 128, 256];
/// Directions of each roughness that are measured.
const DIRECTIONS: u32 = 48;
/// Roughnesses, from one end of the range to the other.
const ROUGHNESSES: u32 = 3;
const SEED: u64 = 23;
/// Seed of the directions that a finished pack is measured at.
const MEASURED_SEED: u64 = 1021;

/// A look-up and what it should give.
struct Lookup {
    direction: DVec3,
    alpha: f64,
    luminance: f64,
}

/// What was measured of one environment. Larger faces are not tried once an error is met.
pub fn candidates(args: &Args, request: &Request<'_>) -> Result<Candidates, Failure> {
    let (low, high) = request.environment()?.alpha;
    let base = Args { output: request.output.to_owned(), ..args.clone() };
    let mut found = Candidates::new(format!("roughness α {low} to {high}"));
    let mut lookups: Option<Vec<Lookup>> = None;
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

fn exact(image: &EnvironmentImage, environment: &Environment, (low, high): (f64, f64), seed: u64) -> Vec<Lookup> {
    let lookup = |k: u32| {
        let mut rng = ItemRng::new(seed, Purpose::EnvironmentPlan, k);
        let (z, turn) = (2.0 * rng.unit() - 1.0, TAU * rng.unit());
        let flat = (1.0 - z * z).max(0.0).sqrt();
        let direction = DVec3::new(flat * libm::cos(turn), flat * libm::sin(turn), z);
        let share = f64::from(k % ROUGHNESSES) / f64::from(ROUGHNESSES - 1);
        // The reference takes what look-ups take, f32.
        let alpha = f64::from((low * libm::pow(high / low, share)) as f32);
        let luminance = filtered(image, environment.params.kernel, direction, alpha).luminance;
        Lookup { direction, alpha, luminance }
    };
    (0..DIRECTIONS * ROUGHNESSES).into_par_iter().map(lookup).collect()
}

/// Root mean square error of luminance over its root mean square, the largest of all roughnesses.
fn error(environment: &Environment, lookups: &[Lookup]) -> f64 {
    let of = |first: usize| {
        let (mut errors, mut power) = (0.0, 0.0);
        for lookup in lookups.iter().skip(first).step_by(ROUGHNESSES as usize) {
            let mip = environment_mip(environment, lookup.alpha as f32);
            let found = radiance_at(environment, lookup.direction.as_vec3(), mip);
            let found = luminance([0, 1, 2].map(|c| f64::from(found[c])));
            errors += (found - lookup.luminance).powi(2);
            power += lookup.luminance.powi(2);
        }
        if power > 0.0 { libm::sqrt(errors / power) } else { 0.0 }
    };
    (0..ROUGHNESSES as usize).map(of).fold(0.0, f64::max)
}
