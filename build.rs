//! Hands the commit to the programs, for `--version` and provenance. A tarball has none; that is no error.

use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // A `.git` of a folder above would belong to somebody else.
    let own = std::path::Path::new(".git").exists();
    let hash = own.then(|| git(&["rev-parse", "--short=12", "HEAD"])).flatten();
    // These change with every commit and every checkout. A second work tree has a HEAD of its own and shares the rest.
    for (folder, file) in
        [("--git-dir", "HEAD"), ("--git-common-dir", "refs/heads"), ("--git-common-dir", "packed-refs")]
    {
        let path = own.then(|| git(&["rev-parse", folder])).flatten().map(|folder| format!("{folder}/{file}"));
        if let Some(path) = path.filter(|path| std::path::Path::new(path).exists()) {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    println!("cargo:rustc-env=GLINT_GIT_HASH={}", hash.unwrap_or_else(|| "unknown".into()));
}

/// What git says of this repository, on one line.
fn git(args: &[&str]) -> Option<String> {
    let output = Command::new("git").args(args).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !text.is_empty()).then_some(text)
}
