//! Where the errors of intervals come from.

use nalgebra::{
    DMatrix, DVector, Matrix3, Matrix3x6, Matrix6, Rotation3, SMatrix, Vector3, Vector6,
};
use vislam::datasets::euroc::GroundTruth;
use vislam::inertial::{GRAVITY, ImuBias, StampedSample};
use vislam::manifold::so3;
use vislam::preintegration::{Deltas, Rule};

use super::intervals::{Flight, Interval, LENGTHS, sizes};
use super::wander::{Wander, correlation};
use crate::preintegration::oracle::parts;

/// Seconds from one state to the next where the ground truth is followed closely.
const PIECE: f64 = 0.05;

/// Times over which wander is fitted, in pieces.
const LAGS: [usize; 7] = [1, 2, 4, 10, 20, 40, 100];

/// Gravity as a flight shows it: what its velocities gain in a second beyond what the readings and
/// [`GRAVITY`] say, on average; and the standard deviation of that mean.
pub fn gravity_found(flight: &Flight) -> (Vector3<f64>, Vector3<f64>) {
    let missing = flight.intervals(Rule::Midpoint, 1.0, 0.0).into_iter().map(|interval| {
        let [_, velocity, _] = parts(&interval.residual(&GRAVITY));
        interval.first.state.world_from_body * velocity / interval.sums.duration
    });
    let missing: Vec<Vector3<f64>> = missing.collect();
    let count = missing.len() as f64;
    let mean = missing.iter().sum::<Vector3<f64>>() / count;
    let squares: Vector3<f64> = missing.iter().map(|m| (m - mean).map(|x| x * x)).sum();
    (GRAVITY + mean, (squares / (count * (count - 1.0))).map(f64::sqrt))
}

/// Gravity and one constant bias of the accelerometer beyond the ground truth's own, both free.
pub struct FreeBias {
    /// Gravity in m/s², in the world.
    pub gravity: Vector3<f64>,
    /// The further bias in m/s², in the body.
    pub bias: Vector3<f64>,
    /// Covariance of gravity and bias, with the noise that the residuals show.
    pub covariance: Matrix6<f64>,
}

impl FreeBias {
    pub fn sigma(&self, index: usize) -> f64 {
        self.covariance[(index, index)].sqrt()
    }

    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        self.covariance[(a, b)] / (self.sigma(a) * self.sigma(b))
    }
}

/// Both as velocities over intervals of a second fit them best, all axes alike.
pub fn gravity_beside_a_bias(flight: &Flight) -> FreeBias {
    let rows = flight.intervals(Rule::Midpoint, 1.0, 0.0).into_iter().map(|interval| {
        let sums = &interval.sums;
        let body_from_world = interval.first.state.world_from_body.inverse();
        let mut design = Matrix3x6::zeros();
        design.fixed_columns_mut::<3>(0).copy_from(&(sums.duration * body_from_world.matrix()));
        let by_bias = sums.bias_jacobian.fixed_view::<3, 3>(3, 3);
        design.fixed_columns_mut::<3>(3).copy_from(&by_bias);
        (design, parts(&interval.residual(&GRAVITY))[1])
    });
    let rows: Vec<(Matrix3x6<f64>, Vector3<f64>)> = rows.collect();
    let information: Matrix6<f64> = rows.iter().map(|(d, _)| d.transpose() * d).sum();
    let moments: Vector6<f64> = rows.iter().map(|(d, r)| d.transpose() * r).sum();
    let inverse = information.try_inverse().expect("a body that turns");
    let found = inverse * moments;
    let squares: f64 = rows.iter().map(|(d, r)| (r - d * found).norm_squared()).sum();
    FreeBias {
        gravity: GRAVITY + found.fixed_rows::<3>(0),
        bias: found.fixed_rows::<3>(3).into_owned(),
        covariance: squares / (3 * rows.len() - 6) as f64 * inverse,
    }
}

/// The mean angle between the vertical and the direction of the body that points up on average, in
/// radians.
pub fn lean(flight: &Flight) -> f64 {
    let up = |truth: &GroundTruth| truth.state.world_from_body.inverse() * Vector3::z();
    let mean = flight.truth.iter().map(up).sum::<Vector3<f64>>();
    flight.truth.iter().map(|truth| up(truth).angle(&mean)).sum::<f64>() / flight.truth.len() as f64
}

/// The flight in pieces between neighbouring states: errors of attitude and velocity, summed up.
pub struct Pieces {
    pub pieces: Vec<Interval>,
    /// What the gyroscope says of the rotation since the first piece.
    turned: Vec<Rotation3<f64>>,
    /// What velocities gain, in the world, beyond the readings turned by the ground truth's own
    /// attitude; and the same for positions.
    velocity: Vec<Vector3<f64>>,
    position: Vec<Vector3<f64>>,
}

impl Pieces {
    pub fn new(flight: &Flight, gravity: &Vector3<f64>) -> Self {
        let pieces = flight.intervals(Rule::Midpoint, PIECE, 0.0);
        let mut turned = vec![Rotation3::identity()];
        let (mut velocity, mut position) = (vec![Vector3::zeros()], vec![Vector3::zeros()]);
        for (k, Interval { first, last, sums }) in pieces.iter().enumerate() {
            let (t, start) = (sums.duration, &first.state);
            let force = |delta: &Vector3<f64>| start.world_from_body * delta;
            let gained =
                last.state.velocity - start.velocity - t * gravity - force(&sums.deltas.velocity);
            let moved = last.state.position
                - start.position
                - t * start.velocity
                - 0.5 * t * t * gravity
                - force(&sums.deltas.position);
            turned.push(turned[k] * sums.deltas.rotation);
            position.push(position[k] + moved + t * velocity[k]);
            velocity.push(velocity[k] + gained);
        }
        Self { pieces, turned, velocity, position }
    }

    /// How far the attitude's change over pieces from `a` to `b` is from the gyroscope's.
    fn attitude(&self, a: usize, b: usize) -> Vector3<f64> {
        let said = self.turned[a].inverse() * self.turned[b];
        let (first, last) = (&self.pieces[a].first.state, &self.pieces[b - 1].last.state);
        so3::local(&said, &(first.world_from_body.inverse() * last.world_from_body))
    }

    fn velocity(&self, a: usize, b: usize) -> Vector3<f64> {
        self.velocity[b] - self.velocity[a]
    }

    fn position(&self, a: usize, b: usize, seconds: f64) -> Vector3<f64> {
        self.position[b] - self.position[a] - seconds * self.velocity[a]
    }

    /// Mean square over all stretches of so many pieces.
    fn mean_square(&self, lag: usize, of: impl Fn(usize, usize) -> Vector3<f64>) -> f64 {
        let count = self.pieces.len() + 1 - lag;
        (0..count).map(|a| of(a, a + lag).norm_squared()).sum::<f64>() / count as f64
    }

    /// The error of attitude over a time, in radians.
    pub fn attitude_after(&self, seconds: f64) -> f64 {
        let lag = (seconds / PIECE).round() as usize;
        self.mean_square(lag, |a, b| self.attitude(a, b)).sqrt()
    }

    /// Of attitude and of velocity.
    pub fn wanders(&self) -> [Wander; 2] {
        let attitude = LAGS.map(|lag| self.mean_square(lag, |a, b| self.attitude(a, b)));
        let velocity = LAGS.map(|lag| self.mean_square(lag, |a, b| self.velocity(a, b)));
        let times = LAGS.map(|lag| PIECE * lag as f64);
        [attitude, velocity].map(|squares| Wander::fitted(&times, &squares))
    }

    /// The correlation of the attitude's errors in neighbouring pieces.
    pub fn step_correlation(&self) -> f64 {
        let errors: Vec<_> = (0..self.pieces.len()).map(|a| self.attitude(a, a + 1)).collect();
        let with_next: f64 = errors.windows(2).map(|w| w[0].dot(&w[1])).sum();
        with_next / errors.iter().map(|error| error.norm_squared()).sum::<f64>()
    }

    /// Errors of velocity and position over intervals of a length when the ground truth's own
    /// attitude turns the forces, in m/s and metres.
    pub fn without_attitude(&self, seconds: f64) -> [f64; 2] {
        let lag = (seconds / PIECE).round() as usize;
        let velocity = self.mean_square(lag, |a, b| self.velocity(a, b));
        let position = self.mean_square(lag, |a, b| self.position(a, b, seconds));
        [velocity.sqrt(), position.sqrt()]
    }
}

/// What errors of velocity and of position are made of for each length, as differences of mean
/// squares: the shares of a gravity that does not point along the world's z axis, of an attitude that
/// departs from the ground truth's, and what is left when it does not.
pub fn shares(flight: &Flight, gravity: &Vector3<f64>, pieces: &Pieces) -> [[[f64; 3]; 2]; 4] {
    let share = |all: f64, without: f64| (all * all - without * without).max(0.0).sqrt();
    LENGTHS.map(|seconds| {
        let intervals = flight.intervals(Rule::Midpoint, seconds, 0.0);
        let [seen, level] = [&GRAVITY, gravity].map(|gravity| sizes(&intervals, gravity));
        let rest = pieces.without_attitude(seconds);
        [(1, rest[0]), (2, rest[1])]
            .map(|(part, rest)| [share(seen[part], level[part]), share(level[part], rest), rest])
    })
}

/// The offset of the clocks in seconds at which errors of attitude are smallest, and how large
/// they are there.
pub fn best_offset(flight: &Flight, seconds: f64) -> (f64, f64) {
    let errors = (-32..=32).map(|k| {
        let offset = 2.5e-4 * f64::from(k);
        (offset, sizes(&flight.intervals(Rule::Midpoint, seconds, offset), &GRAVITY)[0])
    });
    errors.min_by(|a, b| a.1.total_cmp(&b.1)).expect("offsets")
}

/// How many numbers a gyroscope is given to explain errors of attitude: a bias, a matrix of scales
/// and misalignments, and a matrix by which forces act on it.
pub const GYRO_NUMBERS: usize = 21;

/// By what share the mean square error of attitude over a second shrinks when those numbers are
/// fitted, and by what share it would shrink by chance.
pub fn explained_by_the_gyroscope(flight: &Flight) -> (f64, f64) {
    let residuals = |samples: Vec<StampedSample>| -> DVector<f64> {
        let flight = Flight { samples, truth: flight.truth.clone() };
        let intervals = flight.intervals(Rule::Midpoint, 1.0, 0.0);
        let errors = intervals.iter().map(|interval| interval.residual(&GRAVITY));
        DVector::from_vec(errors.flat_map(|error| [error[0], error[1], error[2]]).collect())
    };
    let seen = residuals(flight.samples.clone());
    let size = 1e-4;
    let columns = (0..GYRO_NUMBERS).map(|number| {
        let mut samples = flight.samples.clone();
        for StampedSample { sample, .. } in &mut samples {
            let by = match number {
                0..3 => 1.0,
                3..12 => sample.gyro[(number / 3) % 3],
                _ => sample.accelerometer[(number / 3) % 3],
            };
            sample.gyro[number % 3] += size * by;
        }
        (residuals(samples) - &seen) / size
    });
    let design = DMatrix::from_columns(&columns.collect::<Vec<_>>());
    let fitted = design.clone().svd(true, true).solve(&seen, 1e-12).expect("both factors");
    let left = &seen - design * fitted;
    let share = 1.0 - left.norm_squared() / seen.norm_squared();
    (share, GYRO_NUMBERS as f64 / seen.len() as f64)
}

/// The densities that readings would have if what is beyond a straight line through three of them
/// were white noise, over readings `from` to `to`: the root mean square of the axes.
pub fn roughness(samples: &[StampedSample], from: usize, to: usize) -> [f64; 2] {
    let of = |read: fn(&StampedSample) -> Vector3<f64>| {
        let bends =
            samples[from..to].windows(3).map(|w| read(&w[2]) - 2.0 * read(&w[1]) + read(&w[0]));
        let square: f64 = bends.map(|bend| bend.norm_squared()).sum();
        (square / (18.0 * (to - from - 2) as f64) * 0.005).sqrt()
    };
    [of(|s| s.sample.gyro), of(|s| s.sample.accelerometer)]
}

/// The flight with the mean of the biases in the place of those at each time.
pub fn with_steady_bias(flight: &Flight) -> Flight {
    let biases = flight.truth.iter().map(|truth| truth.bias.vector());
    let mean = ImuBias::from_vector(&(biases.sum::<Vector6<f64>>() / flight.truth.len() as f64));
    let mut truth = flight.truth.clone();
    truth.iter_mut().for_each(|state| state.bias = mean);
    Flight { samples: flight.samples.clone(), truth }
}

/// How errors of the ground truth enter a residual: those of the attitude at both ends, and by how
/// much the error of velocity and the position gain in the interval. All of them are seen from the
/// first body frame.
pub type FromTruth = SMatrix<f64, 9, 12>;

pub fn from_truth(deltas: &Deltas) -> FromTruth {
    let mut matrix = FromTruth::zeros();
    let mut put = |row, column, block: &Matrix3<f64>| {
        matrix.fixed_view_mut::<3, 3>(row, column).copy_from(block);
    };
    let last_from_first = deltas.rotation.matrix().transpose();
    put(0, 0, &-last_from_first);
    put(0, 3, &last_from_first);
    put(3, 0, &so3::hat(&deltas.velocity));
    put(3, 6, &Matrix3::identity());
    put(6, 0, &so3::hat(&deltas.position));
    put(6, 9, &Matrix3::identity());
    matrix
}

/// The covariance of those errors after `t` seconds.
pub fn truth_covariance(attitude: &Wander, velocity: &Wander, t: f64) -> SMatrix<f64, 12, 12> {
    let mut covariance = SMatrix::<f64, 12, 12>::zeros();
    let mut put = |row: usize, column: usize, value: f64| {
        for axis in 0..3 {
            covariance[(3 * row + axis, 3 * column + axis)] = value;
            covariance[(3 * column + axis, 3 * row + axis)] = value;
        }
    };
    let square = attitude.sigma.powi(2);
    put(0, 0, square);
    put(1, 1, square);
    put(0, 1, square * correlation(attitude.tau, t));
    // The gain of velocity since the beginning is g(s); the position has gained its integral.
    let square = velocity.sigma.powi(2);
    let rho = |t: f64| correlation(velocity.tau, t);
    let gains = |s: f64, u: f64| square * (rho((s - u).abs()) - rho(s) - rho(u) + 1.0);
    let count = 60;
    let nodes = || (0..count).map(|k| t * (f64::from(k) + 0.5) / f64::from(count));
    let weight = t / f64::from(count);
    put(2, 2, gains(t, t));
    put(2, 3, nodes().map(|s| weight * gains(s, t)).sum());
    let both = nodes().flat_map(|s| nodes().map(move |u| (s, u)));
    put(3, 3, both.map(|(s, u)| weight * weight * gains(s, u)).sum());
    covariance
}

/// The mean of the normalized error squared when the ground truth errs as well.
pub fn normalized_with_truth(
    intervals: &[Interval],
    gravity: &Vector3<f64>,
    attitude: &Wander,
    velocity: &Wander,
) -> f64 {
    let each = intervals.iter().map(|interval| {
        let of_truth = truth_covariance(attitude, velocity, interval.sums.duration);
        let enters = from_truth(&interval.sums.deltas);
        let covariance = interval.sums.covariance + enters * of_truth * enters.transpose();
        let residual = interval.residual(gravity);
        let solved = covariance.cholesky().expect("a covariance").solve(&residual);
        residual.dot(&solved)
    });
    each.sum::<f64>() / intervals.len() as f64
}
