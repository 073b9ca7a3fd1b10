//! What if: layouts side by side.
//!
//! An [`Assessment`] is everything known of one layout; a [`Comparison`] is several of them that
//! answer the same question. [`Account`] (budget), [`Explanation`] and [`Distribution`] look at one posture,
//! [`Readings`] at one layout in every reading.

mod budget;
mod difference;
mod distribution;
mod explain;
mod motion;
mod reachable;
mod readings;
mod stance;

pub use budget::{Account, Tighter};
pub use difference::{Difference, NodePair};
pub use distribution::Distribution;
pub use explain::{DhRow, Explanation, Line, SenseRow};
pub use motion::{Motion, Place};
pub use reachable::{Asked, Reachable, Sheet, step_of, tolerance_of};
pub use readings::{Choice, Readings, Row};
pub use stance::{At, NoStance, Stance};

use crate::cell::{Cell, Goals, Layout, Operation, Reading, Role, Unit};

use crate::error_map::{NodeRecord, OperationMap, PostureRecord};
use crate::files::shown;
use crate::layout::{Evaluation, Refined, Robustness, Workcell, evaluate, separated};
use crate::reach::{Envelope, Fineness};
use crate::reading::{Figures, MonteCarlo, monte_carlo};
use crate::units::mm_from_m;

/// One layout, evaluated and mapped.
pub struct Assessment<'a> {
    pub label: String,
    pub cell: &'a Cell,
    pub workcell: &'a Workcell,
    pub layout: Layout,
    pub evaluation: Evaluation,
    pub maps: Vec<OperationMap>,
    /// The spot of every operation between the nodes, where one is free to choose.
    pub refined: Vec<Option<Refined>>,
    /// What misplacement does to every operation, if asked.
    pub robustness: Vec<Option<Robustness>>,
    /// Of the statistical reading: what samples through the nonlinear model say of each spot.
    pub samples: Vec<Option<MonteCarlo>>,
    /// If equipment overlaps: the nearest layout in which none does.
    pub apart: Option<Layout>,
}

impl<'a> Assessment<'a> {
    pub fn new(label: &str, workcell: &'a Workcell, layout: Layout) -> Self {
        let evaluation = evaluate(workcell, &layout);
        let maps = workcell.maps(&layout);
        let apart = if evaluation.overlaps.is_empty() { None } else { separated(workcell, &layout) };
        let refined = workcell.refined(&layout, &maps);
        let samples = (0..maps.len()).map(|k| sampled(workcell, &layout, &maps, k)).collect();
        let (cell, robustness) = (&workcell.cell, Vec::new());
        Self {
            label: label.to_string(),
            cell,
            workcell,
            layout,
            evaluation,
            maps,
            refined,
            robustness,
            samples,
            apart,
        }
    }

    /// The same with what misplacement does to it.
    pub fn misplaced(mut self) -> Self {
        self.robustness = self.workcell.robustness(&self.layout, &self.maps);
        self
    }

    /// Whether it is feasible, and every operation stays so and in its limit wherever the placement
    /// tolerances let things stand; once [`Self::misplaced`] was asked.
    pub fn is_robust(&self) -> bool {
        let holds = |r: &Option<Robustness>| r.as_ref().is_some_and(Robustness::holds);
        self.evaluation.objective.is_some() && self.robustness.iter().all(holds)
    }

    /// What can be reached at the height of an operation's TCP: outlines in the world plan, m. Drawn
    /// coarsely.
    pub fn reachable(&self, operation: usize) -> Vec<Vec<(f64, f64)>> {
        let inverse = self.workcell.inverse();
        let attitude = &self.layout.attitudes[operation];
        let operation = &self.cell.operations[operation];
        let (at, base) = (&self.layout.placements[operation.equipment], &self.layout.base);
        let envelope = Envelope::new(inverse, attitude, at.yaw - base.yaw);
        let step = 2.0 * step_of(&self.cell.robot, inverse);
        let fine = Fineness { step, tolerance: tolerance_of(inverse, step), asked: &|_| () };
        let plan = envelope.plan(at.z + operation.standoff - base.z, &fine);
        let (sin, cos) = base.yaw.sin_cos();
        let world = |[x, y]: [f64; 2]| (base.x + cos * x - sin * y, base.y + sin * x + cos * y);
        plan.outlines.iter().map(|o| o.points.iter().map(|p| world(*p)).collect()).collect()
    }

    /// The spot of an operation: its best usable node.
    pub fn spot(&self, operation: usize) -> Option<(&NodeRecord, &PostureRecord)> {
        let node = self.maps[operation].best_node()?;
        Some((node, node.posture.as_ref()?))
    }

    /// The figures at the spot of an operation in a reported sense, m or rad.
    pub fn figures(&self, operation: usize, sense: &str) -> Option<&Figures> {
        let place = self.maps[operation].sense(sense)?;
        self.spot(operation).map(|(_, posture)| &posture.figures[place])
    }

    /// What the reading says at the spot of an operation in a reported sense, mm or degrees.
    pub fn error_at(&self, operation: usize, sense: &str) -> Option<f64> {
        let unit = self.maps[operation].senses[self.maps[operation].sense(sense)?].unit;
        let figures = self.figures(operation, sense)?;
        Some(unit.from_si(figures.in_reading(self.cell.reading, self.cell.quantity)))
    }

    /// Of the statistical reading: whether the samples confirm the first-order figures of a spot.
    pub fn first_order_holds(&self, operation: usize) -> Option<bool> {
        let name = &self.cell.operations[operation].sense.name;
        Some(self.samples[operation].as_ref()?.confirms(self.figures(operation, name)?))
    }

    /// One per [`crate::cell::Goal::ALL`]: m, rad, m2 or shares; None if the layout is not feasible.
    pub fn goals(&self) -> Option<Vec<f64>> {
        self.workcell.goals(&self.layout, &self.evaluation, &Goals::all())
    }

    /// In mm, degrees or as a share.
    pub fn objective(&self) -> Option<f64> {
        self.evaluation.objective.map(|o| self.cell.unit().from_si(o))
    }

    /// In mm; None if it is no length.
    pub fn objective_mm(&self) -> Option<f64> {
        self.objective().filter(|_| self.cell.unit() == Unit::Length)
    }

    /// How far an operation is from its limit, if it has a spot and a limit that is not part of its
    /// quantity.
    pub fn requirement(&self, operation: usize) -> Option<Requirement> {
        let limit = self.cell.operations[operation].limit.filter(|_| self.cell.unit() != Unit::Share)?;
        let value = self.maps[operation].value?;
        Some(Requirement { limit, margin: limit - value })
    }

    /// Whether every operation with a limit keeps it.
    pub fn meets_requirements(&self) -> bool {
        (0..self.maps.len()).filter_map(|k| self.requirement(k)).all(Requirement::is_met)
    }

    /// Why the layout is not feasible, in words; empty if it is.
    pub fn reasons(&self) -> Vec<String> {
        let overlaps = self.evaluation.overlaps.iter().map(|o| o.in_words(self.cell));
        let spotless = self.maps.iter().filter(|m| m.best.is_none());
        let spotless = spotless.map(|m| stance::no_usable_node(self.cell, m));
        let blocked = self.evaluation.blocked.iter().map(|b| b.in_words(self.cell));
        let mut all: Vec<String> = overlaps.chain(self.way_out()).chain(spotless).chain(blocked).collect();
        if all.is_empty() && self.evaluation.objective.is_none() {
            all.push("feasible as drawn, but not wherever its placement tolerances let it stand".into());
        }
        all
    }

    /// Where the overlapping equipment could stand instead.
    fn way_out(&self) -> Option<String> {
        let apart = self.apart.as_ref()?;
        let moves = self.cell.equipment.iter().zip(self.layout.placements.iter().zip(&apart.placements));
        let moved = moves.filter(|(_, (from, to))| from != to).map(|(e, (_, to))| {
            let world = if e.on.is_some() { " (world)" } else { "" };
            format!("{} at x {:.1}, y {:.1} mm{world}", e.name, mm_from_m(to.x), mm_from_m(to.y))
        });
        Some(format!("nearest without overlap: {}", moved.collect::<Vec<_>>().join("; ")))
    }
}

/// The limit of an operation and what is left to it, m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirement {
    pub limit: f64,
    /// Negative if the limit is passed.
    pub margin: f64,
}

impl Requirement {
    pub fn is_met(self) -> bool {
        self.margin >= 0.0
    }
}

/// How many samples judge a spot.
pub const SAMPLES: usize = 1 << 16;

fn sampled(workcell: &Workcell, layout: &Layout, maps: &[OperationMap], k: usize) -> Option<MonteCarlo> {
    if workcell.cell.reading != Reading::Statistical {
        return None;
    }
    let posture = maps[k].best_node()?.posture.as_ref()?;
    let (situation, frames) = workcell.posed(layout, maps, k, posture).ok()?;
    let gauge = workcell.evaluator(k);
    let p95 = posture.figures[gauge.own()].p95;
    Some(monte_carlo(gauge, &situation, &frames, SAMPLES, workcell.cell.search.seed, p95))
}

/// Layouts that answer the same question.
pub struct Comparison<'a> {
    pub columns: Vec<Assessment<'a>>,
}

impl<'a> Comparison<'a> {
    /// # Errors
    /// Why the layouts cannot be compared.
    pub fn new(columns: Vec<Assessment<'a>>) -> Result<Self, String> {
        if let [first, others @ ..] = &columns[..] {
            for other in others {
                same_question(first, other)?;
            }
        }
        Ok(Self { columns })
    }

    /// Change of an error from the first column, percent; None for the first and where it says nothing.
    pub fn change_percent(
        &self,
        column: usize,
        error: impl Fn(&Assessment<'a>) -> Option<f64>,
    ) -> Option<f64> {
        let (first, this) = (error(&self.columns[0])?, error(&self.columns[column])?);
        (column > 0 && first > 0.0).then(|| (this - first) / first * 100.0)
    }

    /// Names of the equipment that any of the layouts has, obstacles left out.
    pub fn equipment(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        let all = self.columns.iter().flat_map(|c| &c.cell.equipment);
        for equipment in all.filter(|e| e.role == Role::Equipment) {
            if !names.contains(&equipment.name.as_str()) {
                names.push(&equipment.name);
            }
        }
        names
    }
}

fn same_question(a: &Assessment<'_>, b: &Assessment<'_>) -> Result<(), String> {
    let refuse =
        |what: String| Err(format!("{} and {} cannot be compared: {what}", shown(&a.label), shown(&b.label)));
    let names = |c: &Cell| c.operations.iter().map(|o| o.name.clone()).collect::<Vec<_>>().join(", ");
    if names(a.cell) != names(b.cell) {
        return refuse(format!("their operations are {} and {}", names(a.cell), names(b.cell)));
    }
    let read = |c: &Cell| {
        let quantity = if c.reading == Reading::Statistical { c.quantity.name() } else { "" };
        (c.reading.name(), quantity, c.registration.name())
    };
    if read(a.cell) != read(b.cell) {
        let said = |c: &Cell| {
            let (reading, quantity, registration) = read(c);
            format!("{reading} {quantity}").trim().to_string() + &format!(", registration {registration}")
        };
        return refuse(format!("one is read {}, the other {}", said(a.cell), said(b.cell)));
    }
    if a.cell.search.objective != b.cell.search.objective {
        let [x, y] = [a, b].map(|a| a.cell.search.objective.name());
        return refuse(format!("the objective of one is {x}, of the other {y}"));
    }
    if a.cell.search.robust != b.cell.search.robust {
        return refuse("one is judged as drawn, the other misplaced (robust = true)".into());
    }
    let question = |o: &Operation| {
        (o.sense.clone(), o.place.in_words(), o.over, o.weight.to_bits(), o.limit.map(f64::to_bits))
    };
    for (x, y) in a.cell.operations.iter().zip(&b.cell.operations) {
        if question(x) != question(y) {
            let said = |o: &Operation| {
                let Operation { sense, place, over, weight, .. } = o;
                format!("sense {}, {} of {}, weight {weight}", sense.name, over.name(), place.in_words())
            };
            return refuse(format!("{} has {} in one, {} in the other", x.name, said(x), said(y)));
        }
    }
    Ok(())
}
