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
