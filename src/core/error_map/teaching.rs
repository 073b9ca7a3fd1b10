//! Teaching of a surface frame: three points that the robot touches with an empty gripper.

use super::operation_setup::TeachPoints;
use super::outcome::Unjudged;
use super::placed_layout::{PlacedLayout, PlacedSurface};
use crate::cell::TEACH_HEIGHT;
use crate::reading::{ErrorEvaluator, Taught, WorkFrame};
use crate::robot::Frames;
use nalgebra::Vector3;

/// Returns the frame of a work surface. The frame is taught if the cell asks for teaching.
///
/// The errors of a taught frame are computed from the error sources of `evaluator`.
///
/// # Errors
/// Returns [`Unjudged::NotTaught`] if the robot cannot touch three points that span the frame.
pub fn work_frame(
    placed: &PlacedLayout<'_>,
    evaluator: &ErrorEvaluator,
    surface: &PlacedSurface<'_>,
) -> Result<WorkFrame, Unjudged> {
    let setup = &placed.mapper.setups[surface.operation];
    let taught = match &setup.teach {
        TeachPoints::None => None,
        points => {
            let postures = touching_postures(placed, surface, points).ok_or(Unjudged::NotTaught)?;
            let chain = placed.mapper.chain();
            Some(Box::new(Taught::new(chain, &evaluator.sources, postures, evaluator.takes_mean())))
        }
    };
    Ok(WorkFrame { equipment: setup.equipment, work: surface.at.pose(), world: surface.world, taught })
}

/// Finds the postures in which the robot touches three points to teach the frame; None if there are none.
///
/// If the points are nodes, the robot may be unable to touch them, or the points may lie nearly in one
/// line. In both cases, the function chooses three touchable nodes that form a wide triangle.
fn touching_postures(
    placed: &PlacedLayout<'_>,
    surface: &PlacedSurface<'_>,
    points: &TeachPoints,
) -> Option<[Frames; 3]> {
    let (grid, at) = (&placed.mapper.setups[surface.operation].grid, &surface.at);
    let attitudes = placed.attitudes(surface);
    let touch = |target: Vector3<f64>| {
        let (arm, scene, mut found) = (&placed.mapper.arm, &placed.mapper.scene, None);
        arm.inverse.visit(&target, &attitudes, &mut arm.inverse.scratch(), |_, posture| {
            if found.is_none() {
                let frames = arm.chain.frames(posture);
                found = scene.hit(&placed.solids, &frames.links, None).is_none().then_some(frames);
            }
        });
        found
    };
    let point = |k: usize| match points {
        TeachPoints::None => None,
        TeachPoints::Nodes(orders) => orders[k].iter().find_map(|&node| touch(grid.target(at, node))),
        TeachPoints::Given(points) => touch(grid.point(at, points[k])),
    };
    let is_wide = |postures: &[Frames; 3]| height(postures) > TEACH_HEIGHT;
    let postures = point(0).zip(point(1)).zip(point(2)).map(|((a, b), c)| [a, b, c]).filter(is_wide);
    if postures.is_some() || matches!(points, TeachPoints::Given(_)) {
        return postures;
    }
    let mut all = Vec::new();
    grid.targets(at, |_, target| all.extend(touch(target)));
    widest(&all).filter(is_wide)
}

/// Computes the height (m), perpendicular to the longest side, of the triangle whose corners are three TCP
/// positions.
fn height(p: &[Frames; 3]) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k| p[k].tcp.translation);
    let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
    (b - a).cross(&(c - a)).norm() / longest.max(f64::MIN_POSITIVE)
}

/// Picks three postures whose TCP positions form a wide triangle; None if `all` is empty.
///
/// The first posture is taken, then the posture farthest from it, then the posture farthest from the line
/// through these two.
fn widest(all: &[Frames]) -> Option<[Frames; 3]> {
    let first = all.first()?;
    let from = |f: &Frames| (f.tcp.translation - first.tcp.translation).norm();
    let second = all.iter().max_by(|a, b| from(a).total_cmp(&from(b)))?;
    let along = second.tcp.translation - first.tcp.translation;
    let beside = |f: &Frames| along.cross(&(f.tcp.translation - first.tcp.translation)).norm();
    let third = all.iter().max_by(|a, b| beside(a).total_cmp(&beside(b)))?;
    Some([*first, *second, *third])
}
