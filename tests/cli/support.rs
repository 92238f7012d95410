//! What the tests share: running the programs, making maps, and looking at what came out.

use assert_cmd::Command;
use glint_bake::input::synthetic;
use std::path::{Path, PathBuf};

/// What a program did.
pub struct Outcome {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Outcome {
    /// The same, after a look that it succeeded.
    #[track_caller]
    pub fn ok(self) -> Outcome {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self
    }
}

fn run(program: &str, folder: &Path, args: &[&str]) -> Outcome {
    let output = Command::cargo_bin(program).unwrap().current_dir(folder).args(args).output().unwrap();
    Outcome {
        code: output.status.code().unwrap(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// Runs glint-bake in `folder`.
pub fn bake(folder: &Path, args: &[&str]) -> Outcome {
    run("glint-bake", folder, args)
}

/// Runs glint-info in `folder`.
pub fn info(folder: &Path, args: &[&str]) -> Outcome {
    run("glint-info", folder, args)
}

/// A folder with two small maps, flakes.png and scratches.png.
pub fn maps() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    synthetic::flakes(8, 8, 1).save(folder.path().join("flakes.png")).unwrap();
    synthetic::scratches(16, 8, 1).save(folder.path().join("scratches.png")).unwrap();
    folder
}

/// The repository.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// JSON of a text.
#[track_caller]
pub fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"))
}

/// A project with a pack of every method, made of a map of each kind and a sky; `glint.toml` in a folder of its own.
pub fn project() -> tempfile::TempDir {
    let folder = maps();
    write_sky(&folder.path().join("sky.hdr"));
    std::fs::write(folder.path().join("glint.toml"), PROJECT).unwrap();
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
    let entries = std::fs::read_dir(folder.join("packs")).unwrap().map(|entry| entry.unwrap().path());
    let packs = entries.filter(|path| path.is_file());
    packs.map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(path).unwrap())).collect()
}

/// Replaces a part of a file that must be there.
#[track_caller]
pub fn edit(path: &Path, old: &str, new: &str) {
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains(old), "{old} is not in {text}");
    std::fs::write(path, text.replacen(old, new, 1)).unwrap();
}

/// A path of the programs under test.
pub fn program(name: &str) -> PathBuf {
    assert_cmd::cargo::cargo_bin(name)
}

/// A grey sky with a small sun, 32 × 16 pixels of Radiance HDR.
pub fn write_sky(path: &Path) {
    let mut sky = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n".to_vec();
    sky.extend((0..16 * 32).flat_map(|k: u32| if k == 77 { [200, 180, 150, 140] } else { [100, 120, 140, 128] }));
    std::fs::write(path, sky).unwrap();
}
