//! No bytes make the reader panic: neither noise nor good packs with changes under right checksums.

use crate::samples::*;
use glint_formats::container::{Limits, MAGIC};
use glint_formats::{Pack, Severity, validate};
use proptest::prelude::*;

/// Small caps keep a case short; what lies beyond them is refused before it is read.
const LIMITS: Limits = Limits { max_file_bytes: 1 << 20, max_sections: 1000, max_raw_bytes: 1 << 20 };

/// Reads bytes in every way; opening and validation agree about structure.
fn read(bytes: Vec<u8>) {
    let issues = validate(&bytes, &LIMITS);
    for issue in &issues {
        assert!(!issue.to_string().is_empty());
    }
    match Pack::from_bytes(bytes, &LIMITS) {
        Ok(pack) => {
            assert_eq!(pack.verify(), issues);
            for entry in pack.sections() {
                let _ = pack.payload(entry);
                assert!(pack.find(entry.kind, &entry.name).is_some());
            }
        }
        Err(refused) => {
            assert!(refused.iter().any(|issue| issue.severity == Severity::Error));
            assert_eq!(refused, issues);
        }
    }
}

/// A change: place as a fraction of the file, value, and how it is combined.
fn change() -> impl Strategy<Value = (f64, u64, u8)> {
    let value = prop_oneof![Just(0), Just(u64::MAX), 0u64..300, any::<u64>(), (0u32..64).prop_map(|bit| 1 << bit)];
    (0.0..1.0f64, value, 0u8..4)
}

fn apply(bytes: &mut [u8], (place, value, how): (f64, u64, u8)) {
    // The header is left as it is: its checks come first and would hide the rest.
    let at = 40 + (place * (bytes.len() - 40) as f64) as usize;
    let width = [1, 2, 4, 8][how as usize].min(bytes.len() - at);
    bytes[at..at + width].copy_from_slice(&value.to_le_bytes()[..width]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn noise_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        read(bytes);
    }

    #[test]
    fn noise_after_a_good_start_never_panics(count in 0u32..5, tail in prop::collection::vec(any::<u8>(), 0..1000)) {
        let mut bytes = MAGIC.to_vec();
        bytes.extend_from_slice(&[1, 0, 0, 0]);
        bytes.extend_from_slice(&count.to_le_bytes());
        bytes.extend_from_slice(&[0; 20]);
        bytes.extend_from_slice(&tail);
        seal(&mut bytes);
        read(bytes);
    }

    #[test]
    fn changed_packs_never_panic(changes in prop::collection::vec(change(), 1..6)) {
        let mut bytes = full_pack();
        for change in changes {
            apply(&mut bytes, change);
        }
        reseal_sections(&mut bytes);
        seal(&mut bytes);
        read(bytes);
    }

    /// Changes in payloads alone: these reach the checks of contents.
    #[test]
    fn changed_payloads_never_panic(changes in prop::collection::vec(change(), 1..6)) {
        let mut bytes = full_pack();
        let good = Pack::from_bytes(bytes.clone(), &LIMITS).unwrap();
        for (place, value, how) in changes {
            let i = (place * good.sections().len() as f64) as usize;
            let entry = &good.sections()[i];
            let within = place * good.sections().len() as f64 - i as f64;
            let at = entry.offset as usize + (within * entry.stored_len as f64) as usize;
            let end = (entry.offset + entry.stored_len) as usize;
            let width = [1, 2, 4, 8][how as usize].min(end - at);
            bytes[at..at + width].copy_from_slice(&value.to_le_bytes()[..width]);
        }
        reseal_sections(&mut bytes);
        seal(&mut bytes);
        read(bytes);
    }
}
