//! What an environment is asked to be, and which askings cannot work.

use super::image::EnvironmentImage;
use super::tree::{BLOCK_BYTES, CELL, REMEMBERED};
use crate::error::{BakeError, Result};
use glint_formats::environment::{Kernel, LevelChoice, MAX_FACE_SIZE, MAX_LEVELS, MAX_LOOK_UPS, MAX_PER_SIZE};

/// What a program holds before it bakes.
const PROGRAM_BYTES: u64 = 8 << 20;
/// Smallest edge of a face.
pub const MIN_FACE_SIZE: u32 = 4;
/// Below [`SHARP`](glint_formats::environment::SHARP) reads may have so many times the error.
pub const OF_SHARP_READS: f64 = 3.0;
/// Error of the filter that can be asked for; sums in single precision do not carry smaller ones.
pub const ERROR_RANGE: (f64, f64) = (1e-4, 0.2);
/// Edge of the smallest faces by default; coarser ones are too coarse for look-ups of rough lobes.
pub const DEFAULT_MIN_FACE_SIZE: u32 = 16;
/// Filtered roughnesses of each face size by default.
pub const DEFAULT_PER_SIZE: u32 = 4;
/// Darkest radiance that the paper's levels tell apart, by default.
pub const DEFAULT_FLOOR: f64 = 1e-3;

/// How many radiance levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LevelCount {
    /// So many, 1 to [`MAX_LEVELS`]. With one, every lit facet reflects the mean radiance.
    Exactly(u32),
    /// The fewest, 2 or more, whose mean relative error of the second moment is this or less.
    Fewest(f64),
}

/// Options of the environment bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentOptions {
    /// Edge of a face of the mirror, a power of two. Those of the least filtered roughnesses are half as large.
    pub face_size: u32,
    /// Edge of a face of the largest roughnesses, a power of two.
    pub min_face_size: u32,
    /// Filtered roughnesses of each face size, 1 to [`MAX_PER_SIZE`].
    pub per_size: u32,
    /// Look-ups that stand for the lobe of a surface seen at an angle, 1 to [`MAX_LOOK_UPS`].
    pub look_ups: u32,
    /// Radiance levels.
    pub levels: LevelCount,
    /// How they are chosen.
    pub level_choice: LevelChoice,
    /// Radiance below this is taken as this by the paper's choice of levels.
    pub floor: f64,
    /// Whether levels have colours of their own.
    pub coloured: bool,
    /// Root mean square error of the texels of every roughness over the mean, that the filter keeps.
    pub filter_error: f64,
    /// Root mean square of the relative errors of what is read at α of [`SHARP`](glint_formats::environment::SHARP) and above;
    /// [`OF_SHARP_READS`] times that below. A bake that misses it fails; none asks for none.
    pub max_error: Option<f64>,
    /// Filter.
    pub kernel: Kernel,
    /// Look-ups that are compared with sums over the source, and a sixteenth as many texels of every roughness.
    pub measured_reads: u32,
}

impl Default for EnvironmentOptions {
    fn default() -> EnvironmentOptions {
        EnvironmentOptions {
            face_size: 256,
            min_face_size: DEFAULT_MIN_FACE_SIZE,
            per_size: DEFAULT_PER_SIZE,
            look_ups: 1,
            levels: LevelCount::Exactly(4),
            level_choice: LevelChoice::Optimal,
            floor: DEFAULT_FLOOR,
            coloured: false,
            filter_error: 0.005,
            max_error: None,
            kernel: Kernel::GgxSoft,
            measured_reads: 128,
        }
    }
}

impl EnvironmentOptions {
    /// Number of filtered roughnesses.
    pub fn filtered(&self) -> u32 {
        (self.face_size.ilog2() - self.min_face_size.ilog2()) * self.per_size
    }

    /// Texels of the mirror, and of all filtered roughnesses of one of each face size.
    fn texels(&self) -> [u64; 2] {
        let of = |size: u32| 6 * u64::from(size).pow(2);
        let sizes = 1..=self.face_size.ilog2() - self.min_face_size.ilog2();
        [of(self.face_size), sizes.map(|step| of(self.face_size >> step)).sum()]
    }

    /// Checks what can be checked without an image.
    ///
    /// # Errors
    /// [`BakeError::BadOption`] names the option, what was expected and what was found.
    pub fn validate(&self) -> Result<()> {
        let size = self.face_size;
        if !(size.is_power_of_two() && (MIN_FACE_SIZE..=MAX_FACE_SIZE).contains(&size)) {
            return bad(format!(
                "face-size: expected a power of two, {MIN_FACE_SIZE} to {MAX_FACE_SIZE}, found {size}"
            ));
        }
        let least = self.min_face_size;
        if !(least.is_power_of_two() && least < size) {
            return bad(format!("min-face-size: expected a power of two below {size}, found {least}"));
        }
        if !(1..=MAX_PER_SIZE).contains(&self.per_size) {
            return bad(format!("roughnesses: expected 1 to {MAX_PER_SIZE} of a face size, found {}", self.per_size));
        }
        if !(1..=MAX_LOOK_UPS as u32).contains(&self.look_ups) {
            return bad(format!("look-ups: expected 1 to {MAX_LOOK_UPS}, found {}", self.look_ups));
        }
        match self.levels {
            LevelCount::Exactly(count) if !(1..=MAX_LEVELS as u32).contains(&count) => {
                return bad(format!("levels: expected 1 to {MAX_LEVELS}, or auto, found {count}"));
            }
            LevelCount::Fewest(error) if !(error > 0.0 && error.is_finite()) => {
                return bad(format!("max-moment-error: expected a number above 0, found {error}"));
            }
            _ => {}
        }
        if self.coloured && self.levels == LevelCount::Exactly(1) {
            return bad("coloured: expected two levels or more, which have colours of their own, found one".into());
        }
        if matches!(self.levels, LevelCount::Fewest(_)) && self.level_choice == LevelChoice::LogUniform {
            return bad(
                "level-choice: expected optimal levels where their number is automatic, found log-uniform ones".into(),
            );
        }
        let (low, high) = ERROR_RANGE;
        if !(low..=high).contains(&self.filter_error) {
            return bad(format!("filter-error: expected {low} to {high}, found {}", self.filter_error));
        }
        if let Some(error) = self.max_error {
            if !(error > 0.0 && error.is_finite()) {
                return bad(format!("max-error: expected a number above 0, found {error}"));
            }
            if self.measured_reads == 0 {
                return bad("max-error: expected look-ups to measure it by, found none".into());
            }
        }
        if !(self.floor > 0.0 && self.floor.is_finite()) {
            return bad(format!("floor: expected a radiance above 0, found {}", self.floor));
        }
        Ok(())
    }

    /// Largest number of levels that these options may lead to.
    fn most_levels(&self) -> u64 {
        match self.levels {
            LevelCount::Exactly(count) => u64::from(count),
            LevelCount::Fewest(_) => MAX_LEVELS as u64,
        }
    }

    /// Bytes of the finished textures, at most.
    pub fn texture_bytes(&self) -> u64 {
        let [mirror, filtered] = self.texels();
        let levels = self.most_levels() - 1;
        let colours = if self.coloured { 4 * levels } else { 0 };
        8 * mirror + filtered * (8 * u64::from(self.per_size) * (1 + levels.div_ceil(4)) + colours)
    }

    /// Bytes that a program holds at most while it bakes `image` on so many threads, the image among them; within a fifth.
    ///
    /// Most is held while the last roughness of the largest filtered faces is made: the image, the tree of its cells, radiance of all
    /// roughnesses in f64 (its factor depends on all of them), rounded indicators and colours, and that roughness with all channels,
    /// twice.
    pub fn working_bytes(&self, image: &EnvironmentImage, threads: u64) -> u64 {
        let pixels = image.pixels.len() as u64;
        let levels = self.most_levels() - 1;
        let channels = (4 + levels * if self.coloured { 4 } else { 1 }).next_multiple_of(4);
        let block = BLOCK_BYTES + 4 * channels;
        // Blocks are halved until they are no larger than a cell.
        let parts = pixels * u64::from(self.division(image)).pow(2);
        let cells = parts.div_ceil(u64::from(CELL)).next_power_of_two();
        let [mirror, filtered] = self.texels();
        let radiance = 8 * (mirror + u64::from(self.per_size) * filtered);
        let light = 4 * radiance;
        let filtered = 2 * 8 * channels * mirror / 4;
        // Then radiance is rounded; where a sun needs a factor of its own, the brightest texels are sorted.
        let rounded = radiance + 16 * mirror;
        let walk = 2 * REMEMBERED as u64 * block;
        PROGRAM_BYTES
            + 12 * pixels
            + 2 * cells * block
            + light
            + (self.texture_bytes() - radiance)
            + filtered.max(rounded)
            + threads * walk
    }

    /// In how many parts a side pixels are divided for the filter, so that they are no wider than half a texel of the
    /// mirror's equator. What the image says stays the same.
    pub fn division(&self, image: &EnvironmentImage) -> u32 {
        (4 * self.face_size).div_ceil(image.width)
    }
}

fn bad(message: String) -> Result<()> {
    Err(BakeError::BadOption(message))
}
