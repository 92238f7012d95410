//! The library in the languages of engines: WGSL as it is, and the query programs through naga's back ends.
//!
//! A translated file is one compute program, `query_<method>`: it holds every function of the library that the method
//! calls, with the bindings of `bind_<method>.wgsl`. Group and binding are kept as SPIR-V's descriptor set and binding and
//! as HLSL's space and register. GLSL counts uniform buffers, storage buffers and textures each from 0, Metal buffers,
//! textures and samplers, in the order of groups and bindings; Metal has the lengths of arrays in the buffer after the
//! last. Loops of the library are bounded, so no counters are added to them.

use crate::{module, modules, parts};
use glint_bake_core::shaders::{self, Shader};
use naga::back::{glsl, hlsl, msl, spv};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, ResourceBinding, ShaderStage, TypeInner};
use std::collections::BTreeMap;

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

    /// Extension of its files: those that compilers expect.
    pub fn extension(self) -> &'static str {
        match self {
            Language::Wgsl => "wgsl",
            Language::Hlsl => "hlsl",
            Language::Glsl => "comp",
            Language::Msl => "metal",
            Language::Spirv => "spv",
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
#[error("{program}.wgsl cannot be written as {language:?}: {reason}")]
pub struct TranslateError {
    /// Name of the program.
    pub program: &'static str,
    /// The language.
    pub language: Language,
    /// What naga says.
    pub reason: String,
}

/// What the library uses beyond the least that naga knows; every WebGPU adapter has both.
pub const CAPABILITIES: Capabilities = Capabilities::CUBE_ARRAY_TEXTURES.union(Capabilities::SHADER_FLOAT16_IN_FLOAT32);

const QUERY: &str = "query_";

/// Names of the methods: one for every `query_<method>.wgsl`.
pub fn methods() -> Vec<&'static str> {
    modules().filter_map(|module| module.name.strip_prefix(QUERY)).collect()
}

/// The files of these methods in a language, in a fixed order. WGSL is the library with examples of how it is bound and
/// called, every file as it is; other languages have one file a method.
///
/// # Errors
/// [`TranslateError`] names the program and what naga finds wrong with it.
///
/// # Panics
/// If a method is none of [`methods`].
pub fn files(language: Language, methods: &[&str]) -> Result<Vec<ShaderFile>, TranslateError> {
    let programs = methods.iter().map(|method| {
        let name = format!("{QUERY}{method}");
        module(&name).unwrap_or_else(|| panic!("there is no {name}.wgsl"))
    });
    if language == Language::Wgsl {
        return Ok(library(methods));
    }
    programs
        .map(|program| {
            let bytes = translate(language, program)?;
            Ok(ShaderFile { name: format!("{}.{}", program.name, language.extension()), bytes })
        })
        .collect()
}

/// The library's files that the methods need, with what the viewer's shading of them needs, in the order of [`modules`].
fn library(methods: &[&str]) -> Vec<ShaderFile> {
    let roots = methods.iter().flat_map(|method| [format!("{QUERY}{method}"), format!("shade_{method}")]);
    let there: Vec<&str> = roots.filter_map(|name| module(&name)).map(|module| module.name).collect();
    let needed = parts(&there);
    let exported = |shader: &Shader| {
        shaders::all().any(|other| other == shader)
            || ["bind_", QUERY].iter().any(|prefix| shader.name.starts_with(prefix))
    };
    let exported = modules().filter(|shader| needed.contains(shader) && exported(shader));
    exported.map(|shader| ShaderFile { name: file_name(shader), bytes: plain_text(shader).into() }).collect()
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
    shader.source.lines().map(line).collect()
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

/// One program in another language.
fn translate(language: Language, program: &'static Shader) -> Result<Vec<u8>, TranslateError> {
    let fail = |reason: String| TranslateError { program: program.name, language, reason };
    let source = crate::compose(&crate::query_files(program.name.trim_start_matches(QUERY)));
    let module = naga::front::wgsl::parse_str(&source).map_err(|e| fail(e.emit_to_string(&source)))?;
    let info = Validator::new(ValidationFlags::all(), CAPABILITIES)
        .validate(&module)
        .map_err(|e| fail(e.emit_to_string(&source)))?;
    let text = match language {
        Language::Wgsl => source,
        Language::Hlsl => to_hlsl(&module, &info).map_err(fail)?,
        Language::Glsl => to_glsl(&module, &info).map_err(fail)?,
        Language::Msl => to_msl(&module, &info).map_err(fail)?,
        Language::Spirv => return to_spirv(&module, &info).map_err(fail),
    };
    Ok(with_header(language, program, &text).into_bytes())
}

/// The text behind a comment that says what it is made from: the first paragraph of every file of the library.
fn with_header(language: Language, program: &Shader, text: &str) -> String {
    let mut header = format!(
        "// {}.wgsl of glint-bake {}, translated by naga. Entry point main; what it is made of:\n",
        program.name,
        env!("CARGO_PKG_VERSION")
    );
    for part in parts(&[program.name]) {
        header.push_str(&format!("//\n// {}.wgsl\n", part.name));
        let paragraph = part.source.lines().take_while(|line| line.starts_with("// "));
        paragraph.for_each(|line| header.push_str(&format!("{line}\n")));
    }
    // GLSL begins with its version.
    match (language, text.split_once('\n')) {
        (Language::Glsl, Some((version, rest))) => format!("{version}\n{header}\n{rest}"),
        _ => format!("{header}\n{text}"),
    }
}

fn to_hlsl(module: &naga::Module, info: &ModuleInfo) -> Result<String, String> {
    // Group and binding become space and register.
    let options = hlsl::Options { force_loop_bounding: false, ..hlsl::Options::default() };
    let pipeline = hlsl::PipelineOptions::default();
    let mut text = String::new();
    hlsl::Writer::new(&mut text, &options, &pipeline).write(module, info, None).map_err(|e| e.to_string())?;
    Ok(text)
}

/// What numbers are counted apart.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Slot {
    Uniform,
    Storage,
    Texture,
    Sampler,
}

/// The module's bindings in the order of groups and bindings, with what they are.
fn slots(module: &naga::Module) -> BTreeMap<(u32, u32), (ResourceBinding, Slot, bool)> {
    let mut all = BTreeMap::new();
    for (_, variable) in module.global_variables.iter() {
        let Some(binding) = variable.binding else { continue };
        let (slot, writable) = match (variable.space, &module.types[variable.ty].inner) {
            (AddressSpace::Uniform, _) => (Slot::Uniform, false),
            (AddressSpace::Storage { access }, _) => (Slot::Storage, access.contains(naga::StorageAccess::STORE)),
            (_, TypeInner::Sampler { .. }) => (Slot::Sampler, false),
            _ => (Slot::Texture, false),
        };
        all.insert((binding.group, binding.binding), (binding, slot, writable));
    }
    all
}

fn to_glsl(module: &naga::Module, info: &ModuleInfo) -> Result<String, String> {
    let mut next: BTreeMap<Slot, u8> = BTreeMap::new();
    let mut binding_map = BTreeMap::new();
    for (binding, slot, _) in slots(module).into_values() {
        let number = next.entry(slot).or_default();
        binding_map.insert(binding, *number);
        *number += 1;
    }
    let options = glsl::Options {
        version: glsl::Version::Desktop(450),
        writer_flags: glsl::WriterFlags::empty(),
        binding_map,
        ..glsl::Options::default()
    };
    let pipeline =
        glsl::PipelineOptions { shader_stage: ShaderStage::Compute, entry_point: "main".into(), multiview: None };
    let mut text = String::new();
    glsl::Writer::new(&mut text, module, info, &options, &pipeline, Default::default())
        .and_then(|mut writer| writer.write())
        .map_err(|e| e.to_string())?;
    Ok(text)
}

fn to_msl(module: &naga::Module, info: &ModuleInfo) -> Result<String, String> {
    let (mut buffers, mut textures, mut samplers) = (0, 0, 0);
    let take = |next: &mut u8| {
        *next += 1;
        *next - 1
    };
    let mut resources = msl::EntryPointResources::default();
    for (binding, slot, mutable) in slots(module).into_values() {
        let mut target = msl::BindTarget { mutable, ..msl::BindTarget::default() };
        match slot {
            Slot::Uniform | Slot::Storage => target.buffer = Some(take(&mut buffers)),
            Slot::Texture => target.texture = Some(take(&mut textures)),
            Slot::Sampler => target.sampler = Some(msl::BindSamplerTarget::Resource(take(&mut samplers))),
        }
        resources.resources.insert(binding, target);
    }
    // Lengths of the arrays whose size is known only at run time.
    resources.sizes_buffer = Some(buffers);
    let options = msl::Options {
        lang_version: (2, 0),
        per_entry_point_map: [("main".to_owned(), resources)].into(),
        fake_missing_bindings: false,
        force_loop_bounding: false,
        ..msl::Options::default()
    };
    let (text, _) =
        msl::write_string(module, info, &options, &msl::PipelineOptions::default()).map_err(|e| e.to_string())?;
    Ok(text)
}

fn to_spirv(module: &naga::Module, info: &ModuleInfo) -> Result<Vec<u8>, String> {
    let options = spv::Options {
        // Names of functions and variables, in builds of every kind.
        flags: spv::WriterFlags::DEBUG,
        force_loop_bounding: false,
        ..spv::Options::default()
    };
    let words = spv::write_vec(module, info, &options, None).map_err(|e| e.to_string())?;
    Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
}
