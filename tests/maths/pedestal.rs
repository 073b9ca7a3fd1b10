//! Tests of the pedestal below a raised robot base: the arm must not touch it, and it takes floor space.

use crate::common::{from_text, shipped};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::{BaseSupport, Cell, Rectangle};
use sweetspot::clearance::{PlacedSolids, Scene, SolidRef};
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::robot::Chain;

/// Returns a cell with a base 700 mm above the floor, on a pedestal of 300 x 400 mm that is not centred.
fn with_pedestal() -> Cell {
    let text = "from = \"ur_cell.toml\"\nclearance_mm = 0\n[robot]\n\
                pedestal = { size_mm = [300, 400], centre_mm = [20, -10] }\n";
    from_text(text).unwrap().cell
}

/// Random postures touch the pedestal exactly if a link beyond the first has a point inside its box. The
/// points are sampled on the axes of the link capsules, so a posture near the surface of the box may be
/// either.
#[test]
fn the_arm_must_not_touch_the_pedestal() {
    let cell = with_pedestal();
    let (scene, mut placed) = (Scene::new(&cell), PlacedSolids::default());
    let mut layout = cell.start();
    // The equipment is moved far away, so that it blocks nothing.
    layout.placements.iter_mut().for_each(|at| at.x += 50.0);
    scene.place(&layout, &mut placed);
    let chain = Chain::new(&cell.robot);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (mut touches, mut apart) = (0, 0);
    for _ in 0..4000 {
        let mut q = [0.0; sweetspot::cell::MAX_JOINTS];
        for (q, joint) in q.iter_mut().zip(&cell.robot.joints) {
            *q = rng.random_range(joint.limits.0..=joint.limits.1);
        }
        let frames = chain.frames(&chain.posture(&q));
        let hit = scene.hit(&placed, &frames.links, None);
        let (mut deepest, mut nearest) = (false, false);
        for solid in cell.robot.solids.iter().filter(|s| s.link >= 2) {
            let (low, high) = sweetspot::cell::extent(&solid.solid.shape);
            let middle = frames.links[solid.link].transform(&((low + high) / 2.0));
            let inside = |room: f64| {
                (middle.x - 0.02).abs() < 0.15 + room
                    && (middle.y + 0.01).abs() < 0.2 + room
                    && middle.z < room
                    && middle.z > -0.7 - room
            };
            deepest |= inside(0.0);
            nearest |= inside((high - low).norm() / 2.0);
        }
        let is_pedestal = hit.is_some_and(|hit| [hit.solid, hit.other].contains(&SolidRef::Pedestal));
        if deepest {
            touches += 1;
            assert!(hit.is_some(), "a link is inside the pedestal at {q:?}");
        }
        if !nearest {
            apart += 1;
            assert!(!is_pedestal, "no link is near the pedestal at {q:?}");
        }
    }
    assert!(touches > 50 && apart > 500, "{touches} {apart}");
}

#[test]
fn the_height_of_the_pedestal_is_that_of_the_base_above_the_floor() {
    let cell = with_pedestal();
    assert_eq!(cell.pedestal(0.7).map(|(_, height)| height), Some(0.7));
    assert_eq!(cell.pedestal(0.0), None);
    let hung = from_text("from = \"ur_cell.toml\"\n[robot]\npedestal = false\n").unwrap().cell;
    assert_eq!((hung.base_support, hung.highest_pedestal()), (BaseSupport::Hung, None));
    // The footprint of the robot is the default, and a base on the floor has none.
    let ur = shipped("ur_cell.toml");
    assert_eq!(ur.base_support, BaseSupport::Pedestal(ur.robot.footprint));
    assert_eq!(shipped("hitachi_cell.toml").highest_pedestal(), None);
    let joined = Rectangle { centre: (0.0, 0.0), size: (2.0, 2.0) }
        .joined(&Rectangle { centre: (1.0, 0.5), size: (2.0, 1.0) });
    assert_eq!(joined, Rectangle { centre: (0.5, 0.0), size: (3.0, 2.0) });
}

/// Equipment may stand below a base on a wall or a gantry, but not in its pedestal.
#[test]
fn equipment_may_stand_below_a_hung_base_only() {
    for (pedestal, is_free) in [("true", false), ("false", true)] {
        let text = format!(
            "from = \"ur_cell.toml\"\n[robot]\npedestal = {pedestal}\n[obstacle.crate]\n\
             solid = [{{ name = \"crate\", box = {{ centre_mm = [0, 0, 100], size_mm = [200, 200, 200] }} }}]\n\
             placement = {{ x_mm = 0, y_mm = 0, z_mm = 0 }}\n\
             [equipment.worktable.placement]\nx_mm = 0\ny_mm = 0\nz_mm = 300\nyaw_deg = 0\n"
        );
        let workcell = Workcell::new(from_text(&text).unwrap().cell).unwrap();
        let table = workcell.cell.equipment.iter().position(|e| e.name == "worktable").unwrap();
        let overlaps = evaluate(&workcell, &workcell.cell.start()).overlaps;
        let with_base = overlaps
            .iter()
            .filter(|o| o.concerns(table) && o.in_words(&workcell.cell).contains("the robot base"));
        assert_eq!(with_base.count() == 0, is_free, "{pedestal}: {overlaps:?}");
    }
}
