//! Islands: searches with successive seeds whose results are merged into one result.

use super::fixed;
use super::table::TextTable;
use crate::cell::Unit;
use crate::record::IslandEntry;

/// Largest number of rows in the terminal; search.json has all islands.
const MAX_ROWS_SHOWN: usize = 20;

/// Returns a table of the islands, with a star at the best island.
pub fn islands(unit: Unit, all: &[IslandEntry]) -> String {
    let mut table = TextTable::indented(2);
    table.row(["", "seed", &format!("least objective, {}", unit.word()), "evaluations", "feasible"]);
    let best = all.iter().position(|island| island.is_best);
    // The best island is shown in any case.
    let shown = |k: &usize| *k < MAX_ROWS_SHOWN || best == Some(*k);
    for island in (0..all.len()).filter(shown).map(|k| &all[k]) {
        let star = if island.is_best { "*" } else { "" };
        let least = island.least_value.map_or("none".to_string(), |least| fixed(least, 4));
        let [seed, evaluations, feasible] =
            [island.seed, island.evaluations, island.feasible].map(|count| count.to_string());
        table.row([star.to_string(), seed, least, evaluations, feasible]);
    }
    let more = all.len().saturating_sub(MAX_ROWS_SHOWN);
    let more =
        if more > 0 { format!("of {} islands; all are in search.json\n", all.len()) } else { String::new() };
    format!("\nislands\n{}{more}", table.render())
}
