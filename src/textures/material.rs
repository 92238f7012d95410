//! The material that a normal map belongs to: its roughness, occlusion and metallic, at the size of the normal map.

use super::args::Args;
use super::target::Stored;
use crate::cli::Terminal;
use crate::exit::Failure;
use crate::input::{LoadedScalar, load_scalar_map};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::textures::Roughness;
use glint_bake_core::textures::levels::{shares, sizes};
use glint_formats::provenance::InputDigest;
use rayon::prelude::*;
use std::path::Path;

/// A material.
pub struct Material {
    /// Perceptual.
    pub roughness: Roughness,
    /// One value a texel; 1 everywhere without.
    pub occlusion: Option<Vec<f32>>,
    /// One value a texel; 1 everywhere without.
    pub metallic: Option<Vec<f32>>,
    /// Alpha of the normals, one value a texel; 1 everywhere without.
    pub alpha: Option<Vec<f32>>,
    /// Digests of the files that were read.
    pub digests: Vec<InputDigest>,
    /// What was noticed.
    pub warnings: Vec<String>,
}

/// Levels of a map that are averaged; 1 everywhere without one.
pub struct Averaged<'a> {
    finest: Option<&'a [f32]>,
    levels: Vec<Vec<f32>>,
}

impl Averaged<'_> {
    /// Texel k of a level.
    pub fn value(&self, level: usize, k: usize) -> f32 {
        match (self.finest, level) {
            (None, _) => 1.0,
            (Some(finest), 0) => finest[k],
            _ => self.levels[level - 1][k],
        }
    }
}

impl Material {
    /// A material without other maps.
    pub fn constant(roughness: Roughness) -> Material {
        Material { roughness, occlusion: None, metallic: None, alpha: None, digests: Vec::new(), warnings: Vec::new() }
    }

    /// Loads what the flags name. `alpha` is that of the normal map, where it was asked for.
    ///
    /// # Errors
    /// Those of [`load_scalar_map`].
    pub fn load(
        args: &Args,
        map: &NormalMap,
        alpha: Option<Vec<f32>>,
        terminal: Terminal,
    ) -> Result<Material, Failure> {
        let roughness = perceptual(args.roughness_is, args.roughness_value());
        let mut material = Material::constant(Roughness::Constant(roughness));
        let mut load =
            |path: &Path, channel: Option<super::args::ChannelArg>, flag: &str| -> Result<Vec<f32>, Failure> {
                let column = channel.map(|channel| channel as usize);
                let loaded = load_scalar_map(path, column, flag, args.input.crop, args.max_memory)?;
                let LoadedScalar { values, digest, warnings, .. } = loaded.resized((map.width, map.height), map.wrap);
                for warning in &warnings {
                    terminal.warn(&format!("{}: {warning}", path.display()));
                }
                material.warnings.extend(warnings.iter().map(|warning| format!("{}: {warning}", digest.name)));
                material.digests.push(digest);
                Ok(values)
            };
        let (kept, of_alpha) = if args.keeps_alpha() { (alpha, None) } else { (None, alpha) };
        let roughness = match &args.roughness_map {
            Some(path) => Some(load(path, args.roughness_channel, "--roughness-channel")?),
            None => of_alpha,
        };
        let occlusion = args.occlusion.as_ref().map(|path| load(path, args.occlusion_channel, "--occlusion-channel"));
        let occlusion = occlusion.transpose()?;
        let metallic = args.metallic.as_ref().map(|path| load(path, args.metallic_channel, "--metallic-channel"));
        let metallic = metallic.transpose()?;
        if let Some(mut values) = roughness {
            values.iter_mut().for_each(|value| *value = perceptual(args.roughness_is, *value));
            material.roughness = Roughness::Map(values);
        }
        Ok(Material { occlusion, metallic, alpha: kept, ..material })
    }

    /// Averages of a map over the texels of every level.
    pub fn levels<'a>(&self, finest: Option<&'a [f32]>, (width, height): (u32, u32)) -> Averaged<'a> {
        let Some(values) = finest else { return Averaged { finest, levels: Vec::new() } };
        let levels = sizes(width, height).into_iter().skip(1);
        let levels = levels.map(|size| averaged(values, (width, height), size)).collect();
        Averaged { finest, levels }
    }
}

/// Perceptual roughness of a stored value.
fn perceptual(stored: Stored, value: f32) -> f32 {
    match stored {
        Stored::Perceptual => value,
        Stored::Alpha => value.sqrt(),
        Stored::Smoothness => 1.0 - value,
    }
}

fn averaged(values: &[f32], (width, height): (u32, u32), (coarse_width, coarse_height): (u32, u32)) -> Vec<f32> {
    let (columns, rows) = (shares(width, coarse_width), shares(height, coarse_height));
    let texel = |k: usize| -> f32 {
        let (first_column, columns) = &columns[k % coarse_width as usize];
        let (first_row, rows) = &rows[k / coarse_width as usize];
        let row = |(dj, share): (usize, &f32)| -> f32 {
            let at = (*first_row as usize + dj) * width as usize + *first_column as usize;
            share * columns.iter().zip(&values[at..]).map(|(share, value)| share * value).sum::<f32>()
        };
        rows.iter().enumerate().map(row).sum()
    };
    (0..coarse_width as usize * coarse_height as usize).into_par_iter().map(texel).collect()
}
