//! Readers under files that were changed at random.
//!
//! A [`Trial`] begins with valid files, changes them ([`change`]) and gives them to a reader, which must not panic,
//! and must not take memory or time out of proportion to the length of the file ([`bounds`]). No compiler tells here
//! which branch was taken. What a reader says does instead: a file that is answered by a sentence that was not heard
//! before is changed further.
//!
//! Without the environment variable [`SECONDS`] a trial takes two seconds and draws the same changes every time; with
//! it, as many as it says, and others every time. An input that a reader fails on is kept, and its name is told: put
//! it into `fuzz/kept`, below the name of the trial, and every run begins with it.

pub mod bounds;
pub mod change;
mod watch;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use bounds::Bounds;
use change::Changes;
use watch::Watch;

/// The environment variable that says how many seconds a trial takes.
pub const SECONDS: &str = "VISLAM_FUZZ_SECONDS";

/// How long a trial takes that nobody asked for.
const SHORT: Duration = Duration::from_secs(2);
/// So many files are changed further at most, of so many bytes: many small ones find more than a few large ones.
const POOL: (usize, usize) = (2_000, 20_000);

/// A reader's files, and what it may take.
pub struct Trial {
    name: &'static str,
    seeds: Vec<Vec<u8>>,
    words: Vec<&'static str>,
    bounds: Bounds,
}

impl Trial {
    /// A trial that begins with these files, which the reader takes.
    pub fn of<S: AsRef<[u8]>>(name: &'static str, seeds: impl IntoIterator<Item = S>) -> Self {
        let seeds = seeds.into_iter().map(|seed| seed.as_ref().to_vec()).collect();
        Self { name, seeds, words: Vec::new(), bounds: Bounds::default() }
    }

    /// Words that mean something to the reader.
    pub fn words(self, words: &[&'static str]) -> Self {
        Self { words: words.to_vec(), ..self }
    }

    /// What the reader may take, where it is not what others may.
    pub fn bounds(self, bounds: Bounds) -> Self {
        Self { bounds, ..self }
    }

    /// Tries the reader, which returns what it says of a file.
    ///
    /// # Panics
    ///
    /// When the reader panics or takes too much. Where it comes to no end, the program ends.
    pub fn run(&self, reader: impl Fn(&[u8]) -> String) {
        let watch = Watch::of(self.name);
        let say = |input: &[u8]| {
            watch.begins(input);
            let said = self.bounds.hold(input, &reader);
            watch.ends();
            said.unwrap_or_else(|why| {
                panic!("{}: {why}; the input is {}", self.name, watch.path().display())
            })
        };
        let mut files = self.seeds.clone();
        files.extend(kept(self.name));
        let mut heard: BTreeSet<String> = files.iter().map(|file| gist(&say(file))).collect();
        let (long, start) = length();
        let mut random = ChaCha8Rng::seed_from_u64(start);
        let changes = Changes { words: &self.words, largest: self.bounds.largest };
        let (begin, mut tried) = (Instant::now(), files.len());
        while begin.elapsed() < long {
            let input = changes.changed(&files, &mut random);
            tried += 1;
            let news = heard.insert(gist(&say(&input)));
            if news && files.len() < POOL.0 && input.len() < POOL.1 {
                files.push(input);
            }
        }
        println!(
            "{}: {tried} inputs in {:.0?} from seed {start}, {} sentences heard",
            self.name,
            begin.elapsed(),
            heard.len()
        );
    }
}

/// Inputs that a reader failed on once.
fn kept(name: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("kept").join(name);
    let mut paths: Vec<_> =
        fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths.iter().filter_map(|path| fs::read(path).ok()).collect()
}

/// How long a trial takes and what its draws begin with.
fn length() -> (Duration, u64) {
    let Ok(seconds) = std::env::var(SECONDS) else { return (SHORT, 0) };
    let seconds = seconds.parse().unwrap_or_else(|_| panic!("{SECONDS} is no number of seconds"));
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (Duration::from_secs(seconds), now.as_millis() as u64)
}

/// A sentence without what it quotes and without its numbers.
fn gist(said: &str) -> String {
    let outside = said.split('`').step_by(2).flat_map(str::chars);
    outside.filter(|letter| !letter.is_numeric()).take(300).collect()
}
