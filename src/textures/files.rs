//! Which files belong to textures that are there: those of their list, or those beside a glTF file. What cannot be read has none; who
//! needs it finds out by reading it.

use crate::gltf::container::Container;
use crate::gltf::document::Document;
use crate::output::folder_of;
use std::path::{Path, PathBuf};

/// Files that go with what was written last: with a list those that it names, with a glTF file those beside it.
pub fn files_of(last: &Path) -> Vec<PathBuf> {
    if last.extension().is_none_or(|extension| extension != "json") {
        return beside(last);
    }
    let list = std::fs::read(last).ok().and_then(|bytes| serde_json::from_slice::<serde_json::Value>(&bytes).ok());
    let files = list.as_ref().and_then(|list| list.get("files")?.as_array()).into_iter().flatten();
    files.filter_map(|file| Some(folder_of(last).join(file.get("file")?.as_str()?))).collect()
}

/// Files that a glTF file has beside it.
pub fn beside(path: &Path) -> Vec<PathBuf> {
    let read = || -> Option<Vec<PathBuf>> {
        let container = Container::read(&std::fs::read(path).ok()?).ok()?;
        Document::read(&container.text).ok()?.files().ok()
    };
    read().unwrap_or_default().into_iter().map(|file| folder_of(path).join(file)).collect()
}
