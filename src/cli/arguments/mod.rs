//! The command line: every command and its arguments.

mod allocate;
mod calibrate;
mod correct;
mod engine;
mod errors;
mod files;
mod index_ranges;
mod layouts;
mod manual;
mod measured;
mod measuring_plan;
mod outputs;
mod postures;
mod question;
mod robots;
mod search;
mod sweep;
mod value_parsers;

pub use allocate::AllocateArguments;
pub use calibrate::CalibrateArguments;
pub use correct::{CorrectArguments, TargetFrame};
pub use engine::{ChunkSize, EngineFlags};
pub use errors::{AccuracyBase, ErrorsArguments};
pub use files::{InitArguments, SchemaArguments, kinds};
pub use index_ranges::IndexRanges;
pub use layouts::{
    CheckArguments, CompareArguments, MapArguments, ReadingsArguments, RemedySearchFlags, RobustArguments,
};
pub use manual::{CompletionsArguments, ManArguments};
pub use measured::MeasuredFlags;
pub use outputs::{ExportArguments, ExportFormat, FiguresArguments, ReportArguments, ViewArguments};
pub use postures::{BudgetArguments, ExplainArguments};
pub use question::{ErrorFlags, QuestionFlags};
pub use robots::{EnvelopeArguments, RobotArguments, RobotsArguments};
pub use search::{SearchArguments, StoppingFlags};
pub use sweep::{SweepArguments, common_settings};

use clap::{Parser, Subcommand};

/// Finds the spot and the workcell layout that give a precision operation of a robot the least end-effector
/// error.
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
    /// Validate a cell file and everything it refers to, and report all errors at once
    #[command(before_help = "Example: sweetspot check cells/hitachi_cell.toml")]
    Check(CheckArguments),
    /// Map the error over every work surface of the layout as drawn
    #[command(before_help = "Example: sweetspot map cells/hitachi_paper.toml --svg map.svg")]
    Map(MapArguments),
    /// Search for the layout and the operation spots of least error
    #[command(
        before_help = "Example: sweetspot search cells/hitachi_cell.toml --seed 2 --out results/second-try",
        mut_arg("sets", |sets| sets.hide(true)) // the command refuses it, and says what to do
    )]
    Search(SearchArguments),
    /// Search or map a cell for every combination of given key values
    #[command(
        before_help = "Example: sweetspot sweep cells/hitachi_cell.toml --set errors=table-2,table-3 --set equipment.worktable.placement.z_mm=600,700"
    )]
    Sweep(SweepArguments),
    /// Compare layouts side by side: cell files, best.toml files or result folders
    #[command(
        before_help = "Example: sweetspot compare cells/hitachi_cell.toml results/hitachi_cell-001 -o compare.html"
    )]
    Compare(CompareArguments),
    /// Rank the error sources at a spot, to show which tolerance to tighten first
    #[command(before_help = "Example: sweetspot budget cells/hitachi_cell.toml --operation assembly")]
    Budget(BudgetArguments),
    /// Allocate tolerances: find the cheapest set with which every operation stays within its limit
    #[command(before_help = "Example: sweetspot allocate cells/hitachi_cell.toml --limit 20")]
    Allocate(AllocateArguments),
    /// Show the error calculation of one posture step by step
    #[command(before_help = "Example: sweetspot explain cells/hitachi_paper.toml --at 5,4")]
    Explain(ExplainArguments),
    /// Compare the error under all readings (signed, worst case, statistical) and all registrations, for the
    /// layout as drawn
    #[command(before_help = "Example: sweetspot readings cells/hitachi_cell.toml --out results/readings")]
    Readings(ReadingsArguments),
    /// Analyse how misplaced equipment affects the error, and report how much misplacement is allowed
    #[command(before_help = "Example: sweetspot robust cells/hitachi_cell.toml --limit 15")]
    Robust(RobustArguments),
    /// Export a layout: PDF, CAD drawing, 3-D scene, table, picture, or frames for controllers and ROS
    #[command(before_help = "Example: sweetspot export results/hitachi_cell-001 --to dxf -o layout.dxf")]
    Export(ExportArguments),
    /// Identify the kinematic errors of a robot from measured positions of its tool
    #[command(before_help = "Example: sweetspot calibrate ur10 tracker.csv --test other-day.csv")]
    Calibrate(CalibrateArguments),
    /// Guess the tolerances of a robot from its data sheet, and predict its pose accuracy (ISO 9283)
    #[command(before_help = "Example: sweetspot errors ur5e --preset collaborative --ap 0.5 --rp 0.03")]
    Errors(ErrorsArguments),
    /// Correct a robot program: find the joint and pose commands with which the TCP reaches its targets
    /// despite known errors
    #[command(before_help = "Example: sweetspot correct cells/hitachi_cell.toml --errors table-2")]
    Correct(CorrectArguments),
    /// List the built-in robots
    #[command(before_help = "Example: sweetspot robots")]
    Robots(RobotsArguments),
    /// Show a robot: D-H table, joint limits, tool, reach, error sets, size of its working envelope
    #[command(before_help = "Example: sweetspot robot hitachi_pw10")]
    Robot(RobotArguments),
    /// Draw and measure the working envelope of a robot: section, plan, volume
    #[command(before_help = "Example: sweetspot envelope hitachi_pw10 --svg envelope.svg")]
    Envelope(EnvelopeArguments),
    /// Write one HTML page about a layout or a search result: verdict, 3-D view, maps, tables
    #[command(before_help = "Example: sweetspot report results/hitachi_cell-001 -o report.html")]
    Report(ReportArguments),
    /// Edit a layout in the browser and see its error at once; the page is served to this machine only
    #[command(
        before_help = "Example: sweetspot view cells/hitachi_cell.toml --open",
        mut_arg("sets", |sets| sets.hide(true)) // the command refuses it, and says what to do
    )]
    View(ViewArguments),
    /// Print the JSON Schema of a file kind, or write all schemas for editors
    #[command(before_help = "Example: sweetspot schema --out schemas")]
    Schema(SchemaArguments),
    /// Draw the figures of the paper on which sweetspot is based (the seed paper) for your own cells
    #[command(before_help = "Example: sweetspot figures cells/hitachi_paper.toml --out figures")]
    Figures(FiguresArguments),
    /// Write a commented first cell, ready to run, for your own robot (a URDF) or a built-in robot
    #[command(before_help = "Example: sweetspot init my_robot.urdf")]
    Init(InitArguments),
    /// Print the manual page of a command, or write all manual pages
    #[command(before_help = "Example: sweetspot man --out ~/.local/share/man/man1")]
    Man(ManArguments),
    /// Print the completions of commands and options for a shell
    #[command(before_help = "Example: sweetspot completions bash > sweetspot.bash")]
    Completions(CompletionsArguments),
}

/// Returns the words of the command line after the name of the program.
pub fn typed() -> Vec<String> {
    std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned()).collect()
}
