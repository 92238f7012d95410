//! Files that an engine includes, from a program that naga has translated: the library with a guard a file of its source, so that several
//! methods go into one shader, and the ready bindings, which a host may leave out; beside them the example that calls it.

use crate::declared::{Declared, Kind, declared, head, is_word};
use crate::items::{Item, items};
use glint_bake_core::shaders::Shader;
use std::collections::{BTreeMap, BTreeSet};

/// What is written of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parts {
    /// The file to include.
    pub library: String,
    /// What calls it, without the line that includes it.
    pub example: String,
}

/// Where a declaration comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Origin {
    /// A file of the library, by its place in the program.
    Library(usize),
    /// Bindings and accessors.
    Bindings,
    /// The example.
    Example,
    /// What naga adds.
    Helper,
}

struct Source<'a> {
    files: &'a [&'static Shader],
    /// Files that the method calls; others are there for what the bindings hold.
    called: &'a [&'a str],
    by_name: BTreeMap<String, (Origin, Declared)>,
}

impl<'a> Source<'a> {
    fn of(files: &'a [&'static Shader], called: &'a [&'a str]) -> Self {
        let mut by_name = BTreeMap::new();
        for (index, file) in files.iter().enumerate() {
            let origin = match file.name {
                name if name.starts_with("bind_") => Origin::Bindings,
                name if name.starts_with("example_") => Origin::Example,
                _ => Origin::Library(index),
            };
            for one in declared(file) {
                by_name.insert(one.name.clone(), (origin, one));
            }
        }
        Source { files, called, by_name }
    }

    fn origin(&self, item: &Item) -> Origin {
        match self.by_name.get(&item.name) {
            Some((origin, _)) => *origin,
            None if item.name.is_empty() || item.name.starts_with("main") || item.name == "_mslBufferSizes" => {
                Origin::Example
            }
            None => Origin::Helper,
        }
    }
}

/// Writes the files of one program.
struct Writer<'a> {
    source: &'a Source<'a>,
    items: &'a [Item],
    /// naga's helpers by name; some have several functions of one name.
    helpers: &'a BTreeMap<&'a str, Vec<&'a Item>>,
    /// Helpers and prototypes that are written.
    written: BTreeSet<String>,
    text: String,
}

impl Writer<'_> {
    /// Lines as a comment.
    fn comment(&mut self, lines: &[impl AsRef<str>]) {
        for line in lines {
            self.text.push_str(format!("// {}", line.as_ref()).trim_end());
            self.text.push('\n');
        }
    }

    /// The helpers of naga that `item` calls, each before the first that calls it and under a guard of its own.
    fn helpers_of(&mut self, item: &Item) {
        let helpers = self.helpers;
        for helper in item.words().filter_map(|word| helpers.get(word)).flatten() {
            let signature = helper_guard(helper);
            if self.written.insert(signature.clone()) {
                self.helpers_of(helper);
                self.text.push_str(&format!("#ifndef {signature}\n#define {signature}\n{}#endif\n", helper.text));
            }
        }
    }

    /// An item with its comments, after what it needs of naga's.
    fn item(&mut self, item: &Item) {
        self.helpers_of(item);
        let Some((_, one)) = self.source.by_name.get(&item.name) else {
            self.text.push_str(&item.text);
            return;
        };
        if one.kind != Kind::Constant {
            self.text.push('\n');
        }
        self.comment(&one.comment);
        for line in item.text.lines() {
            // A struct's members have their comments above them.
            let declared = line.trim_end_matches(';').split('[').next().unwrap_or("");
            let last = declared.rsplit(|c: char| !is_word(c)).next();
            let is_member = one.kind == Kind::Struct && line.ends_with(';');
            let member = one.members.iter().find(|(name, _)| is_member && last == Some(name.as_str()));
            for text in member.iter().flat_map(|(_, comment)| comment) {
                self.text.push_str(&format!("    // {text}\n"));
            }
            self.text.push_str(line);
            self.text.push('\n');
        }
    }

    /// Prototypes of functions that `item` calls and that stand in files after the one of `origin`.
    fn prototypes(&mut self, item: &Item, origin: Origin) {
        let items = self.items;
        let words: BTreeSet<&str> = item.words().collect();
        for other in items.iter().filter(|other| other.is_function && words.contains(other.name.as_str())) {
            let is_later = (origin < self.source.origin(other)) && (self.source.origin(other) < Origin::Example);
            if is_later && self.written.insert(format!("prototype {}", other.name)) {
                let prototype = other.prototype();
                self.helpers_of(&Item { text: prototype.clone(), ..other.clone() });
                self.text.push_str(&prototype);
            }
        }
    }

    /// Whether a struct of the bindings holds this one, which a host then needs whatever it calls.
    fn is_bound(&self, item: &Item) -> bool {
        let holds = |other: &&Item| self.source.origin(other) == Origin::Bindings && other.text.starts_with("struct ");
        item.text.starts_with("struct ")
            && self.items.iter().filter(holds).any(|other| other.words().any(|word| word == item.name))
    }

    /// An item under a guard of its own, for what several files have in common.
    fn shared(&mut self, item: &Item) {
        // A resource may have an accessor of its name.
        let kind = if item.is_function { "function" } else { "bound" };
        let guard = guard(&format!("{kind} {} defined", item.name));
        self.text.push_str(&format!("\n#ifndef {guard}\n#define {guard}\n"));
        self.item(item);
        self.text.push_str("#endif\n");
    }

    /// All of one file of the library, or what the bindings hold of one that the method does not call.
    fn file(&mut self, index: usize) {
        let (source, items) = (self.source, self.items);
        let file = source.files[index];
        let mine: Vec<&Item> = items.iter().filter(|item| source.origin(item) == Origin::Library(index)).collect();
        if !source.called.contains(&file.name) {
            let bound: Vec<&Item> = mine.into_iter().filter(|item| self.is_bound(item)).collect();
            bound.into_iter().for_each(|item| self.shared(item));
            return;
        }
        if mine.is_empty() {
            return;
        }
        let guard = guard(&format!("{} included", file.name));
        self.text.push_str(&format!("\n#ifndef {guard}\n#define {guard}\n"));
        self.comment(&head(file));
        self.text.push('\n');
        let (functions, others): (Vec<&Item>, Vec<&Item>) = mine.into_iter().partition(|item| item.is_function);
        for item in others {
            if self.is_bound(item) {
                self.shared(item);
            } else {
                self.item(item);
            }
        }
        for item in functions {
            self.prototypes(item, Origin::Library(index));
            self.item(item);
        }
        self.text.push_str(&format!("#endif // {guard}\n"));
    }

    /// Resources and accessors, unless the host has its own.
    fn bindings(&mut self, own: &str) {
        let (source, items) = (self.source, self.items);
        self.text.push_str(&format!(
            "\n// Resources and accessors. A host that defines {own} before it includes this file writes the accessors itself.\n\
             #ifndef {own}\n"
        ));
        // Methods have some of them in common.
        items.iter().filter(|item| source.origin(item) == Origin::Bindings).for_each(|item| self.shared(item));
        self.text.push_str(&format!("#endif // {own}\n"));
    }
}

/// Guard of one of naga's helpers: what makes and clears a type has its name, others have several functions of one name.
fn helper_guard(helper: &Item) -> String {
    let has_own_name = ["Construct", "ZeroValue", "ret_", "glint_"].iter().any(|start| helper.name.starts_with(start));
    guard(if has_own_name { &helper.name } else { helper.text.lines().next().unwrap_or("") })
}

/// A name for the preprocessor that stands for `text`.
fn guard(text: &str) -> String {
    let words: Vec<String> = text
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_uppercase)
        .collect();
    format!("GLINT_{}", words.join("_").trim_start_matches("GLINT_"))
}

/// Name that a host defines to leave out the resources and accessors of a method.
pub fn own_bindings(method: &str) -> String {
    guard(&format!("{method} own bindings"))
}

/// Takes a translated program apart. `files` are those of the program in its order, of which the method calls those `called`; the library
/// begins with `before`.
pub fn arrange(method: &str, files: &[&'static Shader], called: &[&str], translated: &str, before: &str) -> Parts {
    let source = Source::of(files, called);
    let items = items(&with_their_names(files, translated));
    let mut helpers: BTreeMap<&str, Vec<&Item>> = BTreeMap::new();
    for item in items.iter().filter(|item| source.origin(item) == Origin::Helper) {
        helpers.entry(&item.name).or_default().push(item);
    }
    let (source, items, helpers) = (&source, &items[..], &helpers);
    let mut library = Writer { source, items, helpers, written: BTreeSet::new(), text: before.to_owned() };
    for index in 0..files.len() {
        library.file(index);
    }
    library.bindings(&own_bindings(method));

    let Writer { written, text, .. } = library;
    let mut example = Writer { source, items, helpers, written, text: String::new() };
    for item in items.iter().filter(|item| source.origin(item) == Origin::Example) {
        // Those for the preprocessor are the caller's.
        if !item.text.starts_with('#') && !item.text.starts_with("using ") {
            example.item(item);
        }
    }
    Parts { library: text, example: example.text }
}

/// What types of vectors are called in these languages, without their sizes.
const TYPES: [&str; 7] = ["half", "float", "double", "int", "uint", "bool", "vec"];

/// The text with the names of the source: naga appends a line to names that end in a digit, to have room for numbers.
fn with_their_names(files: &[&'static Shader], text: &str) -> String {
    let words = |text: &str| -> BTreeSet<String> {
        text.split(|c: char| !is_word(c)).filter(|word| !word.is_empty()).map(str::to_owned).collect()
    };
    let there = words(text);
    let named: BTreeSet<String> = files.iter().flat_map(|file| words(file.source)).collect();
    let restored = |word: &str| {
        let bare = word.strip_suffix('_')?;
        let is_type = TYPES.contains(&bare.trim_end_matches(|c: char| c.is_ascii_digit()));
        let is_named = bare.ends_with(|c: char| c.is_ascii_digit()) && named.contains(bare);
        (is_named && !is_type && !there.contains(bare)).then(|| bare.to_owned())
    };
    replace_words(text, restored)
}

/// The text with some of its words replaced.
pub fn replace_words(text: &str, mut replacement: impl FnMut(&str) -> Option<String>) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(is_word) {
        out.push_str(&rest[..start]);
        let tail = &rest[start..];
        let end = tail.find(|c: char| !is_word(c)).unwrap_or(tail.len());
        let word = &tail[..end];
        out.push_str(&replacement(word).unwrap_or_else(|| word.to_owned()));
        rest = &tail[end..];
    }
    out.push_str(rest);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_replaced_whole() {
        let found = replace_words("f0_ + f0_1 - (f0_)", |word| (word == "f0_").then(|| "f0".to_owned()));
        assert_eq!(found, "f0 + f0_1 - (f0)");
        assert_eq!(guard("float2 naga_f2i32(float2 v)"), "GLINT_FLOAT2_NAGA_F2I32_FLOAT2_V");
        assert_eq!(own_bindings("ndf_maps"), "GLINT_NDF_MAPS_OWN_BINDINGS");
    }
}
