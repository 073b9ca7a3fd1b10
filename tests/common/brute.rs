//! Independent check that a layout is feasible and has its stated value. The check uses 4 x 4 matrices,
//! clipped polygons and clouds of points, and no code of `clearance`, `reach` or `kinematic_error`.

use nalgebra::{Matrix4, Vector3, Vector4};
use sweetspot::assess::Assessment;
use sweetspot::cell::{Cell, JointKind, Layout, Placement, Rectangle, Role, Shape};
use sweetspot::cell::{ErrorSet, SignedErrors};
use sweetspot::pose::Pose;

type Frame = Matrix4<f64>;

/// Distance between the points of a cloud, m.
const STEP: f64 = 0.02;
const DEEP: f64 = 1e-6;

fn frame(pose: &Pose) -> Frame {
    let mut m = Frame::identity();
    m.fixed_view_mut::<3, 3>(0, 0).copy_from(&pose.rotation);
    m.fixed_view_mut::<3, 1>(0, 3).copy_from(&pose.translation);
    m
}

fn placed(at: &Placement) -> Frame {
    turn_z(at.yaw).append_translation(&Vector3::new(at.x, at.y, at.z))
}

fn turn_z(angle: f64) -> Frame {
    Frame::from_axis_angle(&Vector3::z_axis(), angle)
}

fn point(m: &Frame, p: &Vector3<f64>) -> Vector3<f64> {
    (m * Vector4::new(p.x, p.y, p.z, 1.0)).xyz()
}

/// Returns the frame after every D-H row and then the TCP, by eqs. (1) and (2), for rows with the errors
/// `errors`.
fn links(cell: &Cell, q: &[f64], errors: Option<&SignedErrors>) -> Vec<Frame> {
    let mut frames = vec![frame(&cell.start().base.pose()) * frame(&cell.robot.mount)];
    for (i, joint) in cell.robot.joints.iter().enumerate() {
        let off = |row: fn(&SignedErrors) -> &Vec<f64>| errors.map_or(0.0, |e| row(e)[i]);
        let along = q[i] + off(|e| &e.dq);
        let (turn, slide) = if joint.kind == JointKind::Revolute { (along, 0.0) } else { (0.0, along) };
        let r = joint.r + slide + off(|e| &e.dr);
        let a = turn_z(joint.theta + turn)
            * Frame::new_translation(&Vector3::new(joint.l + off(|e| &e.dl), 0.0, r))
            * Frame::from_axis_angle(&Vector3::x_axis(), joint.alpha + off(|e| &e.dalpha));
        frames.push(frames[i] * a);
    }
    frames.push(frames[frames.len() - 1] * frame(&cell.robot.tool));
    frames
}

/// Returns the faults of a layout that is reported as feasible.
pub fn faults(a: &Assessment<'_>) -> Vec<String> {
    let mut faults = overlaps(a.cell, &a.layout);
    for k in 0..a.maps.len() {
        match a.spot(k) {
            None => faults.push(format!("operation {k} has no spot")),
            Some((node, posture)) => {
                let q = &posture.joints[..a.cell.robot.axes()];
                faults.extend(
                    at_spot(a, k, &node.position, q).into_iter().map(|f| format!("operation {k}: {f}")),
                );
                faults.extend(hits(a.cell, &a.layout, q).into_iter().map(|f| format!("operation {k}: {f}")));
                faults.extend(value(a, k, q, posture.value));
            }
        }
    }
    faults
}

/// Checks the TCP at the spot: it must be on the surface, with the tool down and the joints within their
/// limits.
fn at_spot(a: &Assessment<'_>, k: usize, spot: &Vector3<f64>, q: &[f64]) -> Vec<String> {
    let (cell, operation) = (a.cell, &a.cell.operations[k]);
    let mut faults = Vec::new();
    let mut check = |holds: bool, what: String| {
        if !holds {
            faults.push(what);
        }
    };
    let tcp = *links(cell, q, None).last().unwrap();
    let gap = (point(&tcp, &Vector3::zeros()) - spot).norm();
    check(gap < 1e-8, format!("the TCP is {gap} m off its spot"));
    let axis = (tcp * cell.robot.tool_axis.push(0.0)).xyz();
    check(axis.z < -1.0 + 1e-9, format!("the tool points along {axis:?}"));
    for (i, (joint, q)) in cell.robot.joints.iter().zip(q).enumerate() {
        let (low, high) = joint.limits;
        check((low - 1e-9..=high + 1e-9).contains(q), format!("joint {i} at {q} is not in {low} to {high}"));
    }
    let on = operation.equipment;
    let local = point(&placed(&a.layout.placements[on]).try_inverse().unwrap(), spot);
    let surface = cell.equipment[on].surface.unwrap();
    let inside = |v: f64, centre: f64, size: f64| (v - centre).abs() <= size / 2.0 + 1e-9;
    check((local.z - operation.standoff).abs() < 1e-9, format!("{} m above the surface", local.z));
    check(inside(local.x, surface.centre.0, surface.size.0), format!("x {} off the surface", local.x));
    check(inside(local.y, surface.centre.1, surface.size.1), format!("y {} off the surface", local.y));
    faults
}

/// Checks the value of a signed sample. The reference error is the difference of two products of matrices.
fn value(a: &Assessment<'_>, k: usize, q: &[f64], said: f64) -> Option<String> {
    let ErrorSet::Signed(errors) = a.cell.error_set() else { return None };
    let tip = |e| links(a.cell, q, e).last().unwrap().fixed_view::<3, 1>(0, 3).into_owned();
    let d: Vector3<f64> = tip(Some(errors)) - tip(None);
    let error = match a.cell.operations[k].sense.name.as_str() {
        "x" => d.x.abs(),
        "y" => d.y.abs(),
        "z" => d.z.abs(),
        "xy" => d.x.hypot(d.y),
        _ => d.norm(),
    };
    ((error - said).abs() > 1e-10).then(|| format!("operation {k}: {said} said, {error} m is it"))
}

/// Returns the overlaps of floor spaces in plan, by clipping one polygon with the other.
fn overlaps(cell: &Cell, layout: &Layout) -> Vec<String> {
    let plan = |r: &Rectangle, at: &Frame| {
        let (x, y) = (r.size.0 / 2.0, r.size.1 / 2.0);
        [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(dx, dy)| {
            let p = point(at, &Vector3::new(r.centre.0 + dx, r.centre.1 + dy, 0.0));
            (p.x, p.y)
        })
    };
    let stands: Vec<_> = cell
        .equipment
        .iter()
        .zip(&layout.placements)
        .map(|(e, at)| plan(&e.footprint, &placed(at)))
        .collect();
    let mut others =
        vec![("the robot base".to_string(), plan(&cell.robot.footprint, &frame(&cell.start().base.pose())))];
    for k in &cell.keep_out {
        let (low, high) = (k.min, k.max);
        others.push((k.name.clone(), [(low.x, low.y), (high.x, low.y), (high.x, high.y), (low.x, high.y)]));
    }
    let mut faults = Vec::new();
    for (i, stand) in stands.iter().enumerate() {
        let is_obstacle = |k: usize| cell.equipment[k].role == Role::Obstacle;
        let rest = (i + 1..stands.len()).filter(|&j| !(is_obstacle(i) && is_obstacle(j)));
        let rest = rest.map(|j| (cell.equipment[j].name.clone(), stands[j]));
        // Obstacles may stand in keep-out boxes; the first of the others is the robot base.
        let others = others.iter().take(if is_obstacle(i) { 1 } else { others.len() }).cloned();
        for (name, other) in rest.chain(others) {
            let shared = area(&clipped(stand, &other));
            if shared > 1e-9 {
                faults.push(format!("{} shares {shared} m2 with {name}", cell.equipment[i].name));
            }
        }
    }
    faults
}

/// Returns the part of a polygon inside a convex polygon (both anticlockwise), by clipping at one edge after
/// the other.
fn clipped(polygon: &[(f64, f64)], by: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut left = polygon.to_vec();
    for (k, a) in by.iter().enumerate() {
        let b = by[(k + 1) % by.len()];
        let side = |p: &(f64, f64)| (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0);
        let mut cut = Vec::new();
        for (i, p) in left.iter().enumerate() {
            let q = left[(i + 1) % left.len()];
            let (s, t) = (side(p), side(&q));
            if s >= 0.0 {
                cut.push(*p);
            }
            if (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0) {
                let u = s / (s - t);
                cut.push((p.0 + u * (q.0 - p.0), p.1 + u * (q.1 - p.1)));
            }
        }
        left = cut;
    }
    left
}

fn area(polygon: &[(f64, f64)]) -> f64 {
    let edge = |k: usize| {
        let (a, b) = (polygon[k], polygon[(k + 1) % polygon.len()]);
        a.0 * b.1 - b.0 * a.1
    };
    (0..polygon.len()).map(edge).sum::<f64>().abs() / 2.0
}

/// Solid with its pose in the world and its shape.
struct Body<'c> {
    name: &'c str,
    at: Frame,
    back: Frame,
    shape: Shape,
    cloud: Vec<Vector3<f64>>,
}

impl<'c> Body<'c> {
    /// Returns a body. A leg becomes a box that reaches from the floor to the top of the leg.
    fn new(name: &'c str, carrier: Frame, shape: &Shape, floor: f64) -> Self {
        let (at, shape) = match shape {
            Shape::Box { pose, size } => {
                (carrier * frame(pose), Shape::Box { pose: Pose::identity(), size: *size })
            }
            Shape::Leg { x, y, size, top } => {
                let z = carrier[(2, 3)];
                let height = z + top - floor;
                let centre = Vector3::new(*x, *y, top - height / 2.0);
                let size = Vector3::new(size.0, size.1, height);
                (carrier * Frame::new_translation(&centre), Shape::Box { pose: Pose::identity(), size })
            }
            other => (carrier, other.clone()),
        };
        let mut body = Self { name, at, back: at.try_inverse().unwrap(), shape, cloud: Vec::new() };
        body.cloud = body.points();
        body
    }

    fn box_round(&self) -> (Vector3<f64>, Vector3<f64>) {
        let grown =
            |a: &Vector3<f64>, b: &Vector3<f64>, r: f64| (a.inf(b).add_scalar(-r), a.sup(b).add_scalar(r));
        match &self.shape {
            Shape::Box { size, .. } => (-size / 2.0, size / 2.0),
            Shape::Sphere { centre, radius } => grown(centre, centre, *radius),
            Shape::Capsule { a, b, radius } | Shape::Cylinder { a, b, radius } => grown(a, b, *radius),
            other => panic!("no points of {other:?}"),
        }
    }

    /// Returns the depth of a point (in the frame of the body) below the surface, m; negative outside.
    fn depth(&self, p: &Vector3<f64>) -> f64 {
        match &self.shape {
            Shape::Box { size, .. } => (size / 2.0 - p.abs()).min(),
            Shape::Sphere { centre, radius } => radius - (p - centre).norm(),
            Shape::Capsule { a, b, radius } => {
                let t = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
                radius - (p - a - (b - a) * t).norm()
            }
            Shape::Cylinder { a, b, radius } => {
                let axis = (b - a).normalize();
                let along = (p - a).dot(&axis);
                let across = (p - a - axis * along).norm();
                (radius - across).min(along).min((b - a).norm() - along)
            }
            other => panic!("no depth in {other:?}"),
        }
    }

    /// Returns points of the solid in the world.
    fn points(&self) -> Vec<Vector3<f64>> {
        let (low, high) = self.box_round();
        let counts = (high - low).map(|v| (v / STEP).ceil().max(1.0) as usize);
        let along =
            |axis: usize, k: usize| low[axis] + (high[axis] - low[axis]) * k as f64 / counts[axis] as f64;
        let mut points = Vec::new();
        for i in 0..=counts.x {
            for j in 0..=counts.y {
                for k in 0..=counts.z {
                    let p = Vector3::new(along(0, i), along(1, j), along(2, k));
                    if self.depth(&p) >= -1e-12 {
                        points.push(point(&self.at, &p));
                    }
                }
            }
        }
        points
    }

    fn is_inside(&self, world: &Vector3<f64>) -> bool {
        self.depth(&point(&self.back, world)) > DEEP
    }
}

/// Returns the solids that hide a reflector (interface frame) from an instrument (world), by sampling points
/// of the line of sight.
///
/// A solid of the flange or the tool that contains the reflector does not count.
pub fn between(
    cell: &Cell,
    layout: &Layout,
    q: &[f64],
    reflector: &Vector3<f64>,
    instrument: &Vector3<f64>,
) -> Vec<String> {
    let (frames, last) = (links(cell, q, None), cell.robot.axes());
    let from = point(&frames[last], reflector);
    let standing = cell.equipment.iter().zip(&layout.placements).flat_map(|(e, at)| {
        e.solids.iter().map(move |s| Body::new(&e.name, placed(at), &s.shape, cell.floor))
    });
    let carried = cell.robot.solids.iter().filter_map(|s| {
        let body = Body::new(&s.solid.name, frames[s.link], &s.solid.shape, cell.floor);
        (s.link < last || body.depth(&point(&body.back, &from)) < 0.0).then_some(body)
    });
    let count = ((instrument - from).norm() / 1e-3).ceil();
    let on_line = |body: &Body<'_>| {
        (0..=count as usize).any(|k| body.is_inside(&from.lerp(instrument, k as f64 / count)))
    };
    standing.chain(carried).filter(on_line).map(|body| body.name.to_string()).collect()
}

/// Returns the links that touch equipment, obstacles or the floor.
pub fn hits(cell: &Cell, layout: &Layout, q: &[f64]) -> Vec<String> {
    let frames = links(cell, q, None);
    let standing = cell.equipment.iter().zip(&layout.placements).flat_map(|(e, at)| {
        e.solids.iter().map(move |s| Body::new(&e.name, placed(at), &s.shape, cell.floor))
    });
    let keep_out = cell.keep_out.iter().map(|k| {
        let centre = Frame::new_translation(&((k.min + k.max) / 2.0));
        let shape = Shape::Box { pose: Pose::identity(), size: k.max - k.min };
        Body::new(&k.name, centre, &shape, cell.floor)
    });
    let standing: Vec<_> = standing.chain(keep_out).collect();
    let mut faults = Vec::new();
    for solid in &cell.robot.solids {
        let body = Body::new(&solid.solid.name, frames[solid.link], &solid.solid.shape, cell.floor);
        for other in &standing {
            let deep = body.cloud.iter().any(|p| other.is_inside(p))
                || other.cloud.iter().any(|p| body.is_inside(p));
            if deep {
                faults.push(format!("{} is in {}", body.name, other.name));
            }
        }
        if solid.link > 0 && body.cloud.iter().any(|p| p.z < cell.floor - DEEP) {
            faults.push(format!("{} is in the floor", body.name));
        }
    }
    faults
}
