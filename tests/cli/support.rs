//! What the tests share: running the programs, making maps, and looking at what came out.

use assert_cmd::Command;
use glint_bake::input::synthetic;
use std::fs;
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

/// Runs a program in `folder`.
pub fn run(program: &str, folder: &Path, args: &[&str]) -> Outcome {
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

/// A subcommand in a folder of its own: the arguments that every call begins with write `out.glintpack`.
pub struct Case {
    pub folder: tempfile::TempDir,
    pub args: &'static [&'static str],
}

impl Case {
    /// Path of a file.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Bakes with more flags.
    pub fn bake(&self, flags: &[&str]) -> Outcome {
        bake(self.folder.path(), &[self.args, flags].concat())
    }

    /// What glint-info says of the pack.
    pub fn info(&self, flags: &[&str]) -> Outcome {
        info(self.folder.path(), &[&["out.glintpack"], flags].concat())
    }

    /// Bytes of the pack that more flags make.
    #[track_caller]
    pub fn pack(&self, flags: &[&str]) -> Vec<u8> {
        self.bake(flags).ok();
        fs::read(self.path("out.glintpack")).unwrap()
    }

    /// Looks that the pack is intact.
    #[track_caller]
    pub fn verify(&self) {
        assert_eq!(self.info(&["--verify"]).ok().stdout, "out.glintpack: intact\n");
    }

    /// The report of the pack.
    #[track_caller]
    pub fn report(&self) -> serde_json::Value {
        json(&self.info(&["--json"]).ok().stdout)
    }

    /// Names of all files of the folder, sorted.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Looks that flags are refused with a code, by a message that holds `part`.
    #[track_caller]
    pub fn refuses(&self, flags: &[&str], code: i32, part: &str) {
        let refused = self.bake(flags);
        assert_eq!(refused.code, code, "{flags:?}: {}", refused.stderr);
        assert!(refused.stderr.contains(part), "{flags:?}: {}", refused.stderr);
    }

    /// Looks that any number of threads makes the same pack; gives its bytes.
    #[track_caller]
    pub fn same_on_any_threads(&self) -> Vec<u8> {
        let one = self.pack(&["-j", "1"]);
        assert!(one == self.pack(&["-j", "2"]) && one == self.pack(&["-j", "7"]) && one == self.pack(&[]));
        one
    }

    /// Looks that --json and --report give what glint-info prints, --depfile names `inputs`, and -q says nothing.
    #[track_caller]
    pub fn check_outputs(&self, inputs: &[&str]) {
        let before = self.names();
        let done = self.bake(&["--json", "--report", "r.json", "--depfile", "out.d", "-q"]).ok();
        assert!(done.stderr.is_empty(), "{}", done.stderr);
        let printed = self.info(&["--json"]).ok().stdout;
        assert_eq!(done.stdout, printed);
        assert_eq!(fs::read_to_string(self.path("r.json")).unwrap(), printed);
        let inputs: String = inputs.iter().map(|name| format!(" \\\n  {name}")).collect();
        assert_eq!(fs::read_to_string(self.path("out.d")).unwrap(), format!("out.glintpack:{inputs}\n"));
        let mut after = [&before[..], &["out.d", "out.glintpack", "r.json"].map(String::from)].concat();
        after.sort();
        assert_eq!(self.names(), after);
    }
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
    fs::write(path, bytes).unwrap();
}

/// Every kind of pack, and the flags it is baked with.
const PACKS: [(&str, &[&str]); 12] = [
    (
        "layered.glintpack",
        &["ndf-maps", "flakes.png", "scratches.png", "--layers", "scratches:flakes", "--placement", "stochastic"],
    ),
    ("tiled.glintpack", &["ndf-maps", "flakes.png", "--finest-window", "1", "--compress"]),
    ("clamped.glintpack", &["ndf-maps", "flakes.png", "--wrap", "clamp", "--crop", "2x2+0+0"]),
    ("dictionary.glintpack", &["dictionary", "--marginals", "3"]),
    ("facets.glintpack", &["glints", "--colour", "1,0.5,0.2", "--compress"]),
    ("sky.glintpack", &["environment", "sky.hdr", "--face-size", "8", "--min-face-size", "2", "--coloured"]),
    ("levels.glintpack", &["environment", "sky.hdr", "--face-size", "4", "--levels", "7"]),
    ("ggx.glintpack", &["environment", "sky.hdr", "--face-size", "4", "--kernel", "ggx-nl", "--compress"]),
    ("light.glintpack", &["area-light", "scratches.png", "--anisotropic"]),
    ("lobes.glintpack", &["lobes", "scratches.png", "--storage", "f16", "--compress"]),
    ("surface.glintpack", &["lobes", "worn.png", "--synthesize", "96x64", "--patch", "32", "--overlap", "4"]),
    ("snorm.glintpack", &["area-light", "flakes.png", "--format", "snorm8", "--compress"]),
];

/// A folder with every kind of pack and the packs' inputs, and the packs' names. They are baked once.
pub fn packs() -> (tempfile::TempDir, Vec<&'static str>) {
    static BAKED: OnceLock<Vec<(&str, Vec<u8>)>> = OnceLock::new();
    let folder = maps();
    sky(&folder.path().join("sky.hdr"));
    synthetic::scratches(64, 64, 2).save(folder.path().join("worn.png")).unwrap();
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
