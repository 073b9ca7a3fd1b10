//! Export of a PDF: the verdict on page 1, the drawing to scale on page 2, and the report as an appendix.

use super::{cell_file, output_file, posture, write};
use crate::cli::Exit;
use crate::cli::arguments::{ExportArguments, ExportFormat};
use crate::cli::commands::{warn_of_distrust, warn_of_infeasible, workcell};
use crate::cli::report_source::ReportSource;
use crate::report::page::Subject;

/// Writes the PDF, which shows the whole report. Returns whether other formats can show the layout, too. A
/// search without a feasible layout leaves only a report.
pub fn print_out(a: &ExportArguments) -> Result<bool, Exit> {
    // With flags or --start, the layout file inside a result folder is read instead of the whole folder.
    let of =
        if a.start || !a.question.words().is_empty() { cell_file(&a.of, a.start)? } else { a.of.clone() };
    let read = ReportSource::read(&of, &a.packages, &a.question)?;
    let workcell = workcell(read.loaded.cell.clone(), &read.file)?;
    let mut subject = read.subject(&workcell)?;
    if subject.found.is_none() {
        // The pages must not depend on the name of the output file.
        subject.manifest.command = without_out(subject.manifest.command);
    }
    let operation = posture(subject.shown(), a.posture.as_deref())?;
    write(&output_file(a), &pages(&subject, operation)?)?;
    warn_of_infeasible(subject.shown());
    warn_of_distrust(subject.shown());
    Ok(!of.is_dir() || of.join("best.toml").is_file())
}

/// Returns a command line without the name of its output.
fn without_out(command: Vec<String>) -> Vec<String> {
    let mut names_out = false;
    let mut is_kept = |word: &String| {
        let kept = !names_out && !word.starts_with("-o") && !word.starts_with("--out");
        names_out = word == "-o" || word == "--out";
        kept
    };
    command.into_iter().filter(|word| is_kept(word)).collect()
}

/// Returns the pages of the PDF.
#[cfg(feature = "pdf")]
fn pages(subject: &Subject<'_>, operation: Option<usize>) -> Result<Vec<u8>, Exit> {
    use crate::drawing::{Detail, Drawing};
    let drawings = subject.layouts().map(|layout| Drawing::new(layout, &Detail::PLAIN));
    let drawings = drawings.collect::<Result<Vec<_>, _>>();
    let bytes = drawings.and_then(|drawings| crate::report::pdf::pdf(subject, &drawings, operation));
    bytes.map_err(|why| super::cannot(ExportFormat::Pdf, &why))
}

#[cfg(not(feature = "pdf"))]
fn pages(_: &Subject<'_>, _: Option<usize>) -> Result<Vec<u8>, Exit> {
    super::refuse_missing_writer(ExportFormat::Pdf).map(|()| Vec::new())
}
