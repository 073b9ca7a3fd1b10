//! Drawings of one or several layouts in the form that the 3-D viewer reads.

use super::viewer_records::{
    DrawingRecord, DrawingUnits, DrawingsRecord, EnvelopeRecord, EquipmentRecord, FieldRecord, LensRecord,
    MeshRecord, MovementRecord, OperationRecord, PartRecord, PoseNumbers, RectangleRecord, StopRecord,
    TakeRecord,
};
use crate::cell::{Cell, Equipment, JointKind, Rectangle, Role, Sense, Unit};
use crate::drawing::{
    Drawing, DrawnPart, ErrorView, Field, FieldNode, Mesh, Movement, MovementStop, PartCarrier, Rings,
    ViewedErrors,
};
use crate::geometry::simplified_line;
use crate::pose::Pose;
use crate::record::{
    JointEntry, SenseEntry, joints as joints_of_file, nine_digits as length, position_mm as lengths,
};
use crate::units::{deg_from_rad, mm_from_m, rounded};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::Vector3;
use serde_json::Value;
use std::collections::HashMap;

/// Least time between two animation frames that are sent to the viewer, s. The frame at a stop, the frame
/// after it and the last frame are always sent. The viewer interpolates between the frames.
const TICK: f64 = 0.099;
/// Tolerance of the simplified outlines of the envelope, m.
const STRAIGHT: f64 = 1e-3;

/// Returns the document of the viewer: the drawings in the given order. A mesh that several drawings share is
/// written once.
pub fn drawings(drawings: &[Drawing<'_>]) -> Value {
    let mut meshes = MeshList::default();
    let drawings = drawings.iter().map(|d| drawing(d, &mut meshes)).collect();
    let document = DrawingsRecord {
        schema: "sweetspot/drawing/1",
        units: DrawingUnits { length: Unit::Length, angle: Unit::Angle },
        meshes: meshes.written,
        drawings,
    };
    // Serialization of plain numbers and texts cannot fail.
    serde_json::to_value(&document).unwrap_or_default()
}

/// List of meshes without duplicates.
#[derive(Default)]
struct MeshList {
    places: HashMap<MeshRecord, usize>,
    written: Vec<MeshRecord>,
}

impl MeshList {
    /// Returns the index of a mesh; adds the mesh if it is new.
    fn index(&mut self, mesh: &Mesh) -> usize {
        let record = MeshRecord {
            positions: floats(mesh.positions.iter().flat_map(millimetres)),
            normals: floats(mesh.normals.iter().flat_map(|n| [n.x, n.y, n.z])),
            indices: base64(mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes())),
        };
        let next = self.written.len();
        let index = *self.places.entry(record.clone()).or_insert(next);
        if index == next {
            self.written.push(record);
        }
        index
    }
}

fn drawing<'a>(d: &'a Drawing<'_>, meshes: &mut MeshList) -> DrawingRecord<'a> {
    let cell = d.cell;
    let (low, high) = d.extent();
    let unit = |kind: JointKind| if kind == JointKind::Revolute { Unit::Angle } else { Unit::Length };
    let joints = cell.robot.joints.iter();
    let parts = d.parts.iter().map(|p| part(p, meshes)).collect();
    let equipment = cell.equipment.iter().enumerate().map(|(k, e)| self::equipment(e, pose_of(d, k)));
    DrawingRecord {
        name: &d.name,
        cell: &cell.name,
        robot: &cell.robot.name,
        base: pose(&d.base),
        floor_mm: length(mm_from_m(d.floor)),
        extent_mm: [lengths(&low), lengths(&high)],
        joints: joints.map(|j| JointEntry { name: j.name.clone(), unit: unit(j.kind) }).collect(),
        equipment: equipment.collect(),
        operations: operations(cell),
        parts,
        lenses: d.lenses.iter().map(lens).collect(),
        fields: d.fields.iter().map(|f| field(f, cell)).collect(),
        envelopes: d.envelopes.iter().map(envelope).collect(),
        movement: movement(&d.movement, cell),
    }
}

/// Returns the pose of a piece of equipment, taken from its solids; None if the equipment has no solid.
fn pose_of(d: &Drawing<'_>, equipment: usize) -> Option<Pose> {
    let own = d.parts.iter().filter(|p| p.equipment == Some(equipment));
    own.map(|p| d.pose_of(p, d.movement.home())).next()
}

fn equipment(e: &Equipment, at: Option<Pose>) -> EquipmentRecord<'_> {
    EquipmentRecord {
        name: &e.name,
        obstacle: e.role == Role::Obstacle,
        on: e.on,
        at: at.map(|at| pose(&at)),
        surface: e.surface.as_ref().map(rectangle),
        footprint: rectangle(&e.footprint),
    }
}

fn rectangle(r: &Rectangle) -> RectangleRecord {
    let mm = |(x, y): (f64, f64)| [x, y].map(|v| length(mm_from_m(v)));
    RectangleRecord { centre_mm: mm(r.centre), size_mm: mm(r.size) }
}

fn operations(cell: &Cell) -> Vec<OperationRecord<'_>> {
    let record = cell.operations.iter().map(|o| OperationRecord {
        name: &o.name,
        equipment: o.equipment,
        sense: &o.sense.name,
        standoff_mm: length(mm_from_m(o.standoff)),
        limit: o.limit.map(|limit| length(o.sense.unit.from_si(limit))),
    });
    record.collect()
}

fn part<'a>(part: &'a DrawnPart, meshes: &mut MeshList) -> PartRecord<'a> {
    let (link, at) = match part.carrier {
        PartCarrier::Link(k) => (Some(k), None),
        PartCarrier::World(at) => (None, Some(pose(&at))),
    };
    PartRecord {
        name: &part.name,
        owner: &part.owner,
        kind: part.kind.name(),
        link,
        at,
        equipment: part.equipment,
        operation: part.operation,
        mesh: meshes.index(&part.mesh),
    }
}

fn lens(lens: &ErrorView) -> LensRecord {
    LensRecord { model: lens.model, reading: lens.reading_word(), signed: lens.is_signed() }
}

fn field<'a>(f: &'a Field, cell: &Cell) -> FieldRecord<'a> {
    FieldRecord {
        operation: f.operation,
        equipment: cell.operations[f.operation].equipment,
        senses: f.senses.iter().map(SenseEntry::new).collect(),
        sense: f.sense,
        size: [f.size.0, f.size.1],
        every: f.every,
        nodes: f.nodes.iter().map(|n| [n.i, n.j]).collect(),
        positions: floats(f.nodes.iter().flat_map(|n| millimetres(&n.position))),
        status: f.nodes.iter().map(|n| n.sign).collect(),
        reason: f.nodes.iter().map(|n| n.reason.as_str()).collect(),
        joints: f.nodes.iter().map(|n| joints(n, cell)).collect(),
        best: f.best,
        spot_mm: f.spot.as_ref().map(lengths),
        refined_mm: f.refined.as_ref().map(lengths),
        takes: f.takes.iter().map(|t| take(t, &f.senses)).collect(),
    }
}

fn joints(node: &FieldNode, cell: &Cell) -> Option<Vec<f64>> {
    let all = node.joints.as_ref().map(|q| joints_of_file(cell, q));
    all.map(|all| all.into_iter().map(|q| rounded(q, 2)).collect())
}

fn take(take: &ViewedErrors, senses: &[Sense]) -> TakeRecord {
    let none = Vector3::repeat(f64::NAN);
    let values =
        take.values.iter().zip(senses).map(|(values, sense)| {
            floats(values.iter().map(|v| v.map_or(f64::NAN, |v| sense.unit.from_si(v))))
        });
    TakeRecord {
        lens: take.lens,
        error: floats(take.error.iter().flat_map(|e| millimetres(e.as_ref().unwrap_or(&none)))),
        values: values.collect(),
        best: take.best,
    }
}

fn envelope(rings: &Rings) -> EnvelopeRecord {
    let ring = |ring: &Vec<Vector3<f64>>| floats(thinned(ring).iter().flat_map(|p| millimetres(p)));
    EnvelopeRecord {
        at_work: rings.at_work.iter().map(ring).collect(),
        around: rings.around.iter().map(ring).collect(),
    }
}

/// Simplifies a closed line. No removed point is farther than [`STRAIGHT`] from the simplified line.
fn thinned(ring: &[Vector3<f64>]) -> Vec<&Vector3<f64>> {
    // The last point is joined to the first.
    let closed: Vec<Vector3<f64>> = ring.iter().chain(ring.first()).copied().collect();
    let kept = simplified_line(&closed, STRAIGHT);
    kept.into_iter().filter_map(|k| ring.get(k)).collect()
}

fn movement<'a>(m: &Movement, cell: &'a Cell) -> MovementRecord<'a> {
    let kept = kept(m);
    let coordinate = |kind: JointKind, q: f64| match kind {
        JointKind::Revolute => rounded(deg_from_rad(q), 2),
        JointKind::Prismatic => rounded(mm_from_m(q), 2),
    };
    let stop = |s: &MovementStop| StopRecord {
        operation: s.operation,
        name: s.operation.map_or("home", |k| &cell.operations[k].name),
        joints: cell.robot.joints.iter().zip(&s.joints).map(|(j, q)| coordinate(j.kind, *q)).collect(),
        time_s: rounded(s.time, 6),
    };
    MovementRecord {
        checked: m.is_checked,
        stops: m.stops.iter().map(stop).collect(),
        times_s: kept.iter().map(|&k| rounded(m.times[k], 6)).collect(),
        holding: kept.iter().map(|&k| m.holding[k]).collect(),
        links: m.home().len(),
        frames: floats(kept.iter().flat_map(|&k| m.frames[k].iter().flat_map(twelve))),
    }
}

/// Returns the indices of the animation frames that are sent to the viewer. A frame is sent if it is at a
/// stop, follows a stop, or is the last frame. A frame is also sent if it is more than [`TICK`] later than
/// the last sent frame.
fn kept(m: &Movement) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    for (k, t) in m.times.iter().enumerate() {
        let is_stop = m.stops.iter().any(|s| s.time == *t) || k + 1 == m.times.len();
        let far = kept.last().is_none_or(|&last| t - m.times[last] > TICK);
        // The robot rests at a stop until the next frame, so that frame is sent, too.
        let rests = k > 0 && m.stops.iter().any(|s| s.time == m.times[k - 1]);
        if is_stop || far || rests {
            kept.push(k);
        }
    }
    kept
}

fn twelve(at: &Pose) -> [f64; 12] {
    let mut numbers = [0.0; 12];
    // The rotation matrix is written column by column.
    numbers[..9].copy_from_slice(at.rotation.as_slice());
    numbers[9..].copy_from_slice(&millimetres(&at.translation));
    numbers
}

fn pose(at: &Pose) -> PoseNumbers {
    twelve(at).map(|v| rounded(v, 9))
}

fn millimetres(p: &Vector3<f64>) -> [f64; 3] {
    [p.x, p.y, p.z].map(mm_from_m)
}

fn floats(values: impl Iterator<Item = f64>) -> String {
    base64(values.flat_map(|v| (v as f32).to_le_bytes()))
}

fn base64(bytes: impl Iterator<Item = u8>) -> String {
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}
