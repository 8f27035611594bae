//! A filter of a state, its biases and some landmarks, over a few pictures, whose derivatives are taken
//! where one likes.

use nalgebra::{DMatrix, DVector, Vector2, Vector3};
use vislam::consistency::{Chart, Claimed};
use vislam::filtering::{Belief, Form, Transition};
use vislam::inertial::{GRAVITY, ImuBias, NavState};
use vislam::least_squares::{Key, Manifold};
use vislam::preintegration::CombinedPreintegrated;

use super::draws::{self, Eye, SIGMA, Shifted};
use crate::random::Random;

pub const LANDMARKS: usize = 6;
/// Standard deviations at the beginning: of a state in rad, m/s and m, of a bias in rad/s and m/s², of
/// a landmark in m.
const SIGMAS: [f64; 3] = [0.03, 0.01, 0.1];

/// Where a filter takes its derivatives.
#[derive(Clone, Copy, PartialEq)]
pub enum Points {
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
pub struct Case {
    pub chart: Chart,
    pub points: Points,
    /// Whether the world's coordinates of one landmark are known.
    pub known: bool,
}

/// A filter of a state, its biases and some landmarks.
pub struct Filter {
    case: Case,
    eye: Eye,
    belief: Belief,
    state: Key<NavState>,
    bias: Key<ImuBias>,
    landmarks: Vec<Key<Vector3<f64>>>,
    /// First estimates of the state at this picture and of the landmarks.
    first: (NavState, Vec<Vector3<f64>>),
    symmetry: Shifted,
    /// What its rows claimed along the free directions.
    pub claimed: Claimed,
    /// For each picture its rows, by the errors at the beginning.
    pub seen: Vec<DMatrix<f64>>,
}

impl Case {
    /// A filter after so many pictures with readings between them.
    pub fn flown(self, pictures: usize, random: &mut Random) -> Filter {
        let (eye, mut truth) = (Eye::any(random), draws::state(random));
        let (mut sums, bias) = draws::readings(random);
        let points: Vec<_> = (0..LANDMARKS).map(|_| eye.ahead(&truth, random)).collect();
        let mut filter = self.filter((eye, &truth, &points), bias, random);
        filter.picture((&truth, &points), random);
        for picture in 1..pictures {
            if picture > 1 {
                sums = draws::summed(&bias, random);
            }
            truth = sums.sums.predict(&truth, &GRAVITY, &bias);
            filter.carry_on(&sums);
            filter.picture((&truth, &points), random);
        }
        filter
    }

    fn filter(
        self,
        (eye, truth, points): (Eye, &NavState, &[Vector3<f64>]),
        bias: ImuBias,
        random: &mut Random,
    ) -> Filter {
        let mut belief = Belief::new();
        let diagonal = |size, sigma: f64| DMatrix::from_diagonal_element(size, size, sigma * sigma);
        let [of_state, of_bias, of_point] = SIGMAS;
        let off: [f64; 9] = std::array::from_fn(|_| random.normal(of_state));
        let first = truth.retract(&off);
        let guess = |point| point + random.direction(of_point);
        let guesses: Vec<_> = points.iter().map(guess).collect();
        let state = belief.add(first, &diagonal(9, of_state)).expect("it fits");
        let bias = belief.add(bias, &diagonal(6, of_bias)).expect("it fits");
        let add =
            |point: &Vector3<f64>| belief.add(*point, &diagonal(3, of_point)).expect("it fits");
        let landmarks = guesses.iter().map(add).collect();
        let symmetry = match self.points {
            Points::Moved { turn, .. } => Shifted::new(0.3, -0.2, 0.5, turn),
            _ => Shifted::zeros(),
        };
        // Behind the free directions go all that there are at the beginning.
        let size = belief.dimension();
        let mut free = DMatrix::zeros(size, 4 + size);
        free.columns_mut(4, size).fill_with_identity();
        let moved = draws::moved(&first, &symmetry);
        free.fixed_view_mut::<9, 4>(0, 0).copy_from(&draws::free(&moved));
        for (at, point) in guesses.iter().enumerate() {
            let point = draws::moved_point(point, &symmetry);
            free.fixed_view_mut::<3, 4>(15 + 3 * at, 0).copy_from(&draws::free_of_point(&point));
        }
        belief.follow(free).expect("a row for each coordinate");
        let (first, claimed, seen) = ((first, guesses), Claimed::default(), Vec::new());
        Filter { case: self, eye, belief, state, bias, landmarks, first, symmetry, claimed, seen }
    }
}

impl Filter {
    /// The standard deviations of the errors at the beginning, as a diagonal matrix.
    pub fn start(&self) -> DMatrix<f64> {
        let [of_state, of_bias, of_point] = SIGMAS;
        let sigma = |at: usize, _| match at {
            0..9 => of_state,
            9..15 => of_bias,
            _ => of_point,
        };
        DMatrix::from_diagonal(&DVector::from_fn(self.belief.dimension(), sigma))
    }

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
            let noise = Vector2::from_fn(|_, _| random.normal(1.0));
            let off =
                self.eye.seen(&values[self.state], estimate) - self.eye.seen(truth, &points[at]);
            // What is behind a camera is not seen: its rows stay empty.
            if !(off.sum() + by_landmark.sum()).is_finite() {
                continue;
            }
            residual.fixed_rows_mut::<2>(2 * at).copy_from(&(off / SIGMA - noise));
            rows.fixed_view_mut::<2, 3>(2 * at, 0).copy_from(&by_pose.fixed_columns::<3>(0));
            rows.fixed_view_mut::<2, 3>(2 * at, 6).copy_from(&by_pose.fixed_columns::<3>(3));
            if !is_known {
                rows.fixed_view_mut::<2, 3>(2 * at, 15 + 3 * at).copy_from(&by_landmark);
            }
        }
        let directions = self.belief.directions();
        self.claimed.add(&Claimed::of(&rows, directions));
        self.seen.push(&rows * directions.columns_range(4..));
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
