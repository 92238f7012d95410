//! Names of the files of UDIM sets.

use std::path::{Path, PathBuf};

/// What stands for the number of a tile in a name.
pub const MARK: &str = "<UDIM>";

/// Whether a path stands for a file a tile.
pub fn is_set(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().contains(MARK))
}

/// The file of a tile; the path itself where it is the same for all.
pub fn numbered(path: &Path, number: u32) -> PathBuf {
    if !is_set(path) {
        return path.to_owned();
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(name.replace(MARK, &number.to_string()))
}

/// What names of a set's files begin with: the map's name without the number and what set it apart.
pub fn name_of(map: &Path) -> String {
    let stem = map.file_stem().unwrap_or_default().to_string_lossy().replace(MARK, "");
    let name = stem.trim_matches(['.', '_', '-', ' ']);
    if name.is_empty() { "textures".to_owned() } else { name.to_owned() }
}
