//! Section that compares measured positions with the predicted errors.

use super::content::{NOTHING, PageFigure, PageTable, Section};
use super::subject::Subject;
use crate::files::shown;
use crate::record::{ComparedFile, RepeatsEntry};
use crate::report::{chart, text};
use crate::units::{percent_from_share, rounded};

/// Returns the section on measured positions; empty if the report has none.
pub fn section(subject: &Subject<'_>) -> Section {
    let text = "This section compares measured positions of this robot with the predicted errors. The errors of the \
                cell predict how far each measured position is from the nominal position. Base and reflectors are \
                fitted with the nominal arm. The measured and the predicted errors leave out the part that this fit \
                absorbs.";
    let mut section = Section::new("measured", "Measured against predicted", vec![text.into()]);
    let files = &subject.measured;
    if files.is_empty() {
        return section;
    }
    section.tables.push(figures(files));
    for file in files {
        let name = shown(&file.file);
        let arrows = "Arrows begin at the nominal positions.";
        section.figures.push(PageFigure::new(
            format!("{name}: measured and predicted errors"),
            arrows,
            chart::measured(file),
        ));
        section.figures.push(PageFigure::new(format!("{name}: residuals"), "", chart::residuals(file)));
        let said = text::measured_findings(file).iter().map(|line| format!("{line}. ")).collect::<String>();
        section.text.push(format!("{name}: {}", said.trim_end()));
        section.tables.extend(file.repeats.as_ref().map(|repeats| postures(&name, repeats).folded()));
    }
    section
}

fn mm(value: f64) -> String {
    format!("{:.3}", rounded(value, 3))
}

fn figures(files: &[ComparedFile]) -> PageTable {
    let or_nothing = |value: Option<f64>, digits: usize| {
        value.map_or(NOTHING.into(), |v| format!("{:.digits$}", rounded(v, digits as i32)))
    };
    let row = |file: &ComparedFile| {
        vec![
            shown(&file.file),
            file.positions.len().to_string(),
            mm(file.measured.mean_mm),
            mm(file.measured.max_mm),
            mm(file.predicted.mean_mm),
            mm(file.residual.mean_mm),
            or_nothing(file.rank_correlation, 3),
            file.spots.count.to_string(),
            or_nothing(file.spots.rank_correlation, 3),
            or_nothing(file.coverage_95.map(percent_from_share), 1),
            or_nothing(file.coverage_95_varying.map(percent_from_share), 1),
            mm(file.spots.predicted_best.measured_mm),
            or_nothing(file.repeats.as_ref().map(|r| r.largest_ap_mm), 3),
            or_nothing(file.repeats.as_ref().map(|r| r.largest_rp_mm), 3),
        ]
    };
    let head = [
        "file",
        "positions",
        "measured mean mm",
        "measured max mm",
        "predicted mean mm",
        "residual mean mm",
        "rank correlation",
        "spots",
        "over spots",
        "in 95 % ellipsoid %",
        "if errors vary %",
        "at best spot mm",
        "AP mm",
        "RP mm",
    ];
    let note = "The rank correlation is Spearman's correlation of predicted and measured sizes. The column \"at best spot\" is the \
    measured error at \
                the spot with the least predicted error. AP and RP are the largest values over all \
                repeated postures (ISO 9283).";
    PageTable::new("Measured and predicted in numbers", &head, files.iter().map(row).collect())
        .with_note(note)
}

fn postures(name: &str, repeats: &RepeatsEntry) -> PageTable {
    let rows = repeats.postures.iter().map(|p| {
        let position = p.position_mm.map(mm);
        let counts = [p.row.to_string(), p.visits.to_string()];
        counts.into_iter().chain(position).chain([mm(p.ap_mm), mm(p.rp_mm)]).collect()
    });
    let head = ["first row", "visits", "x mm", "y mm", "z mm", "AP mm", "RP mm"];
    PageTable::new(format!("{name}: repeated postures"), &head, rows.collect())
}
