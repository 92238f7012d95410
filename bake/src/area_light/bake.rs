//! From a normal map to a material: the mip chain, packed, and how far packing took it from what was computed.
//!
//! The mip chain holds averaged normals that keep their length, and the roughness of the normals under a texel's footprint.
//!
//! Paper: Tao et al. 2021, sections 3.2 and 4 (normals averaged, not renormalised). Deviations:
//! - The surface is the bilinear one between texels, with unit normals everywhere, as a renderer without mips sees it.
//! - A texel's normal is the mean over its box. Its roughness is that over the B-spline of three boxes ([`weights`]),
//!   what a bilinear look-up averages over. A look-up between texels then knows how the normals of those texels differ,
//!   which no average of the boxes' own roughness would say.
//! - Roughness is that of [`super::spread`], along and across the direction in which the normals vary most.
//! - Maps of any size: texel i of a level of w′ covers texels i w/w′ to (i + 1) w/w′ of the map.
use super::baked::{AreaLightMaterial, LtcTables, TABLE_MEAN_ERROR};
use super::eval::alpha_of_code;
use super::options::AreaLightOptions;
use super::spread::{AlphaOf, KAPPA, axis_concentration, code_of, concentration};
use crate::error::BakeError;
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use glam::{DVec2, DVec3};
use glint_formats::Wrap;
use glint_formats::area_light::{AreaLightParams, MAX_TEXTURE_SIZE, MeasuredError, NormalStorage};
use glint_formats::container::full_mip_count;
use half::f16;
use rayon::prelude::*;

/// Bakes a map. The LTC tables come with the program.
///
/// # Errors
/// Those of [`check`].
pub fn bake(
    map: &NormalMap,
    options: &AreaLightOptions,
    progress: &dyn Progress,
) -> Result<AreaLightMaterial, BakeError> {
    check(map, options)?;
    let levels = mip_chain(map, progress);
    Ok(pack(map, &levels, options))
}

/// Whether a map can be baked, before any work.
///
/// # Errors
/// `BadOption` for options out of range, `BadInput` for a map whose first stored mip is larger than a texture may be,
/// `LimitExceeded` for one whose chain needs more than [`AreaLightOptions::max_memory`].
pub fn check(map: &NormalMap, options: &AreaLightOptions) -> Result<(), BakeError> {
    options.validate()?;
    let skipped = options.skip_mips.min(full_mip_count(map.width, map.height) - 1);
    let (width, height) = ((map.width >> skipped).max(1), (map.height >> skipped).max(1));
    if width.max(height) > MAX_TEXTURE_SIZE {
        let more = (0..).find(|more| (width.max(height) >> more) <= MAX_TEXTURE_SIZE).unwrap_or(0);
        return Err(BakeError::BadInput(format!(
            "a texture has at most {MAX_TEXTURE_SIZE} texels along an edge, the first mip would have {width} × {height}; leave \
             out {} of the finest mips, or use a part of the map",
            skipped + more
        )));
    }
    let needed = u64::from(map.width) * u64::from(map.height) * BYTES_PER_TEXEL;
    if needed > options.max_memory {
        return Err(BakeError::LimitExceeded(format!(
            "the mip chain of {} × {} texels needs {needed} bytes, the limit is {}; allow more, or use a part of the \
             map",
            map.width, map.height, options.max_memory
        )));
    }
    Ok(())
}

/// Packs the levels of a map. What is left when fine mips are skipped is a whole chain again, of a smaller map.
pub fn pack(map: &NormalMap, levels: &[MipLevel], options: &AreaLightOptions) -> AreaLightMaterial {
    let skipped = (options.skip_mips as usize).min(levels.len().saturating_sub(1));
    let levels = &levels[skipped..];
    let (width, height) = levels.first().map_or((map.width, map.height), |level| (level.width, level.height));
    let mut normals = Vec::new();
    let mut roughness = Vec::new();
    let mut measured = MeasuredError { table_mean: TABLE_MEAN_ERROR, ..MeasuredError::default() };
    for texel in levels.iter().flat_map(|level| &level.texels) {
        let at = normals.len();
        let n = texel.normal;
        push_texel(options.storage, [n.x, n.y, n.z, code_of(texel.alpha)], &mut normals);
        if options.anisotropic {
            let [p, q] = texel.by_direction.map(code_of);
            let (c, s) = (texel.axis.x, texel.axis.y);
            let matrix = [p * c * c + q * s * s, (p - q) * c * s, p * s * s + q * c * c, 0.0];
            push_texel(options.storage, matrix, &mut roughness);
        }
        add_error(texel, options.storage.decode(&normals[at..]), &mut measured);
    }
    AreaLightMaterial {
        params: AreaLightParams {
            width,
            height,
            wrap: map.wrap,
            base_roughness: options.base_roughness as f32,
            storage: options.storage,
            anisotropic: options.anisotropic,
            measured,
        },
        normals,
        roughness,
        tables: LtcTables::built_in(),
    }
}

fn add_error(texel: &MipTexel, stored: [f32; 4], measured: &mut MeasuredError) {
    let [x, y, z, _] = stored.map(f64::from);
    let alpha = f64::from(alpha_of_code(stored[3]));
    let stored = DVec3::new(x, y, z);
    let angle = libm::atan2(stored.cross(texel.normal).length(), stored.dot(texel.normal));
    measured.normal_angle = measured.normal_angle.max(angle);
    measured.roughness = measured.roughness.max((alpha - texel.alpha).abs());
}

/// Appends a texel; values from −1 to 1.
fn push_texel(storage: NormalStorage, texel: [f64; 4], out: &mut Vec<u8>) {
    for value in texel {
        match storage {
            NormalStorage::F16 => out.extend(f16::from_f32(value as f32).to_le_bytes()),
            NormalStorage::Snorm8 => out.push((value.clamp(-1.0, 1.0) * 127.0).round() as i8 as u8),
        }
    }
}

/// Bytes that a bake holds for each texel of the map: its moments, the levels, and what is packed of them.
pub const BYTES_PER_TEXEL: u64 = 160;

/// What a texel of a level says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MipTexel {
    /// Mean normal over the texel's box; its length is the mean resultant length there.
    pub normal: DVec3,
    /// Deficit 1 − R of the mean resultant length over the texel's footprint.
    pub deficit: f64,
    /// Meso roughness α over the footprint, the same in all directions.
    pub alpha: f64,
    /// Meso roughness α along `axis` and across it.
    pub by_direction: [f64; 2],
    /// Direction in which normals vary most, a unit vector in the frame of [`tangent_frame`].
    pub axis: DVec2,
}

/// One level.
#[derive(Clone, Debug, PartialEq)]
pub struct MipLevel {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Row by row.
    pub texels: Vec<MipTexel>,
}

/// First and second moments of the normals over a texel of the map: x, y, 1 − z, xx, xy, yy. All are small where the
/// map is flat, so f32 keeps their digits.
type Moments = [f32; 6];

/// Where the shortest turn from z to `n` (unit, z > −1) takes x and y.
pub fn tangent_frame(n: DVec3) -> (DVec3, DVec3) {
    let a = 1.0 / (1.0 + n.z);
    let b = -n.x * n.y * a;
    (DVec3::new(1.0 - n.x * n.x * a, b, -n.x), DVec3::new(b, 1.0 - n.y * n.y * a, -n.y))
}

/// All levels of a map, the map's own first, the last of one texel.
pub fn mip_chain(map: &NormalMap, progress: &dyn Progress) -> Vec<MipLevel> {
    let count = full_mip_count(map.width, map.height);
    progress.begin("mips", u64::from(count) + 1);
    let moments = texel_moments(map);
    let inverses = [AlphaOf::new(concentration), AlphaOf::new(axis_concentration)];
    progress.advance(1);
    let mut levels = Vec::new();
    for level in 0..count {
        levels.push(mip_level(map, &moments, &inverses, level));
        progress.advance(1);
    }
    progress.end();
    levels
}

/// Nodes of the two-point Gauss rule over each half of a texel: exact for the second moments of a bilinear patch.
const NODES: [f64; 4] =
    [0.105_662_432_702_593_56, 0.394_337_567_297_406_4, 0.605_662_432_702_593_6, 0.894_337_567_297_406_4];

fn texel_moments(map: &NormalMap) -> Vec<Moments> {
    let row = |j: u32| (0..map.width).map(move |i| moments_of(map, i, j));
    (0..map.height).into_par_iter().flat_map_iter(row).collect()
}

fn moments_of(map: &NormalMap, i: u32, j: u32) -> Moments {
    let mut sum = [0.0; 6];
    for y in NODES {
        for x in NODES {
            let s = bilinear(map, DVec2::new(f64::from(i) + x, f64::from(j) + y));
            let r2 = s.length_squared().min(1.0);
            // 1 − z = r² / (1 + z).
            let low = r2 / (1.0 + (1.0 - r2).sqrt());
            for (sum, value) in sum.iter_mut().zip([s.x, s.y, low, s.x * s.x, s.x * s.y, s.y * s.y]) {
                *sum += value / 16.0;
            }
        }
    }
    sum.map(|value| value as f32)
}

/// [`NormalMap::bilinear`] without the Jacobian, and without division while inside the map.
fn bilinear(map: &NormalMap, u: DVec2) -> DVec2 {
    let p = u - 0.5;
    let cell = p.floor();
    let (i, j) = (cell.x as i64, cell.y as i64);
    let (width, height) = (i64::from(map.width), i64::from(map.height));
    if i < 0 || j < 0 || i + 1 >= width || j + 1 >= height {
        return map.bilinear(u).0;
    }
    let f = p - cell;
    let at = (j * width + i) as usize;
    let read = |at: usize| DVec2::new(f64::from(map.projected[at][0]), f64::from(map.projected[at][1]));
    let below = at + width as usize;
    read(at).lerp(read(at + 1), f.x).lerp(read(below).lerp(read(below + 1), f.x), f.y)
}

fn mip_level(map: &NormalMap, moments: &[Moments], inverses: &[AlphaOf; 2], level: u32) -> MipLevel {
    let (width, height) = ((map.width >> level).max(1), (map.height >> level).max(1));
    let along = |fine, coarse, cdf| weights(fine, coarse, map.wrap, cdf);
    let kernels: [fn(f64) -> f64; 2] = [box_cdf, spline_cdf];
    let columns = kernels.map(|cdf| along(map.width, width, cdf));
    let rows = kernels.map(|cdf| along(map.height, height, cdf));
    let points = spline_points(point_count(level));
    let ratio = DVec2::new(f64::from(map.width) / f64::from(width), f64::from(map.height) / f64::from(height));
    let texels = (0..width * height)
        .into_par_iter()
        .map(|k| {
            let (i, j) = ((k % width) as usize, (k / width) as usize);
            let sum = |kernel: usize| weighted(moments, map.width as usize, &columns[kernel][i], &rows[kernel][j]);
            // The finest level holds the map itself: magnified, it must not blur.
            let normal = if level == 0 { texel_normal(map, i, j) } else { mean_normal(&sum(0)) };
            let wide = sum(1);
            let centre = DVec2::new(i as f64 + 0.5, j as f64 + 0.5) * ratio;
            let ([alpha, along, across], axis) = roughness(map, inverses, &wide, (centre, ratio), &points);
            MipTexel { normal, deficit: deficit(&wide), alpha, by_direction: [along, across], axis }
        })
        .collect();
    MipLevel { width, height, texels }
}

/// Points that a texel's roughness is taken from. Fine levels have many texels and few normals under each; from level 4 on
/// there are two points for each texel of the map, up to a number that leaves an error of less than a per cent.
fn point_count(level: u32) -> u32 {
    [40, 96, 160, 320, 640, 2048, 8192, 16_384][level.min(7) as usize]
}

fn weighted(moments: &[Moments], width: usize, columns: &[(u32, f64)], rows: &[(u32, f64)]) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for &(j, weight_j) in rows {
        let mut row = [0.0; 6];
        let line = &moments[j as usize * width..][..width];
        for &(i, weight_i) in columns {
            for (sum, value) in row.iter_mut().zip(line[i as usize]) {
                *sum += weight_i * f64::from(value);
            }
        }
        for (sum, value) in sum.iter_mut().zip(row) {
            *sum += weight_j * value;
        }
    }
    sum
}

fn texel_normal(map: &NormalMap, i: usize, j: usize) -> DVec3 {
    let s = map.texel(i as i64, j as i64);
    DVec3::new(s.x, s.y, (1.0 - s.length_squared()).max(0.0).sqrt())
}

fn mean_normal(m: &[f64; 6]) -> DVec3 {
    DVec3::new(m[0], m[1], 1.0 - m[2])
}

/// 1 − |mean|, from 1 − |mean|² = 2 (1 − z) − (1 − z)² − x² − y².
fn deficit(m: &[f64; 6]) -> f64 {
    let squared = m[2] * (2.0 - m[2]) - m[0] * m[0] - m[1] * m[1];
    (squared / (1.0 + mean_normal(m).length())).clamp(0.0, 1.0)
}

/// Weight, in the logarithm of α, of the geometric mean of both directions in the roughness of all directions. The
/// concentration of normals along a line is ruled by the line; a highlight is brighter on it and absent beside it, and the
/// least error is at a lower α. Where normals have no direction the two are the same.
const ANISOTROPIC_SHARE: f64 = 0.25;

/// Below this variance of slopes, (1e-5)², normals count as equal: it is what f32 moments can tell apart.
const LEAST_VARIANCE: f64 = 1e-10;

/// Roughness of the normals at `points` (in texels of the level, `ratio` texels of the map each) around `centre`: the same
/// in all directions, along the direction in which they vary most, and across it.
fn roughness(
    map: &NormalMap,
    [of_all, of_axis]: &[AlphaOf; 2],
    m: &[f64; 6],
    (centre, ratio): (DVec2, DVec2),
    points: &[DVec2],
) -> ([f64; 3], DVec2) {
    let variance = [m[3] - m[0] * m[0], m[4] - m[0] * m[1], m[5] - m[1] * m[1]];
    if variance[0] + variance[2] < LEAST_VARIANCE {
        return ([0.0; 3], DVec2::X);
    }
    let n = mean_normal(m).normalize_or(DVec3::Z);
    let (t, b) = tangent_frame(n);
    let axis = major_axis(n, t, b, variance);
    let (major, minor) = (t * axis.x + b * axis.y, b * axis.x - t * axis.y);
    let k2 = KAPPA * KAPPA;
    let mut sums = [0.0; 3];
    for point in points {
        let s = bilinear(map, centre + *point * ratio);
        let facet = DVec3::new(s.x, s.y, (1.0 - s.length_squared()).max(0.0).sqrt());
        // Slopes against the mean; what turns away from it is as far as can be.
        let z2 = facet.dot(n).max(1e-3).powi(2);
        let (x, y) = (facet.dot(major), facet.dot(minor));
        let (x2, y2) = (x * x, y * y);
        sums[0] += z2 * k2 / (z2 * k2 + x2 + y2);
        sums[1] += z2 * k2 / (z2 * k2 + x2);
        sums[2] += z2 * k2 / (z2 * k2 + y2);
    }
    let [all, along, across] = sums.map(|sum| sum / points.len() as f64);
    let [all, along, across] = [of_all.get(all), of_axis.get(along), of_axis.get(across)];
    // One number for normals that vary along a line: between that of all and the mean of both directions.
    let both = (along * across).sqrt().clamp(0.25 * all, all);
    let all = libm::pow(all, 1.0 - ANISOTROPIC_SHARE) * libm::pow(both, ANISOTROPIC_SHARE);
    ([all, along, across], axis)
}

/// Direction, in the frame (t, b) across the mean `n`, in which normals vary most, from the variance of (x, y).
fn major_axis(n: DVec3, t: DVec3, b: DVec3, variance: [f64; 3]) -> DVec2 {
    // A normal that moves by (dx, dy) also moves by dz = −(n_x dx + n_y dy) / n_z.
    let z = n.z.max(0.05);
    let row = |along: DVec3| DVec2::new(along.x - along.z * n.x / z, along.y - along.z * n.y / z);
    let (p, q) = (row(t), row(b));
    let [xx, xy, yy] = variance;
    let form = |u: DVec2, v: DVec2| xx * u.x * v.x + xy * (u.x * v.y + u.y * v.x) + yy * u.y * v.y;
    let angle = 0.5 * libm::atan2(2.0 * form(p, q), form(p, p) - form(q, q));
    DVec2::new(libm::cos(angle), libm::sin(angle))
}

/// An average over the texels of a level: the box of a texel, or the quadratic B-spline of three boxes, which is what a bilinear
/// look-up of boxes averages over, of a standard deviation of half a texel of the level.
///
/// For every texel of a level of `coarse` texels along an axis of `fine`: the texels under its kernel and their shares,
/// which add up to 1. Texel i of the level covers texels i · fine / coarse to (i + 1) · fine / coarse.
fn weights(fine: u32, coarse: u32, wrap: Wrap, cdf: fn(f64) -> f64) -> Vec<Vec<(u32, f64)>> {
    let ratio = f64::from(fine) / f64::from(coarse);
    let mut all = Vec::with_capacity(coarse as usize);
    for i in 0..coarse {
        let centre = (f64::from(i) + 0.5) * ratio;
        let (first, last) = ((centre - 1.5 * ratio).floor() as i64, (centre + 1.5 * ratio).ceil() as i64);
        let lowest = if last - first < i64::from(fine) { first } else { 0 };
        let mut shares = vec![0.0; (last - first).min(i64::from(fine)) as usize];
        for k in first..last {
            let share = cdf((k as f64 + 1.0 - centre) / ratio) - cdf((k as f64 - centre) / ratio);
            let at = match wrap {
                Wrap::Repeat => (k - lowest).rem_euclid(i64::from(fine)),
                Wrap::Clamp => k.clamp(0, i64::from(fine) - 1) - lowest.max(0).min(i64::from(fine) - 1),
            };
            shares[at as usize] += share;
        }
        let start = match wrap {
            Wrap::Repeat => lowest,
            Wrap::Clamp => lowest.max(0).min(i64::from(fine) - 1),
        };
        let texel = |k: usize| (start + k as i64).rem_euclid(i64::from(fine)) as u32;
        all.push(shares.iter().enumerate().filter(|(_, w)| **w > 0.0).map(|(k, w)| (texel(k), *w)).collect());
    }
    all
}

/// Integral, up to x, of the box of width 1 around 0.
fn box_cdf(x: f64) -> f64 {
    (x + 0.5).clamp(0.0, 1.0)
}

/// Integral, up to x, of the quadratic B-spline of width 3 around 0.
fn spline_cdf(x: f64) -> f64 {
    let away = x.abs().min(1.5);
    let tail = if away >= 0.5 { (1.5 - away).powi(3) / 6.0 } else { 0.5 - away * (0.75 - away * away / 3.0) };
    if x < 0.0 { tail } else { 1.0 - tail }
}

/// `count` points with the density of the B-spline along both axes, in texels of the level from the centre: a Kronecker
/// sequence on the golden ratio's cubic sibling, so that no direction and no period of a map is preferred.
fn spline_points(count: u32) -> Vec<DVec2> {
    const STEP: DVec2 = DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_2);
    (0..count)
        .map(|k| {
            let t = STEP * (f64::from(k) + 0.5);
            DVec2::new(spline_quantile(t.x.fract()), spline_quantile(t.y.fract()))
        })
        .collect()
}

fn spline_quantile(share: f64) -> f64 {
    let (mut low, mut high) = (-1.5, 1.5);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if spline_cdf(middle) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
