//! Tests the seed paper's robot and its comparison of the models (section 4.3) against values computed
//! without this crate.

use crate::common::shipped;
use nalgebra::Vector3;
use sweetspot::cell::{ErrorSet, MAX_JOINTS, Model};
use sweetspot::error_map::NodeSign;
use sweetspot::kinematic_error::{Discrepancy, Perturbation, discrepancy, position_error};
use sweetspot::layout::Workcell;
use sweetspot::robot::Chain;
use sweetspot::units::mm_from_m;

#[test]
fn the_initial_position_of_the_end_effector_matches_the_paper() {
    for name in ["hitachi_paper.toml", "hitachi_paper_parallelogram.toml"] {
        let chain = Chain::new(&shipped(name).robot);
        let pose = chain.forward(&chain.posture(&[0.0; MAX_JOINTS]));
        assert!((pose.translation - Vector3::new(0.0, 1.25, 1.35)).norm() < 1e-15);
        assert!((pose.rotation * chain.tool_axis - Vector3::y()).norm() < 1e-15);
    }
}

/// The values are x, y, z and resultant in mm with six decimal places. The paper truncated some of them
/// instead of rounding.
#[test]
fn the_errors_at_the_initial_position_match_the_paper() {
    let figures = [
        ("table-3", Model::Nonlinear, [1.689215, 2.993310, 1.999417, 3.976307]),
        ("table-3", Model::Linear, [1.691003, 3.0, 2.0, 3.982397]),
        ("table-2", Model::Nonlinear, [2.581402, 4.969703, 6.029340, 8.228884]),
        ("table-2", Model::Linear, [2.563668, 5.0, 6.0, 8.220242]),
    ];
    let robot = shipped("hitachi_paper.toml").robot;
    let chain = Chain::new(&robot);
    let posture = chain.posture(&[0.0; MAX_JOINTS]);
    for (table, model, want) in figures {
        let Some(ErrorSet::Signed(set)) = robot.errors.iter().find(|e| e.name() == table) else {
            panic!("{table} is a signed sample")
        };
        let e = position_error(&chain.frames(&posture), &Perturbation::new(&chain, set), model);
        for (got, want) in [e.x, e.y, e.z, e.norm()].into_iter().zip(want) {
            assert!((mm_from_m(got) - want).abs() < 1e-6, "{table} {model:?}: {got} instead of {want} mm");
        }
    }
}

/// Discrepancy of eq. (9) over the nodes that the robot reaches.
struct Comparison {
    reached: usize,
    /// Largest discrepancies, percent, printed to three decimals.
    resultant: f64,
    y: f64,
    z: f64,
}

/// Checks the paper's claim of at most 1 %. The claim holds for the resultant, y and z, but not for x,
/// because the error in x vanishes along a line across the table.
fn check_comparison(name: &str, want: &Comparison) {
    let cell = shipped(name);
    let start = cell.start();
    let map = Workcell::new(cell).unwrap().maps(&start).remove(0);
    assert_eq!((map.nodes.len(), map.count(NodeSign::Usable)), (99, want.reached), "{name}");
    let errors: Vec<_> = map.nodes.iter().filter_map(|n| n.posture.as_ref()).collect();
    let compared: Vec<_> = errors.iter().map(|e| discrepancy(&e.nonlinear, &e.linear)).collect();
    let largest = |of: fn(&Discrepancy) -> Option<f64>| compared.iter().filter_map(of).fold(0.0, f64::max);
    let figures =
        [(largest(|d| d.resultant), want.resultant), (largest(|d| d.y), want.y), (largest(|d| d.z), want.z)];
    for (got, want) in figures {
        assert!((got - want).abs() < 6e-4, "{name}: {got} % instead of {want} %");
    }
    let passing = || errors.iter().zip(&compared).filter(|(_, d)| d.x.unwrap() > 1.0);
    assert_eq!(passing().count(), 5, "{name}");
    assert!(passing().all(|(e, _)| e.nonlinear.x.abs() < 0.05 * e.nonlinear.norm()), "{name}");
}

#[test]
fn the_discrepancy_of_the_models_over_the_table_matches_the_paper() {
    check_comparison("hitachi_paper.toml", &Comparison { reached: 80, resultant: 0.190, y: 0.355, z: 0.317 });
    check_comparison(
        "hitachi_paper_parallelogram.toml",
        &Comparison { reached: 91, resultant: 0.193, y: 0.355, z: 0.438 },
    );
}
