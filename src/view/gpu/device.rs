//! The adapter and its device: WebGPU's baseline limits, and the few features that are used where they are there.

use std::borrow::Cow;
use std::sync::{Arc, Mutex};

/// Why there is no device.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// No adapter, or none of the wished name.
    #[error(
        "no GPU adapter {wished}was found{found}; install a Vulkan driver, or Mesa's software one (Debian: apt install mesa-vulkan-drivers libvulkan1)"
    )]
    NoAdapter {
        /// The wished name and a blank, or nothing.
        wished: String,
        /// What there is instead, or nothing.
        found: String,
    },
    /// The adapter has less than WebGPU asks of every adapter.
    #[error("the adapter {adapter} gives no device: {reason}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// The device was lost or has no memory left, or the window takes no pictures.
    #[error(
        "the GPU failed: {0}; close what else uses it, ask for fewer pixels, or take another adapter with --adapter"
    )]
    Failed(String),
    /// The device refused a program or a command of ours.
    #[error("the GPU refused: {0}; please report this with the adapter's name")]
    Refused(String),
    /// A section is not what it should be.
    #[error("{0}")]
    BadPack(String),
    /// The device does not hold what is to be shown.
    #[error("{0}")]
    TooLarge(String),
}

/// Which adapter is wanted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AdapterChoice {
    /// Part of the adapter's name, in any case; any adapter without.
    pub name: Option<String>,
}

/// A device, its queue, and what the adapter is.
#[derive(Debug)]
pub struct Gpu {
    /// Instance, which surfaces are made from.
    pub instance: wgpu::Instance,
    /// Adapter.
    pub adapter: wgpu::Adapter,
    /// Name, kind and driver of the adapter.
    pub info: wgpu::AdapterInfo,
    /// Device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    lost: Arc<Mutex<Option<GpuError>>>,
}

/// Features that are used where an adapter has them; everything works without.
const OPTIONAL: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY;

impl Gpu {
    /// The device of the wished adapter, without a window.
    pub fn headless(choice: &AdapterChoice) -> Result<Gpu, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        Gpu::new(instance, None, choice)
    }

    /// The device of the wished adapter; with a surface, of one that can draw to it.
    pub fn new(
        instance: wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
        choice: &AdapterChoice,
    ) -> Result<Gpu, GpuError> {
        let adapter = pollster::block_on(choose(&instance, surface, choice))?;
        let info = adapter.get_info();
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("glint-view"),
            required_features: adapter.features() & OPTIONAL,
            required_limits: wgpu::Limits::default(),
            ..Default::default()
        }))
        .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;
        Ok(Gpu::of_host(instance, adapter, device, queue))
    }

    /// The device that a host has made itself, whose loss and errors are recorded from here on.
    pub fn of_host(instance: wgpu::Instance, adapter: wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Gpu {
        let info = adapter.get_info();
        let lost = Arc::new(Mutex::new(None));
        let record = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            if let Ok(mut lost) = record.lock() {
                lost.get_or_insert(GpuError::Failed(format!("{reason:?}: {message}")));
            }
        });
        let record = Arc::clone(&lost);
        // Whatever is done with a device that is lost is an error, too; the loss is what is told. Else it is a fault of ours.
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut lost) = record.lock() {
                lost.get_or_insert_with(|| match error {
                    wgpu::Error::OutOfMemory { .. } => GpuError::Failed(error.to_string()),
                    _ => GpuError::Refused(error.to_string()),
                });
            }
        }));
        Gpu { instance, adapter, info, device, queue, lost }
    }

    /// A buffer with these bytes, a multiple of four. On a lost device it is unusable, but no panic.
    pub fn buffer(&self, usage: wgpu::BufferUsages, contents: &[u8]) -> wgpu::Buffer {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: contents.len() as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, contents);
        buffer
    }

    /// Why the device was lost or failed, if it did.
    pub fn lost(&self) -> Option<GpuError> {
        self.lost.lock().ok().and_then(|lost| lost.clone())
    }

    /// Whether the device has a feature.
    pub fn has(&self, feature: wgpu::Features) -> bool {
        self.device.features().contains(feature)
    }

    /// The adapter in one line, for reports.
    pub fn adapter_line(&self) -> String {
        let info = &self.info;
        format!("{} ({:?}, {:?}, {})", info.name, info.device_type, info.backend, info.driver_info)
    }

    /// A shader module, or what its compiler says.
    pub fn shader(&self, label: &str, source: &str) -> Result<wgpu::ShaderModule, GpuError> {
        self.module(label, wgpu::ShaderSource::Wgsl(source.into()))
    }

    /// A shader module that counts the operations it executes.
    ///
    /// # Errors
    /// [`GpuError::Refused`] with what is wrong with the text.
    pub fn counting_shader(&self, label: &str, source: &str) -> Result<wgpu::ShaderModule, GpuError> {
        let module = glint_shaders::operations::counted(source).map_err(GpuError::Refused)?;
        self.module(label, wgpu::ShaderSource::Naga(Cow::Owned(module)))
    }

    fn module(&self, label: &str, source: wgpu::ShaderSource<'_>) -> Result<wgpu::ShaderModule, GpuError> {
        let descriptor = wgpu::ShaderModuleDescriptor { label: Some(label), source };
        self.checked(label, || self.device.create_shader_module(descriptor))
    }

    /// Runs `make` and turns what the device finds wrong with it into an error.
    pub fn checked<T>(&self, label: &str, make: impl FnOnce() -> T) -> Result<T, GpuError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make();
        match pollster::block_on(scope.pop()) {
            None => Ok(made),
            Some(error) => Err(GpuError::Refused(format!("{label}: {error}"))),
        }
    }

    /// Waits for all submitted work.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| GpuError::Failed(error.to_string()))?;
        self.lost().map_or(Ok(()), Err)
    }
}

async fn choose(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
    choice: &AdapterChoice,
) -> Result<wgpu::Adapter, GpuError> {
    let Some(name) = &choice.name else {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        };
        let none = |_| GpuError::NoAdapter { wished: String::new(), found: String::new() };
        return instance.request_adapter(&options).await.map_err(none);
    };
    let mut names = Vec::new();
    for adapter in instance.enumerate_adapters(wgpu::Backends::all()).await {
        let found = adapter.get_info().name;
        let fits = surface.is_none_or(|surface| adapter.is_surface_supported(surface));
        if fits && found.to_lowercase().contains(&name.to_lowercase()) {
            return Ok(adapter);
        }
        names.push(format!("'{found}'"));
    }
    let found = if names.is_empty() { String::new() } else { format!("; there is {}", names.join(", ")) };
    Err(GpuError::NoAdapter { wished: format!("named '{name}' "), found })
}
