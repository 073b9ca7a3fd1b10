//! `export`.

use super::{stem, suggest, warn_of_distrust, workcell};
use crate::assess::Assessment;
use crate::cli::arguments::{Overrides, Packages};
use crate::cli::output::path_word;
use crate::cli::overrides;
use crate::cli::overrides::overridden;
use crate::cli::{Exit, found, loading, output, results};
use crate::drawing::{Detail, Drawing};
use crate::files::{Loaded, shown};
use crate::record::MapDocument;
use crate::report;
use crate::report::raster::Shot;
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};

/// Of a picture, px.
const PNG: (usize, usize) = (1600, 1000);

/// What an export can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// CAD drawing in mm: solids, envelope, arrows, dimensions on layers
    Dxf,
    /// 3-D scene in m with the robot's motion
    Glb,
    /// Drawing to scale on paper: plan and elevation
    Svg,
    /// Table of all nodes
    Csv,
    /// The map as a document
    Json,
    /// The table of all nodes with typed columns
    Parquet,
    /// Picture of the cell
    Png,
}

#[derive(Args)]
pub struct ExportArguments {
    /// Cell file (TOML), or a folder that a search has written: its best layout
    #[arg(value_name = "RESULT|CELL")]
    pub of: PathBuf,
    /// What to write
    #[arg(long, value_name = "FORMAT")]
    pub to: Format,
    /// Write into this file [default: the name of the cell file or folder, in this folder]
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Of a folder: the layout from which the search started, instead of the best
    #[arg(long)]
    pub start: bool,
    /// Where the robot stands: at the spot of this operation, or at home [default: at the first spot]
    #[arg(long, value_name = "OPERATION|home")]
    pub posture: Option<String>,
    #[command(flatten)]
    pub packages: Packages,
    #[command(flatten)]
    pub overrides: Overrides,
}

/// `sweetspot export`
pub fn export(a: &ExportArguments) -> Result<Exit, Exit> {
    a.out.as_deref().map_or(Ok(()), |out| refuse_other_ending(out, a.to))?;
    let file = cell_file(&a.of, a.start)?;
    let Loaded { cell, .. } = overridden(loading::load(&file, &a.packages)?, &a.overrides)?;
    let workcell = workcell(cell, &file)?;
    let label = if a.of.is_dir() && !a.start { "best layout" } else { "layout as drawn" };
    let assessment = Assessment::new(label, &workcell, workcell.cell.start());
    let operation = posture(&assessment, a.posture.as_deref())?;
    let bytes = rendered(&assessment, a.to, operation)?;
    let out = a.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.{}", stem(&a.of), extension(a.to))));
    loading::write_whole(&out, &bytes)?;
    output::talk(&format!("wrote {}: {} kB", path_word(&out), bytes.len().div_ceil(1 << 10)));
    warn_of_distrust(&assessment);
    let next = if a.to == Format::Glb { Format::Dxf } else { Format::Glb };
    suggest(&format!("export {} --to {}", path_word(&a.of), extension(next)));
    Ok(Exit::Done)
}

/// A picture under the name of a drawing would only puzzle the program that opens it.
fn refuse_other_ending(out: &Path, format: Format) -> Result<(), Exit> {
    let given = out.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let others = Format::value_variants().iter().filter(|f| **f != format);
    if others.into_iter().all(|f| extension(*f) != given) {
        return Ok(());
    }
    output::error(&format!("{}: what --to {} writes ends in .{1}", path_word(out), extension(format)));
    Err(Exit::BadInput)
}

/// Of a folder its best layout, or the cell that the search began with.
fn cell_file(of: &Path, start: bool) -> Result<PathBuf, Exit> {
    if !of.is_dir() {
        if start {
            output::error(&format!("--start is of a folder, and {} is none", path_word(of)));
            return Err(Exit::BadInput);
        }
        return Ok(of.to_path_buf());
    }
    let best = found::best_of(of)?;
    if !start {
        return Ok(best);
    }
    // best.toml says first what it is made from.
    let text = std::fs::read_to_string(&best).unwrap_or_default();
    let from = text.lines().find_map(|line| line.strip_prefix("from = \"")?.strip_suffix('"'));
    let start = from.map(|inside| of.join(inside)).filter(|path| path.starts_with(of.join(results::INPUTS)));
    start.ok_or_else(|| {
        output::error(&format!("{} does not say what it started from", path_word(&best)));
        Exit::BadInput
    })
}

/// The operation at whose spot the robot stands; None: at home.
fn posture(a: &Assessment<'_>, asked: Option<&str>) -> Result<Option<usize>, Exit> {
    match asked {
        None => Ok((0..a.maps.len()).find(|k| a.spot(*k).is_some())),
        Some("home") => Ok(None),
        Some(name) => {
            let operation = overrides::operation(a.cell, name)?;
            if a.spot(operation).is_none() {
                output::error(&format!("{} has no spot in this layout: --posture home", shown(name)));
                return Err(Exit::AnswerIsNo);
            }
            Ok(Some(operation))
        }
    }
}

fn rendered(a: &Assessment<'_>, format: Format, operation: Option<usize>) -> Result<Vec<u8>, Exit> {
    let cannot = |why: String| {
        output::error(&format!("cannot make {}: {}", extension(format), shown(&why)));
        Exit::BadInput
    };
    let drawing = || Drawing::new(a, &Detail::PLAIN).map_err(cannot);
    match format {
        Format::Csv => results::csv(&MapDocument::new(a)),
        Format::Json => results::pretty(&MapDocument::new(a)),
        Format::Parquet => report::parquet::map(a).map_err(cannot),
        Format::Dxf => Ok(report::dxf::dxf(&drawing()?, operation)),
        Format::Glb => report::glb::glb(&drawing()?, operation).map_err(cannot),
        Format::Svg => Ok(report::sheet::sheet(&drawing()?, operation).into_bytes()),
        Format::Png => {
            let shot = Shot { stance: operation, width: PNG.0, height: PNG.1, ..Shot::default() };
            report::raster::png(&drawing()?, &shot).map_err(cannot)
        }
    }
}

fn extension(format: Format) -> &'static str {
    match format {
        Format::Dxf => "dxf",
        Format::Glb => "glb",
        Format::Svg => "svg",
        Format::Csv => "csv",
        Format::Json => "json",
        Format::Parquet => "parquet",
        Format::Png => "png",
    }
}
