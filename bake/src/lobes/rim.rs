//! How much of a map's lobes lies beyond the rim of the disk of normals, where no normal is. Densities get that mass back
//! (`eval`), which takes a sum over strips; a renderer of a map whose normals keep away from the rim may leave it out.

use super::bake::BakedLobes;
use super::eval::{facet_mass_inside, mass_inside};
use super::quantise::Scales;

/// Intrinsic roughnesses that are tried, the widest first.
const ROUGHNESSES: [f32; 7] = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005];

impl BakedLobes {
    /// Share of a map that its lobes put beyond the rim, with `roughness` as the intrinsic one: the largest of the stored levels'
    /// and of the texels'.
    pub fn beyond_rim(&self, roughness: f32) -> f32 {
        let of_level = |level: usize| {
            let grid = &self.params.levels[level];
            let scales = Scales::new(&self.params, grid);
            let count = grid.cells_x * grid.cells_y * self.params.lobes_per_cell;
            let lobes = (grid.first_lobe..grid.first_lobe + count).map(|index| self.lobe(index, &scales));
            share_beyond(lobes.map(|lobe| (lobe.weight, mass_inside(&lobe, roughness))))
        };
        let texels = (0..self.params.height as i32).flat_map(|j| (0..self.params.width as i32).map(move |i| (i, j)));
        let of_texels = share_beyond(texels.map(|(i, j)| (1.0, facet_mass_inside(self.texel(i, j), roughness))));
        (0..self.params.levels.len()).map(of_level).fold(of_texels, f32::max)
    }

    /// The widest of a few intrinsic roughnesses at which at most `share` of the map lies beyond the rim; 0 if it is more at all of
    /// them.
    pub fn rim_roughness(&self, share: f32) -> f32 {
        ROUGHNESSES.into_iter().find(|roughness| self.beyond_rim(*roughness) <= share).unwrap_or(0.0)
    }
}

/// Share beyond the rim of parts, each a weight and its mass inside.
fn share_beyond(parts: impl Iterator<Item = (f32, f32)>) -> f32 {
    let (mut beyond, mut whole) = (0.0, 0.0);
    for (weight, inside) in parts {
        beyond += f64::from(weight * (1.0 - inside).max(0.0));
        whole += f64::from(weight);
    }
    if whole > 0.0 { (beyond / whole) as f32 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use crate::lobes::{BakedLobes, LobesOptions, bake};
    use crate::normal_map::NormalMap;
    use crate::progress::Silent;
    use glint_formats::Wrap;

    /// Ramps from the middle to `steepest`, the length of the projected normal.
    fn ramps(steepest: f32) -> BakedLobes {
        let projected = (0..32 * 32).map(|k| [steepest * (k % 32) as f32 / 31.0, 0.0]).collect();
        let map = NormalMap { width: 32, height: 32, wrap: Wrap::Clamp, projected };
        bake(&map, &LobesOptions { footprints: 0, ..LobesOptions::default() }, &Silent).unwrap()
    }

    #[test]
    fn gentle_maps_stay_inside_and_steep_ones_do_not() {
        assert_eq!(ramps(0.0).beyond_rim(0.02), 0.0);
        let (gentle, steep) = (ramps(0.5), ramps(0.99));
        assert!(gentle.beyond_rim(0.05) < 1e-5, "{}", gentle.beyond_rim(0.05));
        assert!(steep.beyond_rim(0.05) > 1e-2, "{}", steep.beyond_rim(0.05));
        assert!(gentle.rim_roughness(1e-4) >= 0.05 && steep.rim_roughness(1e-4) == 0.0);
    }

    #[test]
    fn more_lies_beyond_the_rim_of_rougher_facets() {
        let baked = ramps(0.7);
        let shares = [0.01, 0.05, 0.1, 0.2, 0.5].map(|roughness| baked.beyond_rim(roughness));
        assert!(shares.windows(2).all(|pair| pair[0] <= pair[1]), "{shares:?}");
        // A Gaussian of σ around the middle has exp(-1 / 2σ²) beyond the rim; farther out it has more.
        assert!(shares[4] > 0.135 && shares[4] < 0.5, "{shares:?}");
    }
}
