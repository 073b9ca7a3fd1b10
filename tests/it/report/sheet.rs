//! Tests the silhouettes of the drawing for paper.

use nalgebra::{Vector2, Vector3};
use sweetspot::cell::Shape;
use sweetspot::drawing::Mesh;
use sweetspot::drawing::silhouette::{ABOVE, FRONT, Silhouette, silhouette};
use sweetspot::pose::Pose;

fn area(s: &Silhouette) -> f64 {
    let ring =
        |r: &Vec<Vector2<f64>>| -> f64 { (0..r.len()).map(|k| r[k].perp(&r[(k + 1) % r.len()]) / 2.0).sum() };
    s.loops.iter().map(ring).sum()
}

#[test]
fn the_silhouettes_of_a_box_and_a_bar_have_the_right_area() {
    let size = Vector3::new(0.6, 0.4, 0.3);
    let solid = Shape::Box { pose: Pose::IDENTITY, size };
    let mesh = Mesh::of(&solid, 0.0);
    let at = Pose::from_translation_yaw(Vector3::new(1.0, 2.0, 3.0), 0.5);
    let above = silhouette(&mesh, &at, &ABOVE);
    assert_eq!(above.loops.len(), 1);
    assert!((area(&above) - 0.24).abs() < 1e-12 && above.edges.is_empty());
    assert!((above.depth - 3.0).abs() < 1e-12);
    // After a rotation, the front view shows two sides and the edge between them.
    let front = silhouette(&mesh, &at, &FRONT);
    let wide = 0.6 * 0.5f64.cos() + 0.4 * 0.5f64.sin();
    assert!((area(&front) - wide * 0.3).abs() < 1e-12, "{}", area(&front));
    assert_eq!(front.edges.len(), 1);
    let [a, b] = front.edges[0];
    assert!((a.x - b.x).abs() < 1e-12 && ((a.y - b.y).abs() - 0.3).abs() < 1e-12);
    // A bar along x is a rectangle from above and a disc from the side.
    let (a, b) = (Vector3::zeros(), Vector3::new(0.5, 0.0, 0.0));
    let bar = Mesh::of(&Shape::Cylinder { a, b, radius: 0.1 }, 0.0);
    let above = silhouette(&bar, &Pose::IDENTITY, &ABOVE);
    assert!((area(&above) / 0.1 - 1.0).abs() < 0.01, "{}", area(&above));
    let disc = silhouette(&bar, &Pose::IDENTITY, &[-Vector3::y(), Vector3::z(), -Vector3::x()]);
    assert!((area(&disc) / (std::f64::consts::PI * 0.01) - 1.0).abs() < 0.01);
}
