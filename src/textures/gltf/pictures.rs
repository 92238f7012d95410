//! The images of a pair of textures: what a job reads, bakes and encodes.

use super::jobs::Job;
use super::rewrite::{Baked, Basisu, NewImage, Picture, Pictures};
use crate::cli::Terminal;
use crate::exit::{Exit, Failure};
use crate::gltf::source::Source;
use crate::input::{Channels, ColourSpace, InputOptions, normal_map_of, scalar_map_of};
use crate::progress::Stages;
use crate::textures::args::Args;
use crate::textures::encode::{Format, Layout, Plan};
use crate::textures::gltf_flags::GltfImages;
use crate::textures::material::Material;
use crate::textures::target::{Channel, Stored, Target};
use crate::textures::texels::Texels;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::textures::levels::sizes;
use glint_bake_core::textures::{self, Roughness, TexturesOptions};
use std::path::{Path, PathBuf};

/// Texels of a level by number, each value 0 to 1.
type Value<'a> = &'a (dyn Fn(usize, usize) -> [f32; 4] + Sync);

/// What images are made with.
pub struct Making<'a> {
    /// The glTF file, for messages.
    pub path: &'a Path,
    pub args: &'a Args,
    pub source: &'a Source<'a>,
    pub terminal: Terminal,
}

impl Making<'_> {
    /// The textures of a job.
    ///
    /// # Errors
    /// An image that can't be read, is too large or is no map of its kind.
    pub fn of(&self, job: &Job) -> Result<Baked, Failure> {
        let (map, alpha) = self.normal_map(job)?;
        let material = Material { alpha, ..self.material(job, &map)? };
        let label = label(job.normal);
        let options = TexturesOptions { max_memory: self.args.max_memory, ..TexturesOptions::default() };
        options.check(&map).map_err(|e| self.named(Failure::bake(&label, &e)))?;
        let stages = Stages::new(self.terminal);
        let baked = textures::bake(&map, &material.roughness, &options, &stages)
            .map_err(|e| self.named(Failure::bake(&label, &e)))?;
        let texels = Texels::new(&map, &material, &baked.levels, self.args.target);
        let channels = [Channel::Occlusion, Channel::Roughness, Channel::Metallic, Channel::One];
        // Level 0 of what was not multiplied is the image that is there.
        let unchanged = |image: Option<usize>, factor: f64| image.filter(|_| factor == 1.0);
        Ok(Baked {
            normal: self.pictures(
                (&map, material.alpha.is_none()),
                unchanged(Some(job.normal), job.scale),
                &|level, k| texels.normal(level, k, false),
            )?,
            roughness: self.pictures((&map, true), unchanged(job.map, job.roughness), &|level, k| {
                texels.channels(&channels, Stored::Perceptual, level, k)
            })?,
        })
    }

    /// A failure of an image as one of the file.
    fn named(&self, failure: Failure) -> Failure {
        Failure::new(failure.exit, format!("{}: {}", self.path.display(), failure.message))
    }

    fn read(&self, image: usize) -> Result<Vec<u8>, Failure> {
        self.source.image(image).map_err(|fault| fault.at(self.path))
    }

    fn warn(&self, label: &Path, warnings: &[String]) {
        for warning in warnings {
            self.terminal.warn(&format!("{}: {}: {warning}", self.path.display(), label.display()));
        }
    }

    /// The normals, with their scale: the specification multiplies x and y before it makes the length 1 again. And their alpha, where
    /// it is there and kept.
    fn normal_map(&self, job: &Job) -> Result<(NormalMap, Option<Vec<f32>>), Failure> {
        let label = label(job.normal);
        let options = InputOptions {
            wrap: job.wrap,
            channels: Some(Channels::Xyz),
            colour_space: ColourSpace::Linear,
            max_memory: self.args.max_memory,
            alpha: self.args.alpha_use(),
            ..InputOptions::default()
        };
        let loaded =
            normal_map_of(&label, &self.read(job.normal)?, &options).map_err(|error| self.named(error.into()))?;
        self.warn(&label, &loaded.warnings);
        let mut map = loaded.map;
        if job.scale != 1.0 {
            let scale = job.scale as f32;
            for [x, y] in &mut map.projected {
                let z2 = (1.0 - *x * *x - *y * *y).max(0.0);
                let (scaled_x, scaled_y) = (*x * scale, *y * scale);
                let length = (scaled_x * scaled_x + scaled_y * scaled_y + z2).sqrt();
                // Only a normal at the horizon that is scaled to nothing has none.
                (*x, *y) = if length > 0.0 { (scaled_x / length, scaled_y / length) } else { (0.0, 0.0) };
            }
        }
        Ok((map, loaded.alpha))
    }

    /// Roughness, and what the map's other channels hold.
    fn material(&self, job: &Job, map: &NormalMap) -> Result<Material, Failure> {
        let roughness = job.roughness as f32;
        let Some(image) = job.map else { return Ok(Material::constant(Roughness::Constant(roughness))) };
        let (label, bytes) = (label(image), self.read(image)?);
        let mut warnings = Vec::new();
        let mut channel = |column: usize| -> Result<Vec<f32>, Failure> {
            let loaded = scalar_map_of(&label, &bytes, Some(column), "", None, self.args.max_memory)
                .map_err(|error| self.named(error.into()))?;
            let loaded = loaded.resized((map.width, map.height), map.wrap);
            warnings = loaded.warnings;
            Ok(loaded.values)
        };
        let [occlusion, mut green, metallic] = [channel(0)?, channel(1)?, channel(2)?];
        self.warn(&label, &warnings);
        green.iter_mut().for_each(|value| *value *= roughness);
        Ok(Material {
            occlusion: Some(occlusion),
            metallic: Some(metallic),
            ..Material::constant(Roughness::Map(green))
        })
    }

    /// A texture, whose alpha is 1 everywhere where it is opaque; `kept` where its level 0 is an image of the file.
    fn pictures(
        &self,
        (map, opaque): (&NormalMap, bool),
        kept: Option<usize>,
        value: Value<'_>,
    ) -> Result<Pictures, Failure> {
        let all = sizes(map.width, map.height);
        let most = self.args.gltf.max_size.unwrap_or(u32::MAX);
        // The last level has one texel, and so is small enough.
        let first = all.iter().position(|(width, height)| (*width).max(*height) <= most).unwrap_or(all.len() - 1);
        let value = |level: usize, k: usize| value(level + first, k);
        let plan = Plan { name: String::new(), channels: 4, opaque, size: all[first] };
        let layout = Layout { format: Format::Ktx2, bits: 8, zstd: self.args.zstd, blocks: false };
        let needed = layout.payload_bytes(&plan);
        if needed > self.args.max_memory {
            let (limit, path) = (self.args.max_memory, self.path.display());
            let what = format!("{path}: a texture has {needed} bytes, the limit is {limit}; raise --max-memory");
            return Err(Failure::new(Exit::LimitExceeded, what));
        }
        let png = || Picture::New(NewImage { bytes: layout.png(&plan, 0, plan.size, &value), mime: "image/png" });
        let still = || kept.filter(|_| first == 0).map_or_else(png, Picture::Kept);
        let ktx2 = || -> Result<NewImage, Failure> {
            Ok(NewImage { bytes: layout.encode(&plan, &value)?.swap_remove(0), mime: "image/ktx2" })
        };
        Ok(match (self.args.gltf.images(), self.args.target) {
            (GltfImages::Png, _) => Pictures { source: Some(still()), basisu: None },
            // Bevy knows KTX2, and no extension that names it.
            (_, Target::Bevy) => Pictures { source: Some(Picture::New(ktx2()?)), basisu: Some(Basisu::Source) },
            (GltfImages::Ktx2, _) => Pictures { source: Some(still()), basisu: Some(Basisu::Own(ktx2()?)) },
            (GltfImages::Ktx2Only, _) => Pictures { source: None, basisu: Some(Basisu::Own(ktx2()?)) },
        })
    }
}

/// How messages call an image, after the file.
fn label(image: usize) -> PathBuf {
    PathBuf::from(format!("image {image}"))
}
