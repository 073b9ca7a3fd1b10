//! Coordinates of a layout under the names that the page uses: `equipment.NAME.x_mm`, `robot_base.yaw_deg`,
//! `attitude.OPERATION.bend_deg`.

use super::requests;
use crate::cell::{Cell, Coordinate, Layout, Role, Slot};
use crate::files::shown;
use crate::record::coordinate_name;
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg, rounded};
use serde_json::{Map, Value};

/// Largest magnitude that the page may give to a coordinate that the file fixes, m and rad.
const MAX_FREE: (f64, f64) = (100.0, std::f64::consts::TAU);
/// Number of decimals (mm or degrees) to which a requested and an allowed value are rounded for comparison.
const DIGITS: i32 = 9;

/// Every coordinate of a layout, in the order of [`Cell::layout`].
#[derive(Debug, Clone, PartialEq)]
pub struct LayoutValues {
    slots: Vec<Slot>,
    /// Coordinates, m or rad.
    pub si: Vec<f64>,
}

impl LayoutValues {
    /// Returns the coordinates of a layout.
    pub fn of(cell: &Cell, layout: &Layout) -> Self {
        let mut slots = Vec::new();
        cell.layout(|slot, coordinate| {
            slots.push(slot);
            coordinate.start()
        });
        let si = slots.iter().map(|slot| layout.value(cell, *slot)).collect();
        Self { slots, si }
    }

    /// Returns the exact coordinates of the layout as drawn, without rounding.
    pub fn start(cell: &Cell) -> Self {
        let mut values = Self { slots: Vec::new(), si: Vec::new() };
        cell.layout(|slot, coordinate| {
            values.slots.push(slot);
            values.si.push(coordinate.start());
            coordinate.start()
        });
        values
    }

    /// Returns the layout with these coordinates.
    pub fn layout(&self, cell: &Cell) -> Layout {
        cell.layout(|slot, coordinate| self.get(slot).unwrap_or_else(|| coordinate.start()))
    }

    /// Returns a cell with this layout as its start. If `frees` is true, a fixed coordinate that gets another
    /// value becomes a range, as in [`Cell::starting_at`].
    pub fn starting(&self, cell: &Cell, frees: bool) -> Cell {
        cell.starting_at(self.slots.iter().copied().zip(self.si.iter().copied()), frees)
    }

    fn get(&self, slot: Slot) -> Option<f64> {
        self.slots.iter().position(|s| *s == slot).map(|k| self.si[k])
    }

    /// Returns a copy of the coordinates with the changes of a request.
    ///
    /// # Errors
    /// Fails with a message for the page if the request is refused.
    pub fn changed(&self, cell: &Cell, asked: &Map<String, Value>) -> Result<Self, String> {
        let mut values = self.clone();
        for (group, entry) in asked {
            let entries = entry.as_object().ok_or_else(|| format!("`{}` must be an object", shown(group)))?;
            if group == "robot_base" {
                values.take(cell, "the robot base", &Slot::Base, entries)?;
                continue;
            }
            for (name, numbers) in entries {
                let slot = slot_of(cell, group, name)?;
                let numbers =
                    numbers.as_object().ok_or_else(|| format!("`{}` must be an object", shown(name)))?;
                values.take(cell, &shown(name), &slot, numbers)?;
            }
        }
        Ok(values)
    }

    fn take(
        &mut self,
        cell: &Cell,
        owner: &str,
        slot: &dyn Fn(usize) -> Slot,
        numbers: &Map<String, Value>,
    ) -> Result<(), String> {
        for (key, number) in numbers {
            let named = (0..4).map(slot).filter(|s| !matches!(s, Slot::Attitude(_, 3)));
            let place = named.filter(|s| coordinate_name(*s) == key).find_map(|s| self.place(s));
            let place = place
                .ok_or_else(|| format!("{owner} has no coordinate `{}` that can be changed", shown(key)))?;
            let slot = self.slots[place];
            let number = number.as_f64().filter(|v| v.is_finite());
            let number = number.ok_or_else(|| format!("{key} of {owner} must be a number"))?;
            let coordinate = cell.coordinate(slot).ok_or("unknown coordinate")?;
            self.si[place] =
                allowed(coordinate, slot, number).map_err(|why| format!("{key} of {owner} {why}"))?;
        }
        Ok(())
    }

    fn place(&self, slot: Slot) -> Option<usize> {
        self.slots.iter().position(|s| *s == slot)
    }

    /// Returns the change from the layout `before`, in words.
    pub fn difference(&self, before: &Self, cell: &Cell) -> String {
        let pairs = self.slots.iter().zip(self.si.iter().zip(&before.si));
        let moved: Vec<String> = pairs
            .filter(|(_, (now, was))| now != was)
            .map(|(slot, (now, was))| {
                let [was, now] = [was, now].map(|v| rounded(in_file(*slot, *v), 3));
                let (name, unit) = coordinate_name(*slot).split_once('_').unwrap_or_default();
                format!("{} {name} {was} to {now} {unit}", owner(cell, *slot))
            })
            .collect();
        match &moved[..] {
            [] => "nothing changed".into(),
            [first, second, third, _, ..] => {
                format!("{first}, {second}, {third} and {} more", moved.len() - 3)
            }
            few => few.join(", "),
        }
    }
}

/// Returns the start layout of a cell with the changes that the body of a request states.
///
/// # Errors
/// Fails with a message for the page if the request is refused.
pub fn requested_layout(cell: &Cell, body: &[u8]) -> Result<Layout, String> {
    let asked = requests::object(body)?;
    LayoutValues::start(cell).changed(cell, &asked).map(|values| values.layout(cell))
}

fn owner(cell: &Cell, slot: Slot) -> String {
    match slot {
        Slot::Base(_) => "robot base".into(),
        Slot::Equipment(k, _) => shown(&cell.equipment[k].name),
        Slot::Attitude(k, _) => shown(&cell.operations[k].name),
    }
}

/// Returns a function from the index of an axis or angle to the [`Slot`] of that coordinate.
///
/// In the group `equipment`, `name` is a piece of equipment; in the group `attitude`, it is an operation.
fn slot_of(cell: &Cell, group: &str, name: &str) -> Result<Box<dyn Fn(usize) -> Slot>, String> {
    let unknown = |what: &str| format!("the cell has no {what} `{}`", shown(name));
    match group {
        "equipment" => {
            let k = cell.equipment.iter().position(|e| e.name == name).ok_or_else(|| unknown("equipment"))?;
            if cell.equipment[k].role == Role::Obstacle {
                return Err(format!("`{}` is an obstacle, which cannot be moved", shown(name)));
            }
            Ok(Box::new(move |axis| Slot::Equipment(k, axis)))
        }
        "attitude" => {
            let k =
                cell.operations.iter().position(|o| o.name == name).ok_or_else(|| unknown("operation"))?;
            Ok(Box::new(move |angle| Slot::Attitude(k, angle)))
        }
        _ => Err(format!("`{}` is not one of robot_base, equipment, attitude", shown(group))),
    }
}

/// Converts a coordinate to mm or degrees.
fn in_file(slot: Slot, si: f64) -> f64 {
    if slot.is_angle() { deg_from_rad(si) } else { mm_from_m(si) }
}

/// Converts a number of the page (mm or degrees) to SI. Fails if the coordinate does not allow this value.
fn allowed(coordinate: &Coordinate, slot: Slot, number: f64) -> Result<f64, String> {
    let si = if slot.is_angle() { rad_from_deg(number) } else { m_from_mm(number) };
    let same = |v: f64| rounded(in_file(slot, v), DIGITS) == rounded(number, DIGITS);
    let said = |v: f64| rounded(in_file(slot, v), 3);
    match coordinate {
        Coordinate::List(values) => {
            let listed = || values.iter().map(|v| said(*v).to_string()).collect::<Vec<_>>().join(", ");
            values.iter().copied().find(|v| same(*v)).ok_or_else(|| format!("must be one of {}", listed()))
        }
        _ => {
            let farthest = if slot.is_angle() { MAX_FREE.1 } else { MAX_FREE.0 };
            let (min, max) = if coordinate.is_free() { coordinate.range() } else { (-farthest, farthest) };
            if (min..=max).contains(&si) {
                Ok(si)
            } else if same(min) || same(max) {
                Ok(si.clamp(min, max))
            } else {
                Err(format!("must be from {} to {}", said(min), said(max)))
            }
        }
    }
}
