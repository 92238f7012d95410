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

impl Fault {
    /// The same, of this part of the file.
    pub fn of(self, part: &str) -> Fault {
        match self {
            Fault::Bad(what) => Fault::Bad(format!("{part}: {what}")),
            Fault::Unsupported(what) => Fault::Unsupported(format!("{part}: {what}")),
            Fault::TooLarge(what) => Fault::TooLarge(format!("{part}: {what}")),
            Fault::Io(file, source) => Fault::Io(file, source),
        }
    }
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

/// Text without the byte order mark of UTF-8; UTF-16 is refused.
pub(super) fn without_mark(bytes: &[u8]) -> Result<&[u8], Fault> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(Fault::Bad("its text is UTF-16, UTF-8 is needed".to_owned()));
    }
    Ok(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}
