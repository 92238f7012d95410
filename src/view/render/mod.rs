//! Pictures of a scene: programs, passes and targets.

mod accumulate;
mod full_screen;
mod picture;
mod pipelines;
mod present;
mod renderer;
mod subject;
mod targets;
mod timing;
mod uniforms;

pub use picture::{Picture, further, picture, read_picture};
pub use present::{Display, Overlay, ToneMapping};
pub use renderer::{Compare, Renderer, Side, View};
pub use subject::{LightKind, Method, Subject, baseline_of};
pub use uniforms::{
    ACCURATE, Camera, Environment, IN_SPACE, Lights, MAX_POINT_LIGHTS, Material, PointLight, RectLight, SWAP_LAYERS,
    Scene, Sun,
};
