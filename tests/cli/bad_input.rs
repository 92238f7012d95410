//! Bad arguments and bad inputs: the documented code, a message that names file and cause, an untouched output.

use crate::support::{bake, maps};
use std::fs;
use std::path::Path;
use std::time::SystemTime;

/// Bakes over an existing pack, which must survive; gives code and message.
#[track_caller]
fn fails(folder: &Path, args: &[&str]) -> (i32, String) {
    let path = folder.join("old.glintpack");
    fs::write(&path, b"an older pack").unwrap();
    let stamp = |path: &Path| -> SystemTime { fs::metadata(path).unwrap().modified().unwrap() };
    let before = stamp(&path);
    let files = fs::read_dir(folder).unwrap().count();
    let done = bake(folder, &[&["ndf-maps", "-o", "old.glintpack"], args].concat());
    assert_ne!(done.code, 0, "{}", done.stderr);
    assert!(done.stdout.is_empty(), "{}", done.stdout);
    assert_eq!(fs::read(&path).unwrap(), b"an older pack");
    assert_eq!(stamp(&path), before);
    assert_eq!(fs::read_dir(folder).unwrap().count(), files, "something was left behind");
    (done.code, done.stderr)
}

/// A PNG with the header of any size and no pixels.
fn png_of_size(width: u32, height: u32) -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend(width.to_be_bytes());
    header.extend(height.to_be_bytes());
    header.extend([8, 2, 0, 0, 0]);
    let mut out = b"\x89PNG\r\n\x1a\n".to_vec();
    for chunk in [header, b"IEND".to_vec()] {
        out.extend((chunk.len() as u32 - 4).to_be_bytes());
        out.extend(&chunk);
        out.extend(crc32(&chunk).to_be_bytes());
    }
    out
}

fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

/// Puts a chunk behind the header of a PNG.
pub fn with_chunk(png: &[u8], kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let chunk = [&kind[..], content].concat();
    let mut out = png[..33].to_vec();
    out.extend((content.len() as u32).to_be_bytes());
    out.extend(&chunk);
    out.extend(crc32(&chunk).to_be_bytes());
    out.extend(&png[33..]);
    out
}

#[test]
fn bad_inputs_have_their_code_and_name_file_and_cause() {
    let folder = maps();
    let path = |name: &str| folder.path().join(name);
    let good = fs::read(path("flakes.png")).unwrap();
    fs::write(path("empty.png"), b"").unwrap();
    fs::write(path("cut.png"), &good[..good.len() / 2]).unwrap();
    fs::write(path("text.png"), b"this is not an image at all").unwrap();
    fs::write(path("zero.png"), png_of_size(0, 0)).unwrap();
    fs::write(path("wide.png"), png_of_size(100_000, 1)).unwrap();
    image::RgbImage::new(8, 8).save(path("black.png")).unwrap();
    let nan = |x: usize, y: usize| if (x, y) == (3, 2) { (f32::NAN, 0.0, 1.0) } else { (0.0, 0.0, 1.0) };
    exr::prelude::write_rgb_file(path("nan.exr"), 8, 8, nan).unwrap();
    fs::create_dir(path("folder.png")).unwrap();
    fs::write(path("dds.png"), b"DDS and then whatever follows").unwrap();
    image::RgbImage::from_pixel(256, 256, image::Rgb([128, 128, 255])).save(path("large.png")).unwrap();
    for (name, code, cause) in [
        ("missing.png", 3, "cannot be read"),
        ("folder.png", 3, "folder"),
        ("empty.png", 4, "empty"),
        ("cut.png", 4, "cut off"),
        ("text.png", 4, "no image"),
        ("zero.png", 4, "0×0"),
        ("black.png", 4, "not a normal map"),
        ("nan.exr", 4, "texel (3, 2)"),
        ("dds.png", 5, "DDS"),
        ("wide.png", 6, "100000"),
        ("large.png", 6, "--crop"),
    ] {
        let (found, message) = fails(folder.path(), &[name]);
        assert_eq!(found, code, "{name}: {message}");
        assert!(message.contains(name), "{name}: {message}");
        assert!(message.contains(cause), "{name}: {message}");
    }
}

#[test]
fn bad_arguments_are_usage_errors() {
    let folder = maps();
    for (args, cause) in [
        (&["flakes.png", "--roughness", "0"][..], "--roughness"),
        (&["flakes.png", "--roughness", "3"], "--roughness"),
        (&["flakes.png", "--max-error", "nan"], "--max-error"),
        (&["flakes.png", "--finest-window", "0"], "--finest-window"),
        (&["flakes.png", "--crop", "0x8+0+0"], "--crop"),
        (&["flakes.png", "--name", "a", "--name", "b"], "--name"),
        (&["flakes.png", "scratches.png", "--name", "a", "--name", "a"], "given twice"),
        (&["flakes.png", "--layers", "flakes:gold"], "--layers"),
        (&["flakes.png", "--transforms", "rotate=0..90"], "--placement stochastic"),
        (&["flakes.png", "--transforms", "spin=3"], "spin=3"),
        (&["flakes.png", "--placement", "stochastic", "--cells", "3"], "--cells"),
        (&["flakes.png", "--placement", "stochastic", "--spacing", "99"], "--spacing"),
        (&["flakes.png", "--placement", "stochastic", "--transforms", "stretch=9"], "flakes.png"),
        (&["flakes.png", "-q", "-v"], "cannot be used with"),
        (&["flakes.png", "--dry-run", "--json"], "cannot be used with"),
        (&["flakes.png", "--report", "flakes.png"], "flakes.png"),
        (&["flakes.png", "--report", "old.glintpack"], "old.glintpack"),
        (&[], "MAP"),
    ] {
        let (code, message) = fails(folder.path(), args);
        assert_eq!(code, 2, "{args:?}: {message}");
        assert!(message.contains(cause), "{args:?}: {message}");
    }
}

#[test]
fn a_crop_outside_the_map_is_named() {
    let folder = maps();
    let (code, message) = fails(folder.path(), &["flakes.png", "--crop", "8x8+4+0"]);
    assert!(code == 2 || code == 4, "{message}");
    assert!(message.contains("flakes.png") && message.contains("8×8"), "{message}");
}

#[test]
fn an_error_that_cannot_be_kept_is_a_limit() {
    let folder = maps();
    let (code, message) = fails(folder.path(), &["flakes.png", "--max-error", "1e-7"]);
    assert_eq!(code, 6, "{message}");
    assert!(message.contains("flakes.png") && message.contains("nothing was written"), "{message}");
    let (code, message) = fails(folder.path(), &["flakes.png", "--max-memory", "100"]);
    assert_eq!(code, 6, "{message}");
}

#[test]
fn outputs_are_checked_before_any_work() {
    let folder = maps();
    fs::create_dir(folder.path().join("dir")).unwrap();
    for (output, code, cause) in [
        ("none/out.glintpack", 3, "does not exist"),
        ("dir", 3, "folder"),
        ("flakes.png", 2, "an input as well"),
        ("./flakes.png", 2, "an input as well"),
    ] {
        let done = bake(folder.path(), &["ndf-maps", "flakes.png", "-o", output]);
        assert_eq!(done.code, code, "{output}: {}", done.stderr);
        assert!(done.stderr.contains(output) && done.stderr.contains(cause), "{}", done.stderr);
    }
}

/// Only where permissions bind: not as the superuser.
#[cfg(unix)]
#[test]
fn a_folder_that_takes_no_files_is_named() {
    use std::os::unix::fs::PermissionsExt;
    let folder = maps();
    let locked = folder.path().join("locked");
    fs::create_dir(&locked).unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(locked.join("probe"), b"").is_ok() {
        return eprintln!("skipped: this user may write everywhere");
    }
    let done = bake(folder.path(), &["ndf-maps", "flakes.png", "-o", "locked/out.glintpack"]);
    assert_eq!(done.code, 3, "{}", done.stderr);
}

/// `glint-bake … | head` closes the pipe early.
#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_failure() {
    use std::process::{Command, Stdio};
    let folder = maps();
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("glint-bake"))
        .current_dir(folder.path())
        .args(["ndf-maps", "flakes.png", "-o", "out.glintpack", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && !message.contains("panic"), "{message}");
}
