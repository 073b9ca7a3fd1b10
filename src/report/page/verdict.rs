//! Verdict: the answer at the top of a report.

use super::content::plain;
use super::facts::facts;
use super::quantities::quantity;
use super::runner_up::runner_up;
use super::subject::Subject;
use crate::assess::Assessment;
use crate::cell::{Coordinate, Placement, Role, Unit};
use crate::files::shown;
use crate::record::{
    CellYieldEntry, PlacementEntry, REPORT_SCHEMA, RegionEntry, RequirementState, TurnEntry, VerdictAnswer,
    VerdictDocument, VerdictPlacement, VerdictSpot, VerdictSubject, nine_digits, value_word,
};
use crate::region::MovableBody;
use crate::units::{mm_from_m, rounded};

/// Returns the verdict of a report.
pub fn verdict(subject: &Subject<'_>) -> VerdictDocument {
    let (a, cell, found) = (subject.shown(), subject.cell(), subject.found.as_ref());
    let is_found = a.evaluation.objective.is_some() && (found.is_none() || subject.best.is_some());
    let missed = is_found && !a.meets_requirements();
    let limited = (0..a.maps.len()).any(|k| a.requirement(k).is_some());
    let all_unproven =
        || (0..a.maps.len()).filter_map(|k| a.requirement(k)).all(|r| r.is_met() || r.is_unproven());
    let requirement = match (limited, missed) {
        (false, _) => RequirementState::None,
        (true, true) if all_unproven() => RequirementState::NotGuaranteed,
        (true, true) => RequirementState::Missed,
        (true, false) => RequirementState::Met,
    };
    let mut verdict = VerdictDocument {
        schema: REPORT_SCHEMA.into(),
        of: if found.is_some() { VerdictSubject::Search } else { VerdictSubject::Layout },
        cell: cell.name.clone(),
        robot: cell.robot.name.clone(),
        answer: if is_found && !missed { VerdictAnswer::Yes } else { VerdictAnswer::No },
        headline: String::new(),
        feasible: is_found,
        ended: found.map(|f| f.ended),
        unit: cell.unit(),
        quantity: value_word(cell).into(),
        objective: cell.search.objective,
        objective_value: a.objective().filter(|_| is_found).map(nine_digits),
        start_value: subject.start.objective().map(nine_digits),
        gain_percent: found.and_then(|f| f.gain_percent),
        bound: found.and_then(|f| f.bound),
        gap_percent: found.and_then(|f| f.gap_percent),
        requirement,
        runner_up: runner_up(subject).filter(|_| is_found),
        facts: Vec::new(),
        cell_yield: CellYieldEntry::new(a).filter(|_| is_found),
        placements: if is_found { placements(a) } else { Vec::new() },
        operations: if is_found { (0..a.maps.len()).map(|k| spot(a, k)).collect() } else { Vec::new() },
        whole_cell: TurnEntry::new(a).filter(|_| is_found),
        reasons: reasons(subject, is_found),
    };
    verdict.facts = facts(&verdict, subject);
    verdict.headline = headline(&verdict, a);
    verdict
}

/// Returns the reasons why nothing can be recommended.
fn reasons(subject: &Subject<'_>, is_found: bool) -> Vec<String> {
    match (&subject.found, is_found) {
        (_, true) => Vec::new(),
        // The search states the reasons of the layout that is closest to feasible, not of the layout as
        // drawn.
        (Some(found), false) => found
            .reasons
            .iter()
            .map(|r| format!("in the examined layout that is closest to feasible: {}", plain(r)))
            .collect(),
        (None, false) => subject.start.reasons(),
    }
}

fn headline(v: &VerdictDocument, a: &Assessment<'_>) -> String {
    if v.objective_value.is_none() {
        return match v.of {
            VerdictSubject::Search => "No: the search has found no feasible layout".into(),
            VerdictSubject::Layout => "No: the layout as drawn is not feasible".into(),
        };
    }
    let answer = match v.requirement {
        RequirementState::Met => "Yes, every requirement is met: ",
        RequirementState::Missed => "No, a requirement is missed: ",
        RequirementState::NotGuaranteed => "No, a requirement is not guaranteed: ",
        RequirementState::None => "",
    };
    let layout = match v.of {
        VerdictSubject::Search => "the best layout found",
        VerdictSubject::Layout => "the layout as drawn",
    };
    let works = match &a.certificate {
        Some(certificate) if certificate.holds() => "works everywhere within the placement tolerances",
        Some(_) => "is not certified to work within the placement tolerances",
        None => "works if every piece stands exactly at its placement",
    };
    let errors = (0..a.maps.len()).filter_map(|k| {
        let value = quantity(a.cell.unit(), a.maps[k].value?);
        Some(format!("{} {value}", shown(&a.cell.operations[k].name)))
    });
    let errors: Vec<String> = errors.collect();
    let word = value_word(a.cell);
    capital(&format!("{answer}{layout} {works}; {word} of {}", errors.join(", ")))
}

/// Returns the placements of the equipment in the frame of the robot base, with the room (allowed
/// displacement) of each piece.
///
/// The robot base comes first if the search places it.
fn placements(a: &Assessment<'_>) -> Vec<VerdictPlacement> {
    let regions = RegionEntry::all(a);
    let entry = |equipment: &str, at: &Placement| {
        let region = regions.iter().find(|region| region.equipment == equipment);
        VerdictPlacement {
            equipment: equipment.to_string(),
            at: PlacementEntry::new(at),
            room_mm: region.and_then(|r| r.room_mm),
            room_deg: region.and_then(|r| r.room_deg),
            ends_with: region.map(|r| plain(&r.ends_with)),
        }
    };
    let base = a.cell.base.iter().any(Coordinate::is_free);
    let base = base.then(|| VerdictPlacement {
        equipment: format!("{} (world)", MovableBody::Base.name(a.cell)),
        ..entry(MovableBody::Base.name(a.cell), &a.layout.base)
    });
    let placed = a.cell.equipment.iter().zip(&a.layout.placements).filter(|(e, _)| e.role == Role::Equipment);
    base.into_iter().chain(placed.map(|(e, at)| entry(&e.name, &at.from_base(&a.layout.base)))).collect()
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

fn spot(a: &Assessment<'_>, k: usize) -> VerdictSpot {
    let (cell, map, unit) = (a.cell, &a.maps[k], a.cell.unit());
    let operation = &cell.operations[map.operation];
    let equipment = &cell.equipment[operation.equipment].name;
    let node = a.spot(k).map(|(node, _)| node);
    let requirement = a.requirement(k);
    VerdictSpot {
        name: operation.name.clone(),
        equipment: equipment.clone(),
        sense: operation.sense.name.clone(),
        node: node.map(|n| [n.i, n.j]),
        position_mm: node.map(|n| n.position.map(|v| nine_digits(mm_from_m(v))).into()),
        value: map.value.map(|v| nine_digits(unit.from_si(v))),
        limit: requirement.map(|r| nine_digits(unit.from_si(r.limit))),
        margin: requirement.map(|r| nine_digits(unit.from_si(r.margin))),
        worst: a.worst(k).map(|worst| nine_digits(unit.from_si(worst))),
        requirement: requirement.map_or(RequirementState::None, RequirementState::of),
        text: sentence(a, k),
    }
}

fn sentence(a: &Assessment<'_>, k: usize) -> String {
    let (map, unit) = (&a.maps[k], a.cell.unit());
    let operation = &a.cell.operations[map.operation];
    let on = shown(&a.cell.equipment[operation.equipment].name);
    let (Some((node, _)), Some(value)) = (a.spot(k), map.value) else {
        return format!("{} has no spot on {on}", shown(&operation.name));
    };
    let [x, y, z] = [0, 1, 2].map(|axis| format!("{:.1}", rounded(mm_from_m(node.position[axis]), 1)));
    let word = if unit == Unit::Cost { "of the tolerances that meet the limit" } else { value_word(a.cell) };
    let said = format!("{} {word} in {}", quantity(unit, value), shown(&operation.sense.name));
    let at = format!("node ({}, {}), tool at x {x}, y {y}, z {z} mm (world)", node.i, node.j);
    match operation.over.needs_every_node() {
        true => format!("at all nodes on {on}: {} {said}; the worst is {at}", operation.over.name()),
        false => format!("on {on} at {at}: {said}"),
    }
}
