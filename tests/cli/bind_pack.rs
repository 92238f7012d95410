//! docs/examples/bind_pack.py: a host that knows docs/FORMAT.md alone binds a pack on a GPU and gets the CPU's answers, the golden vectors.

use crate::foreign::python_with;
use crate::support::{bake, root};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Words of `ExampleAnswer`.
const WORDS: usize = 12;

fn numbers(path: &Path) -> Vec<f32> {
    let bytes = fs::read(path).unwrap();
    bytes.chunks_exact(4).map(|word| f32::from_le_bytes(word.try_into().unwrap())).collect()
}

#[test]
fn a_host_of_the_documentation_alone_gets_the_answers_of_the_cpu() {
    let Some(python) = python_with("wgpu") else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join("shaders").join(name);
    let args = ["shaders", "--lang", "wgsl", "--vectors", "--method", "dictionary", "-o", "shaders"];
    bake(folder.path(), &args).ok();
    // Without -B a folder of compiled files would appear in docs.
    let output = Command::new(python)
        .current_dir(folder.path().join("shaders"))
        .arg("-B")
        .arg(root().join("docs/examples/bind_pack.py"))
        .args(["vectors_dictionary.glintpack", ".", "vectors_dictionary_pixels.bin", "answers"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

    let (answers, expected) = (numbers(&path("answers")), numbers(&path("vectors_dictionary_answers.bin")));
    assert_eq!(answers.len(), expected.len());
    let largest = expected.iter().copied().fold(0.0, f32::max);
    let mut lit = 0;
    for (k, (found, expected)) in answers.iter().zip(&expected).enumerate() {
        let bound = 1e-3 * expected.abs() + 1e-5 * largest;
        let (pixel, word) = (k / WORDS, k % WORDS);
        assert!((found - expected).abs() <= bound, "pixel {pixel}, word {word}: {found}, on the CPU {expected}");
        lit += usize::from(word == 0 && *expected > 0.0);
    }
    assert!(lit > expected.len() / WORDS / 4, "only {lit} pixels see a glint");
}
