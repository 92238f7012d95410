//! Radiance HDR as programs write it: magics, headers, run lengths, orders of pixels, colours; and how much memory it takes.

use crate::support::{bake, info, json, root};
use glint_bake::input::environment::{LoadedEnvironment, load_environment};
use std::fs;
use std::path::{Path, PathBuf};

const LIMIT: u64 = 4 << 30;
const WIDTH: usize = 16;
const HEIGHT: usize = 8;

/// A picture of which no two pixels are alike.
fn pixel(x: usize, y: usize) -> [u8; 4] {
    [128 + x as u8, 10 * y as u8, (7 * x + 3 * y) as u8, 120 + ((x + y) % 16) as u8]
}

fn rows() -> Vec<Vec<[u8; 4]>> {
    (0..HEIGHT).map(|y| (0..WIDTH).map(|x| pixel(x, y)).collect()).collect()
}

/// A file of flat scanlines.
fn file(header: &str, size: &str, scanlines: &[Vec<[u8; 4]>]) -> Vec<u8> {
    let mut bytes = format!("{header}\n{size}\n").into_bytes();
    scanlines.iter().flatten().for_each(|pixel| bytes.extend(pixel));
    bytes
}

fn usual(header: &str) -> Vec<u8> {
    file(header, "-Y 8 +X 16", &rows())
}

fn loaded(folder: &Path, bytes: &[u8]) -> LoadedEnvironment {
    let path = folder.join("sky.hdr");
    fs::write(&path, bytes).unwrap();
    load_environment(&path, None, LIMIT).unwrap()
}

/// Pixels as the image crate decodes them.
fn decoded_by_others(bytes: &[u8]) -> Vec<[f32; 3]> {
    let image = image::load_from_memory_with_format(bytes, image::ImageFormat::Hdr).unwrap();
    image.into_rgb32f().pixels().map(|pixel| pixel.0).collect()
}

fn same_bits(a: &[[f32; 3]], b: &[[f32; 3]]) -> bool {
    a.len() == b.len() && a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// The folder of cases, or None (said on stderr) where there is none.
fn data(folder: &str) -> Option<PathBuf> {
    let data = std::env::var("GLINT_DATA").map_or(root().join("../shared/data"), Into::into).join(folder);
    if data.is_dir() {
        return Some(data);
    }
    eprintln!("skipped: {} is not there; set GLINT_DATA", data.display());
    None
}

#[test]
fn files_of_the_table_are_read() {
    let Some(cases) = data("cases") else { return };
    let folder = tempfile::tempdir().unwrap();
    for (name, said) in [("rgbe_magic.hdr", None), ("exposure_comma.hdr", Some("EXPOSURE is \"1,5\""))] {
        let file = cases.join(name);
        let flags = ["environment", file.to_str().unwrap(), "-o", "out.glintpack", "--face-size", "8"];
        let done = bake(folder.path(), &flags).ok();
        assert_eq!(done.stderr.contains("EXPOSURE"), said.is_some(), "{name}: {}", done.stderr);
        let report = json(&info(folder.path(), &["out.glintpack", "--json"]).ok().stdout);
        let notes = report["provenance"][0]["notes"].as_array().unwrap();
        assert_eq!(notes.len(), usize::from(said.is_some()), "{name}: {notes:?}");
        assert!(said.is_none_or(|said| notes[0].as_str().unwrap().contains(said)), "{name}: {notes:?}");
        // All else is as the usual magic and no exposure have it.
        let text = fs::read(&file).unwrap();
        let data = &text[text.len() - 4 * 32 * 16..];
        let plain = [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n", data].concat();
        assert!(
            same_bits(&load_environment(&file, None, LIMIT).unwrap().image.pixels, &decoded_by_others(&plain)),
            "{name}"
        );
    }
}

/// Whatever a header says that does not concern pixels, they are the same; what is not used is said.
#[test]
fn headers_of_many_programs_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let expected = decoded_by_others(&usual("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"));
    let f = "FORMAT=32-bit_rle_rgbe\n";
    for (header, said) in [
        (format!("#?RADIANCE\n{f}"), &[][..]),
        (format!("#?RGBE\n{f}"), &[]),
        (format!("#?AUTOPANO\n# by hand\n{f}"), &[]),
        (format!("#?\n{f}"), &[]),
        (format!("#?RADIANCE\r\n{}\r\n", f.replace('\n', "\r\n").trim_end()), &[]),
        (format!("#?RADIANCE\npfilt -1 sky.pic\nVIEW= -vta -vp 0 0 0\nSOFTWARE=\nGAMMA=one\n=\n{f}"), &[]),
        (format!("#?RADIANCE\n\tEXPOSURE=4\n\tCOLORCORR=2 1 1\n{f}"), &[]),
        (format!("#?RADIANCE\n\u{fc}\u{0}=\u{1}\n{f}"), &[]),
        (format!("#?RADIANCE\nPRIMARIES=0 0 0 0 0 0 0 0\n{f}"), &[]),
        (format!("#?RADIANCE\nPRIMARIES=0.64 0.33 0.30 0.60 0.15 0.06 0.3127 0.3290\n{f}"), &[]),
        (format!("#?RADIANCE\nEXPOSURE=2\nEXPOSURE=  2.5 \n{f}"), &["an exposure of 5; radiance is taken as it is"]),
        (format!("#?RADIANCE\nEXPOSURE=1,5\n{f}"), &["EXPOSURE is \"1,5\", expected a number above 0"]),
        (format!("#?RADIANCE\nEXPOSURE=\nEXPOSURE=-1\n{f}"), &["EXPOSURE is \"\"", "EXPOSURE is \"-1\""]),
        (format!("#?RADIANCE\nPIXASPECT=0.5\n{f}"), &["0.5 times as high as wide"]),
        (format!("#?RADIANCE\nPIXASPECT=square\n{f}"), &["PIXASPECT is \"square\""]),
        (format!("#?RADIANCE\nCOLORCORR=1 2\n{f}"), &["COLORCORR is \"1 2\", expected three numbers"]),
        (format!("#?RADIANCE\nPRIMARIES=Rec709\n{f}"), &["PRIMARIES is \"Rec709\""]),
        (format!("#?RADIANCE\nPRIMARIES=.1 .1 .2 .2 .3 .3 .3 .3\n{f}"), &["span no colours"]),
        ("#?RADIANCE\n".to_owned(), &["names no FORMAT; pixels are taken as RGBE"]),
    ] {
        let end = if header.contains('\r') { "" } else { "\n" };
        let bytes = if end.is_empty() {
            let body = file("", "", &rows())[2..].to_vec();
            [format!("{header}\r\n-Y 8 +X 16\r\n").into_bytes(), body].concat()
        } else {
            usual(&header)
        };
        let found = loaded(folder.path(), &bytes);
        assert!(same_bits(&found.image.pixels, &expected), "{header}");
        assert_eq!(found.warnings.len(), said.len(), "{header}: {:?}", found.warnings);
        for (warning, said) in found.warnings.iter().zip(said) {
            assert!(warning.contains(said), "{header}: {warning}");
        }
    }
}

/// The first axis goes from scanline to scanline.
#[test]
fn all_eight_orders_of_pixels_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";
    let expected = decoded_by_others(&usual(header));
    for (y_sign, x_sign) in [('-', '+'), ('-', '-'), ('+', '+'), ('+', '-')] {
        let x_of = |k: usize| if x_sign == '+' { k } else { WIDTH - 1 - k };
        let y_of = |k: usize| if y_sign == '-' { k } else { HEIGHT - 1 - k };
        let by_rows: Vec<Vec<[u8; 4]>> =
            (0..HEIGHT).map(|j| (0..WIDTH).map(|i| pixel(x_of(i), y_of(j))).collect()).collect();
        let by_columns: Vec<Vec<[u8; 4]>> =
            (0..WIDTH).map(|i| (0..HEIGHT).map(|j| pixel(x_of(i), y_of(j))).collect()).collect();
        for (size, scanlines) in
            [(format!("{y_sign}Y 8 {x_sign}X 16"), by_rows), (format!("{x_sign}X 16 {y_sign}Y 8"), by_columns)]
        {
            let found = loaded(folder.path(), &file(header, &size, &scanlines));
            assert_eq!((found.image.width, found.image.height), (16, 8), "{size}");
            assert!(same_bits(&found.image.pixels, &expected), "{size}");
        }
    }
}

/// Flat, run lengths of pixels, run lengths of components, all mixed in a file.
#[test]
fn all_forms_of_scanlines_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n";
    let (a, b) = ([200, 100, 50, 130], [3, 4, 250, 127]);
    let mut bytes = header.to_vec();
    for y in 0..8 {
        match y % 3 {
            0 => bytes.extend([a, [1, 1, 1, 13], b, b].concat()),
            1 => (0..16).for_each(|i| bytes.extend(if i < 14 { a } else { b })),
            _ => {
                bytes.extend([2, 2, 0, 16]);
                for c in 0..4 {
                    bytes.extend([128 + 13, a[c], 3, a[c], b[c], b[c]]);
                }
            }
        }
    }
    let found = loaded(folder.path(), &bytes);
    assert_eq!(found.warnings, Vec::<String>::new());
    let flat: Vec<Vec<[u8; 4]>> = vec![(0..16).map(|i| if i < 14 { a } else { b }).collect(); 8];
    let expected = decoded_by_others(&file("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n", "-Y 8 +X 16", &flat));
    assert!(same_bits(&found.image.pixels, &expected));
    // A file that goes on says so; an end of line does not count.
    bytes.extend(b"\r\n");
    assert_eq!(loaded(folder.path(), &bytes).warnings, Vec::<String>::new());
    bytes.extend(b"more");
    assert!(loaded(folder.path(), &bytes).warnings[0].contains("goes on for 6 bytes after its last scanline"));
}

/// Every mantissa with every exponent, and every image of the shared data, bit for bit as another decoder has them.
#[test]
fn values_are_those_of_other_decoders() {
    let folder = tempfile::tempdir().unwrap();
    let header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";
    // Up to radiances that an environment may have.
    let scanlines: Vec<Vec<[u8; 4]>> =
        (0..128u8).map(|e| (0..=255u8).map(|m| [m, 255 - m, m / 2, e + 32]).collect()).collect();
    let bytes = file(header, "-Y 128 +X 256", &scanlines);
    assert!(same_bits(&loaded(folder.path(), &bytes).image.pixels, &decoded_by_others(&bytes)));
    let Some(hdri) = data("hdri") else { return };
    for entry in fs::read_dir(hdri).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "hdr") {
            let found = load_environment(&path, None, LIMIT).unwrap();
            assert!(
                same_bits(&found.image.pixels, &decoded_by_others(&fs::read(&path).unwrap())),
                "{}",
                path.display()
            );
        }
    }
}

/// Colours that a header names are converted and said; expected values are those of matrix products by hand.
#[test]
fn colours_are_those_of_rec_709() {
    let folder = tempfile::tempdir().unwrap();
    let of = |header: &str, rgbe: [u8; 4]| {
        let found = loaded(folder.path(), &file(header, "-Y 8 +X 16", &vec![vec![rgbe; WIDTH]; HEIGHT]));
        (found.image.pixels[17], found.warnings)
    };
    let rgbe = "FORMAT=32-bit_rle_rgbe\n";
    // (1, 0.5, 0.25), and (1, 1, 0.5) as XYZ.
    let (rgb, xyz) = ([128, 64, 32, 129], [128, 128, 64, 129]);
    for (header, stored, expected, said) in [
        (format!("#?RADIANCE\nCOLORCORR=2 1 .5\n{rgbe}"), rgb, [0.5, 0.5, 0.5], "COLORCORR) of 2 1 0.5 was undone"),
        (format!("#?RADIANCE\nCOLORCORR=2 1 .5\nCOLORCORR=1 2 1\n{rgbe}"), rgb, [0.5, 0.25, 0.5], "2 2 0.5 was undone"),
        (
            format!("#?RADIANCE\nPRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329\n{rgbe}"),
            rgb,
            [1.34846, 0.43981, 0.21124],
            "converted to Rec. 709 from Rec. 2020",
        ),
        (
            "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n".to_owned(),
            xyz,
            [1.24010, 0.98012, 0.42452],
            "converted to Rec. 709 from CIE XYZ",
        ),
    ] {
        let (found, warnings) = of(&header, stored);
        assert!(warnings[0].contains(said) && warnings.len() == 1, "{header}: {warnings:?}");
        for c in 0..3 {
            assert!((found[c] - expected[c]).abs() < 2e-4, "{header}: {found:?}");
        }
    }
    // What has equal X, Y and Z is grey, and what a wide gamut has beyond Rec. 709 is counted as negative.
    let (grey, _) = of("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n", [128, 128, 128, 129]);
    assert!(grey.iter().all(|c| (c - 1.0).abs() < 1e-6), "{grey:?}");
    let wide = format!("#?RADIANCE\nPRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329\n{rgbe}");
    let (_, warnings) = of(&wide, [0, 128, 0, 129]);
    assert!(warnings[1].contains("128 pixels are negative"), "{warnings:?}");
    let both = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\nCOLORCORR=2 1 .5\nPRIMARIES=.64 .33 .3 .6 .15 .06 .31 .33\n";
    let (_, warnings) = of(both, [128, 128, 128, 129]);
    assert!(warnings.iter().filter(|w| w.contains("which CIE XYZ has not")).count() == 2, "{warnings:?}");
}

#[test]
fn what_cannot_be_read_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";
    let whole = usual(header);
    let start = whole.len() - 4 * WIDTH * HEIGHT;
    let mut first_run = whole.clone();
    first_run[start..start + 4].copy_from_slice(&[1, 1, 1, 9]);
    let mut wrong_length = whole.clone();
    wrong_length[start..start + 4].copy_from_slice(&[2, 2, 0, 17]);
    let run_place = format!("byte {start}, in scanline 1 of 8: expected a pixel");
    let length_place = format!("byte {start}, in scanline 1 of 8: expected a scanline of 16 pixels, found one of 17");
    let cases: [(&str, Vec<u8>, i32, &str); 12] = [
        ("cut", whole[..whole.len() - 1].to_vec(), 4, "cut off: it ends in scanline 8 of 8"),
        ("short", whole[..start + 9].to_vec(), 4, "cut off: 9 bytes cannot hold 8 scanlines of 16 pixels"),
        ("header", whole[..20].to_vec(), 4, "cut off: its header"),
        ("run", first_run, 4, &run_place),
        ("length", wrong_length, 4, &length_place),
        ("size", file(header, "-Y eight +X 16", &[]), 4, "damaged at byte 35: expected the size as"),
        ("same-axis", file(header, "-Y 8 +Y 16", &[]), 4, "expected the size"),
        ("empty", file(header, "-Y 0 +X 16", &rows()), 4, "0"),
        ("huge", file(header, "-Y 99999 +X 199998", &rows()), 6, "at most 16384"),
        ("spectra", file("#?RADIANCE\nFORMAT=Radiance_spectra\n", "-Y 8 +X 16", &rows()), 5, "Radiance_spectra"),
        ("two", file(&format!("{header}FORMAT=32-bit_rle_xyze\n"), "-Y 8 +X 16", &rows()), 4, "two values of FORMAT"),
        ("binary", [b"#?".to_vec(), (0..=255).cycle().skip(9).take(4000).collect()].concat(), 4, "cut off: its header"),
    ];
    for (name, bytes, code, part) in cases {
        let name = format!("{name}.hdr");
        fs::write(folder.path().join(&name), bytes).unwrap();
        let refused = bake(folder.path(), &["environment", &name, "-o", "out.glintpack"]);
        assert_eq!(refused.code, code, "{name}: {}", refused.stderr);
        assert!(refused.stderr.contains(&name) && refused.stderr.contains(part), "{name}: {}", refused.stderr);
    }
    // Any byte may be wrong, and the file may end anywhere.
    for at in 0..whole.len() {
        let mut changed = whole.clone();
        changed[at] ^= 0xd5;
        let path = folder.path().join("changed.hdr");
        fs::write(&path, &changed).unwrap();
        let _ = load_environment(&path, None, LIMIT);
        fs::write(&path, &whole[..at]).unwrap();
        assert!(load_environment(&path, None, LIMIT).is_err(), "{at}");
    }
}

/// A panorama of one colour a row, as run lengths of components.
fn write_panorama(path: &Path, width: usize, height: usize) {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    for y in 0..height {
        bytes.extend([2, 2, (width >> 8) as u8, width as u8]);
        for value in [128, 140, (y * 255 / height) as u8, 128] {
            let mut left = width;
            while left > 0 {
                let count = left.min(127);
                bytes.extend([128 + count as u8, value]);
                left -= count;
            }
        }
    }
    fs::write(path, bytes).unwrap();
}

/// MiB of memory that a dry run says.
fn said_mib(stderr: &str) -> f64 {
    let (_, after) = stderr.split_once("with about ").unwrap();
    let (kib, _) = after.split_once(" KiB").unwrap();
    kib.replace(',', "").parse::<f64>().unwrap() / 1024.0
}

#[test]
fn large_panoramas_fit_the_default_limit() {
    let folder = tempfile::tempdir().unwrap();
    for (width, most) in [(8192, 1024.0), (16384, 4096.0)] {
        write_panorama(&folder.path().join("sky.hdr"), width, width / 2);
        let done = bake(folder.path(), &["environment", "sky.hdr", "-o", "out.glintpack", "-n", "-j", "2"]).ok();
        let said = said_mib(&done.stderr);
        // The pixels alone have 12 bytes each.
        let pixels = (width * width / 2 * 12) as f64 / (1 << 20) as f64;
        assert!(said > pixels && said < most, "{width}: {}", done.stderr);
    }
}

/// The most memory that a bake holds, as the system counts it, is what the dry run says.
#[cfg(target_os = "linux")]
#[test]
fn a_bake_holds_what_its_dry_run_says() {
    let folder = tempfile::tempdir().unwrap();
    write_panorama(&folder.path().join("sky.hdr"), 4096, 2048);
    let flags =
        ["environment", "sky.hdr", "-o", "out.glintpack", "-j", "2", "--measure", "0", "--min-face-size", "128"];
    let said = said_mib(&bake(folder.path(), &[&flags[..], &["-n"]].concat()).ok().stderr);
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("glint-bake"))
        .current_dir(folder.path())
        .args([&flags[..], &["-q"]].concat())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut held = 0.0f64;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let peak =
            text.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse::<f64>().ok());
        held = held.max(peak.unwrap_or(0.0) / 1024.0);
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert!(child.wait().unwrap().success());
    assert!(held > 0.8 * said && held < 1.2 * said, "held {held:.0} MiB, said {said:.0} MiB");
}
