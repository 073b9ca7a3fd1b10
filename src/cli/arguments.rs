//! The command line.

use super::commands::{
    ExportArguments, FiguresArguments, InitArguments, ReportArguments, SchemaArguments, ViewArguments,
};
use super::sweep::SweepArguments;
use super::typed::{at, bend, finite, limit, package, seconds, share, step};
use crate::assess::At;
use crate::cell::{Goal, MOST_KEPT, Model, Quantity, Reading, Registration, Solver};
use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Finds where in a robot workcell a precision operation should happen, and where worktable and
/// conveyor must stand so that it can.
#[derive(Parser)]
#[command(
    version,
    about,
    disable_help_subcommand = true,
    before_help = "Example: sweetspot search cells/hitachi_cell.toml"
)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand)]
pub enum Command {
    /// Validate a cell file and everything it refers to; all faults at once
    #[command(before_help = "Example: sweetspot check cells/hitachi_cell.toml")]
    Check(CheckArguments),
    /// Map the error over every work surface of the layout as drawn
    #[command(before_help = "Example: sweetspot map cells/hitachi_paper.toml --svg map.svg")]
    Map(MapArguments),
    /// Search where the equipment must stand and where to operate
    #[command(
        before_help = "Example: sweetspot search cells/hitachi_cell.toml --seed 2 --out results/second-try"
    )]
    Search(SearchArguments),
    /// Search or map a cell with every combination of other values for some of its keys
    #[command(
        before_help = "Example: sweetspot sweep cells/hitachi_cell.toml --set errors=table-2,table-3 --set equipment.worktable.placement.z_mm=600,700"
    )]
    Sweep(SweepArguments),
    /// Put layouts side by side: cell files, best.toml files or folders of a search
    #[command(
        before_help = "Example: sweetspot compare cells/hitachi_cell.toml results/hitachi_cell-001 -o compare.html"
    )]
    Compare(CompareArguments),
    /// Tell at a spot of the layout as drawn which tolerance to tighten first
    #[command(before_help = "Example: sweetspot budget cells/hitachi_cell.toml --operation assembly")]
    Budget(BudgetArguments),
    /// Show the numbers of one posture step by step, to be followed by hand
    #[command(before_help = "Example: sweetspot explain cells/hitachi_paper.toml --at 5,4")]
    Explain(ExplainArguments),
    /// Put every reading and registration of the layout as drawn side by side
    #[command(before_help = "Example: sweetspot readings cells/hitachi_cell.toml --out results/readings")]
    Readings(ReadingsArguments),
    /// Tell what misplaced equipment does to the layout as drawn, and how much it may be misplaced
    #[command(before_help = "Example: sweetspot robust cells/hitachi_cell.toml --limit 15")]
    Robust(RobustArguments),
    /// Write a layout for other programs: CAD, 3-D scene, drawing to scale, tables, picture
    #[command(before_help = "Example: sweetspot export results/hitachi_cell-001 --to dxf -o layout.dxf")]
    Export(ExportArguments),
    /// List the robots that come with the program
    #[command(before_help = "Example: sweetspot robots")]
    Robots(RobotsArguments),
    /// Show a robot: D-H table, limits, tool, reach, error sets, size of its working envelope
    #[command(before_help = "Example: sweetspot robot hitachi_pw10")]
    Robot(RobotArguments),
    /// Draw and measure where a robot can hold its tool: section, plan, volume
    #[command(before_help = "Example: sweetspot envelope hitachi_pw10 --svg envelope.svg")]
    Envelope(EnvelopeArguments),
    /// Make one page that shows it all: verdict, view, maps, tables; of a layout, or of what a search found
    #[command(before_help = "Example: sweetspot report results/hitachi_cell-001 -o report.html")]
    Report(ReportArguments),
    /// Play what-if with a layout in the browser: a page that this machine alone can see
    #[command(before_help = "Example: sweetspot view cells/hitachi_cell.toml --open")]
    View(ViewArguments),
    /// Print the JSON Schema of a kind of file, or write all of them for editors
    #[command(before_help = "Example: sweetspot schema --out schemas")]
    Schema(SchemaArguments),
    /// Draw the figures of the seed paper for cells of your own, as pictures
    #[command(before_help = "Example: sweetspot figures cells/hitachi_paper.toml --out figures")]
    Figures(FiguresArguments),
    /// Write a first cell round a robot of the library, commented and ready to run
    #[command(before_help = "Example: sweetspot init hitachi")]
    Init(InitArguments),
}

/// Where the packages lie whose files a URDF names.
#[derive(Args, Clone, Default)]
pub struct Packages {
    /// The folder of package://NAME/... in a URDF; once for each package
    #[arg(long = "package", value_name = "NAME=DIR", value_parser = package)]
    pub folders: Vec<(String, PathBuf)>,
}

#[derive(Args)]
pub struct CheckArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: Packages,
    /// Print the faults as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// Which errors, how modelled, and where they count: what may be said otherwise than in the cell file.
#[derive(Args)]
pub struct Choice {
    /// Use this error set of the robot
    #[arg(long, value_name = "NAME")]
    pub errors: Option<String>,
    /// Use this error model
    #[arg(long, value_parser = PossibleValuesParser::new(Model::ALL.map(Model::name)))]
    pub model: Option<String>,
    /// Measure every operation in this sense: x, y, z, xy, xyz, rx, ry, rz, rotation, each with
    /// @surface or @tool for other axes, or a sense of the cell file
    #[arg(long, value_name = "SENSE")]
    pub sense: Option<String>,
    /// Largest error with which every operation succeeds: mm, or degrees of a rotation
    #[arg(long, value_name = "MM", value_parser = limit, allow_hyphen_values = true)]
    pub limit: Option<f64>,
}

/// What else may be said otherwise.
#[derive(Args)]
pub struct Overrides {
    #[command(flatten)]
    pub choice: Choice,
    /// Read the errors as one signed sample, as tolerances or as random variables
    #[arg(long, value_parser = PossibleValuesParser::new(Reading::ALL.map(Reading::name)))]
    pub reading: Option<String>,
    /// What of a random error to make small; without --reading, takes the statistical one
    #[arg(long, value_parser = PossibleValuesParser::new(Quantity::ALL.map(Quantity::name)))]
    pub quantity: Option<String>,
    /// What has been measured with the robot itself: nothing, its base frame, the surface frames
    #[arg(long, value_parser = PossibleValuesParser::new(Registration::ALL.map(Registration::name)))]
    pub registration: Option<String>,
}

#[derive(Args)]
pub struct MapArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: Packages,
    #[command(flatten)]
    pub overrides: Overrides,
    /// Print the map as JSON on stdout
    #[arg(long)]
    pub json: bool,
    /// Write the map as a picture
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// Write map.json, map.csv, map.svg, discrepancy.svg and manifest.json into this new folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Args)]
pub struct SearchArguments {
    /// Cell file (TOML)
    #[arg(required_unless_present = "resume")]
    pub cell: Option<PathBuf>,
    #[command(flatten)]
    pub packages: Packages,
    #[command(flatten)]
    pub overrides: Overrides,
    /// Seed of all randomness; the same seed gives the same bytes
    #[arg(long)]
    pub seed: Option<u64>,
    /// Make the worst over the placement tolerances small, not the value as drawn
    #[arg(long)]
    pub robust: bool,
    /// Find the layouts none of which is better than another in all of these goals: two or more of error,
    /// clearance, joint-limits, singularity, travel, footprint
    #[arg(
        long,
        value_name = "GOAL,GOAL,...",
        value_delimiter = ',',
        hide_possible_values = true,
        value_parser = PossibleValuesParser::new(Goal::ALL.map(Goal::name))
    )]
    pub pareto: Option<Vec<String>>,
    /// Tell so many of the best layouts that really differ; with --pareto, of the front
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=MOST_KEPT as u64))]
    pub keep: Option<u64>,
    /// Global solver
    #[arg(long, value_parser = PossibleValuesParser::new(Solver::ALL.map(Solver::name)))]
    pub solver: Option<String>,
    #[command(flatten)]
    pub rules: Rules,
    /// Threads; the result does not depend on it [default: all cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Write the result into this new folder [default: results/CELL-NNN]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Go on with the search that was stopped in this folder
    #[arg(long, value_name = "DIR", conflicts_with = "out")]
    pub resume: Option<PathBuf>,
    /// Seconds between checkpoints; 0: only at the start and when stopped
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "5")]
    pub checkpoint: f64,
    /// How to tell how far it is on stderr [default: a bar on a terminal, else a line of JSON a second]
    #[arg(long, value_parser = PossibleValuesParser::new(["bar", "json", "none"]))]
    pub progress: Option<String>,
    /// Print the result as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// When a search has done enough.
#[derive(Args)]
pub struct Rules {
    /// Layout evaluations
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub budget: Option<u64>,
    /// Stop when the best layout is proven to be within this share of the best possible: 0.01 is 1 %
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub gap: Option<f64>,
    /// Stop searching after so many evaluations without a better layout
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub stagnation: Option<u64>,
    /// Stop after this time with a checkpoint, exit code 4
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time: Option<f64>,
}

#[derive(Args)]
pub struct CompareArguments {
    /// Cell files, or folders that a search has written
    #[arg(required = true)]
    pub layouts: Vec<PathBuf>,
    #[command(flatten)]
    pub packages: Packages,
    #[command(flatten)]
    pub overrides: Overrides,
    /// Write a page that shows them side by side here; a page that is there is replaced
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print the comparison as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct BudgetArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: Packages,
    /// Look at this operation alone [default: all of them]
    #[arg(long, value_name = "NAME")]
    pub operation: Option<String>,
    /// The node: best, or its number along x and along y
    #[arg(long, value_name = "best|I,J", value_parser = at, default_value = "best", hide_default_value = true, allow_hyphen_values = true)]
    pub at: At,
    #[command(flatten)]
    pub overrides: Overrides,
    /// Print the budget as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct ExplainArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: Packages,
    /// Look at this operation [default: the first]
    #[arg(long, value_name = "NAME")]
    pub operation: Option<String>,
    /// The node: best, or its number along x and along y
    #[arg(long, value_name = "best|I,J", value_parser = at, default_value = "best", hide_default_value = true, allow_hyphen_values = true)]
    pub at: At,
    /// Joints instead of a node, for any robot: degrees or mm in its own coordinates
    #[arg(
        long,
        value_name = "Q1,Q2,...",
        value_delimiter = ',',
        value_parser = finite,
        allow_hyphen_values = true,
        conflicts_with = "at"
    )]
    pub joints: Option<Vec<f64>>,
    #[command(flatten)]
    pub overrides: Overrides,
    /// Print the explanation as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct ReadingsArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: Packages,
    #[command(flatten)]
    pub choice: Choice,
    /// Write readings.json, readings.csv and manifest.json into this new folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the readings as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct RobustArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: Packages,
    #[command(flatten)]
    pub overrides: Overrides,
    /// Print the answer as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct RobotsArguments {
    /// Print the list as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct RobotArguments {
    /// Name of a robot of the library, or a robot file (TOML)
    pub robot: PathBuf,
    /// Print the robot file itself, to start your own from
    #[arg(long, conflicts_with = "json")]
    pub toml: bool,
    /// Print the robot as JSON on stdout
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub packages: Packages,
}

#[derive(Args)]
pub struct EnvelopeArguments {
    /// Name of a robot of the library, a robot file or a cell file (TOML)
    #[arg(value_name = "ROBOT|CELL")]
    pub of: PathBuf,
    /// Hold the tool as in this operation of the cell [default: the first]
    #[arg(long, value_name = "NAME")]
    pub operation: Option<String>,
    /// Elevation of the tool axis, degrees: -90 points down, 0 is horizontal [default: that of the
    /// operation; -90]
    #[arg(long, value_name = "DEG", value_parser = bend, allow_hyphen_values = true)]
    pub bend: Option<f64>,
    /// Draw the plan at this height above the robot base; may be given several times [default: that
    /// of the operation; where the robot reaches farthest]
    #[arg(long, value_name = "MM", value_parser = finite, allow_hyphen_values = true)]
    pub height: Vec<f64>,
    /// Distance of the points asked [default: by the size and kind of the robot]
    #[arg(long, value_name = "MM", value_parser = step, allow_hyphen_values = true)]
    pub step: Option<f64>,
    /// Print the envelope as JSON on stdout
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub packages: Packages,
    /// Write section and plan as a picture
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
}
