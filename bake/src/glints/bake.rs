//! From options to a material: its parameters, and the tables that rectangle lights need.

use super::baked::CountedFacets;
use super::options::GlintsOptions;
use crate::area_light::baked::{LtcTables, TABLE_MEAN_ERROR};
use crate::error::BakeError;
use crate::microfacet::microfacet_area;
use crate::progress::Progress;
use glint_formats::glints::GlintsParams;

/// Bakes a material. The LTC tables come with the program, and nothing else takes time, so no progress is told.
///
/// # Errors
/// Those of [`GlintsOptions::validate`].
pub fn bake(options: &GlintsOptions, _progress: &dyn Progress) -> Result<CountedFacets, BakeError> {
    options.validate()?;
    let params = GlintsParams {
        slopes: options.slopes,
        alpha: options.alpha,
        turn: options.turn,
        f0: options.f0,
        density: options.density,
        relative_area: options.relative_area,
        facet_area: microfacet_area(options.smooth()),
        facet_spread: options.facet_spread,
        sky_spread: options.sky_spread,
        seed: options.seed,
        diffuse: options.diffuse,
        coat: options.coat,
        coat_alpha: options.coat_alpha,
        colours: options.colours.clone(),
        table_mean_error: TABLE_MEAN_ERROR,
    };
    Ok(CountedFacets { params, tables: LtcTables::built_in() })
}
