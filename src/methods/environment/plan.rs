//! Drafts of environments: the smallest faces and the fewest levels that keep an error over the scene's roughnesses.

use crate::exit::{Exit, Failure};
use crate::methods::Draft;
use crate::plan::USED;
use crate::plan::{Drafts, Found, Point, options};
use crate::project::scene::Lobes;
use glam::DVec3;
use glint_bake_core::environment::eval::environment_radiance;
use glint_bake_core::environment::image::luminance;
use glint_bake_core::environment::reference::filtered;
use glint_bake_core::environment::{Environment, EnvironmentImage};
use glint_bake_core::rng::{ItemRng, Purpose};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Edges of faces, from few bytes to many.
const FACE_SIZES: [u32; 5] = [16, 32, 64, 128, 256];
/// Directions of each roughness that are measured.
const DIRECTIONS: u32 = 48;
/// Roughnesses, from one end of the range to the other.
const ROUGHNESSES: u32 = 3;
const SEED: u64 = 23;

/// A look-up and what it should give.
struct Lookup {
    direction: DVec3,
    alpha: f64,
    luminance: f64,
}

/// Name of the error.
pub const MEASURE: &str = "RMSE of radiance";

/// What was measured of one environment. Larger faces are not tried once an error is met.
pub fn candidates(drafts: &mut Drafts<'_>, lobes: &Lobes, budget: f64) -> Result<Found, Failure> {
    let (low, high) = lobes.alpha;
    let mut found = Found {
        measure: MEASURE,
        seen: format!("roughness α {low} to {high}"),
        dropped: Vec::new(),
        points: Vec::new(),
    };
    let mut lookups: Option<Vec<Lookup>> = None;
    for size in FACE_SIZES {
        let mut chosen = options([
            ("face-size", size.to_string()),
            ("levels", "auto".into()),
            ("max-moment-error", budget.to_string()),
        ]);
        if drafts.way.words.says("levels") {
            chosen.retain(|(key, _)| key == "face-size");
        }
        chosen.retain(|(key, _)| !drafts.way.words.says(key));
        if found.points.iter().any(|point| point.options == chosen) {
            continue;
        }
        let (draft, bytes) = drafts.make(&chosen)?;
        let Draft::Environment(made) = draft else {
            return Err(Failure::new(
                Exit::Unexpected,
                "a draft of an environment is something else; please report this",
            ));
        };
        let (image, environment) = *made;
        let lookups = lookups.get_or_insert_with(|| exact(&image, &environment, lobes.alpha, SEED));
        let error = error(&environment, lookups);
        found.points.push(Point { options: chosen, bytes, error });
        if error <= USED * budget {
            break;
        }
    }
    Ok(found)
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
            let found = environment_radiance(environment, lookup.direction.as_vec3(), lookup.alpha as f32);
            let found = luminance([0, 1, 2].map(|c| f64::from(found[c])));
            errors += (found - lookup.luminance).powi(2);
            power += lookup.luminance.powi(2);
        }
        if power > 0.0 { libm::sqrt(errors / power) } else { 0.0 }
    };
    (0..ROUGHNESSES as usize).map(of).fold(0.0, f64::max)
}

/// The error of a baked environment, at other directions than those that the plan was made at.
pub fn measured(image: &EnvironmentImage, environment: &Environment, alpha: (f64, f64), seed: u64) -> f64 {
    error(environment, &exact(image, environment, alpha, seed))
}
