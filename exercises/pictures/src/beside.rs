//! The form that fits every exercise: the numbers that a public check compares, the answer's beside those expected.

use exercise_spec::Exercise;
use exercise_spec::check::{Check, Compared, Failure, told_apart};
use nalgebra::DMatrix;
use widgets::{Axis, Control, Face, Panel, Reading, Scene, Shape, Style, Widget};

use crate::squares;
use crate::{Asked, is_silent};

/// The panels, in the order of the face.
const YOURS: usize = 0;
const EXPECTED: usize = 1;
const NUMBERS: usize = 2;
const CASES: usize = 3;
/// Her numbers.
const HERS: Style = Style::First;
/// What they should be.
const BOOKS: Style = Style::Second;
/// Where errors that are none are drawn, as a power of ten.
const FLOOR: f64 = -17.0;

/// An answer beside what its checks expect.
pub struct Beside {
    checks: Vec<Check>,
    answer: Asked,
    face: Face,
    seen: Option<Seen>,
}

/// What a check compared.
struct Seen {
    check: usize,
    cases: Vec<Compared>,
    failure: Option<Failure>,
}

impl Beside {
    /// The picture of an answer to an exercise.
    pub fn of(exercise: &'static Exercise, answer: Asked) -> Self {
        let checks = (exercise.checks)();
        let names = checks.iter().map(|check| &*check.name.replace('_', " ").leak());
        let choices: &'static [&'static str] = names.collect::<Vec<_>>().leak();
        let mut controls = Self::FACE.controls.to_vec();
        controls.insert(0, Control::choice("check", "What is tried", choices));
        let face = Face { controls: controls.leak(), ..Self::FACE };
        Self { checks, answer, face, seen: None }
    }

    /// What a check compares; it is run once.
    fn seen(&mut self, check: usize) -> &Seen {
        if self.seen.as_ref().is_none_or(|seen| seen.check != check) {
            let watched = self.checks.get(check).map(|check| check.watch(&*self.answer));
            let (cases, failure) = watched.unwrap_or_default();
            self.seen = Some(Seen { check, cases, failure });
        }
        self.seen.get_or_insert_with(|| Seen { check, cases: Vec::new(), failure: None })
    }
}

const fn bare(title: &'static str, span: usize, aspect: f64) -> Panel {
    let axis = Axis { label: "", range: [-0.6, 8.6] };
    Panel { title, x: axis, y: axis, aspect, span, equal: true, down: true }
}

const fn graph(title: &'static str, x: &'static str, y: Axis) -> Panel {
    let x = Axis { label: x, range: [0.0, 10.0] };
    Panel { title, x, y, aspect: 0.5, span: 3, equal: false, down: false }
}

const fn counted(label: &'static str) -> Reading {
    Reading { label, unit: "", digits: 0, none: "none", veiled: false }
}

impl Widget for Beside {
    const FACE: Face = Face {
        lead: "Your answer is asked what the tests ask it. A square is as large as its number, hollow where that is \
               negative; a frame marks a number that differs from the one expected.",
        controls: &[Control::slider("case", "Case", "", [1.0, 1.0, 60.0, 1.0])],
        handles: &[],
        panels: &[
            bare("Your answer", 3, 0.6),
            bare("Expected", 3, 0.6),
            graph(
                "The same in order: crosses yours, rings expected",
                "place in the list",
                Axis { label: "number", range: [-1.0, 1.0] },
            ),
            graph(
                "All cases: how far off",
                "case",
                Axis { label: "log₁₀ of the difference", range: [FLOOR - 1.0, 2.0] },
            ),
        ],
        readings: &[
            counted("Cases"),
            counted("Cases that differ"),
            counted("Numbers in this case"),
            counted("Numbers that differ"),
        ],
        question: None,
        words: &[],
    };

    fn face(&self) -> Face {
        self.face
    }

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        let [check, case] = [controls[0], controls[1]].map(|number| number.round() as usize);
        let seen = self.seen(check);
        let case = case.clamp(1, seen.cases.len().max(1));
        scene.read(seen.cases.len() as f64);
        scene.read(seen.cases.iter().filter(|case| case.failure.is_some()).count() as f64);
        match seen.cases.get(case - 1) {
            Some(compared) => {
                one(scene, compared);
                if !is_silent() {
                    all(scene, &seen.cases, case);
                }
                scene.say(&format!("Case {case} of {}: {}", seen.cases.len(), told(compared)));
                if let Some(others) = others(&seen.cases, case) {
                    scene.say(&others);
                }
            }
            None => {
                scene.read(None);
                scene.read(None);
            }
        }
        match &seen.failure {
            Some(failure) => scene.say(&failure.sentence),
            None if seen.cases.is_empty() => {
                scene.say("This check compares no numbers. Your answer passes it.");
            }
            None => {}
        }
    }
}

/// Which other cases differ.
fn others(cases: &[Compared], shown: usize) -> Option<String> {
    const MOST: usize = 8;
    let numbered =
        (1..).zip(cases).filter(|(number, case)| *number != shown && case.failure.is_some());
    let differing: Vec<String> = numbered.map(|(number, _)| number.to_string()).collect();
    let (first, more) = (differing.first()?, differing.len().saturating_sub(MOST));
    let listed = if differing.len() == 1 {
        format!("case {first}")
    } else {
        format!("cases {}", differing[..differing.len().min(MOST)].join(", "))
    };
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    Some(format!("What differs too: {listed}{more}."))
}

/// Draws one case.
fn one(scene: &mut Scene, compared: &Compared) {
    let Compared { obtained, expected, .. } = compared;
    let same_shape = obtained.shape() == expected.shape() && !is_silent();
    let wrong = |row, column| same_shape && compared.differs(row, column);
    let greatest = expected.amax().max(f64::MIN_POSITIVE);
    if !is_silent() {
        squares::draw(scene, (YOURS, HERS), obtained, greatest, wrong);
    }
    squares::draw(scene, (EXPECTED, BOOKS), expected, greatest, wrong);
    let count = (0..expected.len()).filter(|&k| wrong(k % expected.nrows(), k / expected.nrows()));
    scene.read(expected.len() as f64);
    scene.read(same_shape.then(|| count.count() as f64));
    // By rows, as one reads.
    let listed = |matrix: &DMatrix<f64>| -> Vec<[f64; 2]> {
        let entries = matrix.transpose();
        entries.iter().enumerate().map(|(k, number)| [k as f64 + 1.0, *number]).collect()
    };
    let (hers, books) = (listed(obtained), listed(expected));
    let most = hers.len().max(books.len()) as f64;
    let [low, high] = expected
        .iter()
        .fold([0.0_f64; 2], |[low, high], number| [low.min(*number), high.max(*number)]);
    // What is wrong by far would leave nothing to see of the rest.
    let room = (high - low).max(1e-12);
    let (mut bottom, mut top) = (low - 0.15 * room, high + 0.15 * room);
    for number in obtained.iter().filter(|number| number.is_finite()) {
        bottom = bottom.min(number.max(low - room) - 0.1 * room);
        top = top.max(number.min(high + room) + 0.1 * room);
    }
    scene.view(NUMBERS, [0.0, most + 1.0], [bottom, top]);
    scene.draw(NUMBERS, (Shape::Rings, BOOKS, 5.0), books);
    if !is_silent() {
        scene.draw(NUMBERS, (Shape::Crosses, HERS, 3.5), hers);
    }
}

/// Draws how far off all cases are.
fn all(scene: &mut Scene, cases: &[Compared], shown: usize) {
    let place = |(number, case): (usize, &Compared)| [number as f64 + 1.0, case_error(case)];
    let places: Vec<[f64; 2]> = cases.iter().enumerate().map(place).collect();
    let (wrong, right): (Vec<_>, Vec<_>) =
        places.iter().zip(cases).partition(|(_, case)| case.failure.is_some());
    let tolerance = cases.iter().enumerate().flat_map(|(number, case)| {
        let (at, height) = (number as f64 + 1.0, case.tolerance.log10());
        [[at - 0.5, height], [at + 0.5, height]]
    });
    scene.view(CASES, [0.0, cases.len() as f64 + 1.0], [FLOOR - 1.0, 3.0]);
    scene.draw(CASES, (Shape::Dashed, Style::Faint, 1.5), tolerance.collect::<Vec<_>>());
    let of =
        |list: Vec<(&[f64; 2], &Compared)>| list.into_iter().map(|(at, _)| *at).collect::<Vec<_>>();
    scene.draw(CASES, (Shape::Discs, HERS, 4.0), of(right));
    scene.draw(CASES, (Shape::Crosses, HERS, 4.5), of(wrong));
    scene.draw(CASES, (Shape::Rings, Style::Ink, 8.0), places.get(shown - 1).copied());
}

/// The largest difference as a part of the greatest number, as a power of ten.
fn case_error(case: &Compared) -> f64 {
    if case.obtained.shape() != case.expected.shape() {
        return 2.0;
    }
    let error =
        (&case.obtained - &case.expected).amax() / case.expected.amax().max(f64::MIN_POSITIVE);
    if error.is_finite() { error.log10().clamp(FLOOR, 2.0) } else { 2.0 }
}

/// A case in words.
fn told(compared: &Compared) -> String {
    let Compared { what, obtained, expected, failure, .. } = compared;
    let Some(failure) = failure else {
        return format!("{what} agrees with what is expected.");
    };
    if obtained.shape() != expected.shape() || !obtained.iter().all(|number| number.is_finite()) {
        return failure.sentence.clone();
    }
    let places = (0..expected.len()).map(|k| (k % expected.nrows(), k / expected.nrows()));
    let off = |&at: &(usize, usize)| (obtained[at] - expected[at]).abs();
    let at = places.max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or_default();
    let [hers, books] = told_apart(obtained[at], expected[at]);
    let place = place(compared, at);
    let why = failure.misconception.map_or("", |misconception| misconception.sentence);
    let said = format!("{what} differs, most of all{place}: yours {hers}, expected {books}. {why}");
    said.trim_end().to_owned()
}

/// Where a number stands, by the names of its row and column or as Rust counts.
fn place(Compared { expected, rows, columns, .. }: &Compared, at: (usize, usize)) -> String {
    let named = |names: &[String], index: usize| names.get(index).cloned();
    match (expected.nrows(), expected.ncols(), named(rows, at.0), named(columns, at.1)) {
        (1, 1, ..) => String::new(),
        (_, 1, Some(row), _) => format!(" at {row}"),
        (_, 1, None, _) => format!(" at [{}]", at.0),
        (_, _, Some(row), Some(column)) => format!(" at ({row}, {column})"),
        (_, _, Some(row), None) => format!(" at ({row}, [{}])", at.1),
        _ => format!(" at [{}, {}]", at.0, at.1),
    }
}
