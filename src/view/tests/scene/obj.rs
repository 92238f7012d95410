//! OBJ files as they come: marks, line ends, statements, faces of many corners.

use crate::support::{assert_sound, data, glb, load};
use glam::Vec3;
use glint_view::scene::{Mesh, MeshError};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\n";

#[test]
fn marks_and_line_ends_lose_nothing() {
    let plain = load("a.obj", TRIANGLE.as_bytes()).unwrap();
    assert!(plain.notes.is_empty());
    let more = TRIANGLE.replacen("v 0 1 0\n", "v 0 1 0\nv 7 7 7\n", 1);
    for text in [
        format!("\u{feff}{TRIANGLE}"),
        TRIANGLE.replace('\n', "\r\n"),
        TRIANGLE.replace('\n', "\r"),
        format!("\u{feff}{}", TRIANGLE.replace('\n', "\r\n")),
        // Files that were joined.
        TRIANGLE.replacen("v 0 1 0", "\u{feff}v 0 1 0", 1),
        TRIANGLE.replace("v 0 1 0", "v 0 \\\n 1 \\  \n0"),
        TRIANGLE.replace("v 0 1 0", "v\t0  1.0e0   0 1.0 # the last"),
        TRIANGLE.replace("v 1 0 0", "# C:\\models\\\nv 1 0 0 0.5 0.5 0.5"),
        TRIANGLE.replace("f 1/1/1 2/2/1 3/3/1", "f -3/-3/-1 -2/-2/-1 -1/-1/-1"),
        TRIANGLE.trim_end().to_owned(),
        more,
    ] {
        assert_eq!(load("a.obj", text.as_bytes()).unwrap(), plain, "{text:?}");
    }
    let json = glb(|json| format!("\u{feff}{json}"));
    assert_eq!(load("a.glb", &json).unwrap(), load("a.glb", &glb(|json| json)).unwrap());
    for name in ["a.obj", "a.gltf"] {
        let wide: Vec<u8> = [0xfeff].into_iter().chain(TRIANGLE.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        let error = load(name, &wide).unwrap_err();
        assert!(matches!(&error, MeshError::Bad { what, .. } if what.contains("UTF-16")), "{error}");
        let error = load(name, &wide[2..]).unwrap_err();
        assert!(matches!(error, MeshError::Bad { .. }), "{error}");
    }
}

#[test]
fn the_files_with_and_without_a_mark_are_the_same() {
    let (Some(marked), Some(plain)) = (data("cases/bom.obj"), data("cases/nobom.obj")) else {
        eprintln!("skipped: GLINT_DATA has no cases");
        return;
    };
    assert_eq!(Mesh::load(&marked).unwrap(), Mesh::load(&plain).unwrap());
}

#[test]
fn statements_that_are_not_read_are_said() {
    let text = format!("{TRIANGLE}curv 0 1 1 2\nsurf 0 1 0 1 1 2\nfrobnicate 1\ncurv2 1 2\nend\nw 0\n");
    let notes = load("a.obj", text.as_bytes()).unwrap().notes;
    assert_eq!(
        notes,
        [
            "line 11: 'frobnicate' is no statement of OBJ and passed over (2 of the kind)",
            "line 9: 'curv' is of curves and curved surfaces, which are not read (3 of the kind)",
        ]
    );
}

#[test]
fn bad_faces_and_numbers_name_their_line() {
    let start = "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nvn 0 0 1\r\n";
    for (end, found) in [
        ("f 1//0 2//1 3//1", "line 5: a face asks for normal 0, 1 are there so far; they are counted from 1"),
        ("f 1/0 2/0 3/0", "line 5: a face asks for uv 0, 0 are there so far; they are counted from 1"),
        ("f 1 2 4", "line 5: a face asks for position 4, 3 are there so far"),
        ("f 1 2 -4", "line 5: a face asks for position -4, 3 are there so far"),
        ("f 1//1/1 2 3", "line 5: '1//1/1' is not a corner of a face"),
        ("f 1 2 3\\\r\n x", "line 5: 'x' is not a corner of a face"),
        ("\r\nv 1,5 0 0", "line 6: '1,5' is not a number"),
        ("v 1 2\\\r\n", "line 5: 3 numbers are needed, 2 are there"),
        ("v\0 1 0 0", "line 5: 'v\\0' is no text"),
    ] {
        let error = load("a.obj", format!("{start}{end}").as_bytes()).unwrap_err();
        assert!(matches!(&error, MeshError::Bad { what, .. } if what.contains(found)), "{end:?}: {error}");
    }
}

/// Area of the triangles of a flat mesh that face up, and of those that face down.
fn areas(mesh: &Mesh, up: Vec3) -> [f32; 2] {
    assert_sound(mesh);
    mesh.indices.chunks_exact(3).fold([0.0; 2], |mut sums, t| {
        let [a, b, c] = [0, 1, 2].map(|k| Vec3::from(mesh.vertices[t[k] as usize].position));
        let area = 0.5 * (b - a).cross(c - a).dot(up);
        sums[usize::from(area < 0.0)] += area.abs();
        sums
    })
}

#[test]
fn concave_faces_are_covered_once() {
    // An L, an arrow in another plane, a frame whose hole is reached over an edge.
    for (text, up, area) in [
        ("v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 3 4 5 6 1 2\n", Vec3::Z, 5.0),
        ("v 0 0 0\nv 0 2 -1\nv 0 1 0\nv 0 2 1\nf 2 3 4 1\n", Vec3::X, 1.0),
        (
            "v 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nv 1 0 1\nv 1 0 3\nv 3 0 3\nv 3 0 1\nf 1 2 3 4 1 5 6 7 8 5\n",
            Vec3::NEG_Y,
            12.0,
        ),
    ] {
        let mesh = load("a.obj", text.as_bytes()).unwrap();
        let [front, back] = areas(&mesh, up);
        assert!((front - area).abs() < 1e-4 && back < 1e-6, "{text:?}: {front}, {back}");
        assert!(!mesh.notes.iter().any(|note| note.contains("fan")), "{:?}", mesh.notes);
    }
    if let Some(path) = data("cases/concave.obj") {
        let [front, back] = areas(&Mesh::load(&path).unwrap(), Vec3::Z);
        assert!((front - 2.5).abs() < 1e-4 && back == 0.0, "{front}, {back}");
    } else {
        eprintln!("skipped: GLINT_DATA has no cases");
    }
}

#[test]
fn faces_that_cross_themselves_are_said() {
    let text = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 3 0\nf 1 2 3 4\nv 9 9 9\nf 5 5 5 5\n";
    let mesh = load("a.obj", text.as_bytes()).unwrap();
    assert_sound(&mesh);
    let note = "line 5: a face has no area or crosses itself: it is cut into a fan (2 of the kind)";
    assert!(mesh.notes.iter().any(|found| found == note), "{:?}", mesh.notes);
}

/// Ends soon, whatever the number of corners.
#[test]
fn a_concave_face_of_very_many_corners_is_too_much() {
    let count = 40_000;
    let mut text: String = (0..count).map(|i| format!("v {i} {} 0\n", if i % 2 == 0 { 0 } else { 3 })).collect();
    text.push_str("v 0 -9 0\nf");
    (1..=count + 1).rev().for_each(|i| text.push_str(&format!(" {i}")));
    let error = load("a.obj", text.as_bytes()).unwrap_err();
    assert!(matches!(&error, MeshError::TooLarge { what, .. } if what.contains("line 40002: ")), "{error}");
}
