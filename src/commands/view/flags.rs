//! The command line of glint-view. It is compiled into every build, so that manual pages and completions are whole.

use crate::cli::values;
use clap::ValueEnum;
use std::path::PathBuf;

/// Flags of glint-view.
#[derive(clap::Args, Clone, Debug)]
pub struct Args {
    /// Packs to show; what all of them hold can be compared
    ///
    /// Lists that `glint-bake textures` writes, DIR/NAME.json, are shown, too. None is needed with --mesh, whose materials are shown.
    #[arg(value_name = "PACK", required_unless_present = "mesh")]
    pub packs: Vec<PathBuf>,
    /// List what the packs hold that can be shown, and the adapter
    #[arg(long)]
    pub list: bool,
    #[command(flatten)]
    pub picture: PictureFlags,
    #[command(flatten)]
    pub view: ViewFlags,
    #[command(flatten)]
    pub scene: SceneFlags,
    #[command(flatten)]
    pub material: MaterialFlags,
    /// Most bytes to read and to decompress of a pack or an image, as in 512M
    #[arg(long, value_name = "BYTES", default_value = "4G", value_parser = values::bytes)]
    pub max_memory: u64,
}

/// Flags of work without a window.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Without a window")]
pub struct PictureFlags {
    /// Write a picture (PNG) and open no window
    ///
    /// The same adapter gives the same bytes.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["turntable", "bench", "list"])]
    pub headless: Option<PathBuf>,
    /// Write pictures from all around, --frames of them, into this folder
    #[arg(long, value_name = "DIR", conflicts_with_all = ["bench", "list"])]
    pub turntable: Option<PathBuf>,
    /// Print the time of a frame of each method over that of its smooth baseline, and its error
    #[arg(long, conflicts_with = "list")]
    pub bench: bool,
    /// Print what --bench measures as JSON
    #[arg(long, requires = "bench")]
    pub json: bool,
    /// Pictures of --turntable; frames of --bench; with a window, frames until it closes
    ///
    /// The median of frames counts. The defaults are 36 pictures, 20 frames, and no end.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: Option<u32>,
    /// Frames that a picture is the mean of, for smooth edges and for references
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub samples: u32,
    /// Pixels of pictures and of the window
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = values::size)]
    pub size: (u32, u32),
    /// Use the adapter whose name holds this
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

impl PictureFlags {
    /// Whether nothing that is asked for does without a window.
    #[cfg(feature = "view")]
    pub fn opens_window(&self, list: bool) -> bool {
        !list && !self.bench && self.headless.is_none() && self.turntable.is_none()
    }
}

/// Flags of what is shown.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "View")]
pub struct ViewFlags {
    /// What to show, as --list names it: a method, or METHOD:NAME [default: the first of the list]
    #[arg(long, value_name = "METHOD")]
    pub method: Option<String>,
    /// What to compare it with: another entry of --list, baseline, or reference
    ///
    /// The baseline is what the method is measured against, as --bench does; the reference is the method's own brute force.
    #[arg(long, value_name = "METHOD")]
    pub against: Option<String>,
    /// How to compare
    #[arg(long, value_name = "HOW", default_value = "split", requires = "against")]
    pub compare: CompareWhen,
    /// Show the reference in place of the method
    #[arg(long, conflicts_with = "against")]
    pub reference: bool,
    /// False colours in place of radiance
    ///
    /// Blue to red: footprints from 1/8 to 64 texels, level of detail 0 to 10, look-ups 0 to 1023, operations 0 to
    /// 65535.
    #[arg(long, value_name = "WHAT", default_value = "none")]
    pub overlay: OverlayKind,
    /// Exposure in stops
    ///
    /// Radiance is multiplied by 2 to this.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_hyphen_values = true, value_parser = values::finite)]
    pub exposure: f32,
    /// From radiance to what a display can show
    #[arg(long, value_name = "CURVE", default_value = "filmic")]
    pub tone: Tone,
    /// Another seed every frame, so that the mean over --samples is that over surfaces
    #[arg(long)]
    pub vary_seed: bool,
}

/// Flags of the scene.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Scene")]
pub struct SceneFlags {
    /// Shape to draw
    #[arg(long, value_name = "SHAPE", default_value = "plane")]
    pub shape: ShapeKind,
    /// Draw this mesh (.glb, .gltf, .obj) instead
    ///
    /// The materials of a glTF file are one more method, textures.
    #[arg(long, value_name = "FILE", conflicts_with = "shape")]
    pub mesh: Option<PathBuf>,
    /// Camera as azimuth,elevation,distance or azimuth,elevation,distance,x,y,z: degrees, then what it looks at
    #[arg(long, value_name = "CAMERA", allow_hyphen_values = true)]
    pub camera: Option<String>,
    /// Lights that are on [default: the rectangle for area lights, the environment for environments, else the sun]
    #[arg(long, value_name = "LIGHT", value_delimiter = ',')]
    pub light: Vec<LightFlag>,
    /// Direction towards the sun
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::direction)]
    pub sun: Option<[f32; 3]>,
    /// Angle across the sun's disk as counted facets see it, in degrees, 0 to 180
    #[arg(long, value_name = "DEGREES", default_value_t = 0.533, value_parser = values::not_negative)]
    pub sun_size: f32,
    /// Radius of the points as counted facets see them, in world units [default: a fiftieth of the mesh's radius]
    #[arg(long, value_name = "RADIUS", value_parser = values::not_negative)]
    pub point_radius: Option<f32>,
    /// Turn of the environment around the vertical axis, in degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_hyphen_values = true, value_parser = values::finite)]
    pub turn: f32,
    /// Surface units on one unit of the mesh's uv
    #[arg(long, value_name = "N", default_value_t = 1.0, value_parser = values::positive)]
    pub uv_scale: f64,
}

/// Flags of the material; what is not given is what the pack was baked with.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Material")]
pub struct MaterialFlags {
    /// Roughness α, the same along both axes, or along each
    #[arg(long, value_name = "A[,B]", value_parser = values::roughness_pair)]
    pub alpha: Option<[f64; 2]>,
    /// Distribution of slopes that dictionaries and counted facets converge to
    #[arg(long, value_name = "TARGET")]
    pub target: Option<TargetKind>,
    /// Facets on one surface unit squared
    #[arg(long, value_name = "N", value_parser = values::positive)]
    pub density: Option<f64>,
    /// Share of the surface that glints, 0 to 1
    #[arg(long, value_name = "SHARE", value_parser = values::reflectance)]
    pub relative_area: Option<f32>,
    /// Standard deviation of a cell's level of density
    #[arg(long, value_name = "LEVELS", value_parser = values::not_negative)]
    pub density_randomisation: Option<f32>,
    /// Largest ratio of the footprint's axes, 1 to 16
    #[arg(long, value_name = "RATIO", value_parser = values::positive)]
    pub max_anisotropy: Option<f64>,
    /// Intrinsic roughness of NDF maps and lobes: standard deviation of projected normals
    #[arg(long, value_name = "SIGMA", value_parser = values::positive)]
    pub intrinsic_roughness: Option<f64>,
    /// Texels of the map on one surface unit
    #[arg(long, value_name = "N", value_parser = values::positive)]
    pub texels_per_unit: Option<f64>,
    /// Reflectance at normal incidence, linear RGB
    #[arg(long, value_name = "R,G,B", value_parser = values::reflectance3)]
    pub f0: Option<[f32; 3]>,
    /// Colour of glints, linear RGB; may be given more than once
    #[arg(long, value_name = "R,G,B", value_parser = values::reflectance3)]
    pub colour: Vec<[f32; 3]>,
    /// Half angle of the cone that a counted facet reflects a point into, in degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::positive)]
    pub facet_spread: Option<f64>,
    /// By how much the eye turns, in degrees, until counted facets under an environment are others; 0 for never
    #[arg(long, value_name = "DEGREES", value_parser = values::not_negative)]
    pub sky_spread: Option<f32>,
    /// Counted facets lie in space and not in uv: for meshes without uv
    ///
    /// A surface unit is a world unit then, times --uv-scale.
    #[arg(long)]
    pub in_space: bool,
    /// Lobes of directional roughness of area lights, 0 to 9
    ///
    /// 0 is round.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=9))]
    pub lobes: Option<u32>,
    /// Surfaces with different seeds have different glints
    #[arg(long, value_name = "SEED")]
    pub seed: Option<u32>,
    /// Exchange the layers of two-layer materials
    #[arg(long)]
    pub swap_layers: bool,
}

/// How two sides are put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CompareWhen {
    /// Left and right of a line
    Split,
    /// Relative difference in false colours
    Error,
}

/// False colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OverlayKind {
    /// None
    None,
    /// Standard deviation of the footprint in texels
    Footprint,
    /// Level of detail that is read
    Lod,
    /// Look-ups of the method's data a pixel
    Loads,
    /// Arithmetic operations a pixel
    Operations,
}

/// Tone mapping.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Tone {
    /// A filmic curve
    Filmic,
    /// Clamped at white
    Linear,
}

/// Shapes by formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ShapeKind {
    /// A horizontal square
    Plane,
    /// A sphere
    Sphere,
}

/// Lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LightFlag {
    /// Directional light
    Sun,
    /// Points
    Points,
    /// Rectangle
    Rect,
    /// The environment of a pack
    Environment,
}

/// Targets of dictionaries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TargetKind {
    /// Beckmann
    Beckmann,
    /// GGX
    Ggx,
}
