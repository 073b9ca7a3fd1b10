//! First cells of the built-in robots.

use super::{Sketch, SketchedEquipment, stand};
use crate::cli::library::ROBOTS;

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

/// Returns a first cell for the Hitachi arm of the seed paper, from which this project grew. Three robot
/// files describe this arm.
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

/// Returns a first cell for an arm with about one metre of reach. The start placement is (0, `far`) for the
/// bench and (`far`, -100) for the feeder, mm in the world frame.
const fn small(
    [name, about, robot]: [&'static str; 3],
    (pedestal, far): (i32, i32),
    (z, low, high): (i32, i32, i32),
    within: i32,
) -> Sketch {
    let bench = stand("bench", (0, far, z), 0, within).ranging(low, high);
    sketch([name, about, robot, "placeholder"], pedestal, bench, stand("feeder", (far, -100, z), 90, within))
}

/// Returns a first cell with a bench and a feeder, named after its robot. The numbers `of` are the arguments
/// of [`small`], mm. They are the pedestal height, the distance `far`, three heights of the bench (start,
/// least, greatest), and the greatest |x| and |y| of the equipment.
const fn bench(robot: &'static str, about: &'static str, of: [i32; 6]) -> Sketch {
    let [pedestal, far, z, low, high, within] = of;
    small([robot, about, robot], (pedestal, far), (z, low, high), within)
}

/// Returns a first cell with a worktable and a conveyor, named after its robot. The start placement is
/// (0, `y`) for the table and (`x`, -`y` / 2) for the conveyor, mm in the world frame.
const fn hall(robot: &'static str, about: &'static str, [pedestal, x, y, z, within]: [i32; 5]) -> Sketch {
    let table = stand("worktable", (0, y, z), 0, within).ranging(z - 200, z + 200);
    sketch(
        [robot, about, robot, "placeholder"],
        pedestal,
        table,
        stand("conveyor", (x, -y / 2, z), 90, within),
    )
}

/// Allows only four spins about the tool axis, because the inverse kinematics of the arm takes long for each
/// spin.
const fn slow(mut sketch: Sketch) -> Sketch {
    sketch.few_spins = true;
    sketch
}

/// First cells, one for every built-in robot.
pub const SKETCHES: [Sketch; ROBOTS.len()] = [
    hitachi("hitachi", "the 4-axis arm of the seed paper, worktable and conveyor", "hitachi_pw10"),
    large_ur("ur10e", "six axes (Universal Robots UR10e), worktable and conveyor"),
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
        "the arm of the seed paper (with a parallelogram), worktable and conveyor",
        "hitachi_pw10_parallelogram",
    ),
    hitachi(
        "hitachi-urdf",
        "the arm of the seed paper (read from a URDF), worktable and conveyor",
        "hitachi_pw10_urdf",
    ),
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
        ["stanford", "six axes, one of them linear (Stanford arm), bench and feeder", "stanford_arm"],
        (500, 650),
        (600, 400, 800),
        1100,
    ),
    large_ur("ur10", "six axes (Universal Robots UR10), worktable and conveyor"),
    small(
        ["ur5e", "six axes (Universal Robots UR5e), bench and feeder", "ur5e"],
        (700, 550),
        (750, 600, 900),
        900,
    ),
    bench("abb_irb120", "six axes (ABB IRB 120), bench and feeder", [600, 430, 700, 600, 900, 700]),
    bench("abb_irb1200", "six axes (ABB IRB 1200), bench and feeder", [500, 600, 700, 500, 900, 900]),
    hall("abb_irb4600", "six axes (ABB IRB 4600), worktable and conveyor", [0, 1350, 1250, 700, 2200]),
    hall("abb_irb6700", "six axes (ABB IRB 6700), worktable and conveyor", [0, 1700, 1700, 800, 2600]),
    hall("comau_ns16", "six axes (Comau NS16), worktable and conveyor", [0, 1150, 1100, 700, 1900]),
    bench("denso_vs060", "six axes (DENSO VS-060), bench and feeder", [500, 450, 700, 500, 900, 750]),
    hall("doosan_m1013", "six axes (Doosan M1013), worktable and conveyor", [700, 980, 800, 750, 1400]),
    bench(
        "fanuc_lrmate200id",
        "six axes (FANUC LR Mate 200iD), bench and feeder",
        [500, 500, 700, 500, 900, 800],
    ),
    hall("fanuc_m20ia", "six axes (FANUC M-20iA), worktable and conveyor", [0, 1250, 1200, 700, 2100]),
    hall(
        "fanuc_r2000ic_165f",
        "six axes (FANUC R-2000iC), worktable and conveyor",
        [0, 1700, 1700, 800, 2600],
    ),
    bench("kawasaki_rs007n", "six axes (Kawasaki RS007N), bench and feeder", [500, 500, 700, 500, 900, 800]),
    slow(bench("kinova_gen3", "seven axes (Kinova Gen3), bench and feeder", [700, 600, 750, 600, 900, 800])),
    bench(
        "kuka_kr10_r1100",
        "six axes (KUKA KR 10 R1100), bench and feeder",
        [500, 650, 700, 500, 900, 1000],
    ),
    hall("kuka_kr16_2", "six axes (KUKA KR 16-2), worktable and conveyor", [0, 1100, 1050, 700, 1900]),
    hall("kuka_kr150_r3100_2", "six axes (KUKA KR 150), worktable and conveyor", [0, 1900, 1800, 800, 3000]),
    slow(bench(
        "kuka_iiwa14",
        "seven axes (KUKA LBR iiwa 14), bench and feeder",
        [500, 550, 700, 500, 900, 900],
    )),
    hall("motoman_gp12", "six axes (Yaskawa GP12), worktable and conveyor", [0, 1000, 950, 600, 1700]),
    hall("motoman_gp25", "six axes (Yaskawa GP25), worktable and conveyor", [0, 1200, 1150, 700, 2000]),
    bench("motoman_gp8", "six axes (Yaskawa GP8), bench and feeder", [500, 500, 700, 500, 900, 800]),
    bench("staubli_tx2_60", "six axes (Staubli TX2-60), bench and feeder", [500, 450, 700, 500, 900, 750]),
    bench("staubli_tx2_90", "six axes (Staubli TX2-90), bench and feeder", [500, 650, 700, 500, 900, 1000]),
    bench("techman_tm5_900", "six axes (Techman TM5-900), bench and feeder", [700, 550, 750, 600, 900, 900]),
    bench(
        "ufactory_xarm6",
        "six axes with an offset wrist (xArm 6), bench and feeder",
        [700, 470, 750, 600, 900, 700],
    ),
    bench("ur16e", "six axes (Universal Robots UR16e), bench and feeder", [700, 550, 750, 600, 900, 900]),
    hall("ur20", "six axes (Universal Robots UR20), worktable and conveyor", [700, 1000, 950, 750, 1700]),
    bench("ur3e", "six axes (Universal Robots UR3e), bench and feeder", [700, 430, 750, 600, 900, 600]),
];
