//! What is written is read back, and equal packs have equal bytes.

use crate::samples::*;
use glint_formats::container::{FourCc, Limits};
use glint_formats::dictionary::{self, DictionaryParams};
use glint_formats::ndf_maps::{DENSITY, LAYERS, NODES, NdfMapsParams, PARAMS, UNIFORM};
use glint_formats::provenance::{PROVENANCE, Provenance};
use glint_formats::{Codec, FormatError, OpenError, Pack, PackBuilder, Resource, Section, Severity, params, validate};
use std::borrow::Cow;

fn open(bytes: Vec<u8>) -> Pack {
    Pack::from_bytes(bytes, &Limits::default()).unwrap()
}

#[test]
fn a_full_pack_has_no_issues() {
    assert_eq!(validate(&full_pack(), &Limits::default()), []);
    assert_eq!(open(full_pack()).verify(), []);
}

#[test]
fn sections_come_back() {
    let pack = open(full_pack());
    assert_eq!(pack.version(), (1, 0));
    assert_eq!(pack.file_len(), full_pack().len() as u64);
    assert_eq!(pack.names(), [ROCK, "coated rock", "lobes", "sky", "metal", "flakes", "hide", "gold"]);
    let read = |kind, name: &str| pack.payload(pack.find(kind, name).unwrap()).unwrap();
    assert_eq!(params::decode::<Provenance>(&read(PROVENANCE, "")).unwrap(), provenance());
    assert_eq!(params::decode::<NdfMapsParams>(&read(PARAMS, ROCK)).unwrap(), ndf_params());
    assert_eq!(&*read(UNIFORM, ROCK), uniform(&ndf_params(), &stochastic(2, 2), &palette()));
    assert!(read(NODES, ROCK).starts_with(bytemuck::cast_slice(&nodes())));
    assert_eq!(&*read(DENSITY, ROCK), density());
    assert_eq!(params::decode::<DictionaryParams>(&read(dictionary::PARAMS, "lobes")).unwrap(), dictionary_params());
    assert_eq!(
        &*read(dictionary::TABLE, "lobes"),
        bytemuck::cast_slice::<_, u8>(&dictionary_pairs(&dictionary_table()))
    );
    assert!(pack.find(LAYERS, ROCK).is_none());
}

#[test]
fn only_compressed_payloads_are_copied() {
    let pack = open(full_pack());
    for entry in pack.sections() {
        let borrowed = matches!(pack.payload(entry).unwrap(), Cow::Borrowed(_));
        assert_eq!(borrowed, entry.codec == Codec::None, "{}", entry.label());
        assert_eq!(entry.offset % 256, 0);
    }
}

#[test]
fn equal_packs_have_equal_bytes() {
    assert_eq!(full_pack(), full_pack());
}

#[test]
fn a_mapped_file_reads_like_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glintpack");
    std::fs::write(&path, full_pack()).unwrap();
    let mapped = Pack::open(&path, &Limits::default()).unwrap();
    assert_eq!(mapped.sections(), open(full_pack()).sections());
    assert_eq!(mapped.verify(), []);
}

#[test]
fn files_that_are_no_packs_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let open = |path| Pack::open(path, &Limits::default());
    assert!(matches!(open(folder.path().join("missing")), Err(OpenError::Io(_))));
    assert!(matches!(open(folder.path().to_owned()), Err(OpenError::Io(_))));
    let empty = folder.path().join("empty");
    std::fs::write(&empty, b"").unwrap();
    assert!(matches!(open(empty), Err(OpenError::Invalid(issues)) if issues.len() == 1));
}

#[test]
fn empty_packs_and_empty_sections_are_packs() {
    assert_eq!(validate(&pack(vec![]), &Limits::default()), []);
    let empty = Section { payload: vec![], resource: Resource::Buffer { stride: 4, count: 0 }, ..plain_section("a") };
    let bytes = pack(vec![empty.clone(), empty_named(&empty, "b").compressed(), empty_named(&empty, "c")]);
    let issues = validate(&bytes, &Limits::default());
    assert!(issues.iter().all(|issue| issue.severity == Severity::Warning), "{issues:?}");
}

fn empty_named(section: &Section, name: &str) -> Section {
    Section { name: name.to_owned(), ..section.clone() }
}

#[test]
fn the_writer_refuses_what_a_reader_would() {
    let mut builder = PackBuilder::new();
    builder.push(plain_section("a")).unwrap();
    assert!(matches!(builder.push(plain_section("a")), Err(FormatError::Duplicate { .. })));
    builder.push(plain_section(&"é".repeat(31))).unwrap();
    assert!(matches!(builder.push(plain_section(&"é".repeat(32))), Err(FormatError::Name { .. })));
    assert!(matches!(builder.push(plain_section("a\nb")), Err(FormatError::Name { .. })));
    let long = Section { payload: vec![0; 5], ..plain_section("b") };
    assert!(matches!(builder.push(long), Err(FormatError::PayloadLength { expected: 4, found: 5, .. })));
    let texture = Resource::Texture { vk_format: 9, width: 0, height: 1, layers: 1, faces: 1, mips: 1 };
    let empty = Section::texture(FourCc(*b"test"), "c", texture, vec![]);
    assert!(matches!(builder.push(empty), Err(FormatError::Resource { .. })));
    let unknown = Resource::Texture { vk_format: 9999, width: 1, height: 1, layers: 1, faces: 1, mips: 1 };
    let unknown = Section::texture(FourCc(*b"test"), "d", unknown, vec![0; 4]);
    assert!(matches!(builder.push(unknown), Err(FormatError::Resource { .. })));
    let large =
        Section { payload: vec![0; params::MAX_BYTES + 1], resource: Resource::Parameters, ..plain_section("e") };
    let most = params::MAX_BYTES;
    let found = most + 1;
    assert_eq!(builder.push(large), Err(FormatError::ParametersTooLarge { most, found }));
}

#[test]
fn an_entry_of_another_pack_is_an_issue_and_not_a_panic() {
    let large = open(full_pack());
    let small = open(pack(vec![plain_section("a")]));
    assert!(small.payload(large.sections().last().unwrap()).is_err());
}

#[test]
fn messages_name_section_and_place() {
    let issue = &validate(&pack(vec![plain_section("a")]), &Limits::default())[0];
    let expected = "G1031 unknown optional section: it is skipped; a newer reader may use it (test \"a\", byte 256)";
    assert_eq!(issue.to_string(), expected);
}
