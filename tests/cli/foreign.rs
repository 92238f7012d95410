//! Readers that are other people's: packages of Python and of npm. Tests that want one skip without it, and say so.

use crate::support::json;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Python with a package; `None`, which is said, without. `GLINT_PYTHON` names a Python that has to have it.
pub fn python_with(package: &str) -> Option<String> {
    let program = std::env::var("GLINT_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let import = format!("import {package}");
    if Command::new(&program).args(["-c", &import]).output().is_ok_and(|out| out.status.success()) {
        return Some(program);
    }
    assert!(std::env::var_os("GLINT_PYTHON").is_none(), "{program} cannot import {package}");
    eprintln!("skipped: {program} has no package {package}; GLINT_PYTHON names one that has");
    None
}

/// The folder of an npm package; `None`, which is said, without. `GLINT_NPM` names a folder whose `node_modules` has to have it.
pub fn npm_package(name: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("GLINT_NPM") else {
        eprintln!("skipped: GLINT_NPM names no folder with node_modules/{name}");
        return None;
    };
    let package = PathBuf::from(folder).join("node_modules").join(name);
    assert!(package.is_dir(), "{} is not there", package.display());
    Some(package)
}

/// What a script of tests/cli/readers prints when Node.js runs it with an npm package and arguments.
pub fn node(script: &str, package: &Path, args: &[&Path]) -> serde_json::Value {
    let script = crate::support::root().join("tests/cli/readers").join(script);
    printed(Command::new("node").arg(script).arg(package).args(args).output())
}

/// What a script of tests/cli/readers prints when Python runs it.
pub fn python(program: &str, script: &str, args: &[&Path]) -> serde_json::Value {
    let script = crate::support::root().join("tests/cli/readers").join(script);
    printed(Command::new(program).arg("-B").arg(script).args(args).output())
}

fn printed(output: std::io::Result<Output>) -> serde_json::Value {
    let output = output.expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    json(&String::from_utf8_lossy(&output.stdout))
}
