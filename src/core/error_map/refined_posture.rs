//! Refinement of the chosen posture along the coordinates that the task leaves free.
//!
//! The inverse kinematics samples the redundant joint and a free spin of the tool ([`RedundantCoordinate`]).
//! The least-error posture usually lies between the samples. After the best usable sample was found, a
//! compass search with parabolic steps therefore starts there, at other good samples, and in narrow ranges
//! without a sample. Each search keeps the point, the solution of the inverse kinematics and all other
//! coordinates. The refined posture must be usable, too: collision-free, allowed by the motion rules and, if
//! demanded, certified.
//!
//! Layouts to build must leave room for placing their pieces. Their postures therefore keep a quarter of the
//! way from the sample to the edge of what is certified, and are not refined in narrow ranges.

use super::candidate::{ArmContact, Certainty, PostureCandidate};
use super::outcome::Spot;
use super::placed_layout::PlacedLayout;
use super::walk::OperationQuery;
use super::workspace::PostureMemory;
use crate::cell::Reading;
use crate::reach::{RedundantCoordinate, SamplePosition};

/// Greatest number of samples from which refinements start. If samples that differ only in a spin by the last
/// joint count as one, this number and [`MAX_SAMPLES`] are doubled.
const MAX_STARTS: usize = 4;

/// Greatest number of samples that are considered as starts.
const MAX_SAMPLES: usize = 16;

/// Refinements start only at samples whose value exceeds the least value by at most this share.
const MOST_EXCESS: f64 = 0.05;

/// First step of a search, as a share of the distance between neighbouring samples.
const FIRST_STEP: f64 = 0.5;

/// The search ends when its step falls below this share of the distance between neighbouring samples.
const LEAST_STEP: f64 = 1.0 / 1024.0;

/// Factor of the step after a poll without a gain, or after a parabolic step.
const SHRINK: f64 = 0.25;

/// Greatest number of polls of one search.
const MAX_POLLS: usize = 32;

/// Number of bisections of the path from a start to a refined posture that is not usable.
const BISECTIONS: usize = 8;

/// Number of bisections for a layout to build, which does not need the exact last usable posture.
const BISECTIONS_TO_BUILD: usize = 4;

/// Least gain that counts, as a share of the value.
const LEAST_GAIN: f64 = 1e-5;

/// A search ends early if its value exceeds the best known value by more than this multiple of the gain of its
/// last round of polls, plus [`WORTHWHILE`]. A round without a gain does not end the search, because its steps
/// may have passed over a narrow valley.
const LIKELY_ROUNDS: f64 = 4.0;

/// Excess over the best known value at which a search goes on after any gain, as a share of the value.
const WORTHWHILE: f64 = 1e-3;

/// Two values count as equal if their relative difference is at most this constant.
const SAME_VALUE: f64 = 1e-9;

/// Directions of a search: motions of the redundant joint and of the spin.
///
/// The two diagonal directions lead along a joint limit that depends on both coordinates.
const DIRECTIONS: [Direction; 4] = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]];

/// Motion along the redundant coordinates, in the order of [`COORDINATES`], as shares of the distance between
/// neighbouring samples.
type Direction = [f64; 2];

/// Coordinates along which a posture is refined.
const COORDINATES: [RedundantCoordinate; 2] = [RedundantCoordinate::Joint, RedundantCoordinate::Spin];

/// Branch index and value of a posture within the joint limits.
type Judged = (u64, f64);

/// Usable sample of the redundant coordinates.
#[derive(Clone, Copy)]
struct UsableSample {
    node: usize,
    value: f64,
    position: SamplePosition,
}

impl UsableSample {
    fn is_beside(&self, other: &Self) -> bool {
        self.node == other.node && self.position.is_beside(&other.position)
    }

    /// Returns whether both samples have the same node and the same value.
    fn equals(&self, other: &Self) -> bool {
        self.node == other.node && (self.value - other.value).abs() <= SAME_VALUE * self.value.abs()
    }
}

impl PlacedLayout<'_> {
    /// Returns whether the postures of an operation are refined along a redundant coordinate.
    pub fn refines(&self, operation: usize) -> bool {
        let query = OperationQuery::new(self, operation, &[]);
        COORDINATES.iter().any(|coordinate| query.refines(*coordinate))
    }
}

impl OperationQuery<'_> {
    /// Returns whether postures of this operation are refined along a redundant coordinate.
    ///
    /// A spin by the last joint alone changes only the effects of errors behind this joint. Such a spin is
    /// refined only in the signed reading, because the gain is small in the other readings.
    pub fn refines(&self, coordinate: RedundantCoordinate) -> bool {
        let inverse = &self.placed.mapper.arm.inverse;
        let evaluator = &self.setup.evaluator;
        let is_worth_it = match coordinate {
            RedundantCoordinate::Joint => true,
            RedundantCoordinate::Spin if inverse.spins_by_last_joint() => {
                evaluator.reading == Reading::Signed && !evaluator.ignores_spin()
            }
            RedundantCoordinate::Spin => true,
        };
        is_worth_it && !self.setup.is_priced && inverse.is_redundant(coordinate, &self.attitudes)
    }

    /// Refines the best usable posture `best`, and other good samples, which `next` returns best first.
    /// Returns the best posture found.
    ///
    /// A sample is no start if a better sample lies beside it, because a search from there leads to the same
    /// posture. Two samples that differ only in a spin by the last joint count as one. A sample is no start
    /// either if another sample of the node has the same value: the two usually differ only in a spin that
    /// does not change the value.
    pub(super) fn refined(
        &self,
        best: PostureCandidate,
        memory: &mut PostureMemory,
        mut next: impl FnMut(&mut PostureMemory) -> Option<PostureCandidate>,
    ) -> PostureCandidate {
        if !COORDINATES.iter().any(|coordinate| self.refines(*coordinate)) {
            return best;
        }
        let most = best.spot.value * (1.0 + MOST_EXCESS);
        let mut refined = self.refined_alone(best, memory);
        let mut seen = [None; 2 * MAX_SAMPLES];
        seen[0] = Some(self.sample(&best));
        let factor = if self.samples_spin() { 2 } else { 1 };
        let (mut count, mut starts) = (1, 1);
        while count < factor * MAX_SAMPLES && starts < factor * MAX_STARTS {
            let Some(sample) = next(memory).filter(|sample| sample.spot.value <= most) else { break };
            let new = self.sample(&sample);
            let is_known =
                sample.certainty != Certainty::Value || seen.iter().flatten().any(|s| s.equals(&new));
            if is_known || !self.is_free(&sample, memory) {
                continue;
            }
            let is_start = !seen.iter().flatten().any(|other| other.is_beside(&new));
            seen[count] = Some(new);
            count += 1;
            if is_start {
                starts += 1;
                refined = self.better(refined, sample, memory);
            }
        }
        match self.placed.demand {
            None => {
                let refined = self.refined_in_narrow_ranges(refined, most, memory);
                self.with_best_spin(refined, memory)
            }
            Some(_) => refined,
        }
    }

    /// Returns whether the last joint alone spins the tool, and the spin is not refined. Samples that differ
    /// in such a spin then have nearly the same value.
    fn samples_spin(&self) -> bool {
        self.placed.mapper.arm.inverse.spins_by_last_joint() && !self.refines(RedundantCoordinate::Spin)
    }

    /// Returns the best usable posture over the sampled spins of the posture `at`, if the last joint alone
    /// spins the tool. Otherwise returns `at`.
    fn with_best_spin(&self, at: PostureCandidate, memory: &mut PostureMemory) -> PostureCandidate {
        if !self.samples_spin() {
            return at;
        }
        let (inverse, spins) = (&self.placed.mapper.arm.inverse, self.attitudes.spin_rotations().len());
        let mut best = at;
        for spin in 0..spins {
            let Some(branch) = inverse.member_branch(&self.attitudes, at.spot.branch, spin) else { continue };
            let Some(value) = self.value_of(&at, branch, memory) else { continue };
            let candidate = at_branch(at, (branch, value));
            let is_less = value < best.spot.value - LEAST_GAIN * best.spot.value.abs();
            if is_less && self.is_usable(&candidate, memory) {
                best = candidate;
            }
        }
        best
    }

    /// Refines postures at the node of `best` in narrow ranges of a redundant coordinate that contain no
    /// sample. Returns the best posture found. Values above `most` are no starts.
    fn refined_in_narrow_ranges(
        &self,
        best: PostureCandidate,
        most: f64,
        memory: &mut PostureMemory,
    ) -> PostureCandidate {
        let mut refined = best;
        let (mut starts, mut count) = ([0; MAX_SAMPLES], 0);
        let inverse = &self.placed.mapper.arm.inverse;
        inverse.visit_narrow_ranges(&best.target, &self.attitudes, |branch| {
            if count < MAX_SAMPLES {
                starts[count] = branch;
                count += 1;
            }
        });
        for branch in starts.into_iter().take(count) {
            let Some(value) = self.value_of(&best, branch, memory).filter(|value| *value <= most) else {
                continue;
            };
            refined = self.better(refined, at_branch(best, (branch, value)), memory);
        }
        refined
    }

    /// Refines the posture `start`, which need not be usable. Returns the better of `best` and the result.
    fn better(
        &self,
        best: PostureCandidate,
        start: PostureCandidate,
        memory: &mut PostureMemory,
    ) -> PostureCandidate {
        let found = self.descend(&start, best.spot.value, memory);
        if found.1 >= best.spot.value || !self.is_usable(&start, memory) {
            return best;
        }
        let other = self.last_usable(start, found, memory);
        if other.spot.value < best.spot.value { other } else { best }
    }

    /// Returns what the search remembers of a usable sample.
    fn sample(&self, candidate: &PostureCandidate) -> UsableSample {
        let (Spot { node, branch, value }, inverse) = (candidate.spot, &self.placed.mapper.arm.inverse);
        let first_spin = self.samples_spin().then(|| inverse.member_branch(&self.attitudes, branch, 0));
        let position = inverse.sample_position(first_spin.flatten().unwrap_or(branch), &self.attitudes);
        UsableSample { node, value, position }
    }

    /// Refines one usable posture. Returns a usable posture whose value is not larger.
    pub(super) fn refined_alone(
        &self,
        start: PostureCandidate,
        memory: &mut PostureMemory,
    ) -> PostureCandidate {
        let found = self.descend(&start, f64::INFINITY, memory);
        self.last_usable(start, found, memory)
    }

    /// Searches for a posture of less value along the redundant coordinates, within the joint limits. The
    /// search ends early if it will hardly find a value below `known`.
    fn descend(&self, start: &PostureCandidate, known: f64, memory: &mut PostureMemory) -> Judged {
        let refined = COORDINATES.map(|coordinate| self.refines(coordinate));
        let is_searched = |direction: &Direction| (0..2).all(|k| refined[k] || direction[k] == 0.0);
        let mut best = (start.spot.branch, start.spot.value);
        let mut steps = [FIRST_STEP; DIRECTIONS.len()];
        for _ in 0..MAX_POLLS {
            let (mut is_done, before) = (true, best.1);
            for (direction, step) in DIRECTIONS.iter().zip(&mut steps) {
                if *step >= LEAST_STEP && is_searched(direction) {
                    is_done = false;
                    (best, *step) = self.poll(start, best, (direction, *step), memory);
                }
            }
            let gain = before - best.1;
            let likely = LIKELY_ROUNDS * gain + WORTHWHILE * best.1.abs();
            if is_done || gain > 0.0 && best.1 - likely > known {
                break;
            }
        }
        best
    }

    /// Tries a step in `direction` and in the opposite direction, and then the vertex of the parabola through
    /// the three values. Returns the best posture and the next step.
    fn poll(
        &self,
        start: &PostureCandidate,
        best: Judged,
        (direction, step): (&Direction, f64),
        memory: &mut PostureMemory,
    ) -> (Judged, f64) {
        let mut at = |share: f64| {
            let inverse = &self.placed.mapper.arm.inverse;
            let moves = COORDINATES.into_iter().zip(direction).filter(|(_, by)| **by != 0.0);
            let mut branch = best.0;
            for (coordinate, by) in moves {
                branch = inverse.moved(branch, coordinate, by * share, &self.attitudes)?;
            }
            Some((branch, self.value_of(start, branch, memory)?))
        };
        let (below, above) = (at(-step), at(step));
        let vertex = match (below, above) {
            (Some((_, below)), Some((_, above))) => {
                let bend = below - 2.0 * best.1 + above;
                let vertex = step * (below - above) / (2.0 * bend);
                (bend > 0.0 && vertex.abs() < step).then(|| at(vertex)).flatten()
            }
            _ => None,
        };
        let gained = |found: &Judged| found.1 < best.1 - LEAST_GAIN * best.1.abs();
        let found = [below, above, vertex].into_iter().flatten().filter(gained);
        match found.min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some(found) if Some(found) == vertex => (found, step * SHRINK),
            Some(found) => (found, step),
            None => (best, step * SHRINK),
        }
    }

    /// Returns the posture `refined` as a candidate if it is usable. Otherwise bisects the path from the start
    /// to `refined` for its last usable posture. For a layout to build, returns a usable posture at
    /// three quarters of the way to this last posture, or the start.
    fn last_usable(
        &self,
        start: PostureCandidate,
        refined: Judged,
        memory: &mut PostureMemory,
    ) -> PostureCandidate {
        let inverse = &self.placed.mapper.arm.inverse;
        let (mut usable, mut beyond, mut tried) = (start, refined.0, refined);
        let is_to_build = self.placed.demand.is_some();
        let bisections = if is_to_build { BISECTIONS_TO_BUILD } else { BISECTIONS };
        for _ in 0..=bisections {
            let (branch, value) = tried;
            if branch == usable.spot.branch {
                break;
            }
            let candidate = at_branch(start, tried);
            match value < usable.spot.value && self.is_usable(&candidate, memory) {
                true if branch == refined.0 => return candidate,
                true => usable = candidate,
                false => beyond = branch,
            }
            let middle = inverse.between(usable.spot.branch, beyond, &self.attitudes);
            tried = (middle, self.value_of(&start, middle, memory).unwrap_or(f64::INFINITY));
        }
        if !is_to_build || usable.spot.branch == start.spot.branch {
            return usable;
        }
        let middle = inverse.between(start.spot.branch, usable.spot.branch, &self.attitudes);
        let branch = inverse.between(middle, usable.spot.branch, &self.attitudes);
        let value = self.value_of(&start, branch, memory).unwrap_or(f64::INFINITY);
        let inside = at_branch(start, (branch, value));
        let is_better = value < start.spot.value && self.is_usable(&inside, memory);
        if is_better { inside } else { start }
    }

    /// Returns the value of the branch `branch` at the node of `start`; None if the branch does not exist,
    /// exceeds a joint limit, or if the errors cannot be computed.
    fn value_of(&self, start: &PostureCandidate, branch: u64, memory: &mut PostureMemory) -> Option<f64> {
        let (arm, context) = (&self.placed.mapper.arm, self.context.as_ref().ok()?);
        let posture = arm.inverse.usable(&start.target, &self.attitudes, branch)?;
        let PostureMemory { frames, scratch, counts, .. } = memory;
        counts.postures += 1;
        arm.chain.place(&posture, frames);
        Some(self.setup.value(context, frames, scratch))
    }
}

/// Returns a candidate at the same node as `candidate`, with another branch and its value.
fn at_branch(candidate: PostureCandidate, (branch, value): Judged) -> PostureCandidate {
    let spot = Spot { branch, value, ..candidate.spot };
    PostureCandidate { spot, contact: ArmContact::Unknown, first: None, ..candidate }
}
