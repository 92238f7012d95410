//! Plans for a scene: of every material, only what its footprints can see, in the fewest bytes that keep an error.
//!
//! Each material is baked with several options, as drafts of that very map, and each draft is measured against the
//! reference at the footprints of the scene. The cheapest one within the error is taken. When all of them together
//! exceed the byte budget, or an error cannot be met, the plan is the nearest that is possible, and says so.

mod choose;
mod measure;
mod text;

pub use choose::{Plan, USED};
pub use measure::{Measured, measure};

use crate::cli::Terminal;
use crate::exit::{Exit, Failure};
use crate::methods::{Draft as Made, Method, area_light, environment, ndf_maps};
use crate::project::arguments::{Methods, Words};
use crate::project::file::{AREA_LIGHT, NDF_MAPS};
use crate::project::scene::Scene;
use crate::project::{Planned, Project, Seen, Way};

/// A pack to plan, with what was measured of its drafts.
#[derive(Clone, Debug)]
pub struct Candidates {
    /// Name of the pack.
    pub name: String,
    /// Method.
    pub method: String,
    /// Number of the table among those that are planned, and of the way among the table's.
    pub from: (usize, usize),
    /// Options that the project says itself.
    pub words: Words,
    /// Error that it may have.
    pub budget: f64,
    /// Name of that error.
    pub measure: &'static str,
    /// How it is seen.
    pub seen: String,
    /// What no look-up of the scene reads, and so is left out.
    pub dropped: Vec<String>,
    /// Drafts that no other one beats in bytes and error, the smallest first. Never empty.
    pub points: Vec<Point>,
}

/// A draft.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Options that were chosen: name and value.
    pub options: Vec<(String, String)>,
    /// Bytes of the pack.
    pub bytes: u64,
    /// Error at the scene's footprints.
    pub error: f64,
}

/// The plan of a project's scene.
///
/// # Errors
/// Usage, when there is nothing to plan; otherwise what stops a draft.
pub fn plan(project: &Project, terminal: Terminal) -> Result<Plan, Failure> {
    let Some(scene) = project.scene.as_ref().filter(|_| !project.planned.is_empty()) else {
        return Err(Failure::usage(format!(
            "{}: nothing to plan; expected [scene], and a distance or an alpha in what is seen in it",
            project.path.display()
        )));
    };
    let mut planner = Planner { project, scene, methods: Methods::new(), candidates: Vec::new(), dropped: Vec::new() };
    for planned in &project.planned {
        terminal.detail(&format!("{}: drafts", planned.name));
        planner.add(planned)?;
    }
    let Planner { candidates, dropped, .. } = planner;
    Ok(Plan::new(candidates, dropped, scene.bytes))
}

struct Planner<'a> {
    project: &'a Project,
    scene: &'a Scene,
    methods: Methods,
    candidates: Vec<Candidates>,
    dropped: Vec<String>,
}

impl Planner<'_> {
    fn add(&mut self, planned: &Planned) -> Result<(), Failure> {
        let lights = self.scene.lights;
        let way = |method: &str| planned.ways.iter().find(|way| way.method == method);
        match (&planned.seen, way(NDF_MAPS), way(AREA_LIGHT)) {
            (Seen::Sky(_), ..) if !lights.environment => {
                self.dropped.push(format!("{}: the scene has no environment light", planned.name));
            }
            // The lights choose between methods.
            (Seen::Surface(_), Some(glints), Some(highlights)) => {
                let mut name = planned.name.clone();
                let mut wants_highlights = lights.rectangle || !lights.point;
                if lights.point {
                    match self.drafts(&name, planned, glints) {
                        Ok(()) => name = format!("{name}-{AREA_LIGHT}"),
                        Err(failure) if failure.exit == Exit::LimitExceeded => {
                            self.dropped.push(format!("glints of {name}: {}", failure.message));
                            wants_highlights = true;
                        }
                        Err(failure) => return Err(failure),
                    }
                } else {
                    self.dropped.push(format!("glints of {name}: the scene has no point or directional light"));
                }
                if wants_highlights {
                    self.drafts(&name, planned, highlights)?;
                } else {
                    self.dropped.push(format!("area-light maps of {}: the scene has no rectangle light", planned.name));
                }
            }
            _ => {
                for way in &planned.ways {
                    self.drafts(&planned.name, planned, way)?;
                }
            }
        }
        Ok(())
    }

    /// Numbers of a table and of one of its ways.
    fn place(&self, planned: &Planned, way: &Way) -> (usize, usize) {
        let table = self.project.planned.iter().position(|other| other.name == planned.name);
        let number = planned.ways.iter().position(|other| other.method == way.method);
        (table.unwrap_or_default(), number.unwrap_or_default())
    }

    fn drafts(&mut self, name: &str, planned: &Planned, way: &Way) -> Result<(), Failure> {
        let error = match &planned.seen {
            Seen::Surface(view) => view.error,
            Seen::Sky(lobes) => lobes.error,
        };
        let budget = error.unwrap_or(self.scene.error);
        let mut drafts = Drafts { name, way, project: self.project, methods: &mut self.methods };
        let found = match &planned.seen {
            Seen::Surface(view) if way.method == NDF_MAPS => ndf_maps::plan::candidates(&mut drafts, self.scene, view)?,
            Seen::Surface(view) => area_light::plan::candidates(&mut drafts, self.scene, view)?,
            Seen::Sky(lobes) => environment::plan::candidates(&mut drafts, lobes, budget)?,
        };
        let points = front(found.points);
        self.candidates.push(Candidates {
            name: name.to_owned(),
            method: way.method.clone(),
            from: self.place(planned, way),
            words: way.words.clone(),
            budget,
            measure: found.measure,
            seen: found.seen,
            dropped: found.dropped,
            points,
        });
        Ok(())
    }
}

/// What a method finds out about a pack.
pub struct Found {
    pub measure: &'static str,
    pub seen: String,
    pub dropped: Vec<String>,
    pub points: Vec<Point>,
}

/// Makes drafts of one pack.
pub struct Drafts<'a> {
    name: &'a str,
    pub way: &'a Way,
    project: &'a Project,
    methods: &'a mut Methods,
}

impl Drafts<'_> {
    /// The bake with these options, as far as the project does not say them itself.
    fn bake(&mut self, options: &[(String, String)]) -> Result<Method, Failure> {
        let mut words = self.way.words.clone();
        for (key, value) in options {
            words = words.with(key, value);
        }
        let pack = self.project.pack(self.name);
        let target = self.methods.target(self.name, &self.way.method, &words, pack);
        target.map(|target| target.bake).map_err(|wrong| Failure::usage(format!("{}: {}", self.name, wrong.why)))
    }

    /// A draft and the bytes of its pack.
    pub fn make(&mut self, options: &[(String, String)]) -> Result<(Made, u64), Failure> {
        self.bake(options)?.draft()
    }
}

/// Options from names and values.
pub fn options<const N: usize>(all: [(&str, String); N]) -> Vec<(String, String)> {
    all.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

/// Points that no other beats, the smallest first.
fn front(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a.bytes.cmp(&b.bytes).then(a.error.total_cmp(&b.error)));
    let mut best = f64::INFINITY;
    points.retain(|point| {
        let better = point.error < best;
        best = best.min(point.error);
        better
    });
    points
}

/// `count` sizes from one end of a range to the other, evenly by their logarithm.
pub fn sizes((low, high): (f64, f64), most: usize) -> Vec<f64> {
    let octaves = libm::log2(high / low);
    let steps = (octaves.ceil() as usize).clamp(if octaves > 0.1 { 1 } else { 0 }, most - 1);
    (0..=steps).map(|k| low * libm::exp2(octaves * k as f64 / steps.max(1) as f64)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beaten_drafts_are_left_out() {
        let point = |bytes, error| Point { options: Vec::new(), bytes, error };
        let kept = front(vec![point(9, 0.1), point(5, 0.3), point(7, 0.3), point(8, 0.2), point(9, 0.05)]);
        assert_eq!(kept, [point(5, 0.3), point(8, 0.2), point(9, 0.05)]);
    }

    #[test]
    fn sizes_reach_from_end_to_end() {
        assert_eq!(sizes((2.0, 2.0), 4), [2.0]);
        let all = sizes((0.5, 32.0), 4);
        assert_eq!((all.len(), all[0]), (4, 0.5));
        assert!((all[3] - 32.0).abs() < 1e-9);
        assert_eq!(sizes((1.0, 2.0), 4).len(), 2);
    }
}
