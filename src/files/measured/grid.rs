//! Tables in a text: separator, header, units, and the lines of numbers.

use super::number::FieldValue;

/// Character between the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Separator {
    Character(char),
    /// One or more blanks or tabs.
    Blanks,
}

/// Separators in the order in which they are preferred.
const SEPARATORS: [Separator; 5] = [
    Separator::Character(';'),
    Separator::Character('\t'),
    Separator::Character(','),
    Separator::Character('|'),
    Separator::Blanks,
];

/// Beginnings of a line that is a comment.
const COMMENTS: [&str; 5] = ["#", "%", "//", "!", "'"];

/// Largest number of lines from which the separator and the number of columns are determined.
const SAMPLE: usize = 60;

/// Least number of numeric fields in a line of data: the three coordinates of a position.
const LEAST_NUMBERS: usize = 3;

impl Separator {
    /// Splits a line; the fields have neither surrounding blanks nor quotes.
    fn split(self, line: &str) -> Vec<&str> {
        let separator = match self {
            Self::Blanks if !line.contains('"') => return line.split_whitespace().collect(),
            Self::Blanks => ' ',
            Self::Character(separator) => separator,
        };
        let (mut fields, mut start, mut is_quoted) = (Vec::new(), 0, false);
        for (at, c) in line.char_indices() {
            if c == '"' {
                is_quoted = !is_quoted;
            } else if c == separator && !is_quoted {
                fields.push(unquoted(&line[start..at]));
                start = at + c.len_utf8();
            }
        }
        fields.push(unquoted(&line[start..]));
        if self == Self::Blanks {
            fields.retain(|field| !field.is_empty());
        }
        fields
    }

    /// Returns a score for how well the separator splits lines: the number of numeric fields, minus half the
    /// number of other words.
    fn score(self, lines: &[&str]) -> f64 {
        let value = |field: &str| match FieldValue::read(field) {
            FieldValue::Number(_) => 1.0,
            FieldValue::Missing => 0.0,
            FieldValue::Other => -0.5,
        };
        let score = |line: &str| self.split(line).into_iter().map(value).sum::<f64>().max(0.0);
        lines.iter().map(|line| score(line)).sum()
    }
}

fn unquoted(field: &str) -> &str {
    let field = field.trim();
    let inside = field.strip_prefix('"').and_then(|f| f.strip_suffix('"'));
    let inside = inside.or_else(|| field.strip_prefix('\'').and_then(|f| f.strip_suffix('\'')));
    inside.map_or(field, str::trim)
}

/// Returns whether a line is a comment.
fn is_comment(line: &str) -> bool {
    COMMENTS.iter().any(|start| line.starts_with(start))
}

/// Line of a table.
#[derive(Debug, Clone, Copy)]
pub struct GridLine<'t> {
    /// Number of the line in the file, counted from 1.
    pub number: usize,
    text: &'t str,
}

/// Table of one text.
#[derive(Debug, Clone)]
pub struct FieldGrid<'t> {
    separator: Separator,
    /// Names of the columns; their numbers from 1 if the table has no line of names.
    pub header: Vec<String>,
    /// Unit of every column, if a line of units states it; empty if there is no such line.
    pub units: Vec<String>,
    /// Line of the column names, counted from 1; None if the table has no column names.
    pub header_line: Option<usize>,
    pub lines: Vec<GridLine<'t>>,
}

impl<'t> FieldGrid<'t> {
    /// Finds the table in a text. A text without a line of numbers gives a table without lines.
    pub fn new(text: &'t str) -> Self {
        let lines = text.lines().enumerate().map(|(k, line)| (k + 1, line.trim_end_matches(['\r', ' '])));
        let (comments, lines): (Vec<_>, Vec<_>) =
            lines.filter(|(_, line)| !line.trim().is_empty()).partition(|(_, line)| is_comment(line.trim()));
        let sample: Vec<&str> = lines.iter().rev().take(SAMPLE).map(|(_, line)| *line).collect();
        let best = SEPARATORS.into_iter().map(|separator| (separator, separator.score(&sample)));
        // If several separators are equally good, the first one is used.
        let best = best.reduce(|best, other| if other.1 > best.1 { other } else { best });
        let separator = match best {
            Some((separator, score)) if score > 0.0 => separator,
            _ => separator_of_names(&sample),
        };
        let width = |line: &str| separator.split(line).len();
        let widths: Vec<usize> =
            sample.iter().filter(|l| numbers(separator, l) > 0).map(|l| width(l)).collect();
        let common = widths.iter().copied().max_by_key(|w| (widths.iter().filter(|v| *v == w).count(), *w));
        let is_data = |line: &str| {
            let (count, fields) = (numbers(separator, line), width(line));
            count >= LEAST_NUMBERS && 2 * count >= fields.min(common.unwrap_or(fields))
        };
        let first = lines.iter().position(|(_, line)| is_data(line)).unwrap_or(lines.len());
        let (above, table) = lines.split_at(first);
        let end = table.first().map_or(usize::MAX, |(number, _)| *number);
        // numpy.savetxt writes the names as a comment.
        let comments = comments.iter().filter(|(number, _)| *number < end);
        let commented =
            comments.map(|(n, line)| (*n, line.trim().trim_start_matches(['#', '%', '/', '!', ' '])));
        let widest = common.or_else(|| above.iter().map(|(_, l)| width(l)).max()).unwrap_or(0);
        let mut above: Vec<_> = above.iter().copied().chain(commented).collect();
        above.sort_unstable_by_key(|(number, _)| *number);
        let split = above.iter().map(|(number, line)| (*number, separator.split(line)));
        let mut named: Vec<_> = split.filter(|(_, fields)| is_header(fields, widest)).collect();
        let units = named.pop_if(|(_, fields)| are_units(fields)).map(|(_, fields)| fields);
        let (header_line, header) = named.pop().unzip();
        let header: Option<Vec<&str>> = header;
        let own = |text: Vec<&str>| text.into_iter().map(str::to_string).collect::<Vec<_>>();
        let numbered = || (1..=widest).map(|k| k.to_string()).collect();
        Self {
            separator,
            header: header.map_or_else(numbered, own),
            units: units.map_or_else(Vec::new, own),
            header_line,
            lines: table.iter().map(|(number, text)| GridLine { number: *number, text }).collect(),
        }
    }

    /// Returns the fields of a line.
    pub fn fields(&self, line: &GridLine<'t>) -> Vec<&'t str> {
        self.separator.split(line.text)
    }
}

fn numbers(separator: Separator, line: &str) -> usize {
    separator.split(line).into_iter().filter(|field| FieldValue::read(field).number().is_some()).count()
}

/// Returns the separator that occurs most often in a line of names.
fn separator_of_names(lines: &[&str]) -> Separator {
    let count = |separator: &Separator| lines.iter().map(|line| separator.split(line).len()).max();
    SEPARATORS.into_iter().rev().max_by_key(count).unwrap_or(Separator::Blanks)
}

/// Returns whether the fields can name the columns of a table with `width` columns.
fn is_header(fields: &[&str], width: usize) -> bool {
    let words = fields.iter().filter(|field| FieldValue::read(field) == FieldValue::Other).count();
    fields.len() >= LEAST_NUMBERS.min(width.max(1)) && 2 * fields.len() >= width && 2 * words >= fields.len()
}

/// Words of a line of units.
const UNIT_WORDS: [&str; 14] =
    ["", "-", "mm", "m", "deg", "rad", "°", "inch", "in", "s", "n", "1", "°c", "degc"];

fn are_units(fields: &[&str]) -> bool {
    let bare = |field: &&str| field.trim_matches(['[', ']', '(', ')', ' ']).to_lowercase();
    let is_unit = |field: &&str| UNIT_WORDS.contains(&bare(field).as_str());
    fields.iter().all(is_unit) && fields.iter().any(|field| !bare(field).is_empty())
}
