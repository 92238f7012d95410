//! Bytes that a URI of a glTF file stands for (specification, section 2.8): inside it, or in a file of its folder.

use super::fault::{Fault, read_file};
use std::path::{Component, Path};

/// Bytes of `data:…;base64,…`, or of a file beside or below the one in `folder`. Nothing else is read: a mesh of a stranger
/// must not reach other files, or the network.
pub(super) fn fetch(uri: &str, folder: Option<&Path>, limit: u64) -> Result<Vec<u8>, Fault> {
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        let text = text.ok_or_else(|| Fault::Bad("its data URI is not base64".to_owned()))?;
        return base64(text)
            .map_err(|at| Fault::Bad(format!("its data URI is not base64: character {at} after the comma is wrong")));
    }
    let name = percent_decoded(uri);
    // '%3a' is no scheme, but no name that an exporter writes either.
    let inside = |component: Component| matches!(component, Component::Normal(_) | Component::CurDir);
    let within = !name.contains(':') && Path::new(&name).components().all(inside);
    let (Some(folder), true) = (folder, within) else {
        return Err(Fault::Unsupported(format!(
            "it lies at '{uri}'; only files beside or below the .gltf are read: move it there, or export as GLB"
        )));
    };
    read_file(&folder.join(name), limit)
}

/// The bytes of `text` in base64 (RFC 4648, section 4), padding optional; else where it is none.
fn base64(text: &str) -> Result<Vec<u8>, usize> {
    let digits = text.strip_suffix("==").or_else(|| text.strip_suffix('=')).unwrap_or(text);
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 3);
    let (mut bits, mut held) = (0u32, 0);
    for (at, digit) in digits.bytes().enumerate() {
        let value = match digit {
            b'A'..=b'Z' => digit - b'A',
            b'a'..=b'z' => digit - b'a' + 26,
            b'0'..=b'9' => digit - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return Err(at + 1),
        };
        bits = bits << 6 | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    // One digit alone is no byte.
    if held == 6 { Err(digits.len()) } else { Ok(bytes) }
}

fn percent_decoded(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let code = (bytes[i] == b'%').then(|| bytes.get(i + 1..i + 3)).flatten();
        let code = code.and_then(|hex| std::str::from_utf8(hex).ok()).and_then(|hex| u8::from_str_radix(hex, 16).ok());
        decoded.push(code.unwrap_or(bytes[i]));
        i += if code.is_some() { 3 } else { 1 };
    }
    String::from_utf8_lossy(&decoded).into_owned()
}
