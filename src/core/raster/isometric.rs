//! SVG picture of the scene with hidden lines removed, for print and for browsers without WebGL.
//!
//! As in the PNG, a depth buffer decides what is visible at each sample. Areas of equal tone become outlines
//! (contour tracing), and lines are cut to their visible parts.

use super::camera::{Camera, ScreenPoint};
use super::canvas::DepthBuffer;
use super::palette::{Colour, Light, hex};
use super::scene::SceneLine;
use super::{FittedScene, Shot, edges, labels, staged, strip, trace};
use crate::drawing::Drawing;
use crate::svg_text::escaped;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Number of samples per pixel along each side.
const SAMPLES: f64 = 2.0;
/// Number of tones (steps of brightness) with which a body is drawn.
const TONES: f32 = 16.0;
/// Tolerance of the simplification of an outline, in samples.
const TOLERANCE: f64 = 0.8;
/// Least area that an outline must enclose to be drawn, in squared samples.
const MIN_AREA: f64 = 8.0;

/// Returns the picture as SVG, always in parallel projection.
///
/// # Errors
/// Returns a message for the same reasons as [`super::png`].
pub fn isometric(drawing: &Drawing<'_>, shot: &Shot) -> Result<String, String> {
    let shot = &Shot { perspective: false, ..shot.clone() };
    let stage = staged(drawing, shot)?;
    let (width, height) = (shot.width, shot.height);
    let mut out = String::new();
    // The results of writing are ignored, because writing to a String cannot fail.
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"system-ui, sans-serif\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n<title>{}</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{}\"/>",
        escaped(&crate::safe_text::shown(&drawing.cell.name)),
        hex(stage.palette.paper)
    );
    let canvas = draw_areas(&mut out, &stage, shot);
    let seeing = VisibilityTest { camera: &stage.camera, canvas: &canvas };
    let pixel = shot.capital() / 10.0;
    draw_lines(&mut out, &stage, &seeing, pixel);
    draw_clear(&mut out, &stage, &canvas);
    draw_nodes(&mut out, &stage, &seeing, pixel);
    if shot.labels {
        draw_labels(&mut out, &stage, shot);
    }
    if shot.legend {
        strip::draw(&mut out, &strip::items(drawing, &stage, shot));
    }
    out.push_str("</svg>\n");
    Ok(out)
}

fn sampled(camera: &Camera, p: &Vector3<f64>) -> ScreenPoint {
    let seen = camera.seen(p);
    ScreenPoint { at: seen.at * SAMPLES, ..seen }
}

/// Draws solids and floor as areas of uniform tone, and returns the depth buffer that decides visibility.
fn draw_areas(out: &mut String, stage: &FittedScene, shot: &Shot) -> DepthBuffer<u32> {
    let size = [shot.width, shot.height].map(|side| (side as f64 * SAMPLES) as usize);
    let mut canvas = DepthBuffer::new(size[0], size[1], 0u32);
    let light = Light::of(&stage.camera);
    let mut colours: Vec<(usize, f32)> = Vec::new();
    let mut number: BTreeMap<(usize, u32), u32> = BTreeMap::new();
    for (k, body) in stage.scene.bodies.iter().enumerate() {
        if body.opacity < 1.0 || body.is_sign {
            continue;
        }
        let corners: Vec<ScreenPoint> =
            body.mesh.positions.iter().map(|p| sampled(&stage.camera, p)).collect();
        let tones = body.tones(&light);
        for t in &body.mesh.triangles {
            let t = t.map(|i| i as usize);
            let [a, b, c] = t.map(|i| tones[i]);
            canvas.fill(&t.map(|i| corners[i]), true, |v, s| {
                let tone = ((a * s[0] + b * s[1] + c * s[2]) * TONES).round();
                *v = *number.entry((k, tone as u32)).or_insert_with(|| {
                    colours.push((k, tone / TONES));
                    colours.len() as u32
                });
            });
        }
    }
    let _ = writeln!(out, "<g transform=\"scale({})\" stroke-width=\"1.6\">", 1.0 / SAMPLES);
    for (value, rings) in trace::outlines(&canvas.value, canvas.width, MIN_AREA, TOLERANCE) {
        let Some((k, tone)) = (value as usize).checked_sub(1).and_then(|v| colours.get(v)) else { continue };
        let fill = hex(stage.scene.bodies[*k].toned(*tone));
        let d = trace::path(&rings);
        let _ = writeln!(out, "<path fill-rule=\"evenodd\" fill=\"{fill}\" stroke=\"{fill}\" d=\"{d}\"/>");
    }
    out.push_str("</g>\n");
    canvas
}

/// Visibility test of points of the scene against the depth buffer.
struct VisibilityTest<'a> {
    camera: &'a Camera,
    canvas: &'a DepthBuffer<u32>,
}

impl VisibilityTest<'_> {
    fn sees(&self, p: &Vector3<f64>) -> bool {
        let seen = sampled(self.camera, p);
        let (width, height) = (self.canvas.width as i64, self.canvas.height as i64);
        let (x, y) = (seen.at.x.floor() as i64, seen.at.y.floor() as i64);
        // An outline lies between a solid and its background, so one visible sample beside the outline is
        // enough.
        let around = (-1..=1).flat_map(|j| (-1..=1).map(move |i| (x + i, y + j)));
        around.into_iter().any(|(x, y)| {
            let inside = (0..width).contains(&x) && (0..height).contains(&y);
            !inside || seen.near as f32 >= self.canvas.near[(y * width + x) as usize]
        })
    }

    /// Appends the visible parts of a segment (world frame) to the SVG path data `d`, px.
    ///
    /// Before the test, the segment is shifted towards the eye by `lift` (m).
    fn add(&self, d: &mut String, [a, b]: &[Vector3<f64>; 2], lift: f64) {
        let [a, b] = [a, b].map(|p| self.camera.before(p, lift));
        let far = (self.camera.seen(&b).at - self.camera.seen(&a).at).norm();
        let steps = (far / 1.5).ceil().clamp(1.0, 2000.0) as usize;
        let at = |k: usize| a + (b - a) * (k as f64 / steps as f64);
        let mut from: Option<usize> = None;
        for k in 0..=steps {
            let seen = self.sees(&at(k));
            from = if seen { from.or(Some(k)) } else { from };
            let Some(first) = from.filter(|_| !seen || k == steps) else { continue };
            let last = if seen { k } else { k - 1 };
            if last > first {
                let [p, q] = [first, last].map(|k| self.camera.seen(&at(k)).at);
                let start = format!("M{:.1} {:.1}", p.x, p.y);
                // A line that starts at the end of the previous line needs no start point.
                if !d.ends_with(&start[1..]) {
                    d.push_str(&start);
                }
                let _ = write!(d, "L{:.1} {:.1}", q.x, q.y);
            }
            from = None;
        }
    }
}

/// Draws the edges of bodies and the lines of the scene, grouped by colour and width.
fn draw_lines(out: &mut String, stage: &FittedScene, seeing: &VisibilityTest<'_>, pixel: f64) {
    let lift = stage.scene.size * 0.002;
    let mut groups: Vec<(Colour, f64, String)> = Vec::new();
    let mut add = |colour: Colour, width: f64, span: &[Vector3<f64>; 2], lift: f64| {
        let k = groups.iter().position(|g| g.0 == colour && g.1 == width).unwrap_or_else(|| {
            groups.push((colour, width, String::new()));
            groups.len() - 1
        });
        seeing.add(&mut groups[k].2, span, lift);
    };
    let (floor, above): (Vec<&SceneLine>, Vec<&SceneLine>) =
        stage.scene.lines.iter().partition(|l| l.colour == stage.palette.grid);
    floor.iter().for_each(|l| l.spans().for_each(|span| add(l.colour, l.width, &span, l.lift)));
    for body in stage.scene.bodies.iter().filter(|b| b.has_edges && !b.is_sign) {
        let colour = stage.palette.edge(body.colour);
        edges::of(body, &stage.camera).iter().for_each(|span| add(colour, 0.9, span, lift));
    }
    above.iter().for_each(|l| l.spans().for_each(|span| add(l.colour, l.width, &span, l.lift)));
    for (colour, width, d) in groups.iter().filter(|g| !g.2.is_empty()) {
        let (stroke, width) = (hex(*colour), width * pixel);
        let _ =
            writeln!(out, "<path fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width:.2}\" d=\"{d}\"/>");
    }
}

/// Draws each transparent body. The sides that face away from the eye are drawn first, then the sides that
/// face the eye.
fn draw_clear(out: &mut String, stage: &FittedScene, canvas: &DepthBuffer<u32>) {
    for body in stage.scene.bodies.iter().filter(|b| b.opacity < 1.0) {
        for front in [false, true] {
            let mut mask = DepthBuffer::new(canvas.width, canvas.height, 0u32);
            mask.near.copy_from_slice(&canvas.near);
            for t in &body.mesh.triangles {
                let [a, b, c] = t.map(|i| body.mesh.positions[i as usize]);
                let faces_eye = (b - a).cross(&(c - a)).dot(&stage.camera.to_eye(&a)) > 0.0;
                if faces_eye == front {
                    mask.fill(&[a, b, c].map(|p| sampled(&stage.camera, &p)), false, |v, _| *v = 1);
                }
            }
            let outlines = trace::outlines(&mask.value, mask.width, MIN_AREA, TOLERANCE);
            let Some(rings) = outlines.get(&1) else { continue };
            let (fill, d) = (hex(body.colour), trace::path(rings));
            let _ = writeln!(
                out,
                "<path transform=\"scale({})\" fill-rule=\"evenodd\" fill=\"{fill}\" fill-opacity=\"{}\" d=\"{d}\"/>",
                1.0 / SAMPLES,
                body.opacity
            );
        }
    }
}

/// Draws the visible nodes, then the arrows. Farther arrows are drawn first.
fn draw_nodes(out: &mut String, stage: &FittedScene, seeing: &VisibilityTest<'_>, pixel: f64) {
    let lift = stage.scene.size * 0.006;
    for mark in &stage.scene.nodes {
        if !seeing.sees(&seeing.camera.before(&mark.at, lift)) {
            continue;
        }
        let at = seeing.camera.seen(&mark.at).at;
        let (fill, opacity, radius) = match mark.colour {
            Some(colour) => (hex(colour), "", 2.6 * pixel),
            None => (hex(stage.palette.ring), " fill-opacity=\"0\"", 6.0 * pixel),
        };
        let _ = writeln!(
            out,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\" fill=\"{fill}\"{opacity}><title>{}</title></circle>",
            at.x,
            at.y,
            escaped(&mark.title.replace(char::is_control, " "))
        );
    }
    draw_arrows(out, stage, seeing, (lift, pixel));
}

fn draw_arrows(
    out: &mut String,
    stage: &FittedScene,
    seeing: &VisibilityTest<'_>,
    (lift, pixel): (f64, f64),
) {
    let near = |a: &Vector3<f64>| seeing.camera.seen(a).near;
    let mut arrows: Vec<_> = stage.scene.arrows.iter().collect();
    arrows.sort_by(|a, b| near(&a.0.tail).total_cmp(&near(&b.0.tail)));
    for (arrow, colour) in arrows {
        let mut d = String::new();
        seeing.add(&mut d, &[arrow.tail, arrow.tip], lift);
        if d.is_empty() {
            continue;
        }
        for barb in arrow.barbs() {
            seeing.add(&mut d, &[barb, arrow.tip], lift);
        }
        // A rim is drawn first, so that light arrows are visible on a light background.
        for (colour, width) in [(stage.palette.rim(*colour), 2.9), (*colour, 1.8)] {
            let (stroke, width) = (hex(colour), width * pixel);
            let _ = writeln!(
                out,
                "<path fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width:.2}\" d=\"{d}\"/>"
            );
        }
    }
}

fn draw_labels(out: &mut String, stage: &FittedScene, shot: &Shot) {
    let (unit, palette) = (shot.capital(), &stage.palette);
    let all = labels::placed(stage, shot);
    for [a, b] in all.iter().filter_map(|l| l.leader) {
        let _ = writeln!(
            out,
            "<path stroke=\"{}\" stroke-width=\"{:.1}\" d=\"M{:.1} {:.1}L{:.1} {:.1}\"/>",
            hex(palette.spot),
            0.16 * unit,
            a.x,
            a.y,
            b.x,
            b.y
        );
    }
    for label in &all {
        let colour = if label.leader.is_some() { palette.spot } else { palette.text };
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"{:.1}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"{:.1}\" \
             paint-order=\"stroke\">{}</text>",
            label.at.x,
            label.at.y,
            strip::TEXT * unit,
            hex(colour),
            hex(palette.paper),
            0.4 * unit,
            escaped(&label.text)
        );
    }
}
