//! Wavefront OBJ: positions, uv, normals and faces; groups, materials, lines and points are passed over.
//!
//! The tobj crate is not used: its errors name no line.

use super::accessor::MAX_COUNT;
use super::assemble::{Corner, MissingNormals, Part, Parts};
use super::fault::{Fault, without_mark};
use super::mesh::{Look, MAX_TRIANGLES};
use super::polygon::{Cut, MAX_STEPS, cut};
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Statements that say nothing about the triangles.
const PASSED_OVER: [&str; 22] = [
    "g",
    "o",
    "s",
    "mg",
    "mtllib",
    "usemtl",
    "maplib",
    "usemap",
    "l",
    "p",
    "vp",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "call",
    "csh",
    "ctech",
    "stech",
    "deg",
];

/// Statements of curves and curved surfaces.
const FREE_FORM: [&str; 14] =
    ["curv", "curv2", "surf", "cstype", "bmat", "step", "parm", "trim", "hole", "scrv", "sp", "con", "bzp", "bsp"];

#[derive(Default)]
struct Lists {
    positions: Vec<Vec3>,
    uv: Vec<Vec2>,
    normals: Vec<Vec3>,
    /// Numbers of the corners in `part` by position, uv and normal, each 0 for none and counted from 1.
    known: HashMap<[u32; 3], u32>,
}

/// Statements of a kind that are noted: how many, and the first.
#[derive(Default)]
struct Seen {
    count: usize,
    line: usize,
    word: String,
}

impl Seen {
    fn add(&mut self, line: usize, word: &str) {
        if self.count == 0 {
            (self.line, self.word) = (line, word.escape_debug().take(40).collect());
        }
        self.count += 1;
    }

    /// A note, if there is something to tell.
    fn note(&self, what: impl Fn(&Seen) -> String) -> Option<String> {
        (self.count > 0).then(|| format!("line {}: {} ({} of the kind)", self.line, what(self), self.count))
    }
}

/// The triangles in the bytes of a file; polygons are cut. v points up in OBJ and down here, so it is turned.
pub(super) fn read(bytes: &[u8]) -> Result<Parts, Fault> {
    let mut lists = Lists::default();
    let (corners, order, look) = (Vec::new(), Vec::new(), Look::default());
    let mut part = Part { corners, order, missing: MissingNormals::Smooth, look };
    let (mut polygon, mut points, mut triangles, mut steps) = (Vec::new(), Vec::new(), Vec::new(), MAX_STEPS);
    let (mut fans, mut free_form, mut unknown) = (Seen::default(), Seen::default(), Seen::default());
    for (line, text) in statements(without_mark(bytes)?) {
        let at = |what: String| Fault::Bad(format!("line {line}: {what}"));
        let mut words = text.split('#').next().unwrap_or_default().split_whitespace();
        match words.next() {
            Some("v") => lists.positions.push(Vec3::from(numbers(words, 3).map_err(at)?)),
            Some("vn") => lists.normals.push(Vec3::from(numbers(words, 3).map_err(at)?)),
            Some("vt") => {
                let [u, v, _] = numbers(words, 1).map_err(at)?;
                lists.uv.push(Vec2::new(u, 1.0 - v));
            }
            Some("f" | "fo") => {
                polygon.clear();
                for word in words {
                    polygon.push(lists.corner(word, &mut part.corners).map_err(at)?);
                }
                if polygon.len() < 3 {
                    return Err(at(format!("a face has {} corners, three are the least", polygon.len())));
                }
                points.clear();
                points.extend(polygon.iter().map(|&corner| part.corners[corner as usize].position));
                match cut(&points, &mut steps, &mut triangles) {
                    Cut::Whole => {}
                    Cut::Fan => fans.add(line, "f"),
                    Cut::TooLong => {
                        let what = "the faces up to here have too many corners to be cut; triangulate them";
                        return Err(Fault::TooLarge(format!("line {line}: {what}")));
                    }
                }
                part.order.extend(triangles.iter().flatten().map(|&k| polygon[k]));
                if part.triangles() > MAX_TRIANGLES {
                    let what = format!("there are more than {MAX_TRIANGLES} triangles up to here, the limit");
                    return Err(Fault::TooLarge(format!("line {line}: {what}")));
                }
            }
            Some("end") | None => {}
            Some(word) if FREE_FORM.contains(&word) => free_form.add(line, word),
            Some(word) if PASSED_OVER.contains(&word) => {}
            Some(word) if word.contains(char::is_control) => {
                return Err(at(format!("'{}' is no text; save the file as UTF-8", word.escape_debug())));
            }
            Some(word) => unknown.add(line, word),
        }
        if lists.positions.len().max(lists.uv.len()).max(lists.normals.len()) as u64 > MAX_COUNT {
            return Err(Fault::TooLarge(format!("line {line}: {MAX_COUNT} positions, uv or normals are the limit")));
        }
    }
    let notes = [
        fans.note(|_| "a face has no area or crosses itself: it is cut into a fan".to_owned()),
        free_form.note(|seen| format!("'{}' is of curves and curved surfaces, which are not read", seen.word)),
        unknown.note(|seen| format!("'{}' is no statement of OBJ and passed over", seen.word)),
    ];
    Ok(Parts { parts: vec![part], notes: notes.into_iter().flatten().collect() })
}

/// The statements of a text with their lines: a line ends with a line feed, a carriage return or both, and goes on in the next
/// after a backslash, unless it is a comment.
fn statements(bytes: &[u8]) -> impl Iterator<Item = (usize, String)> {
    let (mut rest, mut line) = (bytes, 0);
    std::iter::from_fn(move || {
        let mut text = String::new();
        let first = line + 1;
        while !rest.is_empty() {
            let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
            let after = end + if rest[end..].starts_with(b"\r\n") { 2 } else { 1 };
            // Files that were joined have marks inside.
            let words = String::from_utf8_lossy(&rest[..end]);
            text.push_str(words.trim_start_matches('\u{feff}'));
            (rest, line) = (rest.get(after..).unwrap_or_default(), line + 1);
            text.truncate(text.trim_end().len());
            if !text.ends_with('\\') || text.trim_start().starts_with('#') {
                return Some((first, text));
            }
            text.pop();
        }
        (!text.is_empty()).then_some((first, text))
    })
}

/// Up to three numbers, of which the first `least` must be there; the others are 0.
fn numbers<'a>(mut words: impl Iterator<Item = &'a str>, least: usize) -> Result<[f32; 3], String> {
    let mut values = [0.0; 3];
    for (k, value) in values.iter_mut().enumerate() {
        match words.next() {
            Some(word) => *value = word.parse().map_err(|_| format!("'{word}' is not a number"))?,
            None if k < least => return Err(format!("{least} numbers are needed, {k} are there")),
            None => {}
        }
    }
    Ok(values)
}

impl Lists {
    /// The number of a corner from `position`, `position/uv`, `position//normal` or `position/uv/normal`; counted from 1, or
    /// from the last one so far with -1.
    fn corner(&mut self, word: &str, corners: &mut Vec<Corner>) -> Result<u32, String> {
        let mut parts = word.split('/');
        let mut next = |count: usize, what: &str| -> Result<u32, String> {
            let Some(part) = parts.next().filter(|part| !part.is_empty()) else { return Ok(0) };
            let number: i64 = part.parse().map_err(|_| format!("'{word}' is not a corner of a face"))?;
            let index = if number < 0 { count as i64 + number + 1 } else { number };
            let index = u32::try_from(index).ok().filter(|&index| index > 0 && index as usize <= count);
            index.ok_or_else(|| {
                let hint = if number == 0 { "; they are counted from 1" } else { "" };
                format!("a face asks for {what} {number}, {count} are there so far{hint}")
            })
        };
        let point = next(self.positions.len(), "position")?;
        if point == 0 {
            return Err(format!("'{word}' is not a corner of a face"));
        }
        let (uv, normal) = (next(self.uv.len(), "uv")?, next(self.normals.len(), "normal")?);
        if parts.next().is_some() {
            return Err(format!("'{word}' is not a corner of a face: position/uv/normal are the most"));
        }
        let entry = match self.known.entry([point, uv, normal]) {
            Entry::Occupied(known) => return Ok(*known.get()),
            Entry::Vacant(entry) => entry,
        };
        let place = |number: u32| number.checked_sub(1).map(|index| index as usize);
        let corner = Corner {
            position: self.positions[point as usize - 1],
            point,
            normal: place(normal).map(|index| self.normals[index]),
            uv: place(uv).map(|index| self.uv[index]),
            tangent: None,
        };
        corner.check()?;
        let number = corners.len() as u32;
        corners.push(corner);
        Ok(*entry.insert(number))
    }
}
