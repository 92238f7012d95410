//! Every program in every language: translated, the same each time, and read back by whoever can read it.

use glint_shaders::translate::{Language, ShaderFile, files, methods};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::process::Command;

fn all(language: Language) -> Vec<ShaderFile> {
    let found = files(language, &methods()).unwrap();
    assert_eq!(found, files(language, &methods()).unwrap(), "{language:?} is not the same twice");
    found
}

fn text(file: &ShaderFile) -> &str {
    std::str::from_utf8(&file.bytes).unwrap()
}

/// Runs a checker on every file, where it is installed.
fn accepted_by(program: &str, args: &[&str], files: &[ShaderFile]) {
    let folder = tempfile::tempdir().unwrap();
    for file in files {
        let path = folder.path().join(&file.name);
        std::fs::write(&path, &file.bytes).unwrap();
        match Command::new(program).args(args).arg(&path).output() {
            Ok(output) => {
                let said = String::from_utf8_lossy(&output.stdout).into_owned();
                let said = said + &String::from_utf8_lossy(&output.stderr);
                assert!(output.status.success(), "{program} {}: {said}", file.name);
            }
            Err(error) => return eprintln!("skipped: {program} cannot be run: {error}"),
        }
    }
}

/// HLSL whose arrays are not initialised by a cast of 0, which is HLSL, but not to glslangValidator.
fn without_array_casts(text: &str) -> String {
    let lines = text.lines().map(|line| match line.split_once(" = (") {
        Some((before, after)) if after.ends_with("])0;") => format!("{before};"),
        _ => line.to_owned(),
    });
    lines.collect::<Vec<String>>().join("\n")
}

/// Names of the functions of a method's library file.
fn functions(method: &str) -> Vec<String> {
    let file = glint_shaders::module(&format!("{method}::eval")).unwrap();
    let names = file.source.lines().filter_map(|line| line.strip_prefix("fn "));
    names.map(|rest| rest.split('(').next().unwrap().to_owned()).collect()
}

#[test]
fn every_method_with_a_query_is_offered() {
    let methods = methods();
    assert!(methods.contains(&"dictionary") && methods.contains(&"area_light"), "{methods:?}");
    for language in [Language::Hlsl, Language::Glsl, Language::Msl, Language::Spirv] {
        assert_eq!(all(language).len(), methods.len(), "{language:?}");
    }
    let mut extensions: Vec<&str> = Language::ALL.iter().map(|language| language.extension()).collect();
    extensions.dedup();
    assert_eq!(extensions.len(), 5);
}

#[test]
fn wgsl_is_the_library_as_it_is() {
    let found = files(Language::Wgsl, &["area_light"]).unwrap();
    let names: Vec<&str> = found.iter().map(|file| file.name.as_str()).collect();
    assert!(names.contains(&"area_light/eval.wgsl") && names.contains(&"bind_area_light_sampler.wgsl"), "{names:?}");
    assert!(!names.iter().any(|name| name.contains("dictionary") || name.contains("view")), "{names:?}");
    for file in &found {
        let name = file.name.strip_suffix(".wgsl").unwrap().replace('/', "::");
        let source = glint_shaders::module(&name).unwrap().source;
        let without = |text: &str, mark: &str| text.lines().filter(|line| !line.starts_with(mark)).collect::<String>();
        assert_eq!(without(text(file), "// Calls "), without(source, "#import "));
    }
    // What is written suffices for the program.
    let program: String = found
        .iter()
        .filter(|file| {
            !file.name.contains("sampler") || methods().iter().any(|m| file.name == format!("query_{m}.wgsl"))
        })
        .map(text)
        .collect();
    let module = naga::front::wgsl::parse_str(&program).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&program)));
    Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).unwrap();
}

#[test]
fn glsl_compiles() {
    let found = all(Language::Glsl);
    for file in &found {
        assert!(text(file).starts_with("#version 450"), "{}", file.name);
        assert!(text(file).contains("void main()") && text(file).contains(".wgsl of glint-bake"), "{}", file.name);
    }
    accepted_by("glslangValidator", &[], &found);
}

#[test]
fn hlsl_compiles() {
    let mut found = all(Language::Hlsl);
    for file in &mut found {
        file.bytes = without_array_casts(text(file)).into_bytes();
    }
    for file in &found {
        assert!(
            text(file).contains("void main(uint3") && text(file).contains("[numthreads(64, 1, 1)]"),
            "{}",
            file.name
        );
    }
    accepted_by("glslangValidator", &["-D", "-S", "comp", "-e", "main", "-V", "-o", "/dev/null"], &found);
}

#[test]
fn spirv_is_valid() {
    let found = all(Language::Spirv);
    for file in &found {
        assert_eq!(file.bytes[..4], 0x0723_0203u32.to_le_bytes(), "{}", file.name);
    }
    accepted_by("spirv-val", &["--target-env", "vulkan1.0"], &found);
}

#[test]
fn functions_keep_their_names() {
    for method in ["dictionary", "area_light"] {
        for (language, call) in [(Language::Hlsl, " "), (Language::Msl, " "), (Language::Glsl, " ")] {
            let file = files(language, &[method]).unwrap().pop().unwrap();
            for name in functions(method) {
                assert!(text(&file).contains(&format!("{call}{name}(")), "{language:?} {method}: no {name}");
            }
        }
        let file = files(Language::Spirv, &[method]).unwrap().pop().unwrap();
        for name in functions(method) {
            assert!(file.bytes.windows(name.len()).any(|bytes| bytes == name.as_bytes()), "SPIR-V {method}: no {name}");
        }
    }
}

#[test]
fn metal_has_an_entry_point_with_every_resource() {
    for file in all(Language::Msl) {
        let text = text(&file);
        assert!(text.contains("kernel void main_("), "{}", file.name);
        for slot in ["[[buffer(0)]]", "[[buffer(1)]]"] {
            assert_eq!(text.matches(slot).count(), 1, "{}: {slot}", file.name);
        }
        let textures = text.matches("[[texture(").count();
        for slot in 0..textures {
            assert_eq!(text.matches(&format!("[[texture({slot})]]")).count(), 1, "{}: texture {slot}", file.name);
        }
        let entry = &text[text.find("kernel void main_(").unwrap()..];
        assert_eq!(text.matches('{').count(), text.matches('}').count(), "{}", file.name);
        assert!(!entry.contains("fake"), "{}", file.name);
    }
}
