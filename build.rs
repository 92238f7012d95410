//! Hands the commit to the programs, for `--version` and provenance. A tarball has none; that is no error.

use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // These change with every commit and every checkout; they are absent outside a repository.
    for path in [".git/HEAD", ".git/refs/heads", ".git/packed-refs"] {
        if std::path::Path::new(path).exists() {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    let hash = std::path::Path::new(".git").exists().then(git_hash).flatten().unwrap_or_else(|| "unknown".into());
    println!("cargo:rustc-env=GLINT_GIT_HASH={hash}");
}

/// The commit of this very repository: a `.git` of a folder above would belong to somebody else.
fn git_hash() -> Option<String> {
    let output = Command::new("git").args(["rev-parse", "--short=12", "HEAD"]).output().ok()?;
    let hash = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !hash.is_empty()).then_some(hash)
}
