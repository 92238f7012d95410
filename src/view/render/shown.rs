//! What can be shown of a pack: a method with its data, its parameters, and the WGSL that draws it.

use super::uniforms::Material;
use crate::gpu::Resources;
use std::rc::Rc;

/// A way to shade a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Method {
    /// The smooth BRDF that glints converge to.
    Smooth,
    /// Slope dictionary.
    Dictionary,
}

impl Method {
    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Method::Smooth => "smooth",
            Method::Dictionary => "dictionary",
        }
    }

    /// The WGSL files of its program.
    pub(super) fn files(self) -> &'static [&'static str] {
        match self {
            Method::Smooth => &["shade_smooth", "shade_rect_points", "shade_environment_none"],
            Method::Dictionary => &["shade_dictionary", "shade_rect_points", "shade_environment_none"],
        }
    }
}

/// A method with data and parameters, ready to draw.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Name of the material in the pack; empty for the smooth BRDF.
    pub name: String,
    /// Method.
    pub method: Method,
    /// Group 1.
    pub data: Rc<Resources>,
    /// Parameters.
    pub material: Material,
}
