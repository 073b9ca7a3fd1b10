//! Tests solids as triangle meshes.

use nalgebra::Vector3;
use std::f64::consts::PI;
use sweetspot::cell::Shape;
use sweetspot::drawing::Mesh;
use sweetspot::pose::Pose;

/// Returns the volume of a closed surface by the divergence theorem. The result is wrong if the normal of a
/// face points inwards.
fn volume(mesh: &Mesh) -> f64 {
    let p = |i: u32| mesh.positions[i as usize];
    mesh.triangles.iter().map(|[a, b, c]| p(*a).dot(&p(*b).cross(&p(*c))) / 6.0).sum()
}

#[test]
fn every_solid_mesh_is_closed_and_faces_outwards() {
    let tilted = Pose::from_translation_rpy(Vector3::new(0.3, -0.2, 0.9), Vector3::new(0.4, -0.7, 1.1));
    let (a, b) = (Vector3::new(0.1, 0.2, 0.3), Vector3::new(-0.4, 0.6, 0.9));
    let (length, r): (f64, f64) = ((b - a).norm(), 0.15);
    let solids = [
        (Shape::Box { pose: tilted, size: Vector3::new(0.2, 0.5, 0.7) }, 0.07),
        (Shape::Sphere { centre: a, radius: r }, 4.0 / 3.0 * PI * r.powi(3)),
        (Shape::Capsule { a, b, radius: r }, PI * r * r * length + 4.0 / 3.0 * PI * r.powi(3)),
        (Shape::Cylinder { a, b, radius: r }, PI * r * r * length),
        (Shape::Leg { x: 1.0, y: -1.0, size: (0.1, 0.2), top: -0.05 }, 0.1 * 0.2 * 0.75),
    ];
    for (shape, exact) in solids {
        let mesh = Mesh::of(&shape, -0.8);
        let share = volume(&mesh) / exact;
        // Polygons replace the circles, so the volume is slightly too small.
        assert!((0.975..1.0 + 1e-9).contains(&share), "{shape:?}: {share}");
        let extent = mesh.extent().map(|(lo, hi)| (hi - lo).amax());
        assert!(extent.is_some_and(|e| e > 0.1));
        for (t, n) in mesh.triangles.iter().flat_map(|t| t.iter().map(move |i| (t, *i))) {
            let p = |i: u32| mesh.positions[i as usize];
            let flat = (p(t[1]) - p(t[0])).cross(&(p(t[2]) - p(t[0])));
            assert!(flat.dot(&mesh.normals[n as usize]) > 0.9 * flat.norm(), "{shape:?}");
        }
    }
}

#[test]
fn a_box_has_sharp_and_a_ball_smooth_normals() {
    let cube = Mesh::of(&Shape::Box { pose: Pose::IDENTITY, size: Vector3::repeat(1.0) }, 0.0);
    assert_eq!((cube.positions.len(), cube.triangles.len()), (24, 12));
    let ball = Mesh::of(&Shape::Sphere { centre: Vector3::zeros(), radius: 2.0 }, 0.0);
    for (p, n) in ball.positions.iter().zip(&ball.normals) {
        assert!((p / 2.0 - n).norm() < 0.05, "{p} {n}");
    }
}
