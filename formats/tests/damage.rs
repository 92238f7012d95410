//! Any flipped bit, missing byte or added byte is an error.

use crate::samples::*;
use glint_formats::container::Limits;
use glint_formats::{Issue, Pack, Severity, validate};

fn small_pack() -> Vec<u8> {
    let mut sections = vec![provenance_section()];
    sections.extend(good_ndf_maps());
    pack(sections)
}

fn has_error(issues: &[Issue]) -> bool {
    issues.iter().any(|issue| issue.severity == Severity::Error)
}

#[test]
fn every_flipped_bit_is_found() {
    let good = small_pack();
    assert!(!has_error(&validate(&good, &Limits::default())));
    let mut bytes = good.clone();
    for at in 0..good.len() {
        for pattern in [1, 2, 4, 8, 16, 32, 64, 128, 0xff] {
            bytes[at] ^= pattern;
            assert!(has_error(&validate(&bytes, &Limits::default())), "byte {at} ^ {pattern:#x} was not found");
            bytes[at] = good[at];
        }
    }
}

#[test]
fn every_truncation_is_found() {
    let good = full_pack();
    for len in 0..good.len() {
        assert!(has_error(&validate(&good[..len], &Limits::default())), "a cut at {len} was not found");
    }
}

#[test]
fn every_truncation_is_found_though_the_length_is_made_right() {
    let good = full_pack();
    for len in 0..good.len() {
        let mut bytes = good[..len].to_vec();
        seal(&mut bytes);
        assert!(has_error(&validate(&bytes, &Limits::default())), "a cut at {len} was not found");
    }
}

#[test]
fn added_bytes_are_found() {
    for added in [1, 2, 255, 256, 4096] {
        let mut bytes = small_pack();
        bytes.resize(bytes.len() + added, 0);
        assert!(has_error(&validate(&bytes, &Limits::default())));
        seal(&mut bytes);
        assert!(has_error(&validate(&bytes, &Limits::default())));
    }
}

#[test]
fn a_damaged_payload_is_found_when_it_is_read() {
    let mut bytes = small_pack();
    let good = Pack::from_bytes(bytes.clone(), &Limits::default()).unwrap();
    let entry = &good.sections()[1];
    bytes[entry.offset as usize] ^= 1;
    let pack = Pack::from_bytes(bytes, &Limits::default()).unwrap();
    assert!(pack.payload(&pack.sections()[0]).is_ok());
    assert!(pack.payload(entry).is_err());
    assert_eq!(pack.verify().len(), 1);
}
