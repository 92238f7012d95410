//! What a program binds: resources in the order of their binding numbers, with the layout that follows from them.

use super::device::Gpu;
use glint_formats::FourCc;
use wgpu::util::{DeviceExt, TextureDataOrder};

/// A texture as it is made from bytes.
#[derive(Clone, Copy, Debug)]
pub struct GpuTexture {
    /// Format.
    pub format: wgpu::TextureFormat,
    /// Width and height of the first mip.
    pub size: [u32; 2],
    /// Layers, faces of cubes counted.
    pub layers: u32,
    /// Mips.
    pub mips: u32,
    /// How shaders see it.
    pub dimension: wgpu::TextureViewDimension,
}

/// Resources of one bind group while they are collected.
#[derive(Debug, Default)]
pub struct ResourceSet {
    entries: Vec<wgpu::BindGroupLayoutEntry>,
    resources: Vec<Resource>,
    bytes: u64,
    /// The section that the next resource holds.
    next: Option<FourCc>,
    sections: Vec<(FourCc, BoundSection)>,
}

/// A section on the GPU.
#[derive(Clone, Debug)]
pub enum BoundSection {
    /// In a buffer.
    Buffer(wgpu::Buffer),
    /// In a texture.
    Texture(wgpu::Texture),
}

#[derive(Debug)]
enum Resource {
    Buffer(wgpu::Buffer),
    Texture(wgpu::TextureView),
    Sampler(wgpu::Sampler),
}

/// A bind group and its layout.
#[derive(Debug)]
pub struct Resources {
    /// Layout.
    pub layout: wgpu::BindGroupLayout,
    /// The group.
    pub group: wgpu::BindGroup,
    /// Bytes of what is shown among them: the sections of a pack, or the images that no other group had before.
    pub bytes: u64,
    /// The sections of a pack among them, in the order of bindings.
    pub sections: Vec<(FourCc, BoundSection)>,
}

const STAGES: wgpu::ShaderStages = wgpu::ShaderStages::FRAGMENT.union(wgpu::ShaderStages::COMPUTE);

impl ResourceSet {
    fn push(&mut self, ty: wgpu::BindingType, resource: Resource) {
        let binding = self.entries.len() as u32;
        self.entries.push(wgpu::BindGroupLayoutEntry { binding, visibility: STAGES, ty, count: None });
        self.resources.push(resource);
    }

    /// Notes the resource of `bytes` bytes if it holds a section.
    fn bound(&mut self, resource: BoundSection, bytes: usize) {
        if let Some(kind) = self.next.take() {
            self.bytes += bytes as u64;
            self.sections.push((kind, resource));
        }
    }

    fn buffer(&mut self, gpu: &Gpu, ty: wgpu::BufferBindingType, usage: wgpu::BufferUsages, contents: &[u8]) {
        // Bindings have a multiple of four bytes, and at least one vector of a storage array.
        let mut padded = contents.to_vec();
        padded.resize(contents.len().next_multiple_of(16).max(16), 0);
        let buffer = gpu.buffer(usage | wgpu::BufferUsages::COPY_SRC, &padded);
        self.bound(BoundSection::Buffer(buffer.clone()), padded.len());
        self.push(
            wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            Resource::Buffer(buffer),
        );
    }

    /// Adds a uniform buffer with these bytes.
    pub fn uniform(&mut self, gpu: &Gpu, contents: &[u8]) -> &mut Self {
        self.buffer(gpu, wgpu::BufferBindingType::Uniform, wgpu::BufferUsages::UNIFORM, contents);
        self
    }

    /// Adds a read-only storage buffer with these bytes.
    pub fn storage(&mut self, gpu: &Gpu, contents: &[u8]) -> &mut Self {
        let ty = wgpu::BufferBindingType::Storage { read_only: true };
        self.buffer(gpu, ty, wgpu::BufferUsages::STORAGE, contents);
        self
    }

    /// Adds a texture whose bytes are in the order of the pack, mip by mip, all layers of each. `filterable` says whether
    /// shaders sample it; loads need no filtering.
    pub fn texture(&mut self, gpu: &Gpu, shape: GpuTexture, filterable: bool, contents: &[u8]) -> &mut Self {
        self.texture_of(gpu, shape, wgpu::TextureSampleType::Float { filterable }, contents)
    }

    /// Says that the next resource holds this section as it is.
    pub(super) fn section(&mut self, kind: FourCc) -> &mut Self {
        self.next = Some(kind);
        self
    }

    pub(super) fn texture_of(
        &mut self,
        gpu: &Gpu,
        shape: GpuTexture,
        sample_type: wgpu::TextureSampleType,
        contents: &[u8],
    ) -> &mut Self {
        let descriptor = wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: shape.size[0], height: shape.size[1], depth_or_array_layers: shape.layers },
            mip_level_count: shape.mips,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: shape.format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        };
        let texture =
            gpu.device.create_texture_with_data(&gpu.queue, &descriptor, TextureDataOrder::MipMajor, contents);
        self.bound(BoundSection::Texture(texture.clone()), contents.len());
        let view = texture
            .create_view(&wgpu::TextureViewDescriptor { dimension: Some(shape.dimension), ..Default::default() });
        self.push(
            wgpu::BindingType::Texture { sample_type, view_dimension: shape.dimension, multisampled: false },
            Resource::Texture(view),
        );
        self
    }

    /// Adds all of a texture that other groups may have too, to be sampled.
    pub fn sampled(&mut self, texture: &wgpu::Texture) -> &mut Self {
        self.push(
            wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: true },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            Resource::Texture(texture.create_view(&wgpu::TextureViewDescriptor::default())),
        );
        self
    }

    /// Counts bytes of what is shown that are no section.
    pub fn add_bytes(&mut self, bytes: usize) -> &mut Self {
        self.bytes += bytes as u64;
        self
    }

    /// Adds a sampler that filters between texels and mips; it repeats or clamps.
    pub fn sampler(&mut self, gpu: &Gpu, address: wgpu::AddressMode) -> &mut Self {
        self.sampler_of(gpu, [address; 2])
    }

    /// The same with what lies beyond the edges along u and v.
    pub fn sampler_of(&mut self, gpu: &Gpu, [u, v]: [wgpu::AddressMode; 2]) -> &mut Self {
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: u,
            address_mode_v: v,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        self.push(wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering), Resource::Sampler(sampler));
        self
    }

    /// The bind group.
    pub fn finish(self, gpu: &Gpu) -> Resources {
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &self.entries });
        let entries: Vec<wgpu::BindGroupEntry<'_>> = self
            .resources
            .iter()
            .enumerate()
            .map(|(binding, resource)| wgpu::BindGroupEntry {
                binding: binding as u32,
                resource: match resource {
                    Resource::Buffer(buffer) => buffer.as_entire_binding(),
                    Resource::Texture(view) => wgpu::BindingResource::TextureView(view),
                    Resource::Sampler(sampler) => wgpu::BindingResource::Sampler(sampler),
                },
            })
            .collect();
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &entries,
        });
        Resources { layout, group, bytes: self.bytes, sections: self.sections }
    }
}
