//! Arguments of the commands that make drawings and pages: `export`, `figures`, `report`, `view`.

use super::measured::MeasuredFlags;
use super::question::QuestionFlags;
use crate::cli::packages::PackageFolders;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// File format of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    /// CAD drawing in mm: solids, working envelope, error arrows and dimensions on layers
    Dxf,
    /// 3-D scene in m with the motion of the robot (glTF)
    Glb,
    /// Drawing to scale on paper: plan and elevation
    Svg,
    /// Pages for print: the verdict, the drawing to scale, and the report as an appendix
    Pdf,
    /// Table of all nodes
    Csv,
    /// Map as a JSON document
    Json,
    /// Table of all nodes with typed columns
    Parquet,
    /// Picture of the cell
    Png,
    /// Frames of equipment and spots for KUKA controllers (KRL data list)
    Krl,
    /// Frames of equipment and spots for ABB controllers (work objects in a RAPID module)
    Rapid,
    /// Frames of equipment and spots for Universal Robots (poses in URScript)
    Urscript,
    /// Frames of equipment and spots for FANUC controllers (text, to be entered by hand)
    Fanuc,
    /// Static URDF in m: base, equipment, obstacles and spots as links; meshes go to a folder beside it
    Urdf,
    /// Planning scene of MoveIt: collision objects in the frame of the robot base
    Moveit,
}

impl ExportFormat {
    /// Returns the name of the format, as written after the option `--to`.
    pub fn name(self) -> &'static str {
        match self {
            ExportFormat::Dxf => "dxf",
            ExportFormat::Glb => "glb",
            ExportFormat::Svg => "svg",
            ExportFormat::Pdf => "pdf",
            ExportFormat::Csv => "csv",
            ExportFormat::Json => "json",
            ExportFormat::Parquet => "parquet",
            ExportFormat::Png => "png",
            ExportFormat::Krl => "krl",
            ExportFormat::Rapid => "rapid",
            ExportFormat::Urscript => "urscript",
            ExportFormat::Fanuc => "fanuc",
            ExportFormat::Urdf => "urdf",
            ExportFormat::Moveit => "moveit",
        }
    }

    /// Returns the file name extension.
    pub fn extension(self) -> &'static str {
        match self {
            ExportFormat::Krl => "dat",
            ExportFormat::Rapid => "mod",
            ExportFormat::Urscript => "script",
            ExportFormat::Fanuc => "txt",
            ExportFormat::Moveit => "scene",
            other => other.name(),
        }
    }
}

#[derive(Args)]
pub struct ExportArguments {
    /// Cell file (TOML), or a result folder of `search`, whose best layout is exported
    #[arg(value_name = "RESULT|CELL")]
    pub of: PathBuf,
    /// Format to write
    #[arg(long, value_name = "FORMAT")]
    pub to: ExportFormat,
    /// Write to this file [default: a file in the current folder that has the name of RESULT or CELL and the
    /// extension of the format]
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Export the start layout of a result folder instead of its best layout
    #[arg(long)]
    pub start: bool,
    /// Show the robot at the spot of this operation, or at `home` [default: at the first spot]
    #[arg(long, value_name = "OPERATION|home")]
    pub posture: Option<String>,
    /// Prefix of the names of the mesh files in a URDF, such as package://my_cell/meshes/ [default: the
    /// folder of the mesh files]
    #[arg(long, value_name = "URI")]
    pub meshes: Option<String>,
    #[command(flatten)]
    pub packages: PackageFolders,
    #[command(flatten)]
    pub question: QuestionFlags,
}

#[derive(Args)]
pub struct FiguresArguments {
    /// Cell files, or result folders of `search`
    #[arg(required = true, value_name = "CELL|RESULT")]
    pub cells: Vec<PathBuf>,
    #[command(flatten)]
    pub packages: PackageFolders,
    #[command(flatten)]
    pub question: QuestionFlags,
    /// Write the pictures, README.md and manifest.json to this new folder
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Width of the pictures in pixels
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u16).range(400..=4000), default_value = "1600")]
    pub width: u16,
    /// Draw on a dark background
    #[arg(long)]
    pub dark: bool,
}

#[derive(Args)]
pub struct ReportArguments {
    /// Cell file (TOML), or a result folder of `search`
    #[arg(value_name = "RESULT|CELL")]
    pub of: PathBuf,
    #[command(flatten)]
    pub packages: PackageFolders,
    #[command(flatten)]
    pub question: QuestionFlags,
    #[command(flatten)]
    pub measured: MeasuredFlags,
    /// Write the page to this file; an existing page is replaced
    #[arg(short, long, value_name = "FILE", default_value = "report.html")]
    pub out: PathBuf,
    /// Print the verdict as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct ViewArguments {
    /// Cell file (TOML), or a result folder of `search`
    #[arg(value_name = "CELL|RESULT")]
    pub of: PathBuf,
    #[command(flatten)]
    pub packages: PackageFolders,
    #[command(flatten)]
    pub question: QuestionFlags,
    /// Listen on this port of 127.0.0.1 [default: any free port]
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    pub port: u16,
    /// Open the page in the browser
    #[arg(long)]
    pub open: bool,
}
