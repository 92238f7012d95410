//! Draws a scene: one or two sides, their means over frames, and what the display gets of them.

use super::accumulate::Accumulate;
use super::pipelines::{Key, Pipelines};
use super::present::{Display, Present, PresentUniform, Show};
use super::subject::Subject;
use super::targets::{Targets, view};
use super::timing::Timing;
use super::uniforms::{Material, Scene, SceneUniform};
use crate::gpu::{Gpu, GpuError, ResourceSet, Resources, read_back};
use crate::methods::environment;
use crate::scene::Mesh;
use glam::Vec2;
use std::ops::Range;
use std::rc::Rc;

/// One of the pictures that are compared.
#[derive(Clone, Debug)]
pub struct Side {
    /// Method and material.
    pub shown: Subject,
    /// Whether the method's reference is drawn in its place, one sample a frame.
    pub reference: bool,
}

/// What is compared with what.
#[derive(Clone, Debug)]
pub enum Compare {
    /// One side alone.
    Single(Side),
    /// Left and right of a line at this share of the width.
    Split(Side, Side, f32),
    /// Relative difference of the first from the second, in false colours: 0 blue to 1 red.
    Error(Side, Side),
}

impl Compare {
    fn sides(&self) -> Vec<&Side> {
        match self {
            Compare::Single(side) => vec![side],
            Compare::Split(left, right, _) | Compare::Error(left, right) => vec![left, right],
        }
    }

    /// Whether a reference is part of it.
    pub fn has_reference(&self) -> bool {
        self.sides().iter().any(|side| side.reference)
    }
}

/// All that a frame depends on.
#[derive(Clone, Debug)]
pub struct View {
    /// Pixels.
    pub size: [u32; 2],
    /// Scene.
    pub scene: Scene,
    /// What is shown.
    pub compare: Compare,
    /// How it is displayed.
    pub display: Display,
    /// Whether frames are averaged, and move by parts of a pixel to smooth edges.
    pub antialias: bool,
    /// Whether each frame has another seed, so that the mean over frames is that over surfaces.
    pub vary_seed: bool,
}

impl View {
    /// Whether more frames make a better picture.
    pub fn converges(&self) -> bool {
        self.antialias || self.vary_seed || self.compare.has_reference()
    }
}

#[derive(Debug)]
struct MeshBuffers {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
    parts: Vec<Range<u32>>,
}

/// Draws views.
#[derive(Debug)]
pub struct Renderer {
    mesh: MeshBuffers,
    environment: Rc<Resources>,
    nothing: Resources,
    scene_layout: wgpu::BindGroupLayout,
    pipelines: Pipelines,
    accumulate: Accumulate,
    present: Option<Present>,
    targets: Option<Targets>,
    timing: Timing,
    frames: u32,
    passes: Vec<&'static str>,
}

/// Radical inverse of `index` in a base: a low-discrepancy sequence in (0, 1).
fn radical_inverse(mut index: u32, base: u32) -> f32 {
    let (mut value, mut digit) = (0.0, 1.0 / base as f32);
    while index > 0 {
        value += (index % base) as f32 * digit;
        index /= base;
        digit /= base as f32;
    }
    value
}

impl Renderer {
    /// A renderer of a mesh without an environment.
    pub fn new(gpu: &Gpu, mesh: &Mesh) -> Result<Renderer, GpuError> {
        let uniform = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let scene_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("scene"),
            entries: &[uniform(0), uniform(1)],
        });
        Ok(Renderer {
            mesh: mesh_buffers(gpu, mesh),
            environment: Rc::new(environment::empty(gpu)?),
            nothing: ResourceSet::default().finish(gpu),
            scene_layout,
            pipelines: Pipelines::default(),
            accumulate: Accumulate::new(gpu)?,
            present: None,
            targets: None,
            timing: Timing::new(gpu),
            frames: 0,
            passes: Vec::new(),
        })
    }

    /// Draws another mesh from now on.
    pub fn set_mesh(&mut self, gpu: &Gpu, mesh: &Mesh) {
        self.mesh = mesh_buffers(gpu, mesh);
        self.restart();
    }

    /// Lights with another environment from now on.
    pub fn set_environment(&mut self, environment: Rc<Resources>) {
        self.environment = environment;
        self.restart();
    }

    /// Begins the mean of frames anew; to be called when a view changes.
    pub fn restart(&mut self) {
        self.frames = 0;
    }

    /// Frames in the mean so far.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Draws one more frame of a view and shows it on `target`, a texture of `format` without transfer function.
    pub fn frame(
        &mut self,
        gpu: &Gpu,
        view_of: &View,
        target: &wgpu::TextureView,
        format: wgpu::TextureFormat,
    ) -> Result<(), GpuError> {
        if self.targets.as_ref().is_none_or(|targets| targets.size != view_of.size) {
            self.targets = Some(Targets::new(gpu, view_of.size));
            self.restart();
        }
        if self.present.as_ref().is_none_or(|present| present.format != format) {
            self.present = Some(Present::new(gpu, format)?);
        }
        self.frames = if view_of.converges() { self.frames + 1 } else { 1 };
        self.timing.restart();
        self.passes.clear();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let sides = view_of.compare.sides();
        for (index, side) in sides.iter().enumerate() {
            self.draw_side(gpu, &mut encoder, view_of, index, side)?;
        }
        self.show(gpu, &mut encoder, view_of, sides.len(), target);
        self.timing.resolve(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        gpu.lost().map_or(Ok(()), Err)
    }

    fn draw_side(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view_of: &View,
        index: usize,
        side: &Side,
    ) -> Result<(), GpuError> {
        let Some(targets) = &self.targets else { return Ok(()) };
        let jitter = if view_of.antialias {
            Vec2::new(radical_inverse(self.frames, 2), radical_inverse(self.frames, 3)) - 0.5
        } else {
            Vec2::ZERO
        };
        let scene = SceneUniform::new(&view_of.scene, view_of.size, self.frames, jitter);
        let mut material = side.shown.material;
        if view_of.vary_seed {
            material.seed = material.seed.wrapping_add(self.frames);
        }
        let group = scene_group(gpu, &self.scene_layout, &scene, &material);
        let constants = side.shown.pipeline_constants(&material, &view_of.scene.lights).into_iter();
        let key = Key {
            method: side.shown.method,
            lights: view_of.scene.lights.bits(),
            reference: side.reference,
            overlay: view_of.display.overlay.number(),
            files: side.shown.files.clone(),
            constants: constants.map(|(name, value)| (name, value.to_bits())).collect(),
        };
        let data = &side.shown.data;
        let lights = key.lights;
        let pipeline = self.pipelines.get(gpu, key, &self.scene_layout, data, &self.environment)?.clone();
        let background = self.pipelines.background(gpu, lights, &self.scene_layout, &self.environment)?;
        self.passes.push(if index == 0 { "surface" } else { "surface, right" });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("surface"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view(&targets.sides[index].frame),
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            timestamp_writes: self.timing.next(),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.set_bind_group(1, &data.group, &[]);
        pass.set_bind_group(2, &self.environment.group, &[]);
        pass.set_vertex_buffer(0, self.mesh.vertices.slice(..));
        pass.set_index_buffer(self.mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
        if side.shown.parts.is_empty() {
            pass.draw_indexed(0..self.mesh.count, 0, 0..1);
        } else {
            // A mesh that has more parts is another one than the data were made for.
            for (index, part) in self.mesh.parts.iter().enumerate() {
                pass.set_bind_group(1, &side.shown.parts.get(index).unwrap_or(data).group, &[]);
                pass.draw_indexed(part.clone(), 0, 0..1);
            }
        }
        pass.set_pipeline(background);
        pass.set_bind_group(1, &self.nothing.group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        if view_of.converges() {
            self.passes.push("mean");
            let timestamps = self.timing.next();
            self.accumulate.add(gpu, encoder, &targets.sides[index], self.frames, timestamps);
        }
        Ok(())
    }

    /// The texture that holds what a side shows.
    fn shown(&self, targets: &Targets, index: usize, converges: bool) -> wgpu::Texture {
        let side = &targets.sides[index];
        if converges { side.means[(self.frames % 2) as usize].clone() } else { side.frame.clone() }
    }

    fn show(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view_of: &View,
        sides: usize,
        target: &wgpu::TextureView,
    ) {
        let (Some(targets), Some(present)) = (&self.targets, &self.present) else { return };
        let shown = |index: usize| view(&self.shown(targets, index.min(sides - 1), view_of.converges()));
        let show = match &view_of.compare {
            Compare::Single(_) => Show::Left,
            Compare::Split(_, _, at) => Show::Split(at * view_of.size[0] as f32),
            Compare::Error(..) => Show::Error,
        };
        let sources = [shown(0), shown(1)];
        self.passes.push("display");
        let timestamps = self.timing.next();
        let values = PresentUniform::new(show, &view_of.display);
        present.draw(gpu, encoder, &values, [&sources[0], &sources[1]], target, timestamps);
    }

    /// Seconds of each pass of the last frame, where the device has timestamps; waits for it.
    pub fn pass_seconds(&self, gpu: &Gpu) -> Result<Option<Vec<(&'static str, f64)>>, GpuError> {
        let seconds = self.timing.seconds(gpu)?;
        Ok(seconds.map(|seconds| self.passes.iter().copied().zip(seconds).collect()))
    }

    /// Radiance and overlay of each pixel of a side (0 or 1) of the last view, row by row; waits for the device.
    pub fn radiance(&self, gpu: &Gpu, view_of: &View, index: usize) -> Result<Vec<[f32; 4]>, GpuError> {
        let Some(targets) = &self.targets else { return Ok(Vec::new()) };
        let texture = self.shown(targets, index, view_of.converges());
        let bytes = texture_bytes(gpu, &texture, 16)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }
}

/// The bytes of a texture of `texel_bytes` a texel, row by row without padding; waits for the device.
pub(super) fn texture_bytes(gpu: &Gpu, texture: &wgpu::Texture, texel_bytes: u32) -> Result<Vec<u8>, GpuError> {
    let [width, height] = [texture.width(), texture.height()];
    let row = width * texel_bytes;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(padded) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None },
        },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    let bytes: Vec<u8> = read_back(gpu, &buffer)?;
    Ok(bytes.chunks_exact(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect())
}

fn mesh_buffers(gpu: &Gpu, mesh: &Mesh) -> MeshBuffers {
    let count = mesh.indices.len() as u32;
    let mut parts: Vec<Range<u32>> = mesh.parts.iter().map(|part| part.first..part.first + part.count).collect();
    if parts.is_empty() {
        parts.push(0..count);
    }
    MeshBuffers {
        vertices: gpu.buffer(wgpu::BufferUsages::VERTEX, bytemuck::cast_slice(&mesh.vertices)),
        indices: gpu.buffer(wgpu::BufferUsages::INDEX, bytemuck::cast_slice(&mesh.indices)),
        count,
        parts,
    }
}

fn scene_group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    scene: &SceneUniform,
    material: &Material,
) -> wgpu::BindGroup {
    let uniform = |contents| gpu.buffer(wgpu::BufferUsages::UNIFORM, contents);
    let buffers = [uniform(bytemuck::bytes_of(scene)), uniform(bytemuck::bytes_of(&material.complete()))];
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: buffers[0].as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: buffers[1].as_entire_binding() },
        ],
    })
}
