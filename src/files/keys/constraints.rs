//! `[margins]`, `[transfer]` and `[fence]`.

use crate::cell::*;
use crate::files::fault::shown;
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::{Must, plain};
use crate::units;
use nalgebra::Vector2;

/// Least area of a fence, m2, and least distance of two of its corners, m: less is a slip of units.
const LEAST: (f64, f64) = (1e-4, 1e-6);

const CORNERS: &str =
    "write for example polygon_mm = [[-2000, -1500], [2000, -1500], [2000, 2500], [-2000, 2500]]";

pub fn read_margins(node: Option<&Node>, robot: Option<&Robot>, lib: &mut Library<'_>) -> Option<Margins> {
    let Some(node) = node else { return Some(Margins::default()) };
    Table::read(node, "`margins`", lib, |t, lib| {
        let turn = t.number_or("joint_deg", 0.0, Must::NotBeNegative, lib).map(units::rad_from_deg);
        let slide = t.number_or("joint_mm", 0.0, Must::NotBeNegative, lib).map(units::m_from_mm);
        let singularity = t.number_or("singularity", 0.0, Must::NotBeNegative, lib);
        let margins = Margins { turn: turn?, slide: slide?, singularity: singularity? };
        for (key, kind) in [("joint_deg", JointKind::Revolute), ("joint_mm", JointKind::Prismatic)] {
            let moving = robot.iter().flat_map(|r| &r.joints).filter(|j| j.kind == kind && !j.is_passive());
            let narrow = |j: &&Joint| {
                let (low, high) = margins.kept(j);
                low >= high
            };
            if let Some((joint, at)) = moving.into_iter().find(narrow).zip(t.get(key)) {
                let half = in_file(kind, (joint.limits.1 - joint.limits.0) / 2.0);
                let message = format!("`{key}` leaves no travel to joint `{}`", shown(&joint.name));
                lib.error(at.at, message, format!("write less than {}, half its travel", plain(half)));
            }
        }
        if margins.singularity >= 1.0 {
            let at = t.get("singularity").map_or(node.at, |n| n.at);
            let help = "write a small share of one, for example singularity = 0.02";
            lib.error(at, "`singularity` of 1 or more leaves no posture".into(), help);
        }
        Some(margins)
    })
}

/// A coordinate in the unit of files, rounded for print.
fn in_file(kind: JointKind, q: f64) -> f64 {
    units::rounded(if kind == JointKind::Revolute { units::deg_from_rad(q) } else { units::mm_from_m(q) }, 6)
}

/// None within: transfers are not checked.
pub fn read_transfer(
    node: Option<&Node>,
    robot: Option<&Robot>,
    margins: Option<Margins>,
    lib: &mut Library<'_>,
) -> Option<Option<TransferRules>> {
    let Some(node) = node else { return Some(None) };
    Table::read(node, "`transfer`", lib, |t, lib| {
        let check = t.boolean_or("check", true, lib);
        let lift = t.number_or("lift_mm", 0.0, Must::NotBeNegative, lib).map(units::m_from_mm);
        let cycle = t.boolean_or("cycle", false, lib);
        let given = t.get("via");
        let (robot, margins) = (robot?, margins?);
        let via = match given {
            Some(node) => read_via(node, robot, &margins, lib),
            None => Some(vec![robot.home]),
        };
        let rules = TransferRules { lift: lift?, via: via?, cycle: cycle? };
        Some(check?.then_some(rules))
    })
}

/// One posture, or a list of them.
fn read_via(
    node: &Node,
    robot: &Robot,
    margins: &Margins,
    lib: &mut Library<'_>,
) -> Option<Vec<JointVector>> {
    let one = std::slice::from_ref(node);
    let postures = match &node.value {
        Value::Array(items) if items.iter().all(|i| matches!(i.value, Value::Array(_))) => items,
        _ => one,
    };
    let read: Vec<_> = postures.iter().map(|node| read_posture(node, robot, margins, lib)).collect();
    read.into_iter().collect()
}

fn read_posture(node: &Node, robot: &Robot, margins: &Margins, lib: &mut Library<'_>) -> Option<JointVector> {
    let given = value::numbers(node, "a posture of `via`", robot.axes(), Must::BeFinite, lib)?;
    let mut posture = [0.0; MAX_JOINTS];
    for (i, (joint, &q)) in robot.joints.iter().zip(&given).enumerate() {
        let turns = joint.kind == JointKind::Revolute;
        posture[i] = if turns { units::rad_from_deg(q) } else { units::m_from_mm(q) };
        let (low, high) = margins.kept(joint);
        if !(low..=high).contains(&posture[i]) {
            let (low, high) = (plain(in_file(joint.kind, low)), plain(in_file(joint.kind, high)));
            let less = if margins.of(joint) > 0.0 { ", less the margin" } else { "" };
            let message = format!(
                "number {} of `via` is outside the limits of joint `{}`{less}",
                i + 1,
                shown(&joint.name)
            );
            let at = if let Value::Array(items) = &node.value { items[i].at } else { node.at };
            lib.error(at, message, format!("choose it from {low} to {high}, not {}", plain(q)));
        }
    }
    Some(posture)
}

/// None within: there is no fence.
pub fn read_fence(node: Option<&Node>, lib: &mut Library<'_>) -> Option<Option<Fence>> {
    let Some(node) = node else { return Some(None) };
    Table::read(node, "`fence`", lib, |t, lib| {
        let height = match t.get("height_mm") {
            Some(node) => {
                let height = value::number(node, "`height_mm`", Must::BePositive, lib);
                height.map(|mm| Some(units::m_from_mm(mm)))
            }
            None => Some(None),
        };
        let corners = read_corners(t.need("polygon_mm", CORNERS)?, lib);
        Some(Some(Fence { corners: corners?, height: height? }))
    })
}

fn read_corners(node: &Node, lib: &mut Library<'_>) -> Option<Vec<(f64, f64)>> {
    let items = match &node.value {
        Value::Array(items) if items.len() >= 3 => items,
        other => {
            let given = match other {
                Value::Array(items) => items.len().to_string(),
                other => other.kind().to_string(),
            };
            lib.error(
                node.at,
                format!("`polygon_mm` must be a list of 3 or more corners, not {given}"),
                CORNERS,
            );
            return None;
        }
    };
    let read = |(i, item)| {
        let corner =
            value::numbers(item, &format!("corner {} of `polygon_mm`", i + 1), 2, Must::BeFinite, lib);
        corner.map(|c| Vector2::from_iterator(c).map(units::m_from_mm))
    };
    let corners: Vec<_> = items.iter().enumerate().map(read).collect();
    let corners: Vec<Vector2<f64>> = corners.into_iter().collect::<Option<_>>()?;
    let n = corners.len();
    let edge = |k: usize| (corners[k], corners[(k + 1) % n]);
    if let Some(k) = (0..n).find(|&k| (edge(k).1 - edge(k).0).norm() < LEAST.1) {
        let message = format!("corners {} and {} of `polygon_mm` are one", k + 1, (k + 1) % n + 1);
        lib.error(items[(k + 1) % n].at, message, "remove one of the two: the fence closes by itself");
        return None;
    }
    let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    if let Some((i, j)) =
        pairs.into_iter().find(|&(i, j)| cross(edge(i), edge(j), j == i + 1, j + 1 == n && i == 0))
    {
        let message = format!("the fence crosses itself: its edges {} and {}", i + 1, j + 1);
        lib.error(items[j].at, message, "list the corners in the order in which you walk along the fence");
        return None;
    }
    let area: f64 = (0..n).map(|k| edge(k).0.perp(&edge(k).1) / 2.0).sum();
    if area.abs() < LEAST.0 {
        lib.error(node.at, "the fence holds nearly no floor".into(), "is the unit right? lengths are in mm");
    }
    let mut corners: Vec<_> = corners.iter().map(|c| (c.x, c.y)).collect();
    if area < 0.0 {
        corners.reverse();
    }
    Some(corners)
}

/// Whether two edges share a point, their common corner aside; `follows`: the second begins where the
/// first ends, `leads`: it ends where the first begins.
fn cross(a: Edge, b: Edge, follows: bool, leads: bool) -> bool {
    let (u, v) = (a.1 - a.0, b.1 - b.0);
    if follows || leads {
        // Neighbours meet again only if one runs back over the other.
        let back = if follows { u.dot(&v) } else { v.dot(&u) };
        let flat = u.perp(&v).abs() <= 1e-12 * u.norm() * v.norm();
        return flat && back < 0.0;
    }
    let side = |e: Edge, p: Vector2<f64>| (e.1 - e.0).perp(&(p - e.0));
    let between = |e: Edge, p: Vector2<f64>| side(e, p) == 0.0 && (p - e.0).dot(&(p - e.1)) <= 0.0;
    let apart = |e: Edge, f: Edge| side(e, f.0) * side(e, f.1) >= 0.0;
    let proper = !apart(a, b) && !apart(b, a);
    proper || between(a, b.0) || between(a, b.1) || between(b, a.0) || between(b, a.1)
}

type Edge = (Vector2<f64>, Vector2<f64>);
