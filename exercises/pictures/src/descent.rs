//! Gauss-Newton with a derivative that may be wrong: where it goes, and what that costs.

use std::sync::{Arc, Mutex, PoisonError};

use exercise_spec::answer::Fault;
use exercise_spec::check::readable;
use nalgebra::SMatrix;
use vislam::least_squares::{Dense, Options, Problem, Search, Values};
use widgets::{Axis, Panel, Reading, Scene, Shape, Style};

/// Hers, and the book's.
pub const HERS: Style = Style::First;
/// The book's.
pub const BOOKS: Style = Style::Second;

/// What a factor that asks an answer was told instead of a number.
#[derive(Clone, Default)]
pub struct Trouble(Arc<Mutex<Option<Fault>>>);

impl Trouble {
    /// The number, or none, and the fault is kept.
    pub fn or_keep<T>(&self, outcome: Result<T, Fault>) -> Option<T> {
        outcome
            .map_err(|fault| *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(fault))
            .ok()
    }

    /// What was kept.
    pub fn take(&self) -> Option<Fault> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Where a search has been.
pub struct Way<S> {
    /// The start, and where each step has led.
    pub states: Vec<S>,
    /// The cost there by the book's residual, less that of the minimum.
    pub costs: Vec<f64>,
    /// Why it went no further, if it did not.
    pub ended: Option<String>,
}

impl<S> Way<S> {
    /// Where so many steps lead that are taken whatever they do to the cost.
    pub fn gone(
        problem: &Problem,
        steps: usize,
        state: impl Fn(&Values) -> S,
        cost: impl Fn(&S) -> f64,
    ) -> Self {
        let options = Options {
            max_iterations: steps,
            gradient_tolerance: 0.0,
            step_tolerance: 0.0,
            decrease_tolerance: 0.0,
            ..Options::gauss_newton()
        };
        let mut states = vec![state(problem.values())];
        let search = Dense::new(problem).and_then(|system| Search::new(problem, system, &options));
        let ended = match search {
            Err(error) => Some(error.to_string()),
            Ok(mut search) => loop {
                match search.iterate(problem) {
                    Ok(None) => states.push(state(search.values())),
                    Ok(Some(_)) => break None,
                    Err(error) => break Some(error.to_string()),
                }
            },
        };
        let costs = states.iter().map(cost).collect();
        Self { states, costs, ended }
    }

    /// The cost and the state at the end.
    pub fn end(&self) -> (f64, &S) {
        // There is the start at least.
        (self.costs[self.costs.len() - 1], &self.states[self.states.len() - 1])
    }

    /// How many steps it takes until the cost is next to nothing.
    pub fn steps_needed(&self) -> Option<f64> {
        self.costs.iter().position(|cost| *cost < ARRIVED).map(|steps| steps as f64)
    }
}

/// A cost that is next to nothing.
const ARRIVED: f64 = 1e-9;
/// Where a cost of nothing is drawn, as a power of ten.
const FLOOR: f64 = -24.0;

/// The panel of the costs.
pub const COSTS: Panel = Panel {
    title: "Cost above its minimum: crosses yours, rings the book's",
    x: Axis { label: "step", range: [0.0, 10.0] },
    y: Axis { label: "log₁₀ of the cost", range: [FLOOR, 10.0] },
    aspect: 0.75,
    span: 3,
    equal: false,
    down: false,
};

/// How many steps it takes.
pub const fn steps(label: &'static str) -> Reading {
    Reading { label, unit: "", digits: 0, none: "not in these", veiled: false }
}

/// How far off a search ends.
pub const fn off(label: &'static str, unit: &'static str) -> Reading {
    Reading { label, unit, digits: 3, none: "no number", veiled: false }
}

/// Draws the costs of both ways.
pub fn draw_costs<S>(scene: &mut Scene, panel: usize, hers: &Way<S>, books: &Way<S>) {
    let height =
        |cost: f64| if cost.is_nan() { f64::NAN } else { cost.max(0.0).log10().clamp(FLOOR, 40.0) };
    let places = |way: &Way<S>| -> Vec<[f64; 2]> {
        way.costs.iter().enumerate().map(|(step, cost)| [step as f64, height(*cost)]).collect()
    };
    let (hers, books) = (places(hers), places(books));
    let heights = || hers.iter().chain(&books).map(|at| at[1]).filter(|height| height.is_finite());
    let top = heights().fold(0.0_f64, f64::max) + 2.0;
    let bottom = heights().fold(0.0_f64, f64::min) - 2.0;
    let steps = hers.len().max(books.len()).max(2) - 1;
    scene.view(panel, [-0.5, steps as f64 + 0.5], [bottom, top]);
    scene.draw(panel, (Shape::Line, BOOKS, 1.5), books.clone());
    scene.draw(panel, (Shape::Rings, BOOKS, 5.0), books);
    scene.draw(panel, (Shape::Dashed, HERS, 1.5), hers.clone());
    scene.draw(panel, (Shape::Crosses, HERS, 3.5), hers);
}

/// How far a derivative is from the book's, as a part of the greatest number; nothing where one of them is not there.
pub fn difference<const R: usize, const C: usize>(
    hers: Option<SMatrix<f64, R, C>>,
    books: Option<SMatrix<f64, R, C>>,
) -> Option<f64> {
    let (hers, books) = (hers?, books?);
    Some((hers - books).amax() / books.amax())
}

/// A difference that is more than one of central differences.
const SEEN: f64 = 1e-5;

/// Says how the ways end, and whether the derivative at the start is the book's.
pub fn say<S>(
    scene: &mut Scene,
    [hers, books]: [&Way<S>; 2],
    difference: Option<f64>,
    fault: Option<Fault>,
) {
    if let Some(fault) = fault {
        return scene.say(&format!("{fault}."));
    }
    if let Some(why) = &hers.ended {
        scene.say(&format!("With your derivative no further step is possible: {why}."));
    }
    let start = hers.costs.first().copied().unwrap_or(f64::NAN);
    let sentence = match (hers.steps_needed(), books.steps_needed()) {
        (Some(hers), Some(books)) if hers <= books => {
            "Your derivative leads there as fast as the book's."
        }
        (Some(_), _) => "Your derivative leads there, with more steps than the book's.",
        (None, _) if hers.end().0 >= start => {
            "With your derivative the cost has not fallen: look at signs first."
        }
        (None, Some(_)) => {
            "Your derivative does not arrive where the book's does: look at frames, and at which side a step stands."
        }
        (None, None) => "Neither has arrived: start nearer, or take more steps.",
    };
    scene.say(&format!(
        "Above its minimum the cost begins with {} and ends with {} by your derivative, with {} by the book's. {sentence}",
        readable(start),
        readable(hers.end().0),
        readable(books.end().0),
    ));
    if let Some(difference) = difference.filter(|difference| *difference > SEEN) {
        scene.say(&format!(
            "At the start it differs from the book's, by {} of the greatest number: the tests say where.",
            readable(difference)
        ));
    }
}
