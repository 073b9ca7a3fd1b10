//! Search for usable postures between the sampled values of the redundant joint.
//!
//! The search has three steps. A scan finds intervals that may contain a usable posture. Lipschitz bounds
//! decide whether the target is within reach somewhere in an interval. A golden-section search then reduces
//! the violation of the joint limits.

use super::branch::Gap;
use super::held_joint::{HeldJoint, HeldSample};
use super::redundancy::HeldTarget;
use crate::robot::Posture;

/// Distance between neighbouring values of the scan, in lattice steps (see [`HeldJoint::LATTICE`]).
const SCAN_STEP: u32 = HeldJoint::SAMPLE_STEP / 7;

/// Number of values of the redundant joint that the scan tries.
const SCAN: usize = (HeldJoint::LATTICE / SCAN_STEP) as usize + 1;

/// The search skips a scanned joint value whose [`Gap::limits`] exceeds this constant.
///
/// The constant has the mixed units of [`Gap::limits`]. A larger violation is not expected to vanish within
/// one step of the scan.
const HOPELESS: f64 = 0.5;

/// Largest number of bisections in the search for a joint value at which the target is within reach.
const MAX_PARTS: usize = 128;

/// Smaller part of a golden section, as a share of the whole interval.
const GOLDEN: f64 = 0.381_966_011_250_105_1;

impl HeldTarget<'_> {
    /// Calls [`Self::gap`] and returns its result, with the actual distance for a target that is near.
    ///
    /// The distance from [`Self::gap`] may be a lower bound. If this bound is positive and below `near` (m),
    /// the function replaces the bound by the actual distance.
    fn gap_near(
        &self,
        sample: &HeldSample<'_>,
        near: f64,
        found: &mut dyn FnMut(u64, &Posture),
    ) -> (Gap, bool) {
        let (gap, usable) = self.gap(sample, found);
        if gap.reach == 0.0 || gap.reach >= near {
            return (gap, usable);
        }
        let reach = self.inverse.held_distance(sample, self.first, self.target, self.attitudes);
        (Gap { reach, ..gap }, usable)
    }

    /// Searches for usable postures at values between the samples of the redundant joint.
    ///
    /// A finer scan covers the whole range of the redundant joint. If the scan finds no usable posture, a
    /// golden-section search follows. This search narrows the interval around each value whose [`Gap`] is not
    /// larger than the gaps of its neighbours. Returns the least gap found, and whether a usable posture was
    /// found.
    pub fn search_between(&self, found: &mut dyn FnMut(u64, &Posture)) -> (Gap, bool) {
        let flange = self.inverse.flange(self.first, self.target, self.attitudes);
        let near = self.joint.most_travel(&flange) * f64::from(SCAN_STEP);
        let (mut gaps, mut any) = ([Gap::ALL; SCAN], false);
        for (k, gap) in (0..).zip(&mut gaps) {
            let usable;
            (*gap, usable) = self.gap_near(&self.joint.sample(SCAN_STEP * k), near, found);
            any |= usable;
        }
        if any { (Gap::ALL, true) } else { self.search_around_minima(&gaps, near, |_| true, found) }
    }

    /// Searches for usable postures like [`Self::search_between`], but leaves out the parts of the range that
    /// certainly have none.
    ///
    /// The distance of the target from the reachable points is a Lipschitz function of the redundant joint's
    /// value. Between two scanned values, the distance is therefore greater than 0 if the sum of the two
    /// distances exceeds the Lipschitz constant times the scan step. Lower bounds of the distances suffice
    /// for this test.
    pub fn find_between(&self, found: &mut dyn FnMut(u64, &Posture)) {
        let flange = self.inverse.flange(self.first, self.target, self.attitudes);
        let [near, travel] = [self.joint.most_travel(&flange), self.joint.travel(&flange)]
            .map(|travel| travel * f64::from(SCAN_STEP));
        let (mut gaps, mut any) = ([Gap::ALL; SCAN], false);
        for (k, gap) in (0..).zip(&mut gaps) {
            let usable;
            (*gap, usable) = self.gap(&self.joint.sample(SCAN_STEP * k), found);
            any |= usable;
        }
        if any {
            return;
        }
        let mut is_possible = [false; SCAN];
        for k in 1..SCAN {
            if gaps[k - 1].reach + gaps[k].reach <= travel {
                (is_possible[k - 1], is_possible[k]) = (true, true);
            }
        }
        for k in 0..SCAN {
            let is_needed = is_possible[k.saturating_sub(1)..(k + 2).min(SCAN)].contains(&true);
            if is_needed && gaps[k].reach > 0.0 && gaps[k].reach < near {
                let sample = self.joint.sample(SCAN_STEP * k as u32);
                gaps[k].reach = self.inverse.held_distance(&sample, self.first, self.target, self.attitudes);
            }
        }
        self.search_around_minima(&gaps, near, |k| is_possible[k], found);
    }

    /// Searches around each scanned value whose gap is not larger than the gaps of its neighbours, if
    /// `is_possible` holds for the index of this value. Returns the least gap found, and whether a usable
    /// posture was found.
    ///
    /// `gaps` holds the gaps at the scanned values. Values at which the target is farther out of reach than
    /// `near` (m) are left out.
    fn search_around_minima(
        &self,
        gaps: &[Gap; SCAN],
        near: f64,
        is_possible: impl Fn(usize) -> bool,
        found: &mut dyn FnMut(u64, &Posture),
    ) -> (Gap, bool) {
        let (mut least, mut any) = (Gap::ALL, false);
        for k in (0..SCAN).filter(|k| is_possible(*k)) {
            let higher = |other: usize| !gaps[other].is_less(&gaps[k]);
            let is_far = gaps[k].reach > near || gaps[k].limits > HOPELESS;
            if any || is_far || k > 0 && !higher(k - 1) || k + 1 < SCAN && !higher(k + 1) {
                continue;
            }
            let (gap, usable) = self.search_around(SCAN_STEP * k as u32, gaps[k], found);
            any |= usable;
            least = if gap.is_less(&least) { gap } else { least };
        }
        (least, any)
    }

    /// Searches for a usable posture around the joint value with the lattice number `best` (see
    /// [`HeldSample::number`]). The search moves towards smaller gaps. Returns the least gap, and whether a
    /// usable posture was found.
    ///
    /// `least` is the gap at `best`. The gaps one scan step below and one scan step above `best` must not be
    /// smaller than `least`.
    fn search_around(&self, best: u32, least: Gap, found: &mut dyn FnMut(u64, &Posture)) -> (Gap, bool) {
        let interval = (best.saturating_sub(SCAN_STEP), (best + SCAN_STEP).min(HeldJoint::LATTICE));
        let (best, least) = match least.reach > 0.0 {
            true => self.nearest_reached(interval, (best, least), &mut *found),
            false => (best, least),
        };
        match (least.reach, least.limits) {
            (0.0, 0.0) => (least, true),
            (0.0, _) => self.golden_section(interval, (best, least), found),
            _ => (least, false),
        }
    }

    /// Searches an interval of lattice numbers for a number at which the target is within reach. Returns the
    /// number with the least gap, and this gap.
    ///
    /// The distance of the target from the reachable points is a Lipschitz function of the redundant joint's
    /// value. Parts of the interval that cannot contain a zero of this function are skipped (Piyavskii 1972).
    fn nearest_reached(
        &self,
        (lo, hi): (u32, u32),
        mut least: (u32, Gap),
        found: &mut dyn FnMut(u64, &Posture),
    ) -> (u32, Gap) {
        let flange = self.inverse.flange(self.first, self.target, self.attitudes);
        let most = self.joint.most_travel(&flange);
        let mut gap_at =
            |number: u32| self.gap_near(&self.joint.sample(number), f64::INFINITY, &mut *found).0;
        let mut parts = [(0, Gap::ALL, 0, Gap::ALL); MAX_PARTS + 3];
        let mut count = 2;
        parts[0] = (lo, gap_at(lo), least.0, least.1);
        parts[1] = (least.0, least.1, hi, gap_at(hi));
        for _ in 0..MAX_PARTS {
            if count == 0 || least.1.reach == 0.0 {
                break;
            }
            // Divide the part with the least lower bound of the distance.
            let bound = |p: &(u32, Gap, u32, Gap)| p.1.reach + p.3.reach - most * f64::from(p.2 - p.0);
            let Some(k) = (0..count).min_by(|&a, &b| bound(&parts[a]).total_cmp(&bound(&parts[b]))) else {
                break;
            };
            let (from, before, to, after) = parts[k];
            count -= 1;
            parts[k] = parts[count];
            if bound(&(from, before, to, after)) > 0.0 || to - from < 2 {
                continue;
            }
            let middle = from + (to - from) / 2;
            let gap = gap_at(middle);
            if gap.is_less(&least.1) {
                least = (middle, gap);
            }
            parts[count] = (from, before, middle, gap);
            parts[count + 1] = (middle, gap, to, after);
            count += 2;
        }
        least
    }

    /// Searches an interval of lattice numbers for a usable posture, by a golden-section search for the least
    /// [`Gap`]. Returns the least gap, and whether a usable posture was found.
    ///
    /// `best` is a number inside the interval, and `least` is the gap at `best`.
    fn golden_section(
        &self,
        (mut lo, mut hi): (u32, u32),
        (mut best, mut least): (u32, Gap),
        found: &mut dyn FnMut(u64, &Posture),
    ) -> (Gap, bool) {
        while hi - lo > 2 {
            // Divide the larger part of the interval.
            let up = hi - best >= best - lo;
            let by = ((f64::from(if up { hi - best } else { best - lo }) * GOLDEN) as u32).max(1);
            let number = if up { best + by } else { best - by };
            let (gap, usable) = self.gap_near(&self.joint.sample(number), f64::INFINITY, found);
            if usable {
                return (gap, true);
            }
            match (gap.is_less(&least), up) {
                (true, true) => (lo, best, least) = (best, number, gap),
                (true, false) => (hi, best, least) = (best, number, gap),
                (false, true) => hi = number,
                (false, false) => lo = number,
            }
        }
        (least, false)
    }
}
