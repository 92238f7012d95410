//! Hard cases: maps, footprints, roughness, views and lights at their extremes. Finite, in range, or an error with a name.

use glam::{Vec2, Vec3};
use glint_bake_core::area_light::bake::mip_chain;
use glint_bake_core::area_light::baked::{Maps, decode_tables};
use glint_bake_core::area_light::eval::{fetch, surface_radiance};
use glint_bake_core::area_light::rect::RectLight;
use glint_bake_core::area_light::{AreaLightMaterial, AreaLightOptions, bake};
use glint_bake_core::error::BakeError;
use glint_bake_core::normal_map::{HORIZON, NormalMap};
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_formats::Wrap;
use glint_formats::area_light::NormalStorage;

fn map(width: u32, height: u32, wrap: Wrap, normal: impl Fn(u32, u32) -> [f32; 2]) -> NormalMap {
    let projected = (0..width * height).map(|k| normal(k % width, k / width)).collect();
    NormalMap { width, height, wrap, projected }
}

fn baked(map: &NormalMap, storage: NormalStorage) -> AreaLightMaterial {
    let options = AreaLightOptions { anisotropic: true, storage, ..AreaLightOptions::default() };
    bake(map, &options, &Silent).unwrap()
}

fn maps() -> Vec<NormalMap> {
    let edge = HORIZON as f32;
    let mut rng = ItemRng::new(3, Purpose::Test(1), 0);
    let noise: Vec<[f32; 2]> = (0..37 * 21).map(|_| [rng.unit() as f32 - 0.5, rng.unit() as f32 - 0.5]).collect();
    let step = 2.0 / 255.0;
    vec![
        map(16, 16, Wrap::Repeat, |_, _| [0.0, 0.0]),
        map(16, 16, Wrap::Repeat, |_, _| [0.3, -0.7]),
        map(1, 1, Wrap::Repeat, |_, _| [0.1, 0.2]),
        map(1, 33, Wrap::Clamp, |_, y| [0.0, if y == 16 { edge } else { -0.2 }]),
        map(33, 1, Wrap::Repeat, |x, _| [0.01 * x as f32, 0.0]),
        map(37, 21, Wrap::Clamp, |x, y| noise[(y * 37 + x) as usize]),
        map(8, 8, Wrap::Repeat, |x, y| if (x + y) % 2 == 0 { [edge, 0.0] } else { [-edge, 0.0] }),
        map(8, 8, Wrap::Repeat, |x, _| if x < 4 { [0.0, edge] } else { [0.0, -edge] }),
        map(32, 32, Wrap::Repeat, |x, y| [step * ((x * 7 + y * 3) % 3) as f32 - step, 0.0]),
    ]
}

#[test]
fn every_map_bakes_to_values_in_range() {
    for map in maps() {
        for level in mip_chain(&map, &Silent) {
            assert_eq!(level.texels.len(), level.width as usize * level.height as usize);
            for texel in &level.texels {
                let length = texel.normal.length();
                assert!((0.0..=1.0 + 1e-6).contains(&length) && texel.normal.z >= 0.0, "{texel:?}");
                assert!((0.0..=1.0).contains(&texel.deficit), "{texel:?}");
                for alpha in [texel.alpha, texel.by_direction[0], texel.by_direction[1]] {
                    assert!((0.0..=1.0).contains(&alpha), "{texel:?}");
                }
                assert!((texel.axis.length() - 1.0).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn equal_normals_have_no_roughness() {
    for constant in [[0.0, 0.0], [0.3, -0.7], [0.9, 0.1]] {
        for level in mip_chain(&map(16, 5, Wrap::Repeat, |_, _| constant), &Silent) {
            for texel in &level.texels {
                assert_eq!((texel.alpha, texel.by_direction), (0.0, [0.0, 0.0]), "{texel:?}");
                assert!(texel.deficit < 1e-6 && (texel.normal.length() - 1.0).abs() < 1e-6);
            }
        }
    }
    // 8-bit flat: all equal but ±1 step. The roughness is that of the steps.
    let level = mip_chain(&maps()[8], &Silent).pop().unwrap();
    assert!(level.texels[0].alpha > 1e-3 && level.texels[0].alpha < 0.02, "{:?}", level.texels[0]);
}

#[test]
fn a_map_turned_by_a_quarter_has_its_roughness_turned() {
    let mut rng = ItemRng::new(9, Purpose::Test(1), 0);
    let lines: Vec<f32> = (0..64).map(|_| 0.8 * (rng.unit() as f32 - 0.5)).collect();
    let along_x = map(64, 64, Wrap::Repeat, |_, y| [0.0, lines[y as usize]]);
    let along_y = map(64, 64, Wrap::Repeat, |x, _| [-lines[x as usize], 0.0]);
    for (map, axis) in [(along_x, glam::DVec2::Y), (along_y, glam::DVec2::X)] {
        let top = mip_chain(&map, &Silent).pop().unwrap().texels[0];
        assert!(top.axis.dot(axis).abs() > 0.999, "{top:?}");
        assert!(top.by_direction[0] > 0.1 && top.by_direction[1] < 1e-3, "{top:?}");
    }
}

#[test]
fn a_map_too_large_for_the_limit_is_refused() {
    let map = map(64, 64, Wrap::Repeat, |_, _| [0.0, 0.0]);
    let refused = bake(&map, &AreaLightOptions { max_memory: 1 << 10, ..AreaLightOptions::default() }, &Silent);
    assert!(matches!(refused, Err(BakeError::LimitExceeded(why)) if why.contains("the limit is 1024")));
    let options = AreaLightOptions { base_roughness: 0.0, ..AreaLightOptions::default() };
    assert!(matches!(bake(&map, &options, &Silent), Err(BakeError::BadOption(_))));
}

#[test]
fn every_extreme_gives_a_finite_bounded_answer() {
    let half_pi = std::f32::consts::FRAC_PI_2;
    let direction = |theta: f32, phi: f32| Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
    let views = [(0.0, 0.0), (0.8, 1.0), (1.56, 4.0), (half_pi, 2.0), (2.0, 0.3)].map(|(t, p)| direction(t, p));
    let quad = |corners: [[f32; 3]; 4]| corners.map(Vec3::from_array);
    let lights = [
        quad([[-1.0, -1.0, 2.0], [-1.0, 1.0, 2.0], [1.0, 1.0, 2.0], [1.0, -1.0, 2.0]]),
        quad([[1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, -1.0]]),
        quad([[-1.0, -1.0, -2.0], [-1.0, 1.0, -2.0], [1.0, 1.0, -2.0], [1.0, -1.0, -2.0]]),
        quad([[-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0]]),
        quad([[0.0; 3], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]]),
        quad([[1.0, 0.0, 1.0]; 4]),
        quad([[1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [2.0, 0.0, 2.0], [2.0, 0.0, 2.0]]),
        quad([[1e20, 0.0, 1e20], [1e20, 1e20, 1e20], [0.0, 1e20, 1e20], [0.0, 0.0, 1e20]]),
    ];
    let positions = [Vec2::ZERO, Vec2::new(-0.01, 0.3), Vec2::new(1e9, -1e30), Vec2::new(f32::NAN, f32::INFINITY)];
    let footprints = [0.0, 0.01, 1.0, 37.5, 1e4, 1e30, f32::INFINITY, f32::NAN, -1.0];
    let tables = decode_tables(&glint_bake_core::area_light::baked::LtcTables::built_in());
    let mut bright = 0;
    for (k, map) in maps().iter().enumerate() {
        let material = baked(map, if k % 2 == 0 { NormalStorage::F16 } else { NormalStorage::Snorm8 });
        let maps = Maps::new(&material);
        for position in positions {
            for footprint in footprints {
                let surface = fetch(&maps, position, footprint);
                assert!((surface.normal.length() - 1.0).abs() < 1e-3, "{surface:?}");
                for alpha in [1e-3, 0.1, 1.0] {
                    for view in views {
                        for corners in lights {
                            for (lobes, two_sided) in [(0, true), (3, false), (9, true)] {
                                let light = RectLight { corners, radiance: 1.0, two_sided };
                                let found = surface_radiance(&tables, &surface, alpha, view, 0.9, &light, lobes);
                                assert!(
                                    (0.0..=1.02).contains(&found),
                                    "{found}: map {k} {position} {footprint} {light:?}"
                                );
                                bright += usize::from(found > 0.1);
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(bright > 1000, "{bright}");
}

#[test]
fn a_light_behind_gives_nothing_and_one_that_fills_the_sky_everything() {
    let material = baked(&map(4, 4, Wrap::Repeat, |_, _| [0.0, 0.0]), NormalStorage::F16);
    let tables = decode_tables(&material.tables);
    let surface = fetch(&Maps::new(&material), Vec2::ONE, 1.0);
    let sky = [[-1e4, -1e4, 1.0], [-1e4, 1e4, 1.0], [1e4, 1e4, 1.0], [1e4, -1e4, 1.0]].map(Vec3::from_array);
    let view = Vec3::new(0.6, 0.0, 0.8);
    let shade = |corners, two_sided, lobes| {
        surface_radiance(&tables, &surface, 0.2, view, 1.0, &RectLight { corners, radiance: 2.0, two_sided }, lobes)
    };
    for lobes in [0, 3] {
        let found = shade(sky, false, lobes);
        // What is missing is what GGX sends below the horizon and loses between facets.
        assert!(found > 1.8 && found <= 2.0, "{found}");
        let [a, b, c, d] = sky;
        assert_eq!(shade([d, c, b, a], false, lobes), 0.0);
        assert!((shade([d, c, b, a], true, lobes) - found).abs() < 1e-5);
        // An LTC reaches a little below the surface, where GGX does not.
        assert!(shade(sky.map(|p| -p), true, lobes) < 0.02);
    }
}
