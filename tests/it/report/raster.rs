//! Tests the pictures: triangles, cameras, letters, and contents.

use crate::common::shipped as loaded;
use nalgebra::{Point2, Vector3};
use sweetspot::assess::Assessment;
use sweetspot::drawing::Drawing;
use sweetspot::drawing::{Detail, Mesh};
use sweetspot::layout::Workcell;
use sweetspot::raster::camera::{Camera, PictureFrame, ScreenPoint};
use sweetspot::raster::canvas::DepthBuffer;
use sweetspot::raster::{Shot, Show, ViewDirection, font, isometric, png, trace};

fn drawn<T>(cell: sweetspot::cell::Cell, look: impl FnOnce(&Drawing<'_>) -> T) -> T {
    let workcell = Workcell::new(cell).unwrap();
    let a = Assessment::new("start", &workcell, workcell.cell.start());
    let detail = Detail { lenses: false, envelopes: false, nodes: usize::MAX };
    look(&Drawing::new(&a, &detail).unwrap())
}

fn small() -> Shot {
    Shot { width: 200, height: 140, operation: Some(0), ..Shot::default() }
}

/// Returns width, height and pixels of a PNG file.
fn decoded(bytes: &[u8]) -> (u32, u32, Vec<u8>) {
    let mut reader = ::png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width, info.height, pixels)
}

fn seen(x: f64, y: f64, near: f64) -> ScreenPoint {
    ScreenPoint { at: Point2::new(x, y), near }
}

#[test]
fn a_triangle_covers_the_pixels_whose_centres_it_contains() {
    // The triangle is half of a square of 8 by 8 samples. In row k, it covers the centres left of 8 - k -
    // 1/2. Centres on the diagonal belong to only one half.
    let mut canvas = DepthBuffer::new(10, 10, 0u32);
    let (a, b, c, d) = (seen(0.0, 0.0, 1.0), seen(8.0, 0.0, 1.0), seen(0.0, 8.0, 1.0), seen(8.0, 8.0, 1.0));
    canvas.fill(&[a, b, c], false, |v, _| *v += 1);
    let first: u32 = canvas.value.iter().sum();
    assert!(first == 28 || first == 36, "{first}");
    // The other half has the opposite orientation. Together they cover each pixel of the square once.
    canvas.fill(&[b, c, d], false, |v, _| *v += 1);
    for (k, count) in canvas.value.iter().enumerate() {
        assert_eq!(*count, u32::from(k % 10 < 8 && k / 10 < 8), "sample {k}");
    }
}

#[test]
fn a_triangle_fan_leaves_no_gap_and_no_overlap() {
    let mut canvas = DepthBuffer::new(64, 64, 0u32);
    let rim = |k: usize| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / 37.0).sin_cos();
        seen(31.3 + 27.9 * cos, 32.6 + 27.9 * sin, 0.0)
    };
    for k in 0..37 {
        canvas.fill(&[seen(30.77, 31.1, 0.0), rim(k), rim(k + 1)], false, |v, _| *v += 1);
    }
    assert!(canvas.value.iter().all(|v| *v < 2));
    let area = 37.0 / 2.0 * 27.9f64.powi(2) * (std::f64::consts::TAU / 37.0).sin();
    let covered: u32 = canvas.value.iter().sum();
    assert!((f64::from(covered) / area - 1.0).abs() < 0.01, "{covered} of {area}");
}

#[test]
fn the_nearer_of_two_planes_wins_in_any_order() {
    let plane =
        |near: [f64; 3]| [seen(0.0, 0.0, near[0]), seen(20.0, 0.0, near[1]), seen(0.0, 20.0, near[2])];
    // The planes intersect at x = 10. On the left, the first plane is nearer.
    let (flat, tilted) = (plane([0.5; 3]), plane([0.0, 1.0, 0.0]));
    for order in [[0, 1], [1, 0]] {
        let mut canvas = DepthBuffer::new(20, 20, 9usize);
        for k in order {
            canvas.fill([&flat, &tilted][k], true, |v, _| *v = k);
        }
        for x in [0, 4, 9, 10, 14, 17] {
            assert_eq!(canvas.value[20 + x], usize::from(x >= 10), "{order:?} {x}");
        }
    }
}

#[test]
fn a_ball_is_rendered_as_a_disc_at_its_place() {
    let centre = Vector3::new(0.4, -0.3, 0.8);
    let radius = 0.25;
    let ball = Mesh::of(&sweetspot::cell::Shape::Sphere { centre, radius }, 0.0);
    let frame = PictureFrame { left: 10.0, top: 20.0, width: 200.0, height: 160.0 };
    for view in ViewDirection::ALL {
        let camera = Camera::fitted(view, false, &Vector3::new(1.0, 1.0, 0.0), &ball.positions, &frame);
        let mut canvas = DepthBuffer::new(240, 200, 0u32);
        for t in &ball.triangles {
            canvas.fill(&t.map(|i| camera.seen(&ball.positions[i as usize])), true, |v, _| *v = 1);
        }
        let covered: Vec<usize> = (0..canvas.value.len()).filter(|k| canvas.value[*k] == 1).collect();
        let count = covered.len() as f64;
        // In parallel projection, every silhouette is a circle with the radius of the ball (a polygon of 32
        // corners here).
        let area = std::f64::consts::PI * (radius * camera.scale).powi(2);
        assert!((count / area - 1.0).abs() < 0.02, "{view:?}: {count} of {area}");
        let x = covered.iter().map(|k| (k % 240) as f64 + 0.5).sum::<f64>() / count;
        let y = covered.iter().map(|k| (k / 240) as f64 + 0.5).sum::<f64>() / count;
        let at = camera.seen(&centre).at;
        assert!((at - Point2::new(x, y)).norm() < 0.7, "{view:?}: ({x}, {y}) for {at}");
        assert!((at - Point2::new(110.0, 100.0)).norm() < 2.0, "{at}");
    }
}

#[test]
fn a_camera_frames_its_points_and_orders_them_by_depth() {
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2].map(|b| b as f64 * 2.0 - 0.7);
    let points: Vec<Vector3<f64>> = (0..8).map(|k| Vector3::from(corner(k))).collect();
    let frame = PictureFrame { left: 30.0, top: 40.0, width: 300.0, height: 200.0 };
    for (view, perspective) in ViewDirection::ALL.into_iter().flat_map(|v| [(v, false), (v, true)]) {
        let camera = Camera::fitted(view, perspective, &Vector3::y(), &points, &frame);
        for p in &points {
            let s = camera.seen(p);
            assert!((29.9..330.1).contains(&s.at.x) && (39.9..240.1).contains(&s.at.y), "{view:?} {s:?}");
            let before = camera.seen(&camera.before(p, 0.1));
            assert!((before.at - s.at).norm() < 1e-6 && before.near > s.near, "{view:?}");
        }
    }
}

#[test]
fn every_printable_character_has_a_glyph_of_its_own() {
    let glyphs: Vec<Vec<Vec<_>>> =
        (' '..='~').map(|c| font::strokes(&c.to_string(), Default::default(), 9.0)).collect();
    assert_eq!(glyphs.len(), 95);
    assert!(glyphs[0].is_empty());
    let unknown = font::strokes("\u{263a}", Default::default(), 9.0);
    for (k, glyph) in glyphs.iter().enumerate().skip(1) {
        assert!(!glyph.is_empty() && *glyph != unknown, "{}", k + 32);
        let other = (0..k).find(|o| glyphs[*o] == *glyph);
        // A capital i, a bar and a small l are lines, but they must differ.
        assert_eq!(other, None, "{} and {:?}", k + 32, other.map(|o| o + 32));
        let ink = glyph.iter().flatten();
        assert!(
            ink.clone().all(|p| (-10.1..=3.1).contains(&p.y) && (0.0..=8.1).contains(&p.x)),
            "{}",
            k + 32
        );
    }
}

#[test]
fn a_text_is_as_wide_as_its_ink() {
    for text in ["H", "mm", "arrows 25 x; bar 20 mm", "Wgjq|[]{}", "i l"] {
        let ink = font::strokes(text, Default::default(), 18.0);
        let right = ink.iter().flatten().map(|p| p.x).fold(f64::MIN, f64::max);
        let width = font::width(text, 18.0);
        // Curved strokes end slightly inside the bounding box of their corners.
        assert!(width + 1e-9 >= right && width - right < 2.0, "{text}: {width} {right}");
        assert!((font::width(text, 9.0) * 2.0 - width).abs() < 1e-9);
    }
    assert_eq!(font::width("", 9.0), 0.0);
}

#[test]
fn a_picture_has_the_requested_size_and_is_deterministic() {
    drawn(loaded("hitachi_paper.toml"), |drawing| {
        let bytes = png(drawing, &small()).unwrap();
        assert_eq!(bytes, png(drawing, &small()).unwrap());
        let (width, height, pixels) = decoded(&bytes);
        assert_eq!((width, height, pixels.len()), (200, 140, 200 * 140 * 3));
        let colours: std::collections::BTreeSet<_> = pixels.chunks(3).collect();
        assert!(colours.len() > 200, "{}", colours.len());
        // Every option changes the picture.
        let others = [
            Shot { operation: None, ..small() },
            Shot { view: ViewDirection::Top, ..small() },
            Shot { perspective: false, ..small() },
            Shot { show: Show::Z, ..small() },
            Shot { show: Show::Nothing, ..small() },
            Shot { sense: Some("x".into()), ..small() },
            Shot { labels: false, ..small() },
            Shot { legend: false, ..small() },
            Shot { dark: true, ..small() },
        ];
        for other in others {
            assert_ne!(decoded(&png(drawing, &other).unwrap()).2, pixels, "{other:?}");
        }
    });
}

#[test]
fn an_impossible_picture_is_an_error() {
    drawn(loaded("hitachi_paper.toml"), |drawing| {
        for bad in [
            Shot { width: 0, ..small() },
            Shot { height: 1_000_000, ..small() },
            Shot { take: 7, ..small() },
            Shot { operation: Some(3), ..small() },
        ] {
            assert!(png(drawing, &bad).is_err() && isometric(drawing, &bad).is_err(), "{bad:?}");
        }
    });
}

#[test]
fn an_svg_is_well_formed_whatever_the_names() {
    let evil = "<script>alert(1)</script>\" onload='x' & \u{1b}[31m";
    let mut cell = loaded("hitachi_cell.toml");
    cell.name = evil.into();
    cell.robot.name = evil.into();
    cell.equipment.iter_mut().for_each(|e| e.name = evil.into());
    cell.operations.iter_mut().for_each(|o| o.name = evil.into());
    drawn(cell, |drawing| {
        let svg = isometric(drawing, &Shot { width: 400, height: 250, ..Shot::default() }).unwrap();
        let document = roxmltree::Document::parse(&svg).unwrap();
        let all = || document.descendants().filter(|n| n.is_element());
        for name in ["script", "style", "image", "a", "foreignObject"] {
            assert!(!all().any(|n| n.has_tag_name(name)), "{name}");
        }
        let attributes = || all().flat_map(|n| n.attributes());
        assert!(!attributes().any(|a| a.name().starts_with("on") || a.name() == "style"));
        assert!(!svg.contains('\u{1b}'));
        // Every visible node has a title: its value, or the reason why it has no value.
        let fields = drawing.fields.iter().flat_map(|f| &f.nodes).count();
        let titles = all().filter(|n| n.has_tag_name("title")).count() - 1;
        assert!(titles > fields / 2 && titles <= fields, "{titles} of {fields}");
        assert!(all().any(|n| n.text().is_some_and(|t| t.contains("<script>"))), "names are shown");
    });
}

/// Texts on one line of the legend do not overlap, and the last text ends inside the picture. A text of the
/// SVG is as wide as in the stroke font.
#[test]
fn texts_of_a_legend_do_not_overlap() {
    for name in ["panda_cell.toml", "drilling_cell.toml"] {
        drawn(loaded(name), |drawing| {
            for (width, show) in
                [(500, Show::Resultant), (600, Show::X), (600, Show::InPlane), (1600, Show::Z)]
            {
                let shot = Shot { width, height: width * 5 / 8, show, labels: false, ..Shot::default() };
                let svg = isometric(drawing, &shot).unwrap();
                let document = roxmltree::Document::parse(&svg).unwrap();
                let number =
                    |n: &roxmltree::Node<'_, '_>, key| n.attribute(key).unwrap().parse::<f64>().unwrap();
                let all = document.descendants().filter(|n| n.has_tag_name("text"));
                let texts: Vec<_> = all
                    .map(|n| {
                        let (left, size) = (number(&n, "x"), number(&n, "font-size"));
                        (number(&n, "y"), left, left + font::width(n.text().unwrap(), size / 1.38))
                    })
                    .collect();
                assert!(texts.len() >= 6, "{name} {show:?}: {texts:?}");
                assert!(
                    texts.iter().all(|(_, _, right)| *right <= width as f64),
                    "{name} {show:?}: {texts:?}"
                );
                for (k, (y, left, right)) in texts.iter().enumerate() {
                    let beside = texts[k + 1..].iter().filter(|other| (other.0 - y).abs() < 3.0);
                    let overlaps = |other: &&(f64, f64, f64)| *left < other.2 && other.1 < *right;
                    assert_eq!(beside.filter(overlaps).count(), 0, "{name} {show:?}: {texts:?}");
                }
            }
        });
    }
}

/// The pictures also show a table out of reach and a cell without operations.
#[test]
fn a_drawing_without_errors_is_rendered() {
    let mut cell = loaded("hitachi_paper.toml");
    cell.equipment[0].placement[0] = sweetspot::cell::Coordinate::Fixed(9.0);
    drawn(cell, |drawing| {
        assert_eq!(drawing.fields[0].usable().count(), 0);
        decoded(&png(drawing, &small()).unwrap());
        assert!(isometric(drawing, &small()).unwrap().contains("out of reach"));
    });
    let mut cell = loaded("hitachi_paper.toml");
    cell.operations.clear();
    drawn(cell, |drawing| {
        let shot = Shot { operation: None, ..small() };
        decoded(&png(drawing, &shot).unwrap());
        roxmltree::Document::parse(&isometric(drawing, &shot).unwrap()).unwrap();
    });
}

#[test]
fn contour_tracing_keeps_areas_and_holes() {
    // The area is 9 by 6 cells with a hole of 3 by 2. A second area is too small to be kept.
    let mut values = vec![0u32; 20 * 12];
    for (x, y) in (3..12).flat_map(|x| (2..8).map(move |y| (x, y))) {
        values[y * 20 + x] = u32::from(!((5..8).contains(&x) && (4..6).contains(&y))) * 7;
    }
    values[11 * 20 + 19] = 9;
    let outlines = trace::outlines(&values, 20, 2.0, 0.5);
    assert_eq!(outlines.keys().copied().collect::<Vec<_>>(), [0, 7]);
    let mut rings = outlines[&7].clone();
    rings.iter_mut().for_each(|r| r.sort_unstable());
    rings.sort_unstable();
    let corners = |x: [i32; 2], y: [i32; 2]| vec![[x[0], y[0]], [x[0], y[1]], [x[1], y[0]], [x[1], y[1]]];
    assert_eq!(rings, [corners([3, 12], [2, 8]), corners([5, 8], [4, 6])]);
}
