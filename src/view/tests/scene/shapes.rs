//! Plane, wall and sphere.

use crate::support::{assert_sound, faces_outwards, share_of_true_frames};
use glam::Vec3;
use glint_view::scene::Mesh;

#[test]
fn shapes_have_true_frames() {
    for (name, mesh) in [
        ("plane", Mesh::plane(2.0)),
        ("wall", Mesh::wall(3.0, 2.0)),
        ("sphere", Mesh::sphere(8)),
        ("cube", Mesh::sphere(1)),
    ] {
        assert_sound(&mesh);
        assert!(faces_outwards(&mesh), "{name}");
        assert_eq!(share_of_true_frames(&mesh), 1.0, "{name}");
    }
}

#[test]
fn the_plane_lies_and_the_wall_stands() {
    let plane = Mesh::plane(2.0).bounds();
    assert_eq!((plane.min, plane.max), (Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, 1.0)));
    let wall = Mesh::wall(3.0, 2.0);
    assert_eq!((wall.bounds().min, wall.bounds().max), (Vec3::new(-1.5, -1.0, 0.0), Vec3::new(1.5, 1.0, 0.0)));
    assert!(wall.vertices.iter().all(|v| v.normal == [0.0, 0.0, 1.0]));
    // A unit of uv is as long both ways.
    assert_eq!(wall.vertices[2].uv, [1.5, 1.0]);
}

#[test]
fn uv_of_the_sphere_are_nowhere_pinched() {
    let mesh = Mesh::sphere(32);
    let (mut least, mut most) = (f32::INFINITY, 0.0f32);
    for triangle in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices[triangle[k] as usize]);
        let (p, q) = (Vec3::from(b.position) - Vec3::from(a.position), Vec3::from(c.position) - Vec3::from(a.position));
        let area = p.cross(q).length();
        least = least.min(area);
        most = most.max(area);
    }
    // All have the same area in uv.
    assert!(most / least < 1.5, "{least} {most}");
    assert_eq!(Mesh::sphere(0).vertices.len(), 24);
}
