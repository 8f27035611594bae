//! From one picture to the next: how readings carry a belief on.

use nalgebra::{DMatrix, DVector, SMatrix, Vector3};
use vislam::filtering::Transition;
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::least_squares::Manifold;
use vislam::preintegration::{CombinedPreintegrated, CombinedPreintegrator, Matrix15, linearize};

use super::draws;
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered, differences};
use crate::random::Random;

const STATES: usize = 20;
const STEP: f64 = 0.02;
const NOISE: ImuNoise =
    ImuNoise { gyro: 3e-3, accelerometer: 2e-2, gyro_walk: 2e-2, accelerometer_walk: 0.1 };

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Block = |interval| interval.transition().by_error;
    let mutants: [(_, Block); 4] = [
        ("sign of the first state", |interval| {
            altered(interval.transition().by_error, |by| {
                by.fixed_view_mut::<9, 9>(0, 0).neg_mut();
            })
        }),
        ("not solved for the second state", |interval| {
            let by_first = -interval.linear().by_first;
            altered(interval.transition().by_error, |by| {
                by.fixed_view_mut::<9, 9>(0, 0).copy_from(&by_first);
            })
        }),
        ("bias dropped", |interval| {
            altered(interval.transition().by_error, |by| by.fixed_view_mut::<9, 6>(0, 9).fill(0.0))
        }),
        ("transposed", |interval| interval.transition().by_error.transpose()),
    ];
    chapter.equation("transition", transition, formula, &mutants);

    let formula: Block = |interval| interval.transition().noise;
    let mutants: [(_, Block); 3] = [
        ("not solved for the second state", |interval| interval.readings.covariance()),
        ("inverse transposed", |interval| {
            let by_second = interval.linear().by_second.transpose();
            let inverse = crate::comparison::inverse(by_second);
            let mut whole = Matrix15::identity();
            whole.fixed_view_mut::<9, 9>(0, 0).copy_from(&inverse);
            whole * interval.readings.covariance() * whole.transpose()
        }),
        ("walk independent of the state", |interval| {
            altered(interval.transition().noise, |noise| {
                noise.fixed_view_mut::<9, 6>(0, 9).fill(0.0);
                noise.fixed_view_mut::<6, 9>(9, 0).fill(0.0);
            })
        }),
    ];
    chapter.equation("transition-noise", transition_noise, formula, &mutants);

    let formula: Carried = |before, by_error, noise| {
        let (mut belief, keys) = draws::believed(before);
        let (by_error, noise) = (fixed(by_error), fixed(noise));
        let transition = Transition { state: NavState::origin(), by_error, noise };
        belief.carry_on(keys, &transition).expect("the keys are its own");
        belief.covariance().clone()
    };
    let mutants: [(_, Carried); 4] = [
        ("transition transposed", |p, by, noise| whole(p, &by.transpose(), noise)),
        ("noise dropped", |p, by, noise| whole(p, by, &(0.0 * noise))),
        ("noise subtracted", |p, by, noise| whole(p, by, &-noise)),
        ("others left as they are", |p, by, noise| {
            altered(whole(p, by, noise), |after| {
                after.view_mut((0, 15), (15, 3)).copy_from(&p.view((0, 15), (15, 3)));
                after.view_mut((15, 0), (3, 15)).copy_from(&p.view((15, 0), (3, 15)));
            })
        }),
    ];
    chapter.equation("carried-covariance", carried_covariance, formula, &mutants);
}

/// Readings of an interval, and where it begins.
struct Interval {
    samples: Vec<ImuSample>,
    readings: CombinedPreintegrated,
    state: NavState,
    bias: ImuBias,
}

impl Interval {
    fn random(random: &mut Random) -> Self {
        let bias = ImuBias { gyro: random.direction(0.05), accelerometer: random.direction(0.2) };
        let sample = |_| ImuSample {
            gyro: random.direction(1.5),
            accelerometer: random.direction(3.0) - GRAVITY,
        };
        let samples: Vec<ImuSample> = (0..10).map(sample).collect();
        let mut sums = CombinedPreintegrator::new(&bias, &NOISE).expect("the bias is finite");
        for sample in &samples {
            sums.integrate(sample, STEP).expect("the readings are finite");
        }
        let readings = sums.finish().expect("there are readings");
        Self { samples, readings, state: draws::state(random), bias }
    }

    fn transition(&self) -> Transition {
        Transition::new(&self.readings, &self.state, &self.bias, &GRAVITY).expect("it is finite")
    }

    fn linear(&self) -> vislam::preintegration::LinearizedImu {
        let second = self.transition().state;
        linearize(&self.readings.sums, &self.state, &second, &GRAVITY, &self.bias)
    }

    /// State and bias at the end when every reading and every step of the bias has a noise of its
    /// own, reading after reading: the step from where they would be without.
    fn moved(&self, noise: &[f64]) -> SMatrix<f64, 15, 1> {
        let (mut state, mut bias) = (self.state, self.bias);
        for (sample, noise) in self.samples.iter().zip(noise.chunks(12)) {
            let own = bias.retract(&noise[..6]);
            state = state.propagate(&sample.corrected(&own), &GRAVITY, STEP);
            bias = bias.retract(&noise[6..]);
        }
        let mut error = SMatrix::<f64, 15, 1>::zeros();
        self.transition().state.local(&state, &mut error.as_mut_slice()[..9]);
        self.bias.local(&bias, &mut error.as_mut_slice()[9..]);
        error
    }
}

type Block = fn(&Interval) -> Matrix15;

fn transition(formula: Block) -> Comparison {
    let against = "central differences of the predicted state";
    Comparison::relative(against, 1e-7).over(STATES, 1, |random| {
        let interval = Interval::random(random);
        let Interval { readings, state, bias, .. } = &interval;
        let at = interval.transition().state;
        let oracle = differences(1e-5, |step: SMatrix<f64, 15, 1>| {
            let bias = bias.retract(&step.as_slice()[9..]);
            let first = state.retract(&step.as_slice()[..9]);
            let second = readings.sums.predict(&first, &GRAVITY, &bias);
            let mut error = step;
            at.local(&second, &mut error.as_mut_slice()[..9]);
            error
        });
        (formula(&interval), oracle)
    })
}

fn transition_noise(formula: Block) -> Comparison {
    let against = "differences by the noise of each reading, step by step";
    Comparison::relative(against, 1e-5).over(STATES, 2, |random| {
        let interval = Interval::random(random);
        let (white, walk) = (NOISE.discrete(STEP), NOISE.bias_walk(STEP));
        let variances =
            white.diagonal().iter().chain(&walk.diagonal()).copied().collect::<Vec<_>>();
        let mut oracle = Matrix15::zeros();
        let mut noise = vec![0.0; 12 * interval.samples.len()];
        for place in 0..noise.len() {
            let step = 1e-4;
            noise[place] = step;
            let ahead = interval.moved(&noise);
            noise[place] = -step;
            let slope = (ahead - interval.moved(&noise)) / (2.0 * step);
            noise[place] = 0.0;
            oracle += variances[place % 12] * slope * slope.transpose();
        }
        // In the standard deviations of the oracle, so that every unit counts.
        let sigmas = oracle.diagonal().map(|variance| variance.sqrt().recip());
        let scale = |matrix: Matrix15| {
            Matrix15::from_fn(|row, column| sigmas[row] * matrix[(row, column)] * sigmas[column])
        };
        (scale(formula(&interval)), scale(oracle))
    })
}

type Carried = fn(&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>) -> DMatrix<f64>;

fn fixed(matrix: &DMatrix<f64>) -> Matrix15 {
    Matrix15::from_fn(|row, column| matrix[(row, column)])
}

/// By products of whole matrices.
fn whole(before: &DMatrix<f64>, by_error: &DMatrix<f64>, noise: &DMatrix<f64>) -> DMatrix<f64> {
    let mut transition = DMatrix::identity(18, 18);
    transition.view_mut((0, 0), (15, 15)).copy_from(by_error);
    let mut after = &transition * before * transition.transpose();
    let mut own = after.view_mut((0, 0), (15, 15));
    own += noise;
    after
}

fn carried_covariance(formula: Carried) -> Comparison {
    let against = "the scatter of errors that are moved one by one";
    Comparison::relative(against, 1e-10).over(STATES, 3, |random| {
        let (before, noise) = (draws::covariance(random, 18), draws::covariance(random, 15));
        let by_error = draws::matrix(random, 15, 15);
        let noises = draws::ensemble(&noise);
        let moved = draws::ensemble(&before).into_iter().flat_map(|error| {
            let (state, other) = (error.rows(0, 15) * 1.0, error.rows(15, 3).into_owned());
            let carried = &by_error * state;
            noises
                .iter()
                .map(move |noise| {
                    let mut after = DVector::zeros(18);
                    after.rows_mut(0, 15).copy_from(&(&carried + noise));
                    after.rows_mut(15, 3).copy_from(&other);
                    after
                })
                .collect::<Vec<_>>()
        });
        (formula(&before, &by_error, &noise), draws::scatter(moved))
    })
}

/// A second of readings at rest: the transition, for the numbers of the text.
pub fn second_at_rest(noise: &ImuNoise) -> Transition {
    let mut sums = CombinedPreintegrator::new(&ImuBias::default(), noise).expect("no bias");
    for _ in 0..200 {
        let sample = ImuSample { gyro: Vector3::zeros(), accelerometer: -GRAVITY };
        sums.integrate(&sample, 0.005).expect("the readings are finite");
    }
    let sums = sums.finish().expect("there are readings");
    Transition::new(&sums, &NavState::origin(), &ImuBias::default(), &GRAVITY).expect("finite")
}
