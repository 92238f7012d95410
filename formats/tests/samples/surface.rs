//! Sections of lobes and the surface they lie on.

use super::*;
use glint_formats::Section;
use glint_formats::Wrap;
use glint_formats::lobes::{self, LobeStorage, LobesParams};
use glint_formats::synthesis::SynthesisParams;

/// Lobes of the sample of a surface: 2 × 2 cells of 4 texels and the whole, a lobe each.
pub fn surface_lobes_params() -> LobesParams {
    let mut params = LobesParams {
        width: 8,
        height: 8,
        wrap: Wrap::Clamp,
        step_texels: 4,
        lobes_per_cell: 1,
        ..lobes_params(LobeStorage::Packed)
    };
    params.levels[0].cells_y = 2;
    params
}

/// The synthesis that goes with [`surface_lobes_params`].
pub fn surface_synthesis_params() -> SynthesisParams {
    SynthesisParams { sample_height: 8, alignment: 4, ..synthesis_params() }
}

/// The seven sections of a surface.
pub fn surface_sections(lobes: &LobesParams, synthesis: &SynthesisParams) -> Vec<Section> {
    let normals = vec![[0x0080_0080u32; 2]; (lobes.width * lobes.height).next_multiple_of(2) as usize];
    let mut sections = vec![
        Section::parameters(lobes::PARAMS, "gold", lobes),
        Section::buffer(lobes::UNIFORM, "gold", &[lobes.uniform(synthesis.uniform())]),
        Section::buffer(lobes::LOBES, "gold", &[packed_lobes()[0]; 5]),
        Section::buffer(lobes::NORMALS, "gold", &normals),
    ];
    sections.extend(synthesis_sections(synthesis, &[[4, 4], [4, 4], [0; 2], [0; 2]], &synthesis_seams()));
    sections
}
