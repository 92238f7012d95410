//! Programs are valid WGSL, whole: every hook of the viewer is there once.

use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Programs as the viewer and the tests compose them.
const PROGRAMS: &[&[&str]] = &[
    &["query_counting"],
    &["query_environment", "bind_environment"],
    &["query_environment", "bind_environment_exact"],
    &["view_surface", "shade_smooth", "shade_rect_points", "shade_environment_smooth"],
    &["view_surface", "shade_dictionary", "shade_rect_points", "shade_environment_smooth"],
    &["view_surface", "shade_environment", "shade_rect_points"],
];

#[test]
fn programs_are_valid() {
    for program in PROGRAMS {
        let source = glint_shaders::compose(program);
        let module = naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|error| panic!("{program:?}: {}", error.emit_to_string(&source)));
        Validator::new(ValidationFlags::all(), Capabilities::CUBE_ARRAY_TEXTURES)
            .validate(&module)
            .unwrap_or_else(|error| panic!("{program:?}: {}", error.emit_to_string(&source)));
    }
}
