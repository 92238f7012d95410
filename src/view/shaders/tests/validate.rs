//! Programs are valid WGSL, whole: every hook of the viewer is there once.

use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Programs as the viewer and the tests compose them.
const PROGRAMS: &[&[&str]] = &[
    &["query_dictionary"],
    &["query_lobes", "glint_lobes_packed"],
    &["query_lobes", "glint_lobes_half"],
    &["query_surface", "glint_lobes_packed", "glint_synthesis_grid", "glint_surface_seams"],
    &["query_surface", "glint_lobes_half", "glint_synthesis_tiles", "glint_surface_blocks"],
    &["view_surface", "shade_smooth", "shade_rect_points"],
    &["view_surface", "shade_dictionary", "shade_rect_points"],
    &["view_surface", "shade_lobes", "glint_lobes_packed", "shade_rect_points"],
    &["view_surface", "shade_lobes", "glint_lobes_half", "shade_rect_points"],
    &[
        "view_surface",
        "shade_surface",
        "glint_lobes_packed",
        "glint_synthesis_grid",
        "glint_surface_blocks",
        "shade_rect_points",
    ],
    &[
        "view_surface",
        "shade_surface",
        "glint_lobes_half",
        "glint_synthesis_tiles",
        "glint_surface_seams",
        "shade_rect_points",
    ],
];

/// The environment of programs that are checked without one.
const NO_ENVIRONMENT: &str = "fn shade_environment(point: ViewPoint) -> vec3f { return vec3f(0.0); }";

#[test]
fn programs_are_valid() {
    for program in PROGRAMS {
        let mut source = glint_shaders::compose(program);
        if program.contains(&"view_surface") {
            source += NO_ENVIRONMENT;
        }
        let module = naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|error| panic!("{program:?}: {}", error.emit_to_string(&source)));
        // unpack2x16float is WebGPU's baseline; naga asks for it by name.
        Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32)
            .validate(&module)
            .unwrap_or_else(|error| panic!("{program:?}: {}", error.emit_to_string(&source)));
    }
}
