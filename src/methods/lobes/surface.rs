//! Flags of `glint-bake lobes` that turn a map into a surface of patches, and the normal map of that surface.

use crate::canvas::Canvas;
use crate::cli::OptionList;
use crate::cli::values::{self, SurfaceSize};
use crate::exit::Failure;
use crate::output;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::surface::{ALIGNMENT, Surface};
use glint_bake_core::synthesis::{SynthesisOptions, Target, assemble};
use std::path::{Path, PathBuf};

/// Edges of patches and of tiles by default, and how far they overlap.
const PATCHES: (u32, u32) = (64, 8);
const TILES: (u32, u32) = (96, 6);
/// Most texels of a normal map that is written, as of a surface of 16384 texels a side.
const MOST_TEXELS: u64 = 16_384 * 16_384;
/// Rows of the surface that are assembled at a time.
const ROWS: u32 = 64;

/// What the map is made into.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Synthesis")]
pub struct SurfaceFlags {
    /// Make a large surface of patches of the map: of this size in texels, or `unbounded`
    ///
    /// A size repeats without a seam after whole patches; an unbounded surface, of corner tiles, has no end and no
    /// period.
    #[arg(long, value_name = "WxH", value_parser = values::surface_size)]
    pub synthesize: Option<SurfaceSize>,
    /// Edge of a patch in texels, a multiple of 16 [default: 64; unbounded 96]
    ///
    /// The map must be as large, and with --wrap clamp larger by the overlap rounded up to 16.
    #[arg(long, value_name = "TEXELS", requires = "synthesize")]
    pub patch: Option<u32>,
    /// Texels over which patches overlap [default: 8; unbounded 6]
    ///
    /// 0 to 64, and at most half a patch.
    #[arg(long, value_name = "TEXELS", requires = "synthesize")]
    pub overlap: Option<u32>,
    /// Weight of normals against Jacobians where patches are compared, 0 to 1 [default: 0.9]
    #[arg(long, value_name = "ALPHA", requires = "synthesize")]
    pub alpha: Option<f64>,
    /// Difference along a seam up to which a patch is as good as any, in units of that of neighbouring texels
    /// [default: 0.02]
    ///
    /// Of corner tiles it is the difference over an overlap.
    #[arg(long, value_name = "ERROR", requires = "synthesize")]
    pub error_tolerance: Option<f64>,
    /// Corner colours of an unbounded surface, 1 to 4 [default: 4]
    ///
    /// N colours make N⁴ kinds of tiles.
    #[arg(long, value_name = "N", requires = "synthesize")]
    pub colours: Option<u32>,
    /// Tiles for the same four colours of an unbounded surface, 1 to 16 [default: 2]
    #[arg(long, value_name = "N", requires = "synthesize")]
    pub variants: Option<u32>,
    /// Write the surface as an explicit normal map as well, to look at: PNG, green up
    #[arg(long, value_name = "PNG", requires = "synthesize")]
    pub write_normal_map: Option<PathBuf>,
    /// Size of that normal map [default: the surface's; an unbounded surface needs one]
    ///
    /// It begins at the surface's first texel.
    #[arg(long, value_name = "WxH", value_parser = values::size, requires = "write_normal_map")]
    pub normal_map_size: Option<(u32, u32)>,
}

impl SurfaceFlags {
    /// Options of the synthesis that is asked for.
    ///
    /// # Errors
    /// A usage error names the flag, what was found and what would work.
    pub fn options(&self, seed: u64) -> Result<Option<SynthesisOptions>, Failure> {
        let Some(size) = self.synthesize else { return Ok(None) };
        let usual = SynthesisOptions::default();
        let (target, (patch, overlap)) = match size {
            SurfaceSize::Texels(width, height) => (Target::Patches { width, height }, PATCHES),
            SurfaceSize::Unbounded => {
                (Target::Unbounded { colours: self.colours.unwrap_or(4), variants: self.variants.unwrap_or(2) }, TILES)
            }
        };
        let options = SynthesisOptions {
            target,
            patch: self.patch.unwrap_or(patch),
            overlap: self.overlap.unwrap_or(overlap),
            alpha: self.alpha.unwrap_or(usual.alpha),
            error_tolerance: self.error_tolerance.unwrap_or(usual.error_tolerance),
            alignment: ALIGNMENT,
            seed,
            ..usual
        };
        if !options.patch.is_multiple_of(ALIGNMENT) || options.patch == 0 {
            let found = options.patch;
            return Err(Failure::usage(format!("--patch: expected a multiple of {ALIGNMENT} texels, found {found}")));
        }
        if let SurfaceSize::Texels(..) = size {
            for (flag, given) in [("--colours", self.colours), ("--variants", self.variants)] {
                if given.is_some() {
                    return Err(Failure::usage(format!("{flag}: is for --synthesize unbounded only; leave it out")));
                }
            }
        }
        if self.write_normal_map.is_some() {
            let (width, height) = self.normal_map_size()?;
            if u64::from(width) * u64::from(height) > MOST_TEXELS {
                return Err(Failure::usage(format!(
                    "--write-normal-map: a map of {width} x {height} has more than {MOST_TEXELS} texels; write a part of the \
                     surface with --normal-map-size"
                )));
            }
        }
        Ok(Some(options))
    }

    /// The surface's size in words.
    pub fn size_text(&self) -> String {
        match self.synthesize {
            Some(SurfaceSize::Texels(width, height)) => format!("surface of {width} × {height} texels"),
            _ => "surface without end".to_owned(),
        }
    }

    fn normal_map_size(&self) -> Result<(u32, u32), Failure> {
        match (self.normal_map_size, self.synthesize) {
            (Some(size), _) => Ok(size),
            (None, Some(SurfaceSize::Texels(width, height))) => Ok((width, height)),
            _ => Err(Failure::usage(
                "--write-normal-map: an unbounded surface has no size; give one with --normal-map-size WxH",
            )),
        }
    }

    /// Says whether the normal map can be written, before any work.
    pub fn check_writable(&self, outputs: &[&Path], inputs: &[&Path]) -> Result<(), Failure> {
        let Some(path) = &self.write_normal_map else { return Ok(()) };
        let mut all = outputs.to_vec();
        all.push(path);
        output::check_distinct(&all, inputs)?;
        output::check_writable(path)
    }

    /// Writes the surface's normal map if that is asked for; `sample` is what it was baked from.
    pub fn write_normal_map(&self, surface: &Surface, sample: &NormalMap) -> Result<(), Failure> {
        let Some(path) = &self.write_normal_map else { return Ok(()) };
        let (width, height) = self.normal_map_size()?;
        let mut picture = Canvas { width, height, pixels: Vec::with_capacity(3 * width as usize * height as usize) };
        for row in (0..height).step_by(ROWS as usize) {
            let rows = ROWS.min(height - row);
            let piece = assemble(&surface.synthesis, sample, (0, row as i32), (width, rows))
                .map_err(|e| Failure::bake(path, &e))?;
            picture.pixels.extend(piece.projected.iter().flat_map(|&[x, y]| {
                let z = (1.0 - x * x - y * y).max(0.0).sqrt();
                [x, y, z].map(|v| (127.5 * v + 127.5).round() as u8)
            }));
        }
        output::write(path, &picture.to_png()).map(|_| ())
    }

    /// Options for provenance, as they were used: the flags that change the pack's bytes.
    pub fn option_list(&self, used: &SynthesisOptions) -> OptionList {
        let mut options = OptionList::default();
        let size = match used.target {
            Target::Patches { width, height } => SurfaceSize::Texels(width, height),
            Target::Unbounded { .. } => SurfaceSize::Unbounded,
        };
        options.push("synthesize", values::surface_size_text(size));
        options.push("patch", used.patch);
        options.push("overlap", used.overlap);
        options.push("alpha", used.alpha);
        options.push("error-tolerance", used.error_tolerance);
        if let Target::Unbounded { colours, variants } = used.target {
            options.push("colours", colours);
            options.push("variants", variants);
        }
        options
    }
}
