//! First cells: the text of a commented cell file for each built-in robot.
//!
//! Lengths are in mm and angles in degrees here, as in the file that is written.

mod own_cell;
mod table_choice;
mod text;

pub use own_cell::{OwnCell, TABLE, TablePlace};
pub use table_choice::table_places;

use super::library::ROBOTS;

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
    /// Whether the file allows only four spins about the tool axis: each spin takes long for a redundant arm.
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

/// Name, description, robot and error set of a [`Sketch`].
type SketchHead = [&'static str; 4];

const fn sketch(
    [name, about, robot, errors]: SketchHead,
    pedestal: i32,
    work: SketchedEquipment,
    supply: SketchedEquipment,
) -> Sketch {
    Sketch { name, robot, about, errors, pedestal, work, supply, standoff: 100, few_spins: false }
}

/// Returns a first cell for the arm of the seed paper. Three robot files describe this arm.
const fn hitachi(name: &'static str, about: &'static str, robot: &'static str) -> Sketch {
    let table = stand("worktable", (300, 1000, 600), 10, 1800).ranging(300, 900);
    sketch(
        [name, about, robot, "table-3-tolerance"],
        0,
        table,
        stand("conveyor", (1000, -400, 600), 80, 2000),
    )
}

/// Returns a first cell for a large arm of Universal Robots.
const fn large_ur(name: &'static str, about: &'static str) -> Sketch {
    let table = stand("worktable", (0, 850, 750), 0, 1300).ranging(500, 1000);
    sketch([name, about, name, "placeholder"], 700, table, stand("conveyor", (950, -650, 700), 90, 1500))
}

/// Returns a first cell for an arm with about one metre of reach. The bench starts at (0, `far`) and the
/// feeder at (`far`, -100), mm in the world frame.
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
            stand("bench", (15, 315, 680), 0, 500).ranging(600, 800),
            stand("feeder", (0, -220, 700), 0, 600),
        )
    },
    small(
        ["puma560", "the six-axis arm of many textbooks (PUMA 560), bench and feeder", "puma560"],
        (0, 550),
        (700, 500, 900),
        900,
    ),
    Sketch {
        few_spins: true,
        ..sketch(
            ["track", "a PUMA 560 on a floor track, bench and feeder", "puma560_on_track", "placeholder"],
            0,
            stand("bench", (600, 700, 800), 0, 1400).ranging(600, 1000),
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

/// Returns the [`Sketch`] whose own name or whose robot's name is `name`.
pub fn find(name: &str) -> Option<&'static Sketch> {
    SKETCHES.iter().find(|s| s.name == name || s.robot == name)
}

/// Returns name and text of every first cell.
#[doc(hidden)] // open for tests/maths
pub fn texts() -> impl Iterator<Item = (&'static str, String)> {
    SKETCHES.iter().map(|sketch| (sketch.name, sketch.text()))
}
