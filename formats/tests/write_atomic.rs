//! Files are put in place whole, left alone when equal, and kept when writing fails.

use glint_formats::{WriteOutcome, write_atomic};
use std::fs;
use std::path::Path;

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn new_and_changed_files_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glintpack");
    assert_eq!(write_atomic(&path, b"one").unwrap(), WriteOutcome::Written);
    assert_eq!(fs::read(&path).unwrap(), b"one");
    assert_eq!(write_atomic(&path, b"two").unwrap(), WriteOutcome::Written);
    assert_eq!(fs::read(&path).unwrap(), b"two");
    assert_eq!(write_atomic(&path, b"longer").unwrap(), WriteOutcome::Written);
    assert_eq!(fs::read(&path).unwrap(), b"longer");
    assert_eq!(names_in(folder.path()), ["a.glintpack"]);
}

#[test]
fn an_equal_file_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glintpack");
    let bytes = vec![7; 200_000];
    write_atomic(&path, &bytes).unwrap();
    let before = fs::metadata(&path).unwrap().modified().unwrap();
    assert_eq!(write_atomic(&path, &bytes).unwrap(), WriteOutcome::Unchanged);
    assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), before);
    let empty = folder.path().join("empty");
    assert_eq!(write_atomic(&empty, b"").unwrap(), WriteOutcome::Written);
    assert_eq!(write_atomic(&empty, b"").unwrap(), WriteOutcome::Unchanged);
}

#[test]
fn a_missing_folder_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    assert!(write_atomic(&folder.path().join("missing").join("a"), b"one").is_err());
    assert!(names_in(folder.path()).is_empty());
}

#[test]
fn a_folder_in_the_way_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glintpack");
    fs::create_dir(&path).unwrap();
    fs::write(path.join("inside"), b"kept").unwrap();
    assert!(write_atomic(&path, b"one").is_err());
    assert_eq!(fs::read(path.join("inside")).unwrap(), b"kept");
    assert_eq!(names_in(folder.path()), ["a.glintpack"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_write_that_fails_keeps_the_old_file() {
    // No file can be made in /proc, not even by root, so the temporary file fails.
    let old = fs::read("/proc/version").unwrap();
    assert!(write_atomic(Path::new("/proc/version"), b"new").is_err());
    assert_eq!(fs::read("/proc/version").unwrap(), old);
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::os::unix::fs::{PermissionsExt, symlink};

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn permissions_are_those_of_other_new_files_or_of_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let (path, other) = (folder.path().join("a"), folder.path().join("b"));
        write_atomic(&path, b"one").unwrap();
        fs::write(&other, b"one").unwrap();
        assert_eq!(mode(&path), mode(&other) & 0o644);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        write_atomic(&path, b"two").unwrap();
        assert_eq!(mode(&path), 0o640);
    }

    #[test]
    fn a_link_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        fs::write(&target, b"one").unwrap();
        symlink(&target, &link).unwrap();
        assert_eq!(write_atomic(&link, b"two").unwrap(), WriteOutcome::Written);
        assert_eq!(fs::read(&target).unwrap(), b"two");
        assert!(fs::symlink_metadata(&link).unwrap().file_type().is_symlink());
    }
}
