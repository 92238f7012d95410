//! Pipelines that draw a mesh by a method, made when they are first needed.

use super::present::Overlay;
use super::subject::Method;
use super::targets::{DEPTH, RADIANCE};
use crate::gpu::{Gpu, GpuError, ResourceSet, Resources};
use crate::scene::Vertex;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::mem::offset_of;

/// What a pipeline is specialised for.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Key {
    pub method: Method,
    pub lights: u32,
    pub reference: bool,
    pub overlay: u32,
    pub files: Vec<&'static str>,
    /// Constants of the method, as bits of their values.
    pub constants: Vec<(&'static str, u64)>,
}

/// Pipelines by what they are specialised for, and the shader modules of the methods, as they are or counting operations.
#[derive(Debug, Default)]
pub(super) struct Pipelines {
    modules: HashMap<(Method, Vec<&'static str>, bool), wgpu::ShaderModule>,
    pipelines: HashMap<Key, wgpu::RenderPipeline>,
    backgrounds: HashMap<u32, wgpu::RenderPipeline>,
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
            let counts = key.overlay == Overlay::Operations.number();
            let program = (key.method, key.files.clone(), counts);
            if !self.modules.contains_key(&program) {
                let name = key.method.name();
                let source = glint_shaders::program(name, &key.files);
                let module = if counts { gpu.counting_shader(name, &source)? } else { gpu.shader(name, &source)? };
                self.modules.insert(program.clone(), module);
            }
            let groups = [scene, &data.layout, &environment.layout];
            let pipeline = make(gpu, &key, &self.modules[&program], groups)?;
            self.pipelines.insert(key.clone(), pipeline);
        }
        Ok(&self.pipelines[&key])
    }

    /// The pipeline that fills what no mesh covers.
    pub fn background(
        &mut self,
        gpu: &Gpu,
        lights: u32,
        scene: &wgpu::BindGroupLayout,
        environment: &Resources,
    ) -> Result<&wgpu::RenderPipeline, GpuError> {
        match self.backgrounds.entry(lights) {
            Entry::Occupied(made) => Ok(made.into_mut()),
            Entry::Vacant(place) => {
                let module = gpu.shader("background", &glint_shaders::program("background", &[]))?;
                let nothing = ResourceSet::default().finish(gpu);
                let groups = [scene, &nothing.layout, &environment.layout];
                let drawing = Drawing { label: "background", module: &module, groups, buffers: &[], covers: false };
                Ok(place.insert(drawing.pipeline(gpu, &[("LIGHTS", f64::from(lights))])?))
            }
        }
    }
}

/// What pipelines that draw radiance with depth differ in.
struct Drawing<'a> {
    label: &'static str,
    module: &'a wgpu::ShaderModule,
    groups: [&'a wgpu::BindGroupLayout; 3],
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// Whether it writes depth; else it fills what is left.
    covers: bool,
}

fn make(
    gpu: &Gpu,
    key: &Key,
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
    let buffers = [Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    })];
    let mut constants = vec![
        ("LIGHTS", f64::from(key.lights)),
        ("REFERENCE", f64::from(u8::from(key.reference))),
        ("OVERLAY", f64::from(key.overlay)),
    ];
    constants.extend(key.constants.iter().map(|&(name, bits)| (name, f64::from_bits(bits))));
    Drawing { label: key.method.name(), module, groups, buffers: &buffers, covers: true }.pipeline(gpu, &constants)
}

impl Drawing<'_> {
    fn pipeline(&self, gpu: &Gpu, constants: &[(&str, f64)]) -> Result<wgpu::RenderPipeline, GpuError> {
        let options = wgpu::PipelineCompilationOptions { constants, ..Default::default() };
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &self.groups.map(Some),
            immediate_size: 0,
        });
        gpu.checked(self.label, || {
            gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(self.label),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: self.module,
                    entry_point: Some("vertex"),
                    compilation_options: options.clone(),
                    buffers: self.buffers,
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(self.covers),
                    // Depth is reversed: 1 is near, 0 infinitely far.
                    depth_compare: Some(if self.covers {
                        wgpu::CompareFunction::Greater
                    } else {
                        wgpu::CompareFunction::Equal
                    }),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: self.module,
                    entry_point: Some("fragment"),
                    compilation_options: options.clone(),
                    targets: &[Some(RADIANCE.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        })
    }
}
