//! Every real map that we have, loaded as a user would: sizes, lengths, convention, against their catalogue.
//!
//! The maps lie in the folder GLINT_DATA (../shared/data when unset); without it the test says so and passes.

use std::collections::HashMap;
use std::path::PathBuf;

use glint_bake::input::{InputError, InputOptions, LoadedMap, load_normal_map};
use glint_bake_core::normal_map::GreenAxis;

#[test]
fn dump() {
    for row in catalogue() {
        if !row.kind().starts_with("normal") && !row.kind().starts_with("tiny") && !row.kind().starts_with("height") { continue; }
        let o = InputOptions { height: row.kind().starts_with("height").then_some(4.0), assume_linear: true, ..Default::default() };
        let t = std::time::Instant::now();
        let m = load_normal_map(&row.path(), &o).unwrap();
        let r = &m.report;
        println!("{:45} {:?} corr {:?} [{}] flip {} seam {:?}/{:?} {} flat {} | off {:.4} {} below {} zero {} {:.3} {:.3} [{} {}] mean {:.4?} {} std {:.4?} {} {}", m.file_name, t.elapsed(), r.curl_correlation, row.get("green_convention"), r.flipped_green_suspected,
          r.seam_u, r.seam_v, r.seam_suspected, r.is_flat, r.off_unit as f64/r.texels as f64, row.get("off_unit_gt1pct"), r.below_horizon, r.zero_length, r.min_length, r.max_length, row.get("len_min"), row.get("len_max"), r.mean_normal, row.get("mean_normal"), r.slope_std, row.get("slope_sd_x"), row.get("slope_sd_y"));
        for w in &m.warnings { println!("        - {w}"); }
    }
}

struct Row(HashMap<String, String>);
impl Row {
    fn get(&self, column: &str) -> &str { &self.0[column] }
    fn kind(&self) -> &str { self.get("kind") }
    fn path(&self) -> PathBuf { data().join(self.get("path")) }
}
fn data() -> PathBuf { std::env::var_os("GLINT_DATA").map(PathBuf::from).unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data")) }
fn catalogue() -> Vec<Row> {
    let text = std::fs::read_to_string(data().join("SOURCES.tsv")).unwrap();
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split('\t').collect();
    lines.map(|l| Row(head.iter().map(|s| s.to_string()).zip(l.split('\t').map(|s| s.to_string())).collect())).collect()
}
