//! Files that URIs of a glTF file name (specification, section 2.8).

use super::fault::Fault;
use percent_encoding::percent_decode_str;
use std::path::{Component, PathBuf};

/// The file that a URI names, relative to the folder of the one that has it.
///
/// # Errors
/// Unsupported, for what lies elsewhere.
pub fn file_of(uri: &str) -> Result<PathBuf, Fault> {
    let name = percent_decode_str(uri).decode_utf8_lossy();
    let path = PathBuf::from(name.as_ref());
    let inside = |component: Component| matches!(component, Component::Normal(_) | Component::CurDir);
    // '%3a' is no scheme, but no name that an exporter writes either.
    if name.contains([':', '\0']) || name.is_empty() || !path.components().all(inside) {
        return Err(Fault::unsupported(format!(
            "it lies at '{uri}'; only files beside or below the .gltf are read: move it there, or export as GLB"
        )));
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn only_files_of_the_folder_have_a_path() {
        for (uri, path) in [("a%20b.png", "a b.png"), ("./in/a.png", "./in/a.png"), ("%C3%A9.png", "é.png")] {
            assert_eq!(file_of(uri).unwrap(), Path::new(path));
        }
        for uri in
            ["../a.png", "in/../../a.png", "/a.png", "file:///a.png", "%2e%2e/a.png", "http://a/b.png", "", "%00"]
        {
            assert!(file_of(uri).is_err(), "{uri}");
        }
    }
}
