//! Tests floor plans: closed outlines of a DXF drawing as obstacles, against independent geometry.

use crate::common::{load_from, root};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeSet;
use sweetspot::cell::{Equipment, Role, Shape};
use sweetspot::files::dxf::{FloorOutline, OutlineShape, PlanDrawing, bodies, outlines};
use sweetspot::layout::{Workcell, evaluate};

type Point = (f64, f64);

/// Returns a drawing from group codes and values, which are separated by blanks or line breaks.
fn drawing(unit: i64, blocks: &str, entities: &str) -> String {
    let words = format!(
        "0 SECTION 2 HEADER 9 $INSUNITS 70 {unit} 0 ENDSEC 0 SECTION 2 BLOCKS {blocks} 0 ENDSEC \
         0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"
    );
    words.split_whitespace().map(|word| format!("{word}\n")).collect()
}

/// Returns a closed polyline of vertices x, y and bulge.
fn polyline(layer: &str, vertices: &[(f64, f64, f64)]) -> String {
    let vertices: String = vertices.iter().map(|(x, y, b)| format!(" 10 {x} 20 {y} 42 {b}")).collect();
    format!("0 LWPOLYLINE 8 {layer} 70 1{vertices} ")
}

/// Reads the outlines on the layer WALLS, in the unit of the drawing.
fn read(text: &str, tolerance: f64) -> Result<Vec<FloorOutline>, String> {
    let drawing = PlanDrawing::read(text).map_err(|f| format!("{}: {}", f.line + 1, f.message))?;
    let found = outlines(&drawing, &BTreeSet::from(["WALLS".to_string()]), 1.0, tolerance);
    match found.errors.first() {
        Some(fault) => Err(format!("{}: {}", fault.line + 1, fault.message)),
        None => Ok(found.found),
    }
}

fn corners(outline: &FloorOutline) -> &[Point] {
    let OutlineShape::Polygon(corners) = &outline.shape else { panic!("{outline:?}") };
    corners
}

fn area(corners: &[Point]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| (a.0 * b.1 - b.0 * a.1) / 2.0).sum()
}

/// Returns the winding number of a polygon about a point, which is 0 outside.
fn winding(corners: &[Point], p: Point) -> f64 {
    let angle = |a: &Point, b: &Point| {
        let (u, v) = ((a.0 - p.0, a.1 - p.1), (b.0 - p.0, b.1 - p.1));
        (u.0 * v.1 - u.1 * v.0).atan2(u.0 * v.0 + u.1 * v.1)
    };
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| angle(a, b)).sum::<f64>() / std::f64::consts::TAU
}

fn near(a: Point, b: Point) -> bool {
    (a.0 - b.0).hypot(a.1 - b.1) < 1e-9
}

/// Returns whether two rings have the same corners, even if they begin at different corners.
fn same_ring(found: &[Point], expected: &[Point]) -> bool {
    let n = expected.len();
    found.len() == n && (0..n).any(|k| (0..n).all(|i| near(found[(i + k) % n], expected[i])))
}

#[test]
fn the_shipped_hall_has_its_columns_walls_and_machines() {
    let cell = "from = \"hitachi_cell.toml\"\n[obstacle.hall]\nplacement = { x_mm = -4000, y_mm = -4000, z_mm = 0 }\n\
        plan = { file = \"equipment/hall.dxf\", layers = [\"columns\", \"WALLS\", \"MACHINES\"], height_mm = 3000 }\n";
    let folder = crate::cli::sandbox::temporary_folder();
    std::fs::write(folder.path().join("hall_cell.toml"), cell).unwrap();
    let loaded = load_from(folder.path(), "hall_cell.toml").unwrap_or_else(|f| panic!("{f:#?}"));
    assert_eq!(loaded.warnings, []);
    let hall: Vec<&Equipment> =
        loaded.cell.equipment.iter().filter(|e| e.name.starts_with("hall/")).collect();
    let names: Vec<&str> = hall.iter().map(|e| &e.name[5..]).collect();
    let expected = [
        "COLUMNS 1",
        "COLUMNS 2",
        "COLUMNS 3",
        "COLUMNS 4",
        "WALLS 1 part 1",
        "WALLS 1 part 2",
        "MACHINES 1",
        "MACHINES 2",
        "MACHINES 3",
    ];
    assert_eq!(names, expected);
    assert!(hall.iter().all(|e| e.role == Role::Obstacle && e.surface.is_none()));
    let place = |k: usize| hall[k].placement.each_ref().map(|c| c.start());
    // The rows and columns of the inserted block are at 500 and 7500 mm. The placement subtracts 4000 mm.
    for (k, at) in [(-3.5, -3.5), (3.5, -3.5), (-3.5, 3.5), (3.5, 3.5)].into_iter().enumerate() {
        let [x, y, z, _] = place(k);
        assert!(near((x, y), at) && z == 0.0, "{k}: {x} {y}");
        let Shape::Box { size, pose } = &hall[k].solids[0].shape else { panic!("no box") };
        assert!((size.x - 0.3).abs() < 1e-9 && (size.y - 0.3).abs() < 1e-9 && size.z == 3.0);
        assert_eq!(pose.translation.z, 1.5);
    }
    let Shape::Cylinder { radius, b, .. } = &hall[7].solids[0].shape else { panic!("no cylinder") };
    assert!((radius - 0.3).abs() < 1e-12 && b.z == 3.0 && near((place(7)[0], place(7)[1]), (-2.8, 2.5)));
    // The decomposition of the L-shaped wall is exact: its two parts have the area of the outline.
    let areas = [4, 5].map(|k| match &hall[k].solids[0].shape {
        Shape::Mesh { vertices, .. } => {
            area(&vertices.iter().filter(|v| v.z == 0.0).map(|v| (v.x, v.y)).collect::<Vec<_>>())
        }
        other => panic!("{other:?}"),
    });
    assert!((areas[0] + areas[1] - (6.2 * 0.2 + 5.8 * 0.2)).abs() < 1e-9, "{areas:?}");
}

#[test]
fn a_table_fits_into_the_corner_of_a_wall_but_not_into_the_wall() {
    let at = |x: i32| {
        format!(
            "from = \"hitachi_cell.toml\"\n[obstacle.hall]\nplacement = {{ x_mm = -4000, y_mm = -4000, z_mm = 0 }}\n\
             plan = {{ file = \"equipment/hall.dxf\", layers = [\"WALLS\"], height_mm = 3000 }}\n\
             [equipment.worktable.placement]\nx_mm = {x}\ny_mm = 3300\nz_mm = 600\nyaw_deg = 0\n"
        )
    };
    let overlaps = |x: i32| {
        let folder = crate::cli::sandbox::temporary_folder();
        std::fs::write(folder.path().join("a.toml"), at(x)).unwrap();
        let workcell = Workcell::new(load_from(folder.path(), "a.toml").unwrap().cell).unwrap();
        let found = evaluate(&workcell, &workcell.cell.start()).overlaps;
        found.iter().map(|o| o.in_words(&workcell.cell)).collect::<Vec<_>>()
    };
    // The worktable is 1500 mm by 700 mm; the wall leaves x > -4000 mm and y < 3800 mm free.
    assert_eq!(overlaps(-3230), [""; 0]);
    let found = overlaps(-3270);
    assert!(found.len() == 1 && found[0].contains("hall/WALLS 1 part"), "{found:?}");
}

#[test]
fn arcs_are_replaced_on_their_outer_side_within_the_tolerance() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut pieces = 0;
    for case in 0..200 {
        // The outline is a rectangle whose sides bulge outwards or inwards, in both directions of rotation.
        let (w, h) = (rng.random_range(1.0..4.0), rng.random_range(1.0..4.0));
        let turn = if case % 2 == 0 { 1.0 } else { -1.0 };
        let mut bulges = [0.0; 4].map(|_: f64| rng.random_range(-0.3..0.9));
        bulges[case % 4] = 0.0;
        let mut ring = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)];
        if turn < 0.0 {
            ring.reverse();
        }
        let vertices: Vec<_> = ring.iter().zip(bulges).map(|(p, b)| (p.0, p.1, turn * b)).collect();
        let tolerance = 10f64.powf(rng.random_range(-3.5..-1.5));
        let found = read(&drawing(6, "", &polyline("WALLS", &vertices)), tolerance).unwrap();
        let corners = corners(&found[0]);
        pieces += corners.len();
        // Points of the true arcs must lie inside the polygon and near its edges.
        for k in 0..4 {
            let (a, b) = (vertices[k], vertices[(k + 1) % 4]);
            let sweep = 4.0 * a.2.atan();
            for step in 1..50 {
                let p = if a.2 == 0.0 {
                    let t = f64::from(step) / 50.0;
                    (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1))
                } else {
                    // The angle between the chord from the start and the tangent is half the swept angle.
                    let chord = (b.0 - a.0).hypot(b.1 - a.1);
                    let radius = chord / (2.0 * (sweep / 2.0).sin()).abs();
                    let swept = sweep * f64::from(step) / 50.0;
                    let heading = (b.1 - a.1).atan2(b.0 - a.0) - sweep / 2.0 + swept / 2.0;
                    let length = 2.0 * radius * (swept / 2.0).sin().abs();
                    (a.0 + length * heading.cos(), a.1 + length * heading.sin())
                };
                let off = distance(corners, p);
                assert!(off <= tolerance + 1e-9, "case {case}: {off} beyond {tolerance}");
                let is_inside = (winding(corners, p) - 1.0).abs() < 1e-6;
                assert!(is_inside || off < 1e-9, "case {case}: {p:?} lies outside by {off}");
            }
        }
    }
    assert!(pieces > 2000, "{pieces} corners");
}

fn distance(corners: &[Point], p: Point) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let to = |(a, b): (&Point, &Point)| {
        let (u, v) = ((b.0 - a.0, b.1 - a.1), (p.0 - a.0, p.1 - a.1));
        let t = ((u.0 * v.0 + u.1 * v.1) / (u.0 * u.0 + u.1 * u.1)).clamp(0.0, 1.0);
        (v.0 - t * u.0).hypot(v.1 - t * u.1)
    };
    corners.iter().zip(next).map(to).fold(f64::INFINITY, f64::min)
}

#[test]
fn convex_parts_of_random_outlines_tile_them() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for _ in 0..200 {
        // The outline is a star whose corners have ascending angles, so it does not cross itself.
        let n = rng.random_range(3..40);
        let vertex = |k: usize, r: f64| {
            let angle = std::f64::consts::TAU * k as f64 / n as f64;
            (5.0 + r * angle.cos(), r * angle.sin(), 0.0)
        };
        let star: Vec<_> = (0..n).map(|k| vertex(k, rng.random_range(0.5..3.0))).collect();
        let found = read(&drawing(6, "", &polyline("WALLS", &star)), 0.001).unwrap();
        let whole = corners(&found[0]).to_vec();
        let parts = bodies(&found, 2.0).unwrap();
        let mut sum = 0.0;
        for body in &parts {
            let (s, c) = body.placement.yaw.sin_cos();
            let world = |x: f64, y: f64| (body.placement.x + c * x - s * y, body.placement.y + s * x + c * y);
            let ring: Vec<Point> = match &body.shape {
                Shape::Mesh { vertices, closed, .. } => {
                    assert!(closed);
                    vertices.iter().filter(|v| v.z == 0.0).map(|v| world(v.x, v.y)).collect()
                }
                Shape::Box { size, .. } => {
                    let (x, y) = (size.x / 2.0, size.y / 2.0);
                    [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| world(x, y)).to_vec()
                }
                other => panic!("{other:?}"),
            };
            let n = ring.len();
            for k in 0..n {
                let [p, q, r] = [ring[k], ring[(k + 1) % n], ring[(k + 2) % n]];
                assert!((q.0 - p.0) * (r.1 - q.1) - (q.1 - p.1) * (r.0 - q.0) > -1e-9, "not convex");
                // The floor space contains the part.
                let (dx, dy) = (p.0 - body.placement.x, p.1 - body.placement.y);
                let (u, v) = (c * dx + s * dy, c * dy - s * dx);
                assert!(u.abs() <= body.size.0 / 2.0 + 1e-9 && v.abs() <= body.size.1 / 2.0 + 1e-9);
            }
            // The centre of each part lies inside the outline.
            let middle = (
                ring.iter().map(|p| p.0).sum::<f64>() / n as f64,
                ring.iter().map(|p| p.1).sum::<f64>() / n as f64,
            );
            assert!((winding(&whole, middle) - 1.0).abs() < 1e-6);
            sum += area(&ring);
        }
        assert!((sum - area(&whole)).abs() < 1e-5, "{sum} {}", area(&whole));
    }
}

#[test]
fn blocks_are_placed_scaled_turned_mirrored_and_nested() {
    let square = polyline("0", &[(1.0, 0.0, 0.0), (3.0, 0.0, 0.0), (3.0, 1.0, 0.0)]);
    let blocks = format!(
        "0 BLOCK 8 0 2 Inner 10 1 20 0 {square} 0 ENDBLK \
         0 BLOCK 8 0 2 Outer 10 0 20 0 0 INSERT 8 0 2 INNER 10 5 20 0 41 2 42 -3 50 90 0 ENDBLK"
    );
    let insert = "0 INSERT 8 WALLS 2 outer 10 100 20 200 50 180 ";
    let found = read(&drawing(6, &blocks, insert), 0.01).unwrap();
    // For the inner block, subtract its base point (1, 0), scale by (2, -3), rotate by 90 degrees and move by
    // (5, 0). For the outer block, rotate by 180 degrees and move by (100, 200). The mirrored triangle runs
    // clockwise, so its corners are reversed.
    let place = |(x, y): Point| {
        let (x, y) = (2.0 * (x - 1.0), -3.0 * y);
        let (x, y) = (5.0 - y, x);
        (100.0 - x, 200.0 - y)
    };
    let expected = [(3.0, 1.0), (3.0, 0.0), (1.0, 0.0)].map(place);
    assert!(same_ring(corners(&found[0]), &expected), "{:?} {expected:?}", found[0]);
    // The extrusion (0, 0, -1) mirrors x.
    let flipped = "0 INSERT 8 WALLS 2 Inner 10 10 20 20 210 0 220 0 230 -1 ";
    let found = read(&drawing(6, &blocks, flipped), 0.01).unwrap();
    let place = |(x, y): Point| (-(x - 1.0 + 10.0), y + 20.0);
    let expected = [(3.0, 1.0), (3.0, 0.0), (1.0, 0.0)].map(place);
    assert!(same_ring(corners(&found[0]), &expected), "{:?} {expected:?}", found[0]);
    // Entities of a block that are on another layer do not get the layer of the insert.
    let own = blocks.replace("0 LWPOLYLINE 8 0", "0 LWPOLYLINE 8 OTHER");
    assert_eq!(read(&drawing(6, &own, insert), 0.01).unwrap(), []);
    // The outline of an unevenly scaled circle contains the ellipse.
    let circle = "0 BLOCK 2 C 10 0 20 0 0 CIRCLE 8 0 10 0 20 0 40 1 0 ENDBLK";
    let found = read(&drawing(6, circle, "0 INSERT 8 WALLS 2 C 10 0 20 0 41 2 42 1 "), 0.01).unwrap();
    let ring = corners(&found[0]);
    for k in 0..100 {
        let (s, c) = (0.0628 * f64::from(k)).sin_cos();
        let p = (2.0 * c, s);
        assert!((winding(ring, p) - 1.0).abs() < 1e-6 || distance(ring, p) < 1e-9);
        assert!(distance(ring, p) <= 0.01 + 1e-9);
    }
}

#[test]
fn lines_and_arcs_whose_ends_meet_form_an_outline() {
    // The drawing has two lines, of which one is drawn backwards, and a half circle. A second shape is open.
    let lines = "0 LINE 8 WALLS 10 0 20 0 11 4 21 0 0 LINE 8 WALLS 10 0 20 2 11 0.000001 21 0 \
                 0 LINE 8 WALLS 10 4 20 2 11 0 21 2 0 ARC 8 WALLS 10 4 20 1 40 1 50 270 51 90 \
                 0 LINE 8 WALLS 10 9 20 9 11 10 21 9 ";
    let text = drawing(6, "", lines);
    let parsed = PlanDrawing::read(&text).unwrap();
    let found = outlines(&parsed, &BTreeSet::from(["WALLS".to_string()]), 1.0, 0.001);
    assert_eq!((found.found.len(), found.errors.len(), found.warnings.len()), (1, 0, 1));
    assert!(
        found.warnings[0].message.contains("open line is not read as an obstacle"),
        "{:?}",
        found.warnings
    );
    let whole = 8.0 + std::f64::consts::PI / 2.0;
    let found = area(corners(&found.found[0]));
    assert!(found > whole && found - whole < 0.004, "{found} {whole}");
}

#[test]
fn hostile_drawings_are_refused_at_their_line() {
    let square = polyline("WALLS", &[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0)]);
    let nest = |depth: usize, copies: u64| {
        let block = |k: usize| {
            format!(
                "0 BLOCK 2 B{k} 10 0 20 0 0 INSERT 8 0 2 B{} 10 0 20 0 70 {copies} 71 {copies} 0 ENDBLK ",
                k + 1
            )
        };
        let last = format!("0 BLOCK 2 B{depth} 10 0 20 0 {square} 0 ENDBLK");
        (0..depth).map(block).collect::<String>() + &last
    };
    let insert = "0 INSERT 8 WALLS 2 B0 10 0 20 0 ";
    let with = |vertex: (f64, f64, f64)| polyline("WALLS", &[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), vertex]);
    let many: String = (0..300)
        .map(|k| {
            let x = 3.0 * f64::from(k);
            polyline("WALLS", &[(x, 0.0, 0.0), (x + 1.0, 0.0, 0.0), (x, 1.0, 0.0)])
        })
        .collect();
    let long: Vec<_> = (0..5000)
        .map(|k| {
            let (s, c) = (f64::from(k) / 5000.0 * std::f64::consts::TAU).sin_cos();
            (90.0 * c, 90.0 * s, 0.0)
        })
        .collect();
    let cases = [
        (drawing(6, "", &square).replace("EOF\n", ""), "cut off"),
        (
            drawing(6, "", "0 LWPOLYLINE 8 WALLS 70 1 10 nan 20 0"),
            "group code 10 must be a number, not `nan`",
        ),
        (drawing(6, "", "0 LWPOLYLINE 8 WALLS 70 1 10 1e300 20 0"), "group code 10 must be a number"),
        (drawing(6, "", "0 LWPOLYLINE 8 WALLS 70 x 10 1 20 0"), "group code 70 must be a whole number"),
        (drawing(6, "", "WALLS"), "a group code is a whole number, not `WALLS`"),
        (drawing(6, &nest(3, 1).replace("8 0 2 B3", "8 0 2 B1"), insert), "contains itself"),
        (drawing(6, &nest(20, 1), insert), "nested more than 16 deep"),
        (drawing(6, &nest(12, 10), insert), "more than 100000 entities"),
        (drawing(6, &nest(1, 9_000_000_000_000_000_000), insert), "is inserted"),
        (drawing(6, "", insert), "there is no block `B0`"),
        (drawing(6, "", &with((0.0, 0.0, 0.0))), "almost no area"),
        (drawing(6, "", &with((f64::from(2), 0.0, 0.0))), "almost no area"),
        (
            drawing(
                6,
                "",
                &polyline("WALLS", &[(0.0, 0.0, 0.0), (1.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.5, 0.0)]),
            ),
            "crosses or touches itself",
        ),
        (drawing(6, "", &many), "300 outlines, more than 200"),
        (drawing(6, "", &polyline("WALLS", &long)), "5000 corners, more than 400"),
        (drawing(6, "", "0 CIRCLE 8 WALLS 10 0 20 0 40 0"), "almost no area"),
        (drawing(6, "", &polyline("WALLS", &[(0.0, 0.0, 1e8), (1.0, 0.0, 1.0)])), "layer `WALLS`"),
    ];
    for (text, said) in cases {
        let clock = std::time::Instant::now();
        let fault = read(&text, 0.001).err().unwrap_or_else(|| panic!("accepted: {said}"));
        assert!(fault.contains(said), "{fault} instead of {said}");
        assert!(clock.elapsed().as_secs() < 5, "{said} took {:?}", clock.elapsed());
        let line: usize = fault.split(':').next().unwrap().parse().unwrap();
        assert!((1..=text.lines().count()).contains(&line), "{fault}");
    }
}

/// Damaged drawings give outlines or a fault, never a panic.
#[test]
fn damaged_drawings_never_panic() {
    let hall = std::fs::read_to_string(root().join("cells/equipment/hall.dxf")).unwrap();
    let lines: Vec<&str> = hall.lines().collect();
    let layers = BTreeSet::from(["WALLS", "COLUMNS", "MACHINES"].map(String::from));
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut read = 0;
    for _ in 0..300 {
        let mut lines = lines.clone();
        for _ in 0..rng.random_range(1..4) {
            let at = lines.len() / 2 + rng.random_range(0..lines.len() / 2);
            match rng.random_range(0..4) {
                0 => drop(lines.remove(at)),
                1 => lines[at] = ["nan", "1e308", "-1", "0", "INSERT", "1e-320"][rng.random_range(0..6)],
                2 => {
                    let other = rng.random_range(0..lines.len());
                    lines.swap(at, other);
                }
                _ => lines.truncate(at),
            }
        }
        let Ok(drawing) = PlanDrawing::read(&lines.join("\n")) else { continue };
        let found = outlines(&drawing, &layers, 0.001, 0.001);
        let _ = bodies(&found.found, 3.0);
        read += 1;
    }
    assert!(read > 10, "only {read} drawings could be read");
}
