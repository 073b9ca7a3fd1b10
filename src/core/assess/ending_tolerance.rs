//! Placement tolerances that make a layout infeasible: without these tolerances, or with smaller tolerances,
//! the layout would be feasible.

use crate::cell::{Cell, Layout, Slot};
use crate::layout::{Workcell, evaluate};
use crate::motion::DEVIATION;
use crate::safe_text::shown;
use crate::units::{deg_from_rad, mm_from_m, rounded};

/// Number of bisection steps for the largest tolerance with which a layout is feasible.
const BISECTIONS: usize = 8;
/// Names of the keys of a placement tolerance in a cell file.
const KEYS: [&str; 4] = ["x_mm", "y_mm", "z_mm", "yaw_deg"];

/// Returns, in words, which placement tolerances make a layout infeasible. Each text states smaller values
/// with which the layout would be feasible.
///
/// Each tolerance is reduced alone. If no single tolerance suffices, all tolerances of each body (robot base
/// or piece of equipment) are reduced together. If no single body suffices, the tolerances of all bodies are
/// reduced together. The list is empty if the layout is infeasible even without misplacements.
pub fn ending_tolerances(workcell: &Workcell, layout: &Layout) -> Vec<String> {
    if !workcell.certifies() || evaluate(workcell, layout).is_accepted() {
        return Vec::new();
    }
    let cell = &workcell.cell;
    let bodies: Vec<Vec<Slot>> =
        cell.placement_tolerances().iter().map(|body| body.iter().map(|(slot, _)| *slot).collect()).collect();
    let alone = bodies.concat().into_iter().map(|slot| vec![slot]);
    let alone: Vec<String> = alone.filter_map(|slots| reduced(cell, layout, &slots)).collect();
    if !alone.is_empty() {
        return alone;
    }
    let together: Vec<String> = bodies.iter().filter_map(|slots| reduced(cell, layout, slots)).collect();
    if !together.is_empty() {
        return together;
    }
    reduced(cell, layout, &bodies.concat()).into_iter().collect()
}

/// Describes the largest values of the tolerances `slots` with which the layout is feasible.
///
/// Returns None if the layout is infeasible even without these tolerances.
fn reduced(cell: &Cell, layout: &Layout, slots: &[Slot]) -> Option<String> {
    let holds = |share: f64| {
        let mut less = cell.clone();
        slots.iter().for_each(|slot| *tolerance(&mut less, *slot) *= share);
        Workcell::new(less).is_ok_and(|workcell| evaluate(&workcell, layout).is_accepted())
    };
    if !holds(0.0) {
        return None;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = (low + high) / 2.0;
        match holds(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    if low == 0.0 {
        let keys = slots.iter().map(|slot| format!("{} of {}", KEYS[axis(*slot)], owner(cell, *slot)));
        return Some(format!(
            "even very small placement tolerances make the layout infeasible: {}. With a tolerance above 0, a certified \
             path must keep {} mm more than the clearance, so a larger standoff or a smaller clearance may help",
            keys.collect::<Vec<_>>().join(", "),
            rounded(mm_from_m(2.0 * DEVIATION), 3)
        ));
    }
    let named = |slot: &Slot| {
        let value = *tolerance(&mut cell.clone(), *slot);
        let in_file = |si: f64| rounded(if slot.is_angle() { deg_from_rad(si) } else { mm_from_m(si) }, 3);
        let key = KEYS[axis(*slot)];
        format!(
            "{key} of {} at most {} instead of {}",
            owner(cell, *slot),
            in_file(low * value),
            in_file(value)
        )
    };
    let names: Vec<String> = slots.iter().map(named).collect();
    Some(format!("the layout would be feasible with smaller placement tolerances: {}", names.join(", ")))
}

/// Returns the half width of a tolerance. The slot must be one of [`Cell::placement_tolerances`].
fn tolerance(cell: &mut Cell, slot: Slot) -> &mut f64 {
    match slot {
        Slot::Equipment(k, axis) => &mut cell.equipment[k].tolerance.0[axis],
        Slot::Base(axis) | Slot::Attitude(_, axis) => &mut cell.base_tolerance.0[axis],
    }
}

fn axis(slot: Slot) -> usize {
    match slot {
        Slot::Base(axis) | Slot::Equipment(_, axis) | Slot::Attitude(_, axis) => axis,
    }
}

fn owner(cell: &Cell, slot: Slot) -> String {
    match slot {
        Slot::Equipment(k, _) => shown(&cell.equipment[k].name),
        _ => "the robot base".into(),
    }
}
