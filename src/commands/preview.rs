//! `glint-bake preview`: a picture of a pack's material on a sphere or a plane.

use crate::cli::{Terminal, values};
use crate::exit::{Exit, Failure};
use crate::info::Report;
use crate::methods::ndf_maps::info::LayersInfo;
use crate::output;
use crate::preview::{Camera, Layer, Object, Scene, Shape, Surface, render};
use clap::ValueEnum;
use glam::Vec3;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::sections;
use glint_formats::Limits;
use glint_formats::ndf_maps::LayeredMaterial;
use std::path::PathBuf;

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake preview paint.glintpack -o paint.png
  glint-bake preview paint.glintpack --shape plane --size 320x160 --light 0.5,0.3,1 -o plane.png";

/// Render a picture of a material
///
/// One directional light, microfacets with the pack's NDF, a footprint for every pixel. A pack with two layers shows
/// both, unless --material names one. Light and view point from the object: x right, y up, z towards the viewer.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Pack to show
    #[arg(value_name = "PACK")]
    pub pack: PathBuf,
    /// Picture to write (PNG)
    #[arg(short, long, value_name = "PNG")]
    pub output: PathBuf,
    /// Material to show [default: the two-layer material, else the first]
    #[arg(long, value_name = "NAME")]
    pub material: Option<String>,
    /// Object that has the material
    #[arg(long, value_name = "SHAPE", default_value = "sphere")]
    pub shape: ShapeArg,
    /// Size of the picture
    #[arg(long, value_name = "WxH", default_value = "640x640", value_parser = values::size)]
    pub size: (u32, u32),
    /// Direction towards the light
    #[arg(long, value_name = "X,Y,Z", default_value = "-0.5,0.8,0.6", value_parser = values::direction)]
    #[arg(allow_hyphen_values = true)]
    pub light: [f32; 3],
    /// Direction towards the viewer [default: 0,0.35,1 for a sphere, 0,0.8,1 for a plane]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::direction, allow_hyphen_values = true)]
    pub view: Option<[f32; 3]>,
    /// Texels of the surface across the object
    #[arg(long, value_name = "TEXELS", default_value = "1536", value_parser = values::positive)]
    pub uv_scale: f64,
    /// Reflectance at normal incidence of a material without layers, linear
    #[arg(long, value_name = "R,G,B", default_value = "0.56,0.57,0.58", value_parser = values::reflectance3)]
    pub f0: [f32; 3],
    /// Brightness of the picture
    #[arg(long, value_name = "FACTOR", default_value = "1.0", value_parser = values::positive)]
    pub exposure: f64,
    /// Threads to use [default: one a core]
    #[arg(short = 'j', long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
}

/// Light on a surface that faces it: a perfect mirror's glint is far above white, matt metal below.
const IRRADIANCE: f32 = 1.4;

/// Objects of a preview.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)] // The flag's help says it.
pub enum ShapeArg {
    Sphere,
    Plane,
}

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    output::check_distinct(&[&args.output], &[&args.pack])?;
    output::check_writable(&args.output)?;
    let report = Report::of_file(&args.pack, &Limits::default());
    let look = Look::choose(&report, args)?;
    let scene = look.scene(args);
    let (width, height) = args.size;
    let canvas = crate::cli::on_threads(args.threads, || render(&scene, width, height))?;
    output::write(&args.output, &canvas.to_png())?;
    terminal.say(&format!("{}: written, {width} × {height}", output::shown(&args.output)));
    Ok(())
}

/// The materials that a picture needs.
struct Look {
    base: Material,
    coat: Option<Material>,
    layers: Option<LayeredMaterial>,
}

impl Look {
    fn choose(report: &Report, args: &Args) -> Result<Look, Failure> {
        let pack = report.sound()?;
        let names = sections::materials(pack);
        if names.is_empty() {
            let path = args.pack.display();
            let message =
                format!("{path}: holds no NDF maps, which are all that preview draws; see it with glint-view {path}");
            return Err(Failure::new(Exit::Unsupported, message));
        }
        let load = |name: &str| sections::from_pack(pack, name).map_err(|e| Failure::bake(&args.pack, &e));
        if let Some(name) = &args.material {
            if !names.contains(&name.as_str()) {
                let message = format!("--material: expected one of {}, found {name}", names.join(", "));
                return Err(Failure::usage(message));
            }
            return Ok(Look { base: load(name)?, coat: None, layers: None });
        }
        if let Some(LayersInfo(layers)) = LayersInfo::all_of(pack).into_iter().next() {
            return Ok(Look { base: load(&layers.base)?, coat: Some(load(&layers.coat)?), layers: Some(layers) });
        }
        Ok(Look { base: load(names[0])?, coat: None, layers: None })
    }

    fn scene(&self, args: &Args) -> Scene<'_> {
        let coat = self.coat.as_ref().zip(self.layers.as_ref());
        let view = args.view.map(Vec3::from).unwrap_or(match args.shape {
            ShapeArg::Sphere => Vec3::new(0.0, 0.35, 1.0),
            ShapeArg::Plane => Vec3::new(0.0, 0.8, 1.0),
        });
        let view = view.normalize();
        let surface = Surface {
            base: Layer { material: &self.base, f0: self.layers.as_ref().map_or(args.f0, |l| l.base_f0).into() },
            coat: coat.map(|(material, layers)| Layer { material, f0: Vec3::splat(layers.coat_f0) }),
            texels_per_unit: (args.uv_scale / 2.0) as f32,
        };
        let shape = match args.shape {
            ShapeArg::Sphere => Shape::Sphere { centre: Vec3::ZERO, radius: 1.0, axis: view },
            ShapeArg::Plane => Shape::Plane { half_edge: 1.0 },
        };
        // Both shapes fit the shorter side of the picture.
        let (width, height) = (args.size.0 as f32, args.size.1 as f32);
        let half_height = 0.27 * (height / width).max(1.0);
        Scene {
            objects: vec![Object { shape, surface }],
            light: Vec3::from(args.light).normalize(),
            irradiance: Vec3::splat(IRRADIANCE),
            camera: Camera { position: view * 4.6, target: Vec3::ZERO, half_height },
            exposure: args.exposure as f32,
            fade: None,
        }
    }
}
