//! One bad pack for each numbered issue, here and as a file in `fixtures/corrupt/<id>/bad.glintpack`.
//!
//! `GLINT_WRITE_FIXTURES=1 cargo test -p glint-formats` writes the files.

use crate::samples::codes;
use crate::{corpus_container, corpus_typed};
use glint_formats::container::Limits;
use glint_formats::{IssueCode, Severity, validate};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Largest file of the corpus.
const MAX_FILE: usize = 4096;

/// A bad pack and the one issue it has.
pub struct Case {
    pub code: IssueCode,
    pub bytes: Vec<u8>,
}

pub fn case(code: IssueCode, bytes: Vec<u8>) -> Case {
    Case { code, bytes }
}

fn cases() -> Vec<Case> {
    let mut cases = corpus_container::cases();
    cases.extend(corpus_typed::cases());
    cases
}

fn corpus() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../fixtures/corrupt")
}

fn file_of(code: IssueCode) -> PathBuf {
    corpus().join(code.to_string()).join("bad.glintpack")
}

#[test]
fn each_case_has_exactly_its_issue() {
    for Case { code, bytes } in cases() {
        assert_eq!(codes(&bytes), [code], "{code} {}", code.title());
    }
}

#[test]
fn every_issue_has_a_case() {
    let covered: BTreeSet<IssueCode> = cases().iter().map(|case| case.code).collect();
    for &code in IssueCode::ALL {
        assert!(covered.contains(&code), "no bad pack for {code} {}", code.title());
    }
}

#[test]
fn only_skipped_sections_are_warnings() {
    for Case { code, bytes } in cases() {
        let warning = validate(&bytes, &Limits::default())[0].severity == Severity::Warning;
        assert_eq!(warning, code == IssueCode::UnknownOptional, "{code}");
    }
}

/// The files may be older than the code, as bad packs in the wild are, so their bytes are not compared.
#[test]
fn every_issue_has_a_file() {
    if std::env::var_os("GLINT_WRITE_FIXTURES").is_some() {
        for Case { code, bytes } in cases() {
            std::fs::create_dir_all(file_of(code).parent().unwrap()).unwrap();
            glint_formats::write_atomic(&file_of(code), &bytes).unwrap();
        }
    }
    for &code in IssueCode::ALL {
        let path = file_of(code);
        let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(bytes.len() < MAX_FILE, "{} has {} bytes", path.display(), bytes.len());
        assert_eq!(codes(&bytes), [code], "{}", path.display());
    }
}

#[test]
fn every_file_is_of_an_issue() {
    let ids: BTreeSet<String> = IssueCode::ALL.iter().map(|code| code.to_string()).collect();
    for entry in std::fs::read_dir(corpus()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(ids.contains(&name), "{name} is no issue id");
    }
}

#[test]
fn numbers_rise_and_keep_to_their_groups() {
    for pair in IssueCode::ALL.windows(2) {
        assert!((pair[0] as u16) < pair[1] as u16);
    }
    for &code in IssueCode::ALL {
        assert!((1001..4000).contains(&(code as u16)));
    }
}
