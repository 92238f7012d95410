//! The run time of the glint methods in WGSL: a library of functions without bindings, and what makes programs of it.
//!
//! The library is `glint_bake_core::shaders`: each file lies beside its twin in Rust, with functions of the same names, data by
//! parameters or by accessor functions that the including program defines. Beside this file lie:
//! - `bind_<method>.wgsl`: bindings in group 1 with those accessors, as the viewer and the tests have them. Replace it by your
//!   engine's.
//! - `include_<method>.wgsl`: what an engine calls, a BRDF of a pixel and the like, and `example_<method>.wgsl`, a compute program that calls
//!   it: `glint-bake shaders` writes both in the languages of engines ([`translate`]).
//! - `query_<method>.wgsl`: a compute program that answers queries, one an invocation: what the parity tests run.
//!   query_environment.wgsl takes either of the two bindings of an environment, so it names none.
//! - `view_*.wgsl` and `shade_<method>.wgsl`: the viewer's own programs, see view_scene.wgsl.
//!
//! A file names those that it calls in lines `#import <method>::<file>`.
//! Order of declarations does not matter in WGSL, so a program is its files one after the other ([`compose`]).

mod backends;
mod declared;
pub mod describe;
mod include;
mod items;
pub mod layout;
pub mod operations;
pub mod translate;

use glint_bake_core::shaders::{self, Shader};

/// A file beside this one.
macro_rules! own {
    ($name:literal) => {
        Shader { name: $name, source: include_str!(concat!($name, ".wgsl")) }
    };
}

/// Files of the viewer and of the tests: bindings, queries, shading. The run time itself is
/// [`glint_bake_core::shaders::all`].
const OWN: &[Shader] = &[
    own!("include_map"),
    own!("include_dictionary"),
    own!("include_ndf_maps"),
    own!("include_lobes"),
    own!("include_surface"),
    own!("include_glints"),
    own!("include_area_light"),
    own!("include_environment"),
    own!("bind_ndf_maps_layered"),
    own!("example_pixels"),
    own!("example_dictionary"),
    own!("example_ndf_maps"),
    own!("example_lobes"),
    own!("example_surface"),
    own!("example_glints"),
    own!("example_area_light"),
    own!("example_environment"),
    own!("bind_loads"),
    own!("bind_table"),
    own!("bind_dictionary"),
    own!("query_dictionary"),
    own!("bind_area_light"),
    own!("bind_area_light_sampler"),
    own!("bind_area_light_loads"),
    own!("query_area_light"),
    own!("query_counting"),
    own!("bind_glints"),
    own!("query_glints"),
    own!("bind_environment"),
    own!("bind_environment_exact"),
    own!("query_environment"),
    own!("bind_ndf_maps"),
    own!("query_ndf_maps"),
    own!("bind_lobes"),
    own!("query_lobes"),
    own!("query_surface"),
    own!("bind_textures"),
    own!("view_scene"),
    own!("view_surface"),
    own!("view_sky"),
    own!("view_background"),
    own!("view_accumulate"),
    own!("view_present"),
    own!("shade_smooth_brdf"),
    own!("shade_smooth"),
    own!("shade_dictionary"),
    own!("shade_area_light"),
    own!("shade_plain_ltc"),
    own!("shade_background"),
    own!("shade_environment_surface"),
    own!("shade_environment_smooth"),
    own!("shade_environment_levels"),
    own!("shade_environment"),
    own!("shade_glints"),
    own!("shade_each_light"),
    own!("shade_ndf_maps"),
    own!("shade_ndf_maps_environment"),
    own!("shade_normals"),
    own!("shade_lobes"),
    own!("shade_surface"),
    own!("shade_rect_points"),
    own!("shade_rect_light"),
    own!("shade_mirror"),
    own!("shade_textures_brdf"),
    own!("shade_textures"),
];

/// Every WGSL file: the run time, then the viewer's own.
pub fn modules() -> impl Iterator<Item = &'static Shader> {
    shaders::all().chain(OWN)
}

/// Names of the files that a file imports, in the order of its `#import` lines.
pub fn imports(shader: &Shader) -> impl Iterator<Item = &'static str> {
    shader.source.lines().filter_map(|line| line.strip_prefix("#import ")).map(str::trim)
}

/// A program of the viewer: its name, and the files that give each hook of view_scene.wgsl once.
pub type Program = (&'static str, &'static [&'static str]);

/// Programs that shade a surface, by method.
pub const SHADING: &[Program] = &[
    (
        "smooth",
        &[
            "view_surface",
            "shade_each_light",
            "shade_smooth",
            "shade_rect_points",
            "shade_environment_smooth",
            "shade_mirror",
        ],
    ),
    (
        "dictionary",
        &[
            "view_surface",
            "shade_each_light",
            "shade_dictionary",
            "shade_rect_points",
            "shade_environment_smooth",
            "shade_mirror",
        ],
    ),
    (
        "ndf-maps",
        &[
            "view_surface",
            "shade_each_light",
            "shade_ndf_maps",
            "shade_rect_points",
            "shade_ndf_maps_environment",
            "shade_mirror",
        ],
    ),
    (
        "lobes",
        &[
            "view_surface",
            "shade_each_light",
            "shade_lobes",
            "shade_rect_points",
            "shade_environment_smooth",
            "shade_mirror",
        ],
    ),
    (
        "surface",
        &[
            "view_surface",
            "shade_each_light",
            "shade_surface",
            "shade_rect_points",
            "shade_environment_smooth",
            "shade_mirror",
        ],
    ),
    ("environment", &["view_surface", "shade_each_light", "shade_environment", "shade_rect_points", "shade_mirror"]),
    ("glints", &["view_surface", "shade_glints", "shade_mirror"]),
    (
        "area-light",
        &["view_surface", "shade_each_light", "shade_area_light", "shade_environment_smooth", "shade_mirror"],
    ),
    ("plain-ltc", &["view_surface", "shade_each_light", "shade_plain_ltc", "shade_environment_smooth", "shade_mirror"]),
    ("textures", &["view_surface", "shade_each_light", "shade_textures", "shade_rect_points"]),
    ("plain-textures", &["view_surface", "shade_each_light", "shade_textures", "shade_rect_points"]),
];

/// Files of which a method takes one of each group, as its pack stores data; the first where it is all the same.
pub const CHOICES: &[(&str, &[&[&str]])] = &[
    ("lobes", &[&["lobes::packed", "lobes::half"]]),
    (
        "surface",
        &[
            &["lobes::packed", "lobes::half"],
            &["synthesis::grid", "synthesis::tiles"],
            &["surface::blocks", "surface::seams"],
        ],
    ),
];

/// What draws behind the mesh, and what covers the picture.
pub const PASSES: &[Program] = &[
    ("background", &["view_background", "shade_background"]),
    ("mean", &["view_accumulate"]),
    ("display", &["view_present"]),
];

/// The text of the program that shades a method, or of a pass, with the files of its [`CHOICES`].
///
/// # Panics
/// If there is none of this name: names are constants of this workspace.
pub fn program(name: &str, choices: &[&str]) -> String {
    let found = SHADING.iter().chain(PASSES).find(|program| program.0 == name);
    let files = found.unwrap_or_else(|| panic!("there is no program {name}")).1;
    compose(&[files, choices].concat())
}

/// Files of the program that answers queries of a method, with the bindings of `bind_<method>.wgsl` where its files ask for
/// no others, and the first of its [`CHOICES`].
///
/// # Panics
/// If there is no such program.
pub fn query_files(method: &str) -> Vec<&'static str> {
    let query = format!("query_{method}");
    let query = module(&query).unwrap_or_else(|| panic!("there is no {query}.wgsl"));
    let is_bound = parts(&[query.name]).iter().any(|module| module.name.starts_with("bind_"));
    let bindings = module(&format!("bind_{method}")).filter(|_| !is_bound);
    let choices = CHOICES.iter().filter(|choices| choices.0 == method).flat_map(|choices| choices.1);
    let choices = choices.filter_map(|group| group.first().copied());
    [query].into_iter().chain(bindings).map(|module| module.name).chain(choices).collect()
}

/// The file `name`; `None` if there is none.
pub fn module(name: &str) -> Option<&'static Shader> {
    modules().find(|module| module.name == name)
}

/// These files and all that they need, each once, what is needed before what needs it.
///
/// # Panics
/// If a file is not in [`modules`]: names are constants of this workspace.
pub fn parts(names: &[&str]) -> Vec<&'static Shader> {
    let mut taken = Vec::new();
    for name in names {
        add(name, &mut taken);
    }
    taken
}

/// The text of a program of these files and all that they need, each once.
///
/// # Panics
/// If a file is not in [`modules`]: names are constants of this workspace.
pub fn compose(names: &[&str]) -> String {
    parts(names).into_iter().map(text).collect()
}

/// The text of a file alone, without its `#import` lines.
pub fn text(shader: &Shader) -> String {
    let lines = shader.source.lines().filter(|line| !line.starts_with("#import "));
    lines.flat_map(|line| [line, "\n"]).collect()
}

fn add(name: &str, taken: &mut Vec<&'static Shader>) {
    let module = module(name).unwrap_or_else(|| panic!("there is no {name}.wgsl"));
    for import in imports(module) {
        add(import, taken);
    }
    if !taken.iter().any(|other| other.name == module.name) {
        taken.push(module);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_holds_each_file_once() {
        let text = compose(&["dictionary::eval", "query_dictionary"]);
        assert_eq!(text.matches("fn glint_patch_sdf(").count(), 1);
        assert!(text.find("fn glint_mix_bits(").unwrap() < text.find("fn glint_patch_sdf(").unwrap());
    }
}
