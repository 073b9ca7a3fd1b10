//! Local search for the corner of the tolerance box with the largest error under a nonlinear model.

use super::MAX_SOURCES;
use super::corner::ToleranceCorner;
use super::corner_model::{CornerError, CornerModel, MAX_FREE, gray_code};
use super::worst_case::WorstCase;
use super::zonotope::Farthest;
use nalgebra::Vector6;

/// Largest number of rounds of the local search from one starting corner.
///
/// A round tries to flip every single sign, and the signs of every group of parallel columns together. A
/// column is the linear effect of one source or of the mean. If no such flip increases the error, the round
/// tries pairs of signs. The search ends early if no pair increases the error either.
const MAX_ROUNDS: usize = 12;

/// Least threshold of the function `by_model`, as a share of the linear worst case.
///
/// The search tries a flip only if it changes the linear error by at most the threshold.
const NEAR_SHARE: f64 = 0.02;

/// Columns count as parallel if the sine of their angle is at most this value. The local search also flips
/// the signs of parallel columns together.
const PARALLEL_SINE: f64 = 1e-6;

/// Largest number of corners that a search remembers, so that it ends early if it reaches one of them again.
const OPTIMA: usize = 16;

/// Returns the worst case by a model.
///
/// A local search starts from the first corner of `corners`, the worst by the linear model, and from the
/// opposite corner. The sizes of the errors at these two corners differ only by terms of even order. The
/// search also starts from the second corner of `corners` and its opposite, if they differ from the first.
/// So the errors at both corners are lower bounds of the result.
///
/// A column is the linear effect of one source at its tolerance. If the sources have means, the linear effect
/// of all means together is one more column. The search also chooses a sign for this column, although the
/// means can only have the sign +1. If the search chooses the sign -1, the model reverses all signs before it
/// computes the error. So both starting corners are the same corner of the box if the sources have means.
///
/// The search flips one sign alone, the signs of all parallel columns together, or the signs of two columns.
/// A flip is tried only if it changes the linear error by no more than a threshold. The threshold is the
/// largest of three values:
///
/// - `quadratic`, an estimate of the size of the second-order terms;
/// - the share `NEAR_SHARE` of the linear worst case;
/// - twice the largest difference between the linear worst case and the error under the model at the two
///   corners.
///
/// A planar arm, for example, needs flips of all parallel columns together. The lateral effects of such an
/// arm are perpendicular to all other effects. So the linear error keeps its size if the signs of all
/// lateral effects are reversed. A single flip does not reach the corner with these reversed signs.
///
/// `largest` returns two corners: the corners with the largest displacement and the largest rotation of the
/// TCP by the linear model. A source is weak if a flip of its sign can change the linear error by at most the
/// threshold. If one to `MAX_FREE` sources are weak, the search first tries all combinations of their signs.
/// The threshold does not apply to these combinations. If more than `MAX_FREE` sources are weak, the search
/// also starts from mixed corners. A mixed corner combines the signs of the weak sources from a corner of
/// `largest` with all other signs from `corner`. The search also tries the mixed corners in which the signs
/// of the weak sources, of the other sources, or of all sources are reversed.
///
/// A flip is skipped if its sources leave the error unchanged at every corner ([`CornerModel::idle`]), or if
/// it gives a combination of weak signs that was already tried. It is also skipped if
/// [`CornerModel::may_exceed`] or [`CornerModel::pair_gains`] proves that it does not increase the error. A
/// combination is skipped if [`CornerModel::predict_combinations`] proves that another combination has a
/// larger error. This saves time and does not change the result of the search.
///
/// The search ends at an error above `enough`. The returned `bool` is false if the search may have ended
/// early. The worst case is then at least the result.
pub fn by_model(
    columns: &[Vector6<f64>],
    linear: &Farthest,
    quadratic: f64,
    corners: [ToleranceCorner; 2],
    model: &mut CornerModel,
    largest: impl FnOnce() -> [ToleranceCorner; 2],
    enough: f64,
) -> (WorstCase, bool) {
    let [corner, other] = corners;
    let n = columns.len();
    let mut start = |corner: ToleranceCorner| SearchCorner::new(columns, model.error(corner), corner);
    let starts = both(corner, n).map(&mut start);
    let others = (!is_same(columns, corner, other)).then(|| both(other, n).map(&mut start));
    let apart = starts.iter().map(|start| (start.error.size - linear.value).abs()).fold(0.0, f64::max);
    let gap = (2.0 * apart).max(NEAR_SHARE * linear.value).max(quadratic);
    let mut search = CornerSearch {
        columns,
        groups: groups(columns),
        gap,
        enough,
        idle: model.idle(),
        model,
        best: None,
        combined: None,
        optima: [ToleranceCorner::default(); OPTIMA],
        known: 0,
    };
    let starts = starts.into_iter().chain(others.into_iter().flatten());
    // Sources with hardly any linear effect act through products of errors. If there are only a few such
    // sources, every combination of their signs is tried. Otherwise these sources take their signs from the
    // corners in `largest`.
    let is_weak = |k: &usize| 2.0 * columns[*k].norm() <= gap;
    let count = (0..columns.len()).filter(is_weak).count();
    let mut weak = [0; MAX_FREE];
    let is_combined = (1..=MAX_FREE).contains(&count);
    let acting = (0..columns.len()).filter(|k| is_combined && is_weak(k) && search.idle >> k & 1 == 0);
    let acting = weak.iter_mut().zip(acting).map(|(to, k)| *to = k).count();
    for start in starts {
        if search.has_enough(&start) {
            return (search.worst(linear, corner), false);
        }
        match is_combined {
            true => search.polish_best_combination(start, &weak[..acting]),
            false => search.polish(start),
        }
    }
    if count > MAX_FREE {
        let strong = (0..n).filter(|k| !is_weak(k)).fold(0, |set, k| set | 1 << k);
        for largest in largest().into_iter().flat_map(|largest| both(largest, n)) {
            for mixed in both(largest.with_signs_of(corner, strong), n) {
                let start = SearchCorner::new(columns, search.model.error(mixed), mixed);
                if search.has_enough(&start) {
                    return (search.worst(linear, corner), false);
                }
                search.polish(start);
            }
        }
    }
    let is_complete = search.best.is_none_or(|(size, _)| size <= enough);
    (search.worst(linear, corner), is_complete)
}

/// Returns a corner of `count` columns and the opposite corner.
pub(super) fn both(corner: ToleranceCorner, count: usize) -> [ToleranceCorner; 2] {
    [corner, corner.opposite(count)]
}

/// Returns whether the columns that are not 0 have the same signs at two corners, or at one corner and the
/// opposite of the other.
fn is_same(columns: &[Vector6<f64>], a: ToleranceCorner, b: ToleranceCorner) -> bool {
    let moving =
        (0..columns.len()).filter(|&k| columns[k] != Vector6::zeros()).fold(0, |set, k| set | 1 << k);
    let apart = (a.negative ^ b.negative) & moving;
    apart == 0 || apart == moving
}

/// Returns, for every column, a bit set of the later columns that are parallel to it.
///
/// A later column of zeros counts as parallel. The set is empty for a column of zeros, and for a column in
/// the set of an earlier column.
fn groups(columns: &[Vector6<f64>]) -> [u128; MAX_SOURCES] {
    let mut groups = [0; MAX_SOURCES];
    let mut taken = 0u128;
    for (k, column) in columns.iter().enumerate().filter(|(_, c)| **c != Vector6::zeros()) {
        if taken >> k & 1 == 0 {
            let after = columns.iter().enumerate().skip(k + 1);
            groups[k] = after.filter(|(_, c)| parallel(c, column)).fold(0, |bits, (j, _)| bits | 1 << j);
            taken |= groups[k];
        }
    }
    groups
}

fn parallel(a: &Vector6<f64>, b: &Vector6<f64>) -> bool {
    let product = a.dot(b);
    a.norm_squared() * b.norm_squared() - product * product
        <= PARALLEL_SINE * PARALLEL_SINE * product * product
}

/// Corner of the tolerance box that the local search has reached.
struct SearchCorner {
    error: CornerError,
    corner: ToleranceCorner,
    /// Linear error at this corner: the sum of the columns multiplied by their signs.
    sum: Vector6<f64>,
    /// Size of `sum`.
    length: f64,
}

impl SearchCorner {
    fn new(columns: &[Vector6<f64>], error: CornerError, corner: ToleranceCorner) -> Self {
        let sum: Vector6<f64> = columns.iter().enumerate().map(|(k, c)| c * corner.sign(k)).sum();
        Self { error, corner, sum, length: sum.norm() }
    }
}

/// State of a local search that starts from several corners in turn.
struct CornerSearch<'a, 'm> {
    /// Linear effects of the sources at their tolerances.
    columns: &'a [Vector6<f64>],
    /// Bit set for each column, as returned by the function `groups`: the later columns that are parallel to
    /// this column.
    groups: [u128; MAX_SOURCES],
    /// Largest change of the linear error that a tried flip may cause, m or rad.
    gap: f64,
    /// The search ends at an error above this value, m or rad.
    enough: f64,
    /// Bit set of the sources that leave the error unchanged at every corner. Their signs are not flipped.
    idle: u128,
    model: &'a mut CornerModel<'m>,
    /// Largest error found, and its corner.
    best: Option<(f64, ToleranceCorner)>,
    /// Bit set of weak sources, and the corner with the largest error over all combinations of their signs.
    combined: Option<(u128, ToleranceCorner)>,
    /// Corners at which the search has ended because no flip increases the error. The first
    /// [`Self::known`] entries are used.
    optima: [ToleranceCorner; OPTIMA],
    known: usize,
}

impl CornerSearch<'_, '_> {
    /// Returns the largest error found, at the corner `start` if the search has not begun. `linear` is the
    /// linear worst case.
    fn worst(&self, linear: &Farthest, start: ToleranceCorner) -> WorstCase {
        let exact = linear.upper <= linear.value;
        let (by_model, corner) = self.best.unwrap_or((f64::NEG_INFINITY, start));
        WorstCase { linear: linear.upper.max(linear.value), exact, by_model, corner }
    }

    /// Returns whether the error at a corner, or the largest error found, exceeds [`Self::enough`]. The corner
    /// then counts as found.
    fn has_enough(&mut self, at: &SearchCorner) -> bool {
        if at.error.size > self.enough {
            self.note(at);
        }
        self.best.is_some_and(|(size, _)| size > self.enough)
    }

    /// Remembers a corner if its error is the largest one found.
    fn note(&mut self, at: &SearchCorner) {
        if self.best.is_none_or(|(size, _)| at.error.size > size) {
            self.best = Some((at.error.size, at.corner));
        }
    }

    /// Tries all combinations of the signs of the `weak` sources at `start`, and searches from the best
    /// combination.
    fn polish_best_combination(&mut self, mut start: SearchCorner, weak: &[usize]) {
        self.model.stand_at(start.corner);
        let mut sizes = [0.0; 1 << MAX_FREE];
        let margin = self.model.predict_combinations(start.corner, &start.error, weak, &mut sizes);
        let sizes = &sizes[..1 << weak.len()];
        // A combination can be the best only if its largest possible size reaches the least possible size of
        // every other combination.
        let limit =
            |margin: f64| sizes[1..].iter().fold(start.error.size, |least, s| least.max(s - margin)) - margin;
        let limit = margin.map_or(f64::NEG_INFINITY, limit);
        let mut tried = start.corner;
        for (step, bit) in gray_code(weak.len()) {
            tried = tried.flipped(1 << weak[bit]);
            if sizes[step] >= limit {
                let size = self.model.size(tried);
                if size > start.error.size {
                    (start.error, start.corner) = (self.model.error(tried), tried);
                }
            }
        }
        self.combined = Some((weak.iter().fold(0, |set, k| set | 1 << k), start.corner));
        self.polish(SearchCorner::new(self.columns, start.error, start.corner));
    }

    /// Returns whether flips of the signs in the bit set `flipped` cannot increase the error, because all
    /// combinations of these signs were already tried at the corner `at`.
    fn was_combined(&self, at: &SearchCorner, flipped: u128) -> bool {
        self.combined.is_some_and(|(weak, corner)| flipped & !weak == 0 && at.corner == corner)
    }

    /// Starts at the corner `start`, and flips single signs and the signs of parallel columns together. If no
    /// such flip increases the error, the search flips pairs of signs.
    fn polish(&mut self, start: SearchCorner) {
        let mut at = start;
        // Number of columns that were tried since the last flip that increased the error.
        let mut tried = 0;
        for _ in 0..MAX_ROUNDS {
            if self.is_optimum(&at) {
                return;
            }
            self.model.stand_at(at.corner);
            for k in 0..self.columns.len() {
                let mut is_larger = self.flip(&mut at, 1 << k);
                // A column without parallel columns has no group to flip.
                if self.groups[k] != 0 {
                    is_larger |= self.flip(&mut at, 1 << k | self.groups[k]);
                }
                if is_larger && (self.has_enough(&at) || self.is_optimum(&at)) {
                    return;
                }
                tried = if is_larger { 0 } else { tried + 1 };
                if tried == self.columns.len() {
                    break;
                }
            }
            if tried < self.columns.len() {
                continue;
            }
            if !self.flip_pair(&mut at) {
                self.note_optimum(&at);
                break;
            }
            tried = 0;
        }
        self.note(&at);
    }

    /// Returns whether an earlier search ended at this corner because no flip increases the error.
    fn is_optimum(&self, at: &SearchCorner) -> bool {
        self.optima[..self.known].contains(&at.corner)
    }

    /// Remembers a corner at which no flip increases the error, unless the list is full.
    fn note_optimum(&mut self, at: &SearchCorner) {
        if let Some(free) = self.optima.get_mut(self.known) {
            *free = at.corner;
            self.known += 1;
        }
    }

    /// Flips the first pair of signs that increases the error and changes the linear error by at most
    /// `self.gap`.
    ///
    /// Pairs matter because products of errors may dominate if the linear effects are small. Returns false if
    /// there is no such pair.
    fn flip_pair(&mut self, at: &mut SearchCorner) -> bool {
        let n = self.columns.len();
        let gains = self.model.pair_gains(&at.error);
        let is_hopeless = |j: usize| gains.as_ref().is_some_and(|gains| !gains.may_increase_with(j, n));
        let may_increase = |j: usize, k: usize| gains.as_ref().is_none_or(|gains| gains.may_increase(j, k));
        let idle = self.idle;
        let acts = |k: usize| idle >> k & 1 == 0;
        (0..n)
            .filter(|&j| acts(j) && !is_hopeless(j))
            .any(|j| (j + 1..n).any(|k| acts(k) && may_increase(j, k) && self.flip(at, 1 << j | 1 << k)))
    }

    /// Reverses the signs in the bit set `flipped` if that increases the error and changes the linear error
    /// by at most `self.gap`. Returns whether the signs were reversed.
    #[inline]
    fn flip(&mut self, at: &mut SearchCorner, flipped: u128) -> bool {
        let acting = flipped & !self.idle;
        if acting == 0 || self.was_combined(at, acting) {
            return false;
        }
        let change: Vector6<f64> =
            members(flipped).map(|k| self.columns[k] * (-2.0 * at.corner.sign(k))).sum();
        let sum = at.sum + change;
        let length = sum.norm();
        if (length - at.length).abs() > self.gap || !self.model.may_exceed(&at.error, members(flipped)) {
            return false;
        }
        let flipped = at.corner.flipped(flipped);
        let is_larger = self.model.size(flipped) > at.error.size;
        if is_larger {
            *at = SearchCorner { error: self.model.error(flipped), corner: flipped, sum, length };
            self.model.stand_at(at.corner);
        }
        is_larger
    }
}

/// Returns the members of a bit set in ascending order.
fn members(mut set: u128) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let next = (set != 0).then_some(set.trailing_zeros() as usize);
        set &= set.wrapping_sub(1);
        next
    })
}
