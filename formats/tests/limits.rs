//! Caps are kept, also against false lengths in small files.

use crate::samples::*;
use glint_formats::container::{FourCc, Limits};
use glint_formats::{IssueCode, Pack, Resource, Section, params, validate};

fn first_code(bytes: &[u8], limits: Limits) -> Option<IssueCode> {
    validate(bytes, &limits).first().map(|issue| issue.code)
}

#[test]
fn each_limit_is_kept() {
    let bytes = full_pack();
    let len = bytes.len() as u64;
    let pack = Pack::from_bytes(bytes.clone(), &Limits::default()).unwrap();
    let (count, raw) = (pack.sections().len() as u32, pack.sections().iter().map(|s| s.raw_len).sum());
    let exact = Limits { max_file_bytes: len, max_sections: count, max_raw_bytes: raw };
    assert_eq!(first_code(&bytes, exact), None);
    assert_eq!(first_code(&bytes, Limits { max_file_bytes: len - 1, ..exact }), Some(IssueCode::FileTooLarge));
    assert_eq!(first_code(&bytes, Limits { max_sections: count - 1, ..exact }), Some(IssueCode::TooManySections));
    assert_eq!(first_code(&bytes, Limits { max_raw_bytes: raw - 1, ..exact }), Some(IssueCode::RawTooLarge));
}

/// A frame of 64 MiB of zeros whose entry states less: decompression stops one byte after what was stated.
#[test]
fn a_bomb_stops_at_the_stated_length() {
    let zeros = vec![0u8; 64 << 20];
    let section = Section::buffer(FourCc(*b"test"), "bomb", &zeros).optional().compressed();
    let bytes = pack(vec![section]);
    let bytes = patched(bytes, entry_at(0, 24), &1000u64.to_le_bytes());
    let bytes = patched(bytes, entry_at(0, 48), &1000u64.to_le_bytes());
    assert_eq!(codes(&bytes), [IssueCode::UnknownOptional, IssueCode::DecompressedLength]);
    let pack = Pack::from_bytes(bytes, &Limits { max_raw_bytes: 1000, ..Limits::default() }).unwrap();
    assert!(pack.payload(&pack.sections()[0]).is_err());
}

/// A length of nearly 4 GiB in a file of some hundred bytes is found out without that much memory.
#[test]
fn a_false_length_does_not_allocate() {
    let section = Section { resource: Resource::Parameters, ..plain_section("a").compressed() };
    let bytes = patched(pack(vec![section]), entry_at(0, 24), &((4u64 << 30) - 1).to_le_bytes());
    assert_eq!(codes(&bytes), [IssueCode::UnknownOptional, IssueCode::DecompressedLength]);
}

#[test]
fn a_false_length_in_parameters_does_not_allocate() {
    assert!(params::decode::<Vec<u64>>(&u64::MAX.to_le_bytes()).is_err());
    assert!(params::decode::<Vec<u8>>(&(1u64 << 40).to_le_bytes()).is_err());
    assert!(params::decode::<String>(&(1u64 << 40).to_le_bytes()).is_err());
    assert!(params::decode::<Vec<u8>>(&vec![0; params::MAX_BYTES + 1]).is_err());
}
