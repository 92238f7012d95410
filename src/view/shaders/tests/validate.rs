//! Every program of the viewer is sound WGSL, whatever adapter there is.

use glint_shaders::compose;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Hooks that a program must have once, see view_scene.wgsl.
const HOOKS: [&str; 5] = ["shade_reflect", "shade_reference", "shade_rect", "shade_environment", "shade_lod"];

/// The environment of programs that are checked without one.
const NO_ENVIRONMENT: &str = "fn shade_environment(point: ViewPoint) -> vec3f { return vec3f(0.0); }";

/// Panics with what is wrong and where.
fn check(what: &str, source: &str) {
    let module =
        naga::front::wgsl::parse_str(source).unwrap_or_else(|e| panic!("{what}: {}", e.emit_to_string(source)));
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    validator.validate(&module).unwrap_or_else(|e| panic!("{what}: {}", e.emit_to_string(source)));
}

#[test]
fn programs_of_the_viewer_are_valid() {
    for files in [
        &["view_surface", "shade_smooth", "shade_rect_points"][..],
        &["view_surface", "shade_dictionary", "shade_rect_points"],
        &["view_surface", "shade_area_light"],
        &["view_surface", "shade_plain_ltc"],
    ] {
        let source = compose(files) + "\n" + NO_ENVIRONMENT;
        for hook in HOOKS {
            assert_eq!(source.matches(&format!("\nfn {hook}(")).count(), 1, "{files:?}: {hook}");
        }
        check(&files.join(" "), &source);
    }
}
