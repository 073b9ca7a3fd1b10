//! Tests outlines of solids in the plans.

use nalgebra::Vector3;
use sweetspot::cell::Shape;
use sweetspot::drawing::Mesh;
use sweetspot::pose::Pose;
use sweetspot::report::chart::iso::Point;
use sweetspot::report::chart::outline::{hull, silhouette};

fn area(polygon: &[Point]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(a, b)| a.0 * b.1 - a.1 * b.0).sum::<f64>() / 2.0
}

#[test]
fn the_outlines_of_a_box_and_a_ball_have_the_right_area() {
    let pose = Pose::from_translation_yaw(Vector3::new(1.0, 2.0, 3.0), 0.4);
    let cube = Mesh::of(&Shape::Box { pose, size: Vector3::new(2.0, 3.0, 4.0) }, 0.0);
    let plan = silhouette(&cube, |p| (p.x, p.y));
    assert!(plan.len() == 1 && plan[0].len() == 4 && (area(&plan[0]) - 6.0).abs() < 1e-12);
    let side = silhouette(&cube, |p| (p.x, p.z));
    let wide = 2.0 * 0.4f64.cos() + 3.0 * 0.4f64.sin();
    assert!((area(&side[0]) - 4.0 * wide).abs() < 1e-12);
    let ball = Mesh::of(&Shape::Sphere { centre: Vector3::zeros(), radius: 1.0 }, 0.0);
    let disc = area(&silhouette(&ball, |p| (p.x, p.y))[0]);
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
    let plan = silhouette(&both, |p| (p.x, p.y));
    assert!(plan.len() > 1 && plan.iter().all(|t| area(t) > 0.0));
    // Seen from above, each face counts twice: top and bottom.
    assert!((plan.iter().map(|t| area(t)).sum::<f64>() - 4.0).abs() < 1e-12);
    assert!(plan.concat().iter().all(|p| p.0 <= 0.5 || p.0 >= 2.5));
}

#[test]
fn the_convex_hull_of_few_points_has_few_points() {
    assert_eq!(hull(vec![(1.0, 2.0), (1.0, 2.0)]), [(1.0, 2.0)]);
    assert!(hull(Vec::new()).is_empty());
}
