//! The run time in WGSL: a shader lies beside its twin, `<method>/<file>.wgsl` beside `<method>/<file>.rs`.
//!
//! Functions have the names of the twin's with `glint_` in front. A file names the files that it calls in lines `#import
//! <method>::<file>`, and lists on top the accessors that the including program defines; no file has bindings.

use crate::methods::SHADERS;
pub use crate::shader::Shader;

/// Ground that several methods stand on.
const GROUND: &[Shader] = &[
    Shader { name: "brdf", source: include_str!("brdf.wgsl") },
    Shader { name: "erf", source: include_str!("erf.wgsl") },
    Shader { name: "footprint", source: include_str!("footprint.wgsl") },
    Shader { name: "ggx", source: include_str!("ggx.wgsl") },
    Shader { name: "microfacet", source: include_str!("microfacet.wgsl") },
    Shader { name: "moments", source: include_str!("moments.wgsl") },
    Shader { name: "hash", source: include_str!("hash.wgsl") },
];

/// Every WGSL file of the run time.
pub fn all() -> impl Iterator<Item = &'static Shader> {
    GROUND.iter().chain(crate::windows::SHADERS).chain(SHADERS.iter().copied().flatten())
}
