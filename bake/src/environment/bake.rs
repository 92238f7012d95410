//! Bakes an environment: levels, the mirror by areas, filtered roughnesses by their error bound, albedo, rounding, measurement.
//!
//! Paper: section 5. Radiance and indicators have the same weights in every texel, so they are filtered together.

use super::baked::Environment;
use super::cube::{resampled_row, texel_solid_angle_sr};
use super::image::{EnvironmentImage, luminance};
use super::kernel::Lobe;
use super::levels::{RadianceHistogram, fewest, log_uniform, optimal};
use super::options::{EnvironmentOptions, LevelCount, OF_SHARP_READS};
use super::prefilter::filter_cube;
use super::quality;
use super::rounding::{self, Texels, half_bits, radiance_scale, rounding_error, shared_exponent};
use super::source::{BASE_CHANNELS, Source};
use super::table;
use super::tree::Tree;
use crate::error::{BakeError, Result};
use crate::progress::Progress;
use glint_formats::environment::{EnvironmentParams, LevelChoice, MeasuredError, SHARP, roughness_of};
use rayon::prelude::*;

/// Rows of texels of the mirror that are held with all their channels.
const ROWS_AT_ONCE: usize = 64;

/// Bakes an environment of an image. Stages of `progress`: `filter`, in texels, and `measure`, in roughnesses and a last step.
///
/// # Errors
/// Those of [`EnvironmentOptions::validate`]; [`BakeError::LimitExceeded`] when the texels of a roughness or what is read miss the error that was asked.
pub fn bake(image: &EnvironmentImage, options: &EnvironmentOptions, progress: &dyn Progress) -> Result<Environment> {
    options.validate()?;
    let (levels, second_moment) = choose_levels(image, options);
    let mut params = EnvironmentParams {
        face_size: options.face_size,
        per_size: options.per_size,
        kernel: options.kernel,
        roughness: roughness_of(options.face_size, options.filtered()),
        radiance_scale: 1.0,
        coloured: options.coloured,
        levels,
        level_choice: options.level_choice,
        albedo_size: table::SIZE,
        look_ups: options.look_ups,
        source_width: image.width,
        source_height: image.height,
        negative_pixels: image.report.negative_pixels,
        mean_radiance: image.mean(),
        filter_error: options.filter_error,
        max_error: options.max_error,
        measured: MeasuredError { second_moment, ..MeasuredError::default() },
    };
    let cubes = filtered_cubes(image, options, &params, progress);
    choose_scale(image, &cubes, &mut params);
    params.measured.energy = energy_error(image, &cubes.light[0]);
    let Cubes { light, indicators, colours } = cubes;
    let mut environment = Environment {
        uniform: params.uniform(),
        params,
        mirror: Vec::new(),
        radiance: Vec::new(),
        indicators,
        colours,
        albedo: Vec::new(),
    };
    for (index, texels) in light.into_iter().enumerate() {
        let stored = if index == 0 { &mut environment.mirror } else { &mut environment.radiance };
        stored.extend(stored_radiance(&texels, environment.params.radiance_scale));
    }
    environment.albedo = table::albedo(options.kernel, options.look_ups);
    quality::measure(image, options.measured_reads, &mut environment, progress);
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

/// The mirror and all roughnesses, of which only radiance is yet to be rounded: its factor depends on all of them.
struct Cubes {
    /// [`BASE_CHANNELS`] numbers a texel: red, green, blue, squared luminance. One entry a roughness, the mirror first.
    light: Vec<Vec<f64>>,
    /// Rounded indicators in the order of the pack.
    indicators: Vec<u16>,
    /// Rounded colours of levels in the order of the pack.
    colours: Vec<u32>,
}

/// Sets the factor between stored and true radiance, and records what rounding then costs.
fn choose_scale(image: &EnvironmentImage, cubes: &Cubes, params: &mut EnvironmentParams) {
    let channels = BASE_CHANNELS;
    let of = |(index, texels)| Texels { texels, channels, max_error: quality::allowed_error(params, index) };
    let all: Vec<Texels<'_>> = cubes.light.iter().map(Vec::as_slice).enumerate().map(of).collect();
    let scale = radiance_scale(image, &all);
    let mean = luminance(image.mean());
    let error = |texels: &Texels<'_>| if mean > 0.0 { rounding_error(texels, scale) / mean } else { 0.0 };
    params.measured.rounding = all.iter().map(error).collect();
    params.radiance_scale = scale;
}

fn filtered_cubes(
    image: &EnvironmentImage,
    options: &EnvironmentOptions,
    params: &EnvironmentParams,
    progress: &dyn Progress,
) -> Cubes {
    let texels = (0..=params.filtered()).map(|index| 6 * u64::from(params.size(index)).pow(2)).sum();
    progress.begin("filter", texels);
    let mut cubes = Cubes { light: vec![mirror(image, params)], indicators: Vec::new(), colours: Vec::new() };
    progress.advance(6 * u64::from(params.face_size).pow(2));
    let source = Source::new(image, &params.levels, params.coloured);
    let tree = Tree::new(source.divided(options.division(image)));
    for index in 1..=params.filtered() {
        let lobe = Lobe::new(params.kernel, params.roughness[index as usize]);
        let texels = filter_cube(&tree, &lobe, params.size(index), options.filter_error, progress);
        let coloured = params.coloured && params.place(index).1 == params.colour_layer();
        cubes.add(params, source.channels, coloured, &texels);
    }
    progress.end();
    cubes
}

/// Means over the texels of the source seen through a cube, [`BASE_CHANNELS`] numbers each.
fn mirror(image: &EnvironmentImage, params: &EnvironmentParams) -> Vec<f64> {
    // Levels are of no use where facets are not told apart.
    let source = Source::new(image, &params.levels[..1], false);
    let row = |row| resampled_row(image, params.face_size, row, source.channels, |x, y, out| source.values(x, y, out));
    let rows: Vec<u32> = (0..6 * params.face_size).collect();
    rows.chunks(ROWS_AT_ONCE)
        .flat_map(|rows| rows.par_iter().flat_map_iter(|&at| row(at)).collect::<Vec<f64>>())
        .collect()
}

impl Cubes {
    /// Adds a roughness, whose texels have `channels` numbers each; with its colours where it is one that has them.
    fn add(&mut self, params: &EnvironmentParams, channels: usize, coloured: bool, texels: &[f64]) {
        let more = params.levels.len() - 1;
        let count = texels.len() / channels;
        let (first, first_colour) = (self.indicators.len(), self.colours.len());
        self.indicators.resize(first + params.indicator_layers() as usize * count * 4, 0);
        self.colours.resize(first_colour + if coloured { more * count } else { 0 }, 0);
        let mut light = Vec::with_capacity(count * BASE_CHANNELS);
        for (k, texel) in texels.chunks_exact(channels).enumerate() {
            light.extend(&texel[..BASE_CHANNELS]);
            let shares = &texel[BASE_CHANNELS..BASE_CHANNELS + more];
            // Blocks taken as points may give a few 1e-4 more than the whole.
            let whole = shares.iter().sum::<f64>().max(1.0);
            let shares: Vec<f64> = shares.iter().map(|share| share.max(0.0) / whole).collect();
            for (i, bits) in rounding::indicators(&shares).into_iter().enumerate() {
                self.indicators[first + ((i / 4) * count + k) * 4 + i % 4] = bits;
            }
            if coloured {
                for i in 0..more {
                    let light = &texel[BASE_CHANNELS + more + 3 * i..][..3];
                    self.colours[first_colour + i * count + k] =
                        shared_exponent(unit_luminance([light[0], light[1], light[2]]));
                }
            }
        }
        self.light.push(light);
    }
}

/// |luminance over all texels of the mirror by solid angle, over the source's − 1|.
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
    for (index, measured) in params.measured.texels.iter().enumerate().skip(1) {
        let most = quality::allowed_error(params, index).hypot(params.measured.rounding[index]);
        if measured.rmse > most {
            return Err(BakeError::LimitExceeded(format!(
                "roughness {index} (α {:.4}): expected texels with a root mean square error of {most:.5} of the mean at most, \
                 found {:.5}; allow a larger --filter-error",
                params.roughness[index], measured.rmse
            )));
        }
    }
    let Some(max_error) = params.max_error else { return Ok(()) };
    let allowed = [(OF_SHARP_READS * max_error, "below"), (max_error, "at least")];
    for (reads, (most, side)) in params.measured.reads.iter().zip(allowed) {
        if reads.relative > most {
            return Err(BakeError::LimitExceeded(format!(
                "expected look-ups with a relative error of {most:.4} at most, root mean square, where roughness is {side} {SHARP}, \
                 found {:.4}; give more --roughnesses, a larger --face-size or --min-face-size, or allow a larger --max-error",
                reads.relative
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
        let per_size = 1;
        let measured_reads = 0;
        EnvironmentOptions {
            face_size,
            min_face_size,
            per_size,
            levels,
            measured_reads,
            ..EnvironmentOptions::default()
        }
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
            let exact = filtered_cubes(&image, &options, &params, &Silent);
            let scale = params.radiance_scale;
            assert_eq!(scale.log2().fract() != 0.0, chosen, "{range}: {scale}");
            assert_eq!(f64::from(scale as f32), scale);
            let mean = luminance(image.mean());
            let rounding = |scale: f64, index: usize| {
                let texels = exact.light[index].chunks_exact(BASE_CHANNELS);
                let count = texels.len() as f64;
                let squares = texels.map(|texel| {
                    let stored = |value: f64| f16::from_f32((value / scale) as f32).to_f64() * scale;
                    luminance([0, 1, 2].map(|c| stored(texel[c]) - texel[c])).powi(2)
                });
                (squares.sum::<f64>() / count).sqrt() / mean
            };
            for index in 0..3 {
                let recorded = params.measured.rounding[index];
                let (found, plain) = (rounding(scale, index), rounding(scale.log2().floor().exp2(), index));
                assert!((recorded / found - 1.0).abs() < 0.02, "{range} roughness {index}: {recorded} {found}");
                assert!(recorded <= 0.02, "{range} roughness {index}: {recorded}");
                if chosen && index == 0 {
                    assert!(found < 0.5 * plain, "{range} roughness {index}: {found} {plain}");
                }
            }
        }
    }

    #[test]
    fn the_mirror_is_the_mean_over_every_texel() {
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
