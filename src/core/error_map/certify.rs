//! Certificates of postures and paths. A certified posture or path can be used at every misplacement inside
//! the placement tolerances.

use super::demand::Demand;
use super::outcome::Spot;
use super::placed_layout::PlacedLayout;
use super::walk::OperationQuery;
use super::workspace::{MapperWorkspace, PostureMemory};
use crate::cell::{JointVector, MAX_JOINTS};
use crate::certificate::{BoxedPosture, JointEnclosure, NotCertified, PostureMotion, TargetBox};
use crate::clearance::{Load, SolidMotion};
use crate::motion::{DEVIATION, Hindrance, LineEnds, PathSlack, Stopped, first_hit};
use crate::reach::{Branch, ToolTask};
use crate::robot::{Frames, Posture};
use nalgebra::Vector3;

/// Largest distance between the TCP positions at two successive knots of a straight line of the TCP, m.
///
/// If the distance is larger, the move between the knots does not belong to a straight line of the TCP.
const LINE_STEP: f64 = 0.0201;

/// One posture of an operation, with everything that its certificate needs.
struct Nominal {
    target: Vector3<f64>,
    posture: Posture,
    joints: JointVector,
    frames: Frames,
    task: ToolTask,
    reach: TargetBox,
}

impl OperationQuery<'_> {
    /// Certifies a posture of this operation. Returns an upper bound of the operation's value over all
    /// misplacements; None if `demand` asks for no bound, or if no bound is known.
    ///
    /// # Errors
    /// Returns the reason if the posture is not certified. The error limit of the operation is not checked.
    pub(super) fn certify(
        &self,
        target: &Vector3<f64>,
        branch: Option<Branch>,
        demand: &Demand<'_>,
        memory: &mut PostureMemory,
    ) -> Result<Option<f64>, NotCertified> {
        let (nominal, joints) = self.boxed(target, branch, demand)?;
        let Nominal { frames, task, .. } = &nominal;
        let mapper = self.placed.mapper;
        self.check_singularity(&joints, task, frames)?;
        let motion = self.motion(frames, &joints, demand);
        if let Some(hit) =
            mapper.scene.first_unsafe(&self.placed.solids, &frames.links, self.operation, &motion)
        {
            return Err(NotCertified::Clearance(hit));
        }
        self.certify_lines(&nominal, demand, &mut memory.lines)?;
        Ok(self.bound(&nominal, &joints, demand, memory))
    }

    /// Returns the upper bound that [`Self::certify`] returns. The posture must be certified.
    ///
    /// # Errors
    /// Returns the reason if the posture is certainly not certified.
    fn bound_of_certified(
        &self,
        target: &Vector3<f64>,
        branch: Option<Branch>,
        demand: &Demand<'_>,
        memory: &mut PostureMemory,
    ) -> Result<Option<f64>, NotCertified> {
        let (nominal, joints) = self.boxed(target, branch, demand)?;
        Ok(self.bound(&nominal, &joints, demand, memory))
    }

    /// Returns the nominal posture of a branch, and bounds on its joint coordinates over all misplacements.
    ///
    /// # Errors
    /// Returns the reason if the branch does not exist, or if a joint limit may be exceeded.
    fn boxed(
        &self,
        target: &Vector3<f64>,
        branch: Option<Branch>,
        demand: &Demand<'_>,
    ) -> Result<(Nominal, JointEnclosure), NotCertified> {
        let nominal = self.nominal(target, branch, demand)?;
        let joints = self.joint_box(&nominal, &nominal.frames, &nominal.joints, &[0.0; MAX_JOINTS])?;
        Ok((nominal, joints))
    }

    /// Returns an upper bound of the operation's value over all misplacements; None if `demand` asks for no
    /// bound, or if no bound is known.
    fn bound(
        &self,
        Nominal { posture, frames, reach, .. }: &Nominal,
        joints: &JointEnclosure,
        demand: &Demand<'_>,
        memory: &mut PostureMemory,
    ) -> Option<f64> {
        let (Some(Ok(value)), Ok(context)) = (demand.value, &self.context) else { return None };
        let boxed = BoxedPosture { context, posture, frames, target: reach, joints };
        let chain = &self.placed.mapper.arm.chain;
        Some(value.most(&self.setup.evaluator, chain, &boxed, &mut memory.scratch.evaluator))
    }

    /// Returns the reason why a posture that is usable without misplacements is not certified. Returns None
    /// if the posture is certified, or if no certificate is demanded.
    pub fn uncertainty(
        &self,
        target: &Vector3<f64>,
        branch: Option<Branch>,
        memory: &mut PostureMemory,
    ) -> Option<NotCertified> {
        let demand = Demand { value: None, ..self.placed.demand? };
        self.certify(target, branch, &demand, memory).err()
    }

    /// Returns the nominal posture of a branch, and the box that contains all misplaced TCP targets.
    fn nominal(
        &self,
        target: &Vector3<f64>,
        branch: Option<Branch>,
        demand: &Demand<'_>,
    ) -> Result<Nominal, NotCertified> {
        let arm = &self.placed.mapper.arm;
        let target = *target;
        let found = branch.ok_or(NotCertified::NoBranch)?;
        let (posture, joints) = (found.posture, found.joints);
        let frames = arm.chain.frames(&posture);
        let task = arm.inverse.tool_task(&self.attitudes, &frames).ok_or(NotCertified::NoTask)?;
        let in_world = self.placed.layout.base.pose().transform(&target);
        let mut reach = TargetBox::new(demand.cell, self.placed.layout, self.setup.equipment, &in_world);
        if task.radial {
            reach = reach.with_radial_heading(&target);
        }
        Ok(Nominal { target, posture, joints, frames, task, reach })
    }

    /// Returns bounds on the joint coordinates of a posture over the target box of `nominal`.
    ///
    /// # Errors
    /// Returns the reason if a joint limit may be exceeded.
    fn joint_box(
        &self,
        nominal: &Nominal,
        frames: &Frames,
        joints: &JointVector,
        beyond: &JointVector,
    ) -> Result<JointEnclosure, NotCertified> {
        let chain = &self.placed.mapper.arm.chain;
        let aside = (frames.tcp.translation - nominal.target).xy().norm();
        let reach = if aside > 0.0 { nominal.reach.extended_by(aside) } else { nominal.reach };
        Ok(JointEnclosure::new(chain, &nominal.task, (joints, frames), &reach, beyond)?)
    }

    /// Checks that a posture stays far enough from singular postures within a box of joint coordinates.
    fn check_singularity(
        &self,
        joints: &JointEnclosure,
        task: &ToolTask,
        frames: &Frames,
    ) -> Result<(), NotCertified> {
        let mapper = self.placed.mapper;
        let Some(guard) = &mapper.guard else { return Ok(()) };
        let change = |scale: f64| joints.jacobian_change(&mapper.arm.chain, task, frames, scale);
        guard
            .may_become_singular(frames, change)
            .map_or(Ok(()), |measure| Err(NotCertified::Singular { measure }))
    }

    /// Returns bounds on the motion of all solids if the joint coordinates lie inside a box.
    fn motion<'m>(
        &'m self,
        frames: &'m Frames,
        joints: &'m JointEnclosure,
        demand: &Demand<'m>,
    ) -> PostureMotion<'m> {
        let mapper = self.placed.mapper;
        PostureMotion {
            chain: &mapper.arm.chain,
            frames,
            joints,
            spheres: mapper.scene.bounding_spheres(),
            misplacements: demand.misplacements,
            cell: demand.cell,
            layout: self.placed.layout,
            equipment: self.setup.equipment,
        }
    }

    /// Certifies the straight lines of approach and retract. `lines` receives the ends of certified lines if
    /// transfers need them.
    fn certify_lines(
        &self,
        nominal: &Nominal,
        demand: &Demand<'_>,
        lines: &mut Vec<LineEnds>,
    ) -> Result<(), NotCertified> {
        let Some(guard) = &self.placed.mapper.guard else { return Ok(()) };
        let (approach, retract) = guard.approach_and_retract(self.operation);
        let length = approach.max(retract);
        if length == 0.0 {
            return Ok(());
        }
        let knots = guard
            .back(&nominal.joints, length)
            .map_err(|stopped| NotCertified::Path(Hindrance::Stopped(stopped)))?;
        let boxes = self.deviations(nominal, &knots, true)?;
        let deviations: Vec<JointVector> = boxes.iter().map(|found| found.half).collect();
        let tool_turn = boxes.iter().map(|found| found.tool_turn).fold(0.0, f64::max);
        let widest = JointEnclosure { tool_turn, ..JointEnclosure::NONE };
        let motion = self.motion(&nominal.frames, &widest, demand);
        // Along the line, the TCP is up to `length` away from the spot.
        let aside = 2.0 * DEVIATION + nominal.reach.yaw * length;
        let between = |link: usize, equipment: usize| Some(motion.between(link, equipment)? + aside);
        let load = Load::of(Some(self.operation));
        self.certify_path(&knots, &deviations, load, demand, Some(&between))?;
        if guard.asks_transfers() {
            let end = |line: f64| knots.last().copied().filter(|_| line == length);
            lines.push(LineEnds { spot: nominal.joints, approach: end(approach), retract: end(retract) });
        }
        Ok(())
    }

    /// Returns the largest deviations of the D-H coordinates (rad or m) from the nominal path, one entry per
    /// knot. The actual path follows the misplaced target. The via postures of the transfer rules do not
    /// follow the target. If `keeps_margin` is true, the distance from singular postures is also checked.
    ///
    /// Along a straight line of the TCP, the deviation at a knot also bounds the deviation up to halfway to
    /// each neighbouring knot. Along any other move, the deviation is interpolated linearly.
    fn deviations(
        &self,
        nominal: &Nominal,
        knots: &[JointVector],
        keeps_margin: bool,
    ) -> Result<Vec<JointEnclosure>, NotCertified> {
        let PlacedLayout { mapper, .. } = self.placed;
        let chain = &mapper.arm.chain;
        let frames: Vec<Frames> = knots.iter().map(|q| chain.frames(&chain.posture(q))).collect();
        let step = |a: usize, b: usize| -> JointVector {
            let way = (frames[a].tcp.translation - frames[b].tcp.translation).norm();
            let change = |i: usize| -> f64 {
                let pairs = chain.coupling[i].iter().zip(knots[a].iter().zip(&knots[b]));
                pairs.map(|(c, (a, b))| c * (b - a)).sum()
            };
            let is_line = way <= LINE_STEP;
            std::array::from_fn(|i| if is_line && i < chain.axes() { change(i).abs() / 2.0 } else { 0.0 })
        };
        let deviation = |k: usize| {
            if mapper.guard.as_ref().is_some_and(|guard| guard.is_via(&knots[k])) {
                return Ok(JointEnclosure::NONE);
            }
            let (before, after) = (step(k.saturating_sub(1), k), step(k, (k + 1).min(knots.len() - 1)));
            let beyond = std::array::from_fn(|i| before[i].max(after[i]));
            let found = self.joint_box(nominal, &frames[k], &knots[k], &beyond)?;
            if keeps_margin {
                self.check_singularity(&found, &nominal.task, &frames[k])?;
            }
            Ok(found)
        };
        (0..knots.len()).map(deviation).collect()
    }

    /// Certifies a path of straight moves in joint coordinates. `deviations` has one entry per knot.
    fn certify_path(
        &self,
        knots: &[JointVector],
        deviations: &[JointVector],
        load: Load,
        demand: &Demand<'_>,
        between: Option<&dyn Fn(usize, usize) -> Option<f64>>,
    ) -> Result<(), NotCertified> {
        let PlacedLayout { mapper, solids, .. } = self.placed;
        // A straight line of the TCP is approximated by moves that deviate from it.
        let equipment = |k: Option<usize>| demand.misplacements.of(k) + 2.0 * DEVIATION;
        let slack = PathSlack { joints: deviations, equipment: Some(&equipment), between };
        match first_hit(&mapper.arm.chain, &mapper.scene, solids, knots, load, &slack) {
            Some(hit) => Err(NotCertified::Path(Hindrance::Hit(hit))),
            None => Ok(()),
        }
    }
}

impl PlacedLayout<'_> {
    /// Certifies a spot of an operation.
    ///
    /// # Errors
    /// Returns the reason if the spot is not certified.
    pub fn certify(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        spot: &Spot,
        demand: &Demand<'_>,
        workspace: &mut MapperWorkspace,
    ) -> Result<(), NotCertified> {
        let demand = Demand { value: None, ..*demand };
        self.asking_at(operation, spots, spot, workspace, |query, target, branch, memory| {
            query.certify(target, branch, &demand, memory).map(|_| ())
        })
    }

    /// For a certified spot, returns an upper bound of the operation's value over all misplacements. Returns
    /// None if no bound is known.
    ///
    /// # Errors
    /// Returns the reason if there are no bounds of the joint coordinates ([`JointEnclosure`]), or if these
    /// bounds exceed the joint limits. The other conditions of a certificate are not checked.
    pub fn most(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        spot: &Spot,
        demand: &Demand<'_>,
        workspace: &mut MapperWorkspace,
    ) -> Result<Option<f64>, NotCertified> {
        self.asking_at(operation, spots, spot, workspace, |query, target, branch, memory| {
            query.bound_of_certified(target, branch, demand, memory)
        })
    }

    /// Calls `ask` with the query of one operation, the TCP target and the branch at a spot, and the memory
    /// of this operation in the workspace.
    fn asking_at<T>(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        spot: &Spot,
        workspace: &mut MapperWorkspace,
        ask: impl FnOnce(&OperationQuery<'_>, &Vector3<f64>, Option<Branch>, &mut PostureMemory) -> T,
    ) -> T {
        let attitudes = std::mem::take(&mut workspace.attitudes);
        let surface = self.surface(operation);
        let query = OperationQuery::reusing(self, &surface, spots, attitudes);
        let target = query.setup.grid.target(&query.at, spot.node);
        let memory = workspace.of(self.mapper, operation).postures;
        let found = ask(&query, &target, query.branch_at(&target, spot.branch), memory);
        workspace.attitudes = query.attitudes;
        found
    }

    /// Certifies a path on which the robot moves with a load from one operation to another.
    ///
    /// # Errors
    /// Returns the hindrance if the path is not certified.
    pub fn certify_transfer(
        &self,
        ends: [usize; 2],
        path: &[JointVector],
        load: Load,
        spots: &[Option<Spot>],
        demand: &Demand<'_>,
    ) -> Result<(), Hindrance> {
        // The knots before the longest move follow the misplaced target of the first operation. The other
        // knots follow the target of the second operation.
        let step = |k: &usize| -> f64 {
            path[*k].iter().zip(&path[k + 1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let moves = 0..path.len().saturating_sub(1);
        let longest = moves.max_by(|a, b| step(a).total_cmp(&step(b))).map_or(path.len(), |k| k + 1);
        let (before, after) = path.split_at(longest);
        let certify = || {
            let mut deviations = Vec::with_capacity(path.len());
            for (operation, knots) in ends.into_iter().zip([before, after]) {
                let query = OperationQuery::new(self, operation, spots);
                let spot = spots[operation].ok_or(NotCertified::NoSpot)?;
                let target = query.setup.grid.target(&query.at, spot.node);
                let branch = query.branch_at(&target, spot.branch);
                let nominal = query.nominal(&target, branch, demand)?;
                let found = query.deviations(&nominal, knots, false)?;
                deviations.extend(found.iter().map(|found| found.half));
            }
            OperationQuery::new(self, ends[0], spots).certify_path(path, &deviations, load, demand, None)
        };
        certify().map_err(|why| match why {
            NotCertified::Path(hindrance) => hindrance,
            NotCertified::JointLimit { joint, .. } => {
                Hindrance::Stopped(Stopped::Limit { joint, after: 0.0 })
            }
            _ => Hindrance::Stopped(Stopped::Lost { after: 0.0 }),
        })
    }
}
