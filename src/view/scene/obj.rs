//! Wavefront OBJ: positions, uv, normals and faces; groups, materials, lines and points are passed over.
//!
//! The tobj crate is not used: its errors name no line.

use super::assemble::{Corner, MissingNormals, Part};
use super::fault::Fault;
use super::mesh::MAX_TRIANGLES;
use glam::{Vec2, Vec3};

#[derive(Default)]
struct Lists {
    positions: Vec<Vec3>,
    uv: Vec<Vec2>,
    normals: Vec<Vec3>,
}

/// The triangles in the bytes of a file; polygons are cut into fans. v points up in OBJ and down here, so it is turned.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Part>, Fault> {
    let mut lists = Lists::default();
    let mut corners = Vec::new();
    let mut polygon = Vec::new();
    let mut text = String::new();
    for (i, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        text.push_str(&String::from_utf8_lossy(line));
        let end = text.trim_end().len();
        text.truncate(end);
        if text.ends_with('\\') {
            // The line goes on in the next.
            text.pop();
            continue;
        }
        let at = |what: String| Fault::Bad(format!("line {}: {what}", i + 1));
        let mut words = text.split_whitespace();
        match words.next() {
            Some("v") => lists.positions.push(Vec3::from(numbers(words, 3).map_err(at)?)),
            Some("vn") => lists.normals.push(Vec3::from(numbers(words, 3).map_err(at)?)),
            Some("vt") => {
                let [u, v, _] = numbers(words, 1).map_err(at)?;
                lists.uv.push(Vec2::new(u, 1.0 - v));
            }
            Some("f") => {
                polygon.clear();
                for word in words {
                    polygon.push(lists.corner(word).map_err(at)?);
                }
                if polygon.len() < 3 {
                    return Err(at(format!("a face has {} corners", polygon.len())));
                }
                for k in 1..polygon.len() - 1 {
                    corners.extend([polygon[0], polygon[k], polygon[k + 1]]);
                }
                if corners.len() > 3 * MAX_TRIANGLES {
                    return Err(Fault::TooLarge(format!("it has more than {MAX_TRIANGLES} triangles, the limit")));
                }
            }
            _ => {}
        }
        text.clear();
    }
    Ok(vec![Part { corners, missing: MissingNormals::Smooth }])
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
    /// A corner from `position`, `position/uv`, `position//normal` or `position/uv/normal`; counted from 1, or from the last
    /// one so far with -1.
    fn corner(&self, word: &str) -> Result<Corner, String> {
        let mut parts = word.split('/');
        let mut next = |count: usize, what: &str| -> Result<Option<usize>, String> {
            let Some(part) = parts.next().filter(|part| !part.is_empty()) else { return Ok(None) };
            let number: i64 = part.parse().map_err(|_| format!("'{word}' is not a corner of a face"))?;
            let index = if number < 0 { count as i64 + number } else { number - 1 };
            let index = usize::try_from(index).ok().filter(|&index| index < count);
            index.map(Some).ok_or_else(|| format!("a face asks for {what} {number}, {count} are there so far"))
        };
        let position = next(self.positions.len(), "position")?;
        let point = position.ok_or_else(|| format!("'{word}' is not a corner of a face"))?;
        let uv = next(self.uv.len(), "uv")?;
        let normal = next(self.normals.len(), "normal")?;
        Ok(Corner {
            position: self.positions[point],
            point: point as u32,
            normal: normal.map(|normal| self.normals[normal]),
            uv: uv.map(|uv| self.uv[uv]),
            tangent: None,
        })
    }
}
