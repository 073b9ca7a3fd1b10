//! Tests round trips of the frames for robot controllers. The text is read back with the formula of each
//! manufacturer.

use nalgebra::{Matrix3, Vector3};
use sweetspot::pose::Pose;
use sweetspot::report::controller::{Controller, file};
use sweetspot::report::layout_frames::{LayoutFrames, NamedFrame, SpotFrame};

/// Largest errors of a position (m) and of an element of a rotation matrix.
const ERRORS: (f64, f64) = (6e-8, 2e-8);

/// Returns the rotation matrix about a coordinate axis.
fn about(axis: usize, angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    match axis {
        0 => Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c),
        1 => Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c),
        _ => Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0),
    }
}

/// Returns the rotation by a rotation vector, by Rodrigues' formula.
fn rodrigues(v: Vector3<f64>) -> Matrix3<f64> {
    let angle = v.norm();
    if angle == 0.0 {
        return Matrix3::identity();
    }
    let k = (v / angle).cross_matrix();
    Matrix3::identity() + k * angle.sin() + k * k * (1.0 - angle.cos())
}

/// Returns the rotation matrix of a unit quaternion.
fn of_quaternion([w, x, y, z]: [f64; 4]) -> Matrix3<f64> {
    Matrix3::new(
        w * w + x * x - y * y - z * z,
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        w * w - x * x + y * y - z * z,
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        w * w - x * x - y * y + z * z,
    )
}

/// Returns all numbers of a text, in order.
fn numbers(text: &str) -> Vec<f64> {
    let words = text.split(|c: char| !c.is_ascii_digit() && !"-.".contains(c));
    words.filter_map(|word| word.parse().ok()).collect()
}

/// Reads the pose that a line of a controller file states, m.
fn read(controller: Controller, line: &str) -> Pose {
    let mm = |v: &[f64]| Vector3::new(v[0], v[1], v[2]) / 1000.0;
    match controller {
        Controller::Krl => {
            let v = numbers(line.split_once("={").unwrap().1);
            let [a, b, c] = [v[3], v[4], v[5]].map(f64::to_radians);
            Pose { translation: mm(&v), rotation: about(2, a) * about(1, b) * about(0, c) }
        }
        Controller::Rapid => {
            let v = numbers(line.split_once("[[").unwrap().1);
            Pose { translation: mm(&v), rotation: of_quaternion([v[3], v[4], v[5], v[6]]) }
        }
        Controller::UrScript => {
            let v = numbers(line.split_once("p[").unwrap().1);
            let rotation = rodrigues(Vector3::new(v[3], v[4], v[5]));
            Pose { translation: Vector3::new(v[0], v[1], v[2]), rotation }
        }
        Controller::Fanuc => {
            let v = numbers(line.split_once("] X").unwrap().1);
            // The axes are fixed, so the first rotation is the rightmost factor.
            let [w, p, r] = [v[3], v[4], v[5]].map(f64::to_radians);
            Pose { translation: mm(&v), rotation: about(2, r) * about(1, p) * about(0, w) }
        }
    }
}

/// Returns rotations with all signs and sizes of angles, including gimbal lock and angles near it.
fn rotations() -> Vec<Matrix3<f64>> {
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut all = Vec::new();
    for yaw in [-3.0, -quarter, 0.0, 0.4, 2.0 * quarter] {
        for roll in [-2.0, 0.0, 1.0, quarter, 2.0 * quarter] {
            for pitch in [-quarter, -1.2, 0.0, 1e-9, 0.7, quarter - 1e-7, quarter - 1e-10, quarter, 1.9] {
                all.push(about(2, yaw) * about(1, pitch) * about(0, roll));
            }
        }
    }
    // Right angles give matrices with the exact elements -1, 0 and 1.
    all.push(Matrix3::new(0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0));
    all.push(Matrix3::new(0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0));
    all.push(Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)));
    all.push(Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, -1.0)));
    all
}

fn far(a: &Pose, b: &Pose) -> (f64, f64) {
    ((a.translation - b.translation).amax(), (a.rotation - b.rotation).amax())
}

/// Returns frames in which equipment `k` has rotation `k` and a spot. The base is rotated and displaced.
fn frames() -> LayoutFrames {
    let base = Pose { rotation: about(2, 0.3), translation: Vector3::new(-0.5, 1.25, 0.8) };
    let turns = rotations();
    let place = |k: usize| Vector3::new(1.234_567_8, -0.1 * k as f64, 1e-6 * k as f64);
    let equipment = turns.iter().enumerate().map(|(k, turn)| NamedFrame {
        name: format!("Tisch \u{e4} {k}"),
        pose: base * Pose { rotation: *turn, translation: place(k) },
    });
    let equipment: Vec<NamedFrame> = equipment.collect();
    let spot = |k: usize| SpotFrame {
        operation: format!("{k} drill"),
        equipment: k,
        tcp: equipment[k].pose * Pose { rotation: turns[turns.len() - 1 - k], translation: place(k + 7) },
    };
    let spots = (0..turns.len()).map(spot).collect();
    LayoutFrames {
        cell: "cell ; ! # \u{20ac}".into(),
        robot: "arm".into(),
        layout: "best layout".into(),
        warning: None,
        base,
        equipment,
        spots,
        spotless: vec!["welding".into()],
    }
}

#[test]
fn every_pose_is_read_back_by_the_formula_of_the_controller() {
    let frames = frames();
    let (base, count) = (frames.base, frames.equipment.len());
    for (controller, marks) in [
        (Controller::Krl, ["FRAME base_", "FRAME spot_"]),
        (Controller::Rapid, ["wobjdata wobj_", "pose spot_"]),
        (Controller::UrScript, ["global feature_", "global spot_"]),
        (Controller::Fanuc, ["UFRAME[", "spot in UFRAME["]),
    ] {
        let text = file(controller, "2 cells", &frames);
        assert!(text.is_ascii(), "{controller:?}");
        let of = |mark: &str| {
            let has = |l: &&str| {
                if controller == Controller::Fanuc { l.starts_with(mark) } else { l.contains(mark) }
            };
            text.lines().filter(has).map(str::to_string).collect::<Vec<_>>()
        };
        let (works, spots) = (of(marks[0]), of(marks[1]));
        assert_eq!((works.len(), spots.len()), (count, count), "{controller:?}");
        for k in 0..count {
            // The base frame is rotated. The expected poses are products of matrices, without code of the
            // exporter.
            let inverse = Pose {
                rotation: base.rotation.transpose(),
                translation: -(base.rotation.transpose() * base.translation),
            };
            for (line, pose) in [
                (&works[k], inverse * frames.equipment[k].pose),
                (&spots[k], frames.equipment[k].pose.inverse() * frames.spots[k].tcp),
            ] {
                let (position, rotation) = far(&read(controller, line), &pose);
                assert!(position < ERRORS.0 && rotation < ERRORS.1, "{position} {rotation} {line}");
            }
        }
    }
}

#[test]
fn identifiers_differ_and_comments_state_origin_and_convention() {
    let mut frames = frames();
    frames.equipment[1].name = frames.equipment[0].name.to_uppercase();
    let krl = file(Controller::Krl, "2 cells", &frames);
    assert!(krl.starts_with("DEFDAT cell_2_cells PUBLIC\r\n; ") && krl.ends_with("ENDDAT\r\n"), "{krl}");
    assert!(krl.contains("under the name cell_2_cells.dat") && krl.contains("base_TISCH___0_2={X"), "{krl}");
    let mut words: Vec<_> =
        krl.split("GLOBAL FRAME ").skip(1).map(|l| l.split('=').next().unwrap()).collect();
    let count = words.len();
    words.sort_unstable();
    words.dedup();
    assert!(words.len() == count && words.iter().all(|w| w.len() <= 24));
    for controller in [Controller::Krl, Controller::Rapid, Controller::UrScript, Controller::Fanuc] {
        let text = file(controller, "cells", &frames);
        for said in [
            "cell: cell ; ! # ?",
            "layout: best layout",
            "robot: arm",
            "welding has no spot",
            " mm",
            "ISO 9787",
        ] {
            let said =
                if controller == Controller::UrScript { said.replace(" mm", " m,") } else { said.into() };
            assert!(text.contains(&said), "{controller:?} lacks {said}: {text}");
        }
    }
    assert!(
        file(Controller::Fanuc, "c", &frames)
            .contains("UFRAME is relative to the world frame of the controller")
    );
}
