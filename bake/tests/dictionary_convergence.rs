//! What a cell, and the mean over cells, converges to: Beckmann and GGX, round and 100:1, and the white furnace. What a pixel shows
//! against the mean of its parts.

use glam::{DVec2, Vec2, Vec3};
use glint_bake_core::brdf::{masking, normal_to_slope, sdf_to_ndf};
use glint_bake_core::dictionary::baked::Tables;
use glint_bake_core::dictionary::eval::{
    DictionaryMaterial, TARGET_BECKMANN, TARGET_GGX, cell_sdf, patch_sdf, slope_query,
};
use glint_bake_core::dictionary::reference::smooth_density;
use glint_bake_core::dictionary::{DictionaryOptions, bake};
use glint_bake_core::footprint::PixelOnSurface;
use glint_bake_core::hash::cell_state;
use glint_bake_core::progress::Silent;
use std::f64::consts::PI;

fn material(target: u32, alpha: Vec2, density: f32) -> DictionaryMaterial {
    DictionaryMaterial {
        alpha,
        normal_target: target,
        density,
        relative_area: 1.0,
        density_randomisation: 0.0,
        max_anisotropy: 4.0,
        seed: 3,
        colours: Vec::new(),
        mean_colour: Vec3::ONE,
    }
}

/// Slope at which the target holds a share `u` within its ellipse, in direction `phi`; each cell of a regular grid in
/// (u, phi) then holds the same share of the target.
fn slope_at(ggx: bool, alpha: DVec2, u: f64, phi: f64) -> DVec2 {
    let r = if ggx { (u / (1.0 - u)).sqrt() } else { (-libm::log1p(-u)).sqrt() };
    DVec2::from_angle(phi) * r * alpha
}

/// ∫|cell − target| of one cell at a level of the dictionary, over n × 2n equal shares of the target.
fn cell_l1(tables: &Tables, m: &DictionaryMaterial, cell: u32, level: f32, n: usize) -> f64 {
    let ggx = m.normal_target == TARGET_GGX;
    let alpha = m.alpha.as_dvec2();
    let mut sum = 0.0;
    for a in 0..n {
        let u = (a as f64 + 0.5) / n as f64;
        for b in 0..2 * n {
            let slope = slope_at(ggx, alpha, u, (b as f64 + 0.5) / n as f64 * PI);
            let value = cell_sdf(
                tables,
                m,
                cell_state(cell * 977, cell, m.seed),
                level,
                &slope_query(tables, m, slope.as_vec2()),
            )
            .sdf
            .x;
            sum += (f64::from(value) / smooth_density(ggx, alpha, slope) - 1.0).abs();
        }
    }
    sum / (2 * n * n) as f64
}

#[test]
fn one_cell_at_the_last_level_is_near_the_smooth_target() {
    let tables = bake(&DictionaryOptions::default(), &Silent).unwrap().tables();
    for (target, limit) in [(TARGET_BECKMANN, 0.03), (TARGET_GGX, 0.05)] {
        for alpha in [Vec2::splat(0.5), Vec2::splat(1e-3), Vec2::new(1.0, 0.01)] {
            let m = material(target, alpha, 1e9);
            let mut mean = 0.0;
            let mut first = 0.0;
            for cell in 0..32 {
                mean += cell_l1(&tables, &m, cell, 15.0, 200) / 32.0;
                first += cell_l1(&tables, &m, cell, 0.0, 200) / 32.0;
            }
            println!("target {target} α {alpha}: one cell at level 15: L1 {mean:.4}; at level 0: {first:.3}");
            assert!(mean <= limit, "target {target} α {alpha}: mean L1 {mean:.4}");
            assert!(first > 1.5, "level 0 has no glints: L1 {first:.3}");
        }
    }
}

#[test]
fn infinite_density_gives_the_smooth_target() {
    let tables = bake(&DictionaryOptions::default(), &Silent).unwrap().tables();
    for ggx in [false, true] {
        for alpha in [Vec2::splat(0.3), Vec2::splat(1e-3), Vec2::new(1.0, 0.01), Vec2::new(0.01, 1.0)] {
            let m = material(u32::from(ggx), alpha, 1e16);
            let step = Vec2::new(1e-3, 2e-4);
            let pixel = PixelOnSurface { position: Vec2::new(0.3, 0.7), d_dx: step, d_dy: step.perp() };
            let mut l1 = 0.0;
            for a in 0..200 {
                for b in 0..400 {
                    let slope = slope_at(
                        ggx,
                        alpha.as_dvec2(),
                        (f64::from(a) + 0.5) / 200.0,
                        (f64::from(b) + 0.5) / 200.0 * PI,
                    );
                    let value = f64::from(patch_sdf(&tables, &m, pixel, slope.as_vec2()).sdf.x);
                    l1 += (value / smooth_density(ggx, alpha.as_dvec2(), slope) - 1.0).abs() / 80_000.0;
                }
            }
            assert!(l1 <= 1e-3, "GGX {ggx} α {alpha}: L1 {l1:.1e}");
        }
    }
}

/// Mean over cells at a level, in 8 × 8 equal shares of the target: mean distance of a share from what it should be.
fn mean_over_cells_l1(tables: &Tables, m: &DictionaryMaterial, level: f32, cells: u32) -> f64 {
    let ggx = m.normal_target == TARGET_GGX;
    let alpha = m.alpha.as_dvec2();
    let mut shares = [0.0; 64];
    for cell in 0..cells {
        // Another place in the grid for each cell, so that the grid never lines up with lobes.
        let du = (f64::from(cell) * 0.618_033_988_7).fract();
        let dphi = (f64::from(cell) * 0.754_877_666_2).fract();
        for a in 0..16 {
            for b in 0..16 {
                let (u, phi) = ((a as f64 + du) / 16.0, (b as f64 + dphi) / 16.0 * 2.0 * PI);
                let slope = slope_at(ggx, alpha, u.clamp(1e-9, 1.0 - 1e-9), phi);
                let value = f64::from(
                    cell_sdf(
                        tables,
                        m,
                        cell_state(cell * 31, cell / 7, m.seed),
                        level,
                        &slope_query(tables, m, slope.as_vec2()),
                    )
                    .sdf
                    .x,
                );
                shares[a / 2 * 8 + b / 2] += value / smooth_density(ggx, alpha, slope);
            }
        }
    }
    shares.iter().map(|s| (s / (4.0 * f64::from(cells)) - 1.0).abs() / 64.0).sum()
}

#[test]
fn the_mean_over_cells_is_the_target_at_every_level_up_to_100_to_1() {
    let tables = bake(&DictionaryOptions::default(), &Silent).unwrap().tables();
    for target in [TARGET_BECKMANN, TARGET_GGX] {
        for alpha in [Vec2::splat(0.5), Vec2::new(1.0, 0.01)] {
            let m = material(target, alpha, 1e9);
            let mut found = Vec::new();
            // Limits are about twice the noise of 80 000 samples of a density whose deviation is 10 at level 0.
            for (level, limit) in [(0.0, 0.06), (3.0, 0.03), (7.0, 0.01), (11.0, 0.003), (15.0, 0.002)] {
                let l1 = mean_over_cells_l1(&tables, &m, level, 20_000);
                found.push((level, l1, limit));
            }
            println!("target {target} α {alpha}: mean over 20 000 cells: (level, L1, limit) {found:.4?}");
            for (level, l1, limit) in found {
                assert!(l1 <= limit, "target {target} α {alpha} level {level}: L1 of the mean {l1:.4}");
            }
        }
    }
}

/// ∫ G₁(o, h) D(h) (o·h) / (o·n) dω_h for three view directions, by the midpoint rule over rings and directions. Rings
/// are even in the radius of the dictionary, out to the corner of its domain. The half vector's solid angle is that of
/// its slope times z³.
fn furnace(tables: &Tables, m: &DictionaryMaterial, pixel: PixelOnSurface, thetas: [f64; 3], n: usize) -> [f64; 3] {
    let ggx = m.normal_target == TARGET_GGX;
    let alpha = m.alpha.as_dvec2();
    let mut sums = [0.0; 3];
    let ring = 4.0 / n as f64;
    for a in 0..n {
        let t = (a as f64 + 0.5) * ring;
        let r = if ggx { libm::expm1(t * t).sqrt() } else { t };
        let r_dr = if ggx { t * libm::exp(t * t) } else { t } * ring;
        for b in 0..2 * n {
            let slope = DVec2::from_angle((b as f64 + 0.37) / n as f64 * PI) * r * alpha;
            let z = 1.0 / (1.0 + slope.length_squared()).sqrt();
            let h = Vec3::new((-slope.x * z) as f32, (-slope.y * z) as f32, z as f32);
            let sdf = patch_sdf(tables, m, pixel, normal_to_slope(h)).sdf;
            let d = f64::from(sdf_to_ndf(sdf, h.z).x);
            let solid_angle = z * z * z * r_dr * PI / n as f64 * alpha.x * alpha.y;
            for k in 0..3 {
                let (sin, cos) = thetas[k].sin_cos();
                let o = Vec3::new((sin * 0.8) as f32, (sin * 0.6) as f32, cos as f32);
                let oh = f64::from(o.dot(h)).max(0.0);
                sums[k] += f64::from(masking(o, h)) * d * oh / cos * solid_angle;
            }
        }
    }
    sums
}

#[test]
fn weak_white_furnace() {
    let tables = bake(&DictionaryOptions::default(), &Silent).unwrap().tables();
    let step = 2f32.powi(-12);
    let pixel = PixelOnSurface {
        position: Vec2::new(0.213, 0.577),
        d_dx: Vec2::new(1.3 * step, 0.2 * step),
        d_dy: Vec2::new(-0.4 * step, step),
    };
    let thetas = [0.0, PI / 4.0, 1.56];
    for (target, name) in [(TARGET_BECKMANN, "Beckmann"), (TARGET_GGX, "GGX")] {
        for alpha in [0.01, 0.3, 1.0] {
            let mut worst = [0.0f64; 3];
            for log_density in [14.0f32, 20.0, 26.0] {
                for zeta in [0.01, 2.0] {
                    let mut m = material(target, Vec2::splat(alpha), log_density.exp());
                    m.density_randomisation = zeta;
                    let sums = furnace(&tables, &m, pixel, thetas, 300);
                    for k in 0..3 {
                        worst[k] = worst[k].max((sums[k] - 1.0).abs());
                    }
                }
            }
            println!("{name} α {alpha}: worst furnace error at θ = 0, π/4, 1.56: {worst:.5?}");
            assert!(worst.iter().all(|w| *w <= 0.003), "{name} α {alpha}: {worst:.5?}");
        }
    }
}

/// Mean, and root mean square distance from the smooth target, of what 4 000 pixels show and of the means of their sixteen parts,
/// relative to the target: [[mean, contrast] of pixels, the same of parts].
fn pixels_and_parts(tables: &Tables, m: &DictionaryMaterial, stretch: f32) -> [[f64; 2]; 2] {
    let mut sums = [[0.0; 2]; 2];
    let (mut mass, mut power) = (0.0, 0.0);
    for k in 0..4000 {
        let random = |step: f64| ((f64::from(k) + 0.5) * step).fract() as f32;
        // All phases between two levels of detail; slopes all over the disc that holds most of the target.
        let size = (random(0.618_033_988_7) - 10.0).exp2();
        let axis = Vec2::from_angle(random(0.569_840_291) * std::f32::consts::TAU);
        let (d_dx, d_dy) = (axis * size * stretch, axis.perp() * size);
        let position = Vec2::new(random(0.754_877_666_2), random(0.324_717_957_2)) * 10.0;
        let slope =
            Vec2::from_angle(random(0.220_744_084_6) * std::f32::consts::TAU) * random(0.430_159_709).sqrt() * m.alpha;
        let at = |position, scale| {
            let pixel = PixelOnSurface { position, d_dx: d_dx * scale, d_dy: d_dy * scale };
            f64::from(patch_sdf(tables, m, pixel, slope).sdf.x)
        };
        let mut parts = 0.0;
        for part in 0..16 {
            let (x, y) = ((part % 4) as f32 * 0.25 - 0.375, (part / 4) as f32 * 0.25 - 0.375);
            parts += at(position + d_dx * x + d_dy * y, 0.25) / 16.0;
        }
        let target = smooth_density(false, m.alpha.as_dvec2(), slope.as_dvec2());
        mass += target;
        power += target * target;
        for (sum, value) in sums.iter_mut().zip([at(position, 1.0), parts]) {
            sum[0] += value;
            sum[1] += (value - target).powi(2);
        }
    }
    sums.map(|[mean, square]: [f64; 2]| [mean / mass, (square / power).sqrt()])
}

#[test]
fn a_pixel_has_the_mean_and_the_contrast_of_its_parts() {
    let tables = bake(&DictionaryOptions::default(), &Silent).unwrap().tables();
    for stretch in [1.0, 2.0, 4.0] {
        for density in [1e7, 1e8, 1e10] {
            let m = material(TARGET_BECKMANN, Vec2::splat(0.3), density);
            let [[mean, contrast], [parts_mean, parts_contrast]] = pixels_and_parts(&tables, &m, stretch);
            let ratio = contrast / parts_contrast;
            println!(
                "{stretch}:1, density {density:.0e}: mean {mean:.3}, of parts {parts_mean:.3}; contrast {contrast:.3}, \
                 of parts {parts_contrast:.3}, ratio {ratio:.2}"
            );
            // Three standard deviations of the mean of as many independent pixels.
            assert!((mean - 1.0).abs() < 3.0 * contrast / 4000f64.sqrt(), "mean {mean:.3}");
            assert!((parts_mean - 1.0).abs() < 3.0 * parts_contrast / 4000f64.sqrt(), "mean of parts {parts_mean:.3}");
            // Cells of a pixel's edge blur it more than those of its parts, and their contrast is more than that of finer cells together.
            assert!((0.75..1.35).contains(&ratio), "contrast {ratio:.2} times that of parts");
        }
    }
}
