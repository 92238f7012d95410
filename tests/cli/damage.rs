//! A baked pack under every one-byte flip and every truncation: always a numbered issue, never a panic.

use crate::support::{bake, maps};
use glint_formats::{Limits, Severity, validate};
use std::fs;

fn baked() -> Vec<u8> {
    let folder = maps();
    let args = ["ndf-maps", "flakes.png", "-o", "out.glintpack", "--placement", "stochastic", "--cells", "4"];
    bake(folder.path(), &[&args[..], &["--max-error", "0.1"]].concat()).ok();
    fs::read(folder.path().join("out.glintpack")).unwrap()
}

fn has_error(bytes: &[u8]) -> bool {
    validate(bytes, &Limits::default()).iter().any(|issue| issue.severity == Severity::Error)
}

#[test]
fn every_one_byte_flip_is_found() {
    let mut bytes = baked();
    assert!(!has_error(&bytes));
    for at in 0..bytes.len() {
        bytes[at] ^= 1 << (at % 8);
        assert!(has_error(&bytes), "byte {at}");
        bytes[at] ^= 1 << (at % 8);
    }
}

#[test]
fn every_truncation_has_an_issue() {
    let bytes = baked();
    for length in 0..bytes.len() {
        assert!(has_error(&bytes[..length]), "{length} bytes of {}", bytes.len());
    }
}
