//! The scene profile: what the camera sees of the materials, and what may be spent on them.
//!
//! **Footprints.** A pixel at distance d covers p = 2 d tan(v / 2) / rows metres of a surface that faces the camera, v the
//! vertical field of view. Its footprint is a Gaussian of σ = p / 2 (as in the preview and in the area lights' mips), in
//! texels σ · texels a metre. Tilted by θ, it becomes 1 / cos θ times as long; longer than [`MOST_ANISOTROPIC`] times, it is
//! widened instead, as graphics cards do.

/// Longest footprint over its width.
pub const MOST_ANISOTROPIC: f64 = 4.0;
/// Standard deviation of a pixel's footprint over the pixel's edge.
pub const PIXEL_SIGMA: f64 = 0.5;

/// What is the same for all materials.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Columns and rows of the picture.
    pub image: (u32, u32),
    /// Vertical field of view in degrees.
    pub field_of_view: f64,
    /// Lights there are.
    pub lights: Lights,
    /// Error that a pack may have at the scene's footprints.
    pub error: f64,
    /// Bytes that all planned packs may have together.
    pub bytes: Option<u64>,
}

/// Lights of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lights {
    /// Points and directions.
    pub point: bool,
    /// Rectangles.
    pub rectangle: bool,
    /// An environment.
    pub environment: bool,
}

/// How a material is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceView {
    /// Nearest and farthest distance in metres.
    pub distance: (f64, f64),
    /// Texels, or repeats of the map, a metre.
    pub density: Density,
    /// Largest angle in degrees between the surface's normal and the view.
    pub tilt: f64,
    /// Error of its own.
    pub error: Option<f64>,
}

/// How a map lies on the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Texels a metre.
    Texels(f64),
    /// Repeats of the map a metre.
    Uv(f64),
}

/// How an environment is looked up.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentView {
    /// Least and greatest GGX roughness α of the materials in it.
    pub alpha: (f64, f64),
    /// Error of its own.
    pub error: Option<f64>,
}

/// What is seen, and how.
#[derive(Clone, Debug, PartialEq)]
pub enum Subject {
    /// A material on a surface.
    Surface(SurfaceView),
    /// An environment.
    Environment(EnvironmentView),
}

/// What can be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SubjectKind {
    /// A material on a surface.
    Surface,
    /// An environment.
    Environment,
}

impl Subject {
    /// What it is.
    pub fn kind(&self) -> SubjectKind {
        match self {
            Subject::Surface(_) => SubjectKind::Surface,
            Subject::Environment(_) => SubjectKind::Environment,
        }
    }

    /// The error that its table allows, when it says one.
    pub fn error(&self) -> Option<f64> {
        match self {
            Subject::Surface(view) => view.error,
            Subject::Environment(view) => view.error,
        }
    }
}

/// Footprints that a material is seen with, in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprints {
    /// Least and greatest standard deviation along the minor axis.
    pub sigma: (f64, f64),
    /// Greatest ratio of the axes.
    pub anisotropy: f64,
}

impl Scene {
    /// Footprints of a view of a map that is `width` texels wide.
    pub fn footprints(&self, view: &SurfaceView, width: u32) -> Footprints {
        let texels_per_metre = match view.density {
            Density::Texels(count) => count,
            Density::Uv(repeats) => repeats * f64::from(width),
        };
        let pixel = 2.0 * libm::tan(0.5 * self.field_of_view.to_radians()) / f64::from(self.image.1);
        let sigma = |distance: f64| PIXEL_SIGMA * pixel * distance * texels_per_metre;
        let stretch = 1.0 / libm::cos(view.tilt.to_radians());
        // What is longer than is allowed becomes wider.
        let anisotropy = stretch.min(MOST_ANISOTROPIC);
        Footprints { sigma: (sigma(view.distance.0), sigma(view.distance.1) * (stretch / anisotropy)), anisotropy }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn footprints_follow_from_the_camera() {
        let scene =
            Scene { image: (1600, 1000), field_of_view: 90.0, lights: Lights::default(), error: 0.1, bytes: None };
        // At a distance of 1 m the picture is 2 m high, a pixel 2 mm; σ is half of that.
        let view = SurfaceView { distance: (1.0, 3.0), density: Density::Texels(1000.0), tilt: 60.0, error: None };
        let footprints = scene.footprints(&view, 64);
        assert!((footprints.sigma.0 - 1.0).abs() < 1e-12 && (footprints.sigma.1 - 3.0).abs() < 1e-12, "{footprints:?}");
        assert!((footprints.anisotropy - 2.0).abs() < 1e-12);
        // 20 repeats of 64 texels a metre; tilted to 16 times the length, it is 4 times as long and 4 times as wide.
        let tilt = (1.0f64 / 16.0).acos().to_degrees();
        let view = SurfaceView { density: Density::Uv(20.0), tilt, ..view };
        let footprints = scene.footprints(&view, 64);
        assert!(
            (footprints.sigma.0 - 1.28).abs() < 1e-12 && (footprints.sigma.1 - 3.84 * 4.0).abs() < 1e-9,
            "{footprints:?}"
        );
        assert!((footprints.anisotropy - 4.0).abs() < 1e-12);
    }
}
