//! The scene profile: what the camera sees of the materials, and what may be spent on them.
//!
//! **Footprints.** A pixel at distance d covers p = 2 d tan(v / 2) / rows metres of a surface that faces the camera, v the
//! vertical field of view. Its footprint is a Gaussian of σ = p / 2 (as in the preview and in the area lights' mips), in
//! texels σ · texels a metre. Tilted by θ, it becomes 1 / cos θ times as long; longer than [`MOST_ANISOTROPIC`] times, it is
//! widened instead, as graphics cards do.

use super::file::Entry;
use crate::cli::values;
use toml::de::DeValue;

/// Keys of a material's table that make it planned.
pub const VIEW_KEYS: [&str; 5] = ["distance", "texels-per-metre", "uv-per-metre", "tilt", "error"];
/// Keys of an environment's table, likewise.
pub const LOBE_KEYS: [&str; 2] = ["alpha", "error"];
/// Longest footprint over its width.
pub const MOST_ANISOTROPIC: f64 = 4.0;
/// Standard deviation of a pixel's footprint over the pixel's edge.
pub const PIXEL_SIGMA: f64 = 0.5;

/// What is the same for all materials.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Columns and rows of the picture.
    pub image: (u32, u32),
    /// Vertical field of view in degrees.
    pub field_of_view: f64,
    /// Lights there are.
    pub lights: Lights,
    /// Error that a pack may have at the scene's footprints.
    pub error: f64,
    /// Bytes that all planned packs may have together.
    pub bytes: Option<u64>,
}

/// Lights of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lights {
    /// Points and directions.
    pub point: bool,
    /// Rectangles.
    pub rectangle: bool,
    /// An environment.
    pub environment: bool,
}

/// How a material is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Nearest and farthest distance in metres.
    pub distance: (f64, f64),
    /// Texels, or repeats of the map, a metre.
    pub density: Density,
    /// Largest angle in degrees between the surface's normal and the view.
    pub tilt: f64,
    /// Error of its own.
    pub error: Option<f64>,
}

/// How a map lies on the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Texels a metre.
    Texels(f64),
    /// Repeats of the map a metre.
    Uv(f64),
}

/// How an environment is looked up.
#[derive(Clone, Debug, PartialEq)]
pub struct Lobes {
    /// Least and greatest GGX roughness α of the materials in it.
    pub alpha: (f64, f64),
    /// Error of its own.
    pub error: Option<f64>,
}

/// Footprints that a material is seen with, in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprints {
    /// Least and greatest standard deviation along the minor axis.
    pub sigma: (f64, f64),
    /// Greatest ratio of the axes.
    pub anisotropy: f64,
}

impl Scene {
    /// Footprints of a view of a map that is `width` texels wide.
    pub fn footprints(&self, view: &View, width: u32) -> Footprints {
        let texels_per_metre = match view.density {
            Density::Texels(count) => count,
            Density::Uv(repeats) => repeats * f64::from(width),
        };
        let pixel = 2.0 * libm::tan(0.5 * self.field_of_view.to_radians()) / f64::from(self.image.1);
        let sigma = |distance: f64| PIXEL_SIGMA * pixel * distance * texels_per_metre;
        let stretch = 1.0 / libm::cos(view.tilt.to_radians());
        // What is longer than is allowed becomes wider.
        let anisotropy = stretch.min(MOST_ANISOTROPIC);
        Footprints { sigma: (sigma(view.distance.0), sigma(view.distance.1) * (stretch / anisotropy)), anisotropy }
    }
}

/// What is wrong, and with which key.
pub type Wrong<'a> = (Entry<'a>, &'static str);

/// The scene of a table.
///
/// # Errors
/// The first key that is wrong; `whole` when one is missing.
pub fn scene<'a>(whole: Entry<'a>, entries: &[Entry<'a>]) -> Result<Scene, Wrong<'a>> {
    let mut scene =
        Scene { image: (1920, 1080), field_of_view: 40.0, lights: Lights::default(), error: 0.1, bytes: None };
    for entry in entries {
        let wrong = |why: &'static str| (*entry, why);
        match entry.key {
            "image" => {
                let size = entry.value.as_str().and_then(|text| values::size(text).ok());
                scene.image = size.ok_or(wrong("expected WxH pixels, as in \"1920x1080\""))?;
            }
            "field-of-view" => {
                scene.field_of_view = number(entry.value)
                    .filter(|angle| (1.0..=170.0).contains(angle))
                    .ok_or(wrong("expected the vertical angle in degrees, 1 to 170"))?;
            }
            "lights" => {
                for light in entry.value.as_array().ok_or(wrong(LIGHTS))?.iter() {
                    match light.get_ref().as_str() {
                        Some("point" | "directional") => scene.lights.point = true,
                        Some("rectangle") => scene.lights.rectangle = true,
                        Some("environment") => scene.lights.environment = true,
                        _ => return Err(wrong(LIGHTS)),
                    }
                }
            }
            "error" => scene.error = error(entry.value).ok_or(wrong(ERROR))?,
            "bytes" => {
                let text = match entry.value {
                    DeValue::Integer(count) => Some(count.as_str()),
                    value => value.as_str(),
                };
                let bytes = text.and_then(|text| values::bytes(text).ok());
                scene.bytes = Some(bytes.ok_or(wrong("expected bytes, as in \"2M\""))?);
            }
            _ => return Err(wrong("expected image, field-of-view, lights, error or bytes")),
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
pub fn view<'a>(whole: Entry<'a>, entries: &[Entry<'a>]) -> Result<Option<View>, Wrong<'a>> {
    let (mut distance, mut density, mut tilt, mut own) = (None, None, 60.0, None);
    let mut said = false;
    for entry in entries.iter().filter(|entry| VIEW_KEYS.contains(&entry.key)) {
        let wrong = |why: &'static str| (*entry, why);
        said = true;
        let positive = || number(entry.value).filter(|v| *v > 0.0).ok_or(wrong("expected a number above 0"));
        match entry.key {
            "distance" => distance = Some(range(entry.value).ok_or(wrong(RANGE))?),
            "texels-per-metre" => density = Some(Density::Texels(positive()?)),
            "uv-per-metre" => density = Some(Density::Uv(positive()?)),
            "tilt" => {
                let angle = number(entry.value).filter(|angle| (0.0..89.9).contains(angle));
                tilt = angle.ok_or(wrong("expected degrees, 0 to 89"))?;
            }
            _ => own = Some(error(entry.value).ok_or(wrong(ERROR))?),
        }
    }
    match (said, distance, density) {
        (false, ..) => Ok(None),
        (_, Some(distance), Some(density)) => Ok(Some(View { distance, density, tilt, error: own })),
        (_, None, _) => Err((whole, "expected distance = [NEAREST, FARTHEST] in metres, to plan it for the scene")),
        (_, _, None) => Err((whole, "expected texels-per-metre or uv-per-metre, to plan it for the scene")),
    }
}

/// The lobes that an environment's table says. `Ok(None)` when it says nothing of them.
///
/// # Errors
/// The first key that is wrong; `whole` when one is missing.
pub fn lobes<'a>(whole: Entry<'a>, entries: &[Entry<'a>]) -> Result<Option<Lobes>, Wrong<'a>> {
    let (mut alpha, mut own, mut said) = (None, None, false);
    for entry in entries.iter().filter(|entry| LOBE_KEYS.contains(&entry.key)) {
        let wrong = |why: &'static str| (*entry, why);
        said = true;
        match entry.key {
            "alpha" => {
                let found = range(entry.value).filter(|(_, high)| *high <= 1.0);
                alpha = Some(found.ok_or(wrong("expected [LEAST, GREATEST] roughness, above 0 and up to 1"))?);
            }
            _ => own = Some(error(entry.value).ok_or(wrong(ERROR))?),
        }
    }
    match (said, alpha) {
        (false, _) => Ok(None),
        (_, Some(alpha)) => Ok(Some(Lobes { alpha, error: own })),
        _ => Err((whole, "expected alpha = [LEAST, GREATEST], the roughness of the materials in it")),
    }
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    let text = match value {
        DeValue::Integer(number) if number.radix() == 10 => number.as_str(),
        DeValue::Float(number) => number.as_str(),
        _ => return None,
    };
    text.parse().ok().filter(|v: &f64| v.is_finite())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn footprints_follow_from_the_camera() {
        let scene =
            Scene { image: (1600, 1000), field_of_view: 90.0, lights: Lights::default(), error: 0.1, bytes: None };
        // At a distance of 1 m the picture is 2 m high, a pixel 2 mm; σ is half of that.
        let view = View { distance: (1.0, 3.0), density: Density::Texels(1000.0), tilt: 60.0, error: None };
        let seen = scene.footprints(&view, 64);
        assert!((seen.sigma.0 - 1.0).abs() < 1e-12 && (seen.sigma.1 - 3.0).abs() < 1e-12, "{seen:?}");
        assert!((seen.anisotropy - 2.0).abs() < 1e-12);
        // 20 repeats of 64 texels a metre; tilted to 16 times the length, it is 4 times as long and 4 times as wide.
        let tilt = (1.0f64 / 16.0).acos().to_degrees();
        let view = View { density: Density::Uv(20.0), tilt, ..view };
        let seen = scene.footprints(&view, 64);
        assert!((seen.sigma.0 - 1.28).abs() < 1e-12 && (seen.sigma.1 - 3.84 * 4.0).abs() < 1e-9, "{seen:?}");
        assert!((seen.anisotropy - 4.0).abs() < 1e-12);
    }
}
