//! Time of each method over that of its smooth baseline, in one run, with the error against its reference beside it.

use crate::gpu::{Gpu, GpuError};
use crate::render::{
    Camera, Compare, LightKind, Method, Overlay, Renderer, Side, Subject, View, baseline_of, further, picture,
};
use crate::scene::Mesh;
use crate::settings::{Against, Settings, rect_facing};
use crate::subjects::Subjects;
use glam::Vec3;

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BenchSettings {
    /// Pixels of the pictures that are timed.
    pub size: [u32; 2],
    /// Frames of each method; their median counts.
    pub frames: u32,
    /// Samples of the reference that the error is taken against, an even number; 0 leaves the error out.
    pub reference_samples: u32,
    /// Pixels of the picture in which the error is taken and look-ups are counted.
    pub error_size: [u32; 2],
}

impl Default for BenchSettings {
    fn default() -> BenchSettings {
        BenchSettings { size: [1920, 1080], frames: 20, reference_samples: 256, error_size: [320, 180] }
    }
}

/// Texels of a map that a pixel is wide and high where it is seen from straight ahead, in pictures of any size.
const TEXELS_PER_PIXEL: f32 = 2.0;
/// Surface units likewise, of methods without a map: 2^-9.5. Levels of a dictionary's cells are powers of two, so that its level
/// of detail is halfway between two, where about as many cells are read as on average over distances.
const UNITS_PER_PIXEL: f32 = 0.001_381_067_9;
/// Edge of the wall: it fills the picture from the side, too.
const WALL: f32 = 16.0;
/// Vertical field of view in radians (35°).
const FIELD_OF_VIEW: f32 = 0.610_865_24;

/// A picture that a wall fills, in the light that a method is made for.
#[derive(Clone, Debug)]
pub struct Setup {
    /// How the wall is seen.
    pub name: &'static str,
    /// The lights that are on.
    pub lights: &'static str,
    /// The wall.
    pub mesh: Mesh,
    /// The view that is timed, of the method.
    pub view: View,
    /// The same in fewer pixels with the same footprints.
    pub small: View,
    /// What the method is compared with.
    pub baseline: Side,
}

impl Setup {
    /// The setups of entry `index` of `list`, with the materials of `settings`, in every lighting that the method is made for: the
    /// wall from straight ahead, where footprints are round and equal, and from 60° to the side, where they are long. None for what is a
    /// baseline itself. Lightings need an environment only where `has_environment`.
    pub fn of(
        list: &[Subject],
        index: usize,
        settings: &Settings,
        bench: BenchSettings,
        has_environment: bool,
    ) -> Vec<Setup> {
        let shown = &list[index];
        let Some(base) = baseline_of(list, index).map(|base| &list[base]) else { return Vec::new() };
        let mut settings = settings.clone();
        settings.shown = index;
        settings.against = Against::Nothing;
        settings.lights.room_on = false;
        let places = [("ahead", Vec3::new(0.0, 0.0, 1.0)), ("60 degrees", Vec3::new(0.0, -0.866_025_4, 0.5))];
        let mut setups = Vec::new();
        for lighting in lightings(shown.method, has_environment) {
            settings.lights.only(lighting.kinds);
            let point = settings.lights.points[0];
            settings.lights.points.resize(lighting.points.max(1), point);
            // A rectangle on a smooth surface is its own closed form; the smooth BRDF would take it for sixteen points.
            let own = lighting.kinds.contains(&LightKind::Rect) && shown.method == Method::Glints;
            let of_base = Subject { material: settings.materials[index], ..base.clone() };
            let baseline = Side { shown: if own { shown.clone() } else { of_base }, reference: own };
            for (place, direction) in places {
                let seen = Seen { name: place, direction, lights: lighting.name };
                setups.push(Setup::seen(list, index, &settings, bench, seen, baseline.clone()));
            }
        }
        setups
    }

    fn seen(
        list: &[Subject],
        index: usize,
        settings: &Settings,
        bench: BenchSettings,
        seen: Seen,
        baseline: Side,
    ) -> Setup {
        let Seen { name, direction, lights } = seen;
        let (shown, material) = (&list[index], settings.materials[index]);
        let units_per_pixel =
            if shown.method.has_map() { TEXELS_PER_PIXEL / material.texels_per_unit } else { UNITS_PER_PIXEL };
        let distance = 0.5 / (0.5 * FIELD_OF_VIEW).tan();
        let mut settings = settings.clone();
        // The mirror image of the camera, so that the highlight is in the picture.
        let mirrored = direction * Vec3::new(1.0, -1.0, 1.0);
        settings.lights.sun.direction = mirrored + Vec3::new(0.1, 0.1, 0.0);
        settings.lights.rect = rect_facing(Vec3::ZERO, mirrored * 1.5, 0.5, 0.35);
        for (k, point) in settings.lights.points.iter_mut().enumerate() {
            point.position = mirrored * 3.0 + Vec3::X * (0.3 * k as f32 - 0.4);
            (point.intensity, point.radius) = (Vec3::splat(9.0), 0.02);
        }
        let position = direction * distance;
        let mut view = |size: [u32; 2]| {
            // One unit of uv is the whole wall; the picture shows a height of 1 of it.
            settings.uv_scale = WALL * units_per_pixel * size[1] as f32;
            let mut view = settings.view(list, size);
            view.scene.camera = Camera { position, target: Vec3::ZERO, field_of_view: FIELD_OF_VIEW, near: 0.01 };
            view
        };
        let (view, small) = (view(bench.size), view(bench.error_size));
        Setup { name, lights, mesh: Mesh::wall(WALL, WALL), view, small, baseline }
    }
}

/// Where a wall is seen from, and by which lights.
struct Seen {
    name: &'static str,
    direction: Vec3,
    lights: &'static str,
}

/// Lights in which a method is measured.
struct Lighting {
    /// What its rows say of it.
    name: &'static str,
    kinds: &'static [LightKind],
    /// Points that are on.
    points: usize,
}

/// The light that a method is made for; of counted facets, which are made for all, what each costs and what several do.
fn lightings(method: Method, has_environment: bool) -> Vec<Lighting> {
    let lighting = |name, kinds, points| Lighting { name, kinds, points };
    if method != Method::Glints {
        let usual: (&str, &[LightKind]) = match method.usual_light() {
            LightKind::Sun => ("sun", &[LightKind::Sun]),
            LightKind::Points => ("point", &[LightKind::Points]),
            LightKind::Rect => ("rectangle", &[LightKind::Rect]),
            LightKind::Environment => ("environment", &[LightKind::Environment]),
        };
        return vec![lighting(usual.0, usual.1, 1)];
    }
    let mut all = vec![
        lighting("sun", &[LightKind::Sun], 1),
        lighting("sun and point", &[LightKind::Sun, LightKind::Points], 1),
        lighting("sun and 3 points", &[LightKind::Sun, LightKind::Points], 3),
        lighting("rectangle", &[LightKind::Rect], 1),
    ];
    if has_environment {
        all.push(lighting("environment", &[LightKind::Environment], 1));
        all.push(lighting("sun and environment", &[LightKind::Sun, LightKind::Environment], 1));
    }
    all
}

/// What was measured of a method.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchRow {
    /// Method.
    pub method: &'static str,
    /// Material.
    pub name: String,
    /// How the wall is seen.
    pub view: &'static str,
    /// The lights that are on.
    pub lights: &'static str,
    /// What its time is compared with.
    pub baseline: &'static str,
    /// Median seconds of a frame's passes: the surface and its display.
    pub frame: f64,
    /// That over the median of the baseline, whose frames took turns with those of the method.
    pub frame_ratio: f64,
    /// The same of the surface pass alone.
    pub surface_ratio: f64,
    /// Look-ups of the method's data a pixel, mean over the picture.
    pub loads: f64,
    /// Arithmetic operations a pixel, mean over the picture.
    pub operations: f64,
    /// The same of what its time is compared with.
    pub baseline_operations: f64,
    /// Instructions of the method's program as SPIR-V, all its lights and both sides of its branches.
    pub instructions: usize,
    /// Bytes of the method's data on the GPU.
    pub bytes: u64,
    /// How far the picture is off.
    pub error: Option<PictureError>,
}

/// Error of a picture against the mean of samples of its reference, and the part of it that is the samples' noise. Both are sums over
/// pixels of the luminance's absolute difference, over the sum of the reference's luminance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureError {
    /// Difference of the method from the mean of all samples.
    pub error: f64,
    /// Difference of that mean from the one of infinitely many samples, estimated from its two halves: half of theirs.
    pub noise: f64,
}

/// Measures the method of a setup, one of `subjects`, against its baseline.
pub fn measure(gpu: &Gpu, subjects: &Subjects, setup: &Setup, settings: BenchSettings) -> Result<BenchRow, GpuError> {
    let Compare::Single(Side { shown, .. }) = &setup.view.compare else {
        return Err(GpuError::Refused("a bench has one side".into()));
    };
    let renderer = &mut subjects.renderer(gpu, &setup.mesh)?;
    let of = |view: &View, shown: &Subject, reference| View {
        compare: Compare::Single(Side { shown: shown.clone(), reference }),
        antialias: false,
        vary_seed: false,
        ..view.clone()
    };
    let baseline = &setup.baseline;
    let views = [of(&setup.view, &baseline.shown, baseline.reference), of(&setup.view, shown, false)];
    let small = |reference| of(&setup.small, shown, reference);
    let mut times = [Vec::new(), Vec::new()];
    // The first frame of each compiles its program and is not counted.
    for frame in 0..=settings.frames.max(1) {
        for (view, times) in views.iter().zip(&mut times) {
            let seconds = frame_seconds(gpu, renderer, view)?;
            if frame > 0 {
                times.push(seconds);
            }
        }
    }
    let [base, own] = times.map(|times| FrameSeconds {
        surface: median(times.iter().map(|time| time.surface).collect()),
        frame: median(times.iter().map(|time| time.frame).collect()),
    });
    let loads = mean_count(gpu, renderer, &small(false), Overlay::Loads)?;
    let mut operations =
        |shown, reference| mean_count(gpu, renderer, &of(&setup.small, shown, reference), Overlay::Operations);
    let (operations, baseline_operations) =
        (operations(shown, false)?, operations(&baseline.shown, baseline.reference)?);
    let source = glint_shaders::program(shown.method.name(), &shown.files);
    let instructions = glint_shaders::translate::spirv_instructions(&source).map_err(GpuError::Refused)?;
    // What an environment shows is what lights the scene.
    let environment = subjects.environment.as_ref().filter(|_| shown.method == Method::Environment);
    let bytes = environment.map_or_else(|| shown.bytes(), |environment| environment.bytes);
    let error = if shown.method.has_reference() && settings.reference_samples > 0 {
        Some(error_of(gpu, renderer, &small(false), &small(true), settings.reference_samples)?)
    } else {
        None
    };
    Ok(BenchRow {
        method: shown.method.name(),
        name: shown.name.clone(),
        view: setup.name,
        lights: setup.lights,
        baseline: if baseline.reference { "its smooth form" } else { baseline.shown.method.name() },
        frame: own.frame,
        frame_ratio: own.frame / base.frame,
        surface_ratio: own.surface / base.surface,
        loads,
        operations,
        baseline_operations,
        instructions,
        bytes,
        error,
    })
}

struct FrameSeconds {
    surface: f64,
    frame: f64,
}

/// Seconds of one frame, by the device's timestamps, else by the clock around it.
fn frame_seconds(gpu: &Gpu, renderer: &mut Renderer, view: &View) -> Result<FrameSeconds, GpuError> {
    let start = std::time::Instant::now();
    picture(gpu, renderer, view, 1)?;
    let elapsed = start.elapsed().as_secs_f64();
    let passes = renderer.pass_seconds(gpu)?.unwrap_or_default();
    let surface = passes.first().map_or(elapsed, |pass| pass.1);
    let frame = if passes.is_empty() { elapsed } else { passes.iter().map(|pass| pass.1).sum() };
    Ok(FrameSeconds { surface, frame })
}

/// Look-ups of the method's data, or operations, a pixel, counted by the program itself.
fn mean_count(gpu: &Gpu, renderer: &mut Renderer, view: &View, overlay: Overlay) -> Result<f64, GpuError> {
    let mut view = view.clone();
    view.display.overlay = overlay;
    picture(gpu, renderer, &view, 1)?;
    let pixels = renderer.radiance(gpu, &view, 0)?;
    let sum: f64 = pixels.iter().map(|pixel| f64::from(pixel[3]).exp2() - 1.0).sum();
    Ok(sum / pixels.len() as f64)
}

fn error_of(
    gpu: &Gpu,
    renderer: &mut Renderer,
    method: &View,
    reference: &View,
    samples: u32,
) -> Result<PictureError, GpuError> {
    let luminances = |renderer: &Renderer, view: &View| -> Result<Vec<f64>, GpuError> {
        let of = |p: &[f32; 4]| f64::from(p[0]) * 0.2126 + f64::from(p[1]) * 0.7152 + f64::from(p[2]) * 0.0722;
        Ok(renderer.radiance(gpu, view, 0)?.iter().map(of).collect())
    };
    picture(gpu, renderer, method, 1)?;
    let found = luminances(renderer, method)?;
    picture(gpu, renderer, reference, samples / 2)?;
    let first_half = luminances(renderer, reference)?;
    further(gpu, renderer, reference, samples / 2)?;
    let all = luminances(renderer, reference)?;
    Ok(PictureError { error: relative_difference(&found, &all), noise: relative_difference(&first_half, &all) })
}

/// Sum of absolute differences from `truth` over its sum.
fn relative_difference(values: &[f64], truth: &[f64]) -> f64 {
    let difference: f64 = values.iter().zip(truth).map(|(a, b)| (a - b).abs()).sum();
    difference / truth.iter().sum::<f64>().max(f64::MIN_POSITIVE)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The rows as a Markdown table.
pub fn table(rows: &[BenchRow]) -> String {
    let mut text = String::from(
        "| method | material | seen from | lights | ms a frame | over | ratio | surface alone | look-ups | operations | instructions | bytes | error | noise |\n| --- | --- | --- | --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
    );
    for row in rows {
        let percent = |part: fn(PictureError) -> f64| {
            row.error.map_or_else(String::new, |error| format!("{:.1} %", 100.0 * part(error)))
        };
        let (error, noise) = (percent(|error| error.error), percent(|error| error.noise));
        text.push_str(&format!(
            "| {} | {} | {} | {} | {:.1} | {} | {:.2} | {:.2} | {:.1} | {:.0} of {:.0} | {} | {} | {error} | {noise} |\n",
            row.method,
            row.name,
            row.view,
            row.lights,
            1e3 * row.frame,
            row.baseline,
            row.frame_ratio,
            row.surface_ratio,
            row.loads,
            row.operations,
            row.baseline_operations,
            row.instructions,
            row.bytes
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
    }

    #[test]
    fn differences_are_relative_to_the_whole_picture() {
        assert_eq!(relative_difference(&[1.0, 2.0, 4.0], &[1.0, 3.0, 2.0]), 0.5);
    }
}
