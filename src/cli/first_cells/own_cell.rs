//! Text of a first cell around a robot of the user: one table, one operation.

use super::text::SEARCH;
use crate::files::toml_string;
use crate::units::rad_from_deg;

/// Place of the table in a first cell, in whole mm and degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TablePlace {
    /// Height of the robot base above the floor, mm.
    pub pedestal: i32,
    /// Height of the top of the table above the floor, mm.
    pub top: i32,
    /// Distance of the middle of the table from the base axis, mm.
    pub radius: i32,
    /// Azimuth of the table about the base axis, degrees.
    pub azimuth: i32,
    /// Size of the table along the radius and perpendicular to the radius, mm.
    pub size: (i32, i32),
    pub standoff: i32,
    /// Elevation of the tool axis, degrees.
    pub bend: i32,
}

/// First cell around a robot of the user.
pub struct OwnCell<'a> {
    /// Command that writes the cell.
    pub command: &'a str,
    pub name: &'a str,
    /// Path of the robot file in the folder of the cell.
    pub robot: &'a str,
    pub errors: &'a str,
    /// Note for the user on the errors.
    pub about_errors: &'a str,
    /// Whether the error set contains the signed errors of one robot.
    pub is_signed: bool,
    /// Whether the file allows only four spins about the tool axis, because the inverse kinematics of the arm
    /// takes long for each spin.
    pub few_spins: bool,
    pub place: TablePlace,
}

/// Path of the equipment file of the table in the folder of the cell.
pub const TABLE: &str = "equipment/table.toml";

impl OwnCell<'_> {
    /// Returns the text of the cell file.
    pub fn text(&self) -> String {
        let Self { command, robot, errors, about_errors, place, .. } = self;
        let TablePlace { pedestal, top, radius, azimuth, size, standoff, bend } = *place;
        let (sin, cos) = rad_from_deg(f64::from(azimuth)).sin_cos();
        let at = |share: f64| (f64::from(radius) * share).round() as i32;
        let (x, y) = (at(cos), at(sin));
        let range = |v: i32, by: i32| format!("{{ min = {}, max = {}, start = {v} }}", v - by, v + by);
        let (aside, up) = (size.0 / 2, (size.0 / 4).min(top / 3));
        let spins = match self.few_spins {
            true => {
                "spin_deg = [0, 90, 180, 270] # allowed angles about the tool axis; without this key, every angle is allowed\n"
            }
            false => "",
        };
        let reading = if self.is_signed {
            "reading = \"signed\""
        } else {
            "reading = \"statistical\"\nquantity = \"p95\""
        };
        format!(
            r#"#:schema ./schemas/cell.schema.json
# A first cell, written by `{command}`. It runs as it is; change whatever differs in your workcell.
# Lengths are in mm, angles in degrees. Editors that read the first line can complete and explain every key.
schema = "sweetspot/cell/1"
units = {{ length = "mm", angle = "deg" }}
name = {name}
source = "the table was placed by sweetspot init within the reach of the arm; the robot file states the sources of its numbers"

# Error set of the robot; `sweetspot robot {robot}` lists all sets.
{about_errors}
errors = "{errors}"

# How errors are read: "worst-case" (the worst combination of the tolerances) or "statistical" (random variables).
# `quantity` is the assessed statistic: "rms", "mean", "p95", "p99" or "yield". A measured sample has the reading
# "signed".
{reading}

# A distance below this counts as a collision.
clearance_mm = 10

# The robot, and the placement of its base. Keys here override the keys of its file. Your own tool, for example, is
# tool = {{ position_mm = [0, 0, 120], axis = [0, 0, 1] }}.
# A base above the floor stands on a pedestal; set pedestal = false for a base on a wall or a gantry.
[robot]
from = "{robot}"
base = {{ x_mm = 0, y_mm = 0, z_mm = {pedestal}, yaw_deg = 0 }}

# The table; the origin of its frame is in the middle of its top. A number is fixed; a range {{ min, max, start }}
# or a list of allowed values is searched, and `start` is the value in the layout as drawn.
[equipment.table]
from = "{TABLE}"

[equipment.table.placement]
x_mm = {}
y_mm = {}
z_mm = {}
yaw_deg = {azimuth}

# The operation; its spot is chosen among the nodes of a grid on the table.
[operation.task]
on = "table"
grid = [4, 6]        # divisions along x and y: 5 x 7 nodes
standoff_mm = {standoff}    # height of the TCP above the surface
bend_deg = {bend}       # elevation of the tool axis: -90 points down, 0 is horizontal
{spins}sense = "xyz"        # direction in which the error is assessed: x, y, z, xy, xyz, rx, ry, rz, rotation; xy@tool in tool axes
# limit_mm = 1       # largest allowed error: a search then reports whether the limit is met, and the margin

{SEARCH}"#,
            range(x, aside),
            range(y, aside),
            range(top, up),
            name = toml_string(self.name),
        )
    }
}

impl TablePlace {
    /// Returns the text of the equipment file of the table.
    pub fn table(&self) -> String {
        let (x, y) = self.size;
        let legs = [(-1, -1), (-1, 1), (1, -1), (1, 1)].iter().enumerate().map(|(k, (i, j))| {
            let centre = (i * (x / 2 - 30), j * (y / 2 - 30));
            format!(
                "\n[[solid]]\nname = \"leg {}\"\nleg = {{ centre_mm = [{}, {}], size_mm = [40, 40], top_mm = -30 }}\n",
                k + 1,
                centre.0,
                centre.1
            )
        });
        format!(
            "#:schema ../schemas/equipment.schema.json\n\
             # A table whose size suits the reach of the arm; the origin of its frame is in the middle of its top.\n\
             schema = \"sweetspot/equipment/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\n\
             name = \"Table {x} x {y}\"\nsource = \"made up by sweetspot init\"\n\n\
             [surface]\nsize_mm = [{x}, {y}]\n\n\
             [[solid]]\nname = \"slab\"\nbox = {{ centre_mm = [0, 0, -15], size_mm = [{x}, {y}, 30] }}\n{}",
            legs.collect::<String>()
        )
    }
}
