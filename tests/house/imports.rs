//! No two modules of a crate import each other, directly or around a longer circle, and no crate imports upwards.
//!
//! An arrow runs from a file to the file whose item it names, in `use` lines and in paths within code. `mod child;` is none.

use crate::crates::{Crate, all, root};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use syn::visit::{self, Visit};
use syn::{File, Item, ItemMod, ItemUse, Path, UseTree};

/// Module paths that a file names.
struct Names<'a> {
    of: &'a Crate,
    /// Module of the file.
    module: &'a [String],
    /// How many inline modules, which share the file, the visitor is in.
    inline: usize,
    named: BTreeSet<Vec<String>>,
}

impl Names<'_> {
    /// Adds the file that a path leads to, if it is one of this crate's.
    fn add(&mut self, path: &[String]) {
        let Some(first) = path.first() else { return };
        let mut at: Vec<String> = Vec::new();
        let mut rest = path;
        match first.as_str() {
            "crate" => rest = &path[1..],
            "self" => {
                at = self.module.to_vec();
                rest = &path[1..];
            }
            "super" => {
                let ups = path.iter().take_while(|part| *part == "super").count();
                rest = &path[ups..];
                // The first steps up leave inline modules, not the file.
                let ups = ups.saturating_sub(self.inline).min(self.module.len());
                at = self.module[..self.module.len() - ups].to_vec();
            }
            // A path from here: a child, if there is one of this name.
            _ => {
                at = self.module.to_vec();
                let child: Vec<String> = at.iter().chain([first]).cloned().collect();
                if !self.of.files.contains_key(&child) {
                    return;
                }
            }
        }
        for part in rest {
            let next: Vec<String> = at.iter().chain([part]).cloned().collect();
            if !self.of.files.contains_key(&next) {
                break;
            }
            at = next;
        }
        if at != self.module {
            self.named.insert(at);
        }
    }

    fn add_tree(&mut self, tree: &UseTree, before: &mut Vec<String>) {
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.add_tree(&path.tree, before);
                before.pop();
            }
            UseTree::Group(group) => group.items.iter().for_each(|item| self.add_tree(item, before)),
            UseTree::Name(name) => self.add(&[&before[..], &[name.ident.to_string()]].concat()),
            UseTree::Rename(rename) => self.add(&[&before[..], &[rename.ident.to_string()]].concat()),
            UseTree::Glob(_) => self.add(before),
        }
    }
}

impl<'ast> Visit<'ast> for Names<'_> {
    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        self.add_tree(&item.tree, &mut Vec::new());
    }

    fn visit_path(&mut self, path: &'ast Path) {
        let parts: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        // A single name is what a `use` line brought, or an item of the file.
        if parts.len() > 1 {
            self.add(&parts);
        }
        visit::visit_path(self, path);
    }

    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        let is_test = item.attrs.iter().any(|attribute| attribute.path().is_ident("cfg"));
        if item.content.is_some() && !is_test {
            self.inline += 1;
            visit::visit_item_mod(self, item);
            self.inline -= 1;
        }
    }
}

/// Arrows of a crate: from each file to the files that it names.
fn arrows(of: &Crate) -> BTreeMap<Vec<String>, BTreeSet<Vec<String>>> {
    let mut arrows = BTreeMap::new();
    for (module, path) in &of.files {
        let text = fs::read_to_string(path).unwrap();
        let file: File = syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let mut names = Names { of, module, inline: 0, named: BTreeSet::new() };
        names.visit_file(&file);
        arrows.insert(module.clone(), names.named);
    }
    arrows
}

/// Files that can be reached from each other: every group of more than one.
fn circles<T: Clone + Ord>(arrows: &BTreeMap<T, BTreeSet<T>>) -> Vec<Vec<T>> {
    let reached = |from: &T| {
        let mut reached = BTreeSet::new();
        let mut open = vec![from];
        while let Some(at) = open.pop() {
            for next in arrows.get(at).into_iter().flatten() {
                if reached.insert(next) {
                    open.push(next);
                }
            }
        }
        reached
    };
    let all: BTreeMap<&T, BTreeSet<&T>> = arrows.keys().map(|from| (from, reached(from))).collect();
    let mut circles: Vec<Vec<T>> = Vec::new();
    for (from, reached) in &all {
        if reached.contains(from) && !circles.iter().flatten().any(|known| known == *from) {
            let back = |other: &&&T| all.get(**other).is_some_and(|there| there.contains(*from));
            circles.push(reached.iter().filter(back).map(|other| (*other).clone()).collect());
        }
    }
    circles
}

#[test]
fn no_two_modules_import_each_other() {
    let mut problems = String::new();
    for of in all() {
        let arrows = arrows(&of);
        for circle in circles(&arrows) {
            problems.push_str(&format!("a circle of {} in {}:\n", circle.len(), of.name));
            for from in &circle {
                for to in arrows[from].intersection(&circle.iter().cloned().collect()) {
                    problems.push_str(&format!("  {} -> {}\n", from.join("::"), to.join("::")));
                }
            }
        }
    }
    assert!(problems.is_empty(), "{problems}");
}

/// Methods are declared in `methods.rs`, with their folders as paths.
#[test]
fn every_file_is_a_module_of_its_crate() {
    for of in all() {
        let declared = |module: &[String]| {
            let path = of.files.get(module).unwrap_or_else(|| panic!("{}: there is no module {module:?}", of.name));
            let file = syn::parse_file(&fs::read_to_string(path).unwrap()).unwrap();
            let modules = file.items.iter().filter_map(|item| match item {
                Item::Mod(module) => Some(module.ident.to_string()),
                _ => None,
            });
            modules.collect::<Vec<_>>()
        };
        for (module, path) in &of.files {
            let Some((name, parent)) = module.split_last() else { continue };
            let mut names = declared(parent);
            if parent.is_empty() && of.files.contains_key(&["methods".to_owned()][..]) {
                names.extend(declared(&["methods".to_owned()]));
            }
            assert!(names.contains(name), "{} is declared nowhere", path.display());
        }
    }
}

#[test]
fn a_circle_is_found() {
    let arrows = |pairs: &[(&'static str, &'static str)]| {
        let mut arrows: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for &(from, to) in pairs {
            arrows.entry(from).or_default().insert(to);
            arrows.entry(to).or_default();
        }
        arrows
    };
    assert!(circles(&arrows(&[("a", "b"), ("b", "c"), ("a", "c")])).is_empty());
    assert_eq!(circles(&arrows(&[("a", "b"), ("b", "c"), ("c", "a"), ("d", "a")])), [["a", "b", "c"]]);
    assert_eq!(circles(&arrows(&[("a", "b"), ("b", "a"), ("c", "d"), ("d", "c")])).len(), 2);
}

#[test]
fn every_way_to_name_a_module_is_seen() {
    let files = ["", "a", "a::b", "a::c", "d"]
        .map(|module| (module.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect(), root().into()));
    let of = Crate { name: "example", files: files.into_iter().collect() };
    let named = |module: &str, text: &str| {
        let module: Vec<String> = module.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect();
        let mut names = Names { of: &of, module: &module, inline: 0, named: BTreeSet::new() };
        names.visit_file(&syn::parse_file(text).unwrap());
        names.named.into_iter().map(|path| path.join("::")).collect::<Vec<_>>()
    };
    assert_eq!(named("a::b", "use crate::d::Thing; use super::c;"), ["a::c", "d"]);
    assert_eq!(named("a::b", "use super::Thing;"), ["a"]);
    assert_eq!(named("a", "mod b; pub use b::{X, Y};"), ["a::b"]);
    assert_eq!(named("a", "mod b; mod c;"), [""; 0]);
    assert_eq!(named("d", "fn f() { crate::a::c::g(); }"), ["a::c"]);
    assert_eq!(named("a", "mod inline { use super::b::X; use super::super::d; }"), ["a::b", "d"]);
    assert_eq!(named("a", "#[cfg(test)] mod tests { use super::*; use crate::d; }"), [""; 0]);
    assert_eq!(named("a::b", "use std::fmt; fn f(x: T) -> fmt::Result { T::new() }"), [""; 0]);
}

/// Crates from the ground up, with those that each may name.
const MAY_NAME: [(&str, &[&str]); 5] = [
    ("formats", &[]),
    ("bake", &["glint_formats"]),
    ("src/view/shaders", &["glint_formats", "glint_bake_core"]),
    ("src/view", &["glint_formats", "glint_bake_core", "glint_shaders"]),
    ("src", &["glint_formats", "glint_bake_core", "glint_shaders", "glint_view"]),
];

#[test]
fn no_crate_imports_upwards() {
    let crates = ["glint_formats", "glint_bake_core", "glint_shaders", "glint_view", "glint_bake"];
    for of in all() {
        let (_, may) = MAY_NAME.iter().find(|row| row.0 == of.name).unwrap();
        for path in of.files.values() {
            let text = fs::read_to_string(path).unwrap();
            for other in crates.iter().filter(|other| !may.contains(other)) {
                let names = text.contains(&format!("{other}::"));
                assert!(!names, "{} names {other}, which stands above it", path.display());
            }
        }
    }
}
