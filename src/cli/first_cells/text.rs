//! Text of a first cell, part by part, with comments for the user.

use super::{Sketch, SketchedEquipment};

impl Sketch {
    /// Returns the text of the cell file.
    pub fn text(&self) -> String {
        [self.head(), self.robot_part(), self.equipment(), self.operations(), SEARCH.to_string()].join("\n")
    }

    fn head(&self) -> String {
        let Self { name, robot, errors, .. } = self;
        let what = match *errors {
            "placeholder" => {
                "# PLACEHOLDER values: manufacturers do not publish tolerances of these parameters. Add the tolerances of\n\
                 # your robot to its file, under [errors.NAME], and name the set here. Until then, use the errors only to\n\
                 # compare layouts."
            }
            _ => {
                "# Tolerances with the magnitudes of Table 3 of the seed paper; the robot file states this source. Add the\n\
                 # tolerances of your robot to its file, under [errors.NAME], and name the set here."
            }
        };
        format!(
            r#"#:schema ./schemas/cell.schema.json
# A first cell, written by `sweetspot init {name}`. It runs as it is; change whatever differs in your workcell.
# Lengths are in mm, angles in degrees. Editors that read the first line can complete and explain every key.
schema = "sweetspot/cell/1"
units = {{ length = "mm", angle = "deg" }}
name = "First cell: {name}"
source = "placements made up by sweetspot init; the robot file states the sources of its numbers"

# Error set of the robot; `sweetspot robot {robot}` lists all sets.
{what}
errors = "{errors}"

# How errors are read: "worst-case" (the worst combination of the tolerances) or "statistical" (random variables).
# `quantity` is the assessed statistic: "rms", "mean", "p95", "p99" or "yield". A measured sample has the reading
# "signed".
reading = "statistical"
quantity = "p95"

# A distance below this counts as a collision.
clearance_mm = 10
"#
        )
    }

    fn robot_part(&self) -> String {
        let Self { robot, pedestal, .. } = self;
        let under = match *pedestal > 0 {
            true => {
                "\n# A base above the floor stands on a pedestal; set pedestal = false for a base on a wall or a gantry."
            }
            false => "",
        };
        format!(
            r#"# The robot, and the placement of its base. Keys here override the keys of its file. Your own tool,
# for example, is tool = {{ position_mm = [0, 0, 120], axis = [0, 0, 1] }}.{under}
[robot]
from = "robots/{robot}.toml"
base = {{ x_mm = 0, y_mm = 0, z_mm = {pedestal}, yaw_deg = 0 }}
"#
        )
    }

    fn equipment(&self) -> String {
        format!(
            "# Equipment; the origin of its frame is in the middle of its top. A number is fixed; a range {{ min, max, start }}\n\
             # or a list of allowed values is searched, and `start` is the value in the layout as drawn.\n{}\n{}",
            self.work.text(),
            self.supply.text()
        )
    }

    fn operations(&self) -> String {
        let Self { standoff, work, supply, .. } = self;
        let spin = if self.few_spins {
            "spin_deg = [0, 90, 180, 270] # allowed angles about the tool axis; without this key, every \
            angle is allowed\n"
        } else {
            ""
        };
        format!(
            r#"# Operations; the spot of each operation is chosen among the nodes of a grid on the work surface.
[operation.assembly]
on = "{}"
grid = [6, 4]        # divisions along x and y: 7 x 5 nodes
standoff_mm = {standoff}{}# height of the TCP above the surface
bend_deg = -90       # elevation of the tool axis: -90 points down
{spin}sense = "xy"         # direction in which the error is assessed: x, y, z, xy, xyz, rx, ry, rz, rotation; xy@tool in tool axes
# limit_mm = 1       # largest allowed error: a search then reports whether the limit is met, and the margin

[operation.picking]
on = "{}"
grid = [6, 2]
standoff_mm = {standoff}
bend_deg = -90
{spin}sense = "xy"

# Obstacles go here: only their solids and placement are needed.
# [obstacle.post]
# solid = [{{ name = "post", box = {{ centre_mm = [0, 0, 1000], size_mm = [100, 100, 2000] }} }}]
# placement = {{ x_mm = -900, y_mm = 0, z_mm = 0 }}
"#,
            work.file,
            if *standoff < 100 { "     " } else { "    " },
            supply.file
        )
    }
}

/// Text of the table `[search]` of a first cell.
pub const SEARCH: &str = r#"[search]
solver = "cma-es"
objective = "sum" # sum of all errors; or "max" (largest error), or "lexicographic" (first operation first)
budget = 2000     # layout evaluations; use 20000 for a final result
seed = 1          # the same seed gives the same result
"#;

impl SketchedEquipment {
    fn text(&self) -> String {
        let Self { file, x, y, z, yaw, within, heights } = self;
        let height = match heights {
            Some((low, high)) => format!("{{ min = {low}, max = {high}, start = {z} }}"),
            None => z.to_string(),
        };
        format!(
            r#"[equipment.{file}]
from = "equipment/{file}.toml"

[equipment.{file}.placement]
x_mm = {{ min = -{within}, max = {within}, start = {x} }}
y_mm = {{ min = -{within}, max = {within}, start = {y} }}
z_mm = {height}
yaw_deg = {{ min = -90, max = 90, start = {yaw} }}
"#
        )
    }
}
