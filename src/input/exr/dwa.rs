//! The sizes that a DWA block claims for its four sections. The library allocates them as claimed, so they are held against
//! what a block of its size can need.
//!
//! A block begins with eleven 64-bit counters: version; bytes of the UNKNOWN section, raw and compressed; compressed bytes
//! of AC, DC and RLE; bytes of RLE as tokens and raw; AC values, DC values; and how AC is coded.

use exr::math::Vec2;
use exr::meta::attribute::ChannelList;

const COUNTERS: usize = 11;
/// Coefficients of an 8 × 8 transform.
const COEFFICIENTS: u64 = 64;

/// Looks at the counters of a compressed block. A block that is too short for them is left to the library.
pub(super) fn check(channels: &ChannelList, size: Vec2<usize>, block: &[u8]) -> Result<(), String> {
    let raw = (size.area() * channels.bytes_per_pixel) as u64;
    if block.len() < 8 * COUNTERS || block.len() as u64 == raw {
        return Ok(());
    }
    let counter = |i: usize| {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(&block[8 * i..][..8]);
        u64::from_le_bytes(bytes)
    };
    let transforms = (size.0.div_ceil(8) * size.1.div_ceil(8) * channels.list.len()) as u64;
    let limits = [
        ("bytes of unknown channels", 1, raw),
        // A run takes one byte more than its values at worst.
        ("bytes of run lengths", 6, 2 * raw),
        ("bytes of run-length channels", 7, raw),
        ("AC values", 8, COEFFICIENTS * transforms),
        ("DC values", 9, transforms),
    ];
    match limits.into_iter().find(|&(_, at, most)| counter(at) > most) {
        None => Ok(()),
        Some((what, at, most)) => Err(format!(
            "it claims {} {what}, where a block of {} × {} has {most} at most",
            counter(at),
            size.0,
            size.1
        )),
    }
}
