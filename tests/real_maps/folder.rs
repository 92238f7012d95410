//! The folder of real maps and images, found by `GLINT_DATA`.

use std::path::{Path, PathBuf};

/// The data folder, or None (said on stderr) where there is none.
pub fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("GLINT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: no real maps in {} (set GLINT_DATA)", folder.display());
    None
}
