//! Baked packs under every one-byte flip and every truncation: always a numbered issue, never a panic.

use crate::support::{bake, maps, sky};
use glint_formats::{Limits, Severity, validate};
use std::fs;

/// Small packs of three methods.
fn baked() -> Vec<Vec<u8>> {
    let folder = maps();
    sky(&folder.path().join("sky.hdr"));
    let packs: [&[&str]; 3] = [
        &["ndf-maps", "flakes.png", "--finest-window", "2", "--max-error", "0.2"],
        &["environment", "sky.hdr", "--face-size", "4", "--levels", "3"],
        &["dictionary", "--marginals", "4", "--levels", "3", "--entries", "16", "--lobe-std", "0.04"],
    ];
    let bytes = |args: &&[&str]| {
        bake(folder.path(), &[args, &["-o", "out.glintpack"][..]].concat()).ok();
        fs::read(folder.path().join("out.glintpack")).unwrap()
    };
    packs.iter().map(bytes).collect()
}

fn has_error(bytes: &[u8]) -> bool {
    validate(bytes, &Limits::default()).iter().any(|issue| issue.severity == Severity::Error)
}

#[test]
fn every_one_byte_flip_is_found() {
    for mut bytes in baked() {
        assert!(!has_error(&bytes));
        for at in 0..bytes.len() {
            bytes[at] ^= 1 << (at % 8);
            assert!(has_error(&bytes), "byte {at} of {}", bytes.len());
            bytes[at] ^= 1 << (at % 8);
        }
    }
}

#[test]
fn every_truncation_has_an_issue() {
    for bytes in baked() {
        for length in 0..bytes.len() {
            assert!(has_error(&bytes[..length]), "{length} bytes of {}", bytes.len());
        }
    }
}
