//! Gauss-Newton with a derivative that may be wrong: where it goes, and what that costs.

use std::sync::{Arc, Mutex, PoisonError};

use exercise_spec::answer::Fault;
use vislam::least_squares::{Dense, Options, Problem, Search, Values};
use widgets::{Axis, Panel, Scene, Shape, Style};

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
    /// The cost there, by the book's residual.
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

    /// How many steps it takes until the cost is next to nothing.
    pub fn steps_needed(&self) -> Option<f64> {
        self.costs.iter().position(|cost| *cost < ARRIVED).map(|steps| steps as f64)
    }

    fn last(&self) -> f64 {
        self.costs.last().copied().unwrap_or(f64::NAN)
    }
}

/// A cost that is next to nothing.
const ARRIVED: f64 = 1e-12;
/// Where a cost of nothing is drawn, as a power of ten.
const FLOOR: f64 = -32.0;

/// The panel of the costs.
pub const COSTS: Panel = Panel {
    title: "Cost: crosses with your derivative, rings with the book's",
    x: Axis { label: "step", range: [0.0, 10.0] },
    y: Axis { label: "log₁₀ of the cost", range: [FLOOR, 10.0] },
    aspect: 0.75,
    span: 3,
    equal: false,
    down: false,
};

/// Draws the costs of both ways.
pub fn draw_costs<S>(scene: &mut Scene, panel: usize, hers: &Way<S>, books: &Way<S>) {
    let height = |cost: f64| if cost.is_nan() { f64::NAN } else { cost.log10().clamp(FLOOR, 40.0) };
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

/// Says how the ways end.
pub fn say<S>(scene: &mut Scene, hers: &Way<S>, books: &Way<S>, fault: Option<Fault>) {
    let number = exercise_spec::check::readable;
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
        (Some(_), _) => {
            "Your derivative leads there, with more steps than the book's: something in it is not quite the slope."
        }
        (None, _) if hers.last() >= start => {
            "With your derivative the cost has not fallen: look at signs first."
        }
        (None, Some(_)) => {
            "Your derivative creeps where the book's arrives: look at frames, and at which side a step stands."
        }
        (None, None) => "Neither has arrived: start nearer, or take more steps.",
    };
    scene.say(&format!(
        "The cost begins with {} and ends with {} by your derivative, with {} by the book's. {sentence}",
        number(start),
        number(hers.last()),
        number(books.last()),
    ));
}
