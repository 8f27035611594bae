//! The gyroscope's bias from turns that the pictures know.

use nalgebra::{Matrix3, Rotation3, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::manifold::so3;
use vislam::preintegration::{linearize, preintegrate};
use vislam::simulation::Trajectory;

use super::exact::anywhere_in;
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences, inverse};
use crate::random::Random;

const FLIGHTS: usize = 60;
/// Intervals between pictures, readings in each, and seconds between these.
const INTERVALS: usize = 6;
const READINGS: usize = 40;
const STEP: f64 = 0.005;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Step); 4] = [
        ("sign", |turns| -step(turns)),
        ("Jacobian transposed", |turns| {
            step(&turns.iter().map(|(j, r)| (j.transpose(), *r)).collect::<Vec<_>>())
        }),
        ("mean of all", |turns| step(turns) / turns.len() as f64),
        ("turned by the interval's length alone", |turns| {
            let seconds = READINGS as f64 * STEP;
            turns.iter().map(|(_, r)| r / seconds).sum::<Vector3<f64>>() / turns.len() as f64
        }),
    ];
    chapter.equation("gyro-step", gyro_step, step, &mutants);
}

/// Takes the derivative of each turn's residual by the bias, and the residual.
type Step = fn(&[(Matrix3<f64>, Vector3<f64>)]) -> Vector3<f64>;

fn step(turns: &[(Matrix3<f64>, Vector3<f64>)]) -> Vector3<f64> {
    let hessian: Matrix3<f64> = turns.iter().map(|(j, _)| j.transpose() * j).sum();
    let gradient: Vector3<f64> = turns.iter().map(|(j, r)| j.transpose() * r).sum();
    -inverse(hessian) * gradient
}

/// Readings of some intervals, and how the pictures have the body turned at their ends.
struct Turned {
    readings: Vec<Vec<ImuSample>>,
    rotations: Vec<Rotation3<f64>>,
}

impl Turned {
    fn drawn(random: &mut Random) -> Self {
        let motion = anywhere_in(Trajectory::figure_eight(), random);
        let bias = ImuBias { gyro: random.direction(0.05), accelerometer: random.direction(0.1) };
        let length = READINGS as f64 * STEP;
        let interval = |k: usize| {
            let reading = |i: usize| {
                let t = k as f64 * length + (i as f64 + 0.5) * STEP;
                motion.at(t).sample(&GRAVITY).biased(&bias)
            };
            (0..READINGS).map(reading).collect()
        };
        let mut seen = |k: usize| {
            let truth = motion.at(k as f64 * length).state.world_from_body;
            truth * Rotation3::new(random.direction(2e-3))
        };
        Self {
            rotations: (0..=INTERVALS).map(&mut seen).collect(),
            readings: (0..INTERVALS).map(interval).collect(),
        }
    }

    /// What readings corrected by a bias turn less than the pictures, interval by interval.
    fn residuals(&self, bias: &Vector3<f64>) -> Vec<Vector3<f64>> {
        let residual = |k: usize| {
            let turn = |of: &ImuSample| so3::exp(&(STEP * (of.gyro - bias)));
            let summed = self.readings[k]
                .iter()
                .map(turn)
                .fold(Rotation3::identity(), |all, turn| all * turn);
            let seen = self.rotations[k].inverse() * self.rotations[k + 1];
            so3::log(&(summed.inverse() * seen))
        };
        (0..INTERVALS).map(residual).collect()
    }

    /// The bias with the least sum of squares of these, by steps along numerical derivatives.
    fn best(&self) -> Vector3<f64> {
        let cost = |bias: &Vector3<f64>| {
            self.residuals(bias).iter().map(|r| r.norm_squared()).sum::<f64>()
        };
        let slope = |bias: &Vector3<f64>| {
            differences(1e-4, |d: Vector3<f64>| nalgebra::Vector1::new(cost(&(bias + d))))
                .transpose()
        };
        let mut bias = Vector3::zeros();
        for _ in 0..10 {
            let curvature = differences(1e-3, |d: Vector3<f64>| slope(&(bias + d)));
            bias -= inverse(curvature) * slope(&bias);
        }
        bias
    }

    /// What the library makes of each interval.
    fn turns(&self, bias: &Vector3<f64>) -> Vec<(Matrix3<f64>, Vector3<f64>)> {
        let bias = ImuBias { gyro: *bias, accelerometer: Vector3::zeros() };
        let turn = |k: usize| {
            let sums = preintegrate(&self.readings[k], STEP, &bias, &ImuNoise::euroc());
            let sums = sums.expect("finite readings");
            let [first, second] = [self.rotations[k], self.rotations[k + 1]]
                .map(|world_from_body| NavState { world_from_body, ..NavState::origin() });
            let linear = linearize(&sums, &first, &second, &Vector3::zeros(), &bias);
            let by_bias = linear.by_bias.fixed_view::<3, 3>(0, 0).into_owned();
            (by_bias, linear.residual.fixed_rows::<3>(0).into_owned())
        };
        (0..INTERVALS).map(turn).collect()
    }
}

fn gyro_step(formula: Step) -> Comparison {
    let against = "the bias with the least squares, by numerical derivatives, less a start near by";
    Comparison::absolute(against, 1e-6, "rad/s").over(FLIGHTS, 32, |random| {
        let turned = Turned::drawn(random);
        let best = turned.best();
        let start = best + random.direction(1e-3);
        (formula(&turned.turns(&start)), best - start)
    })
}
