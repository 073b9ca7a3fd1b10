//! Closed sets of words: the values of a key that accepts only certain words.

/// Closed set of values, each with the word that stands for it in the files.
pub trait Word: Copy + 'static {
    fn all() -> &'static [Self];
    fn word(self) -> &'static str;
}

/// Returns the words of a closed set.
pub fn words_of<W: Word>() -> Vec<String> {
    W::all().iter().map(|value| value.word().to_string()).collect()
}

/// Implements [`Word`] for types with a list `ALL` and a method `name`.
macro_rules! words {
    ($($kind:ty),* $(,)?) => { $(
        impl $crate::files::keys::word::Word for $kind {
            fn all() -> &'static [Self] {
                &<$kind>::ALL
            }
            fn word(self) -> &'static str {
                self.name()
            }
        }
    )* };
}
pub(crate) use words;

/// Returns words in quotes, with "or" between them.
pub fn quoted(words: &[String]) -> String {
    format!("\"{}\"", words.join("\" or \""))
}
