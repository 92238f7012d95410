//! One environment, as numbers.

use crate::methods::contents::{Item, decode_all};
use crate::quantities::{kib, percent};
use glint_formats::environment::{
    ALBEDO, COLOURS, EnvironmentParams, INDICATORS, MIRROR, PARAMS, RADIANCE, SHARP, UNIFORM,
};
use glint_formats::{Pack, SectionEntry};
use serde::Serialize;
use std::fmt::Write;

/// One environment.
#[derive(Debug, Serialize)]
pub struct EnvironmentInfo {
    /// Name in the pack.
    pub name: String,
    /// Its parameters.
    pub params: EnvironmentParams,
    /// Bytes that a GPU holds of it: all its sections but the parameters, decompressed.
    pub texture_bytes: u64,
}

impl EnvironmentInfo {
    /// Describes every environment of a sound pack.
    pub fn all_of(pack: &Pack) -> Vec<EnvironmentInfo> {
        let describe = |(entry, params): (&SectionEntry, EnvironmentParams)| {
            let bound = [UNIFORM, MIRROR, RADIANCE, INDICATORS, COLOURS, ALBEDO];
            let bytes = bound.iter().filter_map(|kind| Some(pack.find(*kind, &entry.name)?.raw_len)).sum();
            EnvironmentInfo { name: entry.name.clone(), params, texture_bytes: bytes }
        };
        decode_all(pack, PARAMS).into_iter().map(describe).collect()
    }

    /// Size and error on one line.
    fn size_and_error(&self) -> String {
        let params = &self.params;
        let read = match params.measured.reads.as_slice() {
            [sharp, rest] => format!(
                "read with an error of {} (worst {}), {} (worst {}) where α < {SHARP}",
                percent(rest.relative),
                percent(rest.worst),
                percent(sharp.relative),
                percent(sharp.worst)
            ),
            _ => "error not measured".to_owned(),
        };
        format!(
            "{}² × 6, {} roughnesses, {}, {} levels ({} too much variance to take back at run time), {read}",
            params.face_size,
            params.filtered(),
            kib(self.texture_bytes),
            params.levels.len(),
            percent(params.measured.second_moment)
        )
    }
}

impl Item for EnvironmentInfo {
    fn name(&self) -> &str {
        &self.name
    }

    fn accuracy_line(&self) -> Option<String> {
        Some(self.size_and_error())
    }

    fn to_text(&self) -> String {
        let params = &self.params;
        let measured = &params.measured;
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(out, "environment \"{}\"", self.name);
        let _ = writeln!(
            out,
            "  source       {} × {} pixels, {} of them negative and taken as 0",
            params.source_width, params.source_height, params.negative_pixels
        );
        let [r, g, b] = params.mean_radiance;
        let _ = writeln!(out, "  mean         {r:.5}, {g:.5}, {b:.5}");
        let _ =
            writeln!(out, "  filter       {}, error {} of the mean asked", kebab(&params.kernel), params.filter_error);
        for (reads, alpha) in measured.reads.iter().zip([format!("α < {SHARP}"), format!("α ≥ {SHARP}")]) {
            let _ = writeln!(
                out,
                "  reads        {alpha}: relative error {}, worst {}, RMSE {} of the mean, of {} look-ups",
                percent(reads.relative),
                percent(reads.worst),
                percent(reads.of_mean),
                reads.count
            );
        }
        let _ =
            writeln!(out, "  storage      f16, radiance over {}, {}", params.radiance_scale, kib(self.texture_bytes));
        let _ = writeln!(out, "  energy       {:.1e} from that of the source", measured.energy);
        let _ = writeln!(out, "  look-ups     {} for a surface seen at an angle", params.look_ups);
        let levels: Vec<String> = params.levels.iter().map(|level| format!("{level:.5}")).collect();
        let colours = if params.coloured { ", with colours" } else { "" };
        let _ = writeln!(out, "  levels       {}{colours}: {}", kebab(&params.level_choice), levels.join(" "));
        let _ = writeln!(
            out,
            "  ⟨L²⟩         of levels {} too high on average, exact in the alpha of radiance",
            percent(measured.second_moment)
        );
        let _ = writeln!(out, "  roughnesses      face     roughness         RMSE  worst texel     rounding");
        for (index, alpha) in params.roughness.iter().enumerate() {
            let error = measured
                .texels
                .get(index)
                .map_or((String::from("-"), String::from("-")), |m| (percent(m.rmse), percent(m.worst)));
            let _ = writeln!(
                out,
                "    {index:<10} {:>6} {alpha:>13.5} {:>12} {:>12} {:>12}",
                params.size(index as u32),
                error.0,
                error.1,
                measured.rounding.get(index).map_or(String::from("-"), |rounding| percent(*rounding))
            );
        }
        out
    }
}

/// A unit variant as the pack's JSON and the flags spell it.
fn kebab(value: &impl Serialize) -> String {
    let text = serde_json::to_string(value).unwrap_or_default();
    text.trim_matches('"').to_owned()
}
