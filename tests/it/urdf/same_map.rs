//! Tests that the shipped robot has equal rows and maps from its URDF and from its D-H rows.

use crate::common::{load_from, root, shipped};
use sweetspot::cell::Cell;
use sweetspot::error_map::OperationMap;
use sweetspot::layout::Workcell;
use sweetspot::pose::Pose;

/// Returns both cells with the paper's layout and errors.
fn on_paper() -> [Cell; 2] {
    let written = shipped("hitachi_paper.toml");
    let mut derived = written.clone();
    derived.robot = shipped("hitachi_urdf.toml").robot;
    derived.errors = derived.robot.errors.iter().position(|e| e.name() == "table-3").unwrap();
    [written, derived]
}

#[test]
fn derived_dh_rows_equal_the_written_ones() {
    let loaded = load_from(&root().join("cells"), "hitachi_urdf.toml").unwrap();
    assert_eq!(loaded.warnings, []);
    let (derived, written) = (loaded.cell.robot, shipped("hitachi_cell.toml").robot);
    assert_eq!((derived.mount, derived.tool), (Pose::identity(), Pose::identity()));
    assert_eq!(derived.coupling, written.coupling);
    assert_eq!(derived.footprint, written.footprint);
    for (a, b) in derived.joints.iter().zip(&written.joints) {
        assert_eq!((&a.name, a.kind), (&b.name, b.kind));
        let [a, b] = [a, b].map(|j| [j.theta, j.r, j.l, j.alpha, j.limits.0, j.limits.1]);
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14), "{a:?} {b:?}");
    }
}

#[test]
fn urdf_and_dh_rows_give_the_same_map() {
    let in_cell = [shipped("hitachi_cell.toml"), shipped("hitachi_urdf.toml")];
    let mut judged = 0;
    for cells in [in_cell, on_paper()] {
        let maps = cells.map(|cell| {
            let workcell = Workcell::new(cell).unwrap();
            workcell.maps(&workcell.cell.start())
        });
        for (a, b) in maps[0].iter().zip(&maps[1]) {
            assert_eq!((a.nodes.len(), a.best.is_some()), (b.nodes.len(), b.best.is_some()));
            // Mirrored nodes have equal values, so only the value of the best node is compared.
            let worth =
                |map: &OperationMap| map.best.and_then(|k| Some(map.nodes[k].posture.as_ref()?.value));
            let off = worth(a).zip(worth(b)).map_or(0.0, |(a, b)| (a - b).abs());
            assert!(off < 1e-12, "{off:e}");
            for (a, b) in a.nodes.iter().zip(&b.nodes) {
                assert_eq!(a.status.name(), b.status.name(), "{} {}", a.i, a.j);
                assert_eq!(a.posture.is_some(), b.posture.is_some());
                let (Some(a), Some(b)) = (&a.posture, &b.posture) else { continue };
                assert_eq!(a.branch, b.branch);
                let off_mm = (a.error - b.error).norm().max((a.value - b.value).abs()) * 1000.0;
                assert!(off_mm < 1e-9, "{off_mm:e} mm");
                judged += 1;
            }
        }
    }
    assert!(judged > 100, "{judged}");
}
