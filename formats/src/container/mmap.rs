//! The bytes of a pack, from memory or from a mapped file. The one place with unsafe code.
#![allow(unsafe_code)] // Mapping a file is unsafe because another program may change it; see `Bytes::open`.

use memmap2::Mmap;
use std::fs::File;
use std::io;
use std::ops::Deref;
use std::path::Path;

/// The bytes of a pack.
#[derive(Debug)]
pub(crate) enum Bytes {
    /// In memory.
    Owned(Vec<u8>),
    /// A mapped file.
    Mapped(Mmap),
}

impl Bytes {
    /// Maps a file read-only.
    pub fn open(path: &Path) -> io::Result<Bytes> {
        let file = File::open(path)?;
        if !file.metadata()?.is_file() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file"));
        }
        // SAFETY: The map is read-only and private to this value, and is only handed out as `&[u8]`. Rust asks that
        // the bytes do not change meanwhile. Packs are replaced by rename (`write_atomic`), never written in place,
        // so the mapped file keeps its bytes when a pack is baked again. Nothing of the bytes is trusted beyond
        // that: offsets are kept apart from the map, every access is bounds-checked, and payloads are plain numbers.
        let map = unsafe { Mmap::map(&file)? };
        Ok(Bytes::Mapped(map))
    }
}

impl Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Bytes::Owned(bytes) => bytes,
            Bytes::Mapped(map) => map,
        }
    }
}
