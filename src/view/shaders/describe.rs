//! What an engine calls of a method and what it binds, as data: for hosts that make layouts and bindings by program.

use crate::declared::{Declared, Kind, declared};
use crate::include::own_bindings;
use crate::translate::{Variant, variants};
use glint_bake_core::shaders::Shader;
use serde::Serialize;

/// A method's interface.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Interface {
    /// The method.
    pub method: String,
    /// Names of its files, one for each way in which packs store its data, without `glint_` and extension.
    pub variants: Vec<String>,
    /// What an engine calls.
    pub functions: Vec<Function>,
    /// What a host that has its own bindings writes.
    pub accessors: Vec<Function>,
    /// What such a host defines, in languages with a preprocessor.
    pub own_bindings: String,
    /// Resources of the ready bindings, by group and binding.
    pub bindings: Vec<BoundResource>,
}

/// A function.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Function {
    /// Its name in every language.
    pub name: String,
    /// Its signature in WGSL.
    pub signature: String,
    /// What it does.
    pub comment: String,
}

/// A resource.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct BoundResource {
    /// Group of WGSL and Metal's order, set of SPIR-V, space of HLSL.
    pub group: u32,
    /// Binding, and register of HLSL.
    pub binding: u32,
    /// Its name in every language.
    pub name: String,
    /// Its address space and type in WGSL: `var<uniform> GlintDictionaryTables`.
    pub declaration: String,
    /// Kind of the section of the pack whose bytes it holds; none where the host fills it, and of samplers.
    pub section: Option<String>,
    /// What it holds.
    pub comment: String,
}

/// The interface of a method.
///
/// # Panics
/// If it is none of [`crate::translate::methods`].
pub fn interface(method: &str) -> Interface {
    let variants = variants(method);
    let files = variants[0].files(method);
    let bind: Vec<Declared> =
        files.iter().filter(|file| file.name.starts_with("bind_")).flat_map(|file| declared(file)).collect();
    let is_include = |file: &&&Shader| file.name.starts_with("include_");
    let includes = files.iter().filter(is_include).flat_map(|file| declared(file));
    let mut bindings: Vec<BoundResource> = bind.iter().filter_map(resource).collect();
    bindings.sort();
    Interface {
        method: method.to_owned(),
        variants: variants.into_iter().map(|Variant { name, .. }| name).collect(),
        functions: includes.filter(|one| one.kind == Kind::Function).map(|one| function(&one)).collect(),
        accessors: bind
            .iter()
            .filter(|one| one.kind == Kind::Function && one.name.starts_with("glint_"))
            .map(function)
            .collect(),
        own_bindings: own_bindings(method),
        bindings,
    }
}

fn function(one: &Declared) -> Function {
    Function { name: one.name.clone(), signature: one.text.clone(), comment: one.comment.join(" ") }
}

/// A resource of `@group(1) @binding(0) var<uniform> tables: Tables;`.
fn resource(one: &Declared) -> Option<BoundResource> {
    let rest = one.text.strip_prefix("@group(")?;
    let (group, rest) = rest.split_once(") @binding(")?;
    let (binding, rest) = rest.split_once(") ")?;
    let (before, ty) = rest.trim_end_matches(';').split_once(": ")?;
    let comment = one.comment.join(" ");
    let section = comment.split_once("Section ").map(|(_, after)| after.chars().take(4).collect());
    Some(BoundResource {
        group: group.parse().ok()?,
        binding: binding.parse().ok()?,
        name: one.name.clone(),
        declaration: format!("{} {ty}", before.trim_end_matches(&one.name).trim_end()),
        section,
        comment,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_says_what_it_binds_and_what_is_called() {
        let found = interface("dictionary");
        let names: Vec<&str> = found.functions.iter().map(|function| function.name.as_str()).collect();
        assert_eq!(
            names,
            ["glint_dictionary_defaults", "glint_dictionary_eval", "glint_dictionary_sample", "glint_dictionary_pdf"]
        );
        let bound: Vec<(u32, Option<&str>)> =
            found.bindings.iter().map(|one| (one.binding, one.section.as_deref())).collect();
        assert_eq!(bound, [(0, Some("SDUB")), (1, Some("SDTB")), (2, None)]);
        assert_eq!(found.bindings[1].declaration, "var<storage, read> array<u32>");
        assert_eq!(found.accessors.len(), 3);
        for method in crate::translate::methods() {
            let found = interface(method);
            assert!(found.functions.iter().all(|one| !one.comment.is_empty()), "{method}: {:?}", found.functions);
            let mut slots: Vec<(u32, u32)> = found.bindings.iter().map(|one| (one.group, one.binding)).collect();
            slots.dedup();
            assert_eq!(slots.len(), found.bindings.len(), "{method}");
            assert!(found.bindings.iter().filter(|one| one.section.is_some()).count() >= 2, "{method}");
        }
    }
}
