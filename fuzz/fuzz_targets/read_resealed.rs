//! Like `read_pack`, with file length and checksums made right first, so that the bytes reach the checks behind them.
#![no_main]

use glint_formats::container::{ENTRY_BYTES, HEADER_BYTES, MAGIC};
use glint_formats::{Limits, Pack, validate};
use libfuzzer_sys::fuzz_target;
use xxhash_rust::xxh3::xxh3_64;

const LIMITS: Limits = Limits { max_file_bytes: 1 << 20, max_sections: 1000, max_raw_bytes: 1 << 22 };

fuzz_target!(|input: &[u8]| {
    let mut bytes = input.to_vec();
    reseal(&mut bytes);
    let issues = validate(&bytes, &LIMITS);
    if let Ok(pack) = Pack::from_bytes(bytes, &LIMITS) {
        assert_eq!(pack.verify(), issues);
    }
});

/// Puts magic, version, length and every checksum in place, as far as the file is long enough.
fn reseal(bytes: &mut [u8]) {
    let header = HEADER_BYTES as usize;
    if bytes.len() < header {
        return;
    }
    let len = bytes.len() as u64;
    bytes[..12].copy_from_slice(&MAGIC);
    bytes[12..16].copy_from_slice(&[1, 0, 0, 0]);
    bytes[24..32].copy_from_slice(&len.to_le_bytes());
    let count = u64::from(u32::from_le_bytes(bytes[16..20].try_into().unwrap()));
    let table_end = HEADER_BYTES + count * ENTRY_BYTES;
    if table_end > len {
        return;
    }
    for at in (header..table_end as usize).step_by(ENTRY_BYTES as usize) {
        let start = u64::from_le_bytes(bytes[at + 8..at + 16].try_into().unwrap());
        let end = start.saturating_add(u64::from_le_bytes(bytes[at + 16..at + 24].try_into().unwrap()));
        if end <= len {
            let checksum = xxh3_64(&bytes[start as usize..end as usize]);
            bytes[at + 32..at + 40].copy_from_slice(&checksum.to_le_bytes());
        }
    }
    bytes[32..40].fill(0);
    let checksum = xxh3_64(&bytes[..table_end as usize]);
    bytes[32..40].copy_from_slice(&checksum.to_le_bytes());
}
