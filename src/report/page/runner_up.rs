//! Runner-up: the next best layout, or the next best spot in the same layout.

use super::quantities::{apart, quantity};
use super::subject::Subject;
use crate::assess::Assessment;
use crate::error_map::{NodeRecord, PostureRecord};
use crate::files::shown;
use crate::layout::combined;
use crate::record::{RunnerUpEntry, RunnerUpKind, nine_digits};

/// Returns the kept layout with the least objective, other than the recommended layout. If the search kept no
/// other layout, returns the second-best node of one operation in the recommended layout. This is the
/// operation whose value increases least from its spot to its second-best node.
pub fn runner_up(subject: &Subject<'_>) -> Option<RunnerUpEntry> {
    let shown_layout = subject.shown();
    shown_layout.evaluation.objective?;
    next_layout(subject).or_else(|| next_node(shown_layout))
}

fn next_layout(subject: &Subject<'_>) -> Option<RunnerUpEntry> {
    let found = subject.found.as_ref()?;
    let unit = subject.cell().unit();
    let valued = found.others().filter_map(|other| Some((other, other.objective_value?)));
    let (next, value) = valued.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let kept = match &found.pareto {
        Some(goals) => format!(
            "least objective among the other layouts of the Pareto front for the goals {}",
            goals.iter().map(|g| g.name()).collect::<Vec<_>>().join(", ")
        ),
        None => {
            "next best of the layouts that the search kept, which differ clearly from each other".to_string()
        }
    };
    let text = super::quantities::told(unit, value);
    Some(RunnerUpEntry { kind: RunnerUpKind::Layout, value, text, note: format!("{}: {kept}", next.file) })
}

type Posed<'m> = (&'m NodeRecord, &'m PostureRecord);

fn next_node(a: &Assessment<'_>) -> Option<RunnerUpEntry> {
    let unit = a.cell.unit();
    let choices = (0..a.maps.len()).filter(|k| !a.cell.operations[*k].over.needs_every_node());
    let seconds = choices.filter_map(|k| Some((k, second(a, k)?, a.maps[k].value?)));
    let (k, (node, posture), best) =
        seconds.min_by(|(_, a, x), (_, b, y)| (a.1.value - x).total_cmp(&(b.1.value - y)))?;
    // The other operations stay at their spots.
    let all = (0..a.maps.len()).map(|o| if o == k { Some(posture.value) } else { a.maps[o].value });
    let total = combined(a.cell, &all.collect::<Option<Vec<f64>>>()?);
    let name = shown(&a.cell.operations[k].name);
    let [next, spot] = apart(unit, posture.value, best);
    let note = format!(
        "the next best spot in the same layout: {name} at node ({}, {}) with {next} instead of {spot}; no other layout was kept",
        node.i, node.j,
    );
    let value = nine_digits(unit.from_si(total));
    Some(RunnerUpEntry { kind: RunnerUpKind::Node, value, text: quantity(unit, total), note })
}

/// Largest number of nodes for which a certificate is computed.
const MAX_CERTIFIED: usize = 32;

/// Returns the usable node with the least value, other than the spot and the points touched to teach a frame.
///
/// If a certificate of the layout was computed, the operation must also be certified at this node. At most
/// [`MAX_CERTIFIED`] nodes are tried.
fn second<'m>(a: &'m Assessment<'_>, k: usize) -> Option<Posed<'m>> {
    let map = &a.maps[k];
    let mut others: Vec<_> = map.usable().filter(|(at, _, p)| Some(*at) != map.best && !p.touched).collect();
    others.sort_by(|a, b| a.2.value.total_cmp(&b.2.value));
    let mut maps = a.maps.clone();
    let mut is_certified = |at: usize| {
        maps[k].best = Some(at);
        let certificate = a.workcell.certificate(&a.layout, &maps);
        matches!(certificate.operations[k], Some(Ok(_)))
    };
    let mut tried = others.into_iter().take(match a.certificate {
        Some(_) => MAX_CERTIFIED,
        None => 1,
    });
    tried
        .find(|(at, ..)| a.certificate.is_none() || is_certified(*at))
        .map(|(_, node, posture)| (node, posture))
}
