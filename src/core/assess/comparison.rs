//! Comparison of layouts side by side, and the check that they can be compared.

use super::Assessment;
use crate::cell::{Cell, Operation, Reading, Role};
use crate::layout::Workcell;
use crate::safe_text::shown;
use crate::search::SearchRecord;

/// Layouts with the same operations, reading, registration and objective, side by side.
pub struct Comparison<'a> {
    pub columns: Vec<Assessment<'a>>,
}

impl<'a> Comparison<'a> {
    /// Returns a comparison of layouts, one layout in each column. The first layout is the reference.
    ///
    /// # Errors
    /// Returns the reason if the layouts cannot be compared.
    pub fn new(columns: Vec<Assessment<'a>>) -> Result<Self, String> {
        if let [first, others @ ..] = &columns[..] {
            for other in others {
                same_question(first, other)?;
            }
        }
        Ok(Self { columns })
    }

    /// Returns a comparison of the layout in the cell file with the best layout of a search. Regions are
    /// computed only for the best layout.
    pub fn of_search(workcell: &'a Workcell, record: &SearchRecord) -> Self {
        let [start, best] = [("start", &record.start), ("best", &record.best)]
            .map(|(label, candidate)| Assessment::new(label, workcell, candidate.layout.clone()));
        // Misplacement is analysed only if the cell has a placement tolerance or a limit.
        let limited = workcell.cell.operations.iter().any(|o| o.limit.is_some());
        let matters = workcell.cell.has_placement_tolerance() || limited;
        let best = if matters { best.misplaced() } else { best };
        let columns = [start, best.with_regions()];
        Self { columns: columns.into() }
    }

    /// Returns the relative change of an error from the first layout to the layout in `column`, in percent.
    ///
    /// Returns None for the first layout itself, if either error is missing, or if the first error is zero.
    pub fn change_percent(
        &self,
        column: usize,
        error: impl Fn(&Assessment<'a>) -> Option<f64>,
    ) -> Option<f64> {
        let (first, this) = (error(&self.columns[0])?, error(&self.columns[column])?);
        (column > 0 && first > 0.0).then(|| (this - first) / first * 100.0)
    }

    /// Returns the names of all equipment of the compared layouts, each name once. Obstacles are left out.
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
        return refuse(format!(
            "the first has the operations {}; the second has {}",
            names(a.cell),
            names(b.cell)
        ));
    }
    let read = |c: &Cell| {
        let quantity = if c.reading == Reading::Statistical { c.quantity.name() } else { "" };
        (c.reading.name(), quantity, c.registration.name())
    };
    if read(a.cell) != read(b.cell) {
        let said = |c: &Cell| {
            let (reading, quantity, registration) = read(c);
            format!("{reading} {quantity}").trim().to_string() + &format!(" with registration {registration}")
        };
        return refuse(format!(
            "the reading of the first is {}; the reading of the second is {}",
            said(a.cell),
            said(b.cell)
        ));
    }
    if a.cell.search.objective != b.cell.search.objective {
        let [x, y] = [a, b].map(|a| a.cell.search.objective.name());
        return refuse(format!("the objective of the first is {x}; the objective of the second is {y}"));
    }
    if a.cell.search.robust != b.cell.search.robust {
        return refuse("only one of them is evaluated with its placement tolerances (robust = true)".into());
    }
    let question = |o: &Operation| {
        (o.sense.clone(), o.place.in_words(), o.over, o.weight.to_bits(), o.limit.map(f64::to_bits))
    };
    for (x, y) in a.cell.operations.iter().zip(&b.cell.operations) {
        if question(x) != question(y) {
            let said = |o: &Operation| {
                let Operation { sense, place, over, weight, limit, .. } = o;
                let (of, unit) = (place.in_words(), sense.unit);
                let limit = limit.map_or_else(
                    || "no limit".into(),
                    |l| format!("limit {} {}", unit.from_si(l), unit.word()),
                );
                format!("sense {}, {} of {of}, weight {weight}, {limit}", sense.name, over.name())
            };
            return refuse(format!("{} has {} in the first, but {} in the second", x.name, said(x), said(y)));
        }
    }
    Ok(())
}
