//! The tables of a project file that say what is seen: the scene itself, and keys of materials and environments.

use super::entry::{Entry, number};
use crate::cli::values;
use crate::scene::{Density, EnvironmentView, Lights, Scene, SurfaceView};
use toml::de::DeValue;

/// Keys of a material's table that make it planned.
pub const SURFACE_KEYS: [&str; 5] = ["distance", "texels-per-metre", "uv-per-metre", "tilt", "error"];
/// Keys of an environment's table, likewise.
pub const ENVIRONMENT_KEYS: [&str; 2] = ["alpha", "error"];
/// What is wrong, and with which key.
pub type KeyError<'a> = (Entry<'a>, &'static str);

/// The scene of a table.
///
/// # Errors
/// The first key that is wrong; `whole` when one is missing.
pub fn scene<'a>(whole: Entry<'a>, entries: &[Entry<'a>]) -> Result<Scene, KeyError<'a>> {
    let mut scene =
        Scene { image: (1920, 1080), field_of_view: 40.0, lights: Lights::default(), error: 0.1, bytes: None };
    for entry in entries {
        let refuse = |why: &'static str| (*entry, why);
        match entry.key {
            "image" => {
                let size = entry.value.as_str().and_then(|text| values::size(text).ok());
                scene.image = size.ok_or(refuse("expected WxH pixels, as in \"1920x1080\""))?;
            }
            "field-of-view" => {
                scene.field_of_view = number(entry.value)
                    .filter(|angle| (1.0..=170.0).contains(angle))
                    .ok_or(refuse("expected the vertical angle in degrees, 1 to 170"))?;
            }
            "lights" => {
                for light in entry.value.as_array().ok_or(refuse(LIGHTS))?.iter() {
                    match light.get_ref().as_str() {
                        Some("point" | "directional") => scene.lights.point = true,
                        Some("rectangle") => scene.lights.rectangle = true,
                        Some("environment") => scene.lights.environment = true,
                        _ => return Err(refuse(LIGHTS)),
                    }
                }
            }
            "error" => scene.error = error(entry.value).ok_or(refuse(ERROR))?,
            "bytes" => {
                let text = match entry.value {
                    DeValue::Integer(count) => Some(count.as_str()),
                    value => value.as_str(),
                };
                let bytes = text.and_then(|text| values::bytes(text).ok());
                scene.bytes = Some(bytes.ok_or(refuse("expected bytes, as in \"2M\""))?);
            }
            _ => return Err(refuse("expected image, field-of-view, lights, error or bytes")),
        }
    }
    if scene.lights == Lights::default() {
        return Err((whole, "expected lights, a list of point, directional, rectangle, environment"));
    }
    Ok(scene)
}

const LIGHTS: &str = "expected a list of point, directional, rectangle, environment";
const ERROR: &str = "expected an error above 0 and up to 2, as in 0.05";
const RANGE: &str = "expected [NEAREST, FARTHEST] in metres, both above 0";

/// The view that a material's table says. `Ok(None)` when it says nothing of one.
///
/// # Errors
/// The first key that is wrong; `whole` when one is missing.
pub fn surface_view<'a>(whole: Entry<'a>, entries: &[Entry<'a>]) -> Result<Option<SurfaceView>, KeyError<'a>> {
    let (mut distance, mut density, mut tilt, mut own) = (None, None, 60.0, None);
    let mut said = false;
    for entry in entries.iter().filter(|entry| SURFACE_KEYS.contains(&entry.key)) {
        let refuse = |why: &'static str| (*entry, why);
        said = true;
        let positive = || number(entry.value).filter(|v| *v > 0.0).ok_or(refuse("expected a number above 0"));
        match entry.key {
            "distance" => distance = Some(range(entry.value).ok_or(refuse(RANGE))?),
            "texels-per-metre" => density = Some(Density::Texels(positive()?)),
            "uv-per-metre" => density = Some(Density::Uv(positive()?)),
            "tilt" => {
                let angle = number(entry.value).filter(|angle| (0.0..89.9).contains(angle));
                tilt = angle.ok_or(refuse("expected degrees, 0 to 89"))?;
            }
            _ => own = Some(error(entry.value).ok_or(refuse(ERROR))?),
        }
    }
    match (said, distance, density) {
        (false, ..) => Ok(None),
        (_, Some(distance), Some(density)) => Ok(Some(SurfaceView { distance, density, tilt, error: own })),
        (_, None, _) => Err((whole, "expected distance = [NEAREST, FARTHEST] in metres, to plan it for the scene")),
        (_, _, None) => Err((whole, "expected texels-per-metre or uv-per-metre, to plan it for the scene")),
    }
}

/// The view that an environment's table says. `Ok(None)` when it says nothing of one.
///
/// # Errors
/// The first key that is wrong; `whole` when one is missing.
pub fn environment_view<'a>(whole: Entry<'a>, entries: &[Entry<'a>]) -> Result<Option<EnvironmentView>, KeyError<'a>> {
    let (mut alpha, mut own, mut said) = (None, None, false);
    for entry in entries.iter().filter(|entry| ENVIRONMENT_KEYS.contains(&entry.key)) {
        let refuse = |why: &'static str| (*entry, why);
        said = true;
        match entry.key {
            "alpha" => {
                let found = range(entry.value).filter(|(_, high)| *high <= 1.0);
                alpha = Some(found.ok_or(refuse("expected [LEAST, GREATEST] roughness, above 0 and up to 1"))?);
            }
            _ => own = Some(error(entry.value).ok_or(refuse(ERROR))?),
        }
    }
    match (said, alpha) {
        (false, _) => Ok(None),
        (_, Some(alpha)) => Ok(Some(EnvironmentView { alpha, error: own })),
        _ => Err((whole, "expected alpha = [LEAST, GREATEST], the roughness of the materials in it")),
    }
}

fn error(value: &DeValue<'_>) -> Option<f64> {
    number(value).filter(|error| *error > 0.0 && *error <= 2.0)
}

/// Two ascending numbers above 0.
fn range(value: &DeValue<'_>) -> Option<(f64, f64)> {
    let array = value.as_array()?;
    let mut numbers = array.iter().map(|value| number(value.get_ref()));
    let (low, high) = (numbers.next()??, numbers.next()??);
    (numbers.next().is_none() && low > 0.0 && low <= high).then_some((low, high))
}
