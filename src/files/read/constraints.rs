//! Readers of `[margins]`, `[transfer]` and `[fence]`.

use crate::cell::*;
use crate::files::fault::shown;
use crate::files::keys::cell::cell;
use crate::files::keys::constraints::{fence, margins, transfer};
use crate::files::keys::key::NumberRange;
use crate::files::polygon::crossing_edges;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::Node;
use crate::files::toml::value;
use crate::files::toml::value::plain;
use crate::units;
use nalgebra::Vector2;

/// Least area of a fence, m2. A smaller area is probably in the wrong unit.
const MIN_AREA: f64 = 1e-4;

/// Least distance between two consecutive corners of a fence, m.
const MIN_EDGE: f64 = 1e-6;

/// Reads `[margins]`. If `robot` could be read, checks that the margins leave travel for every joint with an
/// actuator.
pub fn read_margins(t: &mut Table, robot: Option<&Robot>) -> Option<Margins> {
    t.table_or(&cell::MARGINS, Margins::default(), |t| {
        let (turn, slide) = (t.number(&margins::TURN), t.number(&margins::SLIDE));
        let singularity = t.number(&margins::SINGULARITY);
        let read = Margins { turn: turn?, slide: slide?, singularity: singularity? };
        for (key, kind) in [(margins::TURN, JointKind::Revolute), (margins::SLIDE, JointKind::Prismatic)] {
            let moving = robot.iter().flat_map(|r| &r.joints).filter(|j| j.kind == kind && !j.is_passive());
            let narrow = |j: &&Joint| {
                let (low, high) = read.kept(j);
                low >= high
            };
            if let Some((joint, node)) = moving.into_iter().find(narrow).zip(t.get(&key)) {
                let half = in_file(kind, (joint.limits.1 - joint.limits.0) / 2.0);
                let message = format!("`{}` leaves joint `{}` no travel", key.name, shown(&joint.name));
                t.error(
                    node.at,
                    message,
                    format!("write less than {}, half the travel of the joint", plain(half)),
                );
            }
        }
        Some(read)
    })
}

/// Returns a coordinate in the unit of files, rounded for display.
fn in_file(kind: JointKind, q: f64) -> f64 {
    units::rounded(if kind == JointKind::Revolute { units::deg_from_rad(q) } else { units::mm_from_m(q) }, 6)
}

/// Reads `[transfer]`; returns Some(None) if transfers are not checked.
pub fn read_transfer(
    t: &mut Table,
    robot: Option<&Robot>,
    margins: Option<Margins>,
) -> Option<Option<TransferRules>> {
    t.table_or(&cell::TRANSFER, None, |t| {
        let (check, lift) = (t.boolean(&transfer::CHECK), t.number(&transfer::LIFT));
        let cycle = t.boolean(&transfer::CYCLE);
        let given = t.get(&transfer::VIA);
        let (robot, margins) = (robot?, margins?);
        let via = match given {
            Some(node) => read_via(node, robot, &margins, t),
            None => Some(vec![robot.home]),
        };
        let rules = TransferRules { lift: lift?, via: via?, cycle: cycle? };
        Some(check?.then_some(rules))
    })
}

/// Reads `via`: one posture, or a list of postures.
fn read_via(node: &Node, robot: &Robot, margins: &Margins, t: &mut Table) -> Option<Vec<JointVector>> {
    let lists = node.value.items().filter(|items| items.iter().all(|item| item.value.items().is_some()));
    let postures = lists.unwrap_or(std::slice::from_ref(node));
    let read: Vec<_> = postures.iter().map(|node| read_posture(node, robot, margins, t)).collect();
    read.into_iter().collect()
}

fn read_posture(node: &Node, robot: &Robot, margins: &Margins, t: &mut Table) -> Option<JointVector> {
    let given = value::numbers(node, "a posture of `via`", robot.axes(), NumberRange::Finite, t.lib)?;
    let mut posture = [0.0; MAX_JOINTS];
    for (i, (joint, &q)) in robot.joints.iter().zip(&given).enumerate() {
        let turns = joint.kind == JointKind::Revolute;
        posture[i] = if turns { units::rad_from_deg(q) } else { units::m_from_mm(q) };
        let (low, high) = margins.kept(joint);
        if !(low..=high).contains(&posture[i]) {
            let (low, high) = (plain(in_file(joint.kind, low)), plain(in_file(joint.kind, high)));
            let less = if margins.of(joint) > 0.0 { ", reduced by the margin" } else { "" };
            let message = format!(
                "entry {} of `via` is outside the limits of joint `{}`{less}",
                i + 1,
                shown(&joint.name)
            );
            let at = node.value.items().map_or(node.at, |items| items[i].at);
            t.error(at, message, format!("write a value from {low} to {high}, not {}", plain(q)));
        }
    }
    Some(posture)
}

/// Reads `[fence]`; returns Some(None) if there is no fence.
pub fn read_fence(t: &mut Table) -> Option<Option<Fence>> {
    t.table_or(&cell::FENCE, None, |t| {
        let height = t.if_given(&fence::HEIGHT, Table::number);
        let corners = read_corners(t.get(&fence::POLYGON)?, t);
        Some(Some(Fence { corners: corners?, height: height? }))
    })
}

/// Reads the corners of a polygon that does not cross itself; returns them counterclockwise, m.
fn read_corners(node: &Node, t: &mut Table) -> Option<Vec<(f64, f64)>> {
    let items = value::items(node, &fence::POLYGON, t.lib)?;
    let read = |(i, item)| {
        let what = format!("corner {} of `polygon_mm`", i + 1);
        let corner = value::numbers(item, &what, 2, NumberRange::Finite, t.lib);
        corner.map(|c| Vector2::from_iterator(c).map(units::m_from_mm))
    };
    let corners: Vec<_> = items.iter().enumerate().map(read).collect();
    let corners: Vec<Vector2<f64>> = corners.into_iter().collect::<Option<_>>()?;
    let n = corners.len();
    let edge = |k: usize| (corners[k], corners[(k + 1) % n]);
    if let Some(k) = (0..n).find(|&k| (edge(k).1 - edge(k).0).norm() < MIN_EDGE) {
        let message = format!("corners {} and {} of `polygon_mm` are the same point", k + 1, (k + 1) % n + 1);
        t.error(
            items[(k + 1) % n].at,
            message,
            "remove one of the two corners; the fence closes without a repeated first corner",
        );
        return None;
    }
    if let Some((i, j)) = crossing_edges(&corners) {
        let message = format!("edges {} and {} of the fence cross, touch or overlap", i + 1, j + 1);
        t.error(items[j].at, message, "list the corners in their order along the fence");
        return None;
    }
    let area: f64 = (0..n).map(|k| edge(k).0.perp(&edge(k).1) / 2.0).sum();
    if area.abs() < MIN_AREA {
        t.error(node.at, "the fence encloses almost no area", "is the unit right? lengths are in mm");
    }
    let mut corners: Vec<_> = corners.iter().map(|c| (c.x, c.y)).collect();
    if area < 0.0 {
        corners.reverse();
    }
    Some(corners)
}
