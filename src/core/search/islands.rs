//! Islands: searches of one cell that differ only in their seeds, merged into one result.
//!
//! The result depends only on the islands and on the order of their seeds, not on when or where the search of
//! each island ran. The result of a single island equals the result of a search with its seed alone.

use super::pareto_front::{MAX_MEMBERS, Member, ParetoFront, differ};
use super::problem::LOSS_DIGITS;
use super::search_space::SearchSpace;
use super::shortlist::REALLY_DIFFERENT;
use super::stopping::SearchEnd;
use super::{Alternative, SearchRecord, alternative, candidate};
use crate::cell::{Goal, Layout, SearchSettings};
use crate::layout::Workcell;
use crate::units::rounded;
use serde::{Deserialize, Serialize};

/// Result of an island. An island is one of several searches that differ only in their seeds. Floating-point
/// numbers must be stored without rounding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Island {
    pub seed: u64,
    /// Best layout, as in [`SearchRecord::best`].
    pub best: Layout,
    /// Cost of the best layout, with the penalty for infeasible layouts.
    pub cost: f64,
    /// Least objective found (m, rad, a share or a cost). None if no layout is feasible and within every
    /// limit.
    pub least: Option<f64>,
    pub evaluations: u64,
    pub feasible: u64,
    pub trace: Vec<(u64, f64)>,
    pub ended: SearchEnd,
    /// Members of the Pareto front or of the shortlist.
    pub alternatives: Vec<IslandLayout>,
}

/// Layout of the Pareto front or of the shortlist of an island.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IslandLayout {
    pub layout: Layout,
    pub cost: f64,
    /// Loss in every goal ([`Goal::loss`]) of a Pareto search, rounded to nine decimal places. The list is
    /// empty for any other search.
    pub losses: Vec<f64>,
}

impl Island {
    /// Converts the result of a search to an island; `settings` are the settings of this search.
    pub fn new(settings: &SearchSettings, record: &SearchRecord) -> Self {
        let loss = |goal: Goal, values: &[f64]| {
            let value = Goal::ALL.iter().position(|g| *g == goal).and_then(|k| values.get(k));
            rounded(goal.loss(value.copied().unwrap_or(f64::INFINITY)), LOSS_DIGITS)
        };
        let alternative = |a: &Alternative| IslandLayout {
            layout: a.candidate.layout.clone(),
            cost: a.candidate.evaluation.cost,
            losses: settings.pareto.iter().map(|goal| loss(goal, &a.goals)).collect(),
        };
        Self {
            seed: settings.seed,
            best: record.best.layout.clone(),
            cost: record.best.evaluation.cost,
            least: record.least,
            evaluations: record.evaluations,
            feasible: record.feasible,
            trace: record.trace.clone(),
            ended: record.ended,
            alternatives: record.alternatives.iter().map(alternative).collect(),
        }
    }

    /// Returns the key by which islands are sorted. Islands that found a feasible layout within every limit
    /// come first, in the order of their least objectives. The other islands follow in the order of the costs
    /// of their best layouts.
    fn rank(&self) -> (bool, f64) {
        (self.least.is_none(), self.least.unwrap_or(self.cost))
    }
}

/// Returns the index of the best island, or of the first of several equally good islands; None if there is no
/// island.
pub fn best_island(islands: &[Island]) -> Option<usize> {
    let rank = |k: &usize| islands[*k].rank();
    (0..islands.len()).min_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    })
}

/// Merges islands, which must be in the order of their seeds, into the result of one search. `bound` is the
/// proven lower bound of the objective, m or rad. Returns None if there is no island.
///
/// The best layout and the reason why the search ended come from the best island ([`best_island`]). The
/// numbers of evaluations are added. The trace lists the improvements as if one search had run the islands in
/// turn. Pareto fronts are merged into the front of all their members. The merged shortlist holds the best
/// layouts of all shortlists that differ from each other.
pub fn merged(workcell: &Workcell, islands: &[Island], bound: Option<f64>) -> Option<SearchRecord> {
    let best = &islands[best_island(islands)?];
    let settings = &workcell.cell.search;
    let kept = match (settings.pareto.is_empty(), settings.keep) {
        (true, 0) => Vec::new(),
        (true, keep) => shortlist(workcell, islands, best, keep),
        (false, _) => front(workcell, islands),
    };
    Some(SearchRecord {
        start: candidate(workcell, workcell.cell.start()),
        best: candidate(workcell, best.best.clone()),
        least: best.least,
        evaluations: islands.iter().map(|island| island.evaluations).sum(),
        feasible: islands.iter().map(|island| island.feasible).sum(),
        trace: trace(islands),
        bound,
        ended: best.ended,
        alternatives: kept.into_iter().filter_map(|a| alternative(workcell, a.layout.clone())).collect(),
    })
}

/// Returns the trace that a search of all islands, one after the other, would have.
fn trace(islands: &[Island]) -> Vec<(u64, f64)> {
    let (mut before, mut all): (u64, Vec<(u64, f64)>) = (0, Vec::new());
    for island in islands {
        for (evaluations, objective) in &island.trace {
            if all.last().is_none_or(|(_, least)| objective < least) {
                all.push((before + evaluations, *objective));
            }
        }
        before += island.evaluations;
    }
    all
}

/// Merges the fronts of all islands, and returns members that are spread over the merged front. The merged
/// front holds the members that no other member dominates. If several members are equal, the first of them
/// is kept.
fn front<'i>(workcell: &Workcell, islands: &'i [Island]) -> Vec<&'i IslandLayout> {
    let settings = &workcell.cell.search;
    let space = SearchSpace::new(&workcell.cell);
    let member = |a: &IslandLayout| Member { point: space.point(&a.layout), losses: a.losses.clone() };
    let all: Vec<&IslandLayout> = islands.iter().flat_map(|island| &island.alternatives).collect();
    let members: Vec<Member> = all.iter().map(|a| member(a)).collect();
    let front = ParetoFront::of_all(settings.pareto, &members);
    let most = if settings.keep > 0 { settings.keep } else { MAX_MEMBERS };
    let place = |m: &Member| members.iter().position(|other| other == m);
    front.spread(most).into_iter().filter_map(|m| place(m).map(|k| all[k])).collect()
}

/// Returns the best layouts of all shortlists; the layout of the best island comes first. A layout that is
/// similar to a better layout of another island is left out. The layouts of one island already differ from
/// each other.
fn shortlist<'i>(
    workcell: &Workcell,
    islands: &'i [Island],
    best: &'i Island,
    keep: usize,
) -> Vec<&'i IslandLayout> {
    let space = SearchSpace::new(&workcell.cell);
    let numbered = islands.iter().enumerate().flat_map(|(k, i)| i.alternatives.iter().map(move |a| (k, a)));
    let mut all: Vec<(usize, &IslandLayout)> = numbered.collect();
    // The last phase of a search (`settle`) may choose a layout with more room as the best layout. The
    // objective of this layout may therefore be slightly larger than the objectives of other layouts.
    let is_first = |a: &IslandLayout| best.alternatives.first().is_some_and(|b| std::ptr::eq(a, b));
    all.sort_by(|(_, a), (_, b)| is_first(b).cmp(&is_first(a)).then(a.cost.total_cmp(&b.cost)));
    let mut kept: Vec<(usize, Vec<f64>, &IslandLayout)> = Vec::new();
    for (island, a) in all {
        let point = space.point(&a.layout);
        let differs = |(k, other, _): &(usize, Vec<f64>, &IslandLayout)| {
            *k == island || differ(other, &point, REALLY_DIFFERENT)
        };
        if kept.len() < keep && kept.iter().all(differs) {
            kept.push((island, point, a));
        }
    }
    kept.into_iter().map(|(_, _, a)| a).collect()
}
