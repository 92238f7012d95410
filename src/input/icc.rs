//! The transfer function in a colour profile: its tags rTRC, gTRC, bTRC, or kTRC of a grey one (ICC.1:2022, 9.2 and 10).
//!
//! Only the curves are looked at, so that damage elsewhere in a profile does not matter. Profiles of tables (A2B0) have
//! none.

use super::transfer::Transfer;

/// Tags of the three colours, which must agree: normals have no colour.
const COLOURS: [&[u8; 4]; 3] = [b"rTRC", b"gTRC", b"bTRC"];

/// The transfer function; unknown where there is none, or the colours have different ones.
pub(super) fn transfer(profile: &[u8]) -> Transfer {
    if let Some(grey) = tag(profile, b"kTRC").and_then(curve) {
        return grey;
    }
    match COLOURS.map(|name| tag(profile, name).and_then(curve)) {
        [Some(red), Some(green), Some(blue)] if red == green && green == blue => red,
        _ => Transfer::Unknown,
    }
}

/// The content of a tag: the table of tags follows the header of 128 bytes.
fn tag<'a>(profile: &'a [u8], name: &[u8; 4]) -> Option<&'a [u8]> {
    let count = word(profile, 128)?;
    let entries = profile.get(132..)?.chunks_exact(12).take(count);
    let entry = entries.into_iter().find(|entry| &entry[..4] == name)?;
    let (from, length) = (word(entry, 4)?, word(entry, 8)?);
    profile.get(from..from.checked_add(length)?)
}

fn curve(content: &[u8]) -> Option<Transfer> {
    match content.get(..4)? {
        b"curv" => sampled(word(content, 8)?, content.get(12..)?),
        b"para" => parametric(u16::from_be_bytes(content.get(8..10)?.try_into().ok()?), content.get(12..)?),
        _ => None,
    }
}

/// None is the identity, one an exponent with 8 bits of fraction, more are samples.
fn sampled(count: usize, content: &[u8]) -> Option<Transfer> {
    let values: Vec<f32> =
        content.chunks_exact(2).take(count).map(|v| u16::from_be_bytes([v[0], v[1]]) as f32).collect();
    if values.len() != count {
        return None;
    }
    Some(match values.as_slice() {
        [] => Transfer::Linear,
        [exponent] => Transfer::of(|v| v.powf(exponent / 256.0)),
        samples => Transfer::of(|v| {
            let at = v * (count - 1) as f32;
            let below = (at as usize).min(count - 2);
            let part = at - below as f32;
            (samples[below] * (1.0 - part) + samples[below + 1] * part) / 65535.0
        }),
    })
}

/// The five functions of one to seven numbers with 16 bits of fraction.
fn parametric(function: u16, content: &[u8]) -> Option<Transfer> {
    let numbers = [1, 3, 4, 5, 7][..].get(function as usize).copied()?;
    let mut p = [0.0; 7];
    for i in 0..numbers {
        p[i] = i32::from_be_bytes(content.get(4 * i..4 * i + 4)?.try_into().ok()?) as f32 / 65536.0;
    }
    let [g, a, b, c, d, e, f] = p;
    Some(match function {
        0 => Transfer::of(|v| v.powf(g)),
        1 => Transfer::of(|v| if a * v + b >= 0.0 { (a * v + b).powf(g) } else { 0.0 }),
        2 => Transfer::of(|v| if a * v + b >= 0.0 { (a * v + b).powf(g) + c } else { c }),
        3 => Transfer::of(|v| if v >= d { (a * v + b).powf(g) } else { c * v }),
        _ => Transfer::of(|v| if v >= d { (a * v + b).powf(g) + e } else { c * v + f }),
    })
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A profile whose three colours share one curve, or have `blue`.
    fn profile(shared: &[u8], blue: Option<&[u8]>) -> Vec<u8> {
        let mut bytes = vec![0; 128];
        bytes.extend(3u32.to_be_bytes());
        let start = 132 + 3 * 12;
        let blue_at = if blue.is_some() { start + shared.len() } else { start };
        let places = [(start, shared.len()), (start, shared.len()), (blue_at, blue.unwrap_or(shared).len())];
        for (name, (from, length)) in COLOURS.iter().zip(places) {
            bytes.extend(*name);
            bytes.extend((from as u32).to_be_bytes());
            bytes.extend((length as u32).to_be_bytes());
        }
        bytes.extend(shared);
        bytes.extend(blue.unwrap_or_default());
        bytes
    }

    fn curv(values: &[u16]) -> Vec<u8> {
        let mut bytes = b"curv\0\0\0\0".to_vec();
        bytes.extend((values.len() as u32).to_be_bytes());
        values.iter().for_each(|v| bytes.extend(v.to_be_bytes()));
        bytes
    }

    fn para(function: u16, numbers: &[f64]) -> Vec<u8> {
        let mut bytes = b"para\0\0\0\0".to_vec();
        bytes.extend(function.to_be_bytes());
        bytes.extend([0, 0]);
        numbers.iter().for_each(|v| bytes.extend(((v * 65536.0).round() as i32).to_be_bytes()));
        bytes
    }

    #[test]
    fn every_kind_of_curve_is_read() {
        let srgb = [2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045];
        let table: Vec<u16> = (0..1024).map(|i| (Transfer::Srgb.decode(i as f32 / 1023.0) * 65535.0) as u16).collect();
        for (content, expected) in [
            (curv(&[]), Transfer::Linear),
            (curv(&[256]), Transfer::Linear),
            (curv(&[0, 65535]), Transfer::Linear),
            (para(0, &[1.0]), Transfer::Linear),
            (para(3, &srgb), Transfer::Srgb),
            (para(4, &[&srgb[..], &[0.0, 0.0]].concat()), Transfer::Srgb),
            (curv(&table), Transfer::Srgb),
        ] {
            assert_eq!(transfer(&profile(&content, None)), expected, "{}", content.escape_ascii());
        }
        for content in [curv(&[563]), para(0, &[2.2]), para(1, &[2.2, 1.0, 0.0]), para(2, &[2.2, 1.0, 0.0, 0.0])] {
            let found = transfer(&profile(&content, None));
            assert!((found.decode(0.5) - 0.5f32.powf(2.2)).abs() < 1e-3, "{found:?}");
        }
    }

    #[test]
    fn what_cannot_be_read_is_unknown() {
        let linear = curv(&[]);
        assert_eq!(transfer(&profile(&linear, Some(&curv(&[563])))), Transfer::Unknown);
        assert_eq!(transfer(&profile(b"curv\0\0\0\0\0\0\0\x09\0\0", None)), Transfer::Unknown);
        assert_eq!(transfer(&profile(&para(9, &[1.0]), None)), Transfer::Unknown);
        assert_eq!(transfer(&profile(&para(3, &[1.0]), None)), Transfer::Unknown);
        let whole = profile(&linear, None);
        assert_eq!(transfer(&whole), Transfer::Linear);
        for length in 0..whole.len() {
            assert_eq!(transfer(&whole[..length]), Transfer::Unknown, "{length}");
        }
        assert_eq!(transfer(&[0xff; 200]), Transfer::Unknown);
    }
}
