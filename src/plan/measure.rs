//! How good the packs of a scene are once they are built: read back, and measured at other places than the plan's.

use crate::exit::{Exit, Failure};
use crate::methods::Draft;
use crate::methods::area_light::plan as area_light;
use crate::methods::environment::plan as environment;
use crate::methods::ndf_maps::plan as ndf_maps;
use crate::project::{Project, Seen, Target};
use glint_bake_core::area_light::sections as area_light_sections;
use glint_bake_core::environment::sections as environment_sections;
use glint_bake_core::ndf_maps::sections as ndf_sections;
use glint_formats::{Limits, Pack};

/// Seed of the places.
const SEED: u64 = 1021;
/// Places of every size of footprint.
const PLACES: u32 = 12;

/// A pack and its error at the scene's footprints.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Name of the pack.
    pub name: String,
    /// Name of the error.
    pub measure: &'static str,
    /// Error as it is in the pack.
    pub error: f64,
    /// Error that was asked.
    pub budget: f64,
    /// Bytes of the file.
    pub bytes: u64,
}

/// Measures every pack that was planned.
///
/// # Errors
/// A pack that is not built or does not verify; inputs that cannot be read.
pub fn measure(project: &Project) -> Result<Vec<Measured>, Failure> {
    let Some(scene) = &project.scene else { return Ok(Vec::new()) };
    let mut all = Vec::new();
    for target in &project.targets {
        let Some(planned) = target.planned.and_then(|at| project.planned.get(at)) else { continue };
        let pack = open(target)?;
        let damaged = |e: glint_bake_core::error::BakeError| Failure::bake(&target.pack, &e);
        // The draft is made for its maps; what is measured is the file.
        let (draft, _) = target.bake.clone().draft()?;
        let (measure, error, own) = match (&draft, &planned.seen) {
            (Draft::NdfMaps(made), Seen::Surface(view)) => {
                let mut worst = 0.0f64;
                for (name, (map, _)) in ndf_sections::materials(&pack).iter().zip(made) {
                    let material = ndf_sections::from_pack(&pack, name).map_err(damaged)?;
                    let seen = scene.footprints(view, map.width);
                    worst = worst.max(ndf_maps::measured(map, &material, &seen, PLACES, SEED));
                }
                (ndf_maps::MEASURE, worst, view.error)
            }
            (Draft::AreaLight(made), Seen::Surface(view)) => {
                let names = area_light_sections::materials(&pack);
                let name = names.first().copied().unwrap_or_default();
                let material = area_light_sections::from_pack(&pack, name).map_err(damaged)?;
                let sigma = scene.footprints(view, made.0.width).sigma;
                (area_light::MEASURE, area_light::measured(&made.0, &material, sigma, PLACES, SEED), view.error)
            }
            (Draft::Environment(made), Seen::Sky(lobes)) => {
                let names = environment_sections::environments(&pack);
                let name = names.first().copied().unwrap_or_default();
                let baked = environment_sections::from_pack(&pack, name).map_err(damaged)?;
                (environment::MEASURE, environment::measured(&made.0, &baked, lobes.alpha, SEED), lobes.error)
            }
            _ => continue,
        };
        let budget = own.unwrap_or(scene.error);
        let bytes = std::fs::metadata(&target.pack).map_or(0, |meta| meta.len());
        all.push(Measured { name: target.name.clone(), measure, error, budget, bytes });
    }
    Ok(all)
}

fn open(target: &Target) -> Result<Pack, Failure> {
    let path = &target.pack;
    let bytes = std::fs::read(path).map_err(|e| Failure::io(path, "cannot be read; run glint-bake build first", &e))?;
    let damaged = |what: String| Failure::new(Exit::BadInput, format!("{}: {what}", path.display()));
    let pack = Pack::from_bytes(bytes, &Limits::default())
        .map_err(|issues| damaged(issues.first().map_or(String::new(), ToString::to_string)))?;
    match pack.verify().first() {
        Some(issue) => Err(damaged(issue.to_string())),
        None => Ok(pack),
    }
}
