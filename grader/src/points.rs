//! What exercises and checks are worth: a file as `points.toml`.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use book_tests::hidden_checks;
use exercise_spec::{EXERCISES, Exercise, exercise};
use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::fly::GRADED_FLIGHT;
use crate::text::harmless_line;
use crate::words;

/// What exercises are worth and what their checks weigh.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Points {
    public: f64,
    hidden: f64,
    points: BTreeMap<String, f64>,
    checks: BTreeMap<String, BTreeMap<String, f64>>,
    /// They decide nothing that a machine grades, and a change of them grades nobody again.
    #[serde(skip)]
    words: BTreeMap<String, f64>,
    #[serde(skip)]
    late: Lateness,
}

/// What is taken off of a submission that came too late.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Lateness {
    percent_a_day: f64,
    most: f64,
    free_days: f64,
}

/// The file, with where its names and numbers stand.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Lines {
    weights: Weights,
    points: Table,
    #[serde(default)]
    checks: BTreeMap<Spanned<String>, Table>,
    #[serde(default)]
    words: Table,
    late: Option<Late>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Late {
    percent_a_day: Spanned<f64>,
    most: Option<Spanned<f64>>,
    free_days: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Weights {
    public: Spanned<f64>,
    hidden: Spanned<f64>,
}

type Table = BTreeMap<Spanned<String>, Spanned<f64>>;

/// More than anything is worth, so that no sum of points ends in infinity.
const MOST: f64 = 1e6;

impl Points {
    /// Reads a file.
    ///
    /// # Errors
    ///
    /// A sentence with the line when it cannot be read, names what there is not, holds a number
    /// that is no weight, leaves an exercise out, or gives points that no check can earn.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = fs::read_to_string(path)
            .map_err(|error| format!("cannot read the points in {}: {error}", path.display()))?;
        Self::parse(&text).map_err(|error| format!("{}: {error}", path.display()))
    }

    /// The same from text.
    ///
    /// # Errors
    ///
    /// As [`Points::read`].
    pub fn parse(text: &str) -> Result<Self, String> {
        let page = Page(text);
        let lines: Lines = toml::from_str(text).map_err(|error| page.unread(&error))?;
        let points = Self {
            public: page.weight("public", &lines.weights.public)?,
            hidden: page.weight("hidden", &lines.weights.hidden)?,
            points: page.points(&lines.points)?,
            checks: page.checks(&lines.checks)?,
            words: page.words(&lines.words)?,
            late: page.lateness(lines.late.as_ref())?,
        };
        EXERCISES.iter().try_for_each(|exercise| points.suffices(exercise))?;
        Ok(points)
    }

    /// What an exercise is worth.
    pub fn of(&self, slug: &str) -> f64 {
        self.points.get(slug).copied().unwrap_or(0.0)
    }

    /// What an answer in words is worth.
    pub fn of_words(&self, slug: &str) -> f64 {
        self.words.get(slug).copied().unwrap_or(0.0)
    }

    /// What is taken off after so many days, in percent.
    pub fn taken_off(&self, days: f64) -> f64 {
        let Lateness { percent_a_day, most, free_days } = self.late;
        (percent_a_day * (days - free_days).max(0.0).ceil()).min(most)
    }

    /// What a check weighs beside the others of its exercise.
    pub fn weight(&self, slug: &str, check: &str, hidden: bool) -> f64 {
        let alone = self.checks.get(slug).and_then(|checks| checks.get(check));
        alone.copied().unwrap_or(if hidden { self.hidden } else { self.public })
    }

    /// Whether the file says what the exercise is worth, and somebody can earn it.
    fn suffices(&self, exercise: &Exercise) -> Result<(), String> {
        let slug = exercise.slug;
        let Some(points) = self.points.get(slug) else {
            return Err(format!(
                "[points] does not say what `{slug}` is worth; add `{slug} = 10`, or 0 if it is \
                 not to count"
            ));
        };
        if *points > 0.0 && !self.weighs(exercise) {
            return Err(format!(
                "`{slug}` is worth {points} points, and each of its checks weighs 0, so that \
                 nobody could earn them; give a check a weight"
            ));
        }
        Ok(())
    }

    /// Whether a check of the exercise weighs anything.
    fn weighs(&self, exercise: &Exercise) -> bool {
        if !self.checks.contains_key(exercise.slug) {
            // There are checks of both kinds; to draw the hidden ones takes a while.
            return self.public + self.hidden > 0.0;
        }
        let weighs =
            |(name, hidden): &(&str, bool)| self.weight(exercise.slug, name, *hidden) > 0.0;
        checks_of(exercise).iter().any(weighs)
    }
}

/// Names of an exercise's checks, and whether they are hidden.
fn checks_of(exercise: &Exercise) -> Vec<(&'static str, bool)> {
    let public = (exercise.checks)().into_iter().map(|check| (check.name, false));
    let hidden = hidden_checks(exercise.slug, 0).unwrap_or_default();
    public.chain(hidden.into_iter().map(|check| (check.name, true))).collect()
}

/// The text, for errors that say where.
struct Page<'a>(&'a str);

impl Page<'_> {
    fn line<T>(&self, at: &Spanned<T>) -> usize {
        let before = self.0.get(..at.span().start).unwrap_or_default();
        before.matches('\n').count() + 1
    }

    /// What cannot be read, with its line. The parser does not know that values are numbers.
    fn unread(&self, error: &toml::de::Error) -> String {
        let at = error.span().map_or(0, |span| span.start);
        let before = self.0.get(..at).unwrap_or_default().matches('\n').count();
        let line = self.0.lines().nth(before).unwrap_or_default();
        let line = line.split('#').next().unwrap_or_default();
        match line.split_once('=') {
            Some((name, value)) if value.trim().parse::<f64>().is_err() => {
                let name = harmless_line(name.trim(), 80);
                format!(
                    "line {}: `{name}` must be a number, and here it is `{}`; write `{name} = 10`",
                    before + 1,
                    harmless_line(value.trim(), 80)
                )
            }
            _ => error.to_string(),
        }
    }

    fn weight(&self, name: &str, number: &Spanned<f64>) -> Result<f64, String> {
        let value = *number.get_ref();
        if (0.0..=MOST).contains(&value) {
            return Ok(value);
        }
        let line = self.line(number);
        Err(format!("line {line}: `{name}` is {value}; write a number from 0 to {MOST}"))
    }

    fn lateness(&self, late: Option<&Late>) -> Result<Lateness, String> {
        let Some(late) = late else { return Ok(Lateness::default()) };
        let or = |name, number: &Option<Spanned<f64>>, other| {
            number.as_ref().map_or(Ok(other), |number| self.weight(name, number))
        };
        let percent_a_day = self.weight("percent_a_day", &late.percent_a_day)?;
        let most = or("most", &late.most, 100.0)?.min(100.0);
        Ok(Lateness { percent_a_day, most, free_days: or("free_days", &late.free_days, 0.0)? })
    }

    fn points(&self, table: &Table) -> Result<BTreeMap<String, f64>, String> {
        let one = |(slug, number): (&Spanned<String>, &Spanned<f64>)| {
            if slug.get_ref() != GRADED_FLIGHT.slug {
                self.exercise(slug)?;
            }
            Ok((slug.get_ref().clone(), self.weight(slug.get_ref(), number)?))
        };
        table.iter().map(one).collect()
    }

    fn words(&self, table: &Table) -> Result<BTreeMap<String, f64>, String> {
        let one = |(slug, number): (&Spanned<String>, &Spanned<f64>)| {
            let name = slug.get_ref();
            if words::question(name).is_none() {
                return Err(format!("line {}: {}", self.line(slug), words::unknown(name)));
            }
            Ok((name.clone(), self.weight(name, number)?))
        };
        table.iter().map(one).collect()
    }

    fn checks(
        &self,
        tables: &BTreeMap<Spanned<String>, Table>,
    ) -> Result<BTreeMap<String, BTreeMap<String, f64>>, String> {
        let one = |(slug, table): (&Spanned<String>, &Table)| {
            let known = checks_of(self.exercise(slug)?);
            let weights = table.iter().map(|(name, number)| {
                self.check(slug.get_ref(), name, &known)?;
                Ok((name.get_ref().clone(), self.weight(name.get_ref(), number)?))
            });
            Ok((slug.get_ref().clone(), weights.collect::<Result<_, String>>()?))
        };
        tables.iter().map(one).collect()
    }

    fn exercise(&self, slug: &Spanned<String>) -> Result<&'static Exercise, String> {
        exercise(slug.get_ref())
            .ok_or_else(|| format!("line {}: {}", self.line(slug), unknown(slug.get_ref())))
    }

    fn check(
        &self,
        slug: &str,
        name: &Spanned<String>,
        known: &[(&str, bool)],
    ) -> Result<(), String> {
        if known.iter().any(|(check, _)| check == name.get_ref()) {
            return Ok(());
        }
        let names: Vec<&str> = known.iter().map(|(check, _)| *check).collect();
        Err(format!(
            "line {}: `{slug}` has no check `{}`; it has {}. The items.md of a batch lists the \
             checks of all exercises",
            self.line(name),
            name.get_ref(),
            names.join(", ")
        ))
    }
}

/// That there is no exercise of a name, and which there are.
pub fn unknown(slug: &str) -> String {
    let all: Vec<&str> = EXERCISES.iter().map(|exercise| exercise.slug).collect();
    format!("there is no exercise `{slug}`; there is {}", all.join(", "))
}
