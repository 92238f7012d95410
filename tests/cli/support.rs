//! What the tests share: running the programs, making maps, and looking at what came out.

use assert_cmd::Command;
use glint_bake::input::synthetic;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

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

/// A small sky as a Radiance file: a gradient and a sun.
pub fn sky(path: &Path) {
    let (width, height) = (16u8, 8u8);
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    for y in 0..height {
        for x in 0..width {
            let sun = (x, y) == (10, 2);
            bytes.extend(if sun { [200, 180, 150, 138] } else { [100 + 8 * x, 120, 250 - 20 * y, 128] });
        }
    }
    std::fs::write(path, bytes).unwrap();
}

/// Every kind of pack, and the flags it is baked with.
const PACKS: [(&str, &[&str]); 9] = [
    (
        "layered.glintpack",
        &["ndf-maps", "flakes.png", "scratches.png", "--layers", "scratches:flakes", "--placement", "stochastic"],
    ),
    ("tiled.glintpack", &["ndf-maps", "flakes.png", "--storage", "f16", "--compress"]),
    ("paper.glintpack", &["ndf-maps", "flakes.png", "--storage", "paper", "--crop", "2x2+0+0"]),
    ("dictionary.glintpack", &["dictionary", "--marginals", "3"]),
    ("sky.glintpack", &["environment", "sky.hdr", "--face-size", "8", "--min-face-size", "2", "--coloured"]),
    ("unorm.glintpack", &["environment", "sky.hdr", "--face-size", "4", "--format", "unorm16", "--levels", "7"]),
    ("floats.glintpack", &["environment", "sky.hdr", "--face-size", "4", "--format", "f32", "--compress"]),
    ("light.glintpack", &["area-light", "scratches.png", "--anisotropic"]),
    ("snorm.glintpack", &["area-light", "flakes.png", "--format", "snorm8", "--compress"]),
];

/// A folder with every kind of pack and the packs' inputs, and the packs' names. They are baked once.
pub fn packs() -> (tempfile::TempDir, Vec<&'static str>) {
    static BAKED: OnceLock<Vec<(&str, Vec<u8>)>> = OnceLock::new();
    let folder = maps();
    sky(&folder.path().join("sky.hdr"));
    let baked = BAKED.get_or_init(|| {
        let bytes_of = |(name, args): (&'static str, &[&str])| {
            bake(folder.path(), &[args, &["-o", name, "-q"]].concat()).ok();
            (name, std::fs::read(folder.path().join(name)).unwrap())
        };
        PACKS.map(bytes_of).to_vec()
    });
    for (name, bytes) in baked {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    (folder, PACKS.map(|(name, _)| name).to_vec())
}

/// The frozen packs of every released version.
pub fn frozen_packs() -> Vec<PathBuf> {
    let files = |folder: PathBuf| std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let versions = files(root().join("fixtures/packs")).filter(|path| path.is_dir());
    let mut packs: Vec<PathBuf> =
        versions.flat_map(files).filter(|path| path.extension().is_some_and(|e| e == "glintpack")).collect();
    packs.sort();
    packs
}
