//! Tests meshes with fewer triangles for CAD programs.

use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};
use sweetspot::drawing::Mesh;
use sweetspot::report::dxf::simplified::simplified;

/// Returns a ball of radius 1 with `n` rings of `2 n` corners.
fn ball(n: usize) -> Mesh {
    let corner = |i: usize, j: usize| {
        let ((sin, cos), (up_sin, up_cos)) =
            ((TAU * j as f64 / (2 * n) as f64).sin_cos(), (PI * i as f64 / n as f64).sin_cos());
        Vector3::new(up_sin * cos, up_sin * sin, up_cos)
    };
    let at = |i: usize, j: usize| (i * 2 * n + j % (2 * n)) as u32;
    let corners: Vec<_> = (0..=n).flat_map(|i| (0..2 * n).map(move |j| corner(i, j))).collect();
    let quads = (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j)));
    let triangles: Vec<[u32; 3]> = quads
        .flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect();
    Mesh::creased(&corners, &triangles)
}

#[test]
fn a_fine_mesh_keeps_its_shape_with_fewer_triangles() {
    let (corners, triangles) = simplified(&ball(100));
    assert!((200..=1200).contains(&triangles.len()), "{}", triangles.len());
    // The corners are means of corners of the ball, so they lie slightly below its surface.
    assert!(corners.iter().all(|p| p.norm() > 0.97 && p.norm() < 1.0 + 1e-9));
    let volume: f64 = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| corners[i as usize]);
            a.dot(&b.cross(&c)) / 6.0
        })
        .sum();
    assert!((volume / (4.0 / 3.0 * PI) - 1.0).abs() < 0.08, "{volume}");
}

#[test]
fn a_coarse_mesh_stays_as_it_is() {
    let mesh = ball(8);
    assert_eq!(simplified(&mesh), (mesh.positions.clone(), mesh.triangles.clone()));
}
