//! The run time of the glint methods in WGSL: a library of functions without bindings, and what makes programs of it.
//!
//! Four kinds of file lie beside this one:
//! - `glint_<topic>.wgsl`: the library. Functions are named as their twins in `glint-bake-core`, data comes in by parameters
//!   or by accessor functions that the including program defines; each file lists its accessors on top.
//! - `bind_<method>.wgsl`: bindings in group 1 with those accessors, as the viewer and the tests have them. Replace it by your
//!   engine's.
//! - `query_<method>.wgsl`: a compute program that answers queries, one an invocation: what the parity tests run.
//!   query_environment.wgsl takes either of the two bindings of an environment, so it names none.
//! - `view_*.wgsl` and `shade_<method>.wgsl`: the viewer's own programs, see view_scene.wgsl.
//!
//! Order of declarations does not matter in WGSL, so a program is its files one after the other ([`compose`]).

pub mod operations;
pub mod translate;

/// A WGSL file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Module {
    /// File name without `.wgsl`.
    pub name: &'static str,
    /// Its text.
    pub source: &'static str,
    /// Library files whose functions it calls.
    pub needs: &'static [&'static str],
}

/// One row a file: its name, and the library files that it calls.
macro_rules! modules {
    ($($name:literal needs [$($need:literal),*];)*) => {
        /// Every WGSL file.
        pub const MODULES: &[Module] = &[
            $(Module { name: $name, source: include_str!(concat!($name, ".wgsl")), needs: &[$($need),*] },)*
        ];
    };
}

modules! {
    "glint_brdf" needs [];
    "glint_hash" needs [];
    "glint_footprint" needs [];
    "glint_erf" needs [];
    "glint_dictionary" needs ["glint_hash"];
    "bind_loads" needs [];
    "bind_table" needs [];
    "bind_dictionary" needs ["glint_dictionary", "bind_loads"];
    "query_dictionary" needs ["bind_dictionary"];
    "glint_ggx" needs [];
    "glint_ltc" needs [];
    "glint_area_light" needs ["glint_ltc"];
    "bind_area_light" needs ["glint_area_light"];
    "bind_area_light_sampler" needs ["bind_area_light", "bind_loads"];
    "bind_area_light_loads" needs ["bind_area_light"];
    "query_area_light" needs ["bind_area_light_loads", "glint_ggx"];
    "glint_counting" needs [];
    "query_counting" needs ["glint_counting"];
    "glint_surface_cells" needs ["glint_hash", "glint_counting"];
    "glint_environment" needs ["glint_counting"];
    "bind_environment" needs ["glint_environment", "bind_loads"];
    "bind_environment_exact" needs ["glint_environment"];
    "query_environment" needs ["glint_environment", "glint_surface_cells"];
    "glint_ndf_ellipse" needs ["glint_footprint"];
    "glint_ndf_material" needs [];
    "glint_ndf_tiles" needs ["glint_ndf_material"];
    "glint_ndf_lobes" needs ["glint_ndf_material", "glint_erf"];
    "glint_ndf_view" needs ["glint_ndf_ellipse", "glint_ndf_tiles", "glint_ndf_lobes"];
    "glint_ndf_tiled" needs ["glint_ndf_view"];
    "glint_ndf_regions" needs ["glint_ndf_view"];
    "glint_ndf_classes" needs ["glint_ndf_regions"];
    "glint_ndf_probes" needs ["glint_ndf_regions"];
    "glint_ndf_stochastic" needs ["glint_ndf_classes", "glint_ndf_probes"];
    "glint_ndf_maps" needs ["glint_ndf_tiled", "glint_ndf_stochastic"];
    "bind_ndf_maps" needs ["glint_ndf_maps", "bind_loads", "bind_table"];
    "query_ndf_maps" needs ["bind_ndf_maps"];
    "glint_lobes" needs ["glint_footprint", "glint_erf"];
    "glint_lobes_boxes" needs ["glint_lobes"];
    "glint_lobes_levels" needs ["glint_lobes_boxes"];
    "glint_lobes_packed" needs ["glint_lobes"];
    "glint_lobes_half" needs ["glint_lobes"];
    "glint_synthesis_paths" needs [];
    "glint_synthesis" needs ["glint_synthesis_paths"];
    "glint_synthesis_grid" needs ["glint_synthesis"];
    "glint_synthesis_tiles" needs ["glint_synthesis", "glint_hash"];
    "bind_lobes" needs ["glint_lobes_levels", "glint_synthesis_paths", "bind_loads"];
    "query_lobes" needs ["bind_lobes"];
    "glint_surface" needs ["glint_lobes_levels", "glint_synthesis"];
    "glint_surface_seams" needs ["glint_surface"];
    "glint_surface_blocks" needs ["glint_surface"];
    "query_surface" needs ["bind_lobes", "glint_surface"];
    "view_scene" needs [];
    "view_surface" needs ["view_scene", "view_sky", "glint_brdf", "glint_hash", "bind_loads"];
    "view_sky" needs [];
    "view_background" needs ["view_scene", "view_sky"];
    "view_accumulate" needs [];
    "view_present" needs [];
    "shade_smooth_brdf" needs ["view_scene", "glint_brdf"];
    "shade_smooth" needs ["shade_smooth_brdf"];
    "shade_dictionary" needs ["view_scene", "glint_brdf", "bind_dictionary"];
    "shade_area_light" needs ["view_scene", "bind_area_light_sampler", "glint_ggx", "glint_hash"];
    "shade_plain_ltc" needs ["view_scene", "bind_area_light_sampler", "glint_ggx"];
    "shade_background" needs ["view_scene", "bind_environment"];
    "shade_environment_surface" needs ["view_scene", "bind_environment"];
    "shade_environment_smooth" needs ["shade_environment_surface"];
    "shade_environment" needs ["shade_environment_surface", "shade_smooth_brdf", "glint_surface_cells"];
    "shade_ndf_maps" needs ["view_scene", "glint_brdf", "bind_ndf_maps"];
    "shade_normals" needs ["view_scene", "glint_brdf"];
    "shade_lobes" needs ["shade_normals", "bind_lobes"];
    "shade_surface" needs ["shade_normals", "bind_lobes", "glint_surface"];
    "shade_rect_points" needs ["view_scene"];
}

/// A program of the viewer: its name, and the files that give each hook of view_scene.wgsl once.
pub type Program = (&'static str, &'static [&'static str]);

/// Programs that shade a surface, by method.
pub const SHADING: &[Program] = &[
    ("smooth", &["view_surface", "shade_smooth", "shade_rect_points", "shade_environment_smooth"]),
    ("dictionary", &["view_surface", "shade_dictionary", "shade_rect_points", "shade_environment_smooth"]),
    ("ndf-maps", &["view_surface", "shade_ndf_maps", "shade_rect_points", "shade_environment_smooth"]),
    ("lobes", &["view_surface", "shade_lobes", "shade_rect_points", "shade_environment_smooth"]),
    ("surface", &["view_surface", "shade_surface", "shade_rect_points", "shade_environment_smooth"]),
    ("environment", &["view_surface", "shade_environment", "shade_rect_points"]),
    ("area-light", &["view_surface", "shade_area_light", "shade_environment_smooth"]),
    ("plain-ltc", &["view_surface", "shade_plain_ltc", "shade_environment_smooth"]),
];

/// Files of which a method takes one of each group, as its pack stores data; the first where it is all the same.
pub const CHOICES: &[(&str, &[&[&str]])] = &[
    ("lobes", &[&["glint_lobes_packed", "glint_lobes_half"]]),
    (
        "surface",
        &[
            &["glint_lobes_packed", "glint_lobes_half"],
            &["glint_synthesis_grid", "glint_synthesis_tiles"],
            &["glint_surface_blocks", "glint_surface_seams"],
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
pub fn module(name: &str) -> Option<&'static Module> {
    MODULES.iter().find(|module| module.name == name)
}

/// These files and all that they need, each once, what is needed before what needs it.
///
/// # Panics
/// If a file is not in [`MODULES`]: names are constants of this workspace.
pub fn parts(names: &[&str]) -> Vec<&'static Module> {
    let mut taken = Vec::new();
    for name in names {
        add(name, &mut taken);
    }
    taken
}

/// The text of a program of these files and all that they need, each once.
///
/// # Panics
/// If a file is not in [`MODULES`]: names are constants of this workspace.
pub fn compose(names: &[&str]) -> String {
    parts(names).iter().flat_map(|module| [module.source, "\n"]).collect()
}

fn add(name: &str, taken: &mut Vec<&'static Module>) {
    let module = module(name).unwrap_or_else(|| panic!("there is no {name}.wgsl"));
    for need in module.needs {
        add(need, taken);
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
        let text = compose(&["glint_dictionary", "query_dictionary"]);
        assert_eq!(text.matches("fn glint_patch_sdf(").count(), 1);
        assert!(text.find("fn glint_mix_bits(").unwrap() < text.find("fn glint_patch_sdf(").unwrap());
    }
}
