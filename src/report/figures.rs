//! Figures of the seed paper (the 1990s paper from which this project grew), drawn for any cell: pictures
//! with their captions.

use super::chart;
use crate::assess::Assessment;
use crate::cell::{Quantity, Reading};
use crate::drawing::{Detail, Drawing};
use crate::error_map::{NodeSign, OperationMap, PostureRecord};
use crate::files::shown;
use crate::kinematic_error::{Discrepancy, discrepancy};
use crate::raster::{Shot, Show, png};
use crate::svg_text::escaped;
use crate::units::{mm_from_m, rounded};
use std::fmt::Write;

/// Picture with its caption.
pub struct PaperFigure {
    /// Name of the file.
    pub name: String,
    /// Figure of the seed paper that the picture corresponds to.
    pub of: &'static str,
    /// Caption that describes the figure of the seed paper.
    pub paper: &'static str,
    /// Caption that describes this picture.
    pub ours: String,
    pub bytes: Vec<u8>,
}

/// Format of the pictures: size and background.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Format {
    /// Width, px; the height is five eighths of the width.
    pub width: usize,
    pub dark: bool,
}

/// Error map of the seed paper: file name, figure, component drawn, and caption in the paper.
type Map = (&'static str, &'static str, Show, &'static str);
const COMPONENT: &str = "One component of the error at every node of the worktop as an arrow; circles on the \
                         nodes that the robot cannot reach.";
const MAPS: [Map; 5] = [
    ("04-x", "Fig. 4", Show::X, COMPONENT),
    ("04-y", "Fig. 4", Show::Y, COMPONENT),
    ("04-z", "Fig. 4", Show::Z, COMPONENT),
    ("05-resultant", "Fig. 5", Show::Resultant, "The resultant of the three components at every node."),
    (
        "06-in-plane",
        "Fig. 6",
        Show::InPlane,
        "The error in the sense that matters to the operation: in x and y for an assembly, where z does not \
         matter while parts mate. The node with the least error is the spot of the operation.",
    ),
];

/// Draws all figures of a cell. The maps for Fig. 4 to 6 of the seed paper show the first operation. The map
/// for Fig. 7 shows all operations together. Every file name begins with `prefix`.
///
/// # Errors
/// Fails if a picture cannot be drawn.
pub fn figures(a: &Assessment<'_>, prefix: &str, format: Format) -> Result<Vec<PaperFigure>, String> {
    let drawing = Drawing::new(a, &Detail::PLAIN)?;
    let shot =
        Shot { width: format.width, height: format.width * 5 / 8, dark: format.dark, ..Shot::default() };
    let mut all = vec![PaperFigure {
        name: format!("{prefix}01-cell.png"),
        of: "Fig. 1",
        paper: "The model of the robot with its working envelope.",
        ours: cell_words(a),
        bytes: png(&drawing, &Shot { show: Show::Nothing, envelope: true, ..shot.clone() })?,
    }];
    for (name, of, show, paper) in MAPS {
        let Some(map) = a.maps.first() else { break };
        let sense = show.sense().map(str::to_string);
        let shot = Shot { operation: Some(map.operation), show, sense, ..shot.clone() };
        let (name, ours) = (format!("{prefix}{name}.png"), map_words(a, map, show.sense().unwrap_or("xyz")));
        all.push(PaperFigure { name, of, paper, ours, bytes: png(&drawing, &shot)? });
    }
    if a.maps.len() > 1 {
        let own: Vec<String> =
            a.maps.iter().map(|m| map_words(a, m, &a.cell.operations[m.operation].sense.name)).collect();
        all.push(PaperFigure {
            name: format!("{prefix}07-all.png"),
            of: "Fig. 7",
            paper: "Error maps on a worktable and on a conveyor in one cell.",
            ours: own.join(" "),
            bytes: png(&drawing, &shot)?,
        });
    }
    all.push(PaperFigure {
        name: format!("{prefix}08-discrepancy.svg"),
        of: "Fig. 8",
        paper: "Difference between the linearized and the nonlinear model, eq. (9), node by node. The paper's \
                claim: nowhere above 1 %.",
        ours: a.maps.iter().map(|m| discrepancy_words(a, m)).collect::<Vec<_>>().join(" "),
        bytes: chart::discrepancy(a).into_bytes(),
    });
    Ok(all)
}

/// Returns a name with its Markdown and HTML characters escaped.
fn marked(name: &str) -> String {
    let special = |c: char| "\\`*_{}[]()#|!~".contains(c);
    escaped(&shown(name)).chars().flat_map(|c| special(c).then_some('\\').into_iter().chain([c])).collect()
}

fn cell_words(a: &Assessment<'_>) -> String {
    let names: Vec<String> = a.cell.equipment.iter().map(|e| marked(&e.name)).collect();
    let reach = rounded(mm_from_m(a.cell.robot.reach()), 0);
    format!(
        "{} (reach {reach} mm from its base) at home with {}. Lines show the reach of the arm within its \
        joint limits, with the tool held as in the operations. The lines are in horizontal planes and in \
        the vertical plane of the arm. The stronger line is at the height of the work.",
        marked(&a.cell.robot.name),
        names.join(", ")
    )
}

fn map_words(a: &Assessment<'_>, map: &OperationMap, sense: &str) -> String {
    let operation = marked(&a.cell.operations[map.operation].name);
    let (ok, all) = (map.count(NodeSign::Usable), map.nodes.len());
    let occurs = |sign: &NodeSign| !sign.is_usable() && map.count(*sign) > 0;
    let others = NodeSign::ALL.into_iter().filter(occurs);
    let others: Vec<String> = others.map(|sign| format!("{} {}", map.count(sign), sign.label())).collect();
    let mut words = format!("{operation}: {ok} of {all} nodes can be used");
    if !others.is_empty() {
        let _ = write!(words, " ({})", others.join(", "));
    }
    if let Some((low, high, node)) = range(a, map, sense) {
        let unit = a.cell.unit().word();
        let at = &map.nodes[node];
        let [x, y] = [at.position.x, at.position.y].map(|v| rounded(mm_from_m(v), 1));
        let word = crate::record::value_word(a.cell);
        let _ = write!(
            words,
            "; {word} in {} from {low:.3} {unit} at node ({}, {}), where x = {x} mm and y = {y} mm, to {high:.3} {unit}",
            marked(sense),
            at.i,
            at.j
        );
    }
    words + "."
}

/// Returns the least and the greatest value of a map for one sense, and the node with the least value. Values
/// are in the unit of the sense. If the reading is statistical and the quantity is the yield, the values are
/// shares of failures.
fn range(a: &Assessment<'_>, map: &OperationMap, sense: &str) -> Option<(f64, f64, usize)> {
    let sense = map.sense(sense)?;
    let unit = match (a.cell.reading, a.cell.quantity) {
        (Reading::Statistical, Quantity::Yield) => a.cell.unit(),
        _ => map.senses[sense].unit,
    };
    let value = |p: &PostureRecord| p.figures[sense].in_reading(a.cell.reading, a.cell.quantity);
    let values = map.usable().map(|(k, _, p)| (k, unit.from_si(value(p))));
    let values: Vec<(usize, f64)> = values.collect();
    let (node, low) = values.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((low, values.iter().map(|v| v.1).fold(low, f64::max), node))
}

fn discrepancy_words(a: &Assessment<'_>, map: &OperationMap) -> String {
    let all: Vec<Discrepancy> = map.usable().map(|(_, _, p)| discrepancy(&p.nonlinear, &p.linear)).collect();
    let said = |name: &str, value: fn(&Discrepancy) -> Option<f64>| {
        let values: Vec<f64> = all.iter().filter_map(value).collect();
        let most = values.iter().copied().fold(0.0, f64::max);
        let above = values.iter().filter(|v| **v > 1.0).count();
        let nodes = if above == 0 { String::new() } else { format!(" (above 1 % at {above})") };
        format!("{name} {most:.3} %{nodes}")
    };
    let senses =
        [said("resultant", |d| d.resultant), said("x", |d| d.x), said("y", |d| d.y), said("z", |d| d.z)];
    let operation = marked(&a.cell.operations[map.operation].name);
    format!("{operation}, over {} nodes, largest: {}.", all.len(), senses.join(", "))
}

/// Returns the Markdown index of a folder: one chapter for each cell with its figures.
pub fn readme(chapters: &[(String, Vec<PaperFigure>)], command: &str) -> String {
    let mut out = String::from(
        "# The figures of the seed paper, drawn anew\n\nMade by one command (into a new folder; nothing is \
         overwritten):\n\n",
    );
    // Writing to a String cannot fail, so the results of the writes below are ignored.
    let _ = writeln!(out, "    sweetspot {command}\n");
    out.push_str(
        "Arrows show the errors, enlarged by the factor in each picture; their colour shows the size \
        of the displayed error. An error without a sign has two arrows in opposite directions. The spot \
        in each picture is the node with the least value of the error component shown.\n",
    );
    for (name, figures) in chapters {
        let _ = writeln!(out, "\n## {}", marked(name));
        for f in figures {
            let of = f.of;
            let _ = writeln!(out, "\n### {of}: {}\n\n![{of}]({})\n", f.name, f.name);
            let _ = writeln!(out, "- The paper: {}\n- Here: {}", f.paper, f.ours);
        }
    }
    out
}
