//! Reads arbitrary bytes as a pack. Whatever they are, reading ends, stays within the limits and does not panic.
//!
//! Good seeds: `cargo +nightly fuzz run read_pack fuzz/corpus/read_pack fixtures/corrupt fixtures/packs`.
#![no_main]

use glint_formats::{Limits, Pack, validate};
use libfuzzer_sys::fuzz_target;

const LIMITS: Limits = Limits { max_file_bytes: 1 << 20, max_sections: 1000, max_raw_bytes: 1 << 22 };

fuzz_target!(|bytes: &[u8]| {
    let issues = validate(bytes, &LIMITS);
    if let Ok(pack) = Pack::from_bytes(bytes.to_vec(), &LIMITS) {
        assert_eq!(pack.verify(), issues);
        for entry in pack.sections() {
            let _ = pack.payload(entry);
        }
    }
});
