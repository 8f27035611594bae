//! How a valid file is changed: in bytes, in fields, in lines, and in size.

use std::ops::Range;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Numbers and names that are at the end of something.
const ODD: [&str; 36] = [
    "",
    "0",
    "-0",
    "1",
    "-1",
    "0.5",
    "1e-320",
    "1e308",
    "-1e308",
    "1e309",
    "NaN",
    "inf",
    "-inf",
    "+7",
    "0x10",
    "1_0",
    "007",
    "255",
    "256",
    "65535",
    "65536",
    "2147483648",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "1000000000000",
    "\u{feff}",
    "\u{a0}",
    "\u{3000}",
    "\0",
    "é",
    "😀",
    "\r\n",
];

/// One of so many inputs grows to its bound.
const GROWN: u32 = 60;

/// The changes that a file may undergo.
pub struct Changes<'a> {
    /// Words that mean something to the reader.
    pub words: &'a [&'static str],
    /// The length that no file exceeds, in bytes.
    pub largest: usize,
}

impl Changes<'_> {
    /// One of the files with one to eight changes.
    pub fn changed(&self, files: &[Vec<u8>], random: &mut ChaCha8Rng) -> Vec<u8> {
        let mut input = one(files, random).cloned().unwrap_or_default();
        for _ in 0..1 << random.random_range(0..4_u32) {
            self.change(&mut input, files, random);
        }
        if random.random_range(0..GROWN) == 0 {
            self.grow(&mut input, random);
        }
        input.truncate(self.largest);
        input
    }

    fn change(&self, input: &mut Vec<u8>, files: &[Vec<u8>], random: &mut ChaCha8Rng) {
        match random.random_range(0..14_u32) {
            0 => flip(input, random),
            1 => number_in_binary(input, random),
            2 | 3 => {
                let at = place(input, random);
                input.splice(at..at, self.word(random).bytes());
            }
            4 | 5 => {
                let field = field(input, random);
                input.splice(field, self.word(random).bytes());
            }
            6 => drop(input.drain(stretch(input, random))),
            7 => {
                let stretch = input[stretch(input, random)].to_vec();
                let at = place(input, random);
                input.splice(at..at, stretch);
            }
            8 => drop(input.drain(line(input, random))),
            9 | 10 => {
                let line = input[line(input, random)].to_vec();
                let at = self::line(input, random).start;
                input.splice(at..at, line);
            }
            11 => input.truncate(place(input, random)),
            12 => {
                let other = one(files, random).map_or(&[][..], Vec::as_slice);
                let line = self::line(other, random);
                let at = self::line(input, random).start;
                input.splice(at..at, other[line].to_vec());
            }
            _ => {
                let other = one(files, random).map_or(&[][..], Vec::as_slice);
                input.truncate(place(input, random));
                input.extend_from_slice(&other[place(other, random)..]);
            }
        }
    }

    fn word(&self, random: &mut ChaCha8Rng) -> &'static str {
        let of = if random.random_bool(0.5) { self.words } else { &ODD };
        one(of, random).copied().unwrap_or_default()
    }

    /// Repeats a part until the file is as long as it may be.
    fn grow(&self, input: &mut Vec<u8>, random: &mut ChaCha8Rng) {
        let part = match random.random_range(0..4_u32) {
            0 => self.word(random).as_bytes().to_vec(),
            1 => [self.word(random), self.word(random)].concat().into_bytes(),
            2 => input[line(input, random)].to_vec(),
            _ => input[stretch(input, random)].to_vec(),
        };
        let room = self.largest.saturating_sub(input.len());
        if !part.is_empty() {
            let at = place(input, random);
            input.splice(at..at, part.iter().copied().cycle().take(room));
        }
    }
}

fn one<'a, T>(of: &'a [T], random: &mut ChaCha8Rng) -> Option<&'a T> {
    (!of.is_empty()).then(|| &of[random.random_range(0..of.len())])
}

fn place(input: &[u8], random: &mut ChaCha8Rng) -> usize {
    random.random_range(0..=input.len())
}

fn flip(input: &mut [u8], random: &mut ChaCha8Rng) {
    let at = place(input, random);
    if let Some(byte) = input.get_mut(at) {
        *byte = if random.random_bool(0.5) { random.random() } else { *byte ^ (1 << (at % 8)) };
    }
}

/// Writes a number over two, four or eight bytes, the lowest first.
fn number_in_binary(input: &mut [u8], random: &mut ChaCha8Rng) {
    let size = 2 << random.random_range(0..3_u32);
    let shift = random.random_range(0..64_u32);
    let number = [0, 1, u64::MAX, u64::MAX >> shift, 1 << shift][random.random_range(0..5)];
    let at = place(input, random);
    if let Some(bytes) = input.get_mut(at..at + size) {
        bytes.copy_from_slice(&number.to_le_bytes()[..size]);
    }
}

/// Some bytes in a row, a few or many.
fn stretch(input: &[u8], random: &mut ChaCha8Rng) -> Range<usize> {
    let start = place(input, random);
    let most = (1 << random.random_range(0..12_u32)).min(input.len() - start);
    start..start + random.random_range(0..=most)
}

/// A line with its end.
fn line(input: &[u8], random: &mut ChaCha8Rng) -> Range<usize> {
    let at = place(input, random);
    let start = input[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let end = input[at..].iter().position(|byte| *byte == b'\n');
    start..end.map_or(input.len(), |end| at + end + 1)
}

/// Bytes in a row of which a name or a number may consist.
fn field(input: &[u8], random: &mut ChaCha8Rng) -> Range<usize> {
    let at = place(input, random);
    let within = |byte: &u8| byte.is_ascii_alphanumeric() || b"._+-".contains(byte);
    let before = input[..at].iter().rev().take_while(|byte| within(byte)).count();
    let behind = input[at..].iter().take_while(|byte| within(byte)).count();
    at - before..at + behind
}
