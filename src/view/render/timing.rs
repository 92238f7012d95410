//! Time of each pass by timestamps of the device, where it has them.

use crate::gpu::{Gpu, GpuError, read_back};

/// Passes of a frame, at most.
const PASSES: u32 = 8;

/// Timestamps at both ends of the passes of one frame.
#[derive(Debug)]
pub(super) struct Timing {
    queries: Option<Queries>,
    used: u32,
}

#[derive(Debug)]
struct Queries {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
}

impl Timing {
    pub fn new(gpu: &Gpu) -> Timing {
        let buffer = |usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: u64::from(PASSES) * 16,
                usage,
                mapped_at_creation: false,
            })
        };
        let queries = gpu.has(wgpu::Features::TIMESTAMP_QUERY).then(|| Queries {
            set: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: None,
                ty: wgpu::QueryType::Timestamp,
                count: 2 * PASSES,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            readable: buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
        });
        Timing { queries, used: 0 }
    }

    /// Begins a frame.
    pub fn restart(&mut self) {
        self.used = 0;
    }

    /// Timestamps of the next pass.
    pub fn next(&mut self) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let queries = self.queries.as_ref().filter(|_| self.used < PASSES)?;
        let first = 2 * self.used;
        self.used += 1;
        Some(wgpu::RenderPassTimestampWrites {
            query_set: &queries.set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    /// Records what brings the timestamps to where they can be read.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(queries) = self.queries.as_ref().filter(|_| self.used > 0) {
            encoder.resolve_query_set(&queries.set, 0..2 * self.used, &queries.resolved, 0);
            encoder.copy_buffer_to_buffer(&queries.resolved, 0, &queries.readable, 0, u64::from(self.used) * 16);
        }
    }

    /// Seconds of each pass of the last frame, in the order of [`Timing::next`]; waits for the device.
    pub fn seconds(&self, gpu: &Gpu) -> Result<Option<Vec<f64>>, GpuError> {
        let Some(queries) = self.queries.as_ref() else { return Ok(None) };
        let stamps: Vec<u64> = read_back(gpu, &queries.readable)?;
        queries.readable.unmap();
        let tick = f64::from(gpu.queue.get_timestamp_period()) * 1e-9;
        let passes = stamps.chunks_exact(2).take(self.used as usize);
        Ok(Some(passes.map(|ends| ends[1].saturating_sub(ends[0]) as f64 * tick).collect()))
    }
}
