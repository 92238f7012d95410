//! `glint-bake report`: its list, pages whose tables and plots are whole, and refusals before any work.

use crate::bad_input::with_chunk;
use crate::support::bake;
use glint_bake::input::synthetic;
use std::fs;
use std::path::Path;

/// Asserts that every table of a page has as many cells in each row as in its head, and that all its plots are there.
fn assert_page(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let cells = |line: &str| line.matches('|').count();
    let mut head: Option<&str> = None;
    for line in text.lines() {
        head = line.starts_with('|').then(|| head.unwrap_or(line));
        if let Some(head) = head {
            assert_eq!(cells(line), cells(head), "{line}\nunder {head}");
        }
    }
    for plot in text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(link, _)| link) {
        if plot.ends_with(".svg") {
            assert_svg(&path.with_file_name(plot));
        }
    }
    text
}

/// Asserts that a file is an SVG whose elements all end.
fn assert_svg(path: &Path) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.starts_with("<svg ") && text.trim_end().ends_with("</svg>"), "{text}");
    let mut open = Vec::new();
    for tag in text.split('<').skip(1) {
        let (tag, between) = tag.split_once('>').unwrap_or_else(|| panic!("<{tag} has no end"));
        let bare = |text: &str| text.replace("&lt;", "").replace("&gt;", "").replace("&amp;", "").contains('&');
        assert!(!bare(between) && tag.matches('"').count().is_multiple_of(2), "<{tag}>{between}");
        let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "{tag}");
        } else if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

#[test]
fn all_reports_are_listed_and_what_is_missing_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let list = bake(folder.path(), &["report", "--list", "--data", "nowhere"]).ok().stdout;
    for name in [
        "ndf-maps",
        "dictionary",
        "counting",
        "glints",
        "environment",
        "area-light",
        "lobes",
        "surface",
        "textures",
        "frames",
    ] {
        assert!(list.lines().any(|line| line.starts_with(&format!("{name} "))), "{name} is missing from:\n{list}");
    }
    assert!(list.contains("cannot be made here: nowhere/tiny/brushed_16x16.png"), "{list}");
}

#[test]
fn a_page_of_the_users_maps_has_its_tables_and_its_plot() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("leather.png");
    synthetic::leather(8, 8, 1).save(&path).unwrap();
    fs::write(&path, with_chunk(&fs::read(&path).unwrap(), b"sRGB", &[0])).unwrap();
    let report = ["report", "ndf-maps", "--maps", "leather.png", "--crop", "4x4+2+1", "--footprints", "2", "-o", "out"];
    let refused = bake(folder.path(), &[&report[..], &["--assume-linear", "--colour-space", "srgb"]].concat());
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(!folder.path().join("out").exists());
    bake(folder.path(), &[&report[..], &["--assume-linear", "--quick"]].concat()).ok();
    let text = assert_page(&folder.path().join("out/ndf-maps.md"));
    for part in [
        "`glint-bake report ndf-maps --maps leather.png --crop 4x4+2+1 --colour-space linear --footprints 2 -o out --quick`",
        "## leather, 4 × 4",
        "](ndf-maps-leather.svg)",
        "| tiled | 0.5 | 1 |",
        "| stochastic | 32 | 4 |",
        "★",
    ] {
        assert!(text.contains(part), "{part} is missing from:\n{text}");
    }
    // Six settings: those on the front filled, the others white disks with a rim, and one dot in the legend.
    let plot = fs::read_to_string(folder.path().join("out/ndf-maps-leather.svg")).unwrap();
    let off = plot.lines().filter(|line| line.starts_with("<circle") && line.contains("fill=\"#FFFFFF\"")).count();
    assert_eq!(plot.matches("<circle").count() - off, 6 + 1);
}

#[test]
fn the_headline_reaches_the_readme_and_nothing_else_of_it_changes() {
    let folder = tempfile::tempdir().unwrap();
    let readme = folder.path().join("README.md");
    fs::write(&readme, "# A\n\nDefault dictionary (of old).\n\nB\n").unwrap();
    bake(folder.path(), &["report", "dictionary", "--quick", "--readme", "README.md"]).ok();
    let page = assert_page(&folder.path().join("glint-report/dictionary.md"));
    let headline = page.lines().find(|line| line.starts_with("Default dictionary (")).unwrap();
    assert!(headline.contains("KiB, baked in"), "{headline}");
    assert_eq!(fs::read_to_string(&readme).unwrap(), format!("# A\n\n{headline}\n\nB\n"));
}

#[test]
fn counted_facets_are_measured_without_any_data() {
    let folder = tempfile::tempdir().unwrap();
    bake(folder.path(), &["report", "glints", "--quick", "-o", "out"]).ok();
    let page = assert_page(&folder.path().join("out/glints.md"));
    for part in ["| Beckmann | 0.03 |", "| 128² | 2.0000 |", "| a rectangle |", "](glints.svg)"] {
        assert!(page.contains(part), "{part} is missing from:\n{page}");
    }
}

#[test]
fn what_cannot_be_made_is_refused_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), b"in the way").unwrap();
    for (code, words, said) in [
        (2, &["report", "lobe"][..], "expected ndf-maps, dictionary"),
        (2, &["report", "lobes", "--maps", "leather.png"], "--maps"),
        (2, &["report", "ndf-maps", "--crop", "4x4+2+1"], "--maps"),
        (3, &["report", "lobes", "--data", "nowhere"], "nowhere/normals/scratched_gold"),
        (3, &["report", "ndf-maps", "--maps", "none.png"], "none.png"),
        (3, &["report", "dictionary", "-o", "file"], "file"),
        (3, &["report", "dictionary", "--readme", "none.md"], "none.md"),
        (4, &["report", "dictionary", "--readme", "file"], "expected a line that starts with"),
    ] {
        let outcome = bake(folder.path(), words);
        assert_eq!(outcome.code, code, "{words:?}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(said), "{words:?}: {}", outcome.stderr);
    }
    let frames = ["report", "frames", "--frames", "1", "--size", "8x8", "--adapter", "none", "--data", "nowhere"];
    assert_eq!(bake(folder.path(), &frames).code, if cfg!(feature = "view") { 3 } else { 5 });
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
