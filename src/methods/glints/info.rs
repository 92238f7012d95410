//! One material of counted facets, as numbers.

use crate::methods::contents::{Item, decode_all};
use crate::quantities::kib;
use glint_formats::glints::{COLOURS, GlintsParams, INVERSE, PARAMS, TERMS, UNIFORM};
use glint_formats::{Pack, SectionEntry};
use serde::Serialize;
use std::fmt::Write;

/// One material of counted facets.
#[derive(Debug, Serialize)]
pub struct GlintsInfo {
    /// Name in the pack.
    pub name: String,
    /// What it is.
    pub params: GlintsParams,
    /// Bytes that the GPU holds of it.
    pub gpu_bytes: u64,
}

impl GlintsInfo {
    /// Describes every material of counted facets of a sound pack.
    pub fn all_of(pack: &Pack) -> Vec<GlintsInfo> {
        let describe = |(entry, params): (&SectionEntry, GlintsParams)| {
            let bytes = |kind| pack.find(kind, &entry.name).map_or(0, |section| section.raw_len);
            let gpu_bytes = [UNIFORM, COLOURS, INVERSE, TERMS].map(bytes).iter().sum();
            GlintsInfo { name: entry.name.clone(), params, gpu_bytes }
        };
        decode_all(pack, PARAMS).into_iter().map(describe).collect()
    }
}

impl Item for GlintsInfo {
    fn name(&self) -> &str {
        &self.name
    }

    fn accuracy_line(&self) -> Option<String> {
        let params = &self.params;
        Some(format!(
            "{} facets a unit², {}, tables off by {:.1} % on average",
            params.density,
            kib(self.gpu_bytes),
            100.0 * params.table_mean_error
        ))
    }

    fn to_text(&self) -> String {
        let params = &self.params;
        let [a, b] = params.alpha;
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(out, "counted facets \"{}\"", self.name);
        let _ = writeln!(
            out,
            "  slopes       {:?}, α {a} by {b}, turned by {:.1}°",
            params.slopes,
            params.turn.to_degrees()
        );
        let share = 100.0 * params.relative_area;
        let _ = writeln!(out, "  density      {} facets a unit² on {share:.1} % of the surface", params.density);
        let spread = params.facet_spread.to_degrees();
        let sky = match params.sky_spread {
            0.0 => "the same from everywhere under an environment".to_owned(),
            turn => format!("others every {:.1}° under an environment", turn.to_degrees()),
        };
        let _ = writeln!(out, "  facets       reflect {spread:.3}° either side, {sky}");
        let _ = writeln!(out, "  F0           {:?}", params.f0);
        let _ = writeln!(out, "  diffuse      {:?}", params.diffuse);
        match params.coat {
            0.0 => {}
            coat => {
                let _ = writeln!(out, "  coat         {coat}, α {}", params.coat_alpha);
            }
        }
        let _ = writeln!(out, "  colours      {}", params.colours.len());
        let _ = writeln!(out, "  GPU          {}", kib(self.gpu_bytes));
        let _ = writeln!(out, "  seed         {}", params.seed);
        out
    }
}
