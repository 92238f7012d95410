//! Pipelines that draw a mesh by a method, made when they are first needed.

use super::shown::Method;
use super::targets::{DEPTH, RADIANCE};
use crate::gpu::{Gpu, GpuError, Resources};
use crate::scene::Vertex;
use std::collections::HashMap;
use std::mem::offset_of;

/// What a pipeline is specialised for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Key {
    pub method: Method,
    pub lights: u32,
    pub reference: bool,
    pub overlay: u32,
}

/// Pipelines by what they are specialised for, and the shader modules of the methods.
#[derive(Debug, Default)]
pub(super) struct Pipelines {
    modules: HashMap<Method, wgpu::ShaderModule>,
    pipelines: HashMap<Key, wgpu::RenderPipeline>,
}

impl Pipelines {
    /// The pipeline of `key`, with the layouts of groups 0, 1 and 2.
    pub fn get(
        &mut self,
        gpu: &Gpu,
        key: Key,
        scene: &wgpu::BindGroupLayout,
        data: &Resources,
        environment: &Resources,
    ) -> Result<&wgpu::RenderPipeline, GpuError> {
        if !self.pipelines.contains_key(&key) {
            if !self.modules.contains_key(&key.method) {
                let mut files = vec!["view_surface"];
                files.extend(key.method.files());
                let module = gpu.shader(key.method.name(), &glint_shaders::compose(&files))?;
                self.modules.insert(key.method, module);
            }
            let pipeline = make(gpu, key, &self.modules[&key.method], [scene, &data.layout, &environment.layout])?;
            self.pipelines.insert(key, pipeline);
        }
        Ok(&self.pipelines[&key])
    }
}

fn make(
    gpu: &Gpu,
    key: Key,
    module: &wgpu::ShaderModule,
    groups: [&wgpu::BindGroupLayout; 3],
) -> Result<wgpu::RenderPipeline, GpuError> {
    let attribute = |shader_location, format, offset: usize| wgpu::VertexAttribute {
        format,
        offset: offset as u64,
        shader_location,
    };
    let attributes = [
        attribute(0, wgpu::VertexFormat::Float32x3, offset_of!(Vertex, position)),
        attribute(1, wgpu::VertexFormat::Float32x3, offset_of!(Vertex, normal)),
        attribute(2, wgpu::VertexFormat::Float32x4, offset_of!(Vertex, tangent)),
        attribute(3, wgpu::VertexFormat::Float32x2, offset_of!(Vertex, uv)),
    ];
    let constants = [
        ("LIGHTS", f64::from(key.lights)),
        ("REFERENCE", f64::from(u8::from(key.reference))),
        ("OVERLAY", f64::from(key.overlay)),
    ];
    let options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &groups.map(Some),
        immediate_size: 0,
    });
    gpu.checked(key.method.name(), || {
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(key.method.name()),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("vertex"),
                compilation_options: options.clone(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<Vertex>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &attributes,
                })],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                // Depth is reversed: 1 is near.
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some("fragment"),
                compilation_options: options.clone(),
                targets: &[Some(RADIANCE.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    })
}
