//! Puts a file in place whole or not at all: a temporary file beside it, synced, then renamed.

use std::fs::{self, File, Permissions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// How the names of temporary files begin.
pub const TEMPORARY_PREFIX: &str = ".glintpack-";
/// How they end.
pub const TEMPORARY_SUFFIX: &str = ".tmp";

/// What [`write_atomic`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteOutcome {
    /// The file already had these bytes and was left alone, time stamp included.
    Unchanged,
    /// The file was written.
    Written,
}

/// Writes `bytes` to `path` so that readers see the old file or the new one, never a part. A file that has these
/// bytes already is left untouched, so build tools see no change. When this fails the old file is still there.
pub fn write_atomic(path: &Path, bytes: &[u8]) -> io::Result<WriteOutcome> {
    let target = follow_link(path)?;
    if has_bytes(&target, bytes)? {
        return Ok(WriteOutcome::Unchanged);
    }
    let folder = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY_PREFIX).suffix(TEMPORARY_SUFFIX);
    let kept = existing_permissions(&target);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The system takes the umask away from these, as for any new file.
        builder.permissions(Permissions::from_mode(0o644));
    }
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    if let Some(permissions) = kept {
        file.as_file().set_permissions(permissions)?;
    }
    file.as_file().sync_all()?;
    file.persist(&target).map_err(|error| error.error)?;
    sync_folder(folder)?;
    Ok(WriteOutcome::Written)
}

/// Where a symbolic link leads, so that the link is kept and its target replaced.
fn follow_link(path: &Path) -> io::Result<PathBuf> {
    match fs::symlink_metadata(path) {
        Ok(meta) if meta.file_type().is_symlink() => fs::canonicalize(path),
        _ => Ok(path.to_owned()),
    }
}

/// Whether the file is there and has exactly these bytes.
fn has_bytes(path: &Path, bytes: &[u8]) -> io::Result<bool> {
    let mut file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
        Err(error) => return Err(error),
    };
    let meta = file.metadata()?;
    if !meta.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the output path is not a regular file"));
    }
    if meta.len() != bytes.len() as u64 {
        return Ok(false);
    }
    let mut buffer = vec![0; 1 << 16];
    let mut rest = bytes;
    loop {
        let read = file.read(&mut buffer)?;
        if read == 0 {
            return Ok(rest.is_empty());
        }
        let Some(after) = rest.strip_prefix(&buffer[..read]) else {
            return Ok(false);
        };
        rest = after;
    }
}

/// Permissions of the file that will be replaced.
fn existing_permissions(path: &Path) -> Option<Permissions> {
    fs::metadata(path).ok().map(|meta| meta.permissions())
}

/// Makes the rename last through a power cut.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

/// Other systems have no handle for this.
#[cfg(not(unix))]
fn sync_folder(_folder: &Path) -> io::Result<()> {
    Ok(())
}
