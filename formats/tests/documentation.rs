//! `docs/FORMAT.md` names every issue, kind and texture format.

use glint_formats::{IssueCode, kinds, vk_format};

fn format_page() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/FORMAT.md");
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn every_issue_is_in_the_page() {
    let page = format_page();
    for code in IssueCode::ALL {
        let row = format!("| {code} | {} |", code.title());
        assert!(page.contains(&row), "docs/FORMAT.md has no row {row}");
    }
}

#[test]
fn every_kind_is_in_the_page() {
    let page = format_page();
    for known in kinds::all() {
        let row = format!("| `{}` | {} | {} |", known.kind, known.version, known.title);
        assert!(page.contains(&row), "docs/FORMAT.md has no row {row}");
    }
}

#[test]
fn every_texture_format_is_in_the_page() {
    let page = format_page();
    for code in 0..1000 {
        if let (Some(name), Some(bytes)) = (vk_format::name(code), vk_format::texel_bytes(code)) {
            let row = format!("| {code} | {name} | {bytes} |");
            assert!(page.contains(&row), "docs/FORMAT.md has no row {row}");
        }
    }
}
