//! A WGSL file of the run time, and the macro by which a method lists its own.

/// A WGSL file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shader {
    /// Its path without `.wgsl`, as `#import` lines name it: `lobes::query`, or `hash` for ground that several methods stand on.
    pub name: &'static str,
    /// Its text.
    pub source: &'static str,
}

/// `SHADERS` of a method: the WGSL files beside the invoking file, by name.
macro_rules! shaders {
    ($method:literal: $($file:literal),* $(,)?) => {
        /// The run time of this method in WGSL.
        pub const SHADERS: &[$crate::shader::Shader] = &[$($crate::shader::Shader {
            name: concat!($method, "::", $file),
            source: include_str!(concat!($file, ".wgsl")),
        }),*];
    };
}
pub(crate) use shaders;
