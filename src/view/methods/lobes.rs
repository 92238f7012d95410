//! Which WGSL files draw lobes of a map and the surface synthesised from it, as a pack stores them. Both bind
//! [`glint_formats::lobes::BINDINGS`] by `bind_lobes.wgsl`.

use glint_formats::lobes::{LobeStorage, LobesParams};
use glint_formats::synthesis::{Layout, SynthesisParams};

/// The WGSL files that a program of these lobes takes in besides `query_lobes` or `shade_lobes`.
pub fn modules(params: &LobesParams) -> [&'static str; 1] {
    match params.storage {
        LobeStorage::Packed => ["lobes::packed"],
        LobeStorage::Half => ["lobes::half"],
    }
}

/// The WGSL files that a program of this surface takes in besides `query_surface` or `shade_surface`; with `whole_blocks`
/// ([`glint_bake_core::surface::SurfaceSettings::whole_blocks`]) seams are not followed.
pub fn surface_modules(lobes: &LobesParams, synthesis: &SynthesisParams, whole_blocks: bool) -> [&'static str; 3] {
    let [records] = modules(lobes);
    let arrangement = match synthesis.layout {
        Layout::Patches { .. } => "synthesis::grid",
        Layout::CornerTiles { .. } => "synthesis::tiles",
    };
    [records, arrangement, if whole_blocks { "surface::blocks" } else { "surface::seams" }]
}
