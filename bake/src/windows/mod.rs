//! What a Gaussian footprint sees of a normal map, for the methods that read one: the footprint as an [`ellipse`], and a bilinear
//! [`patch`] of normals under it in closed form.

pub mod ellipse;
pub mod patch;

crate::shader::shaders!("windows": "ellipse", "patch");
