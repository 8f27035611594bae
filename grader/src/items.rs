//! Item analysis: what a batch says about the exercises, and not about those who solved them.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use exercise_spec::Exercise;

use crate::grade::{ExerciseGrade, Grade, Outcome, Verdict};
use crate::report::markdown::{counted, escaped};
use crate::report::{points, words};
use crate::text::harmless_line;

/// With fewer submissions a correlation says nothing.
const FEWEST: usize = 10;

/// What a batch says about its exercises, gathered grade by grade.
#[derive(Debug)]
pub struct Items {
    submissions: usize,
    items: Vec<Item>,
}

/// One exercise.
#[derive(Debug, Default)]
struct Item {
    slug: String,
    title: String,
    points: f64,
    all: usize,
    part: usize,
    nothing: usize,
    missing: usize,
    unbegun: usize,
    refused: usize,
    uncompiled: usize,
    ungraded: usize,
    earned: f64,
    correlation: Correlation,
    checks: Vec<CheckItem>,
    misconceptions: BTreeMap<String, usize>,
}

/// One check.
#[derive(Debug, Default)]
struct CheckItem {
    name: String,
    hidden: bool,
    passed: usize,
    ran: usize,
    correlation: Correlation,
}

/// The correlation of two numbers, from their sums.
#[derive(Debug, Default, Clone, Copy)]
pub struct Correlation {
    count: usize,
    sums: [f64; 5],
}

impl Correlation {
    /// Adds a pair.
    pub fn add(&mut self, x: f64, y: f64) {
        self.count += 1;
        for (sum, term) in self.sums.iter_mut().zip([x, y, x * x, y * y, x * y]) {
            *sum += term;
        }
    }

    /// The correlation, if there are enough pairs and both numbers vary.
    pub fn value(&self) -> Option<f64> {
        let count = self.count as f64;
        let [x, y, xx, yy, xy] = self.sums.map(|sum| sum / count);
        let (of_x, of_y) = (xx - x * x, yy - y * y);
        let varies = of_x > 1e-9 * xx.max(1e-9) && of_y > 1e-9 * yy.max(1e-9);
        (self.count >= FEWEST && varies).then(|| (xy - x * y) / (of_x * of_y).sqrt())
    }
}

impl Items {
    /// Begins an analysis.
    pub fn new(exercises: &[&'static Exercise]) -> Self {
        let item = |exercise: &&'static Exercise| Item {
            slug: exercise.slug.to_owned(),
            title: exercise.title.to_owned(),
            ..Item::default()
        };
        Self { submissions: 0, items: exercises.iter().map(item).collect() }
    }

    /// Adds a grade.
    pub fn add(&mut self, grade: &Grade) {
        self.submissions += 1;
        let total = grade.earned();
        for item in &mut self.items {
            if let Some(found) = grade.exercises.iter().find(|found| found.exercise == item.slug) {
                // What the others earn, so that an exercise is not compared with itself.
                let rest = total.and_then(|total| Some(total - found.earned()?));
                item.add(found, rest.filter(|_| grade.exercises.len() > 1));
            }
        }
    }

    /// The report.
    pub fn markdown(&self) -> String {
        let many = self.submissions >= FEWEST;
        let mut text = format!(
            "# What the exercises say\n\n{}. Part is more than nothing and less than all. Those \
             without a file and those who left the skeleton as it was are counted apart and have \
             handed in nothing: they are no part of the mean here, as they are of the mean of all \
             in the terminal. What could not be graded counts nowhere else.\n\n",
            counted(self.submissions, "submission")
        );
        let columns = ["All", "Part", "Nothing", "No file", "Not begun", "Could not be graded"];
        text += &format!("| Exercise | {} | Mean of those handed in |", columns.join(" | "));
        text += if many { " Discrimination |\n" } else { "\n" };
        text += &format!("| --- |{}\n", " --: |".repeat(columns.len() + 1 + usize::from(many)));
        for item in &self.items {
            let _ = writeln!(text, "| {} |", item.cells(many).join(" | "));
        }
        text += &explained(many);
        self.items.iter().fold(text, |text, item| text + &item.section(many))
    }
}

impl Item {
    fn add(&mut self, exercise: &ExerciseGrade, rest: Option<f64>) {
        self.points = exercise.points;
        let Some(earned) = exercise.program() else {
            self.ungraded += 1;
            return;
        };
        match exercise.outcome {
            Outcome::Missing => {
                self.missing += 1;
                return;
            }
            Outcome::NotBegun => {
                self.unbegun += 1;
                return;
            }
            Outcome::Refused(_) => self.refused += 1,
            Outcome::DoesNotCompile(_) => self.uncompiled += 1,
            Outcome::Ran | Outcome::CouldNotGrade(_) | Outcome::InWords => {}
        }
        match earned {
            0.0 => self.nothing += 1,
            _ if earned < exercise.points * (1.0 - 1e-9) => self.part += 1,
            _ => self.all += 1,
        }
        self.earned += earned;
        if let Some(rest) = rest {
            self.correlation.add(earned, rest);
        }
        self.add_checks(exercise, rest);
        for name in exercise.misconceptions() {
            *self.misconceptions.entry(name.to_owned()).or_default() += 1;
        }
    }

    fn add_checks(&mut self, exercise: &ExerciseGrade, rest: Option<f64>) {
        for check in &exercise.checks {
            let same = |item: &CheckItem| item.name == check.name && item.hidden == check.hidden;
            let at = self.checks.iter().position(same).unwrap_or_else(|| {
                let (name, hidden) = (check.name.clone(), check.hidden);
                self.checks.push(CheckItem { name, hidden, ..CheckItem::default() });
                self.checks.len() - 1
            });
            let item = &mut self.checks[at];
            let passed = check.verdict == Verdict::Passed;
            item.ran += 1;
            item.passed += usize::from(passed);
            if let Some(rest) = rest {
                item.correlation.add(f64::from(u8::from(passed)), rest);
            }
        }
    }

    fn handed_in(&self) -> usize {
        self.all + self.part + self.nothing
    }

    fn cells(&self, many: bool) -> Vec<String> {
        let mean = match self.handed_in() {
            0 => String::new(),
            count => format!("{} of {}", points(self.earned / count as f64), points(self.points)),
        };
        let mut cells = vec![
            escaped(&self.title, 80),
            self.all.to_string(),
            self.part.to_string(),
            self.nothing.to_string(),
            self.missing.to_string(),
            self.unbegun.to_string(),
            self.ungraded.to_string(),
            mean,
        ];
        cells.extend(many.then(|| shown(self.correlation)));
        cells
    }

    fn section(&self, many: bool) -> String {
        let mut text = format!("\n## {}\n", escaped(&self.title, 80));
        if self.refused + self.uncompiled > 0 {
            let _ = write!(
                text,
                "\nAmong those that earn nothing: {} that do not compile, {} refused.\n",
                self.uncompiled, self.refused
            );
        }
        if self.checks.is_empty() {
            return text + "\nNo answer ran.\n";
        }
        text += match many {
            true => "\n| Check | | Passed | Discrimination |\n| --- | --- | --: | --: |\n",
            false => "\n| Check | | Passed |\n| --- | --- | --: |\n",
        };
        for check in &self.checks {
            let _ = writeln!(text, "| {} |", check.cells(many).join(" | "));
        }
        if self.misconceptions.is_empty() {
            return text + "\nNo misconception was recognized.\n";
        }
        text += "\n| Misconception | Submissions |\n| --- | --: |\n";
        let mut often: Vec<(&String, &usize)> = self.misconceptions.iter().collect();
        often.sort_by_key(|(name, count)| (std::cmp::Reverse(**count), *name));
        for (name, count) in often {
            let _ = writeln!(text, "| {} | {count} |", escaped(&words(name), 80));
        }
        text
    }
}

impl CheckItem {
    /// The name stands as a file of points has it.
    fn cells(&self, many: bool) -> Vec<String> {
        let name = harmless_line(&self.name, 80).replace(['`', '|'], "");
        let hidden = if self.hidden { "hidden" } else { "public" };
        let percent = 100.0 * self.passed as f64 / self.ran.max(1) as f64;
        let rate = format!("{percent:.0} % ({} of {})", self.passed, self.ran);
        let mut cells = vec![format!("`{name}`"), hidden.to_owned(), rate];
        cells.extend(many.then(|| shown(self.correlation)));
        cells
    }
}

/// What the names of checks are for, and what discrimination is where it is told.
fn explained(many: bool) -> String {
    let mut text =
        "\nChecks have the names by which the tables `checks` of a file of points weigh them.\n"
            .to_owned();
    if many {
        text += "\nDiscrimination is the correlation of what an exercise or a check earns with what \
                 the other exercises earn: near 1, those who solve it solve the others; near 0 or \
                 below, look at the exercise. It is left out where all earn the same.\n";
    }
    text
}

fn shown(correlation: Correlation) -> String {
    correlation.value().map_or_else(String::new, |value| format!("{value:.2}"))
}
