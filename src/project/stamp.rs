//! What a file holds, by its digest, and what the file system says of it, so that the digest need not be taken again.
//!
//! As git's index does: size, times and inode stand for the content. Times are coarse, so a file that was changed just
//! before it was looked at is not trusted: it could change once more within the same tick.

use crate::reading;
use serde::{Deserialize, Serialize};
use std::fs::{File, Metadata};
use std::io::{Read, Result};
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use xxhash_rust::xxh3::Xxh3;

/// Coarsest time stamps of the file systems in use.
const TICK: Duration = Duration::from_secs(2);

/// What the file system says of a file that changes when the content does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stat {
    /// Modification, nanoseconds since 1970.
    modified: u64,
    /// Change of the entry, nanoseconds since 1970; 0 where the system has none.
    changed: u64,
    /// Number of the file; 0 where the system has none.
    inode: u64,
    bytes: u64,
}

/// A file's content.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// XXH3-128 of the bytes, 32 hex digits.
    pub xxh3_128: String,
    /// When given, a file of which the system says the same still has these bytes.
    pub stat: Option<Stat>,
}

impl Stat {
    /// What the file system says now.
    pub fn of(path: &Path) -> Result<Stat> {
        std::fs::metadata(path).map(|meta| Stat::from(&meta))
    }

    /// Size of the file.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    fn from(meta: &Metadata) -> Stat {
        let modified = meta.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        let (changed, inode) = entry(meta);
        Stat { modified: modified.map_or(0, |time| time.as_nanos() as u64), changed, inode, bytes: meta.len() }
    }

    fn is_old(&self, now: SystemTime) -> bool {
        let tick = TICK.as_nanos() as u64;
        let now = now.duration_since(UNIX_EPOCH).map_or(0, |time| time.as_nanos() as u64);
        self.modified.max(self.changed).saturating_add(tick) < now
    }
}

#[cfg(unix)]
fn entry(meta: &Metadata) -> (u64, u64) {
    use std::os::unix::fs::MetadataExt;
    let changed = i128::from(meta.ctime()) * 1_000_000_000 + i128::from(meta.ctime_nsec());
    (u64::try_from(changed).unwrap_or(0), meta.ino())
}

#[cfg(not(unix))]
fn entry(_meta: &Metadata) -> (u64, u64) {
    (0, 0)
}

impl Stamp {
    /// The stamp of a file. It is read only when `known` does not tell.
    ///
    /// # Errors
    /// What cannot be read, and what can be read only once.
    pub fn of(path: &Path, known: Option<&Stamp>) -> Result<Stamp> {
        let now = SystemTime::now();
        let meta = std::fs::metadata(path)?;
        reading::check_regular(&meta)?;
        let stat = Stat::from(&meta);
        match known {
            Some(known) if known.stat == Some(stat) => return Ok(known.clone()),
            _ => {}
        }
        let xxh3_128 = digest(path)?;
        Ok(Stamp { xxh3_128, stat: stat.is_old(now).then_some(stat) })
    }
}

/// XXH3-128 of a file of any size.
fn digest(path: &Path) -> Result<String> {
    let mut file = File::open(path)?;
    let mut state = Xxh3::new();
    let mut buffer = vec![0; 1 << 18];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(format!("{:032x}", state.digest128())),
            read => state.update(&buffer[..read]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glint_formats::provenance::InputDigest;

    #[test]
    fn a_digest_is_that_of_the_provenance() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("big");
        let bytes: Vec<u8> = (0..300_000u32).map(|k| ((k * 7919) >> 3) as u8).collect();
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(Stamp::of(&path, None).unwrap().xxh3_128, InputDigest::of("big", &bytes).xxh3_128);
    }

    #[test]
    fn only_a_file_that_has_rested_is_known_by_its_stat() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map");
        std::fs::write(&path, b"one").unwrap();
        let fresh = Stamp::of(&path, None).unwrap();
        assert_eq!(fresh.stat, None);
        let stat = Stat::of(&path).unwrap();
        assert!(stat.is_old(SystemTime::now() + Duration::from_secs(3)));
        // What is known stands for the bytes as long as the stat does, and no longer.
        let known = Stamp { xxh3_128: "known".into(), stat: Some(stat) };
        assert_eq!(Stamp::of(&path, Some(&known)).unwrap(), known);
        std::fs::write(&path, b"three").unwrap();
        assert_ne!(Stamp::of(&path, Some(&known)).unwrap().xxh3_128, "known");
    }
}
