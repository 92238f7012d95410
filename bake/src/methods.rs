//! The methods and their shaders: the one file of this crate that a new method is written into. Its folder is the method.

use crate::shader::Shader;

#[path = "area_light/mod.rs"]
pub mod area_light;
#[path = "counting/mod.rs"]
pub mod counting;
#[path = "dictionary/mod.rs"]
pub mod dictionary;
#[path = "environment/mod.rs"]
pub mod environment;
#[path = "glints/mod.rs"]
pub mod glints;
#[path = "lobes/mod.rs"]
pub mod lobes;
#[path = "ndf_maps/mod.rs"]
pub mod ndf_maps;
#[path = "surface/mod.rs"]
pub mod surface;
#[path = "synthesis/mod.rs"]
pub mod synthesis;
#[path = "textures/mod.rs"]
pub mod textures;

/// The WGSL files of every method.
pub(crate) const SHADERS: &[&[Shader]] = &[
    crate::dictionary::SHADERS,
    crate::area_light::SHADERS,
    crate::counting::SHADERS,
    crate::environment::SHADERS,
    crate::glints::SHADERS,
    crate::ndf_maps::SHADERS,
    crate::lobes::SHADERS,
    crate::synthesis::SHADERS,
    crate::surface::SHADERS,
];
