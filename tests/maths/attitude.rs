//! Tests the attitude of the tool (elevation, azimuth, spin and tolerance) in the postures that are found.

use crate::common::{from_text, robots};
use nalgebra::Vector3;
use sweetspot::cell::{Attitude, Azimuth, Robot, Spin};
use sweetspot::error_map::Status;
use sweetspot::layout::Workcell;
use sweetspot::reach::{Inverse, Reach};
use sweetspot::robot::Chain;
use sweetspot::units::wrapped;

fn robot(stem: &str) -> Robot {
    robots().into_iter().find(|(name, _)| name == stem).unwrap().1
}

/// Returns elevation, azimuth and spin of a tool from its axis and its reference axis (TCP z and x here). The
/// spin is measured from the upright direction by spherical trigonometry, without frames.
fn angles(d: &Vector3<f64>, r: &Vector3<f64>) -> (f64, f64, f64) {
    let elevation = d.z.clamp(-1.0, 1.0).asin();
    let azimuth = d.y.atan2(d.x);
    // The vertical component of r is cos(spin) cos(elevation); the component along `level` is sin(spin).
    let level = Vector3::new(d.y, -d.x, 0.0).normalize();
    (elevation, azimuth, r.dot(&level).atan2(r.z / elevation.cos()))
}

/// Returns the target, the tool axis and the reference axis of every usable posture at some targets around
/// the arm.
fn held(robot: &Robot, attitude: &Attitude, yaw: f64) -> Vec<(Vector3<f64>, Vector3<f64>, Vector3<f64>)> {
    let chain = Chain::new(robot);
    let inverse = Inverse::new(&chain);
    assert_eq!(inverse.refusal(attitude), None);
    let approach = inverse.tool_attitudes(attitude, yaw);
    let mut all = Vec::new();
    for k in 0..60 {
        let (angle, radius) = (f64::from(k) * 0.7, 0.35 + 0.005 * f64::from(k));
        let target = Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.3);
        let Reach::Branches(branches) = inverse.branches(&target, &approach) else { continue };
        for b in branches.iter().filter(|b| b.is_usable()) {
            let tcp = chain.forward(&chain.posture(&b.joints));
            assert!((tcp.translation - target).norm() < 1e-9);
            all.push((target, tcp.rotation.column(2).into_owned(), tcp.rotation.column(0).into_owned()));
        }
    }
    assert!(all.len() > 20, "{} postures", all.len());
    all
}

fn attitude(elevation: f64, azimuth: Azimuth, spins: &[f64], tolerance: f64) -> Attitude {
    Attitude { elevation, azimuth, spin: Spin::At(spins.to_vec()), tolerance }
}

#[test]
fn six_axis_arms_hold_the_requested_tool_orientation() {
    let robot = robot("abb_irb140");
    let spins = [0.4, 2.0];
    for (d, r) in
        held(&robot, &attitude(-0.9, Azimuth::Surface(0.5), &spins, 0.0), 0.3).iter().map(|h| (h.1, h.2))
    {
        let (elevation, azimuth, spin) = angles(&d, &r);
        assert!((elevation + 0.9).abs() < 1e-9 && wrapped(azimuth - 0.8).abs() < 1e-9, "{d:?}");
        assert!(spins.iter().any(|s| wrapped(spin - s).abs() < 1e-8), "spin {spin}");
    }
    let (mut out, mut inward) = (0, 0);
    for (target, d, r) in held(&robot, &attitude(-0.9, Azimuth::Radial, &[0.4], 0.0), 0.3) {
        let (_, azimuth, spin) = angles(&d, &r);
        let off = wrapped(azimuth - target.y.atan2(target.x)).abs();
        assert!(off < 1e-9 || (off - std::f64::consts::PI).abs() < 1e-9, "{off}");
        assert!(wrapped(spin - 0.4).abs() < 1e-8);
        if off < 1.0 { out += 1 } else { inward += 1 }
    }
    assert!(out > 0 && inward > 0, "{out} outward, {inward} inward");
}

/// If the tool points down with spin 0, its reference axis lies along the azimuth.
#[test]
fn spins_of_a_vertical_tool_count_from_the_azimuth() {
    let down = -std::f64::consts::FRAC_PI_2;
    for stem in ["abb_irb140", "kuka_youbot", "ur5e", "franka_panda"] {
        let robot = robot(stem);
        if robot.reach() < 0.6 {
            continue;
        }
        for (_, d, r) in held(&robot, &attitude(down, Azimuth::Surface(0.5), &[0.25], 0.0), 0.3) {
            // The tool axis points down, so a positive spin is clockwise when seen from above.
            let along = Vector3::new(f64::cos(0.8 - 0.25), f64::sin(0.8 - 0.25), 0.0);
            assert!((d + Vector3::z()).norm() < 1e-9 && (r - along).norm() < 1e-8, "{stem}: {d:?} {r:?}");
        }
    }
}

#[test]
fn an_attitude_tolerance_tilts_the_tool_up_to_its_limit() {
    let robot = robot("abb_irb140");
    let wanted = Vector3::new(f64::cos(-0.9) * f64::cos(0.8), f64::cos(-0.9) * f64::sin(0.8), f64::sin(-0.9));
    let tilts = held(&robot, &attitude(-0.9, Azimuth::Surface(0.5), &[0.0], 0.1), 0.3);
    let tilts: Vec<f64> = tilts.iter().map(|(_, d, _)| d.dot(&wanted).clamp(-1.0, 1.0).acos()).collect();
    assert!(tilts.iter().all(|tilt| *tilt < 0.1 + 1e-7));
    for (low, high) in [(0.0, 1e-6), (0.09, 0.11)] {
        assert!(tilts.iter().any(|tilt| (low..high).contains(tilt)), "none from {low} to {high}");
    }
}

#[test]
fn an_orientation_beyond_the_arm_is_refused_with_the_reason() {
    let told = |stem: &str, attitude: Attitude| Inverse::new(&Chain::new(&robot(stem))).refusal(&attitude);
    let level = || Attitude::elevation(0.0);
    for stem in ["adept_cobra_s600", "abb_irb460"] {
        assert!(
            told(stem, level()).unwrap().contains("always holds its tool at an elevation of -90 deg"),
            "{stem}"
        );
        assert_eq!(told(stem, Attitude::elevation(-std::f64::consts::FRAC_PI_2)), None);
    }
    for stem in ["hitachi_pw10", "kuka_youbot"] {
        let fixed = || Attitude { azimuth: Azimuth::Surface(0.1), ..level() };
        assert!(
            told(stem, fixed()).unwrap().contains("joint 1 of the arm determines the azimuth of the tool"),
            "{stem}"
        );
        assert_eq!(told(stem, Attitude { tolerance: 0.2, ..fixed() }), None);
        assert_eq!(told(stem, Attitude { azimuth: Azimuth::Radial, ..level() }), None);
    }
    let spun = Attitude { spin: Spin::At(vec![0.0]), ..level() };
    assert!(told("hitachi_pw10", spun.clone()).unwrap().contains("no joint of the arm rotates the tool"));
    assert_eq!(told("kuka_youbot", spun.clone()), None);
    assert_eq!(told("ur10", Attitude { azimuth: Azimuth::Surface(0.1), ..spun }), None);
}

/// The base joint determines the azimuth of the paper's arm. If another azimuth is requested, a node misses
/// the orientation by the remaining angle.
#[test]
fn an_arm_that_cannot_turn_its_tool_reports_the_missing_azimuth_angle() {
    let cell = "from = \"hitachi_paper.toml\"\n[operation.map]\nbend_deg = -45\nazimuth_deg = 90\ntolerance_deg = 10\n";
    let name = crate::common::shipped("hitachi_paper.toml").operations[0].name.clone();
    let cell = from_text(&cell.replace("operation.map", &format!("operation.{name}"))).unwrap().cell;
    let workcell = Workcell::new(cell).unwrap();
    let layout = workcell.cell.start();
    let (at, base) = (layout.placements[0], layout.base);
    let map = &workcell.maps(&layout)[0];
    let (mut missed, mut kept) = (0, 0);
    for node in &map.nodes {
        let p = node.position - Vector3::new(base.x, base.y, base.z);
        let off = wrapped(p.y.atan2(p.x) - at.yaw - std::f64::consts::FRAC_PI_2).abs();
        // The tool points outward or inward.
        let off = off.min(std::f64::consts::PI - off) - 10f64.to_radians();
        match node.status {
            Status::Attitude { by, .. } => {
                missed += 1;
                assert!((by - off).abs() < 1e-9, "{by} for {off}");
                assert!(node.status.reason(&workcell.cell).contains("attitude is missed by"));
            }
            Status::Ok => {
                kept += 1;
                assert!(off < 1e-8, "{off}");
            }
            _ => {}
        }
    }
    assert!(missed > 5 && kept > 5, "{missed} missed, {kept} kept");
}
