//! `export`: writes a layout in the formats of other programs.

mod print_out;

use super::{stem, suggest_with, warn_of_distrust, warn_of_infeasible, workcell};
use crate::assess::Assessment;
use crate::cell::Layout;
use crate::cli::arguments::{ExportArguments, ExportFormat};
use crate::cli::output::path_word;
use crate::cli::results_folder::SearchFolder;
use crate::cli::{Exit, asked, json_text, loading, lookup, output, results, results_folder};
use crate::drawing::{Detail, Drawing};
use crate::files::{Loaded, shown};
use crate::raster::{self, Shot};
use crate::record::MapDocument;
use crate::report;
use crate::report::controller::{self, Controller};
use crate::report::layout_frames::LayoutFrames;
use crate::report::sheet::{self, SheetNumber};
use crate::report::{moveit, urdf};
use clap::ValueEnum;
use std::path::{Path, PathBuf};

/// Width and height of a picture, px.
const PNG_SIZE: (usize, usize) = (1600, 1000);

/// Runs `sweetspot export`.
pub fn export(a: &ExportArguments) -> Result<Exit, Exit> {
    a.out.as_deref().map_or(Ok(()), |out| refuse_other_ending(out, a.to))?;
    refuse_missing_writer(a.to)?;
    refuse_idle_meshes(a)?;
    let has_layout = match a.to {
        ExportFormat::Pdf => print_out::print_out(a)?,
        _ => draw(a).map(|()| true)?,
    };
    use ExportFormat::{Dxf, Fanuc, Glb, Krl, Pdf, Rapid, Urscript};
    let next = match a.to {
        Glb => Dxf,
        // A controller file contains the frames of the equipment. The PDF shows the fitter where to place
        // this equipment.
        Krl | Rapid | Urscript | Fanuc => Pdf,
        _ => Glb,
    };
    if !has_layout {
        suggest_with(&format!("report {}", path_word(&a.of)), &a.packages);
        return Ok(Exit::Done);
    }
    suggest_with(&format!("export {} --to {}", path_word(&a.of), next.name()), &a.packages);
    Ok(Exit::Done)
}

/// Writes a format that shows one layout.
fn draw(a: &ExportArguments) -> Result<(), Exit> {
    let (Loaded { cell, .. }, file, best) = subject(a)?;
    let workcell = workcell(cell, &file)?;
    let label = if a.of.is_dir() && !a.start { "best layout" } else { "layout as drawn" };
    let mut assessment = Assessment::new(label, &workcell, best.unwrap_or_else(|| workcell.cell.start()));
    if matches!(a.to, ExportFormat::Dxf | ExportFormat::Svg) {
        assessment = assessment.with_regions();
    }
    let operation = posture(&assessment, a.posture.as_deref())?;
    let out = output_file(a);
    write(&out, &rendered(&assessment, a, &out, operation)?)?;
    warn_of_infeasible(&assessment);
    warn_of_distrust(&assessment);
    Ok(())
}

/// Returns the file to write.
fn output_file(a: &ExportArguments) -> PathBuf {
    a.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.{}", stem(&a.of), a.to.extension())))
}

fn write(out: &Path, bytes: &[u8]) -> Result<(), Exit> {
    loading::write_output(out, bytes)?;
    output::talk(&format!("wrote {}: {} kB", path_word(out), bytes.len().div_ceil(1 << 10)));
    Ok(())
}

/// Prints why a format cannot be written.
fn cannot(format: ExportFormat, why: &str) -> Exit {
    output::error(&format!("cannot export {}: {}", format.name(), shown(why)));
    Exit::BadInput
}

/// Returns the cell to draw, its file and the best layout of a result folder. The layout is None if the
/// returned cell is exported as drawn.
///
/// In a result folder, the function reads the original cell of the search and the best layout. This cell has
/// search ranges, and the drawing shows the regions in which the equipment may stand within them. If a flag
/// changes the cell, the function reads best.toml as the cell. If `--start` is given, it reads the cell file
/// of the search.
fn subject(a: &ExportArguments) -> Result<(Loaded, PathBuf, Option<Layout>), Exit> {
    let file = cell_file(&a.of, a.start)?;
    if a.of.is_dir() && !a.start && a.question.words().is_empty() {
        let SearchFolder { loaded, file, best, .. } = results_folder::read(&a.of, &a.packages)?;
        return Ok((loaded, file, best));
    }
    Ok((asked::load(&file, &a.packages, &a.question)?, file, None))
}

/// Refuses a format whose writer is not part of this build.
fn refuse_missing_writer(format: ExportFormat) -> Result<(), Exit> {
    let (name, feature) = match format {
        ExportFormat::Parquet if !cfg!(feature = "parquet") => ("Parquet", "parquet"),
        ExportFormat::Pdf if !cfg!(feature = "pdf") => ("PDF", "pdf"),
        _ => return Ok(()),
    };
    output::error(&format!("this build has no {name} writer"));
    output::talk(&format!("  help: cargo install --path . --features {feature}"));
    Err(Exit::BadInput)
}

/// Refuses a prefix of mesh files for a format that names no mesh files.
fn refuse_idle_meshes(a: &ExportArguments) -> Result<(), Exit> {
    if a.meshes.is_none() || a.to == ExportFormat::Urdf {
        return Ok(());
    }
    output::error("--meshes needs --to urdf: no other format names mesh files");
    Err(Exit::BadInput)
}

/// Returns the URDF of a layout, after its meshes are written to a folder beside the file `out`.
///
/// The URDF names the meshes relative to its own folder, or with the given prefix.
fn with_meshes(a: &Assessment<'_>, out: &Path, prefix: Option<&str>) -> Result<Vec<u8>, Exit> {
    let folder = format!("{}_meshes", stem(out));
    let prefix =
        prefix.map_or_else(|| format!("{folder}/"), |prefix| format!("{}/", prefix.trim_end_matches('/')));
    let drawing = plain_drawing(a).map_err(|why| cannot(ExportFormat::Urdf, &why))?;
    let urdf::UrdfExport { urdf, meshes } =
        urdf::urdf(&drawing, &prefix).map_err(|why| cannot(ExportFormat::Urdf, &why))?;
    if !meshes.is_empty() {
        let folder = out.with_file_name(&folder);
        std::fs::create_dir_all(&folder).map_err(|e| loading::cannot_write(&folder, &e))?;
        for (name, bytes) in &meshes {
            loading::write_whole(&folder.join(name), bytes)?;
        }
        output::talk(&format!(
            "wrote {}: {}",
            path_word(&folder),
            output::counted(meshes.len(), "mesh file")
        ));
    }
    Ok(urdf.into_bytes())
}

/// Returns the drawing without envelopes, for formats that show no envelopes.
fn plain_drawing<'a>(a: &Assessment<'a>) -> Result<Drawing<'a>, String> {
    Drawing::new(a, &Detail { envelopes: false, ..Detail::PLAIN })
}

/// Refuses a file name with the extension of another format. Such a name would mislead the program that opens
/// the file.
fn refuse_other_ending(out: &Path, format: ExportFormat) -> Result<(), Exit> {
    let given = out.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let others = ExportFormat::value_variants().iter().filter(|f| **f != format);
    if others.into_iter().all(|f| f.extension() != given) {
        return Ok(());
    }
    output::error(&format!(
        "{}: with --to {}, the file name must end in .{1}",
        path_word(out),
        format.extension()
    ));
    Err(Exit::BadInput)
}

/// Returns the file of the best layout in a result folder or, with `start`, the cell file of the search.
fn cell_file(of: &Path, start: bool) -> Result<PathBuf, Exit> {
    if !of.is_dir() {
        if start {
            output::error(&format!("--start needs a result folder, but {} is a file", path_word(of)));
            return Err(Exit::BadInput);
        }
        return Ok(of.to_path_buf());
    }
    let best = results_folder::best_of(of)?;
    if !start {
        return Ok(best);
    }
    // The key `from` of best.toml names the cell file of the search.
    let text = std::fs::read_to_string(&best).unwrap_or_default();
    let from = text.lines().find_map(|line| line.strip_prefix("from = \"")?.strip_suffix('"'));
    let start = from.map(|inside| of.join(inside)).filter(|path| path.starts_with(of.join(results::INPUTS)));
    start.ok_or_else(|| {
        output::error(&format!("{} does not name the cell file it was made from", path_word(&best)));
        Exit::BadInput
    })
}

/// Returns the operation at whose spot the robot is drawn. None means the home position.
fn posture(a: &Assessment<'_>, asked: Option<&str>) -> Result<Option<usize>, Exit> {
    match asked {
        None => Ok((0..a.maps.len()).find(|k| a.spot(*k).is_some())),
        Some("home") => Ok(None),
        Some(name) => {
            let operation = lookup::operation(a.cell, name)?;
            if a.spot(operation).is_none() {
                output::error(&format!("operation {} has no spot in this layout", shown(name)));
                output::talk("  help: show the robot at home with --posture home");
                return Err(Exit::AnswerIsNo);
            }
            Ok(Some(operation))
        }
    }
}

/// Returns the bytes of the file `out`. Meshes that the file names are written first, to a folder beside the
/// file.
fn rendered(
    a: &Assessment<'_>,
    asked: &ExportArguments,
    out: &Path,
    operation: Option<usize>,
) -> Result<Vec<u8>, Exit> {
    let format = asked.to;
    let cannot = |why: String| cannot(format, &why);
    let drawing = || Drawing::new(a, &Detail::PLAIN).map_err(cannot);
    let frames = |controller: Controller| {
        let drawing = plain_drawing(a).map_err(cannot)?;
        Ok(controller::file(controller, &stem(out), &LayoutFrames::new(&drawing)).into_bytes())
    };
    match format {
        ExportFormat::Csv => results::csv(&MapDocument::new(a)),
        ExportFormat::Json => json_text::pretty(&MapDocument::new(a)),
        #[cfg(feature = "parquet")]
        ExportFormat::Parquet => report::parquet::map(a).map_err(cannot),
        #[cfg(not(feature = "parquet"))]
        ExportFormat::Parquet => refuse_missing_writer(format).map(|()| Vec::new()),
        ExportFormat::Pdf => Err(cannot("it shows more than one layout".into())),
        ExportFormat::Dxf => Ok(report::dxf::dxf(&drawing()?, operation)),
        ExportFormat::Glb => report::glb::glb(&drawing()?, operation).map_err(cannot),
        ExportFormat::Svg => Ok(sheet::sheet(&drawing()?, operation, SheetNumber::ALONE).svg.into_bytes()),
        ExportFormat::Png => {
            let shot = Shot { context: operation, width: PNG_SIZE.0, height: PNG_SIZE.1, ..Shot::default() };
            raster::png(&drawing()?, &shot).map_err(cannot)
        }
        ExportFormat::Krl => frames(Controller::Krl),
        ExportFormat::Rapid => frames(Controller::Rapid),
        ExportFormat::Urscript => frames(Controller::UrScript),
        ExportFormat::Fanuc => frames(Controller::Fanuc),
        ExportFormat::Moveit => Ok(moveit::scene(&plain_drawing(a).map_err(cannot)?).into_bytes()),
        ExportFormat::Urdf => with_meshes(a, out, asked.meshes.as_deref()),
    }
}
