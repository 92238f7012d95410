//! The demo's picture: a painted sphere on a brushed plate.

use crate::canvas::Canvas;
use crate::exit::{Exit, Failure};
use crate::info::Report;
use crate::methods::ndf_maps::info::LayersInfo;
use crate::preview::{Camera, Layer, Object, Scene, Shape, Surface, render};
use glam::Vec3;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::sections;
use std::path::Path;

/// Steel, a little warm.
const PLATE_F0: Vec3 = Vec3::new(0.42, 0.40, 0.385);

/// The materials of the demo, as they were read back.
pub struct Look {
    paint: Material,
    coat: Material,
    plate: Material,
    coat_f0: f32,
    base_f0: [f32; 3],
}

impl Look {
    /// Takes the materials from the pack that was written.
    pub fn new(report: &Report) -> Result<Look, Failure> {
        let missing = || Failure::new(Exit::Unexpected, format!("{}: lacks what was baked", report.file));
        let pack = report.pack().ok_or_else(missing)?;
        let layers = LayersInfo::all_of(pack).into_iter().next().ok_or_else(missing)?.0;
        let load = |name: &str| sections::from_pack(pack, name).map_err(|e| Failure::bake(Path::new(&report.file), &e));
        Ok(Look {
            paint: load(&layers.base)?,
            coat: load(&layers.coat)?,
            plate: load("plate")?,
            coat_f0: layers.coat_f0,
            base_f0: layers.base_f0,
        })
    }

    /// Paints the picture.
    pub fn paint(&self, width: u32, height: u32) -> Canvas {
        let camera =
            Camera { position: Vec3::new(0.25, 1.75, 5.2), target: Vec3::new(0.35, 0.72, 0.0), half_height: 0.27 };
        let centre = Vec3::new(-0.45, 1.0, 0.0);
        let axis = (camera.position - centre).normalize();
        let sphere = Object {
            shape: Shape::Sphere { centre, radius: 1.0, axis },
            surface: Surface {
                base: Layer { material: &self.paint, f0: self.base_f0.into() },
                coat: Some(Layer { material: &self.coat, f0: Vec3::splat(self.coat_f0) }),
                texels_per_unit: 800.0,
            },
        };
        let plate = Object {
            shape: Shape::Plane { half_edge: 20.0 },
            surface: Surface {
                base: Layer { material: &self.plate, f0: PLATE_F0 },
                coat: None,
                texels_per_unit: 680.0,
            },
        };
        let scene = Scene {
            objects: vec![sphere, plate],
            light: Vec3::new(0.37, 0.85, 0.20).normalize(),
            irradiance: Vec3::new(2.7, 2.6, 2.4),
            camera,
            exposure: 1.0,
            fade: Some(9.0),
        };
        render(&scene, width, height)
    }
}
