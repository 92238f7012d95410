//! Every real map that we have, loaded as a user would: sizes, lengths, green axis, seams, against their catalogue.
//!
//! The maps lie in the folder GLINT_DATA (../shared/data when unset); without it the tests say so and pass.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::LazyLock;

use glint_bake::input::{ColourSpace, InputOptions, LoadedMap, load_normal_map};
use glint_bake_core::normal_map::{GreenAxis, NormalMap, NormalOptions, NormalReport, RawNormals};
use glint_formats::Wrap;

/// Files that carry an sRGB tag, though their values are linear.
const TAGGED_SRGB: [&str; 2] = ["ground037_ambientcg_rgba_roughness.png", "leather_008_3dtextures_16bit.png"];

/// Files that do not tile, by eye and by how they were made (crops, and photographs that were cut).
const WITH_SEAM: [&str; 7] = [
    "brushed_aluminium_godot_745.png",
    "diamond_plate_pmndrs0008.jpg",
    "hammered_pebbles_pmndrs0015.jpg",
    "wood_grain_pmndrs0019.jpg",
    "riverbed_rock_polyhaven_gl_512_16bit.png",
    "riverbed_rock_polyhaven_gl_256_16bit.tif",
    "riverbed_rock_polyhaven_gl_512_zip.exr",
];

/// One line of the catalogue.
struct Row(HashMap<String, String>);

impl Row {
    fn text(&self, column: &str) -> &str {
        &self.0[column]
    }

    fn number(&self, column: &str) -> f64 {
        self.text(column).parse().unwrap()
    }

    fn path(&self) -> PathBuf {
        data().join(self.text("path"))
    }

    fn is(&self, kind: &str) -> bool {
        self.text("kind").split('/').next() == Some(kind)
    }
}

fn data() -> PathBuf {
    let default = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    std::env::var_os("GLINT_DATA").map(PathBuf::from).unwrap_or_else(default)
}

/// The catalogue's rows of one kind: "normal", "tiny" or "height". None without the folder.
fn catalogue(kind: &str) -> Vec<Row> {
    let path = data().join("SOURCES.tsv");
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: no {} (set GLINT_DATA)", path.display());
        return Vec::new();
    };
    let mut lines = text.lines().map(|line| line.split('\t').map(str::to_owned));
    let columns: Vec<String> = lines.next().unwrap().collect();
    let rows = lines.map(|cells| Row(columns.iter().cloned().zip(cells).collect()));
    rows.filter(|row| row.is(kind)).collect()
}

fn options() -> InputOptions {
    InputOptions { colour_space: ColourSpace::Linear, ..InputOptions::default() }
}

/// All full-size normal maps, loaded once: decoding is slow in a debug build.
static NORMALS: LazyLock<Vec<(Row, LoadedMap)>> = LazyLock::new(|| load_all("normal"));

fn load_all(kind: &str) -> Vec<(Row, LoadedMap)> {
    let load = |row: Row| {
        let loaded = load_normal_map(&row.path(), &options()).unwrap();
        (row, loaded)
    };
    catalogue(kind).into_iter().map(load).collect()
}

fn find(name: &str) -> Option<&'static LoadedMap> {
    NORMALS.iter().map(|(_, loaded)| loaded).find(|loaded| loaded.digest.name == name)
}

/// The map's vectors, to be validated once more in another way.
fn vectors(map: &NormalMap) -> RawNormals {
    let lift = |&[x, y]: &[f32; 2]| [x, y, (1.0 - x * x - y * y).sqrt()];
    RawNormals { width: map.width, height: map.height, vectors: map.projected.iter().map(lift).collect() }
}

fn report_of(raw: &RawNormals, y: GreenAxis) -> NormalReport {
    NormalMap::from_vectors(raw, &NormalOptions { wrap: Wrap::Clamp, y }).unwrap().1
}

#[test]
fn measurements_agree_with_the_catalogue() {
    let tiny = load_all("tiny");
    for (row, loaded) in NORMALS.iter().chain(&tiny) {
        let (name, report) = (&loaded.digest.name, &loaded.report);
        assert_eq!(loaded.map.width as f64, row.number("width"), "{name}");
        assert_eq!(loaded.map.height as f64, row.number("height"), "{name}");
        assert_eq!(loaded.digest.bytes as f64, row.number("bytes"), "{name}");
        assert_eq!(report.below_horizon + report.zero_length, 0, "{name}");
        assert_eq!(row.number("z_le_0"), 0.0, "{name}");
        // Decoders of JPEG differ in the last bits.
        let close = |found: f64, column: &str, tolerance: f64| {
            assert!((found - row.number(column)).abs() < tolerance, "{name}: {column} {found}, {}", row.text(column));
        };
        close(report.off_unit as f64 / report.texels as f64, "off_unit_gt1pct", 0.02);
        close(report.min_length, "len_min", 0.01);
        close(report.max_length, "len_max", 0.01);
        close(report.slope_std[0], "slope_sd_x", 0.001);
        close(report.slope_std[1], "slope_sd_y", 0.001);
        for s in &loaded.map.projected {
            assert!(s[0].hypot(s[1]) < 1.0, "{name}: {s:?}");
        }
    }
}

#[test]
fn flipped_green_is_suspected_where_the_catalogue_says_so() {
    for (row, loaded) in NORMALS.iter() {
        let convention = row.text("green_convention");
        // A polished plate whose slopes are half an 8-bit step: nobody could tell.
        let nearly_flat = row.text("path").contains("metal049a");
        let directx = convention.starts_with("DirectX") && !nearly_flat;
        let opengl = convention.starts_with("OpenGL") && !nearly_flat;
        let name = &loaded.digest.name;
        assert_eq!(loaded.report.flipped_green_suspected, directx, "{name} as +Y up");
        assert_eq!(loaded.warnings.iter().any(|w| w.contains("--normal-y down")), directx, "{:?}", loaded.warnings);
        let down = report_of(&vectors(&loaded.map), GreenAxis::Down);
        assert_eq!(down.flipped_green_suspected, opengl, "{name} as +Y down");
    }
}

#[test]
fn crops_of_right_maps_raise_no_false_alarm() {
    let side = 64;
    let (mut crops, mut false_alarms) = (0, 0);
    for (row, loaded) in NORMALS.iter() {
        if row.text("green_convention").starts_with("DirectX") {
            continue;
        }
        let raw = vectors(&loaded.map);
        for y in (0..(raw.height / side) * side).step_by(side as usize) {
            for x in (0..(raw.width / side) * side).step_by(side as usize) {
                let report = report_of(&raw.crop(x, y, side, side).unwrap(), GreenAxis::Up);
                crops += 1;
                false_alarms += u32::from(report.flipped_green_suspected);
            }
        }
    }
    println!("{false_alarms} false alarms in {crops} crops");
    assert_eq!(false_alarms, 0, "in {crops} crops");
}

#[test]
fn seams_are_seen_where_they_are() {
    for (_, loaded) in NORMALS.iter() {
        let expected = WITH_SEAM.contains(&loaded.digest.name.as_str());
        assert_eq!(loaded.report.seam_suspected, expected, "{}: {:?}", loaded.digest.name, loaded.report);
    }
}

#[test]
fn real_maps_are_taken_as_they_are_and_tags_noted() {
    for kind in ["normal", "tiny", "height"] {
        for row in catalogue(kind) {
            let height = (kind == "height").then_some(4.0);
            let loaded = load_normal_map(&row.path(), &InputOptions { height, ..InputOptions::default() }).unwrap();
            let linear = load_normal_map(&row.path(), &InputOptions { height, ..options() }).unwrap();
            let name = row.text("path");
            assert_eq!(loaded.map, linear.map, "{name}");
            let tagged = TAGGED_SRGB.iter().any(|tagged| name.ends_with(tagged));
            let noted = loaded.warnings.iter().any(|w| w.contains("carries an sRGB chunk"));
            assert_eq!(noted, tagged, "{name}: {:?}", loaded.warnings);
            assert!(!loaded.warnings.iter().any(|w| w.contains("look encoded")), "{name}: {:?}", loaded.warnings);
        }
    }
}

#[test]
fn the_same_picture_in_another_format_is_the_same_map() {
    let pair = |a: &str, b: &str| Some((find(a)?, find(b)?));
    if let Some((png, tga)) = pair("wicker_khronos_512.png", "wicker_khronos_512.tga") {
        assert_eq!(png.map, tga.map);
        assert_ne!(png.digest, tga.digest);
    }
    if let Some((png, exr)) = pair("riverbed_rock_polyhaven_gl_512_16bit.png", "riverbed_rock_polyhaven_gl_512_zip.exr")
    {
        let step = |(a, b): (&[f32; 2], &[f32; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
        let worst = png.map.projected.iter().zip(&exr.map.projected).map(step).fold(0.0, f32::max);
        // The PNG is clipped at 1, the EXR is not.
        assert!(worst < 0.05, "{worst}");
    }
}

#[test]
fn heights_give_a_surface_like_the_normals_made_from_them() {
    let Some(heights) = catalogue("height").into_iter().next() else { return };
    let loaded = load_normal_map(&heights.path(), &InputOptions { height: Some(8.0), ..options() }).unwrap();
    assert_eq!((loaded.map.width, loaded.map.height), (1024, 1024));
    assert!(loaded.report.curl_correlation.unwrap() > 0.999);
    // The normals that their maker painted from these heights, which are DirectX.
    let painted = &find("leather_008_3dtextures.jpg").unwrap().map;
    let correlation = |axis: usize| {
        let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
        for (a, b) in loaded.map.projected.iter().zip(&painted.projected) {
            let (a, b) = (a[axis] as f64, b[axis] as f64);
            (ab, aa, bb) = (ab + a * b, aa + a * a, bb + b * b);
        }
        ab / (aa * bb).sqrt()
    };
    let (x, y_as_up) = (correlation(0), correlation(1));
    assert!(x > 0.4 && y_as_up < -0.8, "x {x}, y {y_as_up}");
}
