//! The bytes are those that `docs/FORMAT.md` describes, written out here by hand.

use crate::samples::*;
use glint_formats::Wrap;
use glint_formats::container::{FourCc, Limits};
use glint_formats::ndf_maps::{MomentsRecord, NodeRecord, PlacementKind, PlacementParams};
use glint_formats::{Pack, Section, params, vk_format};
use xxhash_rust::xxh3::xxh3_64;

/// Joins fields.
fn join(fields: &[&[u8]]) -> Vec<u8> {
    fields.concat()
}

#[test]
fn moments_keep_their_mean_and_covariance() {
    for (mean, [x, y], correlation) in
        [([0.3, -0.7], [0.2, 0.05], 0.4), ([-1.0, 1.0], [1.0, 1e-3], -1.0), ([0.0, 0.0], [0.0, 0.0], 0.0)]
    {
        let covariance: [f64; 3] = [x * x, correlation * x * y, y * y];
        let record = MomentsRecord::new(mean, covariance);
        for (found, expected) in record.mean().into_iter().zip(mean) {
            assert!((f64::from(found) - expected).abs() < 2e-5, "{record:?}");
        }
        let [xx, xy, yy] = record.covariance().map(f64::from);
        // Steps are finer for small deviations, that of the correlation is 1/512.
        assert!((xx.sqrt() - x).abs() <= 1e-3 * x.sqrt() && (yy.sqrt() - y).abs() <= 1e-3 * y.sqrt(), "{record:?}");
        let product = (xx * yy).sqrt();
        assert!((xy - correlation * product).abs() <= 1.1e-3 * product, "{record:?}: {xy}");
    }
}

#[test]
fn bincode_rules() {
    assert_eq!(params::encode(&1u16), [1, 0]);
    assert_eq!(params::encode(&1u32), [1, 0, 0, 0]);
    assert_eq!(params::encode(&-2i64), [254, 255, 255, 255, 255, 255, 255, 255]);
    assert_eq!(params::encode(&1.0f32), [0, 0, 0x80, 0x3f]);
    assert_eq!(params::encode(&1.0f64), [0, 0, 0, 0, 0, 0, 0xf0, 0x3f]);
    assert_eq!(params::encode(&true), [1]);
    assert_eq!(params::encode(&"ab"), [2, 0, 0, 0, 0, 0, 0, 0, b'a', b'b']);
    assert_eq!(params::encode(&vec![7u16, 8]), [2, 0, 0, 0, 0, 0, 0, 0, 7, 0, 8, 0]);
    assert_eq!(params::encode(&[7u16, 8]), [7, 0, 8, 0]);
    assert_eq!(params::encode(&(7u8, 8u16)), [7, 8, 0]);
    assert_eq!(params::encode(&Some(7u8)), [1, 7]);
    assert_eq!(params::encode(&None::<u8>), [0]);
    assert_eq!(params::encode(&Wrap::Repeat), [0, 0, 0, 0]);
    assert_eq!(params::encode(&Wrap::Clamp), [1, 0, 0, 0]);
}

#[test]
fn enum_fields_follow_the_tag() {
    let tiled = PlacementParams { kind: PlacementKind::Tiled, palette_len: 3 };
    assert_eq!(params::encode(&tiled), [0, 0, 0, 0, 3, 0, 0, 0]);
    let expected = join(&[
        &1u32.to_le_bytes(),
        &4u32.to_le_bytes(),
        &8u32.to_le_bytes(),
        &1.5f32.to_le_bytes(),
        &7u64.to_le_bytes(),
        &2u32.to_le_bytes(),
    ]);
    assert_eq!(params::encode(&stochastic(4, 8)), expected);
}

#[test]
fn ndf_parameters_byte_by_byte() {
    let mut expected = Vec::new();
    for word in [3u32, 2] {
        expected.extend_from_slice(&word.to_le_bytes());
    }
    expected.extend_from_slice(&0.01f32.to_le_bytes());
    expected.extend_from_slice(&0.5f32.to_le_bytes());
    expected.extend_from_slice(&2u64.to_le_bytes());
    for word in [2u32, 1, 0, 1, 1, 2] {
        expected.extend_from_slice(&word.to_le_bytes());
    }
    expected.extend_from_slice(&0.1f32.to_le_bytes());
    for error in [0.01f64, 0.02, 0.03, 0.001, 0.04, 0.05, 0.75] {
        expected.extend_from_slice(&error.to_le_bytes());
    }
    expected.extend_from_slice(&3u64.to_le_bytes());
    for error in [0.01f32, 0.02, 0.03] {
        expected.extend_from_slice(&error.to_le_bytes());
    }
    assert_eq!(params::encode(&ndf_params()), expected);
}

#[test]
fn a_node_byte_by_byte() {
    let node =
        NodeRecord { origin: 300 | 299 << 16, place: 7 | 1 << 16, shape: 2 | 3 << 8 | 4 << 16 | 5 << 24, scale: 1.0 };
    let expected = [0x2c, 1, 0x2b, 1, 7, 0, 1, 0, 2, 3, 4, 5, 0, 0, 0x80, 0x3f];
    assert_eq!(bytemuck::bytes_of(&node), expected);
    assert_eq!((node.origin(), node.place()), ([300, 299], [7, 1]));
    assert_eq!((node.size(), node.spacing()), ([2, 3], [4, 5]));
}

#[test]
fn provenance_byte_by_byte() {
    let text = |text: &str| join(&[&(text.len() as u64).to_le_bytes(), text.as_bytes()]);
    let one = 1u64.to_le_bytes();
    let expected = join(&[
        &text("0.1.0"),
        &text(""),
        &text("ndf-maps"),
        &one,
        &text("preset"),
        &text("draft"),
        &7u64.to_le_bytes(),
        &one,
        &text("rock.png"),
        &text(&provenance().inputs[0].xxh3_128),
        &6u64.to_le_bytes(),
        &text("y-up"),
        &0u64.to_le_bytes(),
    ]);
    assert_eq!(params::encode(&provenance()), expected);
}

/// A pack of one buffer, every byte of it.
#[test]
fn a_pack_byte_by_byte() {
    let section = Section::buffer(FourCc(*b"test"), "ab", &[1u16, 2, 3]);
    let payload = [1u8, 0, 2, 0, 3, 0];
    let mut head = join(&[
        &[0xab, b'G', b'L', b'I', b'N', b'T', b'P', 0xbb, 13, 10, 26, 10],
        &[1, 0, 0, 0],
        &1u32.to_le_bytes(),
        &0u32.to_le_bytes(),
        &262u64.to_le_bytes(),
        &[0; 8],
        b"test",
        &[1, 0, 1, 0],
        &256u64.to_le_bytes(),
        &6u64.to_le_bytes(),
        &6u64.to_le_bytes(),
        &xxh3_64(&payload).to_le_bytes(),
        &1u32.to_le_bytes(),
        &2u32.to_le_bytes(),
        &3u64.to_le_bytes(),
        &[0; 16],
        &[2, b'a', b'b'],
        &[0; 61],
    ]);
    assert_eq!(head.len(), 40 + 136);
    let checksum = xxh3_64(&head);
    head[32..40].copy_from_slice(&checksum.to_le_bytes());
    head.resize(256, 0);
    assert_eq!(pack(vec![section]), join(&[&head, &payload]));
}

/// XXH3-64 with seed 0, so that a reader in another language can test its own.
#[test]
fn checksum_vectors() {
    assert_eq!(xxh3_64(b""), 0x2d06_8005_38d3_94c2);
    assert_eq!(xxh3_64(b"glintpack"), CHECKSUM_OF_GLINTPACK);
}

/// Written in `docs/FORMAT.md` too.
const CHECKSUM_OF_GLINTPACK: u64 = 0x81db_4c74_e235_3d14;

#[test]
fn texture_words() {
    let bytes = pack(vec![classes_section(1)]);
    let words: Vec<u32> =
        bytes[80..112].chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect();
    assert_eq!(words, [2, vk_format::R32G32B32A32_UINT, 2, 2, 1, 1, 2, 0]);
}

#[test]
fn a_newer_minor_version_is_read() {
    let bytes = patched(pack(vec![provenance_section()]), 14, &[9, 0]);
    assert_eq!(Pack::from_bytes(bytes, &Limits::default()).unwrap().version(), (1, 9));
}
