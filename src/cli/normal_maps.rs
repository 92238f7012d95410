//! What subcommands that bake normal maps share: flags of how maps are read, names of materials, digests of inputs.

use super::option_list::OptionList;
use super::values;
use crate::exit::Failure;
use crate::input::{Channels, Crop, InputOptions};
use clap::ValueEnum;
use glint_bake_core::normal_map::GreenAxis;
use glint_formats::Wrap;
use glint_formats::container::MAX_NAME_BYTES;
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
    /// Channels that hold the normal; xy computes z
    #[arg(long, value_name = "CHANNELS", default_value = "xyz", help_heading = "Input")]
    pub channels: ChannelsArg,
    /// Read height maps; SCALE is the height of white in texels
    #[arg(long, value_name = "SCALE", value_parser = values::non_zero, allow_negative_numbers = true, help_heading = "Input")]
    pub height: Option<f32>,
    /// Layer of EXR maps to read, by name; '' is the unnamed one [default: the one that fits]
    #[arg(long, value_name = "NAME", help_heading = "Input")]
    pub layer: Option<String>,
    /// Take the values of files tagged as sRGB as they are
    #[arg(long, help_heading = "Input")]
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
    Xy,
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
        }
    }
}

impl InputFlags {
    /// The same for the reader, with a limit in bytes.
    pub fn options(&self, max_memory: u64) -> InputOptions {
        InputOptions {
            y: self.normal_y.into(),
            wrap: self.wrap.into(),
            channels: self.channels.into(),
            height: self.height,
            crop: self.crop,
            assume_linear: self.assume_linear,
            layer: self.layer.clone(),
            max_memory,
        }
    }

    /// Options for provenance; those that say how a particular map is read only where they were given.
    pub fn option_list(&self) -> OptionList {
        let mut options = OptionList::default();
        options.push_choice("normal-y", &self.normal_y);
        options.push_choice("wrap", &self.wrap);
        options.push_choice("channels", &self.channels);
        if let Some(crop) = self.crop {
            options.push("crop", values::crop_text(crop));
        }
        if let Some(scale) = self.height {
            options.push("height", scale);
        }
        if let Some(layer) = &self.layer {
            options.push("layer", layer);
        }
        if self.assume_linear {
            options.push("assume-linear", true);
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

/// The stem of a file's name, with a number when that is taken.
pub fn unique_name(path: &Path, taken: &[String]) -> String {
    let stem: String = path.file_stem().unwrap_or_default().to_string_lossy().chars().collect();
    let stem: String = stem.chars().map(|c| if c.is_control() { '_' } else { c }).collect();
    let mut number = 1;
    let mut name = cut(&stem, "");
    while taken.contains(&name) {
        number += 1;
        name = cut(&stem, &format!("-{number}"));
    }
    name
}

/// The stem, shortened so that it fits a name together with `suffix`.
fn cut(stem: &str, suffix: &str) -> String {
    let mut end = stem.len().min(MAX_NAME_BYTES - suffix.len());
    while !stem.is_char_boundary(end) {
        end -= 1;
    }
    format!("{}{suffix}", &stem[..end])
}
