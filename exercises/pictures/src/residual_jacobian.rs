//! Where an interval began: Gauss-Newton on the first state, by the answer's derivative and by the book's.

use exercise_spec::Exercise;
use exercise_spec::draw::Draw;
use exercise_spec::residual_jacobian::{Answer, Case, Matrix9, State, Vector9};
use nalgebra::{Rotation3, Vector3};
use vislam::inertial::{ImuBias, NavState};
use vislam::least_squares::{Factor, Kernel, Key, Problem};
use vislam::manifold::so3;
use vislam::preintegration::{LinearizedImu, linearize};
use widgets::{Axis, Control, Face, Panel, Scene, Shape, Style, Widget};

use crate::Asked;
use crate::descent::{self, BOOKS, COSTS, HERS, Trouble, Way, off, steps};

/// How many intervals there are.
const INTERVALS: usize = 3;
/// As many steps as lead to the minimum.
const MANY: usize = 80;

/// A search for the first state.
pub struct ResidualJacobian {
    answer: Asked,
}

impl ResidualJacobian {
    /// The picture of an answer.
    pub fn of(_: &'static Exercise, answer: Asked) -> Self {
        Self { answer }
    }
}

/// Which functions of the answer take part.
#[derive(Clone, Copy)]
struct Parts {
    residual: bool,
    derivative: bool,
    dictionary: bool,
}

/// The residual of an interval whose end is known, of the state at its beginning.
#[derive(Clone)]
struct Beginning {
    case: Case,
    first: Key<NavState>,
    answer: Asked,
    parts: Parts,
    trouble: Trouble,
}

impl Beginning {
    fn by_book(&self, first: &NavState) -> LinearizedImu {
        let Case { deltas, second, gravity, .. } = &self.case;
        linearize(&deltas.preintegrated(), first, &second.nav(), gravity, &ImuBias::default())
    }

    fn asked_residual(&self, first: &NavState) -> Option<Vector9> {
        if !self.parts.residual {
            return Some(self.by_book(first).residual);
        }
        let Case { deltas, second, gravity, .. } = &self.case;
        self.trouble.or_keep(Answer(&*self.answer).residual(
            deltas,
            &State::of(first),
            second,
            gravity,
        ))
    }

    /// By steps in the world, as a state is moved here.
    fn asked_derivative(&self, first: &NavState) -> Option<Matrix9> {
        let Case { deltas, second, gravity, .. } = &self.case;
        let (answer, state) = (Answer(&*self.answer), State::of(first));
        let by_first = self.trouble.or_keep(answer.by_first(deltas, &state, second, gravity))?;
        if self.parts.dictionary {
            return self.trouble.or_keep(answer.by_world_steps(&state, &by_first));
        }
        // A step in the world is this one in the body frame.
        let turn = first.world_from_body.inverse();
        let mut by_world_steps = by_first;
        for at in [3, 6] {
            let columns = by_first.fixed_columns::<3>(at) * turn.matrix();
            by_world_steps.fixed_columns_mut::<3>(at).copy_from(&columns);
        }
        Some(by_world_steps)
    }
}

impl Factor<9> for Beginning {
    type Variables = (NavState,);
    type Jacobians = (Matrix9,);

    fn variables(&self) -> (Key<NavState>,) {
        (self.first,)
    }

    fn residual(&self, (first,): (&NavState,)) -> Option<Vector9> {
        self.asked_residual(first)
    }

    fn linearize(&self, (first,): (&NavState,)) -> Option<(Vector9, (Matrix9,))> {
        let residual = self.asked_residual(first)?;
        let derivative = if self.parts.derivative {
            self.asked_derivative(first)?
        } else {
            self.by_book(first).by_first
        };
        Some((residual, (derivative,)))
    }
}

/// Intervals that begin with one state, and where the search for it begins.
struct Setting {
    cases: Vec<Case>,
    start: NavState,
}

impl Setting {
    /// The ends of the intervals say where the beginning is, and contradict each other by an angle.
    fn drawn(number: f64, [turned, shifted, duration, contradicted]: [f64; 4]) -> Self {
        let mut draw = Draw::new(number as u64);
        let drawn = |draw: &mut Draw| Case::drawn(draw, [0.1, 0.2], [duration, duration + 1e-9]);
        let Case { first, gravity, .. } = drawn(&mut draw);
        let case = |_| {
            let Case { deltas, .. } = drawn(&mut draw);
            let led = deltas.lead(&first, &gravity);
            let off = Rotation3::new(contradicted.to_radians() * draw.direction());
            let second = State {
                world_from_body: led.world_from_body * off,
                velocity: led.velocity + contradicted / 40.0 * draw.direction(),
                position: led.position + contradicted / 40.0 * draw.direction(),
            };
            Case { deltas, first, second, gravity }
        };
        let cases = (0..INTERVALS).map(case).collect();
        let [axis, way, speed] = [0; 3].map(|_| draw.direction());
        let start = NavState {
            world_from_body: first.world_from_body * Rotation3::new(turned.to_radians() * axis),
            velocity: first.velocity + shifted * speed,
            position: first.position + shifted * way,
        };
        Self { cases, start }
    }

    /// The residuals of all intervals, of a variable of a problem.
    fn beginnings(
        &self,
        problem: &mut Problem,
        (answer, parts, trouble): (&Asked, Parts, &Trouble),
    ) -> Vec<Beginning> {
        let first = problem.add_variable(self.start);
        let (answer, trouble) = (answer.clone(), trouble.clone());
        let beginning = |case: &Case| Beginning {
            case: *case,
            first,
            answer: answer.clone(),
            parts,
            trouble: trouble.clone(),
        };
        self.cases.iter().map(beginning).collect()
    }

    /// How far the derivative at the start is from the book's.
    fn difference(&self, asked: (&Asked, Parts, &Trouble)) -> Option<f64> {
        let beginnings = self.beginnings(&mut Problem::new(), asked);
        let first = beginnings.first()?;
        let books = first.by_book(&self.start).by_first;
        descent::difference(first.asked_derivative(&self.start), Some(books))
    }

    /// Where the search goes, and the costs there less `least`.
    fn way(&self, asked: (&Asked, Parts, &Trouble), steps: usize, least: f64) -> Way<NavState> {
        let mut problem = Problem::new();
        let beginnings = self.beginnings(&mut problem, asked);
        for beginning in &beginnings {
            // The variable is the problem's own.
            let _ = problem.add_factor(beginning.clone(), Kernel::Squared);
        }
        let cost = |state: &NavState| {
            let squares = beginnings.iter().map(|one| one.by_book(state).residual.norm_squared());
            0.5 * squares.sum::<f64>() - least
        };
        Way::gone(&problem, steps, |values| values[beginnings[0].first], cost)
    }
}

impl Widget for ResidualJacobian {
    const FACE: Face = Face {
        lead: "Three intervals begin with one state, and their ends say where: Gauss-Newton steps on it, once with \
               your derivative and once with the book's, from one start.",
        controls: &[
            Control::choice("steps", "Derivative", &["by_first", "by_world_steps of by_first"]),
            Control::choice("residual", "Residual", &["the book's", "yours"]),
            Control::slider("turned", "Start turned by", "°", [40.0, 0.0, 120.0, 5.0]),
            Control::slider("shifted", "Start shifted by", "m", [3.0, 0.0, 10.0, 0.5]),
            Control::slider(
                "contradicted",
                "Ends contradict each other by",
                "°",
                [20.0, 0.0, 40.0, 1.0],
            ),
            Control::slider("duration", "Length of the intervals", "s", [1.0, 0.3, 3.0, 0.1]),
            Control::slider("count", "Steps", "", [12.0, 1.0, 30.0, 1.0]),
            Control::slider("problem", "Problem", "", [1.0, 1.0, 20.0, 1.0]),
        ],
        handles: &[],
        panels: &[
            COSTS,
            Panel {
                title: "The first position from above; from the disc to the ring",
                x: Axis { label: "x (m)", range: [-5.0, 5.0] },
                y: Axis { label: "y (m)", range: [-5.0, 5.0] },
                aspect: 0.75,
                span: 3,
                equal: true,
                down: false,
            },
        ],
        readings: &[
            steps("Steps until it is there, yours"),
            steps("The same, the book's"),
            off("Position off in the end, yours", "m"),
            off("Rotation off in the end, yours", "°"),
        ],
        question: None,
        words: &[],
    };

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        let &[derivative, residual, turned, shifted, contradicted, duration, count, number] =
            controls
        else {
            return;
        };
        let setting = Setting::drawn(number, [turned, shifted, duration, contradicted]);
        let trouble = Trouble::default();
        let none = Parts { residual: false, derivative: false, dictionary: false };
        let parts =
            Parts { residual: residual > 0.5, derivative: true, dictionary: derivative > 0.5 };
        let by_book = (&self.answer, none, &trouble);
        let whole = setting.way(by_book, MANY, 0.0);
        let (least, there) = whole.end();
        let books = setting.way(by_book, count as usize, least);
        let hers = setting.way((&self.answer, parts, &trouble), count as usize, least);
        scene.read(hers.steps_needed());
        scene.read(books.steps_needed());
        let (_, end) = hers.end();
        scene.read((end.position - there.position).norm());
        scene.read(so3::local(&there.world_from_body, &end.world_from_body).norm().to_degrees());
        descent::draw_costs(scene, 0, &hers, &books);
        draw_ways(scene, 1, [&hers, &books], &there.position, &setting.start.position);
        let difference = setting.difference((&self.answer, parts, &trouble));
        descent::say(scene, [&hers, &books], difference, trouble.take());
    }
}

fn draw_ways(
    scene: &mut Scene,
    panel: usize,
    [hers, books]: [&Way<NavState>; 2],
    truth: &Vector3<f64>,
    start: &Vector3<f64>,
) {
    let places = |way: &Way<NavState>| -> Vec<[f64; 2]> {
        way.states.iter().map(|state| [state.position.x, state.position.y]).collect()
    };
    // The way of the book fits, and what leaves is seen leaving.
    let mut corners = places(books);
    corners.push([truth.x, truth.y]);
    let range = |axis: usize| {
        let along = || corners.iter().map(|at| at[axis]).filter(|at| at.is_finite());
        let (low, high) =
            (along().fold(start[axis], f64::min), along().fold(start[axis], f64::max));
        let room = (0.4 * (high - low)).max(2.0);
        [low - room, high + room]
    };
    scene.view(panel, range(0), range(1));
    scene.draw(panel, (Shape::Line, BOOKS, 1.5), places(books));
    scene.draw(panel, (Shape::Rings, BOOKS, 4.0), places(books));
    scene.draw(panel, (Shape::Dashed, HERS, 1.5), places(hers));
    scene.draw(panel, (Shape::Crosses, HERS, 3.5), places(hers));
    scene.draw(panel, (Shape::Discs, Style::Ink, 4.0), [[start.x, start.y]]);
    scene.draw(panel, (Shape::Rings, Style::Ink, 9.0), [[truth.x, truth.y]]);
}
