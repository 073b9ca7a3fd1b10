//! `figures`: draws the figures of the seed paper (the paper from which this project grew) for any cell.

use super::{stem, suggest_with, workcell};
use crate::assess::Assessment;
use crate::cli::arguments::FiguresArguments;
use crate::cli::output::{path_word, word};
use crate::cli::output_folder::{Sharing, new_folder};
use crate::cli::{Exit, arguments, asked, output, results, results_folder};
use crate::files::Source;
use crate::report::figures::{Format, PaperFigure, figures as drawn, readme};
use std::path::Path;

/// Runs `sweetspot figures`.
pub fn figures(a: &FiguresArguments) -> Result<Exit, Exit> {
    let format = Format { width: usize::from(a.width), dark: a.dark };
    let mut loaded = Vec::new();
    for path in &a.cells {
        let file = if path.is_dir() { results_folder::best_of(path)? } else { path.clone() };
        let it = asked::load(&file, &a.packages, &a.question)?;
        loaded.push((results::portable(&stem(path)), it.sources, workcell(it.cell, &file)?));
    }
    let (mut chapters, mut sources): (Vec<(String, Vec<PaperFigure>)>, Vec<Source>) =
        (Vec::new(), Vec::new());
    for (k, (stem, read, workcell)) in loaded.iter().enumerate() {
        let prefix = match loaded.iter().filter(|(other, ..)| other == stem).count() {
            _ if loaded.len() == 1 => String::new(),
            1 => format!("{stem}-"),
            _ => format!("{stem}-{}-", k + 1),
        };
        let assessment = Assessment::new("start", workcell, workcell.cell.start());
        let figures = drawn(&assessment, &prefix, format).map_err(|why| {
            output::error(&why);
            Exit::BadInput
        })?;
        chapters.push((workcell.cell.name.clone(), figures));
        let is_new = |s: &&Source| !sources.iter().any(|o| o.path == s.path && o.bytes == s.bytes);
        let new: Vec<Source> = read.iter().filter(is_new).cloned().collect();
        sources.extend(new);
    }
    let Some((_, _, first)) = loaded.first() else { return Err(Exit::BadInput) };
    let folder = new_folder(Some(&a.out), "", Sharing::Alone)?;
    let command: Vec<String> = arguments::typed().iter().map(|w| word(w)).collect();
    let text = readme(&chapters, &command.join(" "));
    let pictures = chapters.into_iter().flat_map(|(_, figures)| figures).map(|f| (f.name, f.bytes));
    let mut outputs: Vec<(String, Vec<u8>)> = pictures.collect();
    outputs.push(("README.md".into(), text.into_bytes()));
    let run = results::RunDescription::typed(a.question.settings());
    results::write(&folder, &first.cell, &sources, run, outputs)?.tell();
    suggest_with(&next(&a.cells[0]), &a.packages);
    Ok(Exit::Done)
}

fn next(of: &Path) -> String {
    format!("report {}", path_word(of))
}
