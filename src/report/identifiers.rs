//! Identifiers for programs that accept neither blanks nor letters beyond ASCII.

use std::collections::HashSet;

/// Identifiers given so far. No two identifiers differ only in the case of their letters.
pub struct Identifiers {
    longest: usize,
    given: HashSet<String>,
}

impl Identifiers {
    /// Returns an empty set of identifiers. An identifier has at most `longest` characters.
    pub fn new(longest: usize) -> Self {
        Self { longest, given: HashSet::new() }
    }

    /// Returns the identifier of a name: `prefix`, then the name with `_` in place of all characters other
    /// than letters and digits.
    ///
    /// A prefix must begin with a letter, unless it is empty. An empty prefix requires a name that begins
    /// with an ASCII letter. If this identifier is already in use, a number is appended to make the new
    /// identifier different.
    pub fn give(&mut self, prefix: &str, name: &str) -> String {
        let plain = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' });
        let whole: String = prefix.chars().chain(plain).collect();
        let numbered = |k: usize| {
            let end = if k == 1 { String::new() } else { format!("_{k}") };
            let start = whole.len().min(self.longest - end.len());
            format!("{}{end}", &whole[..start])
        };
        let free = (1..).map(numbered).find(|word| !self.given.contains(&word.to_lowercase()));
        let word = free.unwrap_or(whole);
        self.given.insert(word.to_lowercase());
        word
    }
}

/// Returns the text with `?` in place of every character outside printable ASCII.
pub fn ascii(text: &str) -> String {
    text.chars().map(|c| if (' '..='~').contains(&c) { c } else { '?' }).collect()
}
