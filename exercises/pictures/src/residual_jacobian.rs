//! Where an interval began: Gauss-Newton on the first state, by the answer's derivative and by the book's.

use exercise_spec::Exercise;
use exercise_spec::draw::Draw;
use exercise_spec::residual_jacobian::{Answer, Case, Matrix9, State, Vector9};
use nalgebra::{Rotation3, Vector3};
use vislam::inertial::{ImuBias, NavState};
use vislam::least_squares::{Factor, Kernel, Key, Problem};
use vislam::manifold::so3;
use vislam::preintegration::{LinearizedImu, linearize};
use widgets::{Axis, Control, Face, Panel, Reading, Scene, Shape, Style, Widget};

use crate::Asked;
use crate::descent::{self, BOOKS, COSTS, HERS, Trouble, Way};

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

impl ResidualJacobian {
    /// Where the search goes from a start.
    fn way(
        &self,
        case: &Case,
        start: NavState,
        steps: usize,
        parts: Parts,
        trouble: &Trouble,
    ) -> Way<NavState> {
        let mut problem = Problem::new();
        let first = problem.add_variable(start);
        let beginning = || Beginning {
            case: *case,
            first,
            answer: self.answer.clone(),
            parts,
            trouble: trouble.clone(),
        };
        // The variable is the problem's own.
        let _ = problem.add_factor(beginning(), Kernel::Squared);
        let judge = beginning();
        Way::gone(
            &problem,
            steps,
            |values| values[first],
            |state| 0.5 * judge.by_book(state).residual.norm_squared(),
        )
    }
}

/// A case whose second state is where the readings lead.
fn agreed(number: f64, duration: f64) -> Case {
    let mut draw = Draw::new(number as u64);
    let case = Case::drawn(&mut draw, [0.1, 0.2], [duration, duration + 1e-9]);
    Case { second: case.deltas.lead(&case.first, &case.gravity), ..case }
}

impl Widget for ResidualJacobian {
    const FACE: Face = Face {
        lead: "The end of an interval is known and its beginning is sought: Gauss-Newton steps, once with your \
               derivative and once with the book's, from one start.",
        controls: &[
            Control::choice("steps", "Derivative", &["by_first", "by_world_steps of by_first"]),
            Control::choice("residual", "Residual", &["the book's", "yours"]),
            Control::slider("turned", "Start turned by", "°", [40.0, 0.0, 170.0, 5.0]),
            Control::slider("shifted", "Start shifted by", "m", [3.0, 0.0, 10.0, 0.5]),
            Control::slider("duration", "Interval", "s", [1.0, 0.3, 3.0, 0.1]),
            Control::slider("count", "Steps", "", [8.0, 1.0, 20.0, 1.0]),
            Control::slider("problem", "Problem", "", [1.0, 1.0, 20.0, 1.0]),
        ],
        handles: &[],
        panels: &[
            COSTS,
            Panel {
                title: "The first position from above; the ring is where it should be",
                x: Axis { label: "x (m)", range: [-5.0, 5.0] },
                y: Axis { label: "y (m)", range: [-5.0, 5.0] },
                aspect: 0.75,
                span: 3,
                equal: true,
                down: false,
            },
        ],
        readings: &[
            Reading {
                label: "Steps until the cost is gone, yours",
                unit: "",
                digits: 0,
                none: "not in these",
                veiled: false,
            },
            Reading {
                label: "The same, the book's",
                unit: "",
                digits: 0,
                none: "not in these",
                veiled: false,
            },
            Reading {
                label: "Position off in the end, yours",
                unit: "m",
                digits: 3,
                none: "no number",
                veiled: false,
            },
            Reading {
                label: "Rotation off in the end, yours",
                unit: "°",
                digits: 3,
                none: "no number",
                veiled: false,
            },
        ],
        question: None,
        words: &[],
    };

    fn show(&mut self, controls: &[f64], scene: &mut Scene) {
        let &[derivative, residual, turned, shifted, duration, count, number] = controls else {
            return;
        };
        let case = agreed(number, duration);
        let truth = case.first.nav();
        let mut draw = Draw::new(100 + number as u64);
        let [axis, way, speed] = [0; 3].map(|_| draw.direction());
        let start = NavState {
            world_from_body: truth.world_from_body * Rotation3::new(turned.to_radians() * axis),
            velocity: truth.velocity + shifted * speed,
            position: truth.position + shifted * way,
        };
        let trouble = Trouble::default();
        let parts =
            Parts { residual: residual > 0.5, derivative: true, dictionary: derivative > 0.5 };
        let none = Parts { residual: false, derivative: false, dictionary: false };
        let books = self.way(&case, start, count as usize, none, &trouble);
        let hers = self.way(&case, start, count as usize, parts, &trouble);
        scene.read(hers.steps_needed());
        scene.read(books.steps_needed());
        let end = hers.states.last().copied().unwrap_or(start);
        scene.read((end.position - truth.position).norm());
        scene.read(so3::local(&truth.world_from_body, &end.world_from_body).norm().to_degrees());
        descent::draw_costs(scene, 0, &hers, &books);
        draw_ways(scene, 1, [&hers, &books], &truth.position, &start.position);
        descent::say(scene, &hers, &books, trouble.take());
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
