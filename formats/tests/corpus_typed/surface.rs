//! Bad packs of lobes and the surface they lie on.

use super::without;
use crate::samples::*;
use glint_formats::IssueCode;
use glint_formats::Wrap;
use glint_formats::lobes::LobesParams;
use glint_formats::synthesis::{self, SynthesisParams};

pub fn with(edit: impl Fn(&mut LobesParams, &mut SynthesisParams)) -> Vec<u8> {
    let (mut lobes, mut synthesis) = (surface_lobes_params(), surface_synthesis_params());
    edit(&mut lobes, &mut synthesis);
    pack(surface_sections(&lobes, &synthesis))
}

#[test]
fn lobes_and_synthesis_that_do_not_fit_are_found() {
    assert_eq!(codes(&with(|_, _| ())), []);
    let edits: [fn(&mut LobesParams, &mut SynthesisParams); 5] = [
        |_, surface| surface.sample_width = 9,
        |_, surface| surface.wrap = Wrap::Repeat,
        |_, surface| surface.alignment = 2,
        |_, surface| (surface.patch, surface.alignment) = (8, 8),
        |lobes, _| lobes.wrap = Wrap::Repeat,
    ];
    for edit in edits {
        let found = codes(&with(edit));
        assert!(found.contains(&IssueCode::SurfaceMismatch), "{found:?}");
    }
    // Cells of four texels cannot be told from the surface as a whole, and of cells in steps there must be one.
    let levels: [fn(&mut LobesParams, &mut SynthesisParams); 3] = [
        |lobes, _| lobes.levels[0].cells_x = 1,
        |lobes, _| lobes.levels[1].cells_x = 5,
        |lobes, _| lobes.levels[1].cell_texels = 4,
    ];
    for edit in levels {
        assert_eq!(codes(&with(edit)), [IssueCode::LobesLevels]);
    }
    let odd_step = codes(&with(|lobes, _| lobes.step_texels = 3));
    assert!(odd_step.contains(&IssueCode::LobesParameters), "{odd_step:?}");
    let alone = without(surface_sections(&surface_lobes_params(), &surface_synthesis_params()), synthesis::PARAMS);
    assert!(codes(&pack(alone)).contains(&IssueCode::MissingSection));
    let one = LobesParams { levels: vec![surface_lobes_params().levels[1]], ..surface_lobes_params() };
    assert!(!codes(&pack(surface_sections(&one, &surface_synthesis_params()))).is_empty());
}
