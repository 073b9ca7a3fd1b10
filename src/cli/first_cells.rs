//! First cells: the text of a commented cell file around each built-in robot.
//!
//! Lengths are in mm here, as in the file that is written.

use super::library::ROBOTS;

/// First cell of a robot: its name, errors and equipment.
pub struct Sketch {
    /// Short name, or the name of the robot.
    pub name: &'static str,
    pub robot: &'static str,
    /// Description in one line.
    pub about: &'static str,
    errors: &'static str,
    pedestal: i32,
    work: SketchedEquipment,
    supply: SketchedEquipment,
    standoff: i32,
    /// Whether few spins about the tool axis are tried, because a redundant arm takes long for each.
    few_spins: bool,
}

/// Equipment of a first cell: its start placement, and how far from the origin it may be placed.
struct SketchedEquipment {
    file: &'static str,
    x: i32,
    y: i32,
    yaw: i32,
    within: i32,
    z: i32,
    /// Range of z; None: z is fixed.
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

/// Name, description, robot and error set.
type SketchHead = [&'static str; 4];

const fn sketch(
    [name, about, robot, errors]: SketchHead,
    pedestal: i32,
    work: SketchedEquipment,
    supply: SketchedEquipment,
) -> Sketch {
    Sketch { name, robot, about, errors, pedestal, work, supply, standoff: 100, few_spins: false }
}

/// The arm of the seed paper, which has three files.
const fn hitachi(name: &'static str, about: &'static str, robot: &'static str) -> Sketch {
    let table = stand("worktable", (300, 1000, 600), 10, 1800).ranging(300, 900);
    sketch(
        [name, about, robot, "table-3-tolerance"],
        0,
        table,
        stand("conveyor", (1000, -400, 600), 80, 2000),
    )
}

/// Large arms of Universal Robots.
const fn large_ur(name: &'static str, about: &'static str) -> Sketch {
    let table = stand("worktable", (0, 850, 750), 0, 1300).ranging(500, 1000);
    sketch([name, about, name, "placeholder"], 700, table, stand("conveyor", (950, -650, 700), 90, 1500))
}

/// Arms of about one metre of reach, with a bench in front and a feeder at the side, both at distance `far`.
const fn small(
    [name, about, robot]: [&'static str; 3],
    (pedestal, far): (i32, i32),
    (z, low, high): (i32, i32, i32),
    within: i32,
) -> Sketch {
    let bench = stand("bench", (0, far, z), 0, within).ranging(low, high);
    sketch([name, about, robot, "placeholder"], pedestal, bench, stand("feeder", (far, -100, z), 90, within))
}

/// First cells, one for every built-in robot.
pub const SKETCHES: [Sketch; ROBOTS.len()] = [
    hitachi("hitachi", "the 4-axis arm of the paper, worktable and conveyor", "hitachi_pw10"),
    large_ur("ur10e", "six axes of Universal Robots, worktable and conveyor"),
    Sketch {
        standoff: 50,
        ..sketch(
            ["scara", "a SCARA (Adept Cobra s600), bench and feeder", "adept_cobra_s600", "placeholder"],
            700,
            stand("bench", (0, 450, 880), 0, 500).ranging(830, 1000),
            stand("feeder", (420, 0, 900), 90, 600),
        )
    },
    small(
        ["six-axis", "six axes with a wrist (KUKA KR 6 R900), bench and feeder", "kuka_kr6_r900"],
        (500, 600),
        (700, 500, 900),
        900,
    ),
    Sketch {
        standoff: 300,
        ..sketch(
            ["palletizer", "a palletizer (ABB IRB 460), pallet and conveyor", "abb_irb460", "placeholder"],
            0,
            stand("pallet", (1650, 300, 144), 0, 2500),
            stand("conveyor", (0, -1500, 700), 0, 2500),
        )
    },
    Sketch {
        few_spins: true,
        ..small(
            ["panda", "seven axes (Franka Emika Panda), bench and feeder", "franka_panda"],
            (700, 500),
            (750, 600, 900),
            800,
        )
    },
    small(
        ["irb140", "six axes (ABB IRB 140), bench and feeder", "abb_irb140"],
        (500, 550),
        (700, 500, 900),
        900,
    ),
    sketch(
        [
            "crx10ia",
            "six axes with an offset wrist (FANUC CRX-10iA), worktable and feeder",
            "fanuc_crx10ia",
            "placeholder",
        ],
        700,
        stand("worktable", (0, 750, 750), 0, 1200).ranging(500, 1000),
        stand("feeder", (750, -200, 750), 90, 1200),
    ),
    hitachi(
        "hitachi-parallelogram",
        "the paper's arm with a parallelogram, worktable and conveyor",
        "hitachi_pw10_parallelogram",
    ),
    hitachi("hitachi-urdf", "the paper's arm from a URDF, worktable and conveyor", "hitachi_pw10_urdf"),
    Sketch {
        standoff: 50,
        ..sketch(
            [
                "youbot",
                "a small arm of five axes (KUKA youBot), bench and feeder",
                "kuka_youbot",
                "placeholder",
            ],
            700,
            stand("bench", (0, 300, 650), 0, 500).ranging(600, 800),
            stand("feeder", (0, -220, 700), 0, 600),
        )
    },
    small(
        ["puma560", "six axes of the textbooks, bench and feeder", "puma560"],
        (0, 550),
        (700, 500, 900),
        900,
    ),
    Sketch {
        few_spins: true,
        ..sketch(
            ["track", "a PUMA 560 on a floor track, bench and feeder", "puma560_on_track", "placeholder"],
            0,
            stand("bench", (550, 700, 800), 0, 1400).ranging(600, 1000),
            stand("feeder", (-500, 0, 750), 90, 1400),
        )
    },
    small(
        ["stanford", "six axes, one of which slides (Stanford arm), bench and feeder", "stanford_arm"],
        (500, 650),
        (600, 400, 800),
        1100,
    ),
    large_ur("ur10", "six axes of Universal Robots, worktable and conveyor"),
    small(
        ["ur5e", "six axes of Universal Robots, bench and feeder", "ur5e"],
        (700, 550),
        (750, 600, 900),
        900,
    ),
];

/// Returns the first cell of a short name or of a robot.
pub fn find(name: &str) -> Option<&'static Sketch> {
    SKETCHES.iter().find(|s| s.name == name || s.robot == name)
}

impl Sketch {
    /// Returns the text of the cell file.
    pub fn text(&self) -> String {
        [self.head(), self.robot_part(), self.equipment(), self.operations(), SEARCH.to_string()].join("\n")
    }

    fn head(&self) -> String {
        let Self { name, robot, errors, .. } = self;
        let what = match *errors {
            "placeholder" => {
                "# A PLACEHOLDER: no maker publishes tolerances of these parameters. Put those of your robot into its file,\n\
                 # under [errors.NAME], and name them here; until then errors are good for comparing, not for promising."
            }
            _ => {
                "# The magnitudes of the paper's Table 3 read as plus-or-minus. Those of your robot go into its file, under\n\
                 # [errors.NAME], and their name goes here."
            }
        };
        format!(
            r#"#:schema ./schemas/cell.schema.json
# A first cell, written by `sweetspot init {name}`. It runs as it is; change what is different with you.
# Lengths are in mm, angles in degrees; an editor that reads the line above completes and explains every key.
schema = "sweetspot/cell/1"
units = {{ length = "mm", angle = "deg" }}
name = "First cell: {name}"
source = "placements made up by sweetspot init; the robot file says where its numbers come from"

# Which error set of the robot counts; `sweetspot robot {robot}` lists them.
{what}
errors = "{errors}"

# How errors are read: "worst-case" (the worst corner of the tolerances) or "statistical" (random variables), of
# which `quantity` is made small: "rms", "mean", "p95", "p99" or "yield". One measured sample is read "signed".
reading = "statistical"
quantity = "p95"

# Less distance than this counts as collision.
clearance_mm = 0
"#
        )
    }

    fn robot_part(&self) -> String {
        let Self { robot, pedestal, .. } = self;
        let under = if *pedestal > 0 { ", on a pedestal that is not drawn" } else { "" };
        format!(
            r#"# The robot, and where its base stands{under}. What stands here wins over its file: a tool of your
# own, for example, is tool = {{ position_mm = [0, 0, 120], axis = [0, 0, 1] }}.
[robot]
from = "robots/{robot}.toml"
base = {{ x_mm = 0, y_mm = 0, z_mm = {pedestal}, yaw_deg = 0 }}
"#
        )
    }

    fn equipment(&self) -> String {
        format!(
            "# Equipment: its frame lies in the middle of its top. A number stays; a range {{ min, max, start }} or a list\n\
             # of allowed values is searched, and `start` is where the layout as drawn has it.\n{}\n{}",
            self.work.text(),
            self.supply.text()
        )
    }

    fn operations(&self) -> String {
        let Self { standoff, work, supply, .. } = self;
        let spin = if self.few_spins {
            "spin_deg = [0, 90, 180, 270] # turns about the tool axis that will do; left out: every 30 degrees is tried\n"
        } else {
            ""
        };
        format!(
            r#"# What happens where: the spot on the surface is chosen among the nodes of the grid.
[operation.assembly]
on = "{}"
grid = [6, 4]        # divisions along x and y: 7 x 5 nodes
standoff_mm = {standoff}{}# how far the TCP is above the surface
bend_deg = -90       # elevation of the tool axis: pointing down
{spin}sense = "xy"         # the error that matters: x, y, z, xy, xyz, rx, ry, rz, rotation; xy@tool in axes of the tool
# limit_mm = 1       # the requirement: a search then says whether it is met, and by how much

[operation.picking]
on = "{}"
grid = [6, 2]
standoff_mm = {standoff}
bend_deg = -90
{spin}sense = "xy"

# What stands in the way goes here; nothing else needs to be said of it.
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

const SEARCH: &str = r#"[search]
solver = "cma-es"
objective = "sum" # of the operations' errors; or "max", or "lexicographic": the operations in their order
budget = 2000     # layouts evaluated; 20000 for a result to keep
seed = 1          # the same seed gives the same files
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
