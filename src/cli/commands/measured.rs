//! Comparison of measured positions with the predicted errors of a cell, for `map` and `report`.

use super::measurements::{TableOptions, session};
use crate::cell::Cell;
use crate::cli::arguments::MeasuredFlags;
use crate::cli::output::path_word;
use crate::cli::{Exit, loading, output};
use crate::files::Source;
use crate::record::ComparedFile;
use crate::units::m_from_mm;
use crate::verification::{MeasuredComparison, PredictedErrors};

/// Default of `--spot`, mm: largest difference per axis between a commanded position and the first one of its
/// group.
const SPOT_MM: f64 = 1.0;

/// Compares the errors of a cell with every table that the flags name.
pub fn compared(flags: &MeasuredFlags, cell: &Cell) -> Result<Vec<ComparedFile>, Exit> {
    let errors = PredictedErrors::new(cell);
    let options = TableOptions { columns: &flags.column, joints: flags.joints.as_deref() };
    let spot = m_from_mm(flags.spot.unwrap_or(SPOT_MM));
    let one = |path: &std::path::PathBuf| {
        let session = session(path, &cell.robot, errors.chain(), &options)?;
        let compared = MeasuredComparison::new(&errors, &session, spot).map_err(|why| {
            output::error(&format!("{}: {why}", path_word(path)));
            output::talk("  help: measure more postures, with every joint in several positions");
            Exit::BadInput
        })?;
        Ok(ComparedFile::new(cell, &errors, &compared))
    };
    // Every file is read even if an earlier one is faulty, so that the faults of all files are printed.
    flags.measured.iter().map(one).collect::<Vec<_>>().into_iter().collect()
}

/// Returns the tables that the flags name, as inputs of a result. The path of each table is as the user typed
/// it.
pub fn sources(flags: &MeasuredFlags) -> Result<Vec<Source>, Exit> {
    let tables = flags.measured.iter().chain(&flags.joints);
    let source = |path: &std::path::PathBuf| {
        Ok(Source { path: path.to_string_lossy().into_owned(), bytes: loading::read_packed(path)? })
    };
    tables.map(source).collect()
}

/// Returns the flags as one text for a shell; a space precedes each flag.
pub fn words(flags: &MeasuredFlags) -> String {
    let tables = flags.measured.iter().map(|path| format!(" --measured {}", path_word(path)));
    let joints = flags.joints.iter().map(|path| format!(" --joints {}", path_word(path)));
    let columns = flags.column.iter();
    let columns = columns.map(|(of, name)| format!(" --column {}", output::word(&format!("{of}={name}"))));
    let spot = flags.spot.iter().map(|mm| format!(" --spot {mm}"));
    tables.chain(joints).chain(columns).chain(spot).collect()
}
