//! Every file for engines in every language: translated, the same each time, and compiled by whoever can compile it: examples, which call
//! every function of a method, and shaders that include all methods together.

use glint_shaders::translate::{CAPABILITIES, Language, ShaderFile, files, methods, variants};
use glint_shaders::{CHOICES, modules};
use naga::valid::{ValidationFlags, Validator};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

/// The files of every method.
fn all(language: Language) -> &'static [ShaderFile] {
    static ALL: [OnceLock<Vec<ShaderFile>>; 5] = [const { OnceLock::new() }; 5];
    let place = Language::ALL.iter().position(|other| *other == language).unwrap();
    ALL[place].get_or_init(|| files(language, &methods()).unwrap())
}

#[test]
fn files_are_the_same_twice() {
    for language in Language::ALL {
        let of_method = |method: &str| files(language, &[method]).unwrap();
        assert_eq!(of_method("glints"), of_method("glints"), "{language:?}");
    }
}

fn text(file: &ShaderFile) -> &str {
    std::str::from_utf8(&file.bytes).unwrap()
}

fn write(folder: &Path, files: &[ShaderFile]) {
    for file in files {
        let path = folder.join(&file.name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, &file.bytes).unwrap();
    }
}

/// Runs a checker in `folder` on files of these names, where it is installed.
fn accepted_by(program: &str, args: &[&str], folder: &Path, names: &[&str]) {
    for name in names {
        match Command::new(program).args(args).arg(name).current_dir(folder).output() {
            Ok(output) => {
                let said = String::from_utf8_lossy(&output.stdout).into_owned();
                let said = said + &String::from_utf8_lossy(&output.stderr);
                assert!(output.status.success(), "{program} {name}: {said}");
            }
            Err(error) => return eprintln!("skipped: {program} cannot be run: {error}"),
        }
    }
}

/// Names of files that begin so.
fn beginning<'a>(files: &'a [ShaderFile], start: &str) -> Vec<&'a str> {
    files.iter().map(|file| file.name.as_str()).filter(|name| name.starts_with(start)).collect()
}

/// Lines that include the usual file of every method.
fn includes(extension: &str) -> String {
    methods().iter().map(|method| format!("#include \"glint_{method}.{extension}\"\n")).collect()
}

/// For OpenGL and for Vulkan.
const GLSL: [(&str, &[&str]); 2] =
    [("glslangValidator", &["-G", "-I.", "-o", "/dev/null"]), ("glslangValidator", &["-V", "-I.", "-o", "/dev/null"])];
const HLSL: (&str, &[&str]) = ("glslangValidator", &["-D", "-S", "comp", "-e", "main", "-V", "-I.", "-o", "/dev/null"]);

/// Functions that engines call: those of `include_<method>.wgsl`.
fn functions(method: &str) -> Vec<&'static str> {
    let file = glint_shaders::module(&format!("include_{method}")).unwrap();
    let names = file.source.lines().filter_map(|line| line.strip_prefix("fn "));
    names.map(|rest| rest.split('(').next().unwrap()).collect()
}

#[test]
fn every_method_and_storage_is_offered() {
    assert_eq!(
        methods(),
        ["dictionary", "ndf_maps", "lobes", "surface", "glints", "area_light", "environment"],
        "the order of files"
    );
    let names = |method| variants(method).into_iter().map(|variant| variant.name).collect::<Vec<_>>();
    assert_eq!(names("glints"), ["glints"]);
    assert_eq!(names("lobes"), ["lobes", "lobes_half"]);
    assert_eq!(names("surface").len(), 8);
    assert!(names("surface").contains(&"surface_half_tiles_seams".to_owned()), "{:?}", names("surface"));
    let variants: usize = methods().iter().map(|method| names(method).len()).sum();
    for language in [Language::Hlsl, Language::Glsl, Language::Msl] {
        assert_eq!(all(language).len(), 2 * variants, "{language:?}");
    }
    assert_eq!(all(Language::Spirv).len(), variants);
}

/// Methods go into one program together only if no two files declare the same.
#[test]
fn no_two_files_declare_one_name() {
    let chosen = |name: &str| CHOICES.iter().flat_map(|choices| choices.1.iter()).any(|group| group.contains(&name));
    let apart =
        |name: &str| ["bind_", "query_", "example_", "shade_", "view_"].iter().any(|kind| name.starts_with(kind));
    let mut places: BTreeMap<&str, &str> = BTreeMap::new();
    for file in modules().filter(|file| !apart(file.name) && !chosen(file.name)) {
        for line in file.source.lines() {
            let kinds = ["fn ", "struct ", "const ", "override ", "var<private> "];
            let Some(rest) = kinds.iter().find_map(|kind| line.strip_prefix(kind)) else { continue };
            let name = rest.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap();
            if let Some(other) = places.insert(name, file.name) {
                panic!("{name} is declared in {other} and in {}", file.name);
            }
        }
    }
    assert!(places.len() > 300, "{}", places.len());
}

#[test]
fn wgsl_is_the_library_as_it_is() {
    let found = files(Language::Wgsl, &["area_light"]).unwrap();
    let names: Vec<&str> = found.iter().map(|file| file.name.as_str()).collect();
    for name in
        ["area_light/eval.wgsl", "bind_area_light_sampler.wgsl", "glint_area_light.wgsl", "example_area_light.wgsl"]
    {
        assert!(names.contains(&name), "{name} in {names:?}");
    }
    assert!(
        !names.iter().any(|name| name.contains("dictionary") || name.contains("view") || name.contains("loads")),
        "{names:?}"
    );
    for file in found.iter().filter(|file| !file.name.starts_with("glint_")) {
        let name = file.name.strip_suffix(".wgsl").unwrap().replace('/', "::");
        let source = glint_shaders::module(&name).unwrap().source;
        let kept = |text: &str| {
            let lines = text.lines().filter(|line| !line.starts_with("#import ") && !line.starts_with("// Calls "));
            lines.filter(|line| !line.contains("bound_loads")).collect::<String>()
        };
        assert_eq!(kept(text(file)), kept(source));
        assert!(!text(file).contains("bound_loads"), "{name}");
    }
}

/// The one file of a method, its bindings and its example, one after the other, are a program; and so are the files of all methods.
#[test]
fn wgsl_is_valid() {
    let check = |what: &str, program: &str| {
        let module =
            naga::front::wgsl::parse_str(program).unwrap_or_else(|e| panic!("{what}: {}", e.emit_to_string(program)));
        Validator::new(ValidationFlags::all(), CAPABILITIES)
            .validate(&module)
            .unwrap_or_else(|e| panic!("{what}: {e:?}"));
    };
    for method in methods() {
        let found = files(Language::Wgsl, &[method]).unwrap();
        let one = |name: &str| found.iter().find(|file| file.name == format!("{name}.wgsl")).map(text);
        let beside: String = found
            .iter()
            .filter(|file| file.name.starts_with("bind_") || file.name.starts_with("example_"))
            .map(text)
            .collect();
        for variant in variants(method) {
            let library = one(&format!("glint_{}", variant.name)).unwrap();
            check(&variant.name, &format!("{library}{beside}"));
        }
    }
    let everything: String = all(Language::Wgsl)
        .iter()
        .filter(|file| !["glint_", "example_"].iter().any(|start| file.name.starts_with(start)))
        .filter(|file| !["half", "tiles", "seams"].iter().any(|other| file.name.ends_with(&format!("/{other}.wgsl"))))
        // Methods have the accessors of the LTC tables in common.
        .filter(|file| !file.name.starts_with("bind_area_light"))
        .map(text)
        .collect();
    let maps = "fn glint_area_light_maps() -> GlintAreaLightMaps { return GlintAreaLightMaps(); }\n\
        fn glint_area_light_normals(position: vec2f, level: f32) -> vec4f { return vec4f(0.0); }\n\
        fn glint_area_light_roughness(position: vec2f, level: f32) -> vec4f { return vec4f(0.0); }\n";
    // Groups of bindings are the host's; here each resource has its own.
    let mut number = 0;
    let everything: String = everything
        .lines()
        .map(|line| match line.strip_prefix("@group(").and_then(|rest| rest.split_once(") var")) {
            Some((_, rest)) => {
                number += 1;
                format!("@group(3) @binding({number}) var{rest}\n")
            }
            None => format!("{line}\n"),
        })
        .collect();
    check("all methods", &format!("{everything}{maps}"));
}

#[test]
fn glsl_compiles() {
    let found = all(Language::Glsl);
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), found);
    for name in beginning(found, "glint_") {
        let file = text(found.iter().find(|file| file.name == name).unwrap());
        assert!(!file.contains("void main") && !file.contains("#version"), "{name} is a program");
    }
    let examples = beginning(found, "example_");
    for (program, args) in GLSL {
        accepted_by(program, args, folder.path(), &examples);
    }
    let together = format!(
        "#version 450\n#extension GL_GOOGLE_include_directive : require\n{}layout(local_size_x = 1) in;\nvoid main() {{}}\n",
        includes("glsl")
    );
    std::fs::write(folder.path().join("together.comp"), together).unwrap();
    accepted_by(GLSL[0].0, GLSL[0].1, folder.path(), &["together.comp"]);
}

#[test]
fn hlsl_compiles() {
    let found = all(Language::Hlsl);
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), found);
    for name in beginning(found, "glint_") {
        let file = text(found.iter().find(|file| file.name == name).unwrap());
        assert!(!file.contains("void main") && !file.contains("nagaSamplerHeap"), "{name}");
    }
    accepted_by(HLSL.0, HLSL.1, folder.path(), &beginning(found, "example_"));
    let together = format!("{}[numthreads(1, 1, 1)]\nvoid main() {{}}\n", includes("hlsl"));
    std::fs::write(folder.path().join("together.hlsl"), together).unwrap();
    accepted_by(HLSL.0, HLSL.1, folder.path(), &["together.hlsl"]);
}

/// A host that has its own bindings writes the accessors: no resource is left, and nothing else is missing.
#[test]
fn bindings_can_be_replaced() {
    let found = files(Language::Hlsl, &["dictionary"]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &found);
    let host = "#define GLINT_DICTIONARY_OWN_BINDINGS\n#include \"glint_dictionary.hlsl\"\n\
        static GlintDictionaryTables tables;\n\
        GlintDictionaryTables glint_dictionary_tables() { return tables; }\n\
        float glint_dictionary_filtered(uint row, float place) { return 0.5; }\n\
        float3 glint_dictionary_colour(uint index) { return float3(1.0, 1.0, 1.0); }\n\
        RWByteAddressBuffer answer : register(u0);\n\
        [numthreads(1, 1, 1)]\nvoid main()\n{\n    GlintPixelOnSurface pixel = (GlintPixelOnSurface)0;\n    \
        float3 up = float3(0.0, 0.0, 1.0);\n    \
        float3 f = glint_dictionary_eval(pixel, up, up, glint_dictionary_defaults(), up);\n    answer.Store3(0, asuint(f));\n}\n";
    std::fs::write(folder.path().join("host.hlsl"), host).unwrap();
    accepted_by(HLSL.0, HLSL.1, folder.path(), &["host.hlsl"]);
    let library = text(found.iter().find(|file| file.name == "glint_dictionary.hlsl").unwrap());
    let (before, bindings) = library.split_once("#ifndef GLINT_DICTIONARY_OWN_BINDINGS").unwrap();
    assert!(!before.contains("register(") && bindings.matches("register(").count() == 3, "{bindings}");
}

/// The shader of docs/ENGINES.md is what it says, in a pixel's program.
#[test]
fn the_shader_of_the_page_compiles() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../docs/ENGINES.md")).unwrap();
    let block = page.split("```hlsl\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), all(Language::Hlsl));
    let main = "float4 main(float2 uv : TEXCOORD0) : SV_Target\n{\n    float3 up = float3(0.0, 0.0, 1.0);\n    \
        return float4(shade_sun(uv, up, up, up), 1.0);\n}\n";
    std::fs::write(folder.path().join("page.hlsl"), format!("{block}{main}")).unwrap();
    let args = ["-D", "-S", "frag", "-e", "main", "-V", "-I.", "-o", "/dev/null"];
    accepted_by("glslangValidator", &args, folder.path(), &["page.hlsl"]);
    for method in methods() {
        assert!(page.contains(&format!("`{method}`")), "the page does not name {method}");
    }
}

#[test]
fn spirv_is_valid() {
    let found = all(Language::Spirv);
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), found);
    for file in found {
        assert_eq!(file.bytes[..4], 0x0723_0203u32.to_le_bytes(), "{}", file.name);
    }
    let names: Vec<&str> = found.iter().map(|file| file.name.as_str()).collect();
    accepted_by("spirv-val", &["--target-env", "vulkan1.0"], folder.path(), &names);
}

/// Functions have their names and the comments above them in every language, structs the comments of their members.
#[test]
fn functions_keep_their_names_and_comments() {
    for method in methods() {
        for (language, line) in [(Language::Hlsl, "// "), (Language::Msl, "// "), (Language::Glsl, "// ")] {
            let found = files(language, &[method]).unwrap();
            let library = found.iter().find(|file| file.name.starts_with("glint_")).unwrap();
            for name in functions(method) {
                let at = text(library)
                    .find(&format!(" {name}("))
                    .unwrap_or_else(|| panic!("{language:?} {method}: no {name}"));
                let before: Vec<&str> = text(library)[..at].lines().rev().skip(1).take(1).collect();
                assert!(before[0].starts_with(line), "{language:?}: {name} stands after {before:?}");
            }
        }
    }
    let found = files(Language::Hlsl, &["dictionary"]).unwrap();
    let library = text(found.iter().find(|file| file.name == "glint_dictionary.hlsl").unwrap());
    assert!(library.contains("    // Facets on one unit of surface area.\n    float density;"), "{library}");
    // Names that end in a digit are those of WGSL.
    assert!(library.contains("float3 f0") && !library.contains("f0_,"), "{library}");
}

#[test]
fn metal_has_no_entry_point_but_in_examples() {
    for file in all(Language::Msl) {
        let text = text(file);
        let is_example = file.name.starts_with("example_");
        assert_eq!(text.matches("kernel void main_(").count(), usize::from(is_example), "{}", file.name);
        assert_eq!(text.matches('{').count(), text.matches('}').count(), "{}", file.name);
        assert!(!text.contains("fake") && (is_example || !text.contains("_buffer_sizes")), "{}", file.name);
        for slot in ["[[buffer(0)]]", "[[buffer(1)]]"] {
            assert_eq!(text.matches(slot).count(), usize::from(is_example), "{}: {slot}", file.name);
        }
        let textures = text.matches("[[texture(").count();
        for slot in 0..textures {
            assert_eq!(text.matches(&format!("[[texture({slot})]]")).count(), 1, "{}: texture {slot}", file.name);
        }
    }
}

/// Nothing compiles Metal's language here; at least every struct and function is declared before it is used.
#[test]
fn metal_declares_before_it_uses() {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    for file in all(Language::Msl).iter().filter(|file| file.name.starts_with("glint_")) {
        let (mut names, mut declared) = (BTreeSet::new(), BTreeSet::new());
        let declares = |line: &str| !line.starts_with([' ', '#', '/', '}']);
        for line in text(file).lines().filter(|line| declares(line)) {
            names.extend(line.strip_prefix("struct ").and_then(|rest| rest.split(|c| !is_word(c)).next()));
            names.extend(line.split_once('(').and_then(|(head, _)| head.rsplit(' ').next()));
        }
        for line in text(file).lines().filter(|line| !line.trim_start().starts_with("//") && !line.starts_with('#')) {
            for word in line.split(|c| !is_word(c)).filter(|word| names.contains(word)) {
                let is_own = line.starts_with(&format!("struct {word}")) || line.contains(&format!(" {word}("));
                if declares(line) && is_own {
                    declared.insert(word);
                }
                assert!(declared.contains(word), "{}: {word} is used before it is declared: {line}", file.name);
            }
        }
        assert!(names.len() > 40, "{}: {}", file.name, names.len());
    }
}
