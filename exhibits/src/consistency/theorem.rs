//! One linearization point for each variable: what it keeps, and what each condition is for.

use nalgebra::{DMatrix, DVector, SVector, Vector2, Vector3};
use vislam::consistency::{Chart, Claimed};
use vislam::filtering::{Belief, Form, Transition};
use vislam::inertial::{GRAVITY, ImuBias, NavState};
use vislam::least_squares::{Key, Manifold};
use vislam::preintegration::CombinedPreintegrated;

use super::draws::{self, Eye, SIGMA, Shifted};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};
use crate::random::Random;

const STATES: usize = 100;
const FLIGHTS: usize = 20;
const LANDMARKS: usize = 6;
/// Rounding leaves less than this of what rows would say if nothing cancelled.
const ROUNDING: f64 = 1e-9;
/// By how much derivatives are taken elsewhere about the vertical, in rad.
const TURN: f64 = 0.4;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Gained = |eye, (state, point), (other, other_point)| {
        let up = Vector3::z();
        let turned = other.world_from_body * state.world_from_body.inverse() * up;
        let arm = point - state.position;
        let other_arm = other_point - other.position;
        eye.rows(other, other_point).1 * (up.cross(&arm) - turned.cross(&other_arm))
    };
    let mutants: [(_, Gained); 4] = [
        ("both turned alike", |eye, (state, point), (other, other_point)| {
            let arms = (point - state.position) - (other_point - other.position);
            eye.rows(other, other_point).1 * Vector3::z().cross(&arms)
        }),
        ("rotations exchanged", |eye, (state, point), (other, other_point)| {
            let up = Vector3::z();
            let turned = state.world_from_body * other.world_from_body.inverse() * up;
            let (arm, other_arm) = (point - state.position, other_point - other.position);
            eye.rows(other, other_point).1 * (up.cross(&arm) - turned.cross(&other_arm))
        }),
        ("the landmark's alone", |eye, (_, point), (other, other_point)| {
            eye.rows(other, other_point).1 * Vector3::z().cross(&(point - other_point))
        }),
        ("arms from the world's origin", |eye, (state, point), (other, other_point)| {
            let turned = other.world_from_body * state.world_from_body.inverse() * Vector3::z();
            eye.rows(other, other_point).1 * (Vector3::z().cross(point) - turned.cross(other_point))
        }),
    ];
    chapter.equation("yaw-gained", yaw_gained, formula, &mutants);

    let first = Case { chart: Chart::Separate, points: Points::First, known: false };
    let latest = Case { points: Points::Latest, ..first };
    for (condition, kept, dropped) in [
        ("symmetric", first, Case { known: true, ..first }),
        ("one-point", first, latest),
        (
            "common",
            Case { points: Points::Moved { apart: false, turn: TURN }, ..first },
            Case { points: Points::Moved { apart: true, turn: TURN }, ..first },
        ),
        (
            "constant",
            Case { chart: Chart::RightInvariant, ..latest },
            Case { chart: Chart::RightInvariantPoses, ..latest },
        ),
    ] {
        chapter.counterexample("one-point", condition, nothing_gained, [kept, dropped]);
    }
    let alone = Case { chart: Chart::RightInvariantPoses, ..latest };
    let shifted = Case { points: Points::Moved { apart: true, turn: 0.0 }, ..first };
    let [x, y, z, turn] = latest.sum().gained.map(f64::sqrt);
    let exponent = |part: f64| part.max(1e-16).log10().ceil();
    chapter.number("small_landmarks", LANDMARKS as f64, "", 0);
    chapter.number("mixed_shift_exponent", exponent(x.max(y).max(z) / turn), "", 0);
    chapter.number("alone_part", 100.0 * alone.sum().gained[3].sqrt() / turn, "%", 0);
    let Claimed { gained, whole } = shifted.sum();
    let part = gained.iter().zip(&whole).map(|(gained, whole)| gained / whole).fold(0.0, f64::max);
    chapter.number("apart_shift_exponent", exponent(part), "", 0);
}

/// A camera, a state and a landmark at which directions are taken, and the same elsewhere, where
/// the derivatives are.
type Gained = fn(&Eye, (&NavState, &Vector3<f64>), (&NavState, &Vector3<f64>)) -> Vector2<f64>;

fn yaw_gained(formula: Gained) -> Comparison {
    let against = "central differences of the pixel along the other estimate's turn";
    Comparison::relative(against, 1e-5).over(STATES, 7, |random| {
        let (eye, other) = (Eye::any(random), draws::state(random));
        let other_point = eye.ahead(&other, random);
        let off: [f64; 9] = std::array::from_fn(|_| random.normal(0.2));
        let state = other.retract(&off);
        let point = other_point + random.direction(0.3);
        let (free, of_point) = (draws::free(&state), draws::free_of_point(&point));
        let oracle = differences(1e-4, |along: SVector<f64, 1>| {
            let step = free.column(3) * along[0];
            let seen = other.retract(step.as_slice());
            eye.seen(&seen, &(other_point + of_point.column(3) * along[0])) / SIGMA
        });
        (formula(&eye, (&state, &point), (&other, &other_point)), oracle)
    })
}

/// Where a filter takes its derivatives.
#[derive(Clone, Copy, PartialEq)]
enum Points {
    Latest,
    First,
    /// At the first estimates, after a symmetry: pixels and readings after the same one, or pixels
    /// after one and readings after none.
    Moved {
        apart: bool,
        turn: f64,
    },
}

#[derive(Clone, Copy)]
struct Case {
    chart: Chart,
    points: Points,
    /// Whether the world's coordinates of one landmark are known.
    known: bool,
}

/// What rows claimed along the four directions, over what they would claim if nothing cancelled.
fn nothing_gained(case: Case) -> Comparison {
    let against = "nothing gained in two pictures and the readings between them";
    Comparison::absolute(against, ROUNDING, "of the whole").over(FLIGHTS, 8, |random| {
        let Claimed { gained, whole } = case.claimed(random);
        let share: [f64; 4] = std::array::from_fn(|at| gained[at] / whole[at]);
        (share, [0.0; 4])
    })
}

/// A filter of a state, its biases and some landmarks, over two pictures.
struct Filter {
    case: Case,
    eye: Eye,
    belief: Belief,
    state: Key<NavState>,
    bias: Key<ImuBias>,
    landmarks: Vec<Key<Vector3<f64>>>,
    /// First estimates of the state at this picture and of the landmarks.
    first: (NavState, Vec<Vector3<f64>>),
    symmetry: Shifted,
    claimed: Claimed,
}

impl Case {
    /// What the rows of many such filters claim.
    fn sum(self) -> Claimed {
        let (mut random, mut sum) = (Random::new(11), Claimed::default());
        (0..FLIGHTS).for_each(|_| sum.add(&self.claimed(&mut random)));
        sum
    }

    fn claimed(self, random: &mut Random) -> Claimed {
        let (eye, truth) = (Eye::any(random), draws::state(random));
        let (sums, bias) = draws::readings(random);
        let points: Vec<_> = (0..LANDMARKS).map(|_| eye.ahead(&truth, random)).collect();
        let mut filter = self.filter((eye, &truth, &points), bias, random);
        filter.picture((&truth, &points), random);
        let second = sums.sums.predict(&truth, &GRAVITY, &bias);
        filter.carry_on(&sums);
        filter.picture((&second, &points), random);
        filter.claimed
    }

    fn filter(
        self,
        (eye, truth, points): (Eye, &NavState, &[Vector3<f64>]),
        bias: ImuBias,
        random: &mut Random,
    ) -> Filter {
        let mut belief = Belief::new();
        let diagonal = |size, sigma: f64| DMatrix::from_diagonal_element(size, size, sigma * sigma);
        let off: [f64; 9] = std::array::from_fn(|_| random.normal(0.03));
        let first = truth.retract(&off);
        let guesses: Vec<_> = points.iter().map(|point| point + random.direction(0.1)).collect();
        let state = belief.add(first, &diagonal(9, 0.03)).expect("it fits");
        let bias = belief.add(bias, &diagonal(6, 0.01)).expect("it fits");
        let add = |point: &Vector3<f64>| belief.add(*point, &diagonal(3, 0.1)).expect("it fits");
        let landmarks = guesses.iter().map(add).collect();
        let symmetry = match self.points {
            Points::Moved { turn, .. } => Shifted::new(0.3, -0.2, 0.5, turn),
            _ => Shifted::zeros(),
        };
        let mut free = DMatrix::zeros(belief.dimension(), 4);
        let moved = draws::moved(&first, &symmetry);
        free.fixed_rows_mut::<9>(0).copy_from(&draws::free(&moved));
        for (at, point) in guesses.iter().enumerate() {
            let point = draws::moved_point(point, &symmetry);
            free.fixed_rows_mut::<3>(15 + 3 * at).copy_from(&draws::free_of_point(&point));
        }
        belief.follow(free).expect("a row for each coordinate");
        let (first, claimed) = ((first, guesses), Claimed::default());
        Filter { case: self, eye, belief, state, bias, landmarks, first, symmetry, claimed }
    }
}

impl Filter {
    /// Where derivatives of pixels are taken.
    fn points(&self) -> (NavState, Vec<Vector3<f64>>) {
        let values = self.belief.values();
        match self.case.points {
            Points::Latest => {
                (values[self.state], self.landmarks.iter().map(|key| values[*key]).collect())
            }
            _ => {
                let (state, points) = &self.first;
                let moved = |point| draws::moved_point(point, &self.symmetry);
                (draws::moved(state, &self.symmetry), points.iter().map(moved).collect())
            }
        }
    }

    fn picture(&mut self, (truth, points): (&NavState, &[Vector3<f64>]), random: &mut Random) {
        let (state, landmarks) = self.points();
        let values = self.belief.values();
        let mut rows = DMatrix::zeros(2 * LANDMARKS, self.belief.dimension());
        let mut residual = DVector::zeros(2 * LANDMARKS);
        for (at, landmark) in landmarks.iter().enumerate() {
            let is_known = self.case.known && at == 0;
            let estimate = if is_known { &points[at] } else { &values[self.landmarks[at]] };
            let (by_pose, by_landmark) = self.eye.rows(&state, landmark);
            rows.fixed_view_mut::<2, 3>(2 * at, 0).copy_from(&by_pose.fixed_columns::<3>(0));
            rows.fixed_view_mut::<2, 3>(2 * at, 6).copy_from(&by_pose.fixed_columns::<3>(3));
            if !is_known {
                rows.fixed_view_mut::<2, 3>(2 * at, 15 + 3 * at).copy_from(&by_landmark);
            }
            let noise = Vector2::from_fn(|_, _| random.normal(1.0));
            let off =
                self.eye.seen(&values[self.state], estimate) - self.eye.seen(truth, &points[at]);
            residual.fixed_rows_mut::<2>(2 * at).copy_from(&(off / SIGMA - noise));
        }
        self.claimed.add(&Claimed::of(&rows, self.belief.directions()));
        let chart = (self.case.chart, self.state);
        let corrected = self.belief.correct_on_chart(chart, &rows, &residual, Form::Joseph);
        corrected.expect("a covariance");
    }

    fn carry_on(&mut self, sums: &CombinedPreintegrated) {
        let values = self.belief.values();
        let (state, bias) = (values[self.state], values[self.bias]);
        let second = sums.sums.predict(&state, &GRAVITY, &bias);
        let at = |state: &NavState| match self.case.points {
            Points::Moved { apart: false, .. } => draws::moved(state, &self.symmetry),
            _ => *state,
        };
        let first = match self.case.points {
            Points::Latest => state,
            _ => self.first.0,
        };
        let states = (&at(&first), &at(&second));
        let transition = Transition::between(states, sums, &bias, &GRAVITY).expect("it is finite");
        let transition = Transition { state: second, ..transition };
        self.belief.carry_on((self.state, self.bias), &transition).expect("the keys are its own");
        self.first.0 = second;
    }
}
