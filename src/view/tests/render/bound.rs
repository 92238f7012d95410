//! What is bound on the GPU is what the pack holds, byte for byte, and every section that is no parameter is bound.

use crate::adapter::gpu;
use crate::subjects::{packs, subjects};
use glint_formats::{Limits, Pack, Resource, SectionEntry};
use glint_view::gpu::{BoundSection, Gpu, read_back};
use glint_view::render::Method;
use glint_view::subjects::Subjects;
use std::collections::BTreeSet;

/// Bytes that rows of a texture are a multiple of when they are copied to a buffer.
const ROW: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;

/// The bytes of a section on the GPU, in the order of the pack.
fn bytes_of(gpu: &Gpu, section: &BoundSection) -> Vec<u8> {
    match section {
        BoundSection::Buffer(buffer) => copied(gpu, buffer.size(), |encoder, to| {
            encoder.copy_buffer_to_buffer(buffer, 0, to, 0, buffer.size());
        }),
        BoundSection::Texture(texture) => {
            (0..texture.mip_level_count()).flat_map(|mip| mip_bytes(gpu, texture, mip)).collect()
        }
    }
}

/// The bytes of all layers of a mip, rows tightly packed.
fn mip_bytes(gpu: &Gpu, texture: &wgpu::Texture, mip: u32) -> Vec<u8> {
    let size = texture.size();
    let (width, height) = ((size.width >> mip).max(1), (size.height >> mip).max(1));
    let row = width * texture.format().block_copy_size(None).unwrap();
    let padded = row.next_multiple_of(ROW);
    let layers = size.depth_or_array_layers;
    let bytes = copied(gpu, u64::from(padded * height * layers), |encoder, to| {
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo { mip_level: mip, ..texture.as_image_copy() },
            wgpu::TexelCopyBufferInfo {
                buffer: to,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded),
                    rows_per_image: Some(height),
                },
            },
            wgpu::Extent3d { width, height, depth_or_array_layers: layers },
        );
    });
    bytes.chunks_exact(padded as usize).flat_map(|padded| &padded[..row as usize]).copied().collect()
}

/// `size` bytes that `copy` puts into a buffer.
fn copied(gpu: &Gpu, size: u64, copy: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer)) -> Vec<u8> {
    let readable = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    copy(&mut encoder, &readable);
    gpu.queue.submit([encoder.finish()]);
    read_back(gpu, &readable).unwrap()
}

/// Sections that a GPU holds.
fn gpu_sections(pack: &Pack) -> impl Iterator<Item = &SectionEntry> {
    pack.sections().iter().filter(|entry| entry.resource != Resource::Parameters)
}

/// The packs of `fixtures/packs/v1`: a dictionary, a layered material, random placement.
fn frozen_packs() -> Vec<Pack> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/packs/v1");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    files.map(|path| Pack::open(path, &Limits::default()).unwrap()).collect()
}

#[test]
fn what_is_bound_is_what_the_pack_holds() {
    let Some(gpu) = gpu() else { return };
    let frozen = frozen_packs();
    for pack in packs().iter().chain(&frozen) {
        let subjects = Subjects::of_packs(gpu, &[pack], &[]).unwrap();
        let data = subjects.shown.iter().map(|shown| &shown.data).chain(&subjects.environment);
        let mut bound = BTreeSet::new();
        for (kind, section) in data.flat_map(|data| &data.sections) {
            let bytes = bytes_of(gpu, section);
            let same = |entry: &&SectionEntry| entry.kind == *kind && *pack.payload(entry).unwrap() == bytes[..];
            let found: Vec<&SectionEntry> = gpu_sections(pack).filter(same).collect();
            assert!(!found.is_empty(), "the bytes bound as {kind} are those of no section");
            bound.extend(found.iter().map(|entry| entry.label()));
        }
        for entry in gpu_sections(pack) {
            assert!(bound.contains(&entry.label()), "{} is not bound", entry.label());
        }
    }
}

#[test]
fn bytes_are_those_of_the_sections() {
    let Some(gpu) = gpu() else { return };
    let subjects = subjects(gpu);
    let mut with_sections = 0;
    // What comes from no pack has no sections.
    let of_packs =
        subjects.shown.iter().filter(|shown| !matches!(shown.method, Method::Textures | Method::PlainTextures));
    for data in of_packs.map(|shown| &shown.data).chain(&subjects.environment) {
        let of_sections: u64 = data.sections.iter().map(|(_, section)| bytes_of(gpu, section).len() as u64).sum();
        assert_eq!(data.bytes, of_sections);
        with_sections += u32::from(of_sections > 0);
    }
    assert!(with_sections >= 6, "only {with_sections} have sections");
}
