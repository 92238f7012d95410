//! What is wrong with a mesh file, said where its name is not known, and files that may refer to others.

use std::path::{Path, PathBuf};

/// What is wrong with a file that the caller knows the name of.
#[derive(Debug)]
pub(super) enum Fault {
    Bad(String),
    Unsupported(String),
    TooLarge(String),
    Io(PathBuf, std::io::Error),
}

/// The bytes of a regular file of at most `limit` bytes.
pub(super) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, Fault> {
    let io = |source| Fault::Io(path.to_owned(), source);
    let data = std::fs::metadata(path).map_err(io)?;
    if !data.is_file() {
        // A pipe or a device may never end.
        return Err(io(std::io::Error::new(std::io::ErrorKind::InvalidInput, "not a regular file")));
    }
    if data.len() > limit {
        return Err(Fault::TooLarge(format!("{} has {} bytes, {limit} are the limit", path.display(), data.len())));
    }
    std::fs::read(path).map_err(io)
}
