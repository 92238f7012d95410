//! Counted facets against chances in f64 and facets one by one: smooth surfaces, chances, means, what lights share, and lifetimes.

use glam::{DVec3, Vec2, Vec3};
use glint_bake_core::area_light::baked::{Tables, decode_tables};
use glint_bake_core::area_light::rect::RectLight;
use glint_bake_core::glints::eval::{
    ConeLight, CountedSurface, FacetLight, cone_light, counted_surface, four_lights, hit_ratios, mean_radiance,
    no_light, rect_facets, sky_words,
};
use glint_bake_core::glints::reference::{ExplicitFacets, ReferenceSurface, cone_half_angle};
use glint_bake_core::glints::sampling::{counted_pdf, counted_sample};
use glint_bake_core::glints::{CountedFacets, GlintsOptions, bake};
use glint_bake_core::microfacet::{microfacet_area, microfacet_cosine};
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_formats::glints::Slopes;
use std::f64::consts::PI;

/// Solid angle of the sun's disk, half a degree wide.
const SUN: f32 = 6.8e-5;

fn options(slopes: Slopes, alpha: [f32; 2]) -> GlintsOptions {
    GlintsOptions { slopes, alpha, facet_spread: 1e-4, ..GlintsOptions::default() }
}

fn baked(options: &GlintsOptions) -> (CountedFacets, Tables) {
    let facets = bake(options, &Silent).unwrap();
    let tables = decode_tables(&facets.tables);
    (facets, tables)
}

/// Unit vector at an angle from the normal, in the plane of an azimuth, both in degrees.
fn towards(angle: f32, azimuth: f32) -> Vec3 {
    let (sine, cosine) = angle.to_radians().sin_cos();
    let (y, x) = azimuth.to_radians().sin_cos();
    Vec3::new(sine * x, sine * y, cosine)
}

/// A pixel of a tenth of a unit at `place`, seen from `view`.
fn pixel(facets: &CountedFacets, place: Vec2, view: Vec3) -> CountedSurface {
    counted_surface(facets.material(), place, Vec2::new(0.1, 0.0), Vec2::new(0.0, 0.1), view)
}

fn sun(direction: Vec3) -> ConeLight {
    ConeLight { direction, irradiance: Vec3::ONE, solid_angle_sr: SUN }
}

#[test]
fn the_smooth_surface_is_that_of_the_definitions() {
    let (mut area_worst, mut worst) = (0.0f64, 0.0f64);
    for slopes in [Slopes::Ggx, Slopes::Beckmann] {
        for alpha in [[0.01, 0.01], [0.1, 0.1], [0.5, 0.5], [1.0, 1.0], [0.6, 0.1], [1.0, 0.01]] {
            let options = options(slopes, alpha);
            let reference = ReferenceSurface::new(&options);
            let exact = reference.facet_area();
            area_worst = area_worst.max((f64::from(microfacet_area(options.smooth())) / exact - 1.0).abs());
            let f0 = Vec3::from_array(options.f0);
            for (view, light) in [
                (towards(0.0, 0.0), towards(5.0, 40.0)),
                (towards(60.0, 10.0), towards(58.0, 188.0)),
                (towards(80.0, 100.0), towards(30.0, -60.0)),
            ] {
                let found = microfacet_cosine(options.smooth(), f0, view, light).as_dvec3();
                let exact = reference.brdf_cosine(view.as_dvec3(), light.as_dvec3());
                // Of what is next to nothing, nothing is left.
                worst = worst.max((found - exact).length() / exact.length().max(1e-6));
            }
        }
    }
    println!("facet area off by {area_worst:.1e}, BRDF by {worst:.1e}");
    assert!(area_worst < 1e-4, "{area_worst}");
    // Walter's Λ of Beckmann slopes is off by half a per cent.
    assert!(worst < 0.006, "{worst}");
}

/// Eq. 9 with D at the middle of the cone: exact for cones that are small beside the lobe.
#[test]
fn chances_of_a_sun_are_those_of_the_definition() {
    for slopes in [Slopes::Ggx, Slopes::Beckmann] {
        for alpha in [[0.01, 0.01], [0.03, 0.03], [0.1, 0.1], [0.4, 0.1], [1.0, 1.0]] {
            let options = options(slopes, alpha);
            let (facets, _) = baked(&options);
            let reference = ReferenceSurface::new(&options);
            let area = reference.facet_area();
            let seen = f64::from(SUN) + PI * 1e-8;
            let mut worst = 0.0f64;
            for (view, light) in [
                (towards(0.0, 0.0), towards(0.0, 0.0)),
                (towards(20.0, 0.0), towards(22.0, 182.0)),
                (towards(60.0, 30.0), towards(57.0, 211.0)),
                (towards(75.0, 90.0), towards(76.0, 270.0)),
            ] {
                let found = f64::from(cone_light(pixel(&facets, Vec2::ZERO, view), sun(light)).chance);
                let exact = reference.cone_chance(view.as_dvec3(), light.as_dvec3(), seen, area);
                worst = worst.max((found / exact - 1.0).abs());
            }
            println!("{slopes:?} {alpha:?}: chances of a sun are off by {worst:.1e}");
            // The cone is nearly as wide as the lobe at a roughness of 0.01 that is seen from the side.
            let most = match slopes {
                _ if alpha[0] > 0.02 => 0.005,
                Slopes::Ggx => 0.12,
                Slopes::Beckmann => 0.03,
            };
            assert!(worst < most, "{slopes:?} {alpha:?}: {worst}");
        }
    }
}

/// A rectangle around the mirror image of the eye, `angle` degrees wide and high, at a distance of 2.
fn rect_at(direction: Vec3, degrees: f32) -> RectLight {
    let half = (0.5 * degrees).to_radians().tan() * 2.0;
    let x = direction.any_orthonormal_vector() * half;
    let y = direction.cross(x);
    let middle = direction * 2.0;
    RectLight {
        corners: [middle - x - y, middle + x - y, middle + x + y, middle - x + y],
        radiance: 1.0,
        two_sided: true,
    }
}

#[test]
fn chances_of_rectangles_are_near_those_of_the_definition() {
    println!("alpha  view  width  chance exact off");
    // Lobes without tails hold next to nothing of a rectangle that lies beside them.
    for (slopes, alphas, most) in
        [(Slopes::Ggx, &[0.1f32, 0.3, 0.6][..], [0.025, 0.11]), (Slopes::Beckmann, &[0.3, 0.6], [0.025, 0.1])]
    {
        let (mut sum, mut worst, mut count) = (0.0, 0.0f64, 0.0);
        for &alpha in alphas {
            let options = options(slopes, [alpha; 2]);
            let (facets, tables) = baked(&options);
            let reference = ReferenceSurface::new(&options);
            let area = reference.facet_area();
            for angle in [0.0f32, 40.0, 60.0] {
                let view = towards(angle, 0.0);
                for (degrees, aside) in [(10.0f32, 0.0f32), (40.0, 0.0), (20.0, 25.0)] {
                    let light = rect_at(towards(angle, 180.0 + aside), degrees);
                    let found = f64::from(rect_facets(&tables, pixel(&facets, Vec2::ZERO, view), &light).chance);
                    let corners = light.corners.map(|corner| corner.as_dvec3());
                    let exact = reference.rect_chance(view.as_dvec3(), corners, area);
                    let off = found / exact - 1.0;
                    println!("{alpha:5.2} {angle:4.0}° {degrees:4.0}° {found:.4} {exact:.4} {off:+.3}");
                    sum += off.abs();
                    worst = worst.max(off.abs());
                    count += 1.0;
                }
            }
        }
        println!("{slopes:?}: mean {:.3}, worst {worst:.3}", sum / count);
        assert!(sum / count < most[0] && worst < most[1], "{slopes:?}: {} {worst}", sum / count);
    }
}

/// Mean over seeds and its standard error.
fn mean_and_error(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut sum, mut square, mut count) = (0.0, 0.0, 0.0);
    for value in values {
        sum += value;
        square += value * value;
        count += 1.0;
    }
    let mean = sum / count;
    (mean, ((square / count - mean * mean).max(0.0) / count).sqrt())
}

#[test]
fn the_mean_over_seeds_is_the_smooth_surface_for_every_light() {
    const SEEDS: u32 = 1024;
    let mut loose = 0;
    for alpha in [0.01f32, 0.1, 0.4, 1.0] {
        let mut options = options(Slopes::Ggx, [alpha; 2]);
        options.relative_area = 0.7;
        let (facets, tables) = baked(&options);
        for density in [1e-2f32, 1.0, 1e2, 1e5, 1e8, 1e12] {
            let view = towards(40.0, 10.0);
            let lights = |surface| {
                let suns = [towards(41.0, 190.0), towards(35.0, 200.0)].map(|to| cone_light(surface, sun(to)));
                [suns[0], suns[1], rect_facets(&tables, surface, &rect_at(towards(40.0, 190.0), 30.0)), no_light()]
            };
            let surface = |seed| {
                let mut material = facets.material();
                (material.density, material.seed) = (density, seed);
                counted_surface(material, Vec2::new(3.0, 1.0), Vec2::new(0.1, 0.0), Vec2::new(0.0, 0.1), view)
            };
            for only in 0..4 {
                let of = |seed| {
                    let surface = surface(seed);
                    let mut all = lights(surface);
                    // The last turn is all three together.
                    if only < 3 {
                        all = [all[only], no_light(), no_light(), no_light()];
                    }
                    f64::from(four_lights(surface, &[], all).y)
                };
                let smooth: f64 = {
                    let all = lights(surface(0));
                    let picked: Vec<&FacetLight> = if only < 3 { vec![&all[only]] } else { all.iter().collect() };
                    picked.iter().map(|light| f64::from(light.radiance.y)).sum()
                };
                let (mean, error) = mean_and_error((0..SEEDS).map(of));
                let off = (mean - smooth).abs();
                let most = (4.0 * error).max(1e-5 * smooth);
                // Of facets so rare that 1024 seeds hardly meet one, the error of the mean says nothing.
                let expected = f64::from(surface(0).facets * lights(surface(0))[only % 3].chance) * f64::from(SEEDS);
                if expected > 30.0 || off <= most {
                    assert!(
                        off <= most,
                        "α {alpha}, density {density}, light {only}: {mean} ± {error}, smooth {smooth}"
                    );
                } else {
                    loose += 1;
                }
                if expected > 30.0 && error < 0.0025 * smooth {
                    assert!(off < 0.01 * smooth, "α {alpha}, density {density}, light {only}: {mean}, smooth {smooth}");
                }
            }
        }
    }
    println!("{loose} of 96 means are of facets too rare to say");
    assert!(loose < 48, "{loose}");
}

/// Variance of a facet count: that of N p (1 − p) where N is whole.
#[test]
fn the_variance_over_seeds_is_that_of_independent_facets() {
    let (facets, _) = baked(&options(Slopes::Ggx, [0.2; 2]));
    let view = towards(30.0, 0.0);
    for density in [4e4f32, 4e5, 4e6, 4e7, 4e9] {
        let of = |seed| {
            let mut material = facets.material();
            (material.density, material.seed) = (density, seed);
            let surface = counted_surface(material, Vec2::ZERO, Vec2::new(0.1, 0.0), Vec2::new(0.0, 0.1), view);
            let light = cone_light(surface, sun(towards(30.0, 180.0)));
            (
                hit_ratios(surface, [light, no_light(), no_light(), no_light()])[0],
                surface.facets * light.chance,
                light.chance,
            )
        };
        let (_, expected, chance) = of(0);
        let (mut sum, mut count) = (0.0, 0.0);
        for seed in 0..40_000 {
            sum += (f64::from(of(seed).0) - 1.0).powi(2);
            count += 1.0;
        }
        let exact = (1.0 - f64::from(chance)) / f64::from(expected);
        let off = sum / count / exact - 1.0;
        println!("{expected:.3} hits expected: variance off by {off:+.3}");
        assert!(off.abs() < 0.02, "{expected}: {off}");
    }
}

/// Correlation of the hits of two lights over places.
fn shared(facets: &CountedFacets, view: Vec3, lights: [Vec3; 2], solid_angle_sr: f32) -> f64 {
    let mut sums = [0.0f64; 5];
    const PLACES: u32 = 20_000;
    for k in 0..PLACES {
        let place = Vec2::new((k % 141) as f32, (k / 141) as f32) * 3.7;
        let surface = pixel(facets, place, view);
        let [a, b] = lights.map(|direction| cone_light(surface, ConeLight { solid_angle_sr, ..sun(direction) }));
        let [x, y, ..] = hit_ratios(surface, [a, b, no_light(), no_light()]).map(f64::from);
        for (sum, value) in sums.iter_mut().zip([x, y, x * x, y * y, x * y]) {
            *sum += value / f64::from(PLACES);
        }
    }
    let [x, y, xx, yy, xy] = sums;
    (xy - x * y) / ((xx - x * x) * (yy - y * y)).sqrt()
}

#[test]
fn lights_that_lie_together_share_facets_and_lights_apart_do_not() {
    let mut options = options(Slopes::Ggx, [0.3; 2]);
    options.density = 1e7;
    let (facets, _) = baked(&options);
    let view = towards(35.0, 0.0);
    let light = towards(35.0, 180.0);
    let same = shared(&facets, view, [light, light], SUN);
    let apart = shared(&facets, view, [light, towards(41.0, 180.0)], SUN);
    println!("correlation of two suns: {same:.3} in one place, {apart:.3} six degrees apart");
    assert!(same > 0.999 && apart.abs() < 0.03, "{same} {apart}");
}

/// A facet reflects a turning light for as long as the light's disk covers the facet's mirror direction.
#[test]
fn facets_live_as_long_as_explicit_ones_under_a_turning_light() {
    const ALPHA: f32 = 0.4;
    let spread = 0.05f32;
    let mut options = options(Slopes::Ggx, [ALPHA; 2]);
    (options.facet_spread, options.density) = (spread, 1e5);
    let (facets, _) = baked(&options);
    let explicit = ExplicitFacets::new(1 << 20, f64::from(ALPHA), &mut ItemRng::new(3, Purpose::Test(81), 0));
    for (angle, azimuth) in [(10.0f32, 0.0f32), (50.0, 0.0), (50.0, 90.0)] {
        let view = towards(angle, 0.0);
        let light = towards(angle, 180.0);
        for share in [0.25f32, 0.5, 1.0, 1.5] {
            let turn = share * spread;
            // In the plane of incidence, or out of it.
            let moved = if azimuth == 0.0 {
                towards(angle + turn.to_degrees(), 180.0)
            } else {
                (light * turn.cos() + Vec3::Y * turn.sin()).normalize()
            };
            let found = shared(&facets, view, [light, moved], 0.0);
            let lit = |direction: Vec3| explicit.lit(view.as_dvec3(), direction.as_dvec3(), f64::from(spread));
            let (before, after) = (lit(light), lit(moved));
            let count = |lit: &[bool]| lit.iter().filter(|lit| **lit).count() as f64;
            let both = before.iter().zip(&after).filter(|(a, b)| **a && **b).count() as f64;
            let exact = both / (count(&before) * count(&after)).sqrt();
            println!(
                "{angle}°, turned by {share} of the spread, azimuth {azimuth}: correlation {found:.3}, explicit {exact:.3}"
            );
            assert!((found - exact).abs() < 0.06, "{angle} {share} {azimuth}: {found} {exact}");
        }
    }
}

/// The chance of an explicit facet is that of the quadrature.
#[test]
fn explicit_facets_reflect_as_often_as_the_definition_says() {
    let options = options(Slopes::Ggx, [0.3; 2]);
    let reference = ReferenceSurface::new(&options);
    let facets = ExplicitFacets::new(1 << 19, f64::from(0.3f32), &mut ItemRng::new(3, Purpose::Test(82), 0));
    let view = towards(40.0, 0.0).as_dvec3();
    let light = towards(35.0, 180.0).as_dvec3();
    let solid_angle = 0.01;
    let lit = facets.lit(view, light, cone_half_angle(solid_angle)).iter().filter(|lit| **lit).count() as f64;
    let found = lit / facets.normals.len() as f64;
    let exact = reference.cone_chance(view, light, solid_angle, reference.facet_area());
    // Four standard deviations of the count.
    assert!((found - exact).abs() < 4.0 * (exact / facets.normals.len() as f64).sqrt(), "{found} {exact}");
}

#[test]
fn every_hard_case_gives_a_finite_answer() {
    for slopes in [Slopes::Ggx, Slopes::Beckmann] {
        for alpha in [[1e-3f32, 1e-3], [1.0, 1e-3], [1.0, 1.0]] {
            let (facets, tables) = baked(&options(slopes, alpha));
            for density in [0.0f32, 1e-30, 1.0, 1e16] {
                for view in [towards(0.0, 0.0), towards(89.99, 30.0), Vec3::X] {
                    for direction in [view * Vec3::new(-1.0, -1.0, 1.0), Vec3::Z, Vec3::X, -Vec3::Z, -view] {
                        let mut material = facets.material();
                        material.density = density;
                        for (dx, dy) in [(Vec2::X, Vec2::Y), (Vec2::ZERO, Vec2::ZERO), (Vec2::X * 1e9, Vec2::X * 1e9)] {
                            let surface = counted_surface(material, Vec2::splat(1e9), dx, dy, view);
                            let mut lights = [no_light(); 4];
                            for (light, solid_angle_sr) in lights.iter_mut().zip([0.0, SUN, 7.0]) {
                                *light = cone_light(surface, ConeLight { solid_angle_sr, ..sun(direction) });
                            }
                            // Touching the surface where it is shaded.
                            let corners = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 0.0, 1.0), Vec3::Z];
                            let rect = RectLight { corners, radiance: 1.0, two_sided: true };
                            lights[3] = rect_facets(&tables, surface, &rect);
                            let found = four_lights(surface, &[], lights);
                            assert!(
                                found.is_finite() && found.min_element() >= 0.0,
                                "{material:?} {direction}: {found}"
                            );
                            assert!(lights.iter().all(|light| (0.0..=1.0).contains(&light.chance)), "{lights:?}");
                            assert!(sky_words(surface, 16).iter().all(|word| (0.0..=1.0).contains(word)));
                        }
                    }
                }
            }
        }
    }
}

/// Materials with and without layers, of both distributions of slopes.
fn layered() -> Vec<GlintsOptions> {
    let of = |slopes, alpha, f0, diffuse, coat| GlintsOptions {
        f0: [f0; 3],
        diffuse: [diffuse; 3],
        coat,
        coat_alpha: 0.2,
        turn: 0.7,
        ..options(slopes, alpha)
    };
    vec![
        of(Slopes::Ggx, [0.3, 0.3], 1.0, 0.0, 0.0),
        of(Slopes::Ggx, [0.5, 0.2], 0.04, 0.8, 0.0),
        of(Slopes::Ggx, [0.4, 0.4], 1.0, 0.0, 1.0),
        of(Slopes::Beckmann, [0.2, 0.4], 0.3, 0.5, 0.7),
    ]
}

/// What the whole material reflects of light from `light` towards `view`, on average over seeds, linear RGB.
fn reflected(facets: &CountedFacets, view: Vec3, light: Vec3) -> Vec3 {
    let cone = ConeLight { direction: light, irradiance: Vec3::ONE, solid_angle_sr: 0.0 };
    let found = cone_light(pixel(facets, Vec2::ZERO, view), cone);
    mean_radiance(facets.material(), found.radiance) + found.beside
}

/// Integral over the hemisphere of `f`, by `steps`² directions even in solid angle times the cosine.
fn over_hemisphere(steps: u32, mut f: impl FnMut(Vec3) -> f64) -> f64 {
    let mut sum = 0.0;
    for i in 0..steps {
        // Finer towards the horizon, where lobes seen from the side lie.
        let t = (f64::from(i) + 0.5) / f64::from(steps);
        let (sine, cosine) = (t * 0.5 * PI).sin_cos();
        for j in 0..steps {
            let (y, x) = ((f64::from(j) + 0.5) / f64::from(steps) * 2.0 * PI).sin_cos();
            let light = DVec3::new(sine * x, sine * y, cosine).as_vec3();
            sum += f(light) * sine * PI * PI / f64::from(steps).powi(2);
        }
    }
    sum
}

/// The layers are those of their definitions in f64: Lambert's law, and GGX at an F0 of 0.04.
#[test]
fn layers_are_those_of_their_definitions() {
    let mut worst = 0.0f64;
    for options in layered() {
        let (facets, _) = baked(&options);
        let coat =
            GlintsOptions { f0: [0.04; 3], alpha: [options.coat_alpha; 2], slopes: Slopes::Ggx, ..options.clone() };
        let (coat, base) =
            (ReferenceSurface::new(&coat), ReferenceSurface::new(&GlintsOptions { turn: 0.0, ..options.clone() }));
        for (view, light) in [
            (towards(0.0, 0.0), towards(5.0, 40.0)),
            (towards(60.0, 10.0), towards(58.0, 188.0)),
            (towards(80.0, 100.0), towards(30.0, -60.0)),
        ] {
            let (v, l) = (view.as_dvec3(), light.as_dvec3());
            let schlick = |f0: f64, cosine: f64| f0 + (1.0 - f0) * (1.0 - cosine).powi(5);
            let weight = f64::from(options.coat);
            let through = 1.0 - weight * schlick(0.04, v.z);
            let entering = 1.0 - schlick(f64::from(options.f0[0]), v.z);
            let exact =
                weight * coat.brdf_cosine(v, l).x + through * f64::from(options.diffuse[0]) * entering * l.z / PI;
            let cone = ConeLight { direction: light, irradiance: Vec3::ONE, solid_angle_sr: 0.0 };
            let found = f64::from(cone_light(pixel(&facets, Vec2::ZERO, view), cone).beside.x);
            worst = worst.max((found - exact).abs() / exact.max(1e-3));
            // Facets have what the coat leaves.
            let turn = f64::from(options.turn);
            let turned =
                |v: DVec3| DVec3::new(turn.cos() * v.x + turn.sin() * v.y, turn.cos() * v.y - turn.sin() * v.x, v.z);
            let exact = through * base.brdf_cosine(turned(v), turned(l)).x;
            let found = f64::from(cone_light(pixel(&facets, Vec2::ZERO, view), cone).radiance.x);
            worst = worst.max((found - exact).abs() / exact.max(1e-3));
        }
    }
    println!("layers are off by {worst:.1e}");
    assert!(worst < 0.004, "{worst}");
}

/// A white material under light from everywhere gives no more than falls on it.
#[test]
fn no_material_gives_more_light_than_falls_on_it() {
    for options in layered() {
        let (facets, _) = baked(&GlintsOptions {
            f0: options.f0,
            diffuse: options.diffuse.map(|d| if d > 0.0 { 1.0 } else { 0.0 }),
            ..options
        });
        for angle in [0.0f32, 45.0, 70.0, 85.0] {
            let view = towards(angle, 20.0);
            let albedo = over_hemisphere(400, |light| f64::from(reflected(&facets, view, light).x));
            println!(
                "{:?} α {:?}, coat {}: albedo {albedo:.4} at {angle}°",
                facets.params.slopes, facets.params.alpha, facets.params.coat
            );
            assert!(albedo < 1.0, "{angle}: {albedo}");
        }
    }
}

/// χ² of directions over 20 × 40 equal bins of the hemisphere, and one for what lies below.
#[test]
fn samples_have_the_density_that_is_said() {
    const SAMPLES: u32 = 400_000;
    let (rows, columns) = (20usize, 40usize);
    for options in layered() {
        let (facets, _) = baked(&options);
        let material = facets.material();
        for angle in [10.0f32, 65.0] {
            let view = towards(angle, 30.0);
            let rng = &mut ItemRng::new(5, Purpose::Test(83), 0);
            let mut counts = vec![0.0f64; rows * columns + 1];
            for _ in 0..SAMPLES {
                let [x, y, z] = [rng.unit(), rng.unit(), rng.unit()].map(|u| u as f32);
                let light = counted_sample(material, view, Vec3::new(x, y, z));
                assert!((light.length() - 1.0).abs() < 1e-3, "{light}");
                let bin = if light.z > 0.0 {
                    let turn = f64::from(light.y).atan2(f64::from(light.x)) / (2.0 * PI) + 0.5;
                    let row = (f64::from(light.z) * rows as f64) as usize;
                    row.min(rows - 1) * columns + ((turn * columns as f64) as usize).min(columns - 1)
                } else {
                    rows * columns
                };
                counts[bin] += 1.0;
            }
            let mut expected = vec![0.0f64; rows * columns + 1];
            const FINE: usize = 32;
            let cell = 2.0 * PI / ((rows * columns * FINE * FINE) as f64);
            for i in 0..rows * FINE {
                for j in 0..columns * FINE {
                    let z = (i as f64 + 0.5) / (rows * FINE) as f64;
                    let turn = ((j as f64 + 0.5) / (columns * FINE) as f64 - 0.5) * 2.0 * PI;
                    let across = (1.0 - z * z).sqrt();
                    let light = DVec3::new(across * turn.cos(), across * turn.sin(), z).as_vec3();
                    expected[i / FINE * columns + j / FINE] += f64::from(counted_pdf(material, view, light)) * cell;
                }
            }
            expected[rows * columns] = 1.0 - expected.iter().sum::<f64>();
            let (mut chi2, mut freedom) = (0.0, 0.0);
            for (count, share) in counts.iter().zip(&expected) {
                let expected = share * f64::from(SAMPLES);
                if expected > 20.0 {
                    chi2 += (count - expected).powi(2) / expected;
                    freedom += 1.0;
                }
            }
            println!("{:?} at {angle}°: χ² {chi2:.1} of {freedom} bins", options.slopes);
            assert!(
                freedom > 50.0 && chi2 < freedom + 5.0 * f64::sqrt(2.0 * freedom),
                "{options:?} {angle}: {chi2} of {freedom}"
            );
        }
    }
}

/// The mean of what samples weigh, glints and all, is the albedo of the smooth surface.
#[test]
fn the_mean_of_sampled_weights_is_the_albedo() {
    const SAMPLES: u32 = 200_000;
    for mut options in layered() {
        // Many pixels of facets that are seldom lit would need more samples than there is time for.
        (options.facet_spread, options.density, options.relative_area) = (0.1, 1e5, 0.8);
        let (facets, _) = baked(&options);
        for angle in [10.0f32, 60.0] {
            let view = towards(angle, 30.0);
            let mut material = facets.material();
            let cone = |direction| ConeLight { direction, irradiance: Vec3::ONE, solid_angle_sr: 0.0 };
            let at = |material| counted_surface(material, Vec2::ZERO, Vec2::new(0.1, 0.0), Vec2::new(0.0, 0.1), view);
            let albedo = over_hemisphere(400, |light| {
                let found = cone_light(at(material), cone(light));
                f64::from((mean_radiance(material, found.radiance) + found.beside).x)
            });
            let rng = &mut ItemRng::new(5, Purpose::Test(84), 0);
            let (mean, error) = mean_and_error((0..SAMPLES).map(|seed| {
                material.seed = seed;
                let [x, y, z] = [rng.unit(), rng.unit(), rng.unit()].map(|u| u as f32);
                let light = counted_sample(material, view, Vec3::new(x, y, z));
                if light.z <= 0.0 {
                    return 0.0;
                }
                let surface = at(material);
                let found = cone_light(surface, cone(light));
                let seen = four_lights(surface, &[], [found, no_light(), no_light(), no_light()]).x;
                f64::from(seen / counted_pdf(material, view, light))
            }));
            println!("{:?} at {angle}°: albedo {albedo:.4}, sampled {mean:.4} ± {error:.4}", options.slopes);
            assert!((mean - albedo).abs() < 4.0 * error + 1e-3, "{options:?} {angle}: {mean} ± {error}, {albedo}");
            assert!(error < 0.02 * albedo, "{options:?} {angle}: {mean} ± {error}");
        }
    }
}

/// A light without extent is as wide as a facet's own cone, so that it never gives nothing.
#[test]
fn a_light_without_extent_is_seen_in_facets_as_wide_as_their_spread() {
    let mut options = options(Slopes::Ggx, [0.3; 2]);
    options.facet_spread = 0.01;
    let (facets, _) = baked(&options);
    let surface = pixel(&facets, Vec2::ZERO, Vec3::Z);
    let point = cone_light(surface, ConeLight { solid_angle_sr: 0.0, ..sun(Vec3::Z) });
    let exact = ReferenceSurface::new(&options).cone_chance(
        DVec3::Z,
        DVec3::Z,
        PI * 1e-4,
        ReferenceSurface::new(&options).facet_area(),
    );
    assert!((f64::from(point.chance) / exact - 1.0).abs() < 0.01, "{} {exact}", point.chance);
}
