//! Tests iso-lines of a surface over a grid.

use sweetspot::geometry::PlanePoint as Point;
use sweetspot::report::chart::iso::IsoSurface;

fn grid(size: (usize, usize), f: impl Fn(f64, f64) -> Option<f64>) -> IsoSurface {
    let points: Vec<Point> =
        (0..size.0 * size.1).map(|k| ((k % size.0) as f64, (k / size.0) as f64)).collect();
    let values: Vec<_> = points.iter().map(|p| f(p.0, p.1)).collect();
    IsoSurface::new(size, &points, &values)
}

fn area(polygon: &[Point]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(a, b)| a.0 * b.1 - a.1 * b.0).sum::<f64>() / 2.0
}

#[test]
fn iso_lines_of_a_plane_are_straight_and_have_their_value() {
    let f = |x: f64, y: f64| 2.0 * x - 3.0 * y + 1.0;
    let surface = grid((7, 5), |x, y| Some(f(x, y)));
    for level in [-7.3, -2.0, 0.0, 1.0, 4.77] {
        let lines = surface.lines(level);
        assert_eq!(lines.len(), 1, "{level}");
        assert!(lines[0].iter().all(|p| (f(p.0, p.1) - level).abs() < 1e-12));
        // The line begins and ends at the border of the grid.
        for end in [lines[0][0], *lines[0].last().unwrap()] {
            assert!([end.0, end.0 - 6.0, end.1, end.1 - 4.0].iter().any(|d| d.abs() < 1e-12), "{end:?}");
        }
    }
}

/// On the edges of a grid cell, the values follow from linear interpolation.
#[test]
fn an_iso_line_crosses_grid_edges_by_linear_interpolation() {
    let f = |x: f64, y: f64| (0.9 * x).sin() + (0.7 * y).cos() * 1.3;
    let surface = grid((9, 8), |x, y| Some(f(x, y)));
    let mut seen = 0;
    for level in [-0.8, -0.1, 0.2, 0.9, 1.6] {
        for (x, y) in surface.lines(level).concat() {
            let value = match (x.fract() == 0.0, y.fract() == 0.0) {
                (_, true) => f(x.floor(), y) * (1.0 - x.fract()) + f(x.floor() + 1.0, y) * x.fract(),
                (true, _) => f(x, y.floor()) * (1.0 - y.fract()) + f(x, y.floor() + 1.0) * y.fract(),
                _ => continue,
            };
            assert!((value - level).abs() < 1e-12, "({x}, {y}): {value}, not {level}");
            seen += 1;
        }
    }
    assert!(seen > 50, "{seen}");
}

#[test]
fn a_round_hill_has_one_closed_iso_line_of_the_right_area() {
    let surface = grid((41, 41), |x, y| Some(-((x - 20.0).hypot(y - 20.0))));
    let lines = surface.lines(-12.5);
    assert_eq!(lines.len(), 1);
    assert_eq!(lines[0][0], *lines[0].last().unwrap());
    let above: f64 = surface.above(-12.5).iter().map(|p| area(p)).sum();
    let round = std::f64::consts::PI * 12.5 * 12.5;
    assert!((above / round - 1.0).abs() < 0.01, "{above} {round}");
    assert!((area(&lines[0]).abs() / above - 1.0).abs() < 1e-9);
}

#[test]
fn a_saddle_is_resolved_by_its_centre_value() {
    let high = grid((2, 2), |x, y| Some(if x == y { 3.0 } else { 0.0 }));
    // The centre has the value 1.5. The areas at the high corners are joined at a lower level and separate at
    // a higher level.
    let areas = |level| high.above(level).iter().map(|p| area(p)).sum::<f64>();
    assert_eq!((high.lines(1.0).len(), high.lines(2.0).len()), (2, 2));
    assert!(areas(1.0) > 0.5 && areas(2.0) < 0.5 && areas(-1.0) == 1.0);
}

#[test]
fn holes_single_rows_and_empty_grids_are_handled() {
    let hole = grid((3, 3), |x, y| (x + y > 0.0).then_some(x));
    let whole: f64 = hole.above(f64::NEG_INFINITY).iter().map(|p| area(p)).sum();
    assert!((whole - 3.5).abs() < 1e-12 && hole.covers(1) && !hole.covers(0));
    for (size, filled) in [((5, 1), true), ((1, 1), true), ((0, 0), true), ((4, 4), false)] {
        let none = grid(size, |x, _| filled.then_some(x));
        assert!(none.above(0.0).is_empty() && none.lines(0.5).is_empty() && none.range().is_none());
    }
    let flat = grid((4, 4), |_, _| Some(2.0));
    assert!(flat.lines(2.0).is_empty() && flat.range() == Some((2.0, 2.0)));
}
