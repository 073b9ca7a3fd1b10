//! Progress of a search: a bar on a terminal, lines of JSON for programs.

use super::output;
use crate::cell::Unit;
use crate::cli::mutex::locked;
use crate::layout::Workcell;
use crate::record::{PROGRESS_SCHEMA, ProgressLine};
use crate::search::Progress;
use indicatif::ProgressBar;
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Least time between two lines of progress.
const PERIOD: Duration = Duration::from_secs(1);

/// Form of the progress report.
enum ProgressForm {
    Bar(ProgressBar),
    Lines,
    Silent,
}

/// Reporter that prints the progress of a search on stderr.
pub struct Reporter {
    manner: ProgressForm,
    unit: Unit,
    bound: Option<f64>,
    /// Number of evaluations before this process started; 0 unless it resumes a stopped search.
    before: u64,
    clock: Instant,
    /// Time of the last line, and the progress not yet reported.
    last: Mutex<(Instant, Option<Progress>)>,
}

impl Reporter {
    /// Returns a reporter in the form `manner`. The default is a bar on a terminal and lines of JSON
    /// elsewhere.
    pub fn new(manner: Option<&str>, workcell: &Workcell, bound: Option<f64>, before: u64) -> Self {
        let bar = || ProgressForm::Bar(output::progress_bar(workcell.cell.search.budget));
        let manner = match manner {
            Some("bar") => bar(),
            Some("json") => ProgressForm::Lines,
            Some(_) => ProgressForm::Silent,
            None if std::io::stderr().is_terminal() => bar(),
            None => ProgressForm::Lines,
        };
        let clock = Instant::now();
        let last = Mutex::new((clock, None));
        Self { manner, unit: workcell.cell.unit(), bound, before, clock, last }
    }

    /// Reports progress.
    pub fn tell(&self, progress: Progress) {
        match &self.manner {
            ProgressForm::Bar(bar) => {
                bar.set_position(progress.evaluations);
                bar.set_message(self.in_words(progress));
            }
            ProgressForm::Lines => {
                let mut last = locked(&self.last);
                last.1 = Some(progress);
                if last.0.elapsed() >= PERIOD {
                    *last = (Instant::now(), None);
                    output::talk(&self.line(progress));
                }
            }
            ProgressForm::Silent => {}
        }
    }

    /// Removes the bar, or prints the last progress if no line has reported that progress.
    pub fn finish(self) {
        let last = self.last.lock().map_or(None, |last| last.1);
        if let ProgressForm::Bar(bar) = &self.manner {
            bar.finish_and_clear();
        }
        if let Some(progress) = last {
            output::talk(&self.line(progress));
        }
    }

    /// Returns the gap between the best objective and the lower bound, as a share of the bound. Returns None
    /// without a positive bound or a feasible layout.
    fn gap(&self, p: Progress) -> Option<f64> {
        let bound = self.bound.filter(|b| *b > 0.0)?;
        Some(p.best? / bound - 1.0)
    }

    /// Returns the number of evaluations per second in this process.
    fn rate(&self, p: Progress) -> f64 {
        let own = p.evaluations.saturating_sub(self.before);
        own as f64 / self.clock.elapsed().as_secs_f64().max(1e-3)
    }

    fn in_words(&self, p: Progress) -> String {
        let best = p.best.map_or("none yet".to_string(), |best| {
            format!("{:.4} {}", self.unit.from_si(best), self.unit.word())
        });
        let gap = self.gap(p).map_or(String::new(), |gap| format!(", gap {:.2} %", 100.0 * gap));
        let share = 100.0 * p.feasible as f64 / p.evaluations.max(1) as f64;
        format!("{best}{gap}, {share:.0} % feasible, {:.0}/s", self.rate(p))
    }

    fn line(&self, p: Progress) -> String {
        let (rate, value) = (self.rate(p), |v: f64| self.unit.from_si(v));
        let left = p.budget.saturating_sub(p.evaluations) as f64 / rate;
        let line = ProgressLine {
            schema: PROGRESS_SCHEMA.into(),
            evaluations: p.evaluations,
            budget: p.budget,
            best: p.best.map(value),
            bound: self.bound.map(value),
            unit: self.unit,
            gap: self.gap(p),
            feasible_share: p.feasible as f64 / p.evaluations.max(1) as f64,
            evaluations_per_second: rate.round(),
            seconds: self.clock.elapsed().as_secs_f64(),
            seconds_left: (rate > 0.0).then(|| left.round()),
        };
        // The record holds only numbers and short texts, so the conversion cannot fail.
        serde_json::to_string(&line).unwrap_or_default()
    }
}
