//! What packs hold that can be shown, on the GPU.

use crate::gpu::{Gpu, GpuError, ResourceSet, Resources};
use crate::methods;
use crate::render::{Material, Method, Shown};
use glam::Vec3;
use glint_bake_core::dictionary;
use glint_bake_core::error::BakeError;
use glint_formats::Pack;
use std::rc::Rc;

/// All that can be shown, and the environments that can light it.
#[derive(Debug, Default)]
pub struct Subjects {
    /// What can be shown, the smooth BRDF last.
    pub shown: Vec<Shown>,
    /// What the user should know.
    pub notes: Vec<String>,
}

impl Subjects {
    /// Uploads what `packs`, which passed verification, hold. Glints of dictionaries have `colours` (linear RGB; none means
    /// white).
    pub fn of_packs(gpu: &Gpu, packs: &[&Pack], colours: &[Vec3]) -> Result<Subjects, GpuError> {
        let mut subjects = Subjects::default();
        for pack in packs {
            subjects.add_dictionaries(gpu, pack, colours)?;
        }
        let empty = ResourceSet::default().finish(gpu);
        subjects.add(Method::Smooth, "", empty, Material::default());
        Ok(subjects)
    }

    fn add(&mut self, method: Method, name: &str, data: Resources, material: Material) {
        for note in &data.notes {
            self.notes.push(format!("{} {name}: {note}", method.name()));
        }
        self.shown.push(Shown { name: name.to_owned(), method, data: Rc::new(data), material });
    }

    fn add_dictionaries(&mut self, gpu: &Gpu, pack: &Pack, colours: &[Vec3]) -> Result<(), GpuError> {
        for name in dictionary::sections::dictionaries(pack) {
            let (tables, params) = dictionary::sections::from_pack(pack, name).map_err(bad)?;
            let mut material = Material { alpha: [params.alpha_dict as f32; 2], ..Material::default() };
            if !colours.is_empty() {
                material.colours = colours.len() as u32;
                material.mean_colour = (colours.iter().sum::<Vec3>() / colours.len() as f32).to_array();
            }
            self.add(Method::Dictionary, name, methods::dictionary::upload(gpu, &tables, colours), material);
        }
        Ok(())
    }
}

fn bad(error: BakeError) -> GpuError {
    GpuError::BadPack(error.to_string())
}
