//! Sections on the assumptions of the report and the provenance of its numbers.

use super::content::{PageTable, Section, plain};
use super::facts::reading_in_words;
use super::subject::{Manifest, Subject};
use crate::cell::{Cell, Distribution, ErrorSet, Registration, Tolerance};
use crate::files::shown;
use crate::record::{caveats, is_guess, reading_word};
use crate::report::text::{distrust, extrapolation};
use crate::units::{mm_from_m, percent_from_share, rounded};

/// Returns the section on the assumptions and the warnings.
pub fn section(subject: &Subject<'_>) -> Section {
    let cell = subject.cell();
    let mut rows = vec![
        said("Reading", format!("{}: {}", reading_word(cell), reading_in_words(cell))),
        said("Registration", registration(cell).into()),
        said("Errors", [errors(cell), extrapolated(subject)].concat()),
        said("Model", format!("{} model of the error; {}", cell.model.name(), trust(subject))),
        said("Collision", collision(cell)),
        said("Motion", motion(cell).into()),
        said("Placement", placement(cell).into()),
    ];
    let assumed = cell.assumed.iter().map(|a| format!("{} = {}: the cell does not state it", a.key, a.value));
    rows.extend(assumed.map(|text| said("Assumed", text)));
    rows.extend(caveats(cell).into_iter().map(|note| said("Note", note)));
    rows.extend(subject.warnings.iter().map(|warning| said("Warning", plain(warning))));
    if !subject.manifest.is_complete {
        rows.push(said(
            "Warning",
            "the search was stopped early; the report shows its results so far".into(),
        ));
    }
    let mut section = Section::new("assumptions", "Assumptions and warnings", Vec::new());
    section.tables.push(PageTable::new("", &["subject", "statement"], rows));
    section
}

fn said(what: &str, text: String) -> Vec<String> {
    vec![what.to_string(), text]
}

fn registration(cell: &Cell) -> &'static str {
    match cell.registration {
        Registration::None => "no registration with the robot: the errors of the robot count in full",
        Registration::BestFit => {
            "the base frame is fitted to the robot over all postures within the joint limits: the errors that this fit cancels are removed"
        }
        Registration::Taught => {
            "the frame of every surface is taught by touching three points with the robot, so the errors that the taught frame cancels are removed"
        }
    }
}

fn errors(cell: &Cell) -> String {
    let name = shown(cell.error_set().name());
    let placeholder = match name.contains("placeholder") {
        true => ": a PLACEHOLDER of plausible size; replace it with measured or agreed tolerances",
        false if is_guess(&name) => ": a GUESS; replace it with measured or agreed tolerances",
        false => "",
    };
    match cell.error_set() {
        ErrorSet::Signed(_) => format!("{name}, one signed sample{placeholder}"),
        ErrorSet::Tolerance(t) => format!("{name}, tolerances, {}{placeholder}", distributions(t)),
        ErrorSet::Measured(m) if m.spread.covariance.is_some() => {
            format!("{name}, measured errors with a covariance{placeholder}")
        }
        ErrorSet::Measured(_) => format!("{name}, measured errors without a covariance{placeholder}"),
    }
}

fn distributions(tolerance: &Tolerance) -> String {
    let is_used =
        |d: &Distribution| tolerance.spreads.iter().any(|s| s.plus_minus > 0.0 && s.distribution == *d);
    let names: Vec<_> = Distribution::ALL.into_iter().filter(is_used).map(Distribution::name).collect();
    match &tolerance.covariance {
        Some(_) => "some of them given by a covariance".to_string(),
        None => names.join(" and "),
    }
}

/// Returns a clause that names the operations with extrapolated errors. The report puts this clause after its
/// description of the error set.
fn extrapolated(subject: &Subject<'_>) -> String {
    let a = subject.shown();
    let said = a.maps.iter().filter_map(|map| {
        let name = shown(&a.cell.operations[map.operation].name);
        Some(format!("; {name}: {}", extrapolation(a.cell, map)?))
    });
    said.collect()
}

fn trust(subject: &Subject<'_>) -> String {
    let a = subject.shown();
    let distrusted = a.maps.iter().filter_map(|map| {
        let name = shown(&a.cell.operations[map.operation].name);
        Some(format!("{name}: {}", distrust(a.cell, map)?))
    });
    let distrusted: Vec<String> = distrusted.collect();
    let guard = rounded(percent_from_share(a.cell.guard), 3);
    match distrusted.is_empty() {
        true => format!(
            "the error differs by at most {guard} % from the error of the nonlinear model at every node, so the model can be trusted"
        ),
        false => distrusted.join("; "),
    }
}

fn collision(cell: &Cell) -> String {
    if !cell.collision {
        return "NOT checked".into();
    }
    match cell.clearance {
        c if c > 0.0 => format!("checked with a clearance of {} mm", rounded(mm_from_m(c), 3)),
        _ => "checked; contact counts as a collision".into(),
    }
}

fn motion(cell: &Cell) -> &'static str {
    match cell.transfer {
        Some(_) => "the moves between the operations are checked for collision",
        None => "only the postures at the nodes are checked for collision, NOT the moves between them",
    }
}

fn placement(cell: &Cell) -> &'static str {
    match (cell.has_placement_tolerance(), cell.search.robust) {
        (true, true) => "evaluated at the worst misplacement within the placement tolerances",
        (true, false) if cell.search.ideal => {
            "evaluated without misplacement; the section on misplacement shows the effect of the placement \
             tolerances"
        }
        (true, false) => {
            "the layout must work at every misplacement within the placement tolerances; errors are shown \
             without misplacement"
        }
        (false, _) => "all equipment and the robot base are assumed to stand exactly at their placements",
    }
}

/// Returns the section on the provenance of the numbers: command, version and files.
pub fn manifest(subject: &Subject<'_>) -> Section {
    let Manifest { command, version, seed, inputs, outputs, source, .. } = &subject.manifest;
    let command: Vec<String> = command.iter().map(|word| plain(word)).collect();
    let mut rows = vec![
        said("Reported", plain(source)),
        said("Command", format!("sweetspot {}", command.join(" "))),
        said("Program", format!("sweetspot {}", shown(version))),
        said("Seed", seed.to_string()),
    ];
    if let Some(found) = &subject.found {
        let search = format!(
            "{}: {} layouts evaluated of at most {}, {} of them feasible and within every limit; ended: {}",
            found.solver.name(),
            found.evaluations,
            found.budget,
            found.feasible,
            found.ended.name()
        );
        rows.push(said("Search", search));
    }
    let hashes = |files: &[(String, String)]| files.iter().map(|(p, h)| vec![plain(p), plain(h)]).collect();
    let mut section = Section::new("manifest", "Origin of the numbers", Vec::new());
    section.tables.push(PageTable::new("", &["subject", "statement"], rows));
    section.tables.push(PageTable::new("Files read", &["file", "SHA-256"], hashes(inputs)));
    if !outputs.is_empty() {
        let checked = "Each file of the folder has been read and matches its hash.";
        section.tables.push(
            PageTable::new("Files of the search", &["file", "SHA-256"], hashes(outputs)).with_note(checked),
        );
    }
    section
}
