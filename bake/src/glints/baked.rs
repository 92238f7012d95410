//! A baked material of counted facets.

use super::eval::CountedMaterial;
use super::layers::Layers;
use crate::area_light::baked::LtcTables;
use glam::{Vec2, Vec3};
use glint_formats::glints::GlintsParams;

/// A baked material of counted facets.
#[derive(Clone, Debug, PartialEq)]
pub struct CountedFacets {
    /// Its parameters.
    pub params: GlintsParams,
    /// The LTC tables, those of area lights.
    pub tables: LtcTables,
}

impl CountedFacets {
    /// The material as the run time has it.
    pub fn material(&self) -> CountedMaterial {
        let uniform = self.params.uniform();
        CountedMaterial {
            f0: Vec3::from_array(uniform.f0),
            normal_target: uniform.normal_target,
            alpha: Vec2::from_array(uniform.alpha),
            turn: Vec2::from_array(uniform.turn),
            mean_colour: Vec3::from_array(uniform.mean_colour),
            colours: uniform.colours,
            density: uniform.density,
            relative_area: uniform.relative_area,
            facet_area: uniform.facet_area,
            facet_spread: uniform.facet_spread,
            sky_spread: uniform.sky_spread,
            seed: uniform.seed,
            layers: Layers {
                diffuse: Vec3::from_array(uniform.layers.diffuse),
                coat: uniform.layers.coat,
                coat_alpha: uniform.layers.coat_alpha,
            },
        }
    }

    /// The colours of its facets, linear RGB; none means white.
    pub fn colours(&self) -> Vec<Vec3> {
        self.params.colours.iter().map(|colour| Vec3::from_array(*colour)).collect()
    }
}
