//! What all reports are told: where data lies, how much is measured, and what of it is the user's own.

use crate::cli::Terminal;
use crate::exit::{Exit, Failure};
use crate::input::environment::load_environment;
use crate::input::{ColourSpace, Crop, InputOptions, load_normal_map};
use glint_bake_core::environment::EnvironmentImage;
use glint_bake_core::normal_map::NormalMap;
use std::path::{Path, PathBuf};

/// Most bytes of an input.
const MAX_MEMORY: u64 = 4 << 30;

/// What all reports are told.
pub struct Settings {
    /// Folder of maps (`normals`, `tiny`) and environments (`hdri`).
    pub data: Option<PathBuf>,
    /// Folder that the documents go to, as the user wrote it.
    pub output: PathBuf,
    /// Few samples, so that every report takes less than a minute.
    pub quick: bool,
    /// Random footprints of each size; each report has a default of its own.
    pub footprints: Option<u32>,
    /// Small maps that the report of NDF maps measures in place of its own.
    pub maps: Vec<PathBuf>,
    /// How those maps are read.
    pub input: InputOptions,
    /// Frames of each view that the report of frame times measures.
    pub frames: Option<u32>,
    /// Pixels of those frames.
    pub size: Option<(u32, u32)>,
    /// Part of the name of the adapter that draws them.
    pub adapter: Option<String>,
    /// Where a report says what it is at.
    pub terminal: Terminal,
}

impl Settings {
    /// `usual`, or `quick` where a quick look is wanted.
    pub fn pick<T>(&self, usual: T, quick: T) -> T {
        if self.quick { quick } else { usual }
    }

    /// Random footprints of each size: those that the user asks for, else by the report.
    pub fn footprints(&self, usual: u32, quick: u32) -> u32 {
        self.footprints.unwrap_or(self.pick(usual, quick))
    }

    /// The command that measures the same again.
    pub fn command(&self, report: &str) -> String {
        let mut command = format!("glint-bake report {report}");
        let mut add = |flag: &str, value: Option<String>| {
            if let Some(value) = value {
                command.push_str(format!(" {flag} {value}").trim_end());
            }
        };
        if report == "ndf-maps" && !self.maps.is_empty() {
            let maps: Vec<String> = self.maps.iter().map(|path| path.display().to_string()).collect();
            add("--maps", Some(maps.join(" ")));
            add("--crop", self.input.crop.map(|crop| format!("{}x{}+{}+{}", crop.w, crop.h, crop.x, crop.y)));
            let colour_space = match self.input.colour_space {
                ColourSpace::Auto => None,
                ColourSpace::Linear => Some("linear".to_owned()),
                ColourSpace::Srgb => Some("srgb".to_owned()),
            };
            add("--colour-space", colour_space);
        }
        if report == "frames" {
            add("--frames", self.frames.map(|frames| frames.to_string()));
            add("--size", self.size.map(|(width, height)| format!("{width}x{height}")));
            add("--adapter", self.adapter.as_ref().map(|name| format!("'{name}'")));
        }
        if ["ndf-maps", "lobes", "surface"].contains(&report) {
            add("--footprints", self.footprints.map(|count| count.to_string()));
        }
        add("-o", Some(self.output.display().to_string()));
        if self.quick {
            command.push_str(" --quick");
        }
        command
    }

    /// Path of a file of the data folder.
    ///
    /// # Errors
    /// Input or output, when there is no such folder or no such file in it.
    pub fn data(&self, file: &str) -> Result<PathBuf, Failure> {
        let Some(data) = &self.data else {
            return Err(Failure::new(
                Exit::InputOutput,
                format!("needs {file} of a data folder, and none is named; give --data DIR or set GLINT_DATA"),
            ));
        };
        let path = data.join(file);
        match path.exists() {
            true => Ok(path),
            false => {
                Err(Failure::new(Exit::InputOutput, format!("{}: is not there; give another --data", path.display())))
            }
        }
    }

    /// Says whether all these files are in the data folder.
    pub fn check<'a>(&self, files: impl IntoIterator<Item = &'a str>) -> Result<(), Failure> {
        files.into_iter().try_for_each(|file| self.data(file).map(|_| ()))
    }

    /// A normal map of the data folder, or the part of it from its upper left corner of `edge` texels.
    pub fn normal_map(&self, file: &str, edge: Option<u32>) -> Result<NormalMap, Failure> {
        let crop = edge.map(|edge| Crop { x: 0, y: 0, w: edge, h: edge });
        self.normal_map_as(file, &InputOptions { crop, ..InputOptions::default() })
    }

    /// The same, read with these options.
    pub fn normal_map_as(&self, file: &str, options: &InputOptions) -> Result<NormalMap, Failure> {
        let options = InputOptions { colour_space: ColourSpace::Linear, ..options.clone() };
        Ok(load_normal_map(&self.data(file)?, &options)?.map)
    }

    /// An environment.
    pub fn environment(&self, path: &Path) -> Result<EnvironmentImage, Failure> {
        Ok(load_environment(path, None, MAX_MEMORY)?.image)
    }
}
