//! The run time of the glint methods in WGSL: a library of functions without bindings, and what makes programs of it.
//!
//! Four kinds of file lie beside this one:
//! - `glint_<topic>.wgsl`: the library. Functions are named as their twins in `glint-bake-core`, data comes in by parameters
//!   or by accessor functions that the including program defines; each file lists its accessors on top.
//! - `bind_<method>.wgsl`: bindings in group 1 with those accessors, as the viewer and the tests have them. Replace it by your
//!   engine's.
//! - `query_<method>.wgsl`: a compute program that answers queries, one an invocation: what the parity tests run.
//! - `view_*.wgsl` and `shade_<method>.wgsl`: the viewer's own programs, see view_scene.wgsl.
//!
//! Order of declarations does not matter in WGSL, so a program is its files one after the other ([`compose`]).

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
    "glint_footprint" needs [];
    "glint_hash" needs [];
    "glint_dictionary" needs ["glint_hash"];
    "bind_dictionary" needs ["glint_dictionary"];
    "query_dictionary" needs ["bind_dictionary"];
    "glint_lobes" needs ["glint_footprint"];
    "glint_lobes_packed" needs ["glint_lobes"];
    "glint_lobes_half" needs ["glint_lobes"];
    "glint_synthesis_paths" needs [];
    "glint_synthesis" needs ["glint_synthesis_paths"];
    "glint_synthesis_grid" needs ["glint_synthesis"];
    "glint_synthesis_tiles" needs ["glint_synthesis", "glint_hash"];
    "bind_lobes" needs ["glint_lobes", "glint_synthesis_paths"];
    "query_lobes" needs ["bind_lobes"];
    "glint_surface" needs ["glint_lobes", "glint_synthesis"];
    "glint_surface_seams" needs ["glint_surface"];
    "glint_surface_blocks" needs ["glint_surface"];
    "query_surface" needs ["bind_lobes", "glint_surface"];
    "view_scene" needs [];
    "view_surface" needs ["view_scene", "glint_hash"];
    "shade_smooth" needs ["view_scene", "glint_brdf"];
    "shade_dictionary" needs ["view_scene", "glint_brdf", "bind_dictionary"];
    "shade_normals" needs ["view_scene", "glint_brdf"];
    "shade_lobes" needs ["shade_normals", "bind_lobes"];
    "shade_surface" needs ["shade_normals", "bind_lobes", "glint_surface"];
    "shade_rect_points" needs ["view_scene"];
}

/// The file `name`; `None` if there is none.
pub fn module(name: &str) -> Option<&'static Module> {
    MODULES.iter().find(|module| module.name == name)
}

/// The text of a program of these files and all that they need, each once.
///
/// # Panics
/// If a file is not in [`MODULES`]: names are constants of this workspace.
pub fn compose(names: &[&str]) -> String {
    let mut taken: Vec<&str> = Vec::new();
    let mut text = String::new();
    for name in names {
        add(name, &mut taken, &mut text);
    }
    text
}

fn add(name: &str, taken: &mut Vec<&'static str>, text: &mut String) {
    let module = module(name).unwrap_or_else(|| panic!("there is no {name}.wgsl"));
    if taken.contains(&module.name) {
        return;
    }
    taken.push(module.name);
    for need in module.needs {
        add(need, taken, text);
    }
    text.push_str(module.source);
    text.push('\n');
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
