//! Tests outlines of solids in the plans.

use nalgebra::{Vector2, Vector3};
use sweetspot::cell::Shape;
use sweetspot::drawing::Mesh;
use sweetspot::drawing::silhouette::{ABOVE, FRONT, ViewAxes, silhouette};
use sweetspot::geometry::{convex_hull, join_edges, polygon_area, simplified_line};
use sweetspot::pose::Pose;

/// Returns the signed areas of the outlines of a mesh.
fn areas(mesh: &Mesh, eye: &ViewAxes) -> Vec<f64> {
    let loops = silhouette(mesh, &Pose::IDENTITY, eye).loops;
    let plane = |ring: &Vec<Vector2<f64>>| ring.iter().map(|p| (p.x, p.y)).collect::<Vec<_>>();
    loops.iter().map(|ring| polygon_area(&plane(ring))).collect()
}

#[test]
fn the_outlines_of_a_box_and_a_ball_have_the_right_area() {
    let pose = Pose::from_translation_yaw(Vector3::new(1.0, 2.0, 3.0), 0.4);
    let cube = Mesh::of(&Shape::Box { pose, size: Vector3::new(2.0, 3.0, 4.0) }, 0.0);
    let plan = areas(&cube, &ABOVE);
    assert!(plan.len() == 1 && (plan[0] - 6.0).abs() < 1e-12);
    let side = areas(&cube, &FRONT);
    let wide = 2.0 * 0.4f64.cos() + 3.0 * 0.4f64.sin();
    assert!(side.len() == 1 && (side[0] - 4.0 * wide).abs() < 1e-12);
    let ball = Mesh::of(&Shape::Sphere { centre: Vector3::zeros(), radius: 1.0 }, 0.0);
    let disc: f64 = areas(&ball, &ABOVE).iter().sum();
    assert!((disc / std::f64::consts::PI - 1.0).abs() < 0.01, "{disc}");
}

/// Two boxes in one mesh show the gap between them.
#[test]
fn the_outline_of_a_concave_solid_keeps_its_gaps() {
    let cube = |x: f64| {
        let pose = Pose { translation: Vector3::new(x, 0.0, 0.0), ..Pose::IDENTITY };
        Mesh::of(&Shape::Box { pose, size: Vector3::repeat(1.0) }, 0.0)
    };
    let (mut both, other) = (cube(0.0), cube(3.0));
    let shift = both.positions.len() as u32;
    both.positions.extend(other.positions);
    both.normals.extend(other.normals);
    both.triangles.extend(other.triangles.iter().map(|t| t.map(|k| k + shift)));
    let plan = areas(&both, &ABOVE);
    assert!(plan.len() == 2 && plan.iter().all(|area| (area - 1.0).abs() < 1e-12), "{plan:?}");
    let loops = silhouette(&both, &Pose::IDENTITY, &ABOVE).loops;
    assert!(loops.concat().iter().all(|p| p.x <= 0.5 || p.x >= 2.5));
}

#[test]
fn the_convex_hull_of_few_points_has_few_points() {
    assert_eq!(convex_hull(vec![(1.0, 2.0), (1.0, 2.0)]), [(1.0, 2.0)]);
    assert!(convex_hull(Vec::new()).is_empty());
    let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let mut points = square.to_vec();
    points.extend([(0.5, 0.5), (0.5, 0.0), (1.0, 1.0)]);
    assert_eq!(convex_hull(points), square);
}

#[test]
fn edges_join_to_lines_and_each_belongs_to_one() {
    // The edges form an open line of three edges, a triangle, and nothing else.
    let edges = [(7, 8), (2, 3), (1, 2), (8, 9), (3, 4), (9, 7)];
    let lines = join_edges(&edges, |_, free| free[0]);
    let corners: Vec<(&[i32], bool)> = lines.iter().map(|l| (&l.corners[..], l.is_closed)).collect();
    assert_eq!(corners, [(&[1, 2, 3, 4][..], false), (&[7, 8, 9][..], true)]);
    // At a corner where two rings meet, the function `choose` decides how they are joined. No edge is lost.
    let eight = [(0, 1), (1, 2), (2, 0), (0, 3), (3, 4), (4, 0)];
    let joined = join_edges(&eight, |_, free| free[0]);
    assert_eq!(joined.iter().map(|l| l.corners.len()).sum::<usize>(), 6);
    assert!(joined.iter().all(|l| l.is_closed));
}

#[test]
fn a_simplified_line_stays_within_its_tolerance() {
    let wave: Vec<Vector2<f64>> =
        (0..200).map(|k| f64::from(k) * 0.05).map(|x| Vector2::new(x, x.sin())).collect();
    let kept = simplified_line(&wave, 0.01);
    assert!(kept.len() < 40 && kept[0] == 0 && kept[kept.len() - 1] == 199, "{kept:?}");
    for pair in kept.windows(2) {
        let (a, b) = (wave[pair[0]], wave[pair[1]]);
        let across = Vector2::new(-(b - a).y, (b - a).x).normalize();
        assert!(wave[pair[0]..pair[1]].iter().all(|p| (p - a).dot(&across).abs() <= 0.01));
    }
    assert!(simplified_line::<2>(&[], 1.0).is_empty());
}
