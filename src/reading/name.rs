//! By which name what was read is known: that of its file, or one that does not depend on which pipe it came through.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use super::stream::is_standard;

/// Name of a file without folders. Standard input is `stdin`, and a pipe that a shell has made is `pipe`: its number
/// differs from run to run.
pub fn file_name(path: &Path) -> OsString {
    if is_standard(path) || path == Path::new("/dev/stdin") {
        return "stdin".into();
    }
    let is_descriptor = |folder: &Path| {
        folder == Path::new("/dev/fd") || (folder.starts_with("/proc") && folder.file_name() == Some(OsStr::new("fd")))
    };
    if path.parent().is_some_and(is_descriptor) {
        return "pipe".into();
    }
    path.file_name().unwrap_or_default().to_owned()
}

/// The name as a pack records it, and a note when it is another one: packs are read on systems where a backslash
/// separates folders, names are printed, and text in packs is UTF-8.
pub fn recorded_name(path: &Path) -> (String, Option<String>) {
    let name = file_name(path);
    let recorded: String =
        name.to_string_lossy().chars().map(|c| if c == '\\' || c.is_control() { '_' } else { c }).collect();
    let note = (OsStr::new(&recorded) != name).then(|| {
        format!("the pack records the file's name as {recorded:?}: names in packs are UTF-8 without backslashes and control characters")
    });
    (recorded, note)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_have_names_that_do_not_change() {
        for (path, name) in [
            ("-", "stdin"),
            ("/dev/stdin", "stdin"),
            ("/dev/fd/63", "pipe"),
            ("/proc/self/fd/12", "pipe"),
            ("./-", "-"),
            ("maps/a.png", "a.png"),
            ("/", ""),
        ] {
            assert_eq!(file_name(Path::new(path)), name, "{path}");
        }
    }

    #[test]
    fn names_are_recorded_as_every_system_can_have_them() {
        assert_eq!(recorded_name(Path::new("maps/a b|c.png")), ("a b|c.png".to_owned(), None));
        #[cfg(unix)]
        for (name, recorded) in [
            (&b"back\\slash.png"[..], "back_slash.png"),
            (b"a\nb\x1b[31m", "a_b_[31m"),
            (b"\xff\xfe.png", "\u{fffd}\u{fffd}.png"),
        ] {
            use std::os::unix::ffi::OsStrExt;
            let (found, note) = recorded_name(Path::new(OsStr::from_bytes(name)));
            assert_eq!(found, recorded);
            assert!(note.unwrap().contains("UTF-8"));
        }
    }
}
