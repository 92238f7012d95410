//! Anisotropic textures: the reference against the isotropic one and against energy, the fit against a scan, turned and flat maps.

use glam::{DVec2, DVec3};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::textures::quality::{measure, probes};
use glint_bake_core::textures::reference::{Facet, Stretched, radiance, stretched_radiance};
use glint_bake_core::textures::{Axes, Level, Roughness, Textures, TexturesOptions, bake};
use glint_formats::Wrap;

const BOTH: [Axes; 2] = [Axes::Surface, Axes::Normal];

/// Normals of lines along v: without order along u, and a little of that along v.
fn lines(size: u32, most: f32) -> NormalMap {
    let hash = |i: u32, salt: u32| {
        let mut h = i.wrapping_mul(0x9e37_79b1) ^ salt.wrapping_mul(0x85eb_ca6b);
        h ^= h >> 15;
        h = h.wrapping_mul(0x2c1b_3c6d);
        h ^= h >> 12;
        h as f32 / u32::MAX as f32 * 2.0 - 1.0
    };
    let normal = |k: u32| [most * hash(k % size, 1), 0.1 * most * hash(k, 2)];
    NormalMap { width: size, height: size, wrap: Wrap::Repeat, projected: (0..size * size).map(normal).collect() }
}

/// The map turned by a quarter.
fn turned(map: &NormalMap) -> NormalMap {
    let normal = |k: u32| {
        let [x, y] = map.projected[(k % map.width * map.width + k / map.width) as usize];
        [-y, x]
    };
    NormalMap { projected: (0..map.width * map.height).map(normal).collect(), ..map.clone() }
}

fn baked(map: &NormalMap, roughness: &Roughness, axes: Option<Axes>) -> Textures {
    let options = TexturesOptions { anisotropy: axes, ..TexturesOptions::default() };
    bake(map, roughness, &options, &Silent).unwrap()
}

fn normal(level: &Level, at: usize) -> DVec3 {
    let [x, y] = level.normals[at].map(f64::from);
    DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt()).normalize()
}

fn texel(level: &Level, axes: Axes, i: u32, j: u32) -> Stretched {
    let at = (j * level.width + i) as usize;
    let anisotropy = level.anisotropies[at];
    Stretched {
        normal: normal(level, at),
        roughness: f64::from(level.alphas[at]).sqrt(),
        strength: f64::from(anisotropy.strength),
        direction: DVec2::from_array(anisotropy.direction.map(f64::from)),
        axes,
    }
}

fn on_sphere(polar: f64, azimuth: f64) -> DVec3 {
    DVec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos())
}

#[test]
fn an_anisotropic_texel_of_no_strength_is_an_isotropic_one() {
    let normal = DVec3::new(0.2, -0.3, 1.0).normalize();
    for (roughness, direction) in [(0.3, DVec2::X), (0.6, DVec2::new(-0.6, 0.8))] {
        let round = Facet { normal, alpha: roughness * roughness };
        let of = Stretched { normal, roughness, strength: 0.0, direction, axes: Axes::Normal };
        let flat = Stretched { normal: DVec3::Z, axes: Axes::Surface, ..of };
        let flat_round = Facet { normal: DVec3::Z, ..round };
        for k in 0..40 {
            let t = f64::from(k) + 0.5;
            let (view, light) = (on_sphere(0.03 * t, 1.7 * t), on_sphere(1.2 - 0.025 * t, 2.3 * t));
            for (of, round) in [(&of, &round), (&flat, &flat_round)] {
                let (found, expected) = (stretched_radiance(of, view, light), radiance(round, view, light));
                assert!((found - expected).abs() < 1e-9 * (1.0 + expected), "{found}, {expected}");
            }
        }
    }
}

/// ∫ of radiance over lights, seen from straight above, is 1 less what masking loses: more than for the α along the direction
/// everywhere, less than for that across it.
#[test]
fn an_anisotropic_texel_reflects_what_falls_on_it() {
    let energy = |radiance: &dyn Fn(DVec3) -> f64| {
        let steps = 600;
        let mut sum = 0.0;
        for i in 0..steps {
            for j in 0..steps {
                let z = (f64::from(i) + 0.5) / f64::from(steps);
                let azimuth = std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(steps);
                sum += radiance(on_sphere(z.acos(), azimuth));
            }
        }
        sum * std::f64::consts::TAU / f64::from(steps * steps)
    };
    let of = |strength: f64| Stretched {
        normal: DVec3::Z,
        roughness: 0.3_f64.sqrt(),
        strength,
        direction: DVec2::new(0.8, 0.6),
        axes: Axes::Surface,
    };
    let [round, stretched] =
        [0.0, 0.6].map(|strength| energy(&|light| stretched_radiance(&of(strength), DVec3::Z, light)));
    let wide = Facet { normal: DVec3::Z, alpha: 0.3 + 0.7 * 0.36 };
    let wide = energy(&|light| radiance(&wide, DVec3::Z, light));
    assert!(wide + 0.005 < stretched && stretched + 0.005 < round && round < 1.0, "{wide} {stretched} {round}");
}

#[test]
fn a_flat_map_has_no_strength() {
    let map = NormalMap { width: 8, height: 8, wrap: Wrap::Repeat, projected: vec![[0.0, 0.0]; 64] };
    for axes in BOTH {
        for level in baked(&map, &Roughness::Constant(0.4), Some(axes)).levels {
            assert!(level.anisotropies.iter().all(|of| of.strength == 0.0 && of.direction == [1.0, 0.0]));
            assert!(level.alphas.iter().all(|alpha| (alpha - 0.16).abs() < 1e-6), "{:?}", level.alphas);
        }
    }
    assert!(baked(&map, &Roughness::Constant(0.4), None).levels.iter().all(|level| level.anisotropies.is_empty()));
}

/// A plane that leans: its own highlight lies around its normal, that of an engine with axes of the surface cannot.
#[test]
fn axes_of_the_surface_stretch_the_highlight_of_normals_that_lean() {
    let map = NormalMap { width: 8, height: 8, wrap: Wrap::Repeat, projected: vec![[0.0, 0.2]; 64] };
    let roughness = Roughness::Constant(0.4);
    let [surface, normal] = BOTH.map(|axes| baked(&map, &roughness, Some(axes)).levels[1].anisotropies[0]);
    assert!(normal.strength == 0.0, "{normal:?}");
    assert!(surface.strength > 0.1 && surface.direction[0].abs() < 1e-3, "{surface:?}");
    // Which the bake knows: without anisotropy there is no error.
    for [with, without] in baked(&map, &roughness, Some(Axes::Surface)).against_round {
        assert!(with > 0.3 && without < 1e-3, "{with} {without}");
    }
    assert!(baked(&map, &roughness, Some(Axes::Normal)).against_round.is_empty());
}

#[test]
fn lines_have_their_direction_and_turn_with_the_map() {
    let map = lines(64, 0.3);
    let roughness = Roughness::Constant(0.4);
    for axes in BOTH {
        let [there, turned] = [&map, &turned(&map)].map(|map| baked(map, &roughness, Some(axes)));
        for (level, turned) in there.levels.iter().zip(&turned.levels).skip(1) {
            for (of, turned) in level.anisotropies.iter().zip(&turned.anisotropies) {
                assert!(of.direction[0] > 0.9 && turned.direction[1].abs() > 0.9, "{of:?} {turned:?}");
            }
            let mean = |of: &Level| of.anisotropies.iter().map(|of| of.strength).sum::<f32>() / of.alphas.len() as f32;
            assert!(mean(level) > 0.2 && (mean(level) - mean(turned)).abs() < 0.03, "{} {}", mean(level), mean(turned));
        }
    }
}

/// Neighbours are interpolated: a line has two directions, and all texels of all levels take the same.
#[test]
fn neighbours_point_to_the_same_side() {
    let map = turned(&lines(64, 0.3));
    let textures = baked(&map, &Roughness::Constant(0.3), Some(Axes::Normal));
    let all = || textures.levels.iter().skip(1).flat_map(|level| &level.anisotropies);
    let first = all().next().unwrap().direction[1];
    assert!(all().all(|of| of.direction[1] * first > 0.0));
}

/// The scan knows the reference's own lights.
#[test]
fn the_fit_comes_near_the_best_of_a_scan_and_beats_round_lobes() {
    let map = lines(64, 0.4);
    for (perceptual, axes) in [(0.3_f32, Axes::Surface), (0.5, Axes::Normal), (0.3, Axes::Normal)] {
        let roughness = Roughness::Constant(perceptual);
        let (stretched, round) = (baked(&map, &roughness, Some(axes)), baked(&map, &roughness, None));
        for mip in [3, 5] {
            let (level, round) = (&stretched.levels[mip as usize - 1], &round.levels[mip as usize - 1]);
            let all = probes(&map, &roughness, mip, 4, 192);
            let ours = measure(&all, |i, j| texel(level, axes, i, j)).error();
            let round = measure(&all, |i, j| {
                let at = (j * round.width + i) as usize;
                Facet { normal: normal(round, at), alpha: f64::from(round.alphas[at]) }
            });
            let scan = |probe| {
                let error = |k: u32| {
                    let (across, strength) = (f64::from(k % 12) / 11.0, f64::from(k / 12) / 15.0);
                    let of = |i, j| Stretched {
                        roughness: f64::from(perceptual) * (1.0 + 0.6 * across),
                        strength: 0.9 * strength,
                        direction: DVec2::X,
                        ..texel(level, axes, i, j)
                    };
                    measure(std::slice::from_ref(probe), of).error()
                };
                (0..192).map(error).fold(f64::INFINITY, f64::min)
            };
            // The fit's own samples are few; what they say of one against the other is what counts.
            if let Some([with, without]) = stretched.against_round.get(mip as usize - 1) {
                let (found, exact) = (f64::from(with / without), ours / round.error());
                assert!((found - exact).abs() < 0.1, "{perceptual} mip {mip}: {found} {exact}");
            }
            let best = all.iter().map(scan).sum::<f64>() / all.len() as f64;
            assert!(ours < 1.1 * best + 0.004, "{perceptual} mip {mip} {axes:?}: {ours}, the best of the scan {best}");
            assert!(ours < 0.8 * round.error(), "{perceptual} mip {mip} {axes:?}: {ours}, round {}", round.error());
        }
    }
}

#[test]
fn hard_cases_stay_in_range_on_any_threads() {
    let edge = |k: u32| if k.is_multiple_of(2) { [0.999_999, 0.0] } else { [-0.999_999, 0.0] };
    let of = |width, height, normal: &dyn Fn(u32) -> [f32; 2]| NormalMap {
        width,
        height,
        wrap: Wrap::Repeat,
        projected: (0..width * height).map(normal).collect(),
    };
    for map in [
        of(1, 13, &|k| [0.0, 0.05 * k as f32]),
        of(64, 1, &|k| [0.4 * ((k % 7) as f32 / 3.0 - 1.0), 0.0]),
        of(9, 8, &edge),
        lines(33, 0.9),
    ] {
        for perceptual in [0.0, 0.05, 0.3, 1.0] {
            for axes in BOTH {
                let on = |threads: usize| {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                    pool.install(|| baked(&map, &Roughness::Constant(perceptual), Some(axes)))
                };
                let one = on(1);
                assert!(one == on(3));
                for level in &one.levels {
                    assert_eq!(level.anisotropies.len(), level.alphas.len());
                    for (of, alpha) in level.anisotropies.iter().zip(&level.alphas) {
                        let length = of.direction[0].hypot(of.direction[1]);
                        assert!((0.0..=1.0).contains(&of.strength) && (length - 1.0).abs() < 1e-5, "{of:?}");
                        assert!((1e-3..=1.0).contains(alpha) && *alpha >= 0.999 * perceptual * perceptual, "{alpha}");
                    }
                }
            }
        }
    }
}
