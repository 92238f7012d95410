//! What can be shown of a pack: a method with its data, its parameters, and the WGSL that draws it.

use super::uniforms::{ACCURATE, IN_SPACE, Lights, MAX_POINT_LIGHTS, Material};
use crate::gpu::Resources;
use std::rc::Rc;

/// A kind of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    /// Light from one direction.
    Sun,
    /// Points.
    Points,
    /// A rectangle.
    Rect,
    /// The environment of a pack.
    Environment,
}

/// A way to shade a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Method {
    /// The smooth BRDF that glints converge to.
    Smooth,
    /// Slope dictionary.
    Dictionary,
    /// Multi-scale NDF maps of tiny examples, in one or two layers.
    NdfMaps,
    /// MIP-mapped lobes of a repeated map.
    Lobes,
    /// A surface synthesised from patches of a map, by the map's lobes.
    Surface,
    /// Environment with glints, by radiance levels.
    Environment,
    /// Counted facets under every light.
    Glints,
    /// Multi-scale LTC: mean normals with the roughness of what they average.
    AreaLight,
    /// The same normals with one roughness everywhere: plain LTC.
    PlainLtc,
    /// Materials as textures with mips, which any engine draws.
    Textures,
    /// The same with mips that an engine makes of the finest level.
    PlainTextures,
}

/// What is known of a method.
struct Facts {
    name: &'static str,
    light: LightKind,
    baseline: Option<Method>,
    has_map: bool,
}

impl Method {
    /// Every method.
    pub const ALL: &[Method] = &[
        Method::Smooth,
        Method::Dictionary,
        Method::NdfMaps,
        Method::Lobes,
        Method::Surface,
        Method::Environment,
        Method::Glints,
        Method::AreaLight,
        Method::PlainLtc,
        Method::Textures,
        Method::PlainTextures,
    ];

    fn facts(self) -> Facts {
        match self {
            Method::Smooth => Facts { name: "smooth", light: LightKind::Sun, baseline: None, has_map: false },
            Method::Dictionary => {
                Facts { name: "dictionary", light: LightKind::Sun, baseline: Some(Method::Smooth), has_map: false }
            }
            Method::NdfMaps => {
                Facts { name: "ndf-maps", light: LightKind::Sun, baseline: Some(Method::Smooth), has_map: true }
            }
            Method::Lobes => {
                Facts { name: "lobes", light: LightKind::Sun, baseline: Some(Method::Smooth), has_map: true }
            }
            Method::Surface => {
                Facts { name: "surface", light: LightKind::Sun, baseline: Some(Method::Smooth), has_map: true }
            }
            Method::Environment => Facts {
                name: "environment",
                light: LightKind::Environment,
                baseline: Some(Method::Smooth),
                has_map: false,
            },
            Method::Glints => {
                Facts { name: "glints", light: LightKind::Sun, baseline: Some(Method::Smooth), has_map: false }
            }
            Method::AreaLight => {
                Facts { name: "area-light", light: LightKind::Rect, baseline: Some(Method::PlainLtc), has_map: true }
            }
            Method::PlainLtc => Facts { name: "plain-ltc", light: LightKind::Rect, baseline: None, has_map: true },
            Method::Textures => {
                Facts { name: "textures", light: LightKind::Sun, baseline: Some(Method::PlainTextures), has_map: true }
            }
            Method::PlainTextures => {
                Facts { name: "plain-textures", light: LightKind::Sun, baseline: None, has_map: true }
            }
        }
    }

    /// Name on the command line, in reports, and of its program in [`glint_shaders::SHADING`].
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// The light that it is made for.
    pub fn usual_light(self) -> LightKind {
        self.facts().light
    }

    /// What its cost is compared with: the same light on a surface without glints; nothing for those themselves.
    pub fn baseline(self) -> Option<Method> {
        self.facts().baseline
    }

    /// Whether it draws a map, whose texels have a size on the surface.
    pub fn has_map(self) -> bool {
        self.facts().has_map
    }

    /// Whether it has a reference besides the mean over its seeds.
    pub fn has_reference(self) -> bool {
        !matches!(self, Method::Environment | Method::Glints)
    }

    /// Pipeline constants of its program that follow from a material.
    fn constants(self, material: &Material) -> Vec<(&'static str, f64)> {
        match self {
            Method::Dictionary => vec![
                asks("DICTIONARY_PARTIAL", material.relative_area < 1.0),
                asks("DICTIONARY_RANDOMISED", material.density_randomisation > 0.0),
                asks("DICTIONARY_COLOURED", material.colours > 0),
            ],
            Method::NdfMaps => vec![asks("NDF_MAPS_ACCURATE", material.switches & ACCURATE != 0)],
            Method::Glints => vec![
                asks("GLINTS_COLOURED", material.colours > 0),
                asks("GLINTS_PARTIAL", material.relative_area < 1.0),
                asks("GLINTS_IN_SPACE", material.switches & IN_SPACE != 0),
            ],
            Method::AreaLight => vec![asks("AREA_LIGHT_DIRECTIONAL", material.lobes > 0)],
            _ => Vec::new(),
        }
    }
}

/// A method with data and parameters, ready to draw.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Name of the material in the pack; empty for the smooth BRDF.
    pub name: String,
    /// Method.
    pub method: Method,
    /// Group 1.
    pub data: Rc<Resources>,
    /// Group 1 of each part of the mesh that it was made for; none where `data` is that of all.
    pub parts: Vec<Rc<Resources>>,
    /// Parameters.
    pub material: Material,
    /// Files of the program that follow from the data: one of each group of [`glint_shaders::CHOICES`].
    pub files: Vec<&'static str>,
    /// Pipeline constants that follow from the data.
    pub constants: Vec<(&'static str, f64)>,
    /// Widest intrinsic roughness at which next to nothing of lobes lies beyond the rim of the disk of normals.
    pub rim_roughness: f32,
}

impl Subject {
    /// Bytes of its data on the GPU.
    pub fn bytes(&self) -> u64 {
        let mut all: Vec<&Rc<Resources>> = self.parts.iter().chain([&self.data]).collect();
        all.sort_by_key(|data| Rc::as_ptr(data));
        all.dedup_by(|a, b| Rc::ptr_eq(a, b));
        all.iter().map(|data| data.bytes).sum()
    }

    /// All pipeline constants of its program for a material in these lights.
    pub(super) fn pipeline_constants(&self, material: &Material, lights: &Lights) -> Vec<(&'static str, f64)> {
        let mut constants = self.constants.clone();
        constants.push(("NORMAL_TARGET", f64::from(material.normal_target)));
        constants.extend(self.method.constants(material));
        if self.method == Method::Glints {
            constants.push(("GLINTS_POINTS", lights.points.len().min(MAX_POINT_LIGHTS) as f64));
        }
        if matches!(self.method, Method::Lobes | Method::Surface) {
            constants.push(asks("LOBES_RIM", material.intrinsic_roughness > self.rim_roughness));
        }
        constants
    }
}

/// Index of what entry `index` of a list is compared with: the baseline of its method, of the same material; none where it has none.
pub fn baseline_of(list: &[Subject], index: usize) -> Option<usize> {
    let shown = &list[index];
    let method = shown.method.baseline()?;
    list.iter().position(|other| other.method == method && (other.name == shown.name || method == Method::Smooth))
}

/// A pipeline constant that is a switch.
fn asks(name: &'static str, asked: bool) -> (&'static str, f64) {
    (name, f64::from(u8::from(asked)))
}
