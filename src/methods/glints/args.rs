//! Flags of `glint-bake glints`.

use crate::cli::values::{finite, name_of, not_negative, positive, reflectance, reflectance3, roughness_pair};
use crate::cli::{OptionList, RunFlags};
use crate::delivery::Delivery;
use clap::ValueEnum;
use glint_bake_core::glints::GlintsOptions;
use glint_formats::glints::Slopes;
use std::path::PathBuf;

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake glints -o flakes.glintpack
  glint-bake glints --alpha 0.15 --f0 0.6,0.05,0.03 --diffuse 0.1,0,0 --coat 1 -o lacquer.glintpack
  glint-bake glints --density 2e5 --colour 1,0.8,0.4 --colour 0.4,0.7,1 -o glitter.glintpack";

/// Bake a material of counted facets: procedural glints under every light, without a normal map
///
/// The facets under a pixel are counted, not stored: a sun, points, rectangles and an environment light the same ones, on any mesh, at any
/// distance. The pack holds the material and two small tables for rectangles; density and roughness may differ from pixel to pixel in an
/// engine.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Pack to write
    #[arg(short, long, value_name = "PACK")]
    pub output: PathBuf,
    /// Name of the material in the pack
    #[arg(long, value_name = "NAME", default_value = "glints")]
    pub name: String,

    /// Distribution of the facets' slopes
    #[arg(long, value_name = "TARGET", default_value = "ggx", help_heading = "Material")]
    pub target: Target,
    /// Roughness α, 0.001 to 1, the same along both axes, or along each
    #[arg(long, value_name = "A[,B]", allow_negative_numbers = true, default_value = "0.3", value_parser = roughness_pair, help_heading = "Material")]
    pub alpha: [f64; 2],
    /// Angle from the tangent to the first axis of roughness, in degrees, -180 to 180
    #[arg(long, value_name = "DEGREES", default_value = "0", allow_hyphen_values = true, value_parser = finite, help_heading = "Material")]
    pub turn: f32,
    /// Reflectance at normal incidence, linear RGB
    #[arg(long, value_name = "R,G,B", default_value = "0.95,0.93,0.88", value_parser = reflectance3, help_heading = "Material")]
    pub f0: [f32; 3],
    /// Facets on one surface unit squared of what glints, at most 1e16
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value = "1e6", value_parser = positive, help_heading = "Material")]
    pub density: f64,
    /// Share of the surface that glints, 0 to 1; the rest is smooth
    #[arg(long, value_name = "SHARE", default_value = "1", value_parser = reflectance, help_heading = "Material")]
    pub relative_area: f32,
    /// Half angle of the cone that a facet reflects a point into, in degrees, 0.006 to 28
    ///
    /// The wider, the more facets a light without extent is seen in, and the longer each stays lit when the light or the eye turns. The default is as wide as
    /// the sun.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, default_value = "0.2665", value_parser = positive, help_heading = "Material")]
    pub facet_spread: f64,
    /// By how much the eye turns, in degrees, until facets under an environment are others, 0 to 180; 0 for never
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, default_value = "0", value_parser = not_negative, help_heading = "Material")]
    pub sky_spread: f32,
    /// Colour of facets, linear RGB; may be given up to 256 times, and facets take one of them each
    #[arg(long, value_name = "R,G,B", value_parser = reflectance3, help_heading = "Material")]
    pub colour: Vec<[f32; 3]>,
    /// Albedo of what is scattered below the facets, linear RGB: that of snow or paint; metals have none
    #[arg(long, value_name = "R,G,B", default_value = "0,0,0", value_parser = reflectance3, help_heading = "Layers")]
    pub diffuse: [f32; 3],
    /// Weight of a clear coat over the facets, 0 for none to 1
    #[arg(long, value_name = "WEIGHT", allow_negative_numbers = true, default_value = "0", value_parser = reflectance, help_heading = "Layers")]
    pub coat: f32,
    /// GGX roughness α of the coat, 0.001 to 1
    #[arg(long, value_name = "A", allow_negative_numbers = true, default_value = "0.03", value_parser = positive, help_heading = "Layers")]
    pub coat_alpha: f64,
    /// Surfaces with different seeds have different glints
    #[arg(long, value_name = "SEED", allow_negative_numbers = true, default_value = "1", help_heading = "Material")]
    pub seed: u32,
    /// Compress the pack's sections with Zstandard
    #[arg(long, help_heading = "Bake")]
    pub compress: bool,

    #[command(flatten)]
    pub run: RunFlags,
}

/// Distributions of slopes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// Beckmann
    Beckmann,
    /// GGX
    Ggx,
}

impl Args {
    /// Options of the bake.
    pub fn options(&self) -> GlintsOptions {
        GlintsOptions {
            slopes: match self.target {
                Target::Beckmann => Slopes::Beckmann,
                Target::Ggx => Slopes::Ggx,
            },
            alpha: self.alpha.map(|alpha| alpha as f32),
            turn: self.turn.to_radians(),
            f0: self.f0,
            density: self.density as f32,
            relative_area: self.relative_area,
            facet_spread: self.facet_spread.to_radians() as f32,
            sky_spread: self.sky_spread.to_radians(),
            colours: self.colour.clone(),
            seed: self.seed,
            diffuse: self.diffuse,
            coat: self.coat,
            coat_alpha: self.coat_alpha as f32,
        }
    }

    /// Where the pack goes.
    pub fn delivery(&self) -> Delivery<'_> {
        Delivery { output: &self.output, inputs: &[], run: &self.run }
    }

    /// Options for provenance. Flags that do not change the pack's contents are left out.
    pub fn option_list(&self) -> OptionList {
        let list = |numbers: &[f32]| numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(",");
        let mut options = OptionList::default();
        options.push("name", &self.name);
        options.push("target", name_of(&self.target));
        options.push("alpha", self.alpha.iter().map(f64::to_string).collect::<Vec<_>>().join(","));
        options.push("turn", self.turn);
        options.push("f0", list(&self.f0));
        options.push("density", self.density);
        options.push("relative-area", self.relative_area);
        options.push("facet-spread", self.facet_spread);
        options.push("sky-spread", self.sky_spread);
        options.push("diffuse", list(&self.diffuse));
        options.push("coat", self.coat);
        options.push("coat-alpha", self.coat_alpha);
        for colour in &self.colour {
            options.push("colour", list(colour));
        }
        options
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        args: Args,
    }

    #[test]
    fn the_flags_and_the_bake_have_the_same_defaults() {
        let cli = Cli::parse_from(["glints", "-o", "out.glintpack"]);
        let (found, expected) = (cli.args.options(), GlintsOptions::default());
        assert!((found.facet_spread - expected.facet_spread).abs() < 2e-6, "{}", found.facet_spread);
        assert_eq!(GlintsOptions { facet_spread: expected.facet_spread, ..found }, expected);
    }
}
