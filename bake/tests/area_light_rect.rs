//! The rectangle integral, clipped by the horizon, against a sum over the rectangle in f64; and where it is degenerate.

use glam::{DVec3, Vec3};
use glint_bake_core::area_light::rect::quad_form_factor;
use glint_bake_core::rng::{ItemRng, Purpose};
use std::f64::consts::PI;

/// ∫ max(z, 0) |n_A · ω| / (π r²) dA over a parallelogram, by midpoints.
fn reference(corner: DVec3, e: DVec3, f: DVec3, n: u32) -> f64 {
    let across = e.cross(f);
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n {
            let p = corner + e * ((f64::from(i) + 0.5) / f64::from(n)) + f * ((f64::from(j) + 0.5) / f64::from(n));
            let r2 = p.length_squared();
            sum += p.z.max(0.0) * across.dot(p).abs() / (r2 * r2);
        }
    }
    sum / (PI * f64::from(n * n))
}

fn corners(c: DVec3, e: DVec3, f: DVec3) -> [Vec3; 4] {
    [c, c + e, c + e + f, c + f].map(|p| p.as_vec3())
}

#[test]
fn rectangles_anywhere_are_sums_over_them() {
    let mut clipped = 0;
    for k in 0..300 {
        let mut rng = ItemRng::new(5, Purpose::Test(1), k);
        let mut point = || DVec3::new(rng.unit(), rng.unit(), rng.unit()) * 2.0 - 1.0;
        let (centre, e, f) = (point() * 2.0, point(), point());
        // Near enough a plane through the origin, midpoints do not find the peak; that is the next test's.
        let distance = (centre.dot(e.cross(f)) / e.cross(f).length()).abs();
        if distance < 0.3 {
            continue;
        }
        let c = centre - 0.5 * (e + f);
        let exact = reference(c, e, f, 300);
        let found = f64::from(quad_form_factor(corners(c, e, f)));
        assert!((found - exact).abs() < 1e-4, "{k}: {found} {exact}");
        let below = [c, c + e, c + e + f, c + f].iter().filter(|p| p.z < 0.0).count();
        clipped += usize::from((1..4).contains(&below));
    }
    assert!(clipped > 20, "{clipped}");
}

#[test]
fn what_is_known_in_closed_form() {
    // A square around the zenith that fills the sky, the same half below the horizon, and a strip on the horizon.
    let square = |half: f64, z: f64| corners(DVec3::new(-half, -half, z), DVec3::X * 2.0 * half, DVec3::Y * 2.0 * half);
    assert!((quad_form_factor(square(1e6, 1.0)) - 1.0).abs() < 1e-5);
    assert_eq!(quad_form_factor(square(1.0, -1.0)), 0.0);
    // Nearly touching, it covers all there is.
    assert!((quad_form_factor(square(1.0, 1e-6)) - 1.0).abs() < 1e-5);
    // A wall from the horizon up, as wide and high as can be, fills half of the sky's projected area.
    let wall = corners(DVec3::new(1.0, -1e6, 0.0), DVec3::Y * 2e6, DVec3::Z * 1e6);
    assert!((quad_form_factor(wall) - 0.5).abs() < 1e-5);
    // The part of a wall below the horizon does not count.
    let deep = corners(DVec3::new(1.0, -1e6, -1e6), DVec3::Y * 2e6, DVec3::Z * 2e6);
    assert!((quad_form_factor(deep) - 0.5).abs() < 1e-5);
}

#[test]
fn degenerate_rectangles_are_finite_and_in_range() {
    let points = [
        Vec3::ZERO,
        Vec3::X,
        -Vec3::X,
        Vec3::Z,
        -Vec3::Z,
        Vec3::new(1.0, 0.0, 1e-30),
        Vec3::new(1.0, 1e-7, -1e-7),
        Vec3::new(0.0, 1e-38, 1e-38),
        Vec3::new(1e30, -1e30, 1e30),
        Vec3::new(f32::MAX, f32::MAX, -f32::MAX),
        Vec3::new(f32::NAN, 0.0, 1.0),
        Vec3::new(0.0, f32::INFINITY, 1.0),
    ];
    let n = points.len();
    for k in 0..n.pow(4) {
        let quad = [points[k % n], points[k / n % n], points[k / n / n % n], points[k / n / n / n]];
        let found = quad_form_factor(quad);
        assert!((0.0..=1.0).contains(&found), "{quad:?}: {found}");
    }
}

#[test]
fn moving_through_the_horizon_is_continuous() {
    // A light rises; nothing jumps as its corners pass the horizon one by one.
    let at = |height: f64| {
        let (e, f) = (DVec3::new(0.3, 1.0, 0.2), DVec3::new(0.1, -0.2, 0.7));
        f64::from(quad_form_factor(corners(DVec3::new(1.0, -0.5, height), e, f)))
    };
    let mut before = at(-1.2);
    assert_eq!(before, 0.0);
    for k in 1..=4000 {
        let found = at(-1.2 + 2.0 * f64::from(k) / 4000.0);
        assert!((found - before).abs() < 1e-3, "{k}: {found} after {before}");
        before = found;
    }
    assert!(before > 0.02, "{before}");
}
