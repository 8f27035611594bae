//! Which answers are like one another, for a person to look at.
//!
//! Answers are compared by fingerprints of their tokens, chosen by winnowing (S. Schleimer,
//! D. S. Wilkerson and A. Aiken, “Winnowing: local algorithms for document fingerprinting”,
//! SIGMOD 2003): of every few neighbouring runs of tokens one is kept, so that what two answers
//! share over [`GRAM`] + [`WINDOW`] − 1 tokens is found wherever it stands. Names that an answer
//! gives are numbered by where they first occur in a run, so that new names change nothing, and
//! what only groups or ends is no token, so that more of it changes nothing either.

use std::collections::hash_map::DefaultHasher;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fmt::Write as _;
use std::fs;
use std::hash::{Hash, Hasher};
use std::path::Path;

use exercise_spec::Exercise;
use proc_macro2::{Delimiter, TokenStream, TokenTree};

use crate::report::markdown::escaped;
use exercise_runner::tokens::without_shebang;

/// Tokens of a run.
pub const GRAM: usize = 12;
/// Runs of which one is kept at least.
pub const WINDOW: usize = 6;
/// With fewer fingerprints of its own an answer is too short to be compared.
const FEWEST: usize = 8;
/// As many fingerprints as an answer may have besides those of the reference; of more, the smallest
/// are kept. Twenty times what the longest reference answer has.
const MOST: usize = 8_192;
/// Share from which two answers are told.
const SHARE: f64 = 0.5;
/// As many pairs as are told in a table.
const PAIRS: usize = 40;

/// The answers of a batch as fingerprints.
#[derive(Debug)]
pub struct Similarity {
    exercises: Vec<Answers>,
    names: Vec<String>,
}

/// The answers to one exercise.
#[derive(Debug)]
struct Answers {
    slug: &'static str,
    title: &'static str,
    skeleton: HashSet<u64>,
    reference: Option<Vec<u64>>,
    /// Digests of the skeletons from the first token to the last.
    untouched: HashSet<u64>,
    answers: Vec<Answer>,
}

/// One answer.
#[derive(Debug)]
struct Answer {
    /// The number of its submission.
    of: usize,
    /// Fingerprints in order; none when there are too few to be compared.
    prints: Vec<u64>,
    /// A digest of all tokens.
    whole: u64,
}

/// Two answers that are alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// The one.
    pub one: String,
    /// The other.
    pub other: String,
    /// How much of the smaller one is in the other, from 0 to 1.
    pub share: f64,
    /// How many fingerprints they share.
    pub shared: usize,
}

impl Similarity {
    /// Begins a comparison with what the repository has of the exercises.
    pub fn new(exercises: &[&'static Exercise], repository: &Path) -> Self {
        let answers = |exercise: &&'static Exercise| Answers::new(exercise, repository);
        Self { exercises: exercises.iter().map(answers).collect(), names: Vec::new() }
    }

    /// Adds the answers of a submission, given by slug.
    pub fn add<'a>(&mut self, name: &str, answer: impl Fn(&str) -> Option<&'a str>) {
        let of = self.names.len();
        self.names.push(name.to_owned());
        for exercise in &mut self.exercises {
            if let Some(text) = answer(exercise.slug) {
                exercise.add(of, text);
            }
        }
    }

    /// Answers of an exercise that are like the reference, most alike first.
    pub fn with_reference(&self, slug: &str) -> Vec<Pair> {
        let Some(exercise) = self.exercises.iter().find(|exercise| exercise.slug == slug) else {
            return Vec::new();
        };
        let pair = |(index, share, shared): (usize, f64, usize)| Pair {
            one: self.names[index].clone(),
            other: "the reference".to_owned(),
            share,
            shared,
        };
        let mut pairs: Vec<Pair> = exercise.to_reference().into_iter().map(pair).collect();
        pairs.retain(|pair| pair.share >= SHARE);
        sorted(pairs)
    }

    /// Answers of an exercise that are like one another, most alike first.
    pub fn within(&self, slug: &str) -> Vec<Pair> {
        let Some(exercise) = self.exercises.iter().find(|exercise| exercise.slug == slug) else {
            return Vec::new();
        };
        let pair = |(one, other, share, shared): (usize, usize, f64, usize)| Pair {
            one: self.names[one].clone(),
            other: self.names[other].clone(),
            share,
            shared,
        };
        sorted(exercise.to_one_another().into_iter().map(pair).collect())
    }

    /// The report.
    pub fn markdown(&self) -> String {
        let mut text = format!(
            "# Answers that are alike\n\nThis is for a person to look at, and no verdict: short \
             answers to the same question look alike, and those who worked together wrote alike. \
             Compared are runs of {GRAM} tokens, whatever names the answers give, without comments, \
             without parentheses, braces and semicolons, and without what the skeleton has; how much \
             of the smaller answer is found in the other is told from {:.0} % on, and an answer that is longer than the reference counts \
             as one of its length. Within the batch, \
             what more than half of it has is left out, unless answers are the same from the first \
             token to the last.\n",
            100.0 * SHARE
        );
        text += &self.over_exercises();
        for exercise in &self.exercises {
            let _ = write!(text, "\n## {}\n\n", escaped(exercise.title, 80));
            if let Some((half, count)) = exercise.usual() {
                let _ = write!(
                    text,
                    "Of {count} answers, half share at least {half:.0} % with the reference.\n\n"
                );
            }
            for group in exercise.same() {
                let names: Vec<String> =
                    group.iter().take(PAIRS).map(|of| escaped(&self.names[*of], 80)).collect();
                let _ = write!(
                    text,
                    "The same from the first token to the last, but for names: {} answers, of {}.\n\n",
                    group.len(),
                    names.join(", ")
                );
            }
            let lists = [self.with_reference(exercise.slug), self.within(exercise.slug)];
            if lists.iter().all(Vec::is_empty) {
                text += "Nothing to look at.\n";
                continue;
            }
            text += "| One | Other | Shared |\n| --- | --- | --: |\n";
            for pairs in lists {
                text += &cut(pairs.iter().map(row).collect());
            }
        }
        text
    }

    /// In how many exercises every two submissions are alike, most first.
    fn over_exercises(&self) -> String {
        let mut counts: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for exercise in &self.exercises {
            for (one, other, ..) in exercise.to_one_another() {
                *counts.entry((one, other)).or_default() += 1;
            }
        }
        let name = |index: usize| self.names[index].as_str();
        let named = |((one, other), count)| (count, name(one), name(other));
        let mut pairs: Vec<(usize, &str, &str)> = counts.into_iter().map(named).collect();
        pairs.sort_by(|a, b| b.0.cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        if pairs.is_empty() {
            return String::new();
        }
        let of = self.exercises.len();
        let row = |(count, one, other): &(usize, &str, &str)| {
            format!("| {} | {} | {count} of {of} |\n", escaped(one, 80), escaped(other, 80))
        };
        let rows = cut(pairs.iter().map(row).collect());
        format!(
            "\n## Over all exercises\n\n| One | Other | Alike in |\n| --- | --- | --: |\n{rows}"
        )
    }
}

fn row(pair: &Pair) -> String {
    let (one, other) = (escaped(&pair.one, 80), escaped(&pair.other, 80));
    let (percent, count) = (100.0 * pair.share, pair.shared);
    format!("| {one} | {other} | {percent:.0} % ({count} fingerprints) |\n")
}

/// The first rows, and how many more there are.
fn cut(mut rows: Vec<String>) -> String {
    let others = rows.len().saturating_sub(PAIRS);
    rows.truncate(PAIRS);
    if others > 0 {
        rows.push(format!("| and {others} more | | |\n"));
    }
    rows.concat()
}

fn sorted(mut pairs: Vec<Pair>) -> Vec<Pair> {
    pairs.sort_by(|a, b| {
        let names = (&a.one, &a.other).cmp(&(&b.one, &b.other));
        b.share.total_cmp(&a.share).then(b.shared.cmp(&a.shared)).then(names)
    });
    pairs
}

impl Answers {
    fn new(exercise: &'static Exercise, repository: &Path) -> Self {
        let file = format!("{}.rs", exercise.slug);
        let (mut skeleton, mut untouched) = (HashSet::new(), HashSet::new());
        // Of every edition: an answer may have begun with an older one.
        for edition in fs::read_dir(repository.join("exercises/skeletons")).into_iter().flatten() {
            let path = edition.map(|edition| edition.path().join(&file));
            let text = path.and_then(fs::read_to_string).unwrap_or_default();
            let tokens = tokens(&text).unwrap_or_default();
            untouched.insert(run(&tokens));
            skeleton.extend(runs(&tokens));
        }
        let mut this = Self {
            slug: exercise.slug,
            title: exercise.title,
            skeleton,
            untouched,
            reference: None,
            answers: Vec::new(),
        };
        let reference = fs::read_to_string(repository.join("solutions/src").join(&file));
        this.reference = reference.ok().and_then(|text| Some(this.fingerprints(&tokens(&text)?)));
        this
    }

    fn add(&mut self, of: usize, text: &str) {
        if let Some(tokens) = tokens(text).filter(|tokens| !tokens.is_empty()) {
            let answer = Answer { of, prints: self.fingerprints(&tokens), whole: run(&tokens) };
            self.answers.push(answer);
        }
    }

    /// What an answer has besides the skeleton, if it is enough to be compared. What the reference
    /// has too stays, however much there is around it.
    fn fingerprints(&self, tokens: &[Token]) -> Vec<u64> {
        let mut prints = winnowed(&runs(tokens));
        prints.retain(|print| !self.skeleton.contains(print));
        let reference = self.reference.as_deref().unwrap_or_default();
        let (mut kept, others): (Vec<u64>, Vec<u64>) =
            prints.into_iter().partition(|print| reference.binary_search(print).is_ok());
        kept.extend(others.into_iter().take(MOST));
        kept.sort_unstable();
        if kept.len() < FEWEST { Vec::new() } else { kept }
    }

    /// Groups of submissions whose answers are the same but for names, the greatest first.
    fn same(&self) -> Vec<Vec<usize>> {
        let mut groups: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        for answer in self.answers.iter().filter(|it| !self.untouched.contains(&it.whole)) {
            groups.entry(answer.whole).or_default().push(answer.of);
        }
        let mut groups: Vec<Vec<usize>> =
            groups.into_values().filter(|group| group.len() > 1).collect();
        groups.sort_by_key(|group| (std::cmp::Reverse(group.len()), group[0]));
        groups
    }

    /// Answers that are long enough to be compared.
    fn compared(&self) -> impl Iterator<Item = &Answer> {
        self.answers.iter().filter(|answer| !answer.prints.is_empty())
    }

    /// Submission, share and number shared of every answer and the reference.
    fn to_reference(&self) -> Vec<(usize, f64, usize)> {
        let Some(reference) = &self.reference else {
            return Vec::new();
        };
        let compared = |Answer { of, prints, .. }: &Answer| {
            let shared = prints.iter().filter(|print| reference.binary_search(print).is_ok());
            let shared = shared.count();
            (*of, shared as f64 / prints.len().min(reference.len()).max(1) as f64, shared)
        };
        self.compared().map(compared).collect()
    }

    /// The percentage that half of the answers share at least with the reference, of how many.
    fn usual(&self) -> Option<(f64, usize)> {
        let mut shares: Vec<f64> =
            self.to_reference().into_iter().map(|(_, share, _)| share).collect();
        shares.sort_by(f64::total_cmp);
        let half = shares.get(shares.len() / 2)?;
        (shares.len() >= 4).then_some((100.0 * half, shares.len()))
    }

    /// Submissions, share and number shared of every two answers that share enough.
    fn to_one_another(&self) -> Vec<(usize, usize, f64, usize)> {
        let mut having: HashMap<u64, Vec<usize>> = HashMap::new();
        for (at, answer) in self.answers.iter().enumerate() {
            answer.prints.iter().for_each(|print| having.entry(*print).or_default().push(at));
        }
        // What most have is how one writes it. In a small batch that cannot be told.
        let usual = (self.compared().count() / 2).max(4);
        having.retain(|_, answers| answers.len() <= usual);
        let mut sizes = vec![0; self.answers.len()];
        let mut shared: HashMap<(usize, usize), usize> = HashMap::new();
        for answers in having.values() {
            for (number, one) in answers.iter().enumerate() {
                sizes[*one] += 1;
                for other in &answers[number + 1..] {
                    *shared.entry((*one, *other)).or_default() += 1;
                }
            }
        }
        // Who has much more than the reference has no right to share more with others.
        let most = self.reference.as_ref().map_or(usize::MAX, |prints| prints.len().max(FEWEST));
        let pair = |((one, other), shared): ((usize, usize), usize)| {
            let share = shared as f64 / sizes[one].min(sizes[other]).min(most) as f64;
            let share = share.min(1.0);
            let alike = shared >= FEWEST && share >= SHARE;
            alike.then(|| ((self.answers[one].of, self.answers[other].of), (share, shared)))
        };
        let mut pairs: BTreeMap<(usize, usize), (f64, usize)> =
            shared.into_iter().filter_map(pair).collect();
        let prints: HashMap<usize, usize> =
            self.answers.iter().map(|answer| (answer.of, answer.prints.len())).collect();
        for group in self.same() {
            for (number, one) in group.iter().enumerate() {
                let all = |other: &usize| ((*one, *other), (1.0, prints[one]));
                pairs.extend(group[number + 1..].iter().map(all));
            }
        }
        let flat = |((one, other), (share, shared))| (one, other, share, shared);
        pairs.into_iter().map(flat).collect()
    }
}

/// A token, as far as it is compared.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Token {
    /// What stays as it is: keywords, marks, types, paths, what is called on something.
    Fixed(String),
    /// A name that could be another.
    Name(String),
    /// Any literal.
    Literal,
}

/// The tokens of a text in a row, without comments, attributes, and marks that group or end. Nothing
/// where it has none.
fn tokens(text: &str) -> Option<Vec<Token>> {
    let stream: TokenStream = without_shebang(text).unwrap_or(text).parse().ok()?;
    let mut row = Vec::new();
    let mut open = vec![(stream.into_iter().peekable(), "")];
    while let Some((inner, close)) = open.last_mut() {
        let Some(tree) = inner.next() else {
            row.push(Token::Fixed((*close).to_owned()));
            open.pop();
            continue;
        };
        match tree {
            TokenTree::Group(group)
                if group.delimiter() == Delimiter::Bracket && attribute(&row) =>
            {
                while matches!(row.last(), Some(Token::Fixed(mark)) if mark == "#" || mark == "!") {
                    row.pop();
                }
            }
            TokenTree::Group(group) => {
                let (begin, end) = marks(group.delimiter());
                row.push(Token::Fixed(begin.to_owned()));
                open.push((group.stream().into_iter().peekable(), end));
            }
            TokenTree::Ident(name) => row.push(Token::Name(name.to_string())),
            TokenTree::Punct(mark) => row.push(Token::Fixed(mark.to_string())),
            TokenTree::Literal(_) => row.push(Token::Literal),
        }
    }
    // The places of tokens are kept by the thread for ever otherwise.
    proc_macro2::extra::invalidate_current_thread_spans();
    fix(&mut row);
    row.retain(|token| !matches!(token, Token::Fixed(mark) if GROUPING.contains(&mark.as_str())));
    Some(row)
}

/// Whether a bracket that comes next belongs to an attribute.
fn attribute(row: &[Token]) -> bool {
    let mark = |back: usize, mark: &str| {
        let at = row.len().checked_sub(back).and_then(|at| row.get(at));
        matches!(at, Some(Token::Fixed(found)) if found == mark)
    };
    mark(1, "#") || (mark(1, "!") && mark(2, "#"))
}

fn marks(delimiter: Delimiter) -> (&'static str, &'static str) {
    match delimiter {
        Delimiter::Parenthesis => ("(", ")"),
        Delimiter::Brace => ("{", "}"),
        Delimiter::Bracket => ("[", "]"),
        Delimiter::None => ("", ""),
    }
}

/// Fixes the names that are not the answer's own: keywords, types, parts of paths, macros and
/// what is called on something.
fn fix(row: &mut [Token]) {
    let is = |token: Option<&Token>, mark: &str| matches!(token, Some(Token::Fixed(found)) if found == mark);
    for at in 0..row.len() {
        let Token::Name(name) = &row[at] else {
            continue;
        };
        let before = at.checked_sub(1).and_then(|at| row.get(at));
        let after = row.get(at + 1);
        let call = is(before, ".") && (is(after, "(") || is(after, ":"));
        let double = |one: Option<&Token>, two: Option<&Token>| is(one, ":") && is(two, ":");
        let path = double(before, at.checked_sub(2).and_then(|at| row.get(at)))
            || double(after, row.get(at + 2));
        let kind = name.starts_with(char::is_uppercase);
        if call || path || kind || is(after, "!") || KEYWORDS.contains(&name.as_str()) {
            row[at] = Token::Fixed(name.clone());
        }
    }
}

/// What may stand there once more and changes nothing.
const GROUPING: &[&str] = &["", "(", ")", "{", "}", ";"];

const KEYWORDS: &[&str] = &[
    "as", "bool", "break", "const", "continue", "else", "enum", "f64", "false", "fn", "for", "if",
    "impl", "in", "let", "loop", "match", "mod", "mut", "pub", "ref", "return", "self", "static",
    "struct", "trait", "true", "type", "use", "usize", "where", "while",
];

/// The digest of every run of [`GRAM`] tokens.
fn runs(tokens: &[Token]) -> Vec<u64> {
    tokens.windows(GRAM).map(run).collect()
}

/// A digest of tokens in which names count by where they first occur.
fn run(tokens: &[Token]) -> u64 {
    let mut names: HashMap<&str, usize> = HashMap::new();
    let mut hasher = DefaultHasher::new();
    for token in tokens {
        match token {
            Token::Fixed(text) => (0, text).hash(&mut hasher),
            Token::Literal => 1.hash(&mut hasher),
            Token::Name(name) => {
                let next = names.len();
                (2, *names.entry(name).or_insert(next)).hash(&mut hasher);
            }
        }
    }
    hasher.finish()
}

/// Of every [`WINDOW`] digests in a row, the smallest; each once, in order.
fn winnowed(digests: &[u64]) -> BTreeSet<u64> {
    let smallest = |window: &[u64]| window.iter().copied().min();
    digests.windows(WINDOW.min(digests.len()).max(1)).filter_map(smallest).collect()
}
