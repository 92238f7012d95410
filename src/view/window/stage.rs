//! All that lives on the device, and what happens when it is lost.

use crate::gpu::{Gpu, GpuError, Resources};
use crate::render::{Picture, Renderer, Subject, read_picture};
use crate::scene::Mesh;
use crate::settings::Settings;
use std::rc::Rc;

/// What a program brings to be shown.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// What can be chosen, at least one.
    pub list: Vec<Subject>,
    /// Environment of the scene, if there is one.
    pub environment: Option<Rc<Resources>>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// Uploads what is shown; called again for each new device.
pub type Load = Box<dyn FnMut(&Gpu) -> Result<Loaded, GpuError>>;

/// Frames of a mean, at most.
const MAX_FRAMES: u32 = 4096;
/// Frames after which an earlier loss of the device is forgotten.
const FORGIVE_AFTER: u32 = 600;
/// Losses that end the program.
const MAX_LOSSES: u32 = 3;
/// Format of the picture: bytes as a display takes them.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Counts losses of the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Recovery {
    losses: u32,
    good_frames: u32,
}

impl Recovery {
    /// A frame has been drawn.
    pub fn frame(&mut self) {
        self.good_frames += 1;
        if self.good_frames >= FORGIVE_AFTER {
            *self = Recovery::default();
        }
    }

    /// Whether to go on with a new device after this error, or the error to end with.
    pub fn lost(&mut self, gpu: &Gpu, error: GpuError) -> Result<(), GpuError> {
        let Some(reason) = gpu.lost() else { return Err(error) };
        self.good_frames = 0;
        self.losses += 1;
        if self.losses >= MAX_LOSSES {
            let adapter = &gpu.info.name;
            return Err(GpuError::Failed(format!("{adapter} was lost {MAX_LOSSES} times, the last time: {reason}")));
        }
        Ok(())
    }
}

/// Device, data and picture.
#[derive(Debug)]
pub(super) struct Stage {
    pub gpu: Gpu,
    pub list: Vec<Subject>,
    pub notes: Vec<String>,
    pub renderer: Renderer,
    target: Option<(wgpu::Texture, wgpu::TextureView)>,
    drawn: Option<Settings>,
}

impl Stage {
    /// Brings data and mesh to a device.
    pub fn new(gpu: Gpu, load: &mut Load, mesh: &Mesh) -> Result<Stage, GpuError> {
        let loaded = load(&gpu)?;
        if loaded.list.is_empty() {
            return Err(GpuError::BadPack("there is nothing to show".to_owned()));
        }
        let mut renderer = Renderer::new(&gpu, mesh)?;
        if let Some(environment) = loaded.environment {
            renderer.set_environment(environment);
        }
        Ok(Stage { gpu, list: loaded.list, notes: loaded.notes, renderer, target: None, drawn: None })
    }

    /// Draws another mesh from now on.
    pub fn set_mesh(&mut self, mesh: &Mesh) {
        self.renderer.set_mesh(&self.gpu, mesh);
        self.drawn = None;
    }

    /// Whether another frame makes another picture: something was changed, or a mean still converges.
    pub fn wants_frame(&self, settings: &Settings, size: [u32; 2]) -> bool {
        let same = self.drawn.as_ref() == Some(settings) && self.size() == Some(size);
        !same || settings.view(&self.list, size).converges() && self.renderer.frames() < MAX_FRAMES
    }

    fn size(&self) -> Option<[u32; 2]> {
        self.target.as_ref().map(|(texture, _)| [texture.width(), texture.height()])
    }

    /// Draws one more frame of the picture; whether it is another texture than before.
    pub fn draw(&mut self, settings: &Settings, size: [u32; 2]) -> Result<bool, GpuError> {
        let renewed = self.size() != Some(size);
        if renewed {
            let texture = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("picture"),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            let view = texture.create_view(&Default::default());
            self.target = Some((texture, view));
        }
        if self.drawn.as_ref() != Some(settings) {
            self.renderer.restart();
            self.drawn = Some(settings.clone());
        }
        if let Some((_, target)) = &self.target {
            self.renderer.frame(&self.gpu, &settings.view(&self.list, size), target, FORMAT)?;
        }
        Ok(renewed)
    }

    /// The picture, for the panel's background.
    pub fn target(&self) -> Option<&wgpu::TextureView> {
        self.target.as_ref().map(|(_, view)| view)
    }

    /// The picture as it is, for a screenshot; none before the first frame.
    pub fn picture(&self) -> Result<Option<Picture>, GpuError> {
        self.target.as_ref().map(|(texture, _)| read_picture(&self.gpu, texture)).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{AdapterChoice, ResourceSet};
    use crate::render::{Material, Method};
    use crate::scene::Orbit;

    /// The smooth BRDF on a sphere; none without an adapter.
    fn stage() -> Option<(Stage, Settings)> {
        let gpu = match Gpu::headless(&AdapterChoice::default()) {
            Ok(gpu) => gpu,
            Err(error) if std::env::var_os("GLINT_REQUIRE_ADAPTER").is_none() => {
                eprintln!("skipped: {error}");
                return None;
            }
            Err(error) => panic!("{error}"),
        };
        let mesh = Mesh::sphere(16);
        let stage = Stage::new(gpu, &mut smooth(), &mesh).unwrap();
        let settings = Settings::new(&stage.list, Orbit::fit(mesh.bounds()));
        Some((stage, settings))
    }

    fn smooth() -> Load {
        Box::new(|gpu| {
            let data = Rc::new(ResourceSet::default().finish(gpu));
            let shown = Subject {
                name: String::new(),
                method: Method::Smooth,
                data,
                parts: Vec::new(),
                material: Material::default(),
                files: Vec::new(),
                constants: Vec::new(),
                rim_roughness: 0.0,
            };
            Ok(Loaded { list: vec![shown], environment: None, notes: Vec::new() })
        })
    }

    #[test]
    fn a_lost_device_is_replaced_twice_and_then_given_up() {
        let Some((mut stage, settings)) = stage() else { return };
        let mut recovery = Recovery::default();
        stage.draw(&settings, [64, 48]).unwrap();
        let before = stage.picture().unwrap();
        for loss in 1..=MAX_LOSSES {
            stage.gpu.device.destroy();
            // The loss is told by the next frame, or by the one after it.
            let error = (0..2).find_map(|_| stage.draw(&settings, [64, 48]).err()).unwrap();
            let verdict = recovery.lost(&stage.gpu, error);
            if loss == MAX_LOSSES {
                let message = verdict.unwrap_err().to_string();
                assert!(message.contains("lost 3 times") && message.contains(&stage.gpu.info.name), "{message}");
                return;
            }
            verdict.unwrap();
            stage = Stage::new(Gpu::headless(&AdapterChoice::default()).unwrap(), &mut smooth(), &Mesh::sphere(16))
                .unwrap();
            stage.draw(&settings, [64, 48]).unwrap();
            recovery.frame();
            assert_eq!(stage.picture().unwrap(), before, "the picture is the same again");
        }
    }

    #[test]
    fn losses_that_are_far_apart_are_forgotten_and_other_errors_are_not_losses() {
        let Some((stage, _)) = stage() else { return };
        let mut recovery = Recovery::default();
        let wrong = GpuError::Failed("a program".to_owned());
        assert_eq!(recovery.lost(&stage.gpu, wrong.clone()), Err(wrong.clone()));
        stage.gpu.device.destroy();
        stage.gpu.wait().unwrap_err();
        for _ in 0..2 * MAX_LOSSES {
            assert_eq!(recovery.lost(&stage.gpu, wrong.clone()), Ok(()));
            (0..FORGIVE_AFTER).for_each(|_| recovery.frame());
        }
    }

    #[test]
    fn frames_are_drawn_only_for_something() {
        let Some((mut stage, mut settings)) = stage() else { return };
        assert!(stage.wants_frame(&settings, [64, 48]));
        assert!(stage.draw(&settings, [64, 48]).unwrap());
        assert!(!stage.wants_frame(&settings, [64, 48]), "nothing has changed");
        assert!(stage.wants_frame(&settings, [1, 1]), "the size has changed");
        assert!(stage.draw(&settings, [1, 1]).unwrap());
        settings.exposure_stops = 1.0;
        assert!(stage.wants_frame(&settings, [1, 1]));
        assert!(!stage.draw(&settings, [1, 1]).unwrap());
        assert!(!stage.wants_frame(&settings, [1, 1]));
        settings.antialias = true;
        for frame in 1..4 {
            stage.draw(&settings, [1, 1]).unwrap();
            assert_eq!(stage.renderer.frames(), frame);
            assert!(stage.wants_frame(&settings, [1, 1]), "the mean converges");
        }
        settings.camera.distance *= 1.5;
        stage.draw(&settings, [1, 1]).unwrap();
        assert_eq!(stage.renderer.frames(), 1, "a new view begins anew");
    }
}
