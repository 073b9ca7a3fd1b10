//! `view`: a local web server with a page for editing a layout.
//!
//! The server, not the page, holds the session: undo history, evaluation settings and running search. The
//! session continues after a page is closed, and all open pages show the same state. Every number comes from
//! [`crate::layout::evaluate`] and the error maps, as in the other commands.

mod access_control;
mod background;
mod browser;
mod http_response;
mod job;
mod question;
mod requests;
mod routes;
mod save;
mod server;
mod session;
mod values;

pub use access_control::{AccessControl, secret};
pub use background::BackgroundView;
pub use browser::open_in_browser;
pub use save::Origin;
pub use server::LocalServer;
pub use values::requested_layout;

use crate::assess::Assessment;
use crate::cell::{Layout, Model, Reading};
use crate::cli::mutex::locked;
use crate::drawing::{Detail, Drawing};
use crate::layout::{Workcell, evaluate, separated};
use crate::record::{RegionEntry, TurnEntry};
use crate::region::standing;
use crate::report::json::{
    self, LiveLayoutTrial, LivePulse, LiveQuestion, LiveReach, LiveRegions, LiveStanding, LiveState, LiveStep,
};
use crate::units::{mm_from_m, rounded};
use job::SearchThread;
use question::{EvaluationSettings, Workcells};
use requests::{QuestionBody, SearchBody, StandingBody};
use serde_json::{Map, Value};
use session::Session;
use std::sync::{Arc, Mutex};
use values::LayoutValues;

/// Number of decimals to which the objective of the previous step is rounded for the page.
const DIGITS: i32 = 9;
/// Detail of drawings: one model and reading, no envelope, and few nodes.
///
/// A drawing of this detail can be redrawn while the user drags equipment.
const DETAIL: Detail = Detail { lenses: false, envelopes: false, nodes: 1500 };

/// Cell and session that all open pages share.
pub struct LiveView {
    workcells: Workcells,
    /// Cell with the evaluation settings of its file.
    cell: crate::cell::Cell,
    origin: Origin,
    session: Mutex<Session>,
    job: Mutex<Option<SearchThread>>,
    saving: Mutex<()>,
}

impl LiveView {
    /// Starts a session at the layout as drawn.
    pub fn new(workcell: Workcell, origin: Origin) -> Self {
        let cell = workcell.cell.clone();
        let session = Session::new(LayoutValues::start(&cell), EvaluationSettings::of(&cell));
        let workcells = Workcells::new(workcell);
        Self {
            workcells,
            cell,
            origin,
            session: Mutex::new(session),
            job: Mutex::new(None),
            saving: Mutex::new(()),
        }
    }

    /// Returns the document that a page loads first.
    fn state(&self) -> Result<Value, String> {
        let file = crate::files::shown(&self.origin.file.to_string_lossy());
        Ok(json::value(&LiveState { form: json::form(&self.cell), file, now: self.now()? }))
    }

    /// Returns the current step with its assessment, and the objective of the previous step.
    fn now(&self) -> Result<Value, String> {
        let (revision, (undo, redo), question, now, before) = {
            let session = locked(&self.session);
            let before = session.before().map(|step| step.values.clone());
            (session.revision, session.depth(), session.question.clone(), session.now().clone(), before)
        };
        let workcell = self.workcells.ask(&question)?;
        let cell = &workcell.cell;
        let layout = now.values.layout(cell);
        let before = before.map(|values| evaluate(&workcell, &values.layout(cell)));
        let before = before.map(|e| e.objective.map(|o| rounded(cell.unit().from_si(o), DIGITS)));
        let EvaluationSettings { sense, model, reading } = &question;
        Ok(json::value(&LiveStep {
            revision,
            undo,
            redo,
            what: &now.what,
            question: LiveQuestion { sense: sense.as_deref(), model: *model, reading: *reading },
            numbers: json::numbers(cell, &layout),
            lenses: json::lens_list(cell),
            before: before.flatten(),
            answer: json::answer(&assessed(&workcell, layout, true)),
        }))
    }

    /// Evaluates a layout while equipment is dragged. If `draws` is true, adds the drawing for the 3-D view.
    fn attempt(&self, asked: &Map<String, Value>, draws: bool) -> Result<Value, String> {
        let (question, values) = {
            let session = locked(&self.session);
            (session.question.clone(), session.now().values.changed(&self.cell, asked)?)
        };
        let workcell = self.workcells.ask(&question)?;
        let assessment = assessed(&workcell, values.layout(&workcell.cell), false);
        Ok(json::value(&LiveLayoutTrial {
            numbers: json::numbers(&workcell.cell, &assessment.layout),
            answer: json::answer(&assessment),
            drawing: draws.then(|| drawn(&assessment)).transpose()?,
        }))
    }

    /// Returns the drawing of the 3-D view.
    fn drawing(&self) -> Result<Value, String> {
        let (workcell, layout) = self.shown()?;
        drawn(&assessed(&workcell, layout, false))
    }

    /// Adds the coordinates of a request as a new step of the history.
    fn change(&self, asked: &Map<String, Value>) -> Result<(), String> {
        let mut session = locked(&self.session);
        let values = session.now().values.changed(&self.cell, asked)?;
        let what = values.difference(&session.now().values, &self.cell);
        session.step(values, what);
        Ok(())
    }

    /// Adds a new step that restores the layout as drawn.
    fn reset(&self) {
        let mut session = locked(&self.session);
        let start = session.start().clone();
        session.step(start, "back to the layout as drawn".into());
    }

    /// Changes sense, model and reading.
    fn ask(&self, asked: QuestionBody) -> Result<(), String> {
        let model = Model::ALL.into_iter().find(|m| m.name() == asked.model);
        let reading = Reading::ALL.into_iter().find(|r| r.name() == asked.reading);
        let question = EvaluationSettings {
            sense: asked.sense,
            model: model.ok_or("unknown `model`")?,
            reading: reading.ok_or("unknown `reading`")?,
        };
        self.workcells.ask(&question)?;
        locked(&self.session).ask(question);
        Ok(())
    }

    /// Returns the outlines of the reachable region at the height of every operation, in plan, mm.
    fn reach(&self) -> Result<LiveReach, String> {
        let (workcell, layout) = self.shown()?;
        let a = assessed(&workcell, layout, false);
        let mm = |v: f64| rounded(mm_from_m(v), 1);
        let outline = |o: &Vec<(f64, f64)>| o.iter().map(|(x, y)| [mm(*x), mm(*y)]).collect::<Vec<_>>();
        let of = |k: usize| a.reachable(k).iter().map(outline).collect::<Vec<_>>();
        Ok(LiveReach { outlines: (0..a.maps.len()).map(of).collect() })
    }

    /// Returns the region in which each piece of equipment may be moved from the current layout, and how far
    /// the whole cell may be rotated.
    fn room(&self) -> Result<LiveRegions, String> {
        let (workcell, layout) = self.shown()?;
        let a = assessed(&workcell, layout, false).with_regions();
        Ok(LiveRegions { regions: RegionEntry::all(&a), whole_cell: TurnEntry::new(&a) })
    }

    /// Returns the outlines, in plan and in mm, of the region in which a piece of equipment may stand. The
    /// rest of the layout is unchanged.
    fn standing(&self, asked: &StandingBody) -> Result<LiveStanding, String> {
        let (workcell, layout) = self.shown()?;
        if asked.equipment >= workcell.cell.equipment.len() {
            return Err(format!("there is no piece of equipment with the index {}", asked.equipment));
        }
        let rings = standing(&workcell, &layout, asked.equipment, asked.refined);
        let mm = |v: f64| rounded(mm_from_m(v), 1);
        let outline = |ring: &Vec<(f64, f64)>| ring.iter().map(|(x, y)| [mm(*x), mm(*y)]).collect::<Vec<_>>();
        Ok(LiveStanding { outline: rings.iter().map(outline).collect() })
    }

    /// Returns the workcell with the current evaluation settings, and the current layout.
    fn shown(&self) -> Result<(Arc<Workcell>, Layout), String> {
        let (question, values) = {
            let session = locked(&self.session);
            (session.question.clone(), session.now().values.clone())
        };
        let workcell = self.workcells.ask(&question)?;
        let layout = values.layout(&workcell.cell);
        Ok((workcell, layout))
    }

    /// Starts a search from the current layout, with the current sense, model and reading.
    fn search(&self, asked: &SearchBody) -> Result<(), String> {
        let (question, values) = {
            let session = locked(&self.session);
            (session.question.clone(), session.now().values.clone())
        };
        let cell = values.starting(&self.workcells.ask(&question)?.cell, false);
        if cell.free().is_empty() {
            return Err("nothing to search: every placement and attitude is fixed in the file".into());
        }
        let cell = cell.searching(asked.seed, asked.budget)?;
        let mut job = locked(&self.job);
        if job.as_ref().is_some_and(SearchThread::is_running) {
            return Err("a search is already running: stop it first".into());
        }
        *job = Some(SearchThread::start(cell)?);
        Ok(())
    }

    /// Stops the running search.
    fn stop(&self) {
        if let Some(job) = &*locked(&self.job) {
            job.stop();
        }
    }

    /// Adds the best layout of the search as a new step of the history.
    fn accept(&self) -> Result<(), String> {
        let best = locked(&self.job).as_ref().and_then(SearchThread::best);
        let best = best.ok_or("no search has found a feasible layout yet")?;
        let mut session = locked(&self.session);
        session.step(LayoutValues::of(&self.cell, &best), "the layout that the search found".into());
        Ok(())
    }

    /// Returns the revision of the session and the state of the search. Both may change without a request
    /// from this page.
    fn pulse(&self) -> LivePulse {
        let search = locked(&self.job).as_ref().map(SearchThread::record);
        LivePulse { revision: locked(&self.session).revision, search }
    }
}

fn drawn(a: &Assessment<'_>) -> Result<Value, String> {
    Ok(json::drawings(&[Drawing::new(a, &DETAIL)?]))
}

/// Assesses a layout for the page: spots at nodes only, without Monte Carlo samples or misplacements.
///
/// If `is_settled` is true and equipment overlaps, also finds the nearest layout without overlaps.
fn assessed<'a>(workcell: &'a Workcell, layout: Layout, is_settled: bool) -> Assessment<'a> {
    let evaluation = evaluate(workcell, &layout);
    let maps = workcell.maps(&layout);
    let overlaps = is_settled && !evaluation.overlaps.is_empty();
    let apart = if overlaps { separated(workcell, &layout) } else { None };
    let is_certified = workcell.certifies() && evaluation.objective.is_some();
    let certificate = is_certified.then(|| workcell.certificate(&layout, &maps));
    let operations = maps.len();
    Assessment {
        label: "view".into(),
        cell: &workcell.cell,
        workcell,
        layout,
        evaluation,
        maps,
        refined: vec![None; operations],
        robustness: Vec::new(),
        samples: vec![None; operations],
        cell_yield: None,
        confirmed: vec![None; operations],
        certificate,
        regions: None,
        apart,
    }
}
