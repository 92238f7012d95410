//! Bytes of files, of pipes and of standard input: read once, and no more of them than a limit allows.
//!
//! What the file system says of a pipe's length is nothing, and of a growing file not all; so the limit holds for what is
//! read. A device is no file: most of them never end, so all are refused, and so are sockets that have a path.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, IsTerminal, Read, Result as IoResult, stdin};
use std::path::Path;

/// Whether a path stands for standard input, or for standard output: `-`. A file of that name is `./-`.
pub fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Why the bytes of a file are not there.
#[derive(Debug)]
pub enum ReadError {
    /// The system refuses, or it is not a file.
    Io(Error),
    /// There are more than the limit; how many, when the file system knows.
    TooLarge(Option<u64>),
}

impl From<Error> for ReadError {
    fn from(error: Error) -> ReadError {
        ReadError::Io(error)
    }
}

/// All bytes of a file, or of a pipe up to its end, at most `limit`.
///
/// # Errors
/// What the system says; more bytes than `limit`, after reading one more at most.
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>, ReadError> {
    let (file, len) = open(path)?;
    if len > limit {
        return Err(ReadError::TooLarge(Some(len)));
    }
    let bytes = at_most(file, len, limit.saturating_add(1))?;
    if bytes.len() as u64 > limit {
        return Err(ReadError::TooLarge(None));
    }
    Ok(bytes)
}

/// The first `most` bytes of a file or a pipe; all, when it has no more.
///
/// # Errors
/// What the system says.
pub fn read_at_most(path: &Path, most: u64) -> IoResult<Vec<u8>> {
    let (file, len) = open(path)?;
    at_most(file, len.min(most), most)
}

/// An open file or pipe, and its length as far as the file system knows one.
fn open(path: &Path) -> IoResult<(File, u64)> {
    if is_standard(path) {
        let file = standard_input()?;
        check_kind(&file.metadata()?, Some(&file))?;
        return Ok((file, 0));
    }
    let meta = std::fs::metadata(path)?;
    check_kind(&meta, None)?;
    Ok((File::open(path)?, if meta.is_file() { meta.len() } else { 0 }))
}

fn at_most(file: File, len: u64, most: u64) -> IoResult<Vec<u8>> {
    let mut bytes = Vec::new();
    // A length that is not true costs a refusal at most, never the process.
    let _ = bytes.try_reserve_exact(usize::try_from(len).unwrap_or(0));
    file.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Says whether a file can be read, without taking anything out of a pipe.
///
/// # Errors
/// Why it cannot.
pub fn check_readable(path: &Path) -> IoResult<()> {
    if is_standard(path) {
        let file = standard_input()?;
        return check_kind(&file.metadata()?, Some(&file));
    }
    let meta = std::fs::metadata(path)?;
    check_kind(&meta, None)?;
    // To open a pipe is to wait for its writer, and to close it again is to lose what was written.
    if meta.is_file() { File::open(path).map(drop) } else { Ok(()) }
}

/// Whether a path is read once only: standard input, or a pipe.
pub fn is_stream(path: &Path) -> bool {
    is_standard(path) || std::fs::metadata(path).is_ok_and(|meta| !meta.is_file() && !meta.is_dir())
}

/// Refuses what cannot be read twice, for work that looks at a file before it reads it.
///
/// # Errors
/// Which kind of file it is.
pub fn check_regular(meta: &Metadata) -> IoResult<()> {
    if meta.is_file() {
        return Ok(());
    }
    check_kind(meta, None)?;
    Err(Error::new(
        ErrorKind::InvalidInput,
        "is a pipe, and a project's files are read more than once; save it as a file first",
    ))
}

/// Refuses all but files and pipes. `standard` is the standard input whose kind is looked at.
fn check_kind(meta: &Metadata, standard: Option<&File>) -> IoResult<()> {
    if meta.is_dir() {
        return Err(Error::new(ErrorKind::IsADirectory, "is a folder; name a file in it"));
    }
    let refuse = |what: &str| Err(Error::new(ErrorKind::InvalidInput, what));
    if standard.is_some_and(IsTerminal::is_terminal) {
        return refuse("standard input is a terminal; send a file to it, as in `< FILE`, or name one");
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let kind = meta.file_type();
        if kind.is_char_device() || kind.is_block_device() {
            return refuse("is a device, not a file; name a file or a pipe");
        }
        // Standard input that is a socket is open already, and can be read.
        if kind.is_socket() && standard.is_none() {
            return refuse("is a socket, not a file; name a file or a pipe, or give - for standard input");
        }
    }
    Ok(())
}

/// Standard input without the buffer of the process, as the file that it is.
fn standard_input() -> IoResult<File> {
    #[cfg(unix)]
    {
        use std::os::fd::AsFd;
        stdin().as_fd().try_clone_to_owned().map(File::from)
    }
    #[cfg(windows)]
    {
        use std::os::windows::io::AsHandle;
        stdin().as_handle().try_clone_to_owned().map(File::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_holds_for_files_and_for_what_has_no_length() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ten");
        std::fs::write(&path, [7; 10]).unwrap();
        assert_eq!(read(&path, 10).unwrap(), [7; 10]);
        assert!(matches!(read(&path, 9), Err(ReadError::TooLarge(Some(10)))));
        assert!(matches!(read(folder.path(), 9), Err(ReadError::Io(e)) if e.kind() == ErrorKind::IsADirectory));
        // A file of the system that has bytes and no length.
        let status = Path::new("/proc/self/status");
        if status.exists() {
            assert!(matches!(read(status, 20), Err(ReadError::TooLarge(None))));
            assert!(!read(status, 1 << 20).unwrap().is_empty());
        }
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_sockets_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        for (path, part) in
            [(Path::new("/dev/zero"), "device"), (Path::new("/dev/null"), "device"), (&socket, "socket")]
        {
            let error = check_readable(path).unwrap_err();
            assert!(error.to_string().contains(part), "{error}");
            assert!(matches!(read(path, 100), Err(ReadError::Io(e)) if e.to_string().contains(part)));
            assert!(check_regular(&std::fs::metadata(path).unwrap()).is_err());
        }
    }
}
