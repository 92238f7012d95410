//! Every program of the viewer and of the tests is sound WGSL, whatever adapter there is.

use glint_shaders::translate::CAPABILITIES;
use glint_shaders::{CHOICES, PASSES, SHADING, compose, modules, program};
use naga::valid::{ValidationFlags, Validator};

/// Hooks that a shading program must have once, see view_scene.wgsl.
const HOOKS: [&str; 4] = ["shade_lights", "shade_room", "shade_emitted", "shade_lod"];
/// Those that a program must have once as well if it takes lights one after the other by shade_each_light.wgsl.
const HOOKS_OF_EACH_LIGHT: [&str; 4] = ["shade_reflect", "shade_reference", "shade_rect", "shade_environment"];

/// Panics with what is wrong and where.
fn check(what: &str, source: &str) {
    let module =
        naga::front::wgsl::parse_str(source).unwrap_or_else(|e| panic!("{what}: {}", e.emit_to_string(source)));
    let mut validator = Validator::new(ValidationFlags::all(), CAPABILITIES);
    validator.validate(&module).unwrap_or_else(|e| panic!("{what}: {}", e.emit_to_string(source)));
}

/// Every way to take one file of each group.
fn all_choices(name: &str) -> Vec<Vec<&'static str>> {
    let groups = CHOICES.iter().filter(|choices| choices.0 == name).flat_map(|choices| choices.1);
    groups.fold(vec![Vec::new()], |chosen, group| {
        chosen.iter().flat_map(|files| group.iter().map(|&file| [&files[..], &[file]].concat())).collect()
    })
}

#[test]
fn programs_of_the_viewer_are_valid() {
    for (name, _) in SHADING {
        for choices in all_choices(name) {
            let what = format!("{name} {choices:?}");
            let source = program(name, &choices);
            let each_light = source.contains("\nfn view_reflect(");
            let of_each_light = HOOKS_OF_EACH_LIGHT.iter().filter(|_| each_light);
            for hook in HOOKS.iter().chain(of_each_light) {
                assert_eq!(source.matches(&format!("\nfn {hook}(")).count(), 1, "{what}: {hook}");
            }
            check(&what, &source);
        }
    }
    for (name, _) in PASSES {
        check(name, &program(name, &[]));
    }
}

#[test]
fn programs_that_answer_queries_are_valid() {
    let queries = modules().filter_map(|module| module.name.strip_prefix("query_"));
    for method in queries {
        let files = glint_shaders::query_files(method);
        check(method, &compose(&files));
    }
    check("environment, texel by texel", &compose(&["query_environment", "bind_environment_exact"]));
}
