//! Code blocks of a Markdown page: the info string, the commands, and the output that the page shows.

/// Mark for lines of an output that a page leaves out.
pub const LEFT_OUT: &str = "[...]";

/// Code block of a page.
pub struct Block {
    /// Line of the opening fence, counted from 1.
    pub line: usize,
    /// Parts of the info string: the language, then options such as `exit=1`.
    info: Vec<String>,
    pub lines: Vec<String>,
}

/// Command in a block, with the output that the page shows below it.
pub struct Step {
    /// Lines of the command as typed, without the prompt.
    pub typed: Vec<String>,
    pub shown: Vec<String>,
}

impl Block {
    pub fn language(&self) -> &str {
        self.info.first().map_or("", String::as_str)
    }

    /// Returns whether the info string has a word after the language.
    pub fn has(&self, word: &str) -> bool {
        self.info.iter().skip(1).any(|part| part == word)
    }

    /// Returns the value of an option `name=value` of the info string.
    pub fn option(&self, name: &str) -> Option<&str> {
        self.info.iter().find_map(|part| part.strip_prefix(name)?.strip_prefix('='))
    }

    /// Returns the commands of a block. A command begins after `$ ` and continues on the next line if a line
    /// ends in a backslash.
    pub fn steps(&self) -> Vec<Step> {
        let mut steps: Vec<Step> = Vec::new();
        let mut goes_on = false;
        for line in &self.lines {
            if let Some(command) = line.strip_prefix("$ ") {
                steps.push(Step { typed: vec![command.into()], shown: Vec::new() });
            } else if let Some(step) = steps.last_mut() {
                if goes_on { step.typed.push(line.clone()) } else { step.shown.push(line.clone()) }
            }
            goes_on = line.ends_with('\\');
        }
        steps
    }
}

impl Step {
    /// Returns the words of the command without its comment and without quotation marks.
    pub fn words(&self) -> Vec<String> {
        let text: String =
            self.typed.iter().map(|line| line.trim_end_matches('\\').to_string() + " ").collect();
        let text = text.split(" # ").next().unwrap().to_string() + " ";
        let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
        for c in text.chars() {
            match (quote, c) {
                (Some(q), c) if c == q => quote = None,
                (None, '\'' | '"') => {
                    quote = Some(c);
                    word.get_or_insert_default();
                }
                (None, ' ') => words.extend(word.take()),
                (_, c) => word.get_or_insert_default().push(c),
            }
        }
        words
    }
}

/// Returns a page in which `change` has been applied to the lines of every code block.
pub fn replaced(text: &str, mut change: impl FnMut(&mut Block)) -> String {
    let mut written = String::new();
    let mut block: Option<Block> = None;
    for (k, line) in text.lines().enumerate() {
        match (&mut block, line.strip_prefix("```")) {
            (None, Some(info)) => {
                let info = info.split(',').map(str::to_string).collect();
                block = Some(Block { line: k + 1, info, lines: Vec::new() });
            }
            (Some(open), Some(_)) => {
                change(open);
                open.lines.iter().for_each(|line| written.push_str(&format!("{line}\n")));
                block = None;
            }
            (Some(open), None) => {
                open.lines.push(line.into());
                continue;
            }
            (None, None) => {}
        }
        written.push_str(&format!("{line}\n"));
    }
    assert!(block.is_none(), "a code block has no end");
    written
}

/// Returns a page without its code blocks.
pub fn without_blocks(text: &str) -> String {
    replaced(text, |block| block.lines.clear())
}
