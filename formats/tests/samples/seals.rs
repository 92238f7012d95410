//! Bytes of a pack made wrong, and its checksums right again.

use glint_formats::container::{ENTRY_BYTES, HEADER_BYTES};
use xxhash_rust::xxh3::xxh3_64;

/// Where a field of a table entry lies in the file.
pub fn entry_at(entry: usize, field: usize) -> usize {
    HEADER_BYTES as usize + entry * ENTRY_BYTES as usize + field
}

/// Puts bytes in place and makes header checksum and file length right again.
pub fn patched(mut bytes: Vec<u8>, at: usize, with: &[u8]) -> Vec<u8> {
    bytes[at..at + with.len()].copy_from_slice(with);
    seal(&mut bytes);
    bytes
}

/// Makes file length and header checksum right, where header and table are there at all.
pub fn seal(bytes: &mut [u8]) {
    if bytes.len() < HEADER_BYTES as usize {
        return;
    }
    let len = bytes.len() as u64;
    bytes[24..32].copy_from_slice(&len.to_le_bytes());
    reseal_header(bytes);
}

/// Makes the header checksum right and leaves the stated length.
pub fn reseal_header(bytes: &mut [u8]) {
    let count = u64::from(u32::from_le_bytes(bytes[16..20].try_into().unwrap()));
    let end = HEADER_BYTES + count * ENTRY_BYTES;
    if end > bytes.len() as u64 {
        return;
    }
    bytes[32..40].fill(0);
    let checksum = xxh3_64(&bytes[..end as usize]);
    bytes[32..40].copy_from_slice(&checksum.to_le_bytes());
}

/// Makes every checksum right whose section lies in the file.
pub fn reseal_sections(bytes: &mut [u8]) {
    let mut at = HEADER_BYTES as usize;
    while let Some(entry) = bytes.get(at..at + ENTRY_BYTES as usize) {
        let word = |i: usize| u64::from_le_bytes(entry[i..i + 8].try_into().unwrap());
        let range = word(8)..word(8).saturating_add(word(16));
        if range.end <= bytes.len() as u64 {
            let checksum = xxh3_64(&bytes[range.start as usize..range.end as usize]);
            bytes[at + 32..at + 40].copy_from_slice(&checksum.to_le_bytes());
        }
        at += ENTRY_BYTES as usize;
        let count = u32::from_le_bytes(bytes[16..20].try_into().unwrap()) as usize;
        if at >= HEADER_BYTES as usize + count.saturating_mul(ENTRY_BYTES as usize) {
            return;
        }
    }
}
