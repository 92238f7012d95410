//! MikkTSpace, the tangents that bakers of normal maps agree on, in time that grows as the mesh does.
//! Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, chapter 3, without the angle at which groups are split.
//!
//! A corner's tangent is the mean of the directions of +u on the triangles of its group, in the plane of its normal, weighted
//! by the triangles' angles there. A group is the triangles around a corner that can be reached over shared edges without
//! crossing a mirroring of uv. Corners are shared that have position, normal and uv in common.
//!
//! The bevy_mikktspace crate gives the same, bit by bit, which the tests hold; it is not used because its time grows as the
//! square of the triangles that share an edge or a corner or have no area, and its stack as those around a corner.

use glam::{Vec2, Vec3, Vec4};
use std::collections::{HashMap, VecDeque};

/// What is known of a triangle.
#[derive(Clone, Copy, Debug, Default)]
struct Triangle {
    /// Numbers of its corners, those that are the same having the same number.
    corners: [u32; 3],
    /// Two corners have the same position.
    degenerate: bool,
    /// uv give no directions: such triangles follow those around.
    loose: bool,
    /// uv are not mirrored.
    upright: bool,
    /// Unit directions in which u grows.
    along: Vec3,
    /// The triangles beyond the edges from a corner to the next.
    beyond: [Option<u32>; 3],
    /// Whether the corners are in a group.
    grouped: [bool; 3],
}

/// Directions of +u at the corners of triangles, three in a row, in f32 as given; w is -1 where uv are mirrored, else 1. `None`
/// where neither the triangle's uv nor those around have a direction. v points up here.
pub(super) fn tangents(positions: &[Vec3], normals: &[Vec3], uv: &[Vec2]) -> Vec<Option<Vec4>> {
    let shared = shared_corners(positions, normals, uv);
    let mut triangles: Vec<Triangle> = (0..positions.len() / 3)
        .map(|t| {
            let [a, b, c] = [3 * t, 3 * t + 1, 3 * t + 2];
            let corners = [shared[a], shared[b], shared[c]];
            triangle(corners, [positions[a], positions[b], positions[c]], [uv[a], uv[b], uv[c]])
        })
        .collect();
    join_over_edges(&mut triangles);
    let mut tangents = vec![None; positions.len()];
    let mut group = Vec::new();
    let mut waiting = Vec::new();
    for t in 0..triangles.len() {
        for k in 0..3 {
            if triangles[t].degenerate || triangles[t].loose || triangles[t].grouped[k] {
                continue;
            }
            collect_group(&mut triangles, t as u32, k, &mut group, &mut waiting);
            let corner = triangles[t].corners[k];
            let along = mean_along(&triangles, &group, corner, positions, normals[3 * t + k]);
            let w = if triangles[t].upright { 1.0 } else { -1.0 };
            for &member in &group {
                let place = 3 * member as usize + place_of(&triangles[member as usize], corner);
                tangents[place] = Some(along.extend(w));
            }
        }
    }
    follow(&triangles, &mut tangents);
    tangents
}

/// A number for each corner, equal where all that a corner has is.
fn shared_corners(positions: &[Vec3], normals: &[Vec3], uv: &[Vec2]) -> Vec<u32> {
    let mut known: HashMap<[u32; 8], u32> = HashMap::new();
    let all = positions.iter().zip(normals).zip(uv);
    all.map(|((p, n), uv)| {
        let next = known.len() as u32;
        *known.entry([p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y].map(f32::to_bits)).or_insert(next)
    })
    .collect()
}

/// A triangle by itself: equations 18 and 19 of the paper.
fn triangle(corners: [u32; 3], [a, b, c]: [Vec3; 3], [r, s, t]: [Vec2; 3]) -> Triangle {
    let (e, f) = (b - a, c - a);
    let (p, q) = (s - r, t - r);
    let area = p.x * q.y - p.y * q.x;
    let (along, across) = (q.y * e - p.y * f, -q.x * e + p.x * f);
    let sign = if area > 0.0 { 1.0 } else { -1.0 };
    let fine = |x: f32| x.abs() > f32::MIN_POSITIVE;
    let sized = fine(area) && fine(along.length() / area.abs()) && fine(across.length() / area.abs());
    Triangle {
        corners,
        degenerate: a == b || b == c || c == a,
        loose: !sized,
        upright: area > 0.0,
        along: if fine(area) { unit_or_zero(along) * sign } else { Vec3::ZERO },
        ..Triangle::default()
    }
}

/// Joins each triangle with the first that has the same edge in the other direction and is not joined there.
fn join_over_edges(triangles: &mut [Triangle]) {
    let mut edges: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * triangles.len());
    for (t, triangle) in triangles.iter().enumerate().filter(|(_, triangle)| !triangle.degenerate) {
        for k in 0..3 {
            let (from, to) = (triangle.corners[k], triangle.corners[(k + 1) % 3]);
            edges.push((from.min(to), from.max(to), t as u32));
        }
    }
    edges.sort_unstable();
    for same in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        // Those that wait all have one direction: one of the other direction would have joined the first.
        let mut waiting: VecDeque<(u32, usize)> = VecDeque::new();
        for &(low, high, t) in same {
            let k = edge_of(&triangles[t as usize], low, high);
            let forward = |t: u32, k: usize| triangles[t as usize].corners[k] == low;
            match waiting.front() {
                Some(&(other, edge)) if forward(other, edge) != forward(t, k) => {
                    waiting.pop_front();
                    triangles[other as usize].beyond[edge] = Some(t);
                    triangles[t as usize].beyond[k] = Some(other);
                }
                _ => waiting.push_back((t, k)),
            }
        }
    }
}

/// Which edge of a triangle is the one between two corners that it has.
fn edge_of(triangle: &Triangle, low: u32, high: u32) -> usize {
    let between = |&k: &usize| {
        let (from, to) = (triangle.corners[k], triangle.corners[(k + 1) % 3]);
        (from.min(to), from.max(to)) == (low, high)
    };
    (0..3).find(between).unwrap_or_default()
}

/// Which corner of a triangle is this one, which it has.
fn place_of(triangle: &Triangle, corner: u32) -> usize {
    triangle.corners.iter().position(|&other| other == corner).unwrap_or_default()
}

/// The triangles, in their order, that have corner `k` of the `first` in their group.
fn collect_group(triangles: &mut [Triangle], first: u32, k: usize, group: &mut Vec<u32>, waiting: &mut Vec<u32>) {
    let start = triangles[first as usize];
    let corner = start.corners[k];
    group.clear();
    waiting.push(first);
    while let Some(t) = waiting.pop() {
        let triangle = &mut triangles[t as usize];
        let k = place_of(triangle, corner);
        if triangle.grouped[k] {
            continue;
        }
        if triangle.loose && triangle.grouped == [false; 3] {
            triangle.upright = start.upright;
        }
        if triangle.upright != start.upright {
            continue;
        }
        triangle.grouped[k] = true;
        group.push(t);
        // The edge that ends at the corner is gone over first.
        waiting.extend([k, (k + 2) % 3].into_iter().filter_map(|edge| triangle.beyond[edge]));
    }
    group.sort_unstable();
}

/// The mean direction of +u over a group of triangles around a corner.
fn mean_along(triangles: &[Triangle], group: &[u32], corner: u32, positions: &[Vec3], normal: Vec3) -> Vec3 {
    let flat = |v: Vec3| unit_or_zero(v - normal.dot(v) * normal);
    let mut sum = Vec3::ZERO;
    for &t in group {
        let triangle = &triangles[t as usize];
        if triangle.loose {
            continue;
        }
        let k = place_of(triangle, corner);
        let [here, next, last] = [0, 1, 2].map(|other| positions[3 * t as usize + (k + other) % 3]);
        let cos = flat(next - here).dot(flat(last - here)).clamp(-1.0, 1.0);
        let angle = f64::from(cos).acos() as f32;
        sum += angle * flat(triangle.along);
    }
    unit_or_zero(sum)
}

/// Corners of triangles without area take the tangent of the first triangle with area at the same corner.
fn follow(triangles: &[Triangle], tangents: &mut [Option<Vec4>]) {
    let mut first: HashMap<u32, usize> = HashMap::new();
    if triangles.iter().all(|triangle| !triangle.degenerate) {
        return;
    }
    for (t, triangle) in triangles.iter().enumerate().filter(|(_, triangle)| !triangle.degenerate) {
        for k in 0..3 {
            first.entry(triangle.corners[k]).or_insert(3 * t + k);
        }
    }
    for (t, triangle) in triangles.iter().enumerate().filter(|(_, triangle)| triangle.degenerate) {
        for k in 0..3 {
            tangents[3 * t + k] = first.get(&triangle.corners[k]).and_then(|&place| tangents[place]);
        }
    }
}

fn unit_or_zero(v: Vec3) -> Vec3 {
    if v.abs().max_element() > f32::MIN_POSITIVE { v * v.length().recip() } else { v }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents_with_threshold};
    use rand::RngExt;
    use rand_pcg::Pcg32;
    use rand_pcg::rand_core::SeedableRng;
    use std::time::{Duration, Instant};

    #[derive(Default)]
    struct Corners {
        positions: Vec<Vec3>,
        normals: Vec<Vec3>,
        uv: Vec<Vec2>,
        tangents: Vec<Option<Vec4>>,
    }

    impl Geometry for Corners {
        fn num_faces(&self) -> usize {
            self.positions.len() / 3
        }

        fn num_vertices_of_face(&self, _face: usize) -> usize {
            3
        }

        fn position(&self, face: usize, vert: usize) -> [f32; 3] {
            self.positions[face * 3 + vert].to_array()
        }

        fn normal(&self, face: usize, vert: usize) -> [f32; 3] {
            self.normals[face * 3 + vert].to_array()
        }

        fn tex_coord(&self, face: usize, vert: usize) -> [f32; 2] {
            self.uv[face * 3 + vert].to_array()
        }

        fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, vert: usize) {
            self.tangents[face * 3 + vert] = space.map(|space| Vec4::from_array(space.tangent_encoded()));
        }
    }

    impl Corners {
        fn ours(&self) -> Vec<Option<Vec4>> {
            tangents(&self.positions, &self.normals, &self.uv)
        }

        fn add(&mut self, position: Vec3, normal: Vec3, uv: Vec2) {
            self.positions.push(position);
            self.normals.push(normal);
            self.uv.push(uv);
        }

        /// How many corners have a tangent, all of which the crate gives too.
        #[track_caller]
        fn compare(mut self) -> usize {
            self.tangents = vec![None; self.positions.len()];
            // At 180°, -1, it leaves out triangles with the exactly opposite direction.
            generate_tangents_with_threshold(&mut self, -2.0).unwrap();
            for (i, (ours, theirs)) in self.ours().iter().zip(&self.tangents).enumerate() {
                assert_eq!(
                    ours.map(|t| t.to_array().map(f32::to_bits)),
                    theirs.map(|t| t.to_array().map(f32::to_bits)),
                    "{i}"
                );
            }
            self.tangents.iter().flatten().count()
        }
    }

    /// Triangles between few random corners: edges with many triangles, mirrored uv, uv without area, corners that coincide.
    #[test]
    fn random_triangles_have_the_tangents_of_the_crate() {
        let mut random = Pcg32::seed_from_u64(17);
        let mut found = 0;
        for round in 0..400 {
            let points = 3 + round % 30;
            let mut pool = Vec::new();
            for _ in 0..points {
                let position = Vec3::from_array([0; 3].map(|_| random.random_range(-2i32..3) as f32 / 3.0));
                let normal = Vec3::from_array([0; 3].map(|_| random.random_range(-1.0f32..1.0))).normalize();
                let uv = Vec2::from_array([0; 2].map(|_| random.random_range(0i32..4) as f32 / 4.0));
                pool.push((position, if round % 2 == 0 { Vec3::Z } else { normal }, uv));
            }
            let mut corners = Corners::default();
            for _ in 0..3 * (1 + round % 97) {
                let (position, normal, uv) = pool[random.random_range(0..points)];
                corners.add(position, normal, uv);
            }
            found += corners.compare();
        }
        assert!(found > 20_000, "{found}");
    }

    /// A wavy grid whose uv are turned, mirrored and collapsed here and there.
    #[test]
    fn a_grid_has_the_tangents_of_the_crate() {
        let mut random = Pcg32::seed_from_u64(18);
        for mode in 0..4 {
            let mut corners = Corners::default();
            let place = |i: i32, j: i32| Vec3::new(i as f32, j as f32, (i as f32 * 0.7).sin() + (j as f32 * 0.9).cos());
            for i in 0..24 {
                for j in 0..24 {
                    let flip = if mode > 0 && random.random_range(0..5) == 0 { -1.0 } else { 1.0 };
                    let fold = if mode > 1 && random.random_range(0..5) == 0 { 0.0 } else { 1.0 };
                    let square = [(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)];
                    for (di, dj) in square {
                        let (i, j) = (i + di, j + dj);
                        let normal = Vec3::new((i as f32 * 0.7).cos(), -(j as f32 * 0.9).sin(), 2.0).normalize();
                        let j = if mode > 2 { j / 2 } else { j };
                        corners.add(place(i, j), normal, Vec2::new(flip * i as f32, fold * j as f32) / 24.0);
                    }
                }
            }
            assert!(corners.compare() > 2000);
        }
    }

    /// What a hostile file of some megabytes asks for: time by the square of these would be hours, and a stack by the number of
    /// triangles around a corner is none of any system.
    #[test]
    fn many_triangles_at_one_place_take_no_longer_than_elsewhere() {
        const COUNT: usize = 400_000;
        let around = |i: usize, n: usize| {
            let (sin, cos) = (i as f32 * std::f32::consts::TAU / n as f32).sin_cos();
            Vec3::new(cos, sin, 0.0)
        };
        let uv = |p: Vec3| Vec2::new(p.x, p.y);
        let corner = |i: usize, which: usize| match which {
            // One triangle again and again; pages of a book; a fan; lines without area beside a triangle.
            0 => [Vec3::ZERO, Vec3::X, Vec3::Y],
            1 => [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 1.0, i as f32)],
            2 => [Vec3::ZERO, around(i, COUNT), around((i + 1) % COUNT, COUNT)],
            _ if i > 0 => [Vec3::X, Vec3::Y, Vec3::Y],
            _ => [Vec3::ZERO, Vec3::X, Vec3::Y],
        };
        for which in 0..4 {
            let mut corners = Corners::default();
            for i in 0..COUNT {
                corner(i, which).into_iter().for_each(|p| corners.add(p, Vec3::Z, uv(p)));
            }
            let start = Instant::now();
            let found = corners.ours();
            assert!(start.elapsed() < Duration::from_secs(60), "{which}: {:?}", start.elapsed());
            let right = found.iter().flatten().filter(|t| t.distance(Vec4::new(1.0, 0.0, 0.0, 1.0)) < 1e-3).count();
            assert_eq!(right, 3 * COUNT, "{which}");
        }
    }
}
