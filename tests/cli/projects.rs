//! Projects that the tests of `build`, `ninja` and `plan` share.

use crate::support::{maps, sky};
use std::fs;
use std::path::{Path, PathBuf};

/// A project with a pack of every method, made of a map of each kind and a sky; `glint.toml` in a folder of its own.
pub fn project() -> tempfile::TempDir {
    let folder = maps();
    sky(&folder.path().join("sky.hdr"));
    fs::write(folder.path().join("glint.toml"), PROJECT).unwrap();
    folder
}

/// The file of [`project`].
pub const PROJECT: &str = r#"
output = "packs"

[defaults.ndf-maps]
preset = "draft"

[materials.flakes]
method = "ndf-maps"
input = "flakes.png"
roughness = 0.05

[materials.layered]
method = "ndf-maps"
input = ["scratches.png", "flakes.png"]
name = ["coat", "base"]
layers = "coat:base"
base-f0 = [0.9, 0.6, 0.3]
placement = "stochastic"

[materials.plate]
method = "area-light"
input = "scratches.png"
anisotropic = true

[materials.procedural]
method = "dictionary"
levels = 4
seed = 0x10

[environments.studio]
input = "sky.hdr"
face-size = 16
levels = "auto"
"#;

/// Names of the packs of [`project`].
pub const PACKS: [&str; 5] = ["flakes", "layered", "plate", "procedural", "studio"];

/// Bytes of every pack of a project, by file name.
pub fn packs(folder: &Path) -> std::collections::BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder.join("packs")).unwrap().map(|entry| entry.unwrap().path());
    let packs = entries.filter(|path| path.is_file());
    packs.map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(path).unwrap())).collect()
}

/// Replaces a part of a file that must be there.
#[track_caller]
pub fn edit(path: &Path, old: &str, new: &str) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains(old), "{old} is not in {text}");
    fs::write(path, text.replacen(old, new, 1)).unwrap();
}

/// A path of the programs under test.
pub fn program(name: &str) -> PathBuf {
    assert_cmd::cargo::cargo_bin(name)
}
