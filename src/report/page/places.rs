//! Placements for setting out the cell with a tape measure, and the joint coordinates at each spot.

use super::content::{NOTHING, PageTable, Section};
use super::subject::Subject;
use crate::assess::Assessment;
use crate::cell::{Equipment, Joint, JointKind, Placement, Rectangle, Role};
use crate::drawing::floor_corners;
use crate::files::shown;
use crate::record::{NEAR_LIMIT, near_limits};
use crate::units::{deg_from_rad, mm_from_m, percent_from_share, rounded};

/// Returns the section on placements.
pub fn section(subject: &Subject<'_>) -> Section {
    let mut section = empty();
    section.tables = subject.tables(|a| vec![frames(a), outlines(a)]);
    section
}

/// Returns the section on the placements of compared layouts. The page hides the rows of the tables until the
/// reader opens them.
pub fn of_columns(columns: &[Assessment<'_>]) -> Section {
    let mut section = empty();
    section.tables = columns.iter().flat_map(|a| [frames(a).folded(), outlines(a).folded()]).collect();
    section
}

fn empty() -> Section {
    let text = vec![
        "The corners of floor outline and work surface are listed counterclockwise, beginning with the least x and \
         y in the axes of the equipment. Coordinates x and y are in the world frame. Coordinates from base are in the \
         frame of the robot base. Tape is the horizontal distance from the base axis to the corner."
            .to_string(),
    ];
    Section::new("placements", "Placements", text)
}

/// Returns the section on the joint coordinates at home and at the spots.
pub fn joints(subject: &Subject<'_>) -> Section {
    let text = vec![format!(
        "Joint coordinates are in the convention of the robot file. A joint is near its limit if less than {:.0} % of its \
         travel is left.",
        percent_from_share(NEAR_LIMIT)
    )];
    let mut section = Section::new("joints", "Joints at the spots", text);
    section.tables = subject.tables(|a| vec![joint_table(a)]);
    section
}

pub fn mm(m: f64) -> String {
    format!("{:.1}", rounded(mm_from_m(m), 1))
}

pub fn deg(rad: f64) -> String {
    format!("{:.3}", rounded(deg_from_rad(rad), 3))
}

/// Returns the title of a table with the name of its layout.
pub fn titled(a: &Assessment<'_>, what: &str) -> String {
    match a.label.as_str() {
        "best" => format!("Best layout: {what}"),
        "start" => format!("Layout as drawn: {what}"),
        label => format!("{}: {what}", shown(label)),
    }
}

fn frames(a: &Assessment<'_>) -> PageTable {
    let row = |name: String, at: &Placement, floor: f64| {
        let own = at.seen_from(&a.layout.base);
        let yaw = |yaw: f64| deg(crate::units::wrapped(yaw));
        vec![
            name,
            mm(at.x),
            mm(at.y),
            yaw(at.yaw),
            mm(at.z - floor),
            mm(own.x),
            mm(own.y),
            mm(own.z),
            yaw(own.yaw),
        ]
    };
    let floor = a.cell.floor;
    let base = row("robot base".into(), &a.layout.base, floor);
    let placed = a.cell.equipment.iter().zip(&a.layout.placements);
    let others = placed.map(|(e, at)| row(named(e), at, floor));
    PageTable::new(
        titled(a, "origins"),
        &[
            "what",
            "x mm",
            "y mm",
            "yaw deg",
            "height above floor mm",
            "x from base mm",
            "y from base mm",
            "z from base mm",
            "yaw from base deg",
        ],
        std::iter::once(base).chain(others).collect(),
    )
    .with_note(
        "The origin of equipment with a work surface lies in that surface, so its height is the height of the table top.",
    )
}

fn named(equipment: &Equipment) -> String {
    match equipment.role {
        Role::Equipment => shown(&equipment.name),
        Role::Obstacle => format!("{} (obstacle)", shown(&equipment.name)),
    }
}

fn outlines(a: &Assessment<'_>) -> PageTable {
    let mut rows = Vec::new();
    for (equipment, at) in a.cell.equipment.iter().zip(&a.layout.placements) {
        rows.extend(corner_rows(a, &shown(&equipment.name), "floor outline", &equipment.footprint, at));
        if let Some(surface) = equipment.surface.filter(|s| differ(s, &equipment.footprint)) {
            rows.extend(corner_rows(a, &shown(&equipment.name), "work surface", &surface, at));
        }
    }
    rows.extend(corner_rows(a, "robot", "floor outline", &a.cell.robot.footprint, &a.layout.base));
    PageTable::new(
        titled(a, "corners"),
        &["what", "outline", "corner", "x mm", "y mm", "x from base mm", "y from base mm", "tape mm"],
        rows,
    )
}

/// Returns whether two outlines differ after rounding to 0.1 mm.
fn differ(a: &Rectangle, b: &Rectangle) -> bool {
    let numbers = |r: &Rectangle| [r.centre.0, r.centre.1, r.size.0, r.size.1];
    numbers(a).iter().zip(numbers(b)).any(|(a, b)| mm(*a) != mm(b))
}

fn corner_rows(
    a: &Assessment<'_>,
    name: &str,
    outline: &str,
    r: &Rectangle,
    at: &Placement,
) -> Vec<Vec<String>> {
    let row = |(k, (x, y)): (usize, (f64, f64))| {
        let own = Placement { x, y, z: 0.0, yaw: 0.0 }.seen_from(&a.layout.base);
        let first = |text: &str| if k == 0 { text.to_string() } else { String::new() };
        vec![
            first(name),
            first(outline),
            (k + 1).to_string(),
            mm(x),
            mm(y),
            mm(own.x),
            mm(own.y),
            mm(own.x.hypot(own.y)),
        ]
    };
    floor_corners(r, at).into_iter().enumerate().map(row).collect()
}

fn joint_table(a: &Assessment<'_>) -> PageTable {
    let mut head = vec!["joint".to_string(), "unit".into(), "home".into()];
    head.extend(a.cell.operations.iter().map(|o| shown(&o.name)));
    head.extend(["lower limit".to_string(), "upper limit".into()]);
    let row = |(k, joint): (usize, &Joint)| {
        let told = |value: f64| match joint.kind {
            JointKind::Revolute => deg(value),
            JointKind::Prismatic => format!("{:.3}", rounded(mm_from_m(value), 3)),
        };
        let unit = if joint.kind == JointKind::Revolute { "deg" } else { "mm" };
        let mut row = vec![shown(&joint.name), unit.into(), told(a.cell.robot.home[k])];
        let at_spot = |o: usize| {
            a.spot(o).map_or(NOTHING.into(), |(_, p)| match near_limits(a.cell, &p.joints)[k] {
                true => format!("{} (near its limit)", told(p.joints[k])),
                false => told(p.joints[k]),
            })
        };
        row.extend((0..a.maps.len()).map(at_spot));
        row.extend([told(joint.limits.0), told(joint.limits.1)]);
        row
    };
    let rows = a.cell.robot.joints.iter().enumerate().map(row).collect();
    let words: Vec<&str> = head.iter().map(String::as_str).collect();
    PageTable::new(titled(a, "joints"), &words, rows)
}
