//! What a bake says to the person who runs it.

use super::plan::{Plan, Source};
use crate::quantities::percent;
use crate::pack;

/// One input, for `--verbose`.
pub fn of_input(source: &Source) -> String {
    let report = &source.loaded.report;
    let [su, sv] = report.slope_std;
    format!(
        "{}: {} × {} texels, {}, {} bytes, slope deviation {su:.3} {sv:.3}, material \"{}\"",
        source.path.display(),
        source.loaded.map.width,
        source.loaded.map.height,
        source.loaded.convention,
        source.loaded.bytes,
        source.name
    )
}

/// What a dry run would do.
pub fn of_plan(plan: &Plan) -> String {
    let mut lines = Vec::new();
    for source in &plan.sources {
        let (width, height) = (source.loaded.map.width, source.loaded.map.height);
        lines.push(format!(
            "would bake {} as \"{}\": {width} × {height} texels, {} tiles",
            source.path.display(),
            source.name,
            pack::tile_count(width, height, plan.bake.min_tile)
        ));
    }
    let output = plan.args.output.display();
    lines.push(format!(
        "would write {output}: σ_r {}, E₁ {} asked, {} storage; dry run, nothing was written",
        plan.bake.roughness,
        percent(plan.bake.max_error),
        pack::storage_name(plan.bake.storage)
    ));
    lines.join("\n")
}
