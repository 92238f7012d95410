//! What the window is drawn to.

use crate::gpu::{Gpu, GpuError, Wish};
use std::sync::Arc;
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

/// A surface of the window, configured for a device.
pub(super) struct Surface {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// Whether the configuration must be renewed before the next frame.
    stale: bool,
}

/// What became of the wish for a texture to draw to.
pub(super) enum Acquired {
    /// Draw to this.
    Texture(wgpu::SurfaceTexture),
    /// Nothing can be seen; draw when the window says so, or a moment later.
    Later,
    /// The surface was renewed; try again.
    Again,
}

impl Surface {
    /// A device that can draw to the window, and the window's surface on it.
    pub fn new(window: &Arc<Window>, display: OwnedDisplayHandle, wish: &Wish) -> Result<(Gpu, Surface), GpuError> {
        let instance =
            wgpu::Instance::new(wgpu::InstanceDescriptor::new_with_display_handle_from_env(Box::new(display)));
        let surface = create(&instance, window)?;
        let gpu = Gpu::new(instance, Some(&surface), wish)?;
        let size = window.inner_size();
        let capabilities = surface.get_capabilities(&gpu.adapter);
        let mut config = surface
            .get_default_config(&gpu.adapter, size.width.max(1), size.height.max(1))
            .ok_or_else(|| GpuError::Failed(format!("{} can't draw to the window", gpu.info.name)))?;
        // Pictures hold bytes as displays take them: no conversion on the way.
        config.format = config.format.remove_srgb_suffix();
        if !capabilities.formats.contains(&config.format) {
            let plain = capabilities.formats.iter().copied().find(|format| !format.is_srgb());
            config.format = plain.ok_or_else(|| GpuError::Failed("the window has sRGB formats only".to_owned()))?;
        }
        config.present_mode = wgpu::PresentMode::AutoVsync;
        let mut made = Surface { surface, config, stale: true };
        made.resize(&gpu, size.into());
        Ok((gpu, made))
    }

    /// Format of the textures.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// The window has this many pixels now; nothing happens while it has none.
    pub fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) {
        if size[0] == 0 || size[1] == 0 {
            return;
        }
        let most = gpu.device.limits().max_texture_dimension_2d;
        let [width, height] = size.map(|pixels| pixels.min(most));
        self.stale |= [width, height] != self.size();
        (self.config.width, self.config.height) = (width, height);
    }

    /// A texture to draw to.
    pub fn acquire(&mut self, gpu: &Gpu, window: &Arc<Window>) -> Result<Acquired, GpuError> {
        if self.stale {
            gpu.checked("window", || self.surface.configure(&gpu.device, &self.config))?;
            self.stale = false;
        }
        let texture = self.surface.get_current_texture();
        if !matches!(texture, wgpu::CurrentSurfaceTexture::Success(_)) {
            // The loss of a device is told while it is polled, and a lost one has no textures.
            gpu.device.poll(wgpu::PollType::Poll).ok();
            if let Some(error) = gpu.lost() {
                return Err(error);
            }
        }
        Ok(match texture {
            wgpu::CurrentSurfaceTexture::Success(texture) => Acquired::Texture(texture),
            wgpu::CurrentSurfaceTexture::Suboptimal(texture) => {
                self.stale = true;
                Acquired::Texture(texture)
            }
            wgpu::CurrentSurfaceTexture::Timeout | wgpu::CurrentSurfaceTexture::Occluded => Acquired::Later,
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Validation => {
                self.resize(gpu, window.inner_size().into());
                self.stale = true;
                Acquired::Again
            }
            wgpu::CurrentSurfaceTexture::Lost => {
                self.surface = create(&gpu.instance, window)?;
                self.stale = true;
                Acquired::Again
            }
        })
    }
}

fn create(instance: &wgpu::Instance, window: &Arc<Window>) -> Result<wgpu::Surface<'static>, GpuError> {
    instance
        .create_surface(Arc::clone(window))
        .map_err(|error| GpuError::Failed(format!("there is no surface for the window: {error}")))
}
