//! The crates of the workspace as sets of modules.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A crate by the module paths of its files: `lobes::query` is `lobes/query.rs` or `lobes/query/mod.rs`, the root is empty.
pub struct Crate {
    /// Name of its package's folder, for messages.
    pub name: &'static str,
    /// Files by their module path.
    pub files: BTreeMap<Vec<String>, PathBuf>,
}

/// Folder of the repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Folders with a Cargo.toml of their own below another crate's folder, which are no modules of it.
const NESTED: [&str; 2] = ["src/view", "src/view/shaders"];

/// Every crate of the workspace that is compiled into the programs.
pub fn all() -> Vec<Crate> {
    let of = |name, folder: &str| {
        let folder = root().join(folder);
        let mut files = BTreeMap::new();
        collect(&folder, &folder, &mut files);
        assert!(files.contains_key(&Vec::new()), "{name} has no lib.rs");
        Crate { name, files }
    };
    vec![
        of("formats", "formats/src"),
        of("bake", "bake/src"),
        of("src", "src"),
        of("src/view", "src/view"),
        of("src/view/shaders", "src/view/shaders"),
    ]
}

fn collect(top: &Path, folder: &Path, files: &mut BTreeMap<Vec<String>, PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let inner = path.strip_prefix(top).unwrap();
        let first = inner.components().next().unwrap().as_os_str().to_str().unwrap().to_owned();
        if path.is_dir() {
            let is_crate = NESTED.iter().any(|nested| root().join(nested) == path);
            // Programs, tests and examples are crates of their own.
            if !is_crate && !["bin", "tests", "examples"].contains(&first.as_str()) {
                collect(top, &path, files);
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let mut module: Vec<String> =
                inner.with_extension("").iter().map(|part| part.to_str().unwrap().to_owned()).collect();
            if ["mod", "lib"].contains(&module.last().unwrap().as_str()) {
                module.pop();
            }
            files.insert(module, path);
        }
    }
}
