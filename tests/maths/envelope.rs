//! Tests the working envelope against geometry, the inverse kinematics and Monte Carlo.

use crate::common::{root, shipped};
use nalgebra::{Vector3, vector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use sweetspot::cell::{Attitude, Azimuth, Cell, Placement, Robot, Spin};
use sweetspot::error_map::Outcome;
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::reach::{Branch, Envelope, EnvelopeSection, Fineness, Inverse, Reach, Size};
use sweetspot::robot::Chain;
use sweetspot::{cell, files};

const DOWN: f64 = -FRAC_PI_2;

/// Row of a D-H table: kind, offset, r, l, alpha, limits (mm, degrees).
type Row = (&'static str, f64, f64, f64, f64, [f64; 2]);

fn robot(rows: &[Row], axis: [f64; 3]) -> Robot {
    read(&text_of(rows, axis))
}

fn read(text: &str) -> Robot {
    let loaded = files::load_robot("arm.toml", &mut |_| Ok(text.as_bytes().to_vec()));
    loaded.unwrap_or_else(|f| panic!("{f:#?}")).robot
}

fn text_of(rows: &[Row], axis: [f64; 3]) -> String {
    let mut text =
        "schema = \"sweetspot/robot/1\"\nunits = { length = \"mm\", angle = \"deg\" }\nname = \"arm\"\n\
        source = \"a test\"\nfootprint = { size_mm = [100, 100] }\n"
            .to_string();
    for (i, (kind, offset, r, l, alpha, [low, high])) in rows.iter().enumerate() {
        let (zero, unit) = if *kind == "prismatic" { ("theta", "mm") } else { ("q_offset", "deg") };
        text += &format!(
            "[[joint]]\nname = \"q{i}\"\nkind = \"{kind}\"\n{zero}_deg = {offset}\nr_mm = {r}\nl_mm = {l}\n\
             alpha_deg = {alpha}\nlimits_{unit} = [{low}, {high}]\n"
        );
    }
    let some = vec![0.2; rows.len()];
    text += &format!(
        "[tool]\nposition_mm = [0, 0, 0]\naxis = {axis:?}\n[errors.some]\nkind = \"signed\"\n\
         source = \"a test\"\ndr_mm = {some:?}\ndl_mm = {some:?}\ndalpha_deg = {some:?}\n"
    );
    text
}

const WHOLE: [f64; 2] = [-180.0, 180.0];
const TURN: &str = "revolute";

/// Returns an arm with links of 600, 400 and 200 mm on a post of 700 mm and the tool along the last link.
fn planar(first: [f64; 2]) -> Robot {
    let rows = [
        (TURN, 0.0, 700.0, 0.0, 90.0, first),
        (TURN, 0.0, 0.0, 600.0, 0.0, WHOLE),
        (TURN, 0.0, 0.0, 400.0, 0.0, WHOLE),
        (TURN, 0.0, 0.0, 200.0, 0.0, WHOLE),
    ];
    robot(&rows, [1.0, 0.0, 0.0])
}

/// Returns a SCARA with links of 400 and 300 mm, a vertical slide with a travel of 200 mm, and the tool
/// pointing down.
fn scara(first: [f64; 2], second: [f64; 2]) -> Robot {
    let rows = [
        (TURN, 0.0, 800.0, 400.0, 0.0, first),
        (TURN, 0.0, 0.0, 300.0, 180.0, second),
        ("prismatic", 0.0, 100.0, 0.0, 0.0, [0.0, 200.0]),
        (TURN, 0.0, 0.0, 0.0, 0.0, [-360.0, 360.0]),
    ];
    robot(&rows, [0.0, 0.0, 1.0])
}

/// Returns the SCARA on a track of 1 000 mm along y with its post 800 mm high, in modified rows.
fn on_track() -> Robot {
    let rows = [
        ("prismatic", 0.0, 0.0, 0.0, -90.0, [-500.0, 500.0]),
        (TURN, 0.0, 800.0, 0.0, 90.0, WHOLE),
        (TURN, 0.0, 0.0, 400.0, 0.0, WHOLE),
        ("prismatic", 0.0, 100.0, 300.0, 180.0, [0.0, 200.0]),
        (TURN, 0.0, 0.0, 0.0, 0.0, [-360.0, 360.0]),
    ];
    read(&format!("convention = \"modified\"\n{}", text_of(&rows, [0.0, 0.0, 1.0])))
}

fn fine(step: f64) -> Fineness<'static> {
    Fineness { step, tolerance: 1e-5, on_progress: &|_| () }
}

fn inverse(robot: &Robot) -> Inverse {
    Inverse::new(&Chain::new(robot))
}

fn near(a: f64, b: f64, share: f64) -> bool {
    (a - b).abs() <= share * b.abs()
}

/// Returns whether a region contains a point, by the even-odd rule.
fn holds(region: &EnvelopeSection, p: [f64; 2]) -> bool {
    let mut inside = false;
    for outline in &region.outlines {
        let next = outline.points.iter().cycle().skip(1);
        for (a, b) in outline.points.iter().zip(next) {
            if (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
                inside = !inside;
            }
        }
    }
    inside
}

/// The annulus has the radii 200 and 1 000 mm. Its centre is 200 mm below the shoulder, because the tool
/// hangs down.
#[test]
fn the_envelope_of_a_planar_arm_is_its_annulus() {
    let arm = inverse(&planar(WHOLE));
    let envelope = Envelope::new(&arm, &Attitude::elevation(DOWN), 0.0);
    let section = envelope.section(0.3, &fine(0.01));
    assert_eq!(section.outlines.iter().map(|o| o.is_hole()).collect::<Vec<_>>(), [false, true]);
    assert!(near(section.area(), PI * (1.0 - 0.04), 2e-4), "{}", section.area());
    for [r, z] in section.points() {
        let from = r.hypot(z - 0.5);
        assert!((from - 1.0).abs() < 2e-5 || (from - 0.2).abs() < 2e-5, "({r}, {z}): {from}");
    }
    // The plan cuts the two spheres 0.1 m above their centre.
    let plan = envelope.plan(0.6, &fine(0.01));
    assert!(near(plan.area(), PI * (0.99 - 0.03), 3e-4), "{}", plan.area());
    assert!(envelope.plan(1.6, &fine(0.01)).is_empty());

    assert!(envelope.is_symmetric());
    let Size { volume, error, extent, symmetric } = envelope.size(&fine(0.01));
    let exact = 4.0 / 3.0 * PI * (1.0 - 0.008);
    assert!(symmetric && (volume - exact).abs() < error && near(volume, exact, 1e-3), "{volume} {error}");
    let extent = extent.unwrap();
    let want = [0.0, 1.0, -0.5, 1.5];
    let got = [extent.radius.0, extent.radius.1, extent.height.0, extent.height.1];
    assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-4), "{extent:?}");
    assert!((extent.widest - 0.5).abs() <= 0.01);
}

/// The tool at 30 degrees points outward or inward: the envelope is the union of two annuli.
#[test]
fn a_slanted_tool_has_two_annular_envelopes() {
    let arm = inverse(&planar(WHOLE));
    let elevation = -PI / 6.0;
    let envelope = Envelope::new(&arm, &Attitude::elevation(elevation), 0.0);
    let section = envelope.section(0.0, &fine(0.02));
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..20_000 {
        let (r, z) = (rng.random_range(-1.3..1.3), rng.random_range(-0.6..2.0));
        let wrists = [1.0, -1.0]
            .map(|s: f64| f64::hypot(r - s * 0.2 * elevation.cos(), z - 0.7 - 0.2 * elevation.sin()));
        let reached = wrists.iter().any(|d| (0.2..=1.0).contains(d));
        let edge = wrists.iter().any(|d| (d - 1.0).abs() < 0.005 || (d - 0.2).abs() < 0.005);
        assert!(edge || holds(&section, [r, z]) == reached, "({r}, {z})");
    }
}

/// Joint 1 turns from -60 to 75 degrees. An arm whose other joints turn fully can lean back and reach the
/// whole circle. An arm that reaches only forward leaves a wedge free.
#[test]
fn the_limits_of_joint_1_cut_a_wedge_from_the_envelope() {
    let mut robot = planar([-60.0, 75.0]);
    // The upper arm must not lean back.
    robot.joints[1].limits = (-0.2, FRAC_PI_2 - 0.5);
    let arm = inverse(&robot);
    let envelope = Envelope::new(&arm, &Attitude::elevation(DOWN), 0.0);
    let plan = envelope.plan(0.7, &fine(0.01));
    assert!(!plan.is_empty());
    for [x, y] in plan.points() {
        let azimuth = y.atan2(x).to_degrees();
        // The crossing is refined along one axis, so its error is a large angle near the base.
        let slack = (2e-5_f64 / x.hypot(y)).to_degrees() + 1e-9;
        assert!(azimuth > -60.0 - slack && azimuth < 75.0 + slack, "({x}, {y}): {azimuth}");
    }
    // The volume by angles equals the volume of stacked horizontal sections.
    let Size { volume, error, symmetric, .. } = envelope.size(&fine(0.01));
    let heights = (0..180).map(|k| -0.6 + 0.0125 * (f64::from(k) + 0.5));
    let stacked: f64 = heights.map(|z| 0.0125 * envelope.plan(z, &fine(0.02)).area()).sum();
    assert!(symmetric && (volume - stacked).abs() < error + 2e-3 * stacked, "{volume} {error} {stacked}");
}

/// A lattice of 50 mm gives the extremes of random two-link arms to 0.1 mm. The reference is a dense scan of
/// both joint angles.
#[test]
fn the_extent_of_a_coarse_lattice_is_refined() {
    const PARTS: usize = 1500;
    let mut rng = ChaCha8Rng::seed_from_u64(16);
    let mut worst = 0.0f64;
    for _ in 0..12 {
        let mut limits = || {
            let low = rng.random_range(-170.0_f64..100.0);
            (low.to_radians(), rng.random_range(low + 40.0..175.0).to_radians())
        };
        let mut robot = planar(WHOLE);
        (robot.joints[1].limits, robot.joints[2].limits) = (limits(), limits());
        let (arm, [first, second]) = (inverse(&robot), [1, 2].map(|k| robot.joints[k].limits));
        let envelope = Envelope::new(&arm, &Attitude::elevation(DOWN), 0.0);
        let extent =
            envelope.size(&Fineness { step: 0.05, tolerance: 1e-4, on_progress: &|_| () }).extent.unwrap();
        let part = |(low, high): (f64, f64), k: usize| low + (high - low) * k as f64 / PARTS as f64;
        let mut want = [f64::INFINITY, 0.0, f64::INFINITY, f64::NEG_INFINITY];
        for a in (0..=PARTS).map(|k| part(first, k)) {
            let mut before = None;
            for b in (0..=PARTS).map(|k| a + part(second, k)) {
                let r = 0.6 * a.cos() + 0.4 * b.cos();
                // Between two neighbouring points on opposite sides of the axis, the arm crosses the axis.
                let is_crossed = before.replace(r).is_some_and(|before| before * r <= 0.0);
                let (r, z) = (if is_crossed { 0.0 } else { r.abs() }, 0.5 + 0.6 * a.sin() + 0.4 * b.sin());
                want = [want[0].min(r), want[1].max(r), want[2].min(z), want[3].max(z)];
            }
        }
        let got = [extent.radius.0, extent.radius.1, extent.height.0, extent.height.1];
        let off = got.iter().zip(want).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < extent.within, "{extent:?} {want:?} {first:?} {second:?}");
        worst = worst.max(off);
    }
    println!("largest deviation {:.4} mm", 1e3 * worst);
}

/// With both elbows, the area is the area of the annulus. Here joint 2 stays on one side, and joint 1 has a
/// range of width w. The arm then sweeps the area w / 2 (R^2 - r^2), where R and r are the radii at the two
/// limits of joint 2.
#[test]
fn the_envelope_of_a_scara_has_its_area() {
    let (l1, l2) = (0.4_f64, 0.3_f64);
    let radius2 = |q2: f64| l1 * l1 + l2 * l2 + 2.0 * l1 * l2 * q2.cos();
    let (w, ends) = (200.0_f64, [20.0_f64, 140.0]);
    let arm = inverse(&scara([-100.0, 100.0], ends));
    assert!(arm.family().starts_with("SCARA"), "{}", arm.family());
    let envelope = Envelope::new(&arm, &Attitude::elevation(DOWN), 0.0);
    let exact = w.to_radians() / 2.0 * (radius2(ends[0].to_radians()) - radius2(ends[1].to_radians()));
    // The flange is 100 to 300 mm below 800 mm.
    let plan = envelope.plan(0.6, &fine(0.005));
    assert!(near(plan.area(), exact, 1e-3), "{} {exact}", plan.area());
    assert!(envelope.plan(0.75, &fine(0.02)).is_empty() && envelope.plan(0.45, &fine(0.02)).is_empty());

    // A fixed spin is measured from the x axis. The envelope is therefore counted in x, y and z.
    let fixed = Attitude { spin: Spin::At(vec![0.0]), ..Attitude::elevation(DOWN) };
    let fixed = Envelope::new(&arm, &fixed, 0.0);
    assert!(!fixed.is_symmetric());
    let counted = fixed.size(&fine(0.04));
    let volume = exact * 0.2;
    assert!(!counted.symmetric && near(counted.volume, volume, 0.03), "{counted:?}");
    // The last joint provides every spin, so the range of joint 1 does not matter.
    let turned = envelope.size(&fine(0.005));
    assert!(turned.symmetric && near(turned.volume, volume, 0.01), "{turned:?} {volume}");
    let radial = Attitude { azimuth: Azimuth::Radial, ..Attitude::elevation(DOWN) };
    assert!(Envelope::new(&arm, &radial, 0.0).is_symmetric());
    let tilted = Attitude { tolerance: 0.1, ..Attitude::elevation(DOWN) };
    assert!(!Envelope::new(&arm, &tilted, 0.0).is_symmetric());
    let extent = turned.extent.unwrap();
    let want = [radius2(ends[1].to_radians()).sqrt(), radius2(ends[0].to_radians()).sqrt(), 0.5, 0.7];
    let got = [extent.radius.0, extent.radius.1, extent.height.0, extent.height.1];
    assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < extent.within), "{extent:?} {want:?}");
}

/// Just inside every crossing, a branch stays within all limits. Just outside, no branch stays within all
/// limits.
#[test]
fn every_boundary_crossing_of_the_hitachi_is_real() {
    for name in ["hitachi_paper.toml", "hitachi_paper_parallelogram.toml"] {
        let robot = shipped(name).robot;
        let arm = inverse(&robot);
        let attitude = Attitude::elevation(DOWN);
        let envelope = Envelope::new(&arm, &attitude, 0.0);
        let approach = arm.tool_attitudes(&attitude, 0.0);
        let usable = |target: &Vector3<f64>| match arm.branches(target, &approach) {
            Reach::Branches(all) => all.iter().any(Branch::is_usable),
            _ => false,
        };
        let azimuth = envelope.middle();
        assert!((azimuth - FRAC_PI_2).abs() < 1e-12);
        let place = |[r, z]: [f64; 2]| vector![0.0, r, z];
        let (step, tolerance) = (0.02, 1e-5);
        let section = envelope.section(azimuth, &fine(step));
        let mut count = 0;
        for p in section.points() {
            // The crossing lies on a grid line, along which it was refined.
            let line = |v: f64| ((v / step - 0.5).round() - (v / step - 0.5)).abs() < 1e-9;
            let axis = if line(p[0]) { 1 } else { 0 };
            assert!(line(p[1 - axis]), "{p:?} lies on no line");
            let moved = [1.0, -1.0].map(|s| {
                let mut to = p;
                to[axis] += s * tolerance;
                usable(&place(to))
            });
            assert!(moved[0] != moved[1], "{name} {p:?}: {moved:?}");
            count += 1;
        }
        assert!(count > 100, "{count}");
        let by_polygon = (0..4000).filter(|k| {
            let p = [-1.7 + 0.00085 * f64::from(*k), 0.4 + 0.3 * f64::from(*k % 7)];
            holds(&section, p) != usable(&place(p))
        });
        // Corners between the grid lines are cut.
        assert!(by_polygon.count() < 40);
    }
}

/// Returns the volume of the envelope from seeded random points of a box, and the standard error of the
/// volume.
fn monte_carlo(envelope: &Envelope<'_>, low: [f64; 3], high: [f64; 3], n: u32) -> (f64, f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let hits = (0..n).filter(|_| {
        let p: [f64; 3] = std::array::from_fn(|k| rng.random_range(low[k]..high[k]));
        envelope.contains(&Vector3::from(p))
    });
    let share = hits.count() as f64 / f64::from(n);
    let all: f64 = (0..3).map(|k| high[k] - low[k]).product();
    (all * share, all * (share * (1.0 - share) / f64::from(n)).sqrt())
}

#[test]
fn the_envelope_volume_agrees_with_monte_carlo() {
    let hitachi = shipped("hitachi_paper.toml").robot;
    let arm = inverse(&hitachi);
    let attitudes = [
        Attitude::elevation(DOWN),
        Attitude::elevation(-0.6),
        Attitude { azimuth: Azimuth::Radial, ..Attitude::elevation(0.0) },
    ];
    for attitude in attitudes {
        let envelope = Envelope::new(&arm, &attitude, 0.0);
        let size = envelope.size(&fine(0.01));
        let (counted, deviation) = monte_carlo(&envelope, [-2.0, -2.0, -1.2], [2.0, 2.0, 2.7], 400_000);
        let off = (size.volume - counted).abs();
        assert!(size.symmetric && off < size.error + 3.0 * deviation, "{size:?} {counted} {deviation}");
    }
}

/// Joint 1 of these arms has a range of less than one turn, and its axis points up or down. The last joint
/// provides the spin, so the size is integrated over radius and height. A last joint with a range of less
/// than the distance between sampled spins does not provide the spin in every posture.
#[test]
fn the_envelope_volume_of_a_six_axis_arm_agrees_with_monte_carlo() {
    for (name, low, high) in [
        ("puma560.toml", [-0.9, -0.9, -0.2], [0.9, 0.9, 1.2]),
        ("kuka_kr6_r900.toml", [-1.0, -1.0, -0.5], [1.0, 1.0, 1.1]),
    ] {
        let file = root().join("cells/robots").join(name);
        let mut robot = read(&std::fs::read_to_string(file).unwrap());
        let first = robot.joints[0].limits;
        assert!(first.1 - first.0 < TAU);
        let attitude = Attitude::elevation(DOWN);
        let arm = inverse(&robot);
        let envelope = Envelope::new(&arm, &attitude, 0.0);
        let size = envelope.size(&fine(0.02));
        let (counted, deviation) = monte_carlo(&envelope, low, high, 100_000);
        let off = (size.volume - counted).abs();
        assert!(
            size.symmetric && off < size.error + 3.0 * deviation,
            "{name}: {size:?} {counted} {deviation}"
        );

        robot.joints[5].limits = (-0.1, 0.1);
        let held = inverse(&robot);
        let envelope = Envelope::new(&held, &attitude, 0.0);
        assert!(!envelope.is_symmetric());
        let (fewer, deviation) = monte_carlo(&envelope, low, high, 100_000);
        assert!(fewer + 3.0 * deviation < counted, "{name}: {fewer} {counted}");
    }
}

/// The envelope is the disc of the SCARA (radius 700 mm), swept 1 m along y. The sweep fills the hole around
/// the post of the arm.
#[test]
fn a_track_lengthens_the_envelope() {
    let arm = inverse(&on_track());
    // The spin does not matter here.
    let attitude = Attitude { spin: Spin::At(vec![0.0]), ..Attitude::elevation(DOWN) };
    let envelope = Envelope::new(&arm, &attitude, 0.0);
    // Every target takes 25 times as long here.
    let coarse = |step: f64| Fineness { step, tolerance: 2e-3, on_progress: &|_| () };
    let plan = envelope.plan(0.6, &coarse(0.08));
    let exact = PI * 0.49 + 1.4;
    assert!(near(plan.area(), exact, 0.02), "{} {exact}, {}", plan.area(), arm.family());
    let Size { volume, error, symmetric, extent } = envelope.size(&coarse(0.1));
    let exact = 0.2 * exact;
    assert!(
        !symmetric && (volume - exact).abs() < error + 0.02 * exact,
        "{volume} {error} {exact} {extent:?}"
    );
    let extent = extent.unwrap();
    assert!((extent.radius.1 - 1.2).abs() < extent.within, "{extent:?}");
}

/// Every TCP that a posture inside the limits reaches lies in the shell.
#[test]
fn the_reach_shell_contains_every_tcp() {
    let data = |name: &str| {
        let folder = root().join("tests/data");
        crate::common::load_from(&folder, name).unwrap_or_else(|f| panic!("{f:#?}")).cell.robot
    };
    let mut tilted = data("puma560.toml");
    tilted.tool.translation = vector![0.05, -0.02, 0.15];
    tilted.tool_axis = vector![0.6, 0.0, 0.8];
    let robots = [
        shipped("hitachi_paper.toml").robot,
        planar([-60.0, 75.0]),
        scara([-100.0, 100.0], [20.0, 140.0]),
        on_track(),
        data("ur5.toml"),
        data("puma560.toml"),
        tilted,
    ];
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut tightest = Vec::new();
    for robot in &robots {
        let chain = Chain::new(robot);
        let arm = Inverse::new(&chain);
        let (mut far, mut close): (f64, f64) = (0.0, f64::INFINITY);
        for _ in 0..100_000 {
            let mut q = [0.0; cell::MAX_JOINTS];
            for (q, joint) in q.iter_mut().zip(&robot.joints) {
                *q = rng.random_range(joint.limits.0..=joint.limits.1);
            }
            let tcp = chain.forward(&chain.posture(&q));
            let axis = tcp.rotation * chain.tool_axis;
            let attitude = Attitude::elevation(axis.z.atan2(axis.x.hypot(axis.y)));
            let shell = arm.shell(&attitude);
            let from = (tcp.translation - shell.centre).norm();
            assert!(shell.gap(from, from) == 0.0, "{} {q:?}: {from} {shell:?}", robot.name);
            far = far.max(from / shell.outer);
            close = close.min((from - shell.inner) / shell.outer);
        }
        tightest.push((far, close));
    }
    // The shell is not much larger than necessary.
    assert!(tightest.iter().all(|(far, _)| *far > 0.6), "{tightest:?}");
    assert!(tightest[0].1 < 0.35, "{tightest:?}");
}

/// The shell gives a lower bound of the distance to a target outside the shell.
#[test]
fn the_reach_shell_gives_the_distance_outside() {
    let arm = inverse(&planar(WHOLE));
    let shell = arm.shell(&Attitude::elevation(DOWN));
    assert!((shell.centre - vector![0.0, 0.0, 0.5]).norm() < 1e-12, "{shell:?}");
    assert!((shell.outer - 1.0).abs() < 2e-6 && (shell.inner - 0.2).abs() < 2e-6, "{shell:?}");
    assert!((shell.gap(1.5, 2.0) - 0.5).abs() < 2e-6);
    assert!((shell.gap(0.0, 0.15) - 0.05).abs() < 2e-6);
    assert_eq!(shell.gap(0.0, 3.0), 0.0);
}

/// Returns the shipped cell with the worktable operation and a SCARA. The inverse kinematics of this arm is
/// slow, so unreachable layouts are found before the node loop.
fn scara_cell() -> Cell {
    let mut cell = shipped("hitachi_cell.toml");
    cell.robot = scara([-100.0, 100.0], [20.0, 140.0]);
    (cell.errors, cell.collision) = (0, false);
    cell.operations.truncate(1);
    cell
}

/// The map visits every node of every layout. The evaluation discards no node that the map finds usable, and
/// all values are equal to the bit.
#[test]
fn the_reach_shell_changes_no_objective() {
    let workcell = Workcell::new(scara_cell()).unwrap();
    assert_ne!(workcell.inverse().cost(), sweetspot::reach::Cost::Low);
    let shell = workcell.inverse().shell(&workcell.cell.operations[0].attitude);
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (mut found, mut lost) = (0, 0);
    for _ in 0..1000 {
        let mut layout = workcell.cell.start();
        let mut about = |size: f64| rng.random_range(-size..size);
        layout.placements[0] =
            Placement { x: about(1.8), y: about(1.8), z: 0.5 + about(0.4), yaw: about(PI) };
        let evaluation = evaluate(&workcell, &layout);
        let map = &workcell.maps(&layout)[0];
        match (evaluation.outcomes[0], map.spot()) {
            (Outcome::Found(spot), Some(of_map)) => {
                assert_eq!(spot.value.to_bits(), of_map.value.to_bits());
                found += 1;
            }
            (Outcome::Unreachable { gap }, None) => {
                assert!(gap.reach > 0.0 || gap.limits > 0.0, "{gap:?}");
                let near = map.nodes.iter().map(|n| (n.position - shell.centre).norm());
                let discarded = near.fold(f64::INFINITY, f64::min) > shell.outer;
                lost += usize::from(discarded);
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(found > 50 && lost > 50, "{found} found, {lost} discarded");
}

/// The penalty grows with the distance of the target, also across the edge of the shell. This leads the
/// search back to feasible layouts.
#[test]
fn the_penalty_grows_with_the_distance() {
    let workcell = Workcell::new(scara_cell()).unwrap();
    let mut before = 0.0;
    for k in 0..60 {
        let mut layout = workcell.cell.start();
        layout.placements[0] = Placement { x: 1.2 + 0.05 * f64::from(k), y: 0.1, z: 0.5, yaw: 0.3 };
        let evaluation = evaluate(&workcell, &layout);
        let Outcome::Unreachable { gap } = evaluation.outcomes[0] else { continue };
        assert!(gap.reach > 0.0 && evaluation.cost > before, "{k}: {gap:?} {before}");
        before = evaluation.cost;
    }
    assert!(before > 0.0);
}
