//! Sections of a synthesised surface.

use glint_formats::Section;
use glint_formats::Wrap;
use glint_formats::synthesis::{self, Layout, SynthesisParams};

/// A surface of 2 × 1 patches of four texels, which overlap by two.
pub fn synthesis_params() -> SynthesisParams {
    SynthesisParams {
        sample_width: 8,
        sample_height: 6,
        wrap: Wrap::Clamp,
        patch: 4,
        overlap: 2,
        alignment: 2,
        alpha: 0.9,
        error_tolerance: 0.5,
        seed: 7,
        layout: Layout::Patches { width: 7, height: 4, columns: 2, rows: 1 },
        measured: synthesis::MeasuredError { seam_ratio: 1.25, distinct_offsets: 2 },
    }
}

/// Two tiles for four corners of the one colour.
pub fn corner_tile_params() -> SynthesisParams {
    let layout = Layout::CornerTiles { colours: 1, variants: 2, margin: 1, hash_seed: 3 };
    SynthesisParams { sample_width: 12, sample_height: 12, patch: 10, overlap: 2, layout, ..synthesis_params() }
}

/// Offsets of [`synthesis_params`], and zeros to 16 bytes.
pub fn synthesis_offsets() -> Vec<[u16; 2]> {
    vec![[2, 2], [4, 2], [0; 2], [0; 2]]
}

/// Paths of [`synthesis_params`]: six entries of one bit in a word, left and upper of each patch.
pub fn synthesis_seams() -> Vec<u32> {
    vec![0b001100, 0b111111, 0, 0b100000]
}

/// The three sections of a synthesis.
pub fn synthesis_sections(params: &SynthesisParams, offsets: &[[u16; 2]], seams: &[u32]) -> Vec<Section> {
    vec![
        Section::parameters(synthesis::PARAMS, "gold", params),
        Section::buffer(synthesis::OFFSETS, "gold", offsets),
        Section::buffer(synthesis::SEAMS, "gold", seams),
    ]
}

pub fn good_synthesis() -> Vec<Section> {
    synthesis_sections(&synthesis_params(), &synthesis_offsets(), &synthesis_seams())
}
