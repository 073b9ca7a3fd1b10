//! Small random cells from a seed: an arm, one or two pieces of equipment with a few free coordinates, and
//! obstacles.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::fmt::Write;

/// Kind of arm of a random cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RandomArm {
    /// Base yaw and three parallel axes of random lengths and limits.
    Planar,
    Hitachi,
    Scara,
    SixAxes,
}

struct RandomSource(ChaCha8Rng);

impl RandomSource {
    /// Returns a random whole number, which the text of a cell states exactly.
    fn between(&mut self, low: i32, high: i32) -> i32 {
        self.0.random_range(low..=high)
    }

    fn chance(&mut self, share: f64) -> bool {
        self.0.random::<f64>() < share
    }

    fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.0.random_range(0..all.len())]
    }
}

/// Returns the text of a cell and its kind of arm.
pub fn random_cell(seed: u64) -> (RandomArm, String) {
    let dice = &mut RandomSource(ChaCha8Rng::seed_from_u64(seed));
    let arm = *dice.of(&[
        RandomArm::Planar,
        RandomArm::Planar,
        RandomArm::Planar,
        RandomArm::Hitachi,
        RandomArm::Hitachi,
        RandomArm::Scara,
        RandomArm::SixAxes,
    ]);
    let mut text = format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nname = \"random {seed}\"\n"
    );
    let _ = writeln!(text, "clearance_mm = {}", dice.of(&[0, 0, 5, 20]));
    // Reach with the tool down, mm, and heights of surfaces in that reach.
    let (reach, low, high) = match arm {
        RandomArm::Planar => planar_arm(dice, &mut text),
        RandomArm::Hitachi => {
            let errors = dice.of(&["table-2", "table-3"]);
            let _ = writeln!(text, "errors = \"{errors}\"\n[robot]\nfrom = \"robots/hitachi_pw10.toml\"");
            (1150, 400, 900)
        }
        RandomArm::Scara => {
            library_arm(dice, &mut text, "adept_cobra_s600", 4);
            (560, 130, 250)
        }
        RandomArm::SixAxes => {
            let robot = *dice.of(&["ur5e", "puma560", "abb_irb140"]);
            library_arm(dice, &mut text, robot, 6);
            (600, 100, 400)
        }
    };
    let around = f64::from(dice.between(-180, 180));
    let free = if arm == RandomArm::SixAxes { 1 } else { dice.between(1, 3) };
    table(dice, &mut text, "bench", arm, (reach, low, high), around, free);
    if free < 3 && arm != RandomArm::SixAxes && dice.chance(0.8) {
        let other = around + f64::from(dice.between(80, 160));
        table(dice, &mut text, "feeder", arm, (reach, low, high), other, 0);
    }
    in_the_way(dice, &mut text, reach, around);
    (arm, text)
}

/// Writes an arm like the arm of the seed paper, with other lengths and limits.
fn planar_arm(dice: &mut RandomSource, text: &mut String) -> (i32, i32, i32) {
    let (r, l2, l3) = (dice.between(500, 900), dice.between(350, 700), dice.between(350, 800));
    let l4 = dice.between(150, 400);
    let limits =
        [dice.between(110, 175), dice.between(50, 100), dice.between(60, 130), dice.between(80, 120)];
    text.push_str("errors = \"sample\"\n[robot]\nname = \"random arm\"\nsource = \"random\"\n");
    text.push_str(
        "tool = { position_mm = [0, 0, 0], axis = [1, 0, 0] }\nfootprint = { size_mm = [400, 400] }\n",
    );
    let rows = [(90, r, 0, 90), (90, 0, l2, 0), (-90, 0, l3, 0), (0, 0, l4, 0)];
    for (k, ((q, r, l, alpha), limit)) in rows.into_iter().zip(limits).enumerate() {
        let _ = write!(
            text,
            "[[robot.joint]]\nname = \"q{}\"\nq_offset_deg = {q}\nr_mm = {r}\nl_mm = {l}\nalpha_deg = {alpha}\n\
             limits_deg = [-{limit}, {limit}]\n",
            k + 1
        );
    }
    let bars = [
        ("column", 1, [0, -(r - 160), 0], 120),
        ("upper arm", 2, [-l2, 0, 0], 80),
        ("forearm", 3, [-l3, 0, 0], 70),
    ];
    for (name, link, a, radius) in bars {
        let _ = write!(
            text,
            "[[robot.solid]]\nname = \"{name}\"\nlink = {link}\n\
             capsule = {{ a_mm = {a:?}, b_mm = [0, 0, 0], radius_mm = {radius} }}\n"
        );
    }
    let _ = write!(
        text,
        "[[robot.solid]]\nname = \"tool\"\nlink = 4\n\
         cylinder = {{ a_mm = [-{l4}, 0, 0], b_mm = [-20, 0, 0], radius_mm = 35 }}\n[robot.errors.sample]\n\
         kind = \"signed\"\nsource = \"random\"\n"
    );
    errors(dice, text, 4);
    ((l2 + l3) * 9 / 10, (r - l4 - 300).max(250), r + 50)
}

/// Writes an arm of the library with a random signed sample of errors.
fn library_arm(dice: &mut RandomSource, text: &mut String, robot: &str, axes: usize) {
    let _ = write!(
        text,
        "errors = \"sample\"\n[robot]\nfrom = \"robots/{robot}.toml\"\n[robot.errors.sample]\n\
         kind = \"signed\"\nsource = \"random\"\n"
    );
    errors(dice, text, axes);
}

/// Writes errors of every row, in tenths of mm and hundredths of a degree.
fn errors(dice: &mut RandomSource, text: &mut String, axes: usize) {
    for (key, most, part) in [("dr_mm", 30, 10.0), ("dl_mm", 30, 10.0), ("dalpha_deg", 80, 100.0)] {
        let values: Vec<f64> = (0..axes).map(|_| f64::from(dice.between(-most, most)) / part).collect();
        let _ = writeln!(text, "{key} = {values:?}");
    }
}

/// Writes a table in a direction about `around` degrees from the x axis, with an operation and some free
/// coordinates.
fn table(
    dice: &mut RandomSource,
    text: &mut String,
    name: &str,
    arm: RandomArm,
    (reach, low, high): (i32, i32, i32),
    around: f64,
    free: i32,
) {
    let size = [dice.between(reach * 3 / 10, reach * 8 / 10), dice.between(reach * 3 / 10, reach * 6 / 10)];
    let radius = f64::from(dice.between(reach * 6 / 10, reach)) + f64::from(size[1]) / 4.0;
    let (sin, cos) = around.to_radians().sin_cos();
    let centre = [
        (radius * cos).round() as i32,
        (radius * sin).round() as i32,
        dice.between(low, high),
        dice.between(-90, 90),
    ];
    let spread = [reach / 2, reach / 2, (high - low) / 2, 60];
    let mut order = [0, 1, 2, 3];
    (0..3).for_each(|k| order.swap(k, dice.between(k as i32, 3) as usize));
    let coordinate = |k: usize| {
        let (at, by) = (centre[k], spread[k]);
        // An upright slab stands on legs and cannot sink into the floor.
        let (min, max) =
            if k == 2 { ((at - by).max(low), (at + by).min(high).max(low + 10)) } else { (at - by, at + by) };
        match order[..free as usize].contains(&k) {
            true => format!("{{ min = {min}, max = {max} }}"),
            false => at.to_string(),
        }
    };
    let [x, y, z, yaw] = [0, 1, 2, 3].map(coordinate);
    let _ = write!(
        text,
        "[equipment.{name}]\nsurface = {{ size_mm = {size:?} }}\n\
         solid = [{{ name = \"slab\", box = {{ centre_mm = [0, 0, -15], size_mm = [{}, {}, 30] }} }},\n\
         {{ name = \"leg\", leg = {{ centre_mm = [0, 0], size_mm = [80, 80], top_mm = -30 }} }}]\n\
         placement = {{ x_mm = {x}, y_mm = {y}, z_mm = {z}, yaw_deg = {yaw} }}\n",
        size[0], size[1]
    );
    let grid = if arm == RandomArm::SixAxes { [1, 1] } else { [dice.between(1, 5), dice.between(1, 4)] };
    let spin = if matches!(arm, RandomArm::SixAxes | RandomArm::Scara) {
        "azimuth_deg = 0\nspin_deg = [0]\n"
    } else {
        ""
    };
    let sense = dice.of(&["xy", "xy", "xyz"]);
    let _ = write!(
        text,
        "[operation.{name}-work]\non = \"{name}\"\ngrid = {grid:?}\nstandoff_mm = {}\nbend_deg = -90\n{spin}\
         sense = \"{sense}\"\nweight = {}\n",
        dice.between(40, 150),
        dice.of(&[1.0, 1.0, 2.5])
    );
}

/// Writes posts and blocks around the table, and a keep-out box.
fn in_the_way(dice: &mut RandomSource, text: &mut String, reach: i32, around: f64) {
    for k in 0..dice.between(1, 4) {
        let radius = f64::from(dice.between(reach * 5 / 10, reach * 11 / 10));
        let (sin, cos) = (around + f64::from(dice.between(-70, 70))).to_radians().sin_cos();
        let size = [dice.between(40, reach / 5), dice.between(40, reach / 5), dice.between(300, 1500)];
        let _ = write!(
            text,
            "[obstacle.post-{k}]\nsolid = [{{ name = \"post\", box = {{ centre_mm = [0, 0, {}], size_mm = {size:?} }} }}]\n\
             placement = {{ x_mm = {}, y_mm = {}, z_mm = 0, yaw_deg = {} }}\n",
            f64::from(size[2]) / 2.0,
            (radius * cos).round(),
            (radius * sin).round(),
            dice.between(-45, 45)
        );
    }
    if dice.chance(0.6) {
        let radius = f64::from(dice.between(reach * 8 / 10, reach * 13 / 10));
        let (sin, cos) = (around + f64::from(dice.between(-60, 60))).to_radians().sin_cos();
        let (x, y, half) =
            ((radius * cos).round(), (radius * sin).round(), f64::from(dice.between(50, reach / 5)));
        let _ = write!(
            text,
            "[keep_out.way]\nmin_mm = [{}, {}, 0]\nmax_mm = [{}, {}, 2000]\n",
            x - half,
            y - half,
            x + half,
            y + half
        );
    }
}
