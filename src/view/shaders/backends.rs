//! naga's back ends, and what their text lacks to be an engine's: names as in WGSL, plain samplers, sets for Vulkan, types of arrays that are
//! the same in every program.

use crate::include::replace_words;
use crate::items::items;
use naga::back::{glsl, hlsl, msl, spv};
use naga::valid::ModuleInfo;
use naga::{AddressSpace, ResourceBinding, ShaderStage, TypeInner};
use std::collections::BTreeMap;

/// HLSL of a module.
///
/// # Errors
/// What naga finds.
pub fn to_hlsl(module: &naga::Module, info: &ModuleInfo) -> Result<String, String> {
    // Group and binding become space and register.
    let options = hlsl::Options { force_loop_bounding: false, ..hlsl::Options::default() };
    let pipeline = hlsl::PipelineOptions::default();
    let mut text = String::new();
    hlsl::Writer::new(&mut text, &options, &pipeline).write(module, info, None).map_err(|e| e.to_string())?;
    Ok(plain_hlsl(module, &text))
}

/// HLSL as an engine has it: samplers by registers where naga takes them from a heap, and arrays of zeros by their elements, since not every
/// compiler casts a number to an array.
fn plain_hlsl(module: &naga::Module, text: &str) -> String {
    let mut samplers = BTreeMap::new();
    for (binding, slot, _) in slots(module).into_values() {
        let variable = module.global_variables.iter().find(|(_, variable)| variable.binding == Some(binding));
        if slot == Slot::Sampler
            && let Some(name) = variable.and_then(|(_, variable)| variable.name.clone())
        {
            samplers.insert(name, binding);
        }
    }
    let line = |line: &str| -> Option<String> {
        if line.contains("SamplerHeap[2048]") || line.starts_with("StructuredBuffer<uint> nagaGroup") {
            return None;
        }
        if let Some(name) = line.strip_prefix("static const SamplerState ").and_then(|rest| rest.split(' ').next()) {
            let binding = samplers[name];
            return Some(format!("SamplerState {name} : register(s{}, space{});", binding.binding, binding.group));
        }
        if let Some((before, cast)) = line.split_once(" = (")
            && let Some((ty, count)) = cast.strip_suffix("])0;").and_then(|cast| cast.split_once('['))
            && let Ok(count) = count.parse()
        {
            return Some(format!("{before} = {{ {} }};", vec![format!("({ty})0"); count].join(", ")));
        }
        Some(line.to_owned())
    };
    text.lines().filter_map(line).flat_map(|line| [line, "\n".to_owned()]).collect()
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

/// GLSL of a module and its entry point `main`, without its version.
///
/// # Errors
/// What naga finds.
pub fn to_glsl(module: &naga::Module, info: &ModuleInfo) -> Result<String, String> {
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
    Ok(plain_glsl(module, &text))
}

/// What GLSL files begin with: Vulkan has sets and bindings, OpenGL a number for each kind of resource.
pub const GLSL_SLOTS: &str = "\
#ifndef GLINT_SLOT
#ifdef VULKAN
#define GLINT_SLOT(group, number, count) set = group, binding = number
#else
#define GLINT_SLOT(group, number, count) binding = count
#endif
#endif
";

/// A line that declares a resource, `layout(std430, binding = 2) ...`, with its slot for both.
fn with_slot(line: &str, binding: ResourceBinding) -> String {
    let (before, rest) = line.split_once("binding = ").unwrap_or((line, ""));
    let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    let (count, after) = rest.split_at(digits);
    format!("{before}GLINT_SLOT({}, {}, {count}){after}", binding.group, binding.binding)
}

/// GLSL whose resources are called as in WGSL; what its extensions add is in version 4.50.
fn plain_glsl(module: &naga::Module, text: &str) -> String {
    let mut names = BTreeMap::new();
    for (_, variable) in module.global_variables.iter() {
        if let (Some(binding), Some(name)) = (variable.binding, variable.name.clone()) {
            names.insert(format!("_group_{}_binding_{}_cs", binding.group, binding.binding), name);
        }
    }
    let mut names_of_slots = BTreeMap::new();
    for (binding, _, _) in slots(module).into_values() {
        let name = &names[&format!("_group_{}_binding_{}_cs", binding.group, binding.binding)];
        names_of_slots.insert(name.clone(), binding);
    }
    let mut out = String::new();
    for line in text.lines().filter(|line| !line.starts_with("#version") && !line.starts_with("#extension")) {
        let mut bound = None;
        let renamed = replace_words(line, |word| {
            let name = names.get(word).cloned();
            bound = name.clone().or(bound.take());
            name
        });
        let renamed = match names_of_slots.get(bound.as_deref().unwrap_or_default()) {
            Some(binding) if line.starts_with("layout(") => with_slot(&renamed, *binding),
            _ => renamed,
        };
        // A block has the name of what it holds.
        let is_block = |word: &str| line.starts_with("layout(") && word.contains("_block_");
        let renamed = replace_words(&renamed, |word| {
            bound.as_ref().filter(|_| is_block(word)).map(|name| format!("{name}_block"))
        });
        out.push_str(&renamed);
        out.push('\n');
    }
    out
}

/// Metal's language of a module.
///
/// # Errors
/// What naga finds.
pub fn to_msl(module: &naga::Module, info: &ModuleInfo) -> Result<String, String> {
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
    Ok(plain_msl(&text))
}

/// Metal's text in which types of arrays are called by what they are, so that they are the same in every program, and functions do not hand
/// on lengths of arrays that none but the example asks for.
fn plain_msl(text: &str) -> String {
    let mut names: BTreeMap<String, String> = BTreeMap::new();
    for item in items(text).iter().filter(|item| item.name.starts_with("type_")) {
        let own =
            item.words().filter(|word| !["struct", "typedef", "metal", "inner", item.name.as_str()].contains(word));
        let words: Vec<&str> = own.map(|word| names.get(word).map_or(word, |name| name)).collect();
        let kind = if item.text.starts_with("typedef") { "list" } else { "array" };
        let name = format!("glint_{kind}_{}", words.join("_"));
        names.insert(item.name.clone(), name);
    }
    let text = replace_words(text, |word| names.get(word).cloned()).replace(", _buffer_sizes)", ")");
    text.replace(",\n    constant _mslBufferSizes& _buffer_sizes\n", "\n")
}

/// SPIR-V of a module, with names.
///
/// # Errors
/// What naga finds.
pub fn to_spirv(module: &naga::Module, info: &ModuleInfo) -> Result<Vec<u8>, String> {
    let options = spv::Options {
        // Names of functions and variables, in builds of every kind.
        flags: spv::WriterFlags::DEBUG,
        force_loop_bounding: false,
        ..spv::Options::default()
    };
    let words = spv::write_vec(module, info, &options, None).map_err(|e| e.to_string())?;
    Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
}
