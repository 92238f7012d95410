//! A shader and its twin are the same functions in the same order; what must differ stands in `twin_exceptions.txt` with its reason.
//!
//! The twin of `lobes/query.wgsl` is `lobes/query.rs`. A function of WGSL is called `glint_` and the name of its twin, with a short
//! name of the method between where names of several methods would meet: `glint_lobes_cell` is `cell`.

use crate::crates::root;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{ImplItemFn, ItemFn, ItemMod};

/// Share of a workspace's shader functions that may have no twin.
const MOST_EXCEPTIONS: f64 = 0.15;

/// Short names of methods that are not the names of their folders.
const SHORT_NAMES: [(&str, &str); 1] = [("ndf_maps", "ndf")];

/// WGSL files of the run time, from the repository's root.
fn shaders() -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![root().join("bake/src")];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension == "wgsl") {
                found.push(path);
            }
        }
    }
    found.sort();
    assert!(found.len() > 10, "{found:?}");
    found
}

fn relative(path: &Path) -> String {
    path.strip_prefix(root()).unwrap().to_str().unwrap().to_owned()
}

/// Functions of a WGSL file in their order.
fn wgsl_functions(text: &str) -> Vec<String> {
    let declared = text.lines().filter_map(|line| line.strip_prefix("fn "));
    declared.map(|rest| rest.split('(').next().unwrap().to_owned()).collect()
}

/// Functions of a Rust file in their order, those of tests left out.
#[derive(Default)]
struct RustFunctions(Vec<String>);

impl<'ast> Visit<'ast> for RustFunctions {
    fn visit_item_fn(&mut self, item: &'ast ItemFn) {
        self.0.push(item.sig.ident.to_string());
        visit::visit_item_fn(self, item);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast ImplItemFn) {
        self.0.push(item.sig.ident.to_string());
        visit::visit_impl_item_fn(self, item);
    }

    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        if !item.attrs.iter().any(|attribute| attribute.path().is_ident("cfg")) {
            visit::visit_item_mod(self, item);
        }
    }
}

fn rust_functions(text: &str) -> Vec<String> {
    let mut functions = RustFunctions::default();
    functions.visit_file(&syn::parse_file(text).unwrap());
    functions.0
}

/// The twin of a function of WGSL among these.
fn twin<'a>(function: &str, shader: &Path, among: &'a [String]) -> Option<&'a String> {
    let bare = function.strip_prefix("glint_")?;
    let folder = shader.parent().unwrap().file_name().unwrap().to_str().unwrap();
    let short = SHORT_NAMES.iter().find(|row| row.0 == folder).map_or(folder, |row| row.1);
    let within = bare.strip_prefix(&format!("{short}_"));
    among.iter().find(|name| *name == bare || Some(name.as_str()) == within)
}

/// Exceptions: file and function, whose reasons are checked to be there.
fn exceptions() -> BTreeSet<(String, String)> {
    let text = fs::read_to_string(root().join("tests/house/twin_exceptions.txt")).unwrap();
    let mut found = BTreeSet::new();
    for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let (place, reason) = line.split_once(" — ").unwrap_or_else(|| panic!("no reason in {line:?}"));
        let (file, function) = place.split_once(": ").unwrap_or_else(|| panic!("no function in {line:?}"));
        assert!(reason.len() > 10, "what reason is {reason:?}?");
        assert!(found.insert((file.to_owned(), function.to_owned())), "{place} stands twice");
    }
    found
}

#[test]
fn shaders_and_their_twins_are_the_same_functions() {
    let exceptions = exceptions();
    let mut needed = BTreeSet::new();
    let mut problems = String::new();
    let mut functions = 0;
    for shader in shaders() {
        let path = shader.with_extension("rs");
        let Ok(text) = fs::read_to_string(&path) else {
            problems.push_str(&format!("{} has no twin\n", relative(&shader)));
            continue;
        };
        let in_rust = rust_functions(&text);
        let in_wgsl = wgsl_functions(&fs::read_to_string(&shader).unwrap());
        functions += in_wgsl.len();
        let mut order = Vec::new();
        for function in &in_wgsl {
            match twin(function, &shader, &in_rust) {
                Some(name) => order.push(in_rust.iter().position(|other| other == name).unwrap()),
                None => {
                    needed.insert((relative(&shader), function.clone()));
                }
            }
        }
        if let Some(at) = order.windows(2).position(|pair| pair[0] >= pair[1]) {
            let (before, after) = (&in_rust[order[at]], &in_rust[order[at + 1]]);
            problems.push_str(&format!("{}: {after} stands before {before}, in WGSL after it\n", relative(&path)));
        }
        let twins: BTreeSet<usize> = order.into_iter().collect();
        let alone = in_rust.iter().enumerate().filter(|(at, _)| !twins.contains(at));
        needed.extend(alone.map(|(_, function)| (relative(&path), function.clone())));
    }
    for (file, function) in needed.difference(&exceptions) {
        problems.push_str(&format!("{file}: {function} has no twin\n"));
    }
    for (file, function) in exceptions.difference(&needed) {
        problems.push_str(&format!("twin_exceptions.txt: {file}: {function} is none\n"));
    }
    let of_wgsl = needed.iter().filter(|(file, _)| file.ends_with(".wgsl")).count();
    if of_wgsl as f64 > MOST_EXCEPTIONS * functions as f64 {
        problems.push_str(&format!("{of_wgsl} of {functions} functions of WGSL have no twin\n"));
    }
    assert!(problems.is_empty(), "{problems}");
}

#[test]
fn names_of_twins_are_found() {
    let names: Vec<String> = ["cell", "lod"].map(str::to_owned).to_vec();
    let of = |function: &str, file: &str| twin(function, Path::new(file), &names).cloned();
    assert_eq!(of("glint_lobes_cell", "lobes/query.wgsl").as_deref(), Some("cell"));
    assert_eq!(of("glint_ndf_lod", "ndf_maps/query.wgsl").as_deref(), Some("lod"));
    assert_eq!(of("glint_lod", "ndf_maps/query.wgsl").as_deref(), Some("lod"));
    assert_eq!(of("glint_lobes_cell", "ndf_maps/query.wgsl"), None);
    assert_eq!(of("lod", "ndf_maps/query.wgsl"), None);
    let found: BTreeMap<usize, String> =
        wgsl_functions("fn a(x: f32) {\n}\n  fn b\nfn c(").into_iter().enumerate().collect();
    assert_eq!(found.into_values().collect::<Vec<_>>(), ["a", "c"]);
    assert_eq!(rust_functions("fn a() {} impl X { fn b(&self) {} } #[cfg(test)] mod tests { fn c() {} }"), ["a", "b"]);
}
