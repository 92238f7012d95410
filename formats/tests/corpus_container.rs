//! Bad packs of the container: G1xxx.

use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::container::FourCc;
use glint_formats::{IssueCode, Resource, Section};
use xxhash_rust::xxh3::xxh3_64;

/// A known section of a few bytes.
fn one() -> Vec<u8> {
    pack(vec![provenance_section()])
}

/// Two known sections of a few bytes.
fn two() -> Vec<u8> {
    let second = Section { name: String::from("rock"), ..provenance_section() };
    pack(vec![provenance_section(), second])
}

fn with_byte(mut bytes: Vec<u8>, at: usize, value: u8) -> Vec<u8> {
    bytes[at] = value;
    bytes
}

/// A pack of one compressed provenance.
fn compressed() -> Vec<u8> {
    pack(vec![provenance_section().compressed()])
}

/// The compressed pack with another frame of the same length in the table and a right checksum.
fn with_frame(edit: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = compressed();
    let mut frame = bytes.split_off(256);
    edit(&mut frame);
    bytes.extend_from_slice(&frame);
    let bytes = patched(bytes, entry_at(0, 16), &(frame.len() as u64).to_le_bytes());
    patched(bytes, entry_at(0, 32), &xxh3_64(&frame).to_le_bytes())
}

fn buffer_of(kind: &[u8; 4]) -> Section {
    Section::buffer(FourCc(*kind), "", &[1u8, 2, 3, 4])
}

/// A texture descriptor that no texture has: 2 × 1 texels with 3 mips.
fn impossible_texture() -> Vec<u8> {
    let mut words = Vec::new();
    for word in [2u32, 9, 2, 1, 1, 1, 3, 0] {
        words.extend_from_slice(&word.to_le_bytes());
    }
    patched(one(), entry_at(0, 40), &words)
}

/// A compressed buffer that states 5 GiB.
fn five_gib() -> Vec<u8> {
    let len = 5u64 << 30;
    let bytes = pack(vec![provenance_section().compressed()]);
    patched(bytes, entry_at(0, 24), &len.to_le_bytes())
}

pub fn cases() -> Vec<Case> {
    let mut cases = header_cases();
    cases.extend(table_cases());
    cases.extend(layout_cases());
    cases.extend(payload_cases());
    cases
}

fn header_cases() -> Vec<Case> {
    let mut stated_longer = one();
    stated_longer[24..32].copy_from_slice(&(5u64 << 30).to_le_bytes());
    reseal_header(&mut stated_longer);
    let mut cut = one();
    cut.pop();
    let mut text_mode = one();
    text_mode.remove(8);
    vec![
        case(IssueCode::FileTooShort, one()[..20].to_vec()),
        case(IssueCode::BadMagic, text_mode),
        case(IssueCode::UnsupportedMajor, patched(one(), 12, &[2, 0])),
        case(IssueCode::FileLength, cut),
        case(IssueCode::UnknownFlags, patched(one(), 20, &[1])),
        case(IssueCode::TableOutOfFile, patched(one(), 16, &[100])),
        case(IssueCode::HeaderChecksum, with_byte(one(), 32, one()[32] ^ 1)),
        case(IssueCode::FileTooLarge, stated_longer),
        case(IssueCode::TooManySections, patched(one(), 16, &[0, 0, 2, 0])),
    ]
}

fn table_cases() -> Vec<Case> {
    let raw_len = one().len() as u64 - 256;
    vec![
        case(IssueCode::RawTooLarge, five_gib()),
        case(IssueCode::BadName, patched(one(), entry_at(0, 72), &[1, 0xff])),
        case(IssueCode::DuplicateSection, patched(two(), entry_at(1, 72), &[0; 64])),
        case(IssueCode::UnknownCodec, patched(one(), entry_at(0, 7), &[2])),
        case(IssueCode::BadRequiredFlag, patched(one(), entry_at(0, 6), &[2])),
        case(IssueCode::UnknownResource, patched(one(), entry_at(0, 40), &[3])),
        case(IssueCode::BadResource, impossible_texture()),
        case(IssueCode::UnusedBytes, patched(one(), entry_at(0, 71), &[1])),
        case(IssueCode::RawLength, patched(pack(vec![buffer_of(b"PROV")]), entry_at(0, 48), &[5])),
        case(IssueCode::StoredLength, patched(one(), entry_at(0, 24), &(raw_len + 1).to_le_bytes())),
        case(IssueCode::UnknownRequired, pack(vec![buffer_of(b"nope")])),
        case(IssueCode::UnknownOptional, pack(vec![buffer_of(b"nope").optional()])),
        case(
            IssueCode::UnsupportedSectionVersion,
            pack(vec![Section { version: 2, required: true, ..provenance_section() }]),
        ),
    ]
}

fn layout_cases() -> Vec<Case> {
    let mut gap = one();
    gap.splice(256..256, [0; 256]);
    let mut longer = one();
    longer.push(0);
    seal(&mut longer);
    let mut shifted = one();
    shifted.insert(256, 0);
    let second_offset = entry_at(1, 8);
    vec![
        case(IssueCode::OverlapsHeader, patched(one(), entry_at(0, 8), &0u64.to_le_bytes())),
        case(IssueCode::Misaligned, patched(shifted, entry_at(0, 8), &257u64.to_le_bytes())),
        case(IssueCode::SectionsOverlap, patched(two(), second_offset, &512u64.to_le_bytes())),
        case(IssueCode::SectionGap, patched(gap, entry_at(0, 8), &512u64.to_le_bytes())),
        case(IssueCode::SectionOutOfFile, patched(compressed(), entry_at(0, 16), &4000u64.to_le_bytes())),
        case(IssueCode::TrailingBytes, longer),
        case(IssueCode::PaddingNotZero, with_byte(one(), 255, 1)),
    ]
}

fn payload_cases() -> Vec<Case> {
    let last = one().len() - 1;
    let raw_len = provenance_section().payload.len() as u64;
    let one_more = Section { resource: Resource::Parameters, ..provenance_section() };
    vec![
        case(IssueCode::SectionChecksum, with_byte(one(), last, one()[last] ^ 1)),
        case(IssueCode::BadCompression, with_frame(|frame| frame.push(0))),
        case(
            IssueCode::DecompressedLength,
            patched(pack(vec![one_more.compressed()]), entry_at(0, 24), &(raw_len + 1).to_le_bytes()),
        ),
    ]
}
