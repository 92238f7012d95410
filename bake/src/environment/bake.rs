//! Bakes an environment: levels, first mip by areas, filtered mips by their error bound, albedo, rounding, measurement.
//!
//! Paper: section 5. Radiance and indicators have the same weights in every texel, so they are filtered together.

use super::albedo;
use super::baked::Environment;
use super::cube::{resampled_row, texel_solid_angle_sr};
use super::image::{EnvironmentImage, luminance};
use super::kernel::{Lobe, roughness_of_mips};
use super::levels::{RadianceHistogram, fewest, log_uniform, optimal};
use super::options::{EnvironmentOptions, LevelCount};
use super::prefilter::filter_mip;
use super::quality;
use super::rounding::{self, Mip, half_bits, radiance_scale, rounding_error, shared_exponent};
use super::source::{BASE_CHANNELS, Source};
use super::tree::Tree;
use crate::error::{BakeError, Result};
use crate::progress::Progress;
use glint_formats::environment::{EnvironmentParams, LevelChoice, MeasuredError};
use rayon::prelude::*;

/// Rows of texels of the first mip that are held with all their channels.
const ROWS_AT_ONCE: usize = 64;

/// Bakes an environment of an image. Stages of `progress`: `filter`, in texels, and `measure`, in mips.
///
/// # Errors
/// Those of [`EnvironmentOptions::validate`]; [`BakeError::LimitExceeded`] when a mip misses the error that was asked.
pub fn bake(image: &EnvironmentImage, options: &EnvironmentOptions, progress: &dyn Progress) -> Result<Environment> {
    options.validate()?;
    let (levels, second_moment) = choose_levels(image, options);
    let mut params = EnvironmentParams {
        face_size: options.face_size,
        kernel: options.kernel,
        roughness: roughness_of_mips(options.mips()),
        radiance_scale: 1.0,
        coloured: options.coloured,
        levels,
        level_choice: options.level_choice,
        albedo_size: albedo::SIZE,
        source_width: image.width,
        source_height: image.height,
        negative_pixels: image.report.negative_pixels,
        mean_radiance: image.mean(),
        max_error: options.max_error,
        measured: MeasuredError { second_moment, ..MeasuredError::default() },
    };
    let mips = filtered_mips(image, options, &params, progress);
    choose_scale(image, &mips, &mut params);
    params.measured.energy = energy_error(image, &mips.light[0]);
    let Mips { light, indicators, colours } = mips;
    let mut environment = Environment {
        uniform: params.uniform(),
        params,
        radiance: Vec::new(),
        indicators,
        colours,
        albedo: Vec::new(),
    };
    for texels in light {
        environment.radiance.extend(stored_radiance(&texels, environment.params.radiance_scale));
    }
    environment.albedo = albedo::table()
        .into_iter()
        .flat_map(|areas| [areas.scale, areas.bias, areas.reflecting, areas.whole])
        .map(half_bits)
        .collect();
    quality::measure(image, options.measured_texels, &mut environment, progress);
    check_error(&environment)?;
    Ok(environment)
}

/// Levels and the mean relative error of the second moment that they lead to.
fn choose_levels(image: &EnvironmentImage, options: &EnvironmentOptions) -> (Vec<f64>, f64) {
    let histogram = || RadianceHistogram::new(image, options.kernel);
    match (options.levels, options.level_choice) {
        (LevelCount::Exactly(1), _) => (vec![luminance(image.mean())], 0.0),
        (LevelCount::Fewest(error), _) => fewest(&histogram(), error),
        (LevelCount::Exactly(count), LevelChoice::Optimal) => optimal(&histogram(), count as usize),
        (LevelCount::Exactly(count), LevelChoice::LogUniform) => {
            let levels = log_uniform(image, count as usize, options.floor);
            let error = histogram().error(&levels);
            (levels, error)
        }
    }
}

/// All mips, of which only radiance is yet to be rounded: its factor depends on all of them.
struct Mips {
    /// [`BASE_CHANNELS`] numbers a texel: red, green, blue, squared luminance. One entry a mip.
    light: Vec<Vec<f64>>,
    /// Rounded indicators in the order of the pack.
    indicators: Vec<u16>,
    /// Rounded colours of levels in the order of the pack.
    colours: Vec<u32>,
}

/// Sets the factor between stored and true radiance, and records what rounding then costs.
fn choose_scale(image: &EnvironmentImage, mips: &Mips, params: &mut EnvironmentParams) {
    let channels = BASE_CHANNELS;
    let of = |(mip, texels)| Mip { texels, channels, max_error: quality::allowed_error(params, mip) };
    let all: Vec<Mip<'_>> = mips.light.iter().map(Vec::as_slice).enumerate().map(of).collect();
    let scale = radiance_scale(image, &all);
    let mean = luminance(image.mean());
    let error = |mip: &Mip<'_>| if mean > 0.0 { rounding_error(mip, scale) / mean } else { 0.0 };
    params.measured.rounding = all.iter().map(error).collect();
    params.radiance_scale = scale;
}

fn filtered_mips(
    image: &EnvironmentImage,
    options: &EnvironmentOptions,
    params: &EnvironmentParams,
    progress: &dyn Progress,
) -> Mips {
    let sizes: Vec<u32> = (0..params.mips()).map(|mip| params.face_size >> mip).collect();
    let texels = sizes.iter().map(|size| 6 * u64::from(size * size)).sum();
    progress.begin("filter", texels);
    let source = Source::new(image, &params.levels, params.coloured);
    let mut mips = Mips { light: Vec::new(), indicators: Vec::new(), colours: Vec::new() };
    let mut first = RoundedMip::new(params, sizes[0]);
    for rows in (0..6 * sizes[0]).collect::<Vec<u32>>().chunks(ROWS_AT_ONCE) {
        let texels: Vec<Vec<f64>> = rows.par_iter().map(|row| first_mip_row(image, sizes[0], *row, &source)).collect();
        texels.iter().for_each(|row| first.add(params, source.channels, row));
    }
    mips.add(first);
    progress.advance(6 * u64::from(params.face_size).pow(2));
    let tree = Tree::new(source.divided(options.division(image)));
    for (size, alpha) in sizes.iter().zip(&params.roughness).skip(1) {
        let lobe = Lobe::new(params.kernel, *alpha);
        let mut mip = RoundedMip::new(params, *size);
        mip.add(params, source.channels, &filter_mip(&tree, &lobe, *size, options.max_error, progress));
        mips.add(mip);
    }
    progress.end();
    mips
}

/// A row of means over texels of the first mip, which is the source itself seen through a cube.
fn first_mip_row(image: &EnvironmentImage, size: u32, row: u32, source: &Source<'_>) -> Vec<f64> {
    resampled_row(image, size, row, source.channels, |x, y, out| source.values(x, y, out))
}

impl Mips {
    fn add(&mut self, mip: RoundedMip) {
        self.light.push(mip.light);
        self.indicators.extend(mip.indicators);
        self.colours.extend(mip.colours);
    }
}

/// One mip, texel after texel.
struct RoundedMip {
    /// Texels of the whole mip.
    count: usize,
    light: Vec<f64>,
    indicators: Vec<u16>,
    colours: Vec<u32>,
}

impl RoundedMip {
    fn new(params: &EnvironmentParams, size: u32) -> RoundedMip {
        let count = 6 * (size as usize).pow(2);
        let colours = if params.coloured { (params.levels.len() - 1) * count } else { 0 };
        RoundedMip {
            count,
            light: Vec::with_capacity(count * BASE_CHANNELS),
            indicators: vec![0; params.indicator_layers() as usize * count * 4],
            colours: vec![0; colours],
        }
    }

    /// Adds the next texels, of `channels` numbers each.
    fn add(&mut self, params: &EnvironmentParams, channels: usize, texels: &[f64]) {
        let more = params.levels.len() - 1;
        for texel in texels.chunks_exact(channels) {
            let k = self.light.len() / BASE_CHANNELS;
            self.light.extend(&texel[..BASE_CHANNELS]);
            let shares = &texel[BASE_CHANNELS..BASE_CHANNELS + more];
            // Blocks taken as points may give a few 1e-4 more than the whole.
            let whole = shares.iter().sum::<f64>().max(1.0);
            let shares: Vec<f64> = shares.iter().map(|share| share.max(0.0) / whole).collect();
            for (i, bits) in rounding::indicators(&shares).into_iter().enumerate() {
                self.indicators[((i / 4) * self.count + k) * 4 + i % 4] = bits;
            }
            if params.coloured {
                for i in 0..more {
                    let light = &texel[BASE_CHANNELS + more + 3 * i..][..3];
                    self.colours[i * self.count + k] = shared_exponent(unit_luminance([light[0], light[1], light[2]]));
                }
            }
        }
    }
}

/// |luminance over all texels of the first mip by solid angle, over the source's − 1|.
fn energy_error(image: &EnvironmentImage, texels: &[f64]) -> f64 {
    let size = ((texels.len() / BASE_CHANNELS / 6) as f64).sqrt() as u32;
    let whole = luminance(image.mean()) * 4.0 * std::f64::consts::PI;
    let mut sum = 0.0;
    for (k, texel) in texels.chunks_exact(BASE_CHANNELS).enumerate() {
        let k = k as u32 % (size * size);
        sum += luminance([texel[0], texel[1], texel[2]]) * texel_solid_angle_sr(k % size, k / size, size);
    }
    if whole > 0.0 { (sum / whole - 1.0).abs() } else { sum }
}

/// Half floats of radiance and root mean square luminance over `scale`.
fn stored_radiance(texels: &[f64], scale: f64) -> impl Iterator<Item = u16> {
    texels.chunks_exact(BASE_CHANNELS).flat_map(move |texel| {
        let rgba = [texel[0], texel[1], texel[2], texel[3].max(0.0).sqrt()];
        rgba.map(|value| half_bits(value / scale))
    })
}

/// A colour scaled to luminance 1; white where there is no light.
fn unit_luminance(rgb: [f64; 3]) -> [f64; 3] {
    let y = luminance(rgb);
    if y > 0.0 { rgb.map(|c| c / y) } else { [1.0; 3] }
}

fn check_error(environment: &Environment) -> Result<()> {
    let params = &environment.params;
    for (mip, measured) in params.measured.mips.iter().enumerate().skip(1) {
        let most = quality::allowed_error(params, mip).hypot(params.measured.rounding[mip]);
        if measured.rmse > most {
            return Err(BakeError::LimitExceeded(format!(
                "mip {mip} (α {:.4}): expected a root mean square error of {most:.5} of the mean at most, found {:.5}; \
                 allow a larger error",
                params.roughness[mip], measured.rmse
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::image::direction;
    use crate::environment::reference::texel_mean;
    use crate::progress::Silent;
    use half::f16;

    /// Sky, ground, some texture, and a sun of a few pixels that is `range` times as bright.
    fn sunny(width: u32, height: u32, range: f32) -> EnvironmentImage {
        let sun = glam::DVec3::new(0.3, 0.5, -0.6).normalize();
        let pixel = |k: u32| {
            let [u, v] = [(k % width, width), (k / width, height)].map(|(c, of)| (f64::from(c) + 0.5) / f64::from(of));
            let d = direction(std::f64::consts::TAU * (u - 0.5), (std::f64::consts::PI * (0.5 - v)).sin());
            if d.dot(sun) > 0.996 {
                return [range, 0.9 * range, 0.8 * range];
            }
            let texture = 1.0 + 0.5 * ((13.0 * d.x).sin() * (17.0 * d.z).cos()) as f32;
            if d.y > 0.0 { [0.3 * texture, 0.5 * texture, texture] } else { [0.2 * texture, 0.15, 0.1] }
        };
        EnvironmentImage::new(width, height, (0..width * height).map(pixel).collect()).unwrap()
    }

    fn options(face_size: u32, min_face_size: u32) -> EnvironmentOptions {
        let levels = LevelCount::Exactly(1);
        EnvironmentOptions { face_size, min_face_size, levels, measured_texels: 0, ..EnvironmentOptions::default() }
    }

    /// A sun of a few texels decides what rounding costs, and the factor of stored radiance follows it.
    #[test]
    fn a_sun_rounds_well() {
        let options = options(64, 16);
        for (range, chosen) in [(1.0f32, false), (1e6, true), (3.3e7, true)] {
            let mut pixels = sunny(256, 128, 1.0).pixels;
            pixels[37 * 256 + 120] = [range, 0.9 * range, 0.8 * range];
            let image = EnvironmentImage::new(256, 128, pixels).unwrap();
            let params = bake(&image, &options, &Silent).unwrap().params;
            let exact = filtered_mips(&image, &options, &params, &Silent);
            let scale = params.radiance_scale;
            assert_eq!(scale.log2().fract() != 0.0, chosen, "{range}: {scale}");
            assert_eq!(f64::from(scale as f32), scale);
            let mean = luminance(image.mean());
            let rounding = |scale: f64, mip: usize| {
                let texels = exact.light[mip].chunks_exact(BASE_CHANNELS);
                let count = texels.len() as f64;
                let squares = texels.map(|texel| {
                    let stored = |value: f64| f16::from_f32((value / scale) as f32).to_f64() * scale;
                    luminance([0, 1, 2].map(|c| stored(texel[c]) - texel[c])).powi(2)
                });
                (squares.sum::<f64>() / count).sqrt() / mean
            };
            for mip in 0..3 {
                let recorded = params.measured.rounding[mip];
                let (found, plain) = (rounding(scale, mip), rounding(scale.log2().floor().exp2(), mip));
                assert!((recorded / found - 1.0).abs() < 0.02, "{range} mip {mip}: {recorded} {found}");
                assert!(recorded <= 0.02, "{range} mip {mip}: {recorded}");
                if chosen && mip == 0 {
                    assert!(found < 0.5 * plain, "{range} mip {mip}: {found} {plain}");
                }
            }
        }
    }

    #[test]
    fn the_first_mip_is_the_mean_over_every_texel() {
        // Pixels that fit no texel, some of them a million times as bright.
        let (image, size) = (sunny(101, 51, 1e6), 16);
        let row = |row| {
            resampled_row(&image, size, row, 3, |x, y, out| {
                out.copy_from_slice(&image.pixels[(y * image.width + x) as usize]);
            })
        };
        let texels: Vec<f64> = (0..6 * size).flat_map(row).collect();
        // The reference's lines leave some 1e-4 where a bright edge runs nearly along them.
        let error = |(k, texel): (u32, &[f64])| {
            let exact = texel_mean(&image, (k / (size * size)) as usize, k % size, k / size % size, size, 512);
            (luminance([texel[0], texel[1], texel[2]]) / exact.luminance - 1.0).abs()
        };
        let all: Vec<(u32, &[f64])> = (0..6 * size * size).zip(texels.chunks_exact(3)).collect();
        let worst = all.into_par_iter().map(error).reduce(|| 0.0, f64::max);
        println!("worst texel: {worst:.1e}");
        assert!(worst <= 5e-4, "{worst}");
    }
}
