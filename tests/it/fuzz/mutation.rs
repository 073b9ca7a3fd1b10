//! Mutation of inputs: changes of bits, bytes, lines, tokens and numbers, joined pieces of two inputs,
//! repetition and nesting.

use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Largest size of a mutated input, bytes.
const MAX_BYTES: usize = 1 << 18;

/// Largest size of an input that joins the corpus, bytes.
const MAX_KEPT_BYTES: usize = 1 << 13;

/// Numbers at the limits of types, formats and ranges.
const NUMBERS: [&str; 29] = [
    "nan",
    "-nan",
    "inf",
    "-inf",
    "0",
    "-0",
    "-0.0",
    "-1",
    "1e-320",
    "1e-7",
    "1e7",
    "-1e7",
    "1.0000001e7",
    "1e308",
    "-1e308",
    "1e309",
    "1e-400",
    "0.1",
    "1_000",
    "0x7fffffffffffffff",
    "0b1",
    "255",
    "65536",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551616",
    "99999999999999999999999999999999999999999999",
];

/// Whole numbers that may occur in a binary file.
const WORDS: [u32; 8] = [0, 1, 2, 0x7f80_0000, 0x7fc0_0000, 0xff80_0000, 0x7fff_ffff, u32::MAX];

/// Bytes with a meaning in some format.
const MARKS: &[u8] = b"\"'[]{}()<>/=.,:;#*\n\r\t \\\0\x1b\x7f\xff\xc3\xe2-+e_@%";

/// Brackets that can be nested.
const BRACKETS: [(&str, &str); 6] =
    [("[", "]"), ("{", "}"), ("{a=", "}"), ("{\"a\":", "}"), ("<a>", "</a>"), ("a.", "")];

/// Seeded source of inputs.
pub struct Mutator {
    /// The seeds, and then the inputs that were kept.
    pool: Vec<Vec<u8>>,
    seeds: usize,
    words: Vec<Vec<u8>>,
    rng: ChaCha8Rng,
}

impl Mutator {
    pub fn new(seeds: &[Vec<u8>], words: &[String], seed: u64) -> Self {
        let words = words.iter().map(|word| word.clone().into_bytes()).collect();
        Self { pool: seeds.to_vec(), seeds: seeds.len(), words, rng: ChaCha8Rng::seed_from_u64(seed) }
    }

    /// Adds an input to the pool, from which inputs are mutated.
    pub fn keep(&mut self, input: Vec<u8>) {
        if input.len() <= MAX_KEPT_BYTES {
            self.pool.push(input);
        }
    }

    /// Returns an input of the pool with one to six random changes, most often one or two.
    pub fn next_input(&mut self) -> Vec<u8> {
        let mut bytes = self.of_pool();
        let mut changes = 1;
        while changes < 6 && self.rng.random_bool(0.4) {
            changes += 1;
        }
        for _ in 0..changes {
            self.change(&mut bytes);
            bytes.truncate(MAX_BYTES);
        }
        bytes
    }

    /// Returns an input of the pool. With probability 1/2 or more it is a seed, because seeds are nearest to
    /// accepted inputs.
    fn of_pool(&mut self) -> Vec<u8> {
        let from = if self.rng.random_bool(0.5) { &self.pool[..self.seeds] } else { &self.pool };
        from.choose(&mut self.rng).cloned().unwrap_or_default()
    }

    /// Returns a short range of an input.
    fn range(&mut self, bytes: &[u8], longest: usize) -> (usize, usize) {
        let from = self.rng.random_range(0..=bytes.len());
        (from, (from + self.rng.random_range(1..=longest)).min(bytes.len()))
    }

    fn change(&mut self, bytes: &mut Vec<u8>) {
        let (from, to) = self.range(bytes, 12);
        match self.rng.random_range(0..40) {
            0..2 if from < to => bytes[from] ^= 1 << self.rng.random_range(0..8),
            2 if from < to => bytes[from] = self.rng.random(),
            3..5 => bytes.insert(from, MARKS[self.rng.random_range(0..MARKS.len())]),
            5..7 => drop(bytes.drain(from..to)),
            7 => drop(bytes.splice(from..from, bytes[from..to].to_vec())),
            8 => bytes.truncate(from),
            9 => self.overwrite_word(bytes, from),
            10 => self.spliced(bytes, from),
            11..13 => self.repeat(bytes),
            13 => self.nest(bytes, from),
            14..22 => self.lines(bytes),
            22..30 => self.replace_token(bytes),
            30..38 => self.replace_number(bytes),
            _ => {
                let word = self.word();
                drop(bytes.splice(from..from, word));
            }
        }
    }

    fn word(&mut self) -> Vec<u8> {
        match self.words.choose(&mut self.rng) {
            Some(word) if self.rng.random_bool(0.7) => word.clone(),
            _ => self.number(),
        }
    }

    fn number(&mut self) -> Vec<u8> {
        NUMBERS[self.rng.random_range(0..NUMBERS.len())].into()
    }

    /// Overwrites four bytes with a whole number or a float in the form of binary files.
    fn overwrite_word(&mut self, bytes: &mut [u8], from: usize) {
        let word = WORDS[self.rng.random_range(0..WORDS.len())].to_le_bytes();
        bytes.iter_mut().skip(from).zip(word).for_each(|(byte, new)| *byte = new);
    }

    /// Replaces the end of an input by the end of another input.
    fn spliced(&mut self, bytes: &mut Vec<u8>, from: usize) {
        let other = self.of_pool();
        let start = self.rng.random_range(0..=other.len());
        bytes.truncate(from);
        bytes.extend(&other[start..]);
    }

    /// Repeats a piece of an input, mostly a few times.
    fn repeat(&mut self, bytes: &mut Vec<u8>) {
        let (from, to) = self.range(bytes, 80);
        let often = if self.rng.random_bool(0.01) { 5_000 } else { 8 };
        let times = self.rng.random_range(1..=often);
        let piece = bytes[from..to].repeat(times);
        drop(bytes.splice(from..from, piece));
    }

    /// Puts nested brackets around the end of an input.
    fn nest(&mut self, bytes: &mut Vec<u8>, from: usize) {
        let (open, close) = BRACKETS[self.rng.random_range(0..BRACKETS.len())];
        let deepest = if self.rng.random_bool(0.05) { 3_000 } else { 100 };
        let depth = self.rng.random_range(1..deepest);
        let end = bytes[from..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |end| from + end);
        drop(bytes.splice(end..end, close.repeat(depth).into_bytes()));
        drop(bytes.splice(from..from, open.repeat(depth).into_bytes()));
    }

    /// Removes, swaps or copies a line. A copied line may come from another input.
    fn lines(&mut self, bytes: &mut Vec<u8>) {
        let other = self.of_pool();
        let mut lines: Vec<&[u8]> = bytes.split_inclusive(|b| *b == b'\n').collect();
        let foreign: Vec<&[u8]> = other.split_inclusive(|b| *b == b'\n').collect();
        if lines.is_empty() || foreign.is_empty() {
            return;
        }
        let (a, b) = (self.rng.random_range(0..lines.len()), self.rng.random_range(0..lines.len()));
        match self.rng.random_range(0..5) {
            0 => drop(lines.remove(a)),
            1 => lines.swap(a, b),
            2 => lines.insert(a, lines[b]),
            3 => lines.insert(a, foreign[self.rng.random_range(0..foreign.len())]),
            _ => lines[a] = foreign[self.rng.random_range(0..foreign.len())],
        }
        *bytes = lines.concat();
    }

    /// Replaces a word of an input by another word.
    fn replace_token(&mut self, bytes: &mut Vec<u8>) {
        let in_word = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_' || *b == b'-';
        let (from, _) = self.range(bytes, 1);
        let Some(start) = bytes[from..].iter().position(in_word).map(|k| from + k) else { return };
        let start = bytes[..start].iter().rposition(|b| !in_word(b)).map_or(0, |k| k + 1);
        let end = bytes[start..].iter().position(|b| !in_word(b)).map_or(bytes.len(), |k| start + k);
        let word = self.word();
        drop(bytes.splice(start..end, word));
    }

    /// Replaces a number of an input by a hostile number or by a small number.
    fn replace_number(&mut self, bytes: &mut Vec<u8>) {
        let in_number = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
        let (from, _) = self.range(bytes, 1);
        let digit = bytes[from..].iter().position(u8::is_ascii_digit).map(|k| from + k);
        let Some(digit) = digit.or_else(|| bytes.iter().position(u8::is_ascii_digit)) else { return };
        let start = bytes[..digit].iter().rposition(|b| !in_number(b)).map_or(0, |k| k + 1);
        let end = bytes[digit..].iter().position(|b| !in_number(b)).map_or(bytes.len(), |k| digit + k);
        let number = match self.rng.random_bool(0.6) {
            true => self.number(),
            false => format!("{}", self.rng.random_range(-2000i32..=2000)).into_bytes(),
        };
        drop(bytes.splice(start..end, number));
    }
}
