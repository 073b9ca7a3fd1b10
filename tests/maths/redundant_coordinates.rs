//! Tests the refinement of postures along the coordinates that a task leaves free (redundant joint and free
//! spin) against a fine scan of these coordinates.

use crate::common::{buildable, cases, shipped};
use nalgebra::{Matrix3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use sweetspot::cell::{Attitude, Cell, Layout, MAX_JOINTS, Placement, Spin};
use sweetspot::layout::{HeldLayout, HeldMemory, Workcell};
use sweetspot::pose::Pose;
use sweetspot::reading::{WorkContext, WorkFrame};
use sweetspot::robot::Frames;

/// Arm with redundant coordinates, and the number of values that the fine scan tries.
struct FreeArm {
    name: &'static str,
    cell: Cell,
    /// Index of the redundant joint, and the number of its values.
    redundant: Option<(usize, usize)>,
    /// Number of spins; 0 if the spins of the cell are tried.
    spins: usize,
}

impl FreeArm {
    /// Returns the least value of an operation over all values of the fine scan. `target` is the position of
    /// the TCP in the base frame, m.
    fn scanned(&self, workcell: &Workcell, k: usize, target: &Vector3<f64>, at: &Placement) -> f64 {
        let (cell, evaluator) = (&workcell.cell, workcell.evaluator(k));
        let operation = &cell.operations[k];
        let spins = (0..self.spins).map(|k| TAU * k as f64 / self.spins as f64).collect::<Vec<_>>();
        let spin = if spins.is_empty() { operation.attitude.spin.clone() } else { Spin::At(spins) };
        let attitude = Attitude { spin, ..operation.attitude.clone() };
        let work = Pose { translation: Vector3::new(at.x, at.y, at.z), ..Pose::identity() };
        let site =
            WorkFrame { equipment: operation.equipment, work, world: Matrix3::identity(), taught: None };
        let context = WorkContext { site, reference: None };
        let (mut memory, mut frames, mut least) = (evaluator.memory(), Frames::default(), f64::INFINITY);
        let (joint, count) = self.redundant.unwrap_or((0, 1));
        for value in 0..count {
            let mut q = [0.0; MAX_JOINTS];
            let (low, high) = cell.robot.joints[joint].limits;
            q[joint] = low + (high - low) * value as f64 / (count - 1).max(1) as f64;
            let inverse = workcell.inverse().held_at(&q);
            let attitudes = inverse.tool_attitudes(&attitude, at.yaw);
            let mut scratch = inverse.scratch();
            inverse.visit(target, &attitudes, &mut scratch, |_, posture| {
                evaluator.chain().place(posture, &mut frames);
                least = least.min(evaluator.value(&context, &frames, &mut memory));
            });
        }
        least
    }

    /// Returns a random layout near the start.
    fn layout(&self, rng: &mut ChaCha8Rng) -> Layout {
        let mut layout = self.cell.start();
        for at in &mut layout.placements {
            at.x += rng.random_range(-0.3..0.3);
            at.y += rng.random_range(-0.3..0.3);
            at.yaw += rng.random_range(-0.5..0.5);
        }
        layout
    }
}

/// Returns a shipped cell without collisions, with the base of the robot without yaw and with a tool of the
/// given length (m) whose TCP is `beside` (m) its axis.
fn free_cell(name: &str, beside: Option<(f64, f64)>, spin_is_free: bool) -> Cell {
    let mut cell = shipped(name);
    cell.collision = false;
    if let Some((beside, length)) = beside {
        cell.robot.tool.translation = Vector3::new(beside, 0.0, length);
    }
    for operation in &mut cell.operations {
        if spin_is_free {
            operation.attitude.spin = Spin::Free;
        }
    }
    cell
}

fn arms() -> Vec<FreeArm> {
    let beside = Some((0.08, 0.15));
    vec![
        FreeArm {
            name: "panda",
            cell: free_cell("panda_cell.toml", None, false),
            redundant: Some((6, 721)),
            spins: 0,
        },
        FreeArm {
            name: "track",
            cell: free_cell("track_cell.toml", None, false),
            redundant: Some((0, 721)),
            spins: 0,
        },
        FreeArm {
            name: "ur, tool beside the axis",
            cell: free_cell("ur_cell.toml", beside, true),
            redundant: None,
            spins: 720,
        },
        FreeArm {
            name: "wrist, tool beside the axis",
            cell: free_cell("wrist_cell.toml", beside, true),
            redundant: None,
            spins: 720,
        },
        FreeArm {
            name: "panda, free spin",
            cell: free_cell("panda_cell.toml", None, true),
            redundant: Some((6, 241)),
            spins: 72,
        },
    ]
}

/// The scan has 721 values of a redundant joint or 720 spins. If joint and spin are both free, the scan has
/// 241 values of the joint with 72 spins each. A value counts as worse if it exceeds the value of the scan
/// both by more than 0.1 % and by more than 1 um.
///
/// The full test compares 1 000 poses of each arm:
/// `SWEETSPOT_TEST_CASES=full cargo test --test maths redundant_coordinates:: -- --nocapture`.
#[test]
fn refined_postures_are_as_good_as_a_fine_scan() {
    let count = cases(40, 1000);
    for arm in arms() {
        let workcell = Workcell::new(arm.cell.clone()).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut excess = Vec::new();
        while excess.len() < count {
            let layout = arm.layout(&mut rng);
            let base = layout.base.pose().inverse();
            for (k, map) in workcell.maps(&layout).iter().enumerate() {
                let at = &layout.placements[arm.cell.operations[k].equipment];
                let node = &map.nodes[rng.random_range(0..map.nodes.len())];
                let Some(posture) = &node.posture else { continue };
                let least = arm.scanned(&workcell, k, &base.transform(&node.position), at);
                excess.push((posture.value - least, posture.value / least - 1.0));
            }
        }
        let worse = excess.iter().filter(|(by, share)| *by > 1e-6 && *share > 1e-3).count();
        excess.sort_by(|a, b| a.1.total_cmp(&b.1));
        let percent = |rank: usize| excess[rank].1 * 100.0;
        let (all, last) = (excess.len(), excess.len() - 1);
        println!(
            "{}: {all} poses, {worse} worse; median {:.4} %, 95 % {:.4} %, most {:.4} %",
            arm.name,
            percent(last / 2),
            percent(last * 95 / 100),
            percent(last)
        );
        assert!(worse * 200 <= all, "{}: {worse} of {all}", arm.name);
    }
}

/// A spin by the last joint alone is only sampled in the statistical reading, because the error changes
/// little with the spin.
#[test]
fn twelve_spins_of_the_last_joint_are_nearly_as_good_as_seventy_two() {
    let mut most = 1.0_f64;
    for name in ["scara_cell.toml", "palletizer_cell.toml", "five_axis_cell.toml", "offset_wrist_cell.toml"] {
        let cell = free_cell(name, None, true);
        let mut finer = cell.clone();
        for operation in &mut finer.operations {
            operation.attitude.spin = Spin::At((0..72).map(|k| TAU * f64::from(k) / 72.0).collect());
        }
        let maps = [cell, finer].map(|cell| {
            let workcell = Workcell::new(cell).unwrap();
            workcell.maps(&workcell.cell.start())
        });
        let nodes = maps[0].iter().zip(&maps[1]).flat_map(|(a, b)| a.nodes.iter().zip(&b.nodes));
        let values = nodes.filter_map(|(a, b)| Some((a.usable_posture()?.value, b.usable_posture()?.value)));
        let ratios: Vec<f64> = values.map(|(twelve, more)| twelve / more).collect();
        assert!(ratios.len() > 20, "{name}");
        most = ratios.into_iter().fold(most, f64::max);
    }
    println!("the best of 12 spins is at most {:.3} % above the best of 72", (most - 1.0) * 100.0);
    assert!(most < 1.0012, "{most}");
}

/// With a tool beside the axis and calibrated errors, the best of the sampled spins is much worse than the
/// refined spin. The refined posture never has a larger value.
#[test]
fn refinement_improves_on_the_sampled_spins() {
    let refined = free_cell("ur_cell.toml", Some((0.08, 0.15)), true);
    let mut sampled = refined.clone();
    for operation in &mut sampled.operations {
        operation.attitude.spin = Spin::At(Attitude::free_spins().collect());
    }
    let maps = [refined, sampled].map(|cell| {
        let workcell = Workcell::new(cell).unwrap();
        workcell.maps(&workcell.cell.start())
    });
    let nodes = maps[0].iter().zip(&maps[1]).flat_map(|(a, b)| a.nodes.iter().zip(&b.nodes));
    let values = nodes.filter_map(|(a, b)| Some((a.usable_posture()?.value, b.usable_posture()?.value)));
    let ratios: Vec<f64> = values.map(|(refined, sampled)| sampled / refined).collect();
    assert!(ratios.len() > 40 && ratios.iter().all(|ratio| *ratio >= 1.0), "{ratios:?}");
    assert!(ratios.iter().filter(|ratio| **ratio > 1.05).count() > 5, "{ratios:?}");
}

/// A refined posture of a layout to build leaves room to place the pieces: each table of the Panda may be
/// displaced by 5 mm in every direction.
#[test]
fn refined_postures_of_a_layout_to_build_leave_room() {
    let workcell = Workcell::new(buildable("panda_cell.toml")).unwrap();
    let start = workcell.cell.start();
    let held = HeldLayout::new(&workcell, &start).unwrap();
    for (piece, (x, y)) in
        (0..2).flat_map(|piece| [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)].map(|by| (piece, by)))
    {
        let mut moved = start.clone();
        moved.placements[piece].x += 0.005 * x;
        moved.placements[piece].y += 0.005 * y;
        let judged = held.judge(&moved, f64::INFINITY, &mut HeldMemory::default());
        assert!(judged.is_ok(), "piece {piece} moved by {x}, {y}: {judged:?}");
    }
}
