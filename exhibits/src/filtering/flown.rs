//! Flights of a filter that knows where the landmarks are, or that measures how far it has come.

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, Vector3};
use vislam::factors::BodyPixel;
use vislam::filtering::{
    Belief, BlockNees, Correction, Form, StateError, Transition, attitude_in_world, nees,
};
use vislam::inertial::{BodyPose, GRAVITY, ImuBias, ImuNoise, NavState, between};
use vislam::least_squares::{Key, Manifold};
use vislam::manifold::so3;
use vislam::preintegration::preintegrate_combined;
use vislam::simulation::{Flight, FlightRecording, Trajectory};

use crate::comparison::inverse;
use crate::random::Random;

/// The standard deviations of what is known at the beginning: turns, velocity and position, in rad,
/// m/s and m, and the biases of gyroscope and accelerometer, in rad/s and m/s².
const START: [f64; 15] =
    [0.02, 0.02, 0.02, 0.1, 0.1, 0.1, 0.05, 0.05, 0.05, 5e-3, 5e-3, 5e-3, 0.05, 0.05, 0.05];
pub const PICTURE_RATE: f64 = 10.0;
/// Landmarks that a picture shows, at most.
pub const LANDMARKS: usize = 6;
/// The standard deviation of each coordinate of a measured displacement, in metres.
pub const STEP_SIGMA: f64 = 0.01;

/// What corrects the filter.
#[derive(Clone, Copy, PartialEq)]
pub enum Sensor {
    /// Pixels of landmarks whose places are known, while the light is on.
    Map,
    /// By how much the body has moved since the last picture, in its axes then.
    Displacement,
}

/// A filter, and what may be wrong with it.
#[derive(Clone, Copy)]
pub struct Filter {
    pub sensor: Sensor,
    /// By which factor the noise of the sensor is believed to be larger than it is.
    pub noise: f64,
    /// The same for the densities of the inertial sensor.
    pub density: f64,
    /// Whether an error of the attitude moves velocity and position.
    pub coupled: bool,
    /// Whether a copy of the state knows that it is one.
    pub tied: bool,
    /// From when to when it is dark, in seconds.
    pub dark: [f64; 2],
    /// How often pixels are linearized.
    pub iterations: usize,
}

pub const RIGHT: Filter = Filter {
    sensor: Sensor::Map,
    noise: 1.0,
    density: 1.0,
    coupled: true,
    tied: true,
    dark: [0.0, 0.0],
    iterations: 1,
};

/// What is known of the filter at a picture.
#[derive(Clone, Copy)]
pub struct Moment {
    pub seconds: f64,
    pub nees: BlockNees,
    /// Of all nine numbers of the state.
    pub whole: f64,
    /// Sum of all innovations squared until here, and of their numbers.
    pub innovations: [f64; 2],
    pub error: StateError,
    /// Standard deviations of yaw and of the position along x.
    pub sigmas: [f64; 2],
    /// The covariance of the position.
    pub place: Matrix3<f64>,
    /// What the correction would have to do to the covariance of the attitude, if that were carried to where
    /// the correction led: by which part of itself it changes a standard deviation at most.
    pub reset: f64,
}

/// The flight of the chapter: a figure-eight with a poor sensor.
pub fn flight(seconds: f64) -> Flight {
    let motion = Trajectory::figure_eight();
    Flight {
        seconds,
        picture_rate: PICTURE_RATE,
        tracks: LANDMARKS,
        noise: ImuNoise::mems(),
        ..Flight::new(motion)
    }
}

pub fn recorded(seconds: f64, seed: u64) -> FlightRecording {
    let flight = flight(seconds);
    let room = flight.room(3.0, 300, seed).expect("the flight has a room");
    flight.record(&room, seed).expect("the flight can be flown")
}

/// Flies a filter, and says at every picture how it is.
pub fn flown(filter: &Filter, recording: &FlightRecording, seed: u64) -> Vec<Moment> {
    let mut flown = Flown::new(filter, recording, seed);
    let mut innovations = [0.0; 2];
    let pictures = 1..recording.pictures.len();
    let visit = pictures.map(|picture| {
        flown.carry(picture);
        let before = flown.belief.values()[flown.state];
        let innovation = flown.correct(picture);
        innovations = [innovations[0] + innovation[0], innovations[1] + innovation[1]];
        Moment { innovations, reset: flown.reset(&before), ..flown.moment(picture) }
    });
    visit.collect()
}

struct Flown<'a> {
    filter: &'a Filter,
    recording: &'a FlightRecording,
    belief: Belief,
    state: Key<NavState>,
    bias: Key<ImuBias>,
    random: Random,
}

impl<'a> Flown<'a> {
    fn new(filter: &'a Filter, recording: &'a FlightRecording, seed: u64) -> Self {
        let mut random = Random::new(seed ^ 0x5eed);
        let off = START.map(|sigma| random.normal(sigma));
        let variances = START.map(|sigma| sigma * sigma);
        let diagonal = |of: &[f64]| DMatrix::from_diagonal(&DVector::from_row_slice(of));
        let truth = &recording.truth;
        let mut belief = Belief::new();
        let state = truth.states[0].retract(&off[..9]);
        let state = belief.add(state, &diagonal(&variances[..9])).expect("it fits");
        let bias = truth.biases[0].retract(&off[9..]);
        let bias = belief.add(bias, &diagonal(&variances[9..])).expect("it fits");
        Self { filter, recording, belief, state, bias, random }
    }

    /// Carries the belief to a picture, and keeps a copy of the state before that if it is needed.
    fn carry(&mut self, picture: usize) {
        let Self { filter, recording, .. } = *self;
        let time = |picture: usize| recording.pictures[picture].nanoseconds;
        let (state, bias) = (self.belief.values()[self.state], self.belief.values()[self.bias]);
        if filter.sensor == Sensor::Displacement {
            self.copy(state);
        }
        let readings = between(&recording.readings, time(picture - 1), time(picture))
            .expect("readings cover the flight");
        let mut noise = recording.flight.noise;
        noise.gyro *= filter.density;
        noise.accelerometer *= filter.density;
        let sums = preintegrate_combined(&readings, &bias, &noise).expect("there are readings");
        let mut transition = Transition::new(&sums, &state, &bias, &GRAVITY).expect("finite");
        if !filter.coupled {
            transition.by_error.fixed_view_mut::<6, 3>(3, 0).fill(0.0);
        }
        self.belief.carry_on((self.state, self.bias), &transition).expect("the keys are its own");
    }

    fn copy(&mut self, state: NavState) {
        self.belief.keep(&[0, 1]).expect("both are there");
        if self.filter.tied {
            self.belief.clone_variable(self.state).expect("it is there");
        } else {
            let covariance = self.belief.of(self.state).expect("it is there");
            self.belief.add(state, &covariance).expect("it fits");
        }
    }

    /// Corrects the belief, and again from where it was before with pixels that are linearized where
    /// it came to.
    fn correct(&mut self, picture: usize) -> [f64; 2] {
        let before = self.belief.clone();
        let innovation = self.correct_from(&before, picture);
        for _ in 1..self.filter.iterations {
            self.correct_from(&before, picture);
        }
        innovation
    }

    /// Corrects what was believed before, by measurements that are linearized at what is believed now;
    /// the innovation squared and its dimension.
    fn correct_from(&mut self, before: &Belief, picture: usize) -> [f64; 2] {
        let (jacobian, residual) = match self.filter.sensor {
            Sensor::Map => self.pixels(picture),
            Sensor::Displacement => self.displacement(picture),
        };
        if residual.is_empty() {
            return [0.0, 0.0];
        }
        let (from, to) = (&before.values()[self.state], &self.belief.values()[self.state]);
        let mut gone = DVector::zeros(jacobian.ncols());
        from.local(to, &mut gone.as_mut_slice()[..9]);
        let mut by_step = SMatrix::<f64, 9, 9>::zeros();
        from.local_jacobian(to, by_step.as_mut_slice());
        let mut jacobian = jacobian;
        let own = jacobian.columns(0, 9) * inverse(by_step);
        jacobian.columns_mut(0, 9).copy_from(&own);
        let residual = residual - &jacobian * gone;
        self.belief = before.clone();
        let scale = self.filter.noise.recip();
        let corrected =
            self.belief.correct(&(scale * jacobian), &(scale * &residual), Form::Joseph);
        let Correction { innovation, .. } = corrected.expect("a covariance");
        [innovation, residual.len() as f64]
    }

    /// Two rows for each landmark that the picture shows.
    fn pixels(&self, picture: usize) -> (DMatrix<f64>, DVector<f64>) {
        let Self { filter, recording, .. } = self;
        let truth = &recording.truth;
        let seconds = picture as f64 / PICTURE_RATE;
        let [from, to] = filter.dark;
        let is_dark = (from..to).contains(&seconds);
        let features = recording.pictures[picture].features.iter().filter(|_| !is_dark);
        let body = BodyPose::from(&self.belief.values()[self.state]);
        let camera = &recording.flight.camera;
        let extrinsics = recording.flight.rig.body_from_camera;
        let rows = features.filter_map(|feature| {
            let landmark = truth.landmarks[truth.landmark_of_track[feature.track]];
            let inverse_sigma = 1.0 / recording.flight.pixel_sigma;
            let seen = BodyPixel { camera, pixel: feature.pixel, inverse_sigma };
            let (residual, (by_body, ..)) = seen.linearize((&body, &landmark, &extrinsics))?;
            Some((residual, by_body))
        });
        let rows: Vec<_> = rows.collect();
        let mut jacobian = DMatrix::zeros(2 * rows.len(), self.belief.dimension());
        let mut residual = DVector::zeros(2 * rows.len());
        for (at, (own, by_body)) in rows.iter().enumerate() {
            let (by_turn, by_shift) =
                (by_body.fixed_columns::<3>(0), by_body.fixed_columns::<3>(3));
            jacobian.fixed_view_mut::<2, 3>(2 * at, 0).copy_from(&by_turn);
            jacobian.fixed_view_mut::<2, 3>(2 * at, 6).copy_from(&by_shift);
            residual.fixed_rows_mut::<2>(2 * at).copy_from(own);
        }
        (jacobian, residual)
    }

    /// Three rows: where the body is now, in the axes of the copy.
    fn displacement(&mut self, picture: usize) -> (DMatrix<f64>, DVector<f64>) {
        let in_first = |first: &NavState, now: &NavState| {
            first.world_from_body.inverse() * (now.position - first.position)
        };
        let truth = &self.recording.truth.states;
        let noise = Vector3::from_fn(|_, _| self.random.normal(STEP_SIGMA));
        let measured = in_first(&truth[picture - 1], &truth[picture]) + noise;
        let states = self.belief.values().of_kind::<NavState>();
        let (now, first) = (states[0], states[1]);
        let predicted = in_first(&first, &now);
        let to_first = first.world_from_body.matrix().transpose();
        let mut jacobian = SMatrix::<f64, 3, 24>::zeros();
        jacobian.fixed_view_mut::<3, 3>(0, 6).copy_from(&to_first);
        jacobian.fixed_view_mut::<3, 3>(0, 15).copy_from(&so3::hat(&predicted));
        jacobian.fixed_view_mut::<3, 3>(0, 21).copy_from(&-to_first);
        let jacobian = jacobian / STEP_SIGMA;
        let residual = (predicted - measured) / STEP_SIGMA;
        (
            DMatrix::from_column_slice(3, 24, jacobian.as_slice()),
            DVector::from_column_slice(residual.as_slice()),
        )
    }

    /// What carrying the covariance from a state to the one that is believed now changes at most.
    fn reset(&self, from: &NavState) -> f64 {
        let to = &self.belief.values()[self.state];
        let turned = so3::local(&from.world_from_body, &to.world_from_body);
        let by_step = inverse(so3::right_jacobian_inverse(&turned));
        let own: Matrix3<f64> = self.belief.covariance().fixed_view::<3, 3>(0, 0).into_owned();
        let root = own.cholesky().expect("a covariance").l();
        let relative = inverse(root) * by_step * root;
        let parts = (relative * relative.transpose()).symmetric_eigenvalues();
        parts.iter().map(|part| (part.sqrt() - 1.0).abs()).fold(0.0, f64::max)
    }

    fn moment(&self, picture: usize) -> Moment {
        let truth = &self.recording.truth.states[picture];
        let estimate = &self.belief.values()[self.state];
        let covariance = self.belief.covariance().fixed_view::<9, 9>(0, 0).into_owned();
        let mut error = SMatrix::<f64, 9, 1>::zeros();
        estimate.local(truth, error.as_mut_slice());
        let turn = attitude_in_world(estimate, &covariance.fixed_view::<3, 3>(0, 0));
        Moment {
            seconds: picture as f64 / PICTURE_RATE,
            nees: BlockNees::of(estimate, truth, &covariance).expect("a covariance"),
            whole: nees(&error, &covariance).expect("a covariance"),
            innovations: [0.0; 2],
            error: StateError::between(estimate, truth),
            place: covariance.fixed_view::<3, 3>(6, 6).into_owned(),
            sigmas: [turn[(2, 2)].sqrt(), covariance[(6, 6)].sqrt()],
            reset: 0.0,
        }
    }
}
