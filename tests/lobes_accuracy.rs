//! MIP-mapped lobes on real maps: error against exact integration, and against the paper's clustering. Few footprints of two
//! maps; the report has more.

mod real_maps;

use glam::DVec2;
use glint_bake_core::lobes::options::LobesOptions;
use glint_bake_core::lobes::quality::{Measured, footprint_errors};
use glint_bake_core::lobes::query::QuerySettings;
use glint_bake_core::lobes::reference::Reference;
use glint_bake_core::lobes::{BakedLobes, bake};
use glint_bake_core::progress::Silent;
use glint_bake_core::quality::sweep;
use glint_formats::lobes::{Filter, Merge};
use real_maps::{data, load};

#[test]
fn footprints_of_real_maps_are_within_their_error_and_far_ahead_of_k_means() {
    let Some(data) = data() else { return };
    for (file, finest) in
        [("normals/leather_008_3dtextures.jpg", 0.03), ("normals/scratched_gold_cgbookcase_rgba.png", 0.03)]
    {
        let map = load(&data, file, Some((0, 0, 128)));
        let options = LobesOptions { footprints: 0, ..LobesOptions::default() };
        let ours = bake(&map, &options, &Silent).unwrap();
        let paper = bake(&map, &LobesOptions { merge: Merge::KMeans, ..options }, &Silent).unwrap();
        let reference = Reference::new(&map, Filter::Linear, 0.02);
        for sigma in [2.0, 5.0, 16.0] {
            let places = sweep::footprints(sigma, 1.0, DVec2::splat(128.0), 3, 9);
            let chosen = |baked| -> (&BakedLobes, Measured) { (baked, Measured::Chosen(QuerySettings::default())) };
            let errors = footprint_errors(&reference, &[chosen(&ours), chosen(&paper)], &places, 6);
            let [ours, paper] = [errors[0].e1.mean, errors[1].e1.mean];
            // Up to σ = 2 both read the map itself.
            let allowed = if sigma == 2.0 { finest } else { (0.5 * paper).min(0.07) };
            assert!(ours <= allowed, "{file}, σ {sigma}: {ours}, k-means {paper}");
        }
    }
}
