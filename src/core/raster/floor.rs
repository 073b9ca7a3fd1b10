//! Floor: a plate with grid lines. The plate is darkened below solids that rest on the floor or are close
//! above it.

use super::camera::ScreenPoint;
use super::canvas::DepthBuffer;
use super::palette::{Colour, Palette, mixed};
use super::scene::{RasterScene, SceneBody, SceneLine};
use crate::drawing::Mesh;
use nalgebra::{Point2, Vector3};

/// Number of tiles of the floor along each side.
const FIELDS: usize = 160;
/// Height above the floor, m, at which a solid darkens the floor half as much as a solid that rests on the
/// floor.
const HALF_SHADE_HEIGHT: f64 = 0.35;
/// Distance between neighbouring grid lines, m.
const GRID: f64 = 0.5;

/// Adds the floor at `height` (m) to the scene. The floor extends beyond all bodies that the scene already
/// holds.
pub fn lay(scene: &mut RasterScene, palette: &Palette, height: f64) {
    let points: Vec<Vector3<f64>> = scene.bodies.iter().flat_map(|b| &b.mesh.positions).copied().collect();
    let bounds = points.iter().map(|p| (*p, *p)).reduce(|(lo, hi), (p, q)| (lo.inf(&p), hi.sup(&q)));
    let Some((low, high)) = bounds else { return };
    let margin = 0.15;
    let [low, high] = [
        [low.x, low.y].map(|v| ((v - margin) / GRID).floor() * GRID),
        [high.x, high.y].map(|v| ((v + margin) / GRID).ceil() * GRID),
    ];
    let dark = shade(scene, low, high, height);
    let at = |i: usize, j: usize| {
        let along = |axis: usize, k: usize| low[axis] + (high[axis] - low[axis]) * k as f64 / FIELDS as f64;
        Vector3::new(along(0, i), along(1, j), height)
    };
    let across = FIELDS + 1;
    let positions: Vec<_> = (0..across * across).map(|k| at(k % across, k / across)).collect();
    let shares = dark.iter().map(|d| 1.0 - d).collect();
    let quads = (0..FIELDS * FIELDS).map(|k| ((k / FIELDS) * across + k % FIELDS) as u32);
    let wide = across as u32;
    let triangles = quads.flat_map(|a| [[a, a + 1, a + wide + 1], [a, a + wide + 1, a + wide]]).collect();
    let normals = vec![Vector3::z(); positions.len()];
    let mesh = Mesh { positions, normals, triangles };
    let body = SceneBody {
        is_lit: false,
        has_edges: false,
        shares,
        dark: shadow(palette),
        ..SceneBody::solid(mesh, palette.floor, 1.0)
    };
    scene.bodies.insert(0, body);
    add_grid(scene, palette.grid, low, high, height);
}

fn shadow(palette: &Palette) -> Colour {
    mixed(palette.floor, [0.02, 0.03, 0.05], 0.55)
}

fn add_grid(scene: &mut RasterScene, colour: Colour, low: [f64; 2], high: [f64; 2], height: f64) {
    let lift = 0.0;
    for axis in 0..2 {
        let count = ((high[axis] - low[axis]) / GRID).round() as usize;
        for k in 0..=count.min(400) {
            let value = low[axis] + k as f64 * GRID;
            // Ends of a grid line.
            let end = |v: f64| {
                if axis == 0 { Vector3::new(value, v, height) } else { Vector3::new(v, value, height) }
            };
            let points = vec![end(low[1 - axis]), end(high[1 - axis])];
            let line =
                SceneLine { points, closed: false, dashed: false, colour, width: 0.7, lift: lift + 0.0005 };
            scene.lines.insert(0, line);
        }
    }
}

/// Returns the blurred shade of the floor at each corner of the tiles. The shade is the share of the light
/// from above that solids block.
fn shade(scene: &RasterScene, low: [f64; 2], high: [f64; 2], floor: f64) -> Vec<f32> {
    let across = FIELDS + 1;
    let mut lowest = DepthBuffer::new(across, across, ());
    let scale = |axis: usize| FIELDS as f64 / (high[axis] - low[axis]).max(1e-9);
    let (sx, sy) = (scale(0), scale(1));
    for body in scene.bodies.iter().filter(|b| b.opacity >= 1.0 && !b.is_sign) {
        let seen = |p: &Vector3<f64>| ScreenPoint {
            at: Point2::new((p.x - low[0]) * sx + 0.5, (p.y - low[1]) * sy + 0.5),
            near: floor - p.z,
        };
        for t in &body.mesh.triangles {
            let corners = t.map(|i| seen(&body.mesh.positions[i as usize]));
            lowest.fill(&corners, true, |_, _| ());
        }
    }
    let share = |near: f32| {
        if near == f32::MIN {
            0.0
        } else {
            1.0 / (1.0 + (f64::from(-near).max(0.0) / HALF_SHADE_HEIGHT).powi(2))
        }
    };
    let mut dark: Vec<f32> = lowest.near.iter().map(|n| share(*n) as f32).collect();
    for _ in 0..3 {
        dark = blurred(&dark, across, 1);
        dark = blurred(&dark, across, across);
    }
    dark
}

/// Returns, for each place of a square grid, the mean of five values along one direction. The five values are
/// the value at the place and those of two neighbours on each side (0 outside the grid).
///
/// The grid has `across` values per row. The direction is along rows if `step` is 1, and along columns if
/// `step` is `across`.
fn blurred(values: &[f32], across: usize, step: usize) -> Vec<f32> {
    const REACH: isize = 2;
    let place = |k: usize| if step == 1 { k % across } else { k / across };
    let mean = |k: usize| {
        let sum: f32 = (-REACH..=REACH)
            .filter_map(|d| {
                let there = place(k) as isize + d;
                let inside = (0..across as isize).contains(&there);
                inside.then(|| values[(k as isize + d * step as isize) as usize])
            })
            .sum();
        sum / (2 * REACH + 1) as f32
    };
    (0..values.len()).map(mean).collect()
}
