//! Where results go: standard output that may be closed, output paths checked before any work.

use crate::exit::{Exit, Failure};
use crate::reading::is_standard;
use glint_formats::{WriteOutcome, write_atomic};
use std::io::{ErrorKind, IsTerminal, Write, stdout};
use std::path::{Path, PathBuf};
use std::sync::RwLock;

/// Prints to standard output. A reader that has gone, as `head` does, is no failure.
pub fn print(text: &str) -> Result<(), Failure> {
    print_bytes(text.as_bytes())
}

fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
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

/// Writes a file whole or not at all; one that has these bytes already is left alone. `-` is standard output.
pub fn write(path: &Path, bytes: &[u8]) -> Result<WriteOutcome, Failure> {
    if is_standard(path) {
        return print_bytes(bytes).map(|()| WriteOutcome::Written);
    }
    let _writing = WRITING.read();
    write_atomic(path, bytes).map_err(|e| Failure::io(path, "cannot be written", &e))
}

/// An output as messages name it.
pub fn shown(path: &Path) -> String {
    if is_standard(path) { "standard output".to_owned() } else { path.display().to_string() }
}

/// Makes a folder for results, and says whether it takes files.
pub fn create_folder(path: &Path) -> Result<(), Failure> {
    if is_standard(path) {
        return Err(Failure::usage(
            "-: expected a folder, since there are several files to write; one of this name is ./-",
        ));
    }
    std::fs::create_dir_all(path).map_err(|e| Failure::io(path, "cannot be created", &e))?;
    probe(path).map_err(|e| Failure::io(path, "cannot be written", &e))
}

/// Makes a file in a folder and removes it again: permission bits do not tell all (read-only mounts, access lists).
fn probe(folder: &Path) -> std::io::Result<()> {
    let _writing = WRITING.read();
    tempfile::Builder::new().prefix(".glint-probe-").tempfile_in(folder)?.close()
}

/// Folder that a file lies in.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Says whether `path` can be written, before any work: its folder is there and takes a new file, and a file that it
/// would replace may be replaced. `-` is standard output, unless that is a terminal.
pub fn check_writable(path: &Path) -> Result<(), Failure> {
    if is_standard(path) {
        return if stdout().is_terminal() {
            Err(Failure::usage("-: standard output is a terminal; send it to a file, as in `> FILE`, or name one"))
        } else {
            Ok(())
        };
    }
    let refuse = |what: &str| Err(Failure::new(Exit::InputOutput, format!("{}: {what}", path.display())));
    if path.file_name().is_none() {
        return refuse("expected the name of a file to write, found none");
    }
    let unusable = |error: &std::io::Error| Failure::io(path, "cannot be written", error);
    let target = match std::fs::symlink_metadata(path) {
        Ok(meta) if meta.is_symlink() => match path.canonicalize() {
            Ok(target) => target,
            Err(_) => return refuse("cannot be written: it is a link to a file that does not exist; remove it first"),
        },
        Ok(_) => path.to_owned(),
        // A name may be too long, or hold what the file system does not take.
        Err(error) if !matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Err(unusable(&error));
        }
        Err(_) => path.to_owned(),
    };
    if let Ok(meta) = std::fs::metadata(&target) {
        if meta.is_dir() {
            return refuse("cannot be written: it is a folder; give a file name in it");
        }
        if !meta.is_file() {
            return refuse("cannot be written: it is not a regular file; for standard output give -");
        }
        if meta.permissions().readonly() {
            return refuse("cannot be written: the file is read-only; make it writable, or give another name");
        }
        // It is compared with what would be written, and left alone when that is the same.
        std::fs::File::open(&target).map_err(|error| unusable(&error))?;
    }
    let folder = folder_of(&target);
    if !folder.is_dir() {
        let what = if folder.exists() { "is no folder" } else { "does not exist; create it first" };
        return refuse(&format!("cannot be written: the folder {} {what}", folder.display()));
    }
    probe(folder).map_err(|error| unusable(&error))
}

/// Refuses an output that is one of the `inputs` or another output.
pub fn check_distinct(outputs: &[&Path], inputs: &[&Path]) -> Result<(), Failure> {
    let files = |paths: &[&'_ Path]| -> Vec<PathBuf> {
        paths.iter().filter(|path| !is_standard(path)).map(|path| path.to_path_buf()).collect()
    };
    let mut seen: Vec<(PathBuf, &str)> = files(inputs).iter().map(|path| (identity(path), "an input")).collect();
    for output in &files(outputs) {
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

#[cfg(test)]
mod tests {
    use super::*;

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
        // Standard input and standard output are not one file.
        assert!(check_distinct(&[Path::new("-"), &new], &[Path::new("-")]).is_ok());
    }

    #[test]
    fn what_cannot_be_written_is_said_before() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("file"), b"x").unwrap();
        std::fs::write(at("kept"), b"x").unwrap();
        let mut permissions = std::fs::metadata(at("kept")).unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(at("kept"), permissions).unwrap();
        let long = "n".repeat(300);
        for (path, part) in [
            (folder.path().to_owned(), "it is a folder"),
            (at("kept"), "read-only"),
            (at("none/file"), "does not exist; create it first"),
            (at("file/file"), "is no folder"),
            (at(&long), "cannot be written"),
            (PathBuf::from("/"), "expected the name of a file"),
        ] {
            let failure = check_writable(&path).unwrap_err();
            assert!(failure.exit == Exit::InputOutput && failure.message.contains(part), "{failure:?}");
        }
        assert!(check_writable(&at("file")).is_ok() && check_writable(&at("new")).is_ok());
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("nowhere", at("dangling")).unwrap();
            std::os::unix::fs::symlink("file", at("link")).unwrap();
            assert!(check_writable(&at("dangling")).unwrap_err().message.contains("link to a file"));
            assert!(check_writable(&at("link")).is_ok());
        }
        assert!(create_folder(Path::new("-")).unwrap_err().exit == Exit::Usage);
        assert!(create_folder(&at("file")).unwrap_err().exit == Exit::InputOutput);
        assert!(create_folder(&at("a/b")).is_ok());
    }
}
