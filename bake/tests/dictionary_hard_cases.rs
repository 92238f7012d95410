//! Hard cases: extreme roughness, density, footprints and directions. Always finite, never negative, bounded work.

use glam::{Vec2, Vec3};
use glint_bake_core::dictionary::eval::patch_brdf;
use glint_bake_core::dictionary::eval::{DictionaryMaterial, TARGET_BECKMANN, TARGET_GGX, patch_sdf, smooth_sdf};
use glint_bake_core::dictionary::quality::max_cells;
use glint_bake_core::dictionary::{DictionaryOptions, bake};
use glint_bake_core::footprint::PixelOnSurface;
use glint_bake_core::progress::Silent;

fn material() -> DictionaryMaterial {
    DictionaryMaterial {
        alpha: Vec2::splat(0.5),
        normal_target: TARGET_BECKMANN,
        density: 1e8,
        relative_area: 1.0,
        density_randomisation: 1.0,
        max_anisotropy: 8.0,
        seed: 1,
        colours: Vec::new(),
        mean_colour: Vec3::ONE,
    }
}

fn direction(theta: f32, phi: f32) -> Vec3 {
    Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos().max(1e-7))
}

#[test]
fn every_extreme_gives_a_finite_bounded_answer() {
    let tables = bake(&DictionaryOptions { marginals: 32, ..Default::default() }, &Silent).unwrap().tables();
    let fine = 2f32.powi(-15);
    let footprints = [
        (Vec2::ZERO, Vec2::ZERO),
        (Vec2::new(1e-30, 0.0), Vec2::new(0.0, 1e-30)),
        (Vec2::new(fine, 0.0), Vec2::ZERO),
        (Vec2::new(fine, 0.0), Vec2::new(0.0, fine)),
        (Vec2::new(1e4 * fine, 0.0), Vec2::new(0.0, 1e4 * fine)),
        (Vec2::new(10.0 * fine, 10.0 * fine), Vec2::new(-1e4 * fine, 1e4 * fine)),
        (Vec2::new(1e3, 0.0), Vec2::new(0.0, 1.0)),
        (Vec2::new(1e20, 1e19), Vec2::new(0.0, f32::INFINITY)),
    ];
    let alphas = [(1e-3, 1e-3), (1.0, 1.0), (1.0, 0.01), (1e-3, 0.1), (0.3, 0.3)];
    let half_pi = std::f32::consts::FRAC_PI_2;
    let views = [(0.0, 0.0), (0.5, 1.0), (1.56, 0.3), (half_pi, 2.0)];
    let lights = [(0.0, 0.0), (0.5, 1.0 + 3.1), (1.56, 3.4), (half_pi, 2.0), (half_pi, 1.9)];
    let mut cases = 0;
    for target in [TARGET_BECKMANN, TARGET_GGX] {
        for alpha in alphas {
            for density in [0.0f32, 1e-16, 1.0, 1e8, 1e16] {
                for (d_dx, d_dy) in footprints {
                    let mut m = material();
                    m.normal_target = target;
                    m.alpha = Vec2::new(alpha.0, alpha.1);
                    m.density = density;
                    for position in [Vec2::ZERO, Vec2::new(-0.7, 123.4), Vec2::new(1e12, -1e30)] {
                        let pixel = PixelOnSurface { position, d_dx, d_dy };
                        for view in views {
                            for light in lights {
                                let (o, i) = (direction(view.0, view.1), direction(light.0, light.1));
                                let found = patch_brdf(&tables, &m, Vec3::splat(0.9), pixel, o, i);
                                let what = format!("{target} {alpha:?} ρ {density:e} {pixel:?} {view:?} {light:?}");
                                assert!(found.value.is_finite(), "{what}: {found:?}");
                                assert!(found.value.min_element() >= 0.0, "{what}: {found:?}");
                                assert!((found.coverage - 1.0).abs() < 1e-5, "{what}: {found:?}");
                                assert!(found.cells <= max_cells(m.max_anisotropy), "{what}: {found:?}");
                                let back = patch_brdf(&tables, &m, Vec3::splat(0.9), pixel, i, o);
                                let scale = found.value.x.max(1e-6);
                                assert!((found.value.x - back.value.x).abs() <= 1e-3 * scale, "{what}: not reciprocal");
                                cases += 1;
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(cases > 10_000);
}

#[test]
fn a_footprint_of_zero_area_still_integrates_to_one() {
    // The mass of the slope distribution on a grid fine enough for the lobes (σ = 0.02 of a domain of 1.41).
    let tables = bake(&DictionaryOptions { marginals: 32, ..Default::default() }, &Silent).unwrap().tables();
    for density in [0.0, 1e6, 1e9] {
        for size in [0.0, 1e4 * 2f32.powi(-15)] {
            let mut m = material();
            m.density = density;
            let pixel = PixelOnSurface {
                position: Vec2::new(0.37, 0.61),
                d_dx: Vec2::new(size, 0.0),
                d_dy: Vec2::new(0.0, size),
            };
            let step = 4.2 / 500.0;
            let mut sum = 0.0;
            for a in 0..500 {
                for b in 0..500 {
                    let slope = Vec2::new((a as f32 + 0.5) * step - 2.1, (b as f32 + 0.5) * step - 2.1);
                    sum += f64::from(patch_sdf(&tables, &m, pixel, slope).sdf.x) * f64::from(step * step);
                }
            }
            assert!((sum - 1.0).abs() < 1e-3, "ρ {density} footprint {size}: {sum}");
        }
    }
}

#[test]
fn zooming_and_moving_never_jumps() {
    // Small steps in footprint size and position change the distribution little, across whole levels too.
    let tables = bake(&DictionaryOptions::default(), &Silent).unwrap().tables();
    let m = material();
    let mut largest = 0.0f32;
    let mut previous: Option<[f32; 8]> = None;
    for k in 0..40_000 {
        let size = (k as f32 * 2.5e-4 - 15.5).exp2();
        let pixel = PixelOnSurface {
            position: Vec2::new(0.4 + size * 0.1, 0.3),
            d_dx: Vec2::new(size, 0.1 * size),
            d_dy: Vec2::new(0.0, size * 1.7),
        };
        let mut now = [0.0; 8];
        for (s, value) in now.iter_mut().enumerate() {
            let slope = Vec2::new(0.1 * s as f32 - 0.35, 0.07);
            *value = patch_sdf(&tables, &m, pixel, slope).sdf.x / smooth_sdf(&m, slope);
        }
        if let Some(before) = previous {
            for s in 0..8 {
                largest = largest.max((now[s] - before[s]).abs() / (1.0 + before[s]));
            }
        }
        previous = Some(now);
    }
    println!("largest relative change a step of 2^(1/4000): {largest:.4}");
    assert!(largest < 0.02, "{largest}");
}

#[test]
fn coverage_and_colour_have_the_right_means() {
    let tables = bake(&DictionaryOptions::default(), &Silent).unwrap().tables();
    let mut m = material();
    m.relative_area = 0.25;
    m.colours = vec![Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.5), Vec3::new(0.2, 0.5, 1.0)];
    m.mean_colour = (m.colours[0] + m.colours[1] + m.colours[2]) / 3.0;
    let step = 2f32.powi(-15);
    for density in [1e6, 1e10, 1e16] {
        m.density = density;
        let (mut sum, mut coverage) = (Vec3::ZERO, 0.0);
        for a in 0..200 {
            for b in 0..200 {
                let position = Vec2::new(a as f32 * 9.0, b as f32 * 7.0) * step;
                let pixel = PixelOnSurface { position, d_dx: Vec2::new(step, 0.0), d_dy: Vec2::new(0.0, step) };
                let slope = Vec2::new((a % 20) as f32 * 0.05 - 0.475, (b % 20) as f32 * 0.05 - 0.475);
                let found = patch_sdf(&tables, &m, pixel, slope);
                sum += found.sdf / smooth_sdf(&m, slope) / 40_000.0;
                coverage += found.coverage / 40_000.0;
            }
        }
        assert!((coverage - 0.25).abs() < 0.01, "ρ {density:e}: coverage {coverage}");
        let wished = m.mean_colour * 0.25;
        assert!((sum - wished).abs().max_element() < 0.05, "ρ {density:e}: {sum} for {wished}");
    }
    m.relative_area = 0.0;
    let pixel = PixelOnSurface { position: Vec2::ONE, d_dx: Vec2::X * step, d_dy: Vec2::Y * step };
    let nothing = patch_sdf(&tables, &m, pixel, Vec2::ZERO);
    assert!(nothing.sdf == Vec3::ZERO && nothing.coverage == 0.0);
}
