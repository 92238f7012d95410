//! A slope dictionary on the GPU: `bind_dictionary.wgsl`.

use crate::gpu::{Gpu, ResourceSet, Resources};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use glint_bake_core::dictionary::tables::Dictionary;

/// `DictionaryData`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct TablesUniform {
    marginals: u32,
    levels: u32,
    entries: u32,
    alpha_dict: f32,
    domain: f32,
    inv_spacing: f32,
    lobe_area: f32,
    unused: u32,
}

/// Uploads a dictionary and the colours of its glints (linear RGB; none means white).
pub fn upload(gpu: &Gpu, dictionary: &Dictionary, colours: &[Vec3]) -> Resources {
    let tables = dictionary.tables();
    let uniform = TablesUniform {
        marginals: tables.marginals,
        levels: tables.levels,
        entries: tables.entries,
        alpha_dict: tables.alpha_dict,
        domain: tables.domain,
        inv_spacing: tables.inv_spacing,
        lobe_area: tables.lobe_area,
        unused: 0,
    };
    let colours: Vec<[f32; 4]> = colours.iter().map(|colour| colour.extend(1.0).to_array()).collect();
    let mut set = ResourceSet::default();
    set.uniform(gpu, bytemuck::bytes_of(&uniform));
    set.storage(gpu, bytemuck::cast_slice(&pairs(dictionary)));
    set.storage(gpu, bytemuck::cast_slice(&colours));
    set.finish(gpu)
}

/// Each texel with the next of its row, the last with itself: the first in the lower half of a word.
fn pairs(dictionary: &Dictionary) -> Vec<u32> {
    let mut words = Vec::with_capacity(dictionary.bits.len());
    for row in dictionary.bits.chunks_exact(dictionary.options.entries as usize) {
        let next = row.iter().skip(1).chain(row.last());
        words.extend(row.iter().zip(next).map(|(&own, &next)| u32::from(own) | u32::from(next) << 16));
    }
    words
}
