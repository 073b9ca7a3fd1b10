//! First cells: the text of a commented cell file for each built-in robot.
//!
//! In this module, lengths are in mm and angles in degrees, as in the file that is written.

mod own_cell;
mod sketches;
mod table_choice;
mod text;

pub use own_cell::{OwnCell, TABLE, TablePlace};
pub use sketches::SKETCHES;
pub use table_choice::table_places;

/// Content of the first cell file for a robot: name, errors and equipment.
pub struct Sketch {
    /// Name for `sweetspot init`: a short name, or the name of the robot.
    pub name: &'static str,
    pub robot: &'static str,
    /// Description in one line.
    pub about: &'static str,
    errors: &'static str,
    pedestal: i32,
    work: SketchedEquipment,
    supply: SketchedEquipment,
    standoff: i32,
    /// Whether the file allows only four spins about the tool axis, because the inverse kinematics of the arm
    /// takes long for each spin.
    few_spins: bool,
}

/// Equipment of a first cell: its start placement, and the greatest |x| and |y| at which it may be placed.
struct SketchedEquipment {
    file: &'static str,
    x: i32,
    y: i32,
    yaw: i32,
    within: i32,
    z: i32,
    /// Range of z, mm; None if z is fixed.
    heights: Option<(i32, i32)>,
}

const fn stand(file: &'static str, (x, y, z): (i32, i32, i32), yaw: i32, within: i32) -> SketchedEquipment {
    SketchedEquipment { file, x, y, yaw, within, z, heights: None }
}

impl SketchedEquipment {
    const fn ranging(mut self, low: i32, high: i32) -> Self {
        self.heights = Some((low, high));
        self
    }
}

/// Returns the [`Sketch`] whose name, or whose robot, is `name`; None if there is none.
pub fn find(name: &str) -> Option<&'static Sketch> {
    SKETCHES.iter().find(|s| s.name == name || s.robot == name)
}

/// Returns the name and the text of every first cell.
#[doc(hidden)] // open for tests/maths
pub fn texts() -> impl Iterator<Item = (&'static str, String)> {
    SKETCHES.iter().map(|sketch| (sketch.name, sketch.text()))
}
