//! Answers of a `query_<method>.wgsl` program to a list of queries.

use super::device::{Gpu, GpuError};
use super::resources::Resources;
use bytemuck::Pod;

/// Queries of one dispatch, at most: 64 an invocation group, 65 535 groups.
const MOST: usize = 64 * 65_535;

/// Runs the program `source` (entry point `main`, 64 invocations a group) with queries and answers in group 0 and `data` in
/// groups 1 and on; one answer a query, in order.
pub fn answer<Q: Pod, A: Pod>(
    gpu: &Gpu,
    label: &str,
    source: &str,
    data: &[&Resources],
    queries: &[Q],
) -> Result<Vec<A>, GpuError> {
    answer_by(gpu, label, &gpu.shader(label, source)?, data, queries)
}

/// The same by a shader module that is made already.
pub fn answer_by<Q: Pod, A: Pod>(
    gpu: &Gpu,
    label: &str,
    module: &wgpu::ShaderModule,
    data: &[&Resources],
    queries: &[Q],
) -> Result<Vec<A>, GpuError> {
    assert!(!queries.is_empty() && queries.len() <= MOST, "1 to {MOST} queries");
    let device = &gpu.device;
    let storage = |binding, read_only| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[storage(0, true), storage(1, false)],
    });
    let mut layouts = vec![Some(&layout)];
    layouts.extend(data.iter().map(|resources| Some(&resources.layout)));
    let pipeline = gpu.checked(label, || {
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &layouts,
                immediate_size: 0,
            })),
            module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        })
    })?;

    let input = gpu.buffer(wgpu::BufferUsages::STORAGE, bytemuck::cast_slice(queries));
    let size = (queries.len() * size_of::<A>()) as u64;
    let buffer =
        |usage| device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
    let output = buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let readable = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: output.as_entire_binding() },
        ],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        for (i, resources) in data.iter().enumerate() {
            pass.set_bind_group(i as u32 + 1, &resources.group, &[]);
        }
        pass.dispatch_workgroups(queries.len().div_ceil(64) as u32, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&output, 0, &readable, 0, size);
    gpu.queue.submit([encoder.finish()]);
    read_back(gpu, &readable)
}

/// What a mappable buffer holds once all submitted work is done.
pub fn read_back<A: Pod>(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<A>, GpuError> {
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver is gone only when the wait below has failed, which is reported there.
        sender.send(result).ok();
    });
    gpu.wait()?;
    let mapped = receiver.recv().map_err(|error| error.to_string()).and_then(|r| r.map_err(|error| error.to_string()));
    mapped.map_err(GpuError::Failed)?;
    let failed = |error: wgpu::MapRangeError| GpuError::Failed(error.to_string());
    Ok(bytemuck::pod_collect_to_vec(&buffer.get_mapped_range(..).map_err(failed)?))
}
