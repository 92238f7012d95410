//! What subcommands that bake normal maps share: flags of how maps are read, names of materials, digests of inputs.

use super::option_list::OptionList;
use super::values;
use crate::exit::Failure;
use crate::input::{Channels, ColourSpace, Crop, InputOptions};
use crate::reading;
use clap::ValueEnum;
use glint_bake_core::normal_map::GreenAxis;
use glint_formats::Wrap;
use glint_formats::container::MAX_NAME_BYTES;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// How normal maps are read.
#[derive(clap::Args, Clone, Debug)]
pub struct InputFlags {
    /// Use only this part of each map
    #[arg(long, value_name = "WxH+X+Y", value_parser = values::crop, help_heading = "Input")]
    pub crop: Option<Crop>,
    /// Which way green points: up (OpenGL) or down (DirectX)
    #[arg(long, value_name = "AXIS", default_value = "up", help_heading = "Input")]
    pub normal_y: NormalY,
    /// What lies beyond a map's edge
    #[arg(long, value_name = "WRAP", default_value = "repeat", help_heading = "Input")]
    pub wrap: WrapArg,
    /// Channels that hold the normal: xyz, or those of x and y, of which z is computed [default: xyz where the data agree]
    ///
    /// Without it, maps of two channels and object-space maps are recognised and refused; given, the map is not doubted.
    #[arg(long, value_name = "CHANNELS", help_heading = "Input")]
    pub channels: Option<ChannelsArg>,
    /// Read height maps; SCALE is the height of white in texels
    #[arg(long, value_name = "SCALE", value_parser = values::non_zero, allow_negative_numbers = true, help_heading = "Input")]
    pub height: Option<f32>,
    /// Layer of EXR maps to read, by name; '' is the unnamed one [default: the one that fits]
    #[arg(long, value_name = "NAME", help_heading = "Input")]
    pub layer: Option<String>,
    /// How stored values are decoded: as the data and the file's tag say, not at all, or by the sRGB curve
    #[arg(long, value_name = "SPACE", default_value = "auto", help_heading = "Input")]
    pub colour_space: ColourSpaceArg,
    /// The same as --colour-space linear
    #[arg(long, conflicts_with = "colour_space", help_heading = "Input")]
    pub assume_linear: bool,
}

/// Which way green points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)] // The flag's help says it.
pub enum NormalY {
    Up,
    Down,
}

/// What lies beyond the edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)] // The flag's help says it.
pub enum WrapArg {
    Repeat,
    Clamp,
}

/// Which channels hold the normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)] // The flag's help says it.
pub enum ChannelsArg {
    Xyz,
    #[value(alias = "rg")]
    Xy,
    #[value(alias = "gr")]
    Yx,
    #[value(alias = "wy")]
    Ag,
    #[value(alias = "yw")]
    Ga,
    #[value(alias = "xw")]
    Ra,
    #[value(alias = "wx")]
    Ar,
}

/// How stored values are decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)] // The flag's help says it.
pub enum ColourSpaceArg {
    Auto,
    Linear,
    Srgb,
}

impl From<NormalY> for GreenAxis {
    fn from(axis: NormalY) -> GreenAxis {
        match axis {
            NormalY::Up => GreenAxis::Up,
            NormalY::Down => GreenAxis::Down,
        }
    }
}

impl From<WrapArg> for Wrap {
    fn from(wrap: WrapArg) -> Wrap {
        match wrap {
            WrapArg::Repeat => Wrap::Repeat,
            WrapArg::Clamp => Wrap::Clamp,
        }
    }
}

impl From<ChannelsArg> for Channels {
    fn from(channels: ChannelsArg) -> Channels {
        match channels {
            ChannelsArg::Xyz => Channels::Xyz,
            ChannelsArg::Xy => Channels::Xy,
            ChannelsArg::Yx => Channels::Yx,
            ChannelsArg::Ag => Channels::Ag,
            ChannelsArg::Ga => Channels::Ga,
            ChannelsArg::Ra => Channels::Ra,
            ChannelsArg::Ar => Channels::Ar,
        }
    }
}

impl ColourSpaceArg {
    /// The same for the reader; `--assume-linear` is another name of `linear`.
    pub fn or_linear(self, assume_linear: bool) -> ColourSpace {
        match self {
            _ if assume_linear => ColourSpace::Linear,
            ColourSpaceArg::Auto => ColourSpace::Auto,
            ColourSpaceArg::Linear => ColourSpace::Linear,
            ColourSpaceArg::Srgb => ColourSpace::Srgb,
        }
    }
}

impl InputFlags {
    /// The same for the reader, with a limit in bytes.
    pub fn options(&self, max_memory: u64) -> InputOptions {
        InputOptions {
            y: self.normal_y.into(),
            wrap: self.wrap.into(),
            channels: self.channels.map(Channels::from),
            height: self.height,
            crop: self.crop,
            colour_space: self.colour_space.or_linear(self.assume_linear),
            layer: self.layer.clone(),
            max_memory,
            ..InputOptions::default()
        }
    }

    /// Options for provenance; those that say how a particular map is read only where they were given.
    pub fn option_list(&self) -> OptionList {
        let mut options = OptionList::default();
        options.push_choice("normal-y", &self.normal_y);
        options.push_choice("wrap", &self.wrap);
        options.push_choice("channels", &self.channels.unwrap_or(ChannelsArg::Xyz));
        if let Some(crop) = self.crop {
            options.push("crop", values::crop_text(crop));
        }
        if let Some(scale) = self.height {
            options.push("height", scale);
        }
        if let Some(layer) = &self.layer {
            options.push("layer", layer);
        }
        match self.colour_space.or_linear(self.assume_linear) {
            ColourSpace::Auto => {}
            ColourSpace::Linear => options.push_choice("colour-space", &ColourSpaceArg::Linear),
            ColourSpace::Srgb => options.push_choice("colour-space", &ColourSpaceArg::Srgb),
        }
        options
    }

    /// Which way green points, for provenance.
    pub fn normal_convention(&self) -> String {
        format!("y-{}", values::name_of(&self.normal_y))
    }
}

/// Whether a material can have this name.
///
/// # Errors
/// A usage failure that says what a name may be.
pub fn check_name(name: &str) -> Result<(), Failure> {
    if name.is_empty() || name.len() > MAX_NAME_BYTES || name.chars().any(char::is_control) {
        return Err(Failure::usage(format!(
            "--name: expected 1 to {MAX_NAME_BYTES} bytes without control characters, found {name:?}"
        )));
    }
    Ok(())
}

/// Names of materials that are given out, each once.
#[derive(Debug, Default)]
pub struct Names {
    taken: HashSet<String>,
    /// The number that a stem had last, so that thousands of equal stems are not tried anew.
    numbers: HashMap<String, u32>,
}

impl Names {
    /// Takes a name; false when it is taken already.
    pub fn take(&mut self, name: &str) -> bool {
        self.taken.insert(name.to_owned())
    }

    /// The stem of a file's name, with a number when that is taken.
    pub fn of_file(&mut self, path: &Path) -> String {
        let stem = stem_of(path);
        let mut name = cut(&stem, "");
        let number = self.numbers.entry(stem.clone()).or_insert(1);
        while !self.taken.insert(name.clone()) {
            *number += 1;
            name = cut(&stem, &format!("-{number}"));
        }
        name
    }
}

/// Name of the one material of a file.
pub fn name_of_file(path: &Path) -> String {
    Names::default().of_file(path)
}

fn stem_of(path: &Path) -> String {
    let file = reading::file_name(path);
    let stem = Path::new(&file).file_stem().unwrap_or_default().to_string_lossy();
    stem.chars().map(|c| if c.is_control() { '_' } else { c }).collect()
}

/// The stem, shortened so that it fits a name together with `suffix`.
fn cut(stem: &str, suffix: &str) -> String {
    let mut end = stem.len().min(MAX_NAME_BYTES - suffix.len());
    while !stem.is_char_boundary(end) {
        end -= 1;
    }
    format!("{}{suffix}", &stem[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_unique_and_fit() {
        let mut names = Names::default();
        assert!(names.take("a-2"));
        let of = |names: &mut Names, path: &str| names.of_file(Path::new(path));
        assert_eq!(of(&mut names, "x/a.png"), "a");
        assert_eq!(of(&mut names, "y/a.exr"), "a-3");
        assert!(!names.take("a-3"));
        let long = format!("{}.png", "é".repeat(60));
        assert!(of(&mut names, &long).len() <= MAX_NAME_BYTES);
        assert!(of(&mut names, &long).ends_with("-2"));
        assert_eq!(name_of_file(Path::new("-")), "stdin");
        // Equal names in great number take no longer each.
        for number in 2..100_000 {
            names.of_file(Path::new("same.png"));
            assert!(number < 99_999 || of(&mut names, "same.png") == "same-99999");
        }
    }
}
