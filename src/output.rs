//! Where results go: standard output that may be closed, output paths checked before any work, dependency files.

use crate::exit::{Exit, Failure};
use glint_formats::{WriteOutcome, write_atomic};
use std::io::{ErrorKind, Write, stdout};
use std::path::{Path, PathBuf};
use std::sync::RwLock;

/// Prints to standard output. A reader that has gone, as `head` does, is no failure.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(Failure::new(Exit::InputOutput, format!("standard output cannot be written: {error}"))),
    }
}

/// Held while a temporary file lies in somebody's folder.
static WRITING: RwLock<()> = RwLock::new(());

/// Waits for files that are being written and lets no further ones begin. For a process that is about to end.
pub fn stop_writing() {
    std::mem::forget(WRITING.write());
}

/// Writes a file whole or not at all; one that has these bytes already is left alone.
pub fn write(path: &Path, bytes: &[u8]) -> Result<WriteOutcome, Failure> {
    let _writing = WRITING.read();
    write_atomic(path, bytes).map_err(|e| Failure::io(path, "cannot be written", &e))
}

/// Folder that a file lies in.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Says whether `path` can be written, before any work: its folder is there and takes a new file.
pub fn check_writable(path: &Path) -> Result<(), Failure> {
    let refuse = |what: String| Err(Failure::new(Exit::InputOutput, format!("{}: {what}", path.display())));
    if path.file_name().is_none() {
        return refuse("expected the name of a file to write, found none".into());
    }
    if path.is_dir() {
        return refuse("cannot be written: it is a folder; give a file name in it".into());
    }
    if path.exists() && !path.is_file() {
        return refuse("cannot be written: it is not a regular file".into());
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        return refuse(format!("cannot be written: the folder {} does not exist; create it first", folder.display()));
    }
    let _writing = WRITING.read();
    // Permission bits do not tell all (read-only mounts, access lists), so a file is made and removed.
    match tempfile::Builder::new().prefix(".glint-probe-").tempfile_in(folder) {
        Ok(probe) => probe.close().map_err(|e| Failure::io(folder, "cannot be written", &e)),
        Err(error) => Err(Failure::io(path, "cannot be written", &error)),
    }
}

/// Refuses an output that is one of the `inputs` or another output.
pub fn check_distinct(outputs: &[&Path], inputs: &[&Path]) -> Result<(), Failure> {
    let mut seen: Vec<(PathBuf, &str)> = inputs.iter().map(|path| (identity(path), "an input")).collect();
    for output in outputs {
        let id = identity(output);
        if let Some((_, role)) = seen.iter().find(|(other, _)| *other == id) {
            let message = format!("{}: is {role} as well; give another output path", output.display());
            return Err(Failure::usage(message));
        }
        seen.push((id, "another output"));
    }
    Ok(())
}

/// The same for every way of writing a path, whether the file is there yet or not.
fn identity(path: &Path) -> PathBuf {
    if let Ok(whole) = path.canonicalize() {
        return whole;
    }
    let folder = folder_of(path).canonicalize().unwrap_or_else(|_| folder_of(path).to_owned());
    folder.join(path.file_name().unwrap_or_default())
}

/// A dependency file in Make's syntax: `target: input input`.
pub fn depfile(target: &Path, inputs: &[&Path]) -> String {
    let mut text = escape(target);
    text.push(':');
    for input in inputs {
        text.push_str(" \\\n  ");
        text.push_str(&escape(input));
    }
    text.push('\n');
    text
}

/// Make's own rules: `$` doubles; spaces, `#`, `:` and the backslashes before a space take a backslash.
fn escape(path: &Path) -> String {
    let mut out = String::new();
    let mut backslashes = 0;
    for c in path.to_string_lossy().chars() {
        match c {
            '$' => out.push('$'),
            ' ' | '\t' => out.push_str(&"\\".repeat(backslashes + 1)),
            '#' => out.push('\\'),
            _ => {}
        }
        backslashes = if c == '\\' { backslashes + 1 } else { 0 };
        out.push(c);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depfiles_escape_what_make_would_misread() {
        let text = depfile(Path::new("out dir/a.glintpack"), &[Path::new("cost$.png"), Path::new("b#1.png")]);
        assert_eq!(text, "out\\ dir/a.glintpack: \\\n  cost$$.png \\\n  b\\#1.png\n");
    }

    #[test]
    fn the_same_file_is_found_under_another_spelling() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.png");
        std::fs::write(&path, b"x").unwrap();
        let other = folder.path().join("./map.png");
        assert_eq!(check_distinct(&[&other], &[&path]).unwrap_err().exit, Exit::Usage);
        let new = folder.path().join("new.glintpack");
        assert!(check_distinct(&[&new], &[&path]).is_ok());
        assert!(check_distinct(&[&new, &new], &[&path]).is_err());
    }
}
