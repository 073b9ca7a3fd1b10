//! `robust`: sensitivity to misplaced equipment.

use super::{suggest_with, workcell};
use crate::assess::Assessment;
use crate::cli::arguments::RobustArguments;
use crate::cli::output::path_word;
use crate::cli::{Exit, asked, json_text, output};
use crate::record::RobustDocument;
use crate::report;

/// Runs `sweetspot robust`.
pub fn robust(a: &RobustArguments) -> Result<Exit, Exit> {
    let cell = asked::load(&a.cell, &a.packages, &a.question)?.cell;
    let workcell = workcell(cell, &a.cell)?;
    let assessment = Assessment::new("start", &workcell, workcell.cell.start()).misplaced();
    if a.json {
        json_text::print(&RobustDocument::new(&assessment))?;
    } else {
        let headline = report::text::headline(&workcell.cell);
        let mut said = format!("{headline}\n\n{}", report::text::robustness(&assessment));
        if assessment.evaluation.objective.is_none() {
            said.push_str(&report::text::feasibility(&assessment));
        }
        output::data(&said)?;
        let cell = path_word(&a.cell);
        let searched = !workcell.cell.free().is_empty() && workcell.cell.has_placement_tolerance();
        let next =
            if searched { format!("search {cell} --robust") } else { format!("map {cell} --svg map.svg") };
        suggest_with(&next, &a.packages);
    }
    Ok(if assessment.is_robust() { Exit::Done } else { Exit::AnswerIsNo })
}
