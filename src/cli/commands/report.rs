//! `report`: writes one HTML page about a layout or a search result.

use super::{measured, refuse_other_pages, suggest_with, warn_of_distrust, within_size, workcell};
use crate::cli::arguments::ReportArguments;
use crate::cli::output::path_word;
use crate::cli::report_source::{ReportSource, hashed};
use crate::cli::{Exit, json_text, loading, output};
use crate::drawing::Drawing;
use crate::record::VerdictAnswer;
use crate::report::page;
use crate::report::page::{Report, Subject};
use crate::search::SearchEnd;
use std::path::Path;

/// Runs `sweetspot report`.
pub fn report(a: &ReportArguments) -> Result<Exit, Exit> {
    refuse_other_pages(&a.out)?;
    let read = ReportSource::read(&a.of, &a.packages, &a.question)?;
    let workcell = workcell(read.loaded.cell.clone(), &read.file)?;
    let file = read.file.clone();
    let mut subject = read.subject(&workcell)?;
    subject.measured = measured::compared(&a.measured, &workcell.cell)?;
    let tables = measured::sources(&a.measured)?;
    subject.manifest.inputs.extend(tables.iter().map(hashed));
    let mut verdict = None;
    let html = within_size(|detail| {
        let drawings = subject.layouts().map(|a| Drawing::new(a, detail)).collect::<Result<Vec<_>, _>>()?;
        let Report { html, verdict: told } = page::report(&subject, &drawings)?;
        verdict = Some(told);
        Ok(html)
    })?;
    let Some(verdict) = verdict else { return Err(Exit::Io) };
    let report = Report { html, verdict };
    loading::write_output(&a.out, report.html.as_bytes())?;
    tell(a, &file, &subject, &report)?;
    Ok(if report.verdict.answer == VerdictAnswer::Yes { Exit::Done } else { Exit::AnswerIsNo })
}

fn tell(a: &ReportArguments, file: &Path, subject: &Subject<'_>, report: &Report) -> Result<(), Exit> {
    let verdict = &report.verdict;
    if a.json {
        json_text::print(verdict)?;
    } else {
        let facts = verdict.facts.iter().map(|f| format!("  {}: {} ({})\n", f.label, f.text, f.note));
        let reasons = verdict.reasons.iter().map(|r| format!("  {r}\n"));
        let rest: String = facts.chain(reasons).collect();
        output::data(&format!("{}\n{rest}", verdict.headline))?;
    }
    if verdict.ended.is_some_and(|ended| matches!(ended, SearchEnd::Interrupted | SearchEnd::TimeLimit)) {
        output::talk("note: the search was stopped early: resume it to look for a better layout");
    }
    output::talk(&format!("wrote {} ({} kB)", path_word(&a.out), report.html.len().div_ceil(1 << 10)));
    warn_of_distrust(subject.shown());
    if !a.json {
        let of = path_word(&a.of);
        let movable = !subject.cell().free().is_empty();
        let next = match (&subject.found, movable) {
            (Some(_), _) if subject.best.is_some() => {
                format!("compare {} {of} -o compare.html", path_word(file))
            }
            (Some(_), _) => format!("map {} --svg map.svg", path_word(file)),
            (None, true) => format!("search {of}"),
            (None, false) => format!("map {of} --svg map.svg"),
        };
        suggest_with(&next, &a.packages);
    }
    Ok(())
}
