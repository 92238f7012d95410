//! The library in the languages of engines, for `glint-bake shaders`: WGSL as it is, other languages through naga's back ends.
//!
//! A method is one file to include, `glint_<method>`, with the ready bindings of `bind_<method>.wgsl`; `example_<method>` calls it. Where
//! packs store data in several ways there is a file for each, see [`CHOICES`]. Group and binding are kept as SPIR-V's descriptor set and
//! binding and as HLSL's space and register. GLSL counts uniform buffers, storage buffers and textures each from 0, Metal buffers,
//! textures and samplers, in the order of groups and bindings; the functions of Metal get resources as arguments. Loops of the library
//! are bounded, so no counters are added to them.

use crate::backends::{GLSL_SLOTS, to_glsl, to_hlsl, to_msl, to_spirv};
use crate::declared::{Kind, declared, head};
use crate::include::{Parts, arrange};
use crate::{CHOICES, module, modules, parts, text};
use glint_bake_core::shaders::Shader;
use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// A shading language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// WebGPU's, as the library is written.
    Wgsl,
    /// Shader model 5.1.
    Hlsl,
    /// Version 4.50, which GLSL ES 3.10 differs from in its first line and precisions.
    Glsl,
    /// Metal 2.0.
    Msl,
    /// Version 1.0, binary.
    Spirv,
}

impl Language {
    /// Every language.
    pub const ALL: [Language; 5] = [Language::Wgsl, Language::Hlsl, Language::Glsl, Language::Msl, Language::Spirv];

    /// Extension of the files to include.
    pub fn extension(self) -> &'static str {
        match self {
            Language::Wgsl => "wgsl",
            Language::Hlsl => "hlsl",
            Language::Glsl => "glsl",
            Language::Msl => "metal",
            Language::Spirv => "spv",
        }
    }

    /// Extension of examples: those that compilers expect of compute programs.
    fn example_extension(self) -> &'static str {
        match self {
            Language::Glsl => "comp",
            other => other.extension(),
        }
    }
}

/// A file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShaderFile {
    /// Its name.
    pub name: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// Why a program has no translation.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{program} cannot be written as {language:?}: {reason}")]
pub struct TranslateError {
    /// Name of the program.
    pub program: String,
    /// The language.
    pub language: Language,
    /// What naga says.
    pub reason: String,
}

/// What the library uses beyond the least that naga knows; every WebGPU adapter has both.
pub const CAPABILITIES: Capabilities = Capabilities::CUBE_ARRAY_TEXTURES.union(Capabilities::SHADER_FLOAT16_IN_FLOAT32);

/// One way in which packs store a method's data: what its files are called, and the files of [`CHOICES`] that it takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variant {
    /// The method's name, and what of the storage is not the first choice: `surface_half_tiles`.
    pub name: String,
    /// Files of the library.
    pub choices: Vec<&'static str>,
}

impl Variant {
    /// Names of the files of the library that the method calls.
    fn called(&self, method: &str) -> Vec<&'static str> {
        let include = format!("include_{method}");
        let all = parts(&[&[include.as_str()], &self.choices[..]].concat());
        all.into_iter().map(|file| file.name).collect()
    }

    /// Files of its example, what is needed before what needs it.
    pub(crate) fn files(&self, method: &str) -> Vec<&'static Shader> {
        let example = format!("example_{method}");
        let example = module(&example).unwrap_or_else(|| panic!("there is no {example}.wgsl"));
        let all = parts(&[&[example.name], &self.choices[..]].concat());
        all.into_iter().filter(|file| file.name != "bind_loads").collect()
    }
}

/// Names of the methods: one for every `include_<method>.wgsl` with an example.
pub fn methods() -> Vec<&'static str> {
    let included = modules().filter_map(|module| module.name.strip_prefix("include_"));
    included.filter(|method| module(&format!("example_{method}")).is_some()).collect()
}

/// The variants of a method, the usual storage first.
pub fn variants(method: &str) -> Vec<Variant> {
    let groups = CHOICES.iter().filter(|choices| choices.0 == method).flat_map(|choices| choices.1);
    let mut found = vec![Variant { name: method.to_owned(), choices: Vec::new() }];
    for group in groups {
        let with = |variant: &Variant, (place, file): (usize, &&'static str)| {
            let mut variant = variant.clone();
            variant.choices.push(file);
            if place > 0 {
                variant.name = format!("{}_{}", variant.name, file.rsplit("::").next().unwrap_or(file));
            }
            variant
        };
        found =
            group.iter().enumerate().flat_map(|file| found.iter().map(move |variant| with(variant, file))).collect();
    }
    found
}

/// The files of these methods in a language, in a fixed order.
///
/// # Errors
/// [`TranslateError`] names the program and what naga finds wrong with it.
///
/// # Panics
/// If a method is none of [`methods`].
pub fn files(language: Language, methods: &[&str]) -> Result<Vec<ShaderFile>, TranslateError> {
    let mut found = if language == Language::Wgsl { library(methods) } else { Vec::new() };
    for method in methods {
        for variant in variants(method) {
            found.extend(written(language, method, &variant)?);
        }
    }
    Ok(found)
}

/// The library's files that the methods need, with their bindings and examples, in the order of [`modules`].
fn library(methods: &[&str]) -> Vec<ShaderFile> {
    let needed: Vec<&Shader> = methods
        .iter()
        .flat_map(|method| variants(method).into_iter().flat_map(move |variant| variant.files(method)))
        .collect();
    let exported = modules().filter(|shader| needed.contains(shader));
    exported.map(|shader| ShaderFile { name: file_name(shader), bytes: plain_text(shader).into() }).collect()
}

/// The files of one variant.
fn written(language: Language, method: &str, variant: &Variant) -> Result<Vec<ShaderFile>, TranslateError> {
    let files = variant.files(method);
    let name = format!("glint_{}.{}", variant.name, language.extension());
    if language == Language::Wgsl {
        let of_library =
            files.iter().filter(|file| !["bind_", "example_"].iter().any(|kind| file.name.starts_with(kind)));
        let library: String = of_library.map(|file| for_engines(file)).collect();
        return Ok(vec![ShaderFile { name, bytes: format!("{}\n{library}", header(method)).into() }]);
    }
    let example = format!("example_{}.{}", variant.name, language.example_extension());
    let fail = |reason: String| TranslateError { program: variant.name.clone(), language, reason };
    let source: String = files.iter().map(|file| for_engines(file)).collect();
    let module = naga::front::wgsl::parse_str(&source).map_err(|e| fail(e.emit_to_string(&source)))?;
    let info = Validator::new(ValidationFlags::all(), CAPABILITIES)
        .validate(&module)
        .map_err(|e| fail(e.emit_to_string(&source)))?;
    let translated = match language {
        Language::Spirv => {
            return Ok(vec![ShaderFile { name: example, bytes: to_spirv(&module, &info).map_err(fail)? }]);
        }
        Language::Hlsl => to_hlsl(&module, &info),
        Language::Glsl => to_glsl(&module, &info),
        Language::Msl => to_msl(&module, &info),
        Language::Wgsl => Ok(source),
    };
    let about = header(method);
    let before = match language {
        Language::Msl => format!("{about}\n{METAL_HEAD}{}", forward_declarations(&files)),
        Language::Glsl => format!("{about}\n{GLSL_SLOTS}"),
        _ => format!("{about}\n"),
    };
    // An example is a program, a library is not.
    let first = if language == Language::Glsl { GLSL_HEAD } else { "" };
    let Parts { library, example: calls } =
        arrange(method, &files, &variant.called(method), &translated.map_err(fail)?, &before);
    let about = format!("// An example of how {name} is called: a compute program.\n\n#include \"{name}\"\n");
    Ok(vec![
        ShaderFile { name: example, bytes: format!("{first}{about}{calls}").into() },
        ShaderFile { name, bytes: library.into() },
    ])
}

/// What examples in GLSL begin with.
const GLSL_HEAD: &str = "#version 450\n#extension GL_GOOGLE_include_directive : require\n\n";

/// What files in Metal's language begin with.
const METAL_HEAD: &str = "#pragma once\n#include <metal_stdlib>\n#include <simd/simd.h>\n\nusing metal::uint;\n";

/// Structs of the bindings, which functions of Metal hand on before they are defined.
fn forward_declarations(files: &[&'static Shader]) -> String {
    let bound = files.iter().filter(|file| file.name.starts_with("bind_")).flat_map(|file| declared(file));
    bound.filter(|one| one.kind == Kind::Struct).map(|one| format!("struct {};\n", one.name)).collect()
}

/// What every file begins with.
fn header(method: &str) -> String {
    let include = format!("include_{method}");
    let about = head(module(&include).unwrap_or_else(|| panic!("there is no {include}.wgsl")));
    let lines = [
        "SPDX-License-Identifier: MIT OR Apache-2.0".to_owned(),
        format!("Of glint-bake {}, written by glint-bake shaders.", env!("CARGO_PKG_VERSION")),
        String::new(),
    ];
    let lines = lines.into_iter().chain(about.into_iter().map(str::to_owned));
    lines.map(|line| format!("// {line}").trim_end().to_owned() + "\n").collect()
}

/// The text of a file for engines, which do not count loads.
fn for_engines(shader: &Shader) -> String {
    let counts = |line: &&str| line.contains("bound_loads");
    text(shader).lines().filter(|line| !counts(line)).flat_map(|line| [line, "\n"]).collect()
}

/// Path of an exported file: `lobes/query.wgsl` for `lobes::query`.
pub fn file_name(shader: &Shader) -> String {
    format!("{}.wgsl", shader.name.replace("::", "/"))
}

/// The text of a file for compilers that know no imports: each `#import` line says the file that is called as a comment.
pub fn plain_text(shader: &Shader) -> String {
    let line = |line: &str| match line.strip_prefix("#import ") {
        Some(name) => format!("// Calls {}.wgsl.\n", name.trim().replace("::", "/")),
        None => format!("{line}\n"),
    };
    let lines = shader.source.lines().filter(|line| !line.contains("bound_loads") && *line != "#import bind_loads");
    lines.map(line).collect()
}

/// Instructions of a program as SPIR-V, declarations left out: its length as a driver gets it, before it is optimised.
///
/// # Errors
/// What naga finds wrong with the text.
pub fn spirv_instructions(source: &str) -> Result<usize, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string(source))?;
    let info =
        Validator::new(ValidationFlags::all(), CAPABILITIES).validate(&module).map_err(|e| e.emit_to_string(source))?;
    let (module, info) = naga::back::pipeline_constants::process_overrides(&module, &info, None, &Default::default())
        .map_err(|e| e.to_string())?;
    let words = spv::write_vec(&module, &info, &spv::Options::default(), None).map_err(|e| e.to_string())?;
    Ok(count_instructions(&words))
}

/// Instructions between the beginnings and ends of functions.
fn count_instructions(words: &[u32]) -> usize {
    const HEADER_WORDS: usize = 5;
    const FUNCTION: u32 = 54;
    const FUNCTION_END: u32 = 56;
    let (mut at, mut inside, mut count) = (HEADER_WORDS, false, 0);
    while at < words.len() {
        let operation = words[at] & 0xffff;
        inside = (inside || operation == FUNCTION) && operation != FUNCTION_END;
        count += usize::from(inside);
        at += (words[at] >> 16).max(1) as usize;
    }
    count
}
