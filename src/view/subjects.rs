//! What packs hold that can be shown, on the GPU.

use crate::gpu::{Gpu, GpuError, ResourceSet, Resources, bind_pack};
use crate::methods::{self, textures::Textured};
use crate::render::{Material, Method, Renderer, Subject};
use crate::scene::Mesh;
use glam::Vec3;
use glint_bake_core::error::BakeError;
use glint_bake_core::{area_light, dictionary, environment, glints, lobes, ndf_maps, surface, synthesis};
use glint_formats::glints::GlintsParams;
use glint_formats::lobes::{BINDINGS, LobesParams};
use glint_formats::ndf_maps::MaterialUniform;
use glint_formats::{Pack, Wrap};
use std::rc::Rc;

/// All that can be shown, and the environment that can light it.
#[derive(Debug, Default)]
pub struct Subjects {
    /// What can be shown, the smooth BRDF last.
    pub shown: Vec<Subject>,
    /// What lights a scene whose environment is on; black where no pack has one.
    pub environment: Option<Rc<Resources>>,
    /// Pipeline constants of programs that reflect it.
    environment_constants: Vec<(&'static str, f64)>,
    left_out: Vec<String>,
}

impl Subjects {
    /// What the user should know: what of the packs is left out.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = self.left_out.clone();
        notes.sort_unstable();
        notes.dedup();
        notes
    }

    /// Uploads what `packs`, which passed verification, hold. Glints of dictionaries have `colours` (linear RGB; none means
    /// white).
    pub fn of_packs(gpu: &Gpu, packs: &[&Pack], colours: &[Vec3]) -> Result<Subjects, GpuError> {
        let mut subjects = Subjects::default();
        for pack in packs {
            subjects.add_dictionaries(gpu, pack, colours)?;
            subjects.add_ndf_maps(gpu, pack)?;
            subjects.add_lobes(gpu, pack)?;
            subjects.add_surfaces(gpu, pack)?;
            subjects.add_environments(gpu, pack)?;
            subjects.add_area_lights(gpu, pack)?;
            subjects.add_glints(gpu, pack)?;
        }
        subjects.add(Method::Smooth, "", &nothing(gpu), Material::default());
        subjects.light_all();
        Ok(subjects)
    }

    /// Uploads what a file says of its surfaces, and shows it before the smooth BRDF: with its own mips, and with plain ones.
    pub fn add_textures(&mut self, gpu: &Gpu, textured: &Textured) -> Result<(), GpuError> {
        let texels_per_unit = textured.texels();
        for method in [Method::Textures, Method::PlainTextures] {
            let materials = methods::textures::upload(gpu, textured, method == Method::PlainTextures)?;
            let Some(first) = materials.first() else { continue };
            let mut constants = self.environment_constants.clone();
            constants.push(("EMITS", f64::from(u8::from(textured.emits()))));
            let material = Material { texels_per_unit, ..Material::default() };
            let shown = Subject {
                name: textured.name.clone(),
                method,
                data: Rc::clone(first),
                parts: textured.parts.iter().map(|&material| Rc::clone(&materials[material])).collect(),
                material,
                files: Vec::new(),
                constants,
                rim_roughness: 0.0,
            };
            self.shown.insert(self.shown.len() - 1, shown);
        }
        Ok(())
    }

    /// A renderer of a mesh in the light of the environment, if there is one.
    pub fn renderer(&self, gpu: &Gpu, mesh: &Mesh) -> Result<Renderer, GpuError> {
        let mut renderer = Renderer::new(gpu, mesh)?;
        if let Some(environment) = &self.environment {
            renderer.set_environment(Rc::clone(environment));
        }
        Ok(renderer)
    }

    fn add(&mut self, method: Method, name: &str, data: &Rc<Resources>, material: Material) -> &mut Subject {
        let (name, data) = (name.to_owned(), Rc::clone(data));
        let (parts, files, constants) = (Vec::new(), Vec::new(), Vec::new());
        self.shown.push_mut(Subject { name, method, data, parts, material, files, constants, rim_roughness: 0.0 })
    }

    fn add_dictionaries(&mut self, gpu: &Gpu, pack: &Pack, colours: &[Vec3]) -> Result<(), GpuError> {
        for name in dictionary::sections::dictionaries(pack) {
            let params = dictionary::sections::params(pack, name).map_err(bad)?;
            let mut material = Material { alpha: [params.alpha_dict as f32; 2], ..Material::default() };
            if !colours.is_empty() {
                material.colours = colours.len() as u32;
                material.mean_colour = (colours.iter().sum::<Vec3>() / colours.len() as f32).to_array();
            }
            let data = Rc::new(methods::dictionary::upload(gpu, pack, name, colours)?);
            self.add(Method::Dictionary, name, &data, material);
        }
        Ok(())
    }

    /// Layered materials first, then each of its own.
    fn add_ndf_maps(&mut self, gpu: &Gpu, pack: &Pack) -> Result<(), GpuError> {
        let read = |name: &str| ndf_maps::sections::uniform(pack, name).map_err(bad);
        for (name, layered) in ndf_maps::sections::layered(pack).map_err(bad)? {
            let (base, coat) = (read(&layered.base)?, read(&layered.coat)?);
            let data = methods::ndf_maps::bind(gpu, pack, &layered.base, Some((&layered.coat, name)))?;
            let material = Material { f0: layered.base_f0, ..ndf_material(&base) };
            let title = format!("{}+{}", layered.coat, layered.base);
            let shown = self.add(Method::NdfMaps, &title, &Rc::new(data), material);
            shown.constants = methods::ndf_maps::constants(&base, Some(&coat));
        }
        for name in ndf_maps::sections::materials(pack) {
            let uniform = read(name)?;
            let data = Rc::new(methods::ndf_maps::bind(gpu, pack, name, None)?);
            let shown = self.add(Method::NdfMaps, name, &data, ndf_material(&uniform));
            shown.constants = methods::ndf_maps::constants(&uniform, None);
        }
        Ok(())
    }

    fn add_lobes(&mut self, gpu: &Gpu, pack: &Pack) -> Result<(), GpuError> {
        for name in lobes::sections::maps(pack) {
            let params = lobes::sections::params(pack, name).map_err(bad)?;
            let data = Rc::new(bind_pack(gpu, pack, name, BINDINGS, params.wrap)?);
            let shown = self.add(Method::Lobes, name, &data, lobes_material(&params));
            shown.files = methods::lobes::modules(&params).to_vec();
            shown.rim_roughness = params.rim_roughness;
        }
        Ok(())
    }

    fn add_surfaces(&mut self, gpu: &Gpu, pack: &Pack) -> Result<(), GpuError> {
        for name in surface::sections::surfaces(pack) {
            let params = &lobes::sections::params(pack, name).map_err(bad)?;
            let synthesis = &synthesis::sections::params(pack, name).map_err(bad)?;
            let data = Rc::new(bind_pack(gpu, pack, name, BINDINGS, params.wrap)?);
            let shown = self.add(Method::Surface, name, &data, lobes_material(params));
            shown.files = methods::lobes::surface_modules(params, synthesis, true).to_vec();
            shown.rim_roughness = params.rim_roughness;
        }
        Ok(())
    }

    /// The first environment lights the scene; the others would need one of their own.
    fn add_environments(&mut self, gpu: &Gpu, pack: &Pack) -> Result<(), GpuError> {
        for name in environment::sections::environments(pack) {
            if self.environment.is_some() {
                self.left_out.push(format!("environment '{name}' is left out: a scene has one, the first"));
                continue;
            }
            let params = environment::sections::params(pack, name).map_err(bad)?;
            let bindings = glint_formats::environment::BINDINGS;
            self.environment = Some(Rc::new(bind_pack(gpu, pack, name, bindings, Wrap::Clamp)?));
            let material = Material { alpha: [0.25; 2], ..Material::default() };
            self.add(Method::Environment, name, &nothing(gpu), material);
            self.environment_constants = methods::environment::constants(&params);
        }
        Ok(())
    }

    fn add_glints(&mut self, gpu: &Gpu, pack: &Pack) -> Result<(), GpuError> {
        for name in glints::sections::materials(pack) {
            let params = glints::sections::params(pack, name).map_err(bad)?;
            let data = Rc::new(bind_pack(gpu, pack, name, glint_formats::glints::BINDINGS, Wrap::Clamp)?);
            let shown = self.add(Method::Glints, name, &data, glints_material(&params));
            let has = |layer: bool| f64::from(u8::from(layer));
            shown.constants.push(("GLINTS_TURNED", has(params.turn != 0.0)));
            shown.constants.push(("GLINTS_DIFFUSE", has(params.diffuse != [0.0; 3])));
            shown.constants.push(("GLINTS_COATED", has(params.coat > 0.0)));
        }
        Ok(())
    }

    /// Every program reflects the environment that lights the scene, of whichever pack.
    fn light_all(&mut self) {
        for shown in &mut self.shown {
            shown.constants.extend(self.environment_constants.iter().copied());
        }
    }

    fn add_area_lights(&mut self, gpu: &Gpu, pack: &Pack) -> Result<(), GpuError> {
        for name in area_light::sections::materials(pack) {
            let params = area_light::sections::params(pack, name).map_err(bad)?;
            let material = Material {
                alpha: [0.1; 2],
                texels_per_unit: params.width as f32,
                lobes: if params.anisotropic { area_light::eval::LOBES } else { 0 },
                ..Material::default()
            };
            let data = Rc::new(bind_pack(gpu, pack, name, glint_formats::area_light::BINDINGS, params.wrap)?);
            self.add(Method::AreaLight, name, &data, material);
            self.add(Method::PlainLtc, name, &data, material);
        }
        Ok(())
    }
}

/// The data of methods that have none of their own.
fn nothing(gpu: &Gpu) -> Rc<Resources> {
    Rc::new(ResourceSet::default().finish(gpu))
}

/// A tiny example repeats some times over the surface.
fn ndf_material(uniform: &MaterialUniform) -> Material {
    const EXAMPLES: f32 = 16.0;
    Material {
        intrinsic_roughness: uniform.intrinsic_roughness,
        texels_per_unit: EXAMPLES * uniform.size[0].max(uniform.size[1]) as f32,
        ..Material::default()
    }
}

fn lobes_material(params: &LobesParams) -> Material {
    Material {
        intrinsic_roughness: params.intrinsic_roughness,
        texels_per_unit: params.width.max(params.height) as f32,
        ..Material::default()
    }
}

fn glints_material(params: &GlintsParams) -> Material {
    let uniform = params.uniform();
    Material {
        f0: uniform.f0,
        alpha: uniform.alpha,
        normal_target: uniform.normal_target,
        density: uniform.density,
        mean_colour: uniform.mean_colour,
        relative_area: uniform.relative_area,
        seed: uniform.seed,
        colours: uniform.colours,
        facet_spread: uniform.facet_spread,
        sky_spread: uniform.sky_spread,
        ..Material::default()
    }
}

fn bad(error: BakeError) -> GpuError {
    GpuError::BadPack(error.to_string())
}
