//! Result of a search: its files, what the terminal shows, and the exit code.

use crate::assess::{Assessment, Comparison};
use crate::cli::commands::{suggest, warn_of_distrust};
use crate::cli::output::path_word;
use crate::cli::results::{RunDescription, WrittenFolder, write_search};
use crate::cli::{Exit, json_text, output};
use crate::files::Source;
use crate::layout::Workcell;
use crate::proof::Proof;
use crate::record::{IslandEntry, SearchResult, objective_word};
use crate::report;
use crate::search::{SearchEnd, SearchRecord};
use std::path::Path;

/// Result of a search, with its assessment.
pub struct SearchOutcome<'a> {
    workcell: &'a Workcell,
    record: &'a SearchRecord,
    proof: &'a Proof,
    comparison: Comparison<'a>,
    document: Option<SearchResult>,
}

impl<'a> SearchOutcome<'a> {
    /// Assesses the result of a search. `islands` lists the islands from which the result was merged; the
    /// list is empty for a search with one seed.
    pub fn new(
        workcell: &'a Workcell,
        record: &'a SearchRecord,
        proof: &'a Proof,
        islands: Vec<IslandEntry>,
    ) -> Self {
        let comparison = Comparison::of_search(workcell, record);
        let document = SearchResult::of_comparison(record, proof, &comparison).map(|d| d.of_islands(islands));
        Self { workcell, record, proof, comparison, document }
    }

    /// Writes the files of the result; `run` is None for a search that was stopped.
    pub fn write(
        &self,
        folder: &Path,
        file: &Path,
        sources: &[Source],
        run: Option<RunDescription>,
    ) -> Result<WrittenFolder, Exit> {
        write_search(folder, file, sources, (self.record, &self.comparison), &self.document, run)
    }

    /// Prints the result, the written files and warnings. `seconds` is the duration of the search.
    pub fn tell(&self, written: &WrittenFolder, seconds: f64, as_json: bool) -> Result<(), Exit> {
        output::data(&if as_json {
            json_text::line(&self.document.clone().map(|document| document.timed(seconds)))?
        } else {
            self.answer(seconds)
        })?;
        written.tell();
        self.comparison.columns.last().into_iter().for_each(warn_of_distrust);
        Ok(())
    }

    /// Suggests a report of the result in `folder`.
    pub fn suggest_report(&self, folder: &Path, as_json: bool) {
        if self.record.found() && !as_json {
            suggest(&format!("report {}", path_word(folder)));
        }
    }

    /// Returns the exit code. A finished search gives [`Exit::AnswerIsNo`] if no feasible layout was found,
    /// or if an operation of the best layout exceeds its limit.
    pub fn exit(&self) -> Exit {
        let misses = self.comparison.columns.last().is_some_and(|best| !best.meets_requirements());
        match (self.record.ended, self.record.found()) {
            (SearchEnd::Interrupted, _) => Exit::Interrupted,
            (SearchEnd::TimeLimit, _) => Exit::Limit,
            (_, true) if !misses => Exit::Done,
            _ => Exit::AnswerIsNo,
        }
    }

    fn answer(&self, seconds: f64) -> String {
        let Self { workcell, record, proof, comparison, .. } = self;
        let cell = &workcell.cell;
        let best = comparison.columns.last().map(|best| best.proven(proof));
        let (proof, gap) = best.unwrap_or_else(|| ((*proof).clone(), None));
        let said = match (record.ended, record.found()) {
            (SearchEnd::NothingToSearch, _) => {
                "nothing to search: every placement and attitude is fixed".to_string()
            }
            (_, false) => "no feasible layout found; `best` is the layout closest to feasible".to_string(),
            (_, true) => match comparison.change_percent(1, Assessment::objective) {
                Some(change) if change > -0.05 => {
                    "no layout better than the start layout was found".to_string()
                }
                Some(change) => {
                    let word = match cell.search.robust {
                        true => {
                            format!("{} (upper bound, proven for every misplacement)", objective_word(cell))
                        }
                        false => objective_word(cell),
                    };
                    format!(
                        "gain: the {word} of the best layout is {:.1} % lower than that of the \
                    start layout",
                        -change
                    )
                }
                None => "the start layout is infeasible, the best layout is feasible".to_string(),
            },
        };
        let limits = match cell.operations.iter().any(|o| o.limit.is_some()) {
            true => "feasible and within every limit",
            false => "feasible",
        };
        let islands = self.document.iter().filter_map(|document| document.islands.as_ref()).next();
        let shown = comparison.columns.last();
        let of_best = |text: fn(&Assessment<'_>) -> String| shown.map(text).unwrap_or_default();
        [
            format!("{}\n", report::text::headline(cell)),
            of_best(report::text::answer),
            format!("\n{said}\n"),
            shown
                .map(Assessment::ending_tolerances)
                .unwrap_or_default()
                .iter()
                .map(|why| format!("  {why}\n"))
                .collect(),
            report::text::proven(workcell, gap, record.least, &proof),
            report::text::front(cell, record),
            format!("\n{}\n", report::text::side_by_side(comparison)),
            // If a layout has a certificate, sampled misplacements add no information.
            shown.filter(|best| best.certificate.is_none()).map(report::text::robustness).unwrap_or_default(),
            of_best(report::text::goals_line),
            report::text::assumptions(cell),
            islands.map(|islands| report::text::islands(cell.unit(), islands)).unwrap_or_default(),
            format!(
                "{} layouts evaluated, {} {limits}, in {seconds:.2} s ({}, {}); {}\n",
                record.evaluations,
                record.feasible,
                cell.search.solver.name(),
                islands.map_or(format!("seed {}", cell.search.seed), |all| format!("{} seeds", all.len())),
                record.ended.in_words(),
            ),
        ]
        .concat()
    }
}
