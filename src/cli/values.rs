//! Values that flags take, and how they are typed: crops, sizes, colours, byte counts, ranges of transforms.

use crate::input::Crop;
use clap::ValueEnum;
use glint_bake_core::ndf_maps::options::TransformRanges;

/// The name of a value, as a flag takes it.
pub fn name_of(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// `WxH+X+Y`, as ImageMagick writes it.
pub fn crop(text: &str) -> Result<Crop, String> {
    let parse = || {
        let mut parts = text.split('+');
        let (w, h) = pair(parts.next()?)?;
        let (x, y) = (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
        (parts.next().is_none() && w > 0 && h > 0).then_some(Crop { x, y, w, h })
    };
    parse().ok_or_else(|| "expected WxH+X+Y with W and H above 0, as in 32x32+0+64".into())
}

/// `WxH` pixels, both from 1 to 16384.
pub fn size(text: &str) -> Result<(u32, u32), String> {
    let fits = |n: u32| (1..=16_384).contains(&n);
    pair(text).filter(|&(w, h)| fits(w) && fits(h)).ok_or_else(|| "expected WxH, each 1 to 16384, as in 640x480".into())
}

/// A surface's size: `WxH` texels, or without end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceSize {
    /// Width and height in texels.
    Texels(u32, u32),
    /// Without end.
    Unbounded,
}

/// `WxH` texels, both above 0, or `unbounded`.
pub fn surface_size(text: &str) -> Result<SurfaceSize, String> {
    if text == "unbounded" {
        return Ok(SurfaceSize::Unbounded);
    }
    let size = pair(text).filter(|&(w, h)| w > 0 && h > 0).map(|(w, h)| SurfaceSize::Texels(w, h));
    size.ok_or_else(|| "expected WxH texels, as in 4096x4096, or unbounded".into())
}

/// A crop as it is typed.
pub fn crop_text(crop: Crop) -> String {
    format!("{}x{}+{}+{}", crop.w, crop.h, crop.x, crop.y)
}

/// A surface's size as it is typed.
pub fn surface_size_text(size: SurfaceSize) -> String {
    match size {
        SurfaceSize::Texels(width, height) => format!("{width}x{height}"),
        SurfaceSize::Unbounded => "unbounded".to_owned(),
    }
}

fn pair(text: &str) -> Option<(u32, u32)> {
    let (w, h) = text.split_once('x')?;
    Some((w.parse().ok()?, h.parse().ok()?))
}

/// Three finite numbers `X,Y,Z`.
pub fn vector(text: &str) -> Result<[f32; 3], String> {
    let mut numbers = text.split(',').map(|part| part.trim().parse::<f32>().ok().filter(|v| v.is_finite()));
    match (numbers.next().flatten(), numbers.next().flatten(), numbers.next().flatten(), numbers.next()) {
        (Some(x), Some(y), Some(z), None) => Ok([x, y, z]),
        _ => Err("expected three numbers X,Y,Z, as in 0.5,1,0.25".into()),
    }
}

/// A direction: three numbers, not all 0.
pub fn direction(text: &str) -> Result<[f32; 3], String> {
    vector(text).and_then(|v| {
        if v.iter().any(|c| c.abs() > 1e-6) {
            Ok(v)
        } else {
            Err("expected a direction, found a vector of length 0".into())
        }
    })
}

/// Linear RGB reflectance, each 0 to 1.
pub fn reflectance3(text: &str) -> Result<[f32; 3], String> {
    let rgb = vector(text).map_err(|_| "expected R,G,B, each 0 to 1, as in 0.9,0.6,0.3")?;
    if rgb.iter().all(|c| (0.0..=1.0).contains(c)) { Ok(rgb) } else { Err("expected R,G,B, each 0 to 1".into()) }
}

/// A reflectance, 0 to 1.
pub fn reflectance(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|v| (0.0..=1.0).contains(v)).ok_or_else(|| "expected a number from 0 to 1".into())
}

/// A finite number.
pub fn finite(text: &str) -> Result<f32, String> {
    text.parse::<f32>().ok().filter(|v| v.is_finite()).ok_or_else(|| "expected a number".into())
}

/// A finite number, 0 or above.
pub fn not_negative(text: &str) -> Result<f32, String> {
    finite(text).ok().filter(|v| *v >= 0.0).ok_or_else(|| "expected a number, 0 or above".into())
}

/// A finite number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|v| v.is_finite() && *v > 0.0);
    number.ok_or_else(|| "expected a number above 0".into())
}

/// Roughness along both axes: one number above 0 for both, or two.
pub fn roughness_pair(text: &str) -> Result<[f64; 2], String> {
    let numbers: Result<Vec<f64>, String> = text.split(',').map(|part| positive(part.trim())).collect();
    match numbers.as_deref() {
        Ok([both]) => Ok([*both; 2]),
        Ok([first, second]) => Ok([*first, *second]),
        _ => Err("expected one number above 0, or two, as in 0.3 or 0.4,0.1".into()),
    }
}

/// A finite number other than 0.
pub fn non_zero(text: &str) -> Result<f32, String> {
    let number = text.parse::<f32>().ok().filter(|v| v.is_finite() && *v != 0.0);
    number.ok_or_else(|| "expected a finite number other than 0".into())
}

/// Bytes with an optional K, M, G or KiB, MiB, GiB (all powers of 1024).
pub fn bytes(text: &str) -> Result<u64, String> {
    let digits = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    let unit: u64 = match text[digits..].trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1,
        "k" | "kib" => 1 << 10,
        "m" | "mib" => 1 << 20,
        "g" | "gib" => 1 << 30,
        _ => return Err("expected bytes with K, M or G, as in 512M".into()),
    };
    let count = text[..digits].parse::<u64>().ok().and_then(|n| n.checked_mul(unit)).filter(|&n| n > 0);
    count.ok_or_else(|| "expected a number of bytes above 0, as in 512M".into())
}

/// `rotate=A..B,mirror,scale=A..B,stretch=A..B,shear=A..B`; a single value stands for both ends, what is not named
/// does not vary.
pub fn transforms(text: &str) -> Result<TransformRanges, String> {
    let mut ranges = TransformRanges::default();
    for part in text.split(',').map(str::trim).filter(|part| !part.is_empty() && *part != "none") {
        match part.split_once('=') {
            None if part == "mirror" => ranges.mirror = true,
            Some(("rotate", value)) => ranges.rotate_degrees = range(part, value)?,
            Some(("scale", value)) => ranges.scale = range(part, value)?,
            Some(("stretch", value)) => ranges.stretch = range(part, value)?,
            Some(("shear", value)) => ranges.shear = range(part, value)?,
            _ => {
                let expected = "rotate=A..B, mirror, scale=A..B, stretch=A..B, shear=A..B or none";
                return Err(format!("expected {expected}, found '{part}'"));
            }
        }
    }
    Ok(ranges)
}

/// Ranges as the flag takes them.
pub fn transforms_text(ranges: &TransformRanges) -> String {
    let mut parts = Vec::new();
    let mut add = |name: &str, (low, high): (f64, f64), neutral: f64| {
        if low != high {
            parts.push(format!("{name}={low}..{high}"));
        } else if low != neutral {
            parts.push(format!("{name}={low}"));
        }
    };
    add("rotate", ranges.rotate_degrees, 0.0);
    add("scale", ranges.scale, 1.0);
    add("stretch", ranges.stretch, 1.0);
    add("shear", ranges.shear, 0.0);
    if ranges.mirror {
        parts.push("mirror".into());
    }
    if parts.is_empty() { "none".into() } else { parts.join(",") }
}

fn range(part: &str, value: &str) -> Result<(f64, f64), String> {
    let (low, high) = value.split_once("..").unwrap_or((value, value));
    match (low.parse::<f64>(), high.parse::<f64>()) {
        (Ok(low), Ok(high)) if low.is_finite() && high.is_finite() && low <= high => Ok((low, high)),
        _ => Err(format!("expected a number or an ascending range A..B, found '{part}'")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crops_sizes_and_bytes() {
        assert_eq!(crop("32x16+0+64").unwrap(), Crop { x: 0, y: 64, w: 32, h: 16 });
        for bad in ["", "32x16", "0x1+0+0", "32x16+1", "32x16+1+2+3", "32x-1+0+0"] {
            assert!(crop(bad).is_err(), "{bad}");
        }
        assert_eq!(size("640x480").unwrap(), (640, 480));
        assert!(size("640x0").is_err() && size("99999x1").is_err());
        assert_eq!(bytes("2K").unwrap(), 2048);
        assert_eq!(bytes("4GiB").unwrap(), 4 << 30);
        assert!(bytes("").is_err() && bytes("-1").is_err() && bytes("1T").is_err() && bytes("0").is_err());
    }

    #[test]
    fn transforms_by_name() {
        let ranges = transforms("rotate=0..360,mirror,scale=0.5").unwrap();
        assert_eq!(ranges.rotate_degrees, (0.0, 360.0));
        assert!(ranges.mirror);
        assert_eq!(ranges.scale, (0.5, 0.5));
        assert_eq!(transforms("none").unwrap(), TransformRanges::default());
        for bad in ["turn=3", "rotate", "rotate=9..1", "scale=a..b", "scale=nan"] {
            assert!(transforms(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn vectors_are_finite() {
        assert_eq!(vector("1, -2,3.5").unwrap(), [1.0, -2.0, 3.5]);
        assert!(vector("1,2").is_err() && vector("1,2,inf").is_err() && vector("1,2,3,4").is_err());
        assert!(direction("0,0,0").is_err());
        assert!(reflectance3("0,0,1.5").is_err());
    }
}
