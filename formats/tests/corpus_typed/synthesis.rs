//! Bad packs of synthesised surfaces.

use super::without;
use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::IssueCode;
use glint_formats::synthesis::{self, Layout, SynthesisParams};

fn synthesis_with_params(edit: impl Fn(&mut SynthesisParams)) -> Vec<u8> {
    let mut params = synthesis_params();
    edit(&mut params);
    pack(synthesis_sections(&params, &synthesis_offsets(), &synthesis_seams()))
}

fn synthesis_with_offset(offset: [u16; 2]) -> Vec<u8> {
    pack(synthesis_sections(&synthesis_params(), &[[2, 2], offset, [0; 2], [0; 2]], &synthesis_seams()))
}

fn synthesis_with_seam(word: u32) -> Vec<u8> {
    let mut seams = synthesis_seams();
    seams[3] = word;
    pack(synthesis_sections(&synthesis_params(), &synthesis_offsets(), &seams))
}

pub fn cases() -> Vec<Case> {
    vec![
        case(IssueCode::SynthesisParameters, synthesis_with_params(|params| params.alignment = 3)),
        case(IssueCode::SynthesisShape, pack(synthesis_sections(&synthesis_params(), &[[2, 2]], &synthesis_seams()))),
        case(IssueCode::SynthesisOffset, synthesis_with_offset([6, 2])),
        case(IssueCode::SynthesisSeam, synthesis_with_seam(0b1000000)),
        case(
            IssueCode::SynthesisPadding,
            pack(synthesis_sections(&synthesis_params(), &[[2, 2], [4, 2], [0; 2], [0, 1]], &synthesis_seams())),
        ),
    ]
}

#[test]
fn every_way_a_synthesis_can_be_wrong_is_found() {
    let edits: [fn(&mut SynthesisParams); 18] = [
        |params| params.sample_width = 0,
        |params| params.sample_height = u32::MAX,
        |params| params.sample_height = 5,
        |params| params.patch = 3,
        |params| params.patch = u32::MAX,
        |params| params.overlap = 3,
        |params| params.overlap = u32::MAX,
        |params| params.alignment = 0,
        |params| params.alpha = 1.5,
        |params| params.alpha = f32::NAN,
        |params| params.error_tolerance = f32::INFINITY,
        |params| params.error_tolerance = -1.0,
        |params| params.measured.seam_ratio = f64::NAN,
        |params| params.layout = Layout::Patches { width: 0, height: 4, columns: 0, rows: 1 },
        |params| params.layout = Layout::Patches { width: 7, height: 4, columns: 3, rows: 1 },
        |params| params.layout = Layout::Patches { width: u32::MAX, height: 4, columns: 1 << 30, rows: 1 },
        |params| params.layout = Layout::CornerTiles { colours: 1, variants: 1, margin: 1, hash_seed: 0 },
        // Patches of 68 texels with an overlap of 34 take 17 words a path: more than a buffer that every GPU binds holds.
        |params| {
            (params.sample_width, params.sample_height, params.patch, params.overlap) = (128, 128, 70, 35);
            params.layout = Layout::Patches { width: 1024 * 70, height: 1024 * 70, columns: 1024, rows: 1024 };
        },
    ];
    for edit in edits {
        assert_eq!(codes(&synthesis_with_params(edit)), [IssueCode::SynthesisParameters]);
    }
    // Outside, not aligned, and the last that lies inside.
    for offset in [[0, 2], [2, 4], [3, 2], [u16::MAX, u16::MAX]] {
        assert_eq!(codes(&synthesis_with_offset(offset)), [IssueCode::SynthesisOffset], "{offset:?}");
    }
    assert_eq!(codes(&synthesis_with_offset([4, 2])), []);
    let lacking = |kind| pack(without(good_synthesis(), kind));
    assert_eq!(codes(&lacking(synthesis::OFFSETS)), [IssueCode::MissingSection]);
    assert_eq!(codes(&lacking(synthesis::SEAMS)), [IssueCode::MissingSection]);
    assert_eq!(codes(&lacking(synthesis::PARAMS)), [IssueCode::OrphanSection; 2]);
}

/// Offsets and paths of no bits of a sound surface with these parameters.
fn blank_synthesis(params: &SynthesisParams) -> (Vec<[u16; 2]>, Vec<u32>) {
    let mut offsets = vec![[2, 2]; params.offset_count() as usize];
    offsets.resize(params.stored_offsets() as usize, [0; 2]);
    (offsets, vec![0; params.stored_seam_words() as usize])
}

#[test]
fn every_way_corner_tiles_can_be_wrong_is_found() {
    let sound = corner_tile_params();
    let codes_of = |params: &SynthesisParams, seams: &[u32]| {
        codes(&pack(synthesis_sections(params, &blank_synthesis(&sound).0, seams)))
    };
    let (offsets, mut seams) = blank_synthesis(&sound);
    // One colour and two tiles; a pair of paths of six entries, four paths of eight a tile, all in a word each.
    assert_eq!((sound.offset_count(), sound.seam_words()), (3, 10));
    assert_eq!((offsets.len(), seams.len()), (4, 12));
    assert_eq!(codes_of(&sound, &seams), []);
    seams[9] = 0b1_0000_0000;
    assert_eq!(codes_of(&sound, &seams), [IssueCode::SynthesisSeam]);
    (seams[9], seams[11]) = (0, 1);
    assert_eq!(codes_of(&sound, &seams), [IssueCode::SynthesisPadding]);
    seams[11] = 0;
    let layouts = [(0, 1, 1), (5, 1, 1), (1, 0, 1), (1, 17, 1), (1, 2, 0), (1, 2, 2), (1, 2, u32::MAX)];
    for (colours, variants, margin) in layouts {
        let layout = Layout::CornerTiles { colours, variants, margin, hash_seed: 3 };
        let params = SynthesisParams { layout, ..sound.clone() };
        assert_eq!(codes_of(&params, &seams), [IssueCode::SynthesisParameters], "{colours} {variants} {margin}");
    }
    let odd = SynthesisParams { patch: 11, sample_width: 14, sample_height: 14, alignment: 1, ..sound };
    assert_eq!(codes_of(&odd, &seams), [IssueCode::SynthesisParameters]);
}

#[test]
fn a_path_that_jumps_or_leaves_the_overlap_is_found() {
    // An overlap of three takes two bits an entry; three is no entry, and from nought to two is no step.
    let params = SynthesisParams { sample_width: 9, sample_height: 9, patch: 6, overlap: 3, ..synthesis_params() };
    let layout = Layout::Patches { width: 6, height: 6, columns: 1, rows: 1 };
    let params = SynthesisParams { alignment: 3, layout, ..params };
    let codes_of =
        |word: u32| codes(&pack(synthesis_sections(&params, &[[3, 3], [0; 2], [0; 2], [0; 2]], &[0, word, 0, 0])));
    assert_eq!(codes_of(0b01_10_01_00), []);
    assert_eq!(codes_of(0b11_10), [IssueCode::SynthesisSeam]);
    assert_eq!(codes_of(0b10_00), [IssueCode::SynthesisSeam]);
}
