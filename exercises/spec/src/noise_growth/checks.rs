//! What is asked about an answer, and on which instances.

use std::f64::consts::LN_10;

use nalgebra::{DMatrix, DVector, Matrix3, Matrix6, Rotation3, Vector3, Vector6};
use vislam::inertial::{GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::manifold::so3;
use vislam::preintegration::{Deltas, Preintegrated, preintegrate};

use super::*;
use crate::Exercise;
use crate::answer::{Spoiled, Transport};
use crate::check::{Check, Failure, compare, compare_number, readable, show_list};
use crate::draw::Draw;

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "noise_growth",
    title: "Covariance of preintegration",
    chapter: "preintegration_noise",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Densities", "Exponents", "Reading", "Source"],
    forbidden: &["observability", "preintegration", "simulation"],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    UNTRANSPOSED_BLOCK, "untransposed_block":
        "A block turns the errors the wrong way round. They were seen from the body at the \
         beginning of the step and are to be seen from the body at its end: which of exp(ω dt) \
         and its transpose takes coordinates of the first of these frames to the second?";
    VELOCITY_NOT_TURNED, "velocity_not_turned":
        "The velocity's rows still stand in the frame that the body \
         had at the beginning of the step. From which frame is ν seen after it?";
    LEAK_SIGN, "leak_sign":
        "The block by which attitude leaks into velocity has the wrong sign. The force comes out as \
         exp(φ) f, which is f + φ × f to first order: which matrix times φ is φ × f?";
    ROTATION_TOO_EARLY, "rotation_too_early":
        "The force of this step was turned by the rotation after the step. In the sums, how is the \
         body turned when it feels the force, and which of the two lines comes first?";
    LEAK_NOT_TURNED, "leak_not_turned":
        "The block by which attitude leaks into velocity is the only one that is not turned. It is \
         −dt f^ as the body felt the force at the beginning of the step, and ν is seen from the body \
         at its end: what do the blocks beside it have in front?";
    LEAK_WITHOUT_STEP, "leak_without_step":
        "The block by which attitude leaks into velocity has no dt: it is an acceleration. For how \
         long does a force that is turned wrongly act?";
    RIGHT_JACOBIAN_FORGOTTEN, "right_jacobian_forgotten":
        "The gyroscope's noise enters the attitude as if the step did not turn. It is added to ω \
         inside of exp, and ω dt is not small here: by which matrix does such a sum become a \
         product of two rotations, with the small one on the right?";
    LEFT_JACOBIAN, "left_jacobian":
        "The gyroscope's noise enters by the left Jacobian, which puts the small rotation on the \
         left of the step. On which side is it in ΔR exp(φ)? The tests of the covariance cannot \
         see this: J Jᵀ is the same for both.";
    DIFFERENCED, "differenced":
        "This agrees with the derivatives, but not to their last digits: it was differenced. Derivatives \
         are asked for. Which matrix takes what the body saw before the step to what it sees after it, and \
         what does such a matrix have that a quotient of differences has only nearly?";
    SQUARED_STEP, "squared_step":
        "The leak from attitude into velocity grows with the square of dt. A force that is turned \
         wrongly acts for dt seconds: how much velocity is that?";
    DENSITY_PER_SAMPLE, "density_per_sample":
        "What a step adds grows with dt² here: the density was taken for the standard deviation of \
         one reading. Cut the same second into twice as many steps: what would the sum say, and \
         what should it say?";
    DENSITY_TIMES_STEP, "density_times_step":
        "The variance of a reading is σ² times dt here. A reading that stands for a shorter time \
         averages over less: is it more certain for that, or less?";
    ONE_DENSITY, "one_density":
        "Both sensors have the same density here. Which of the two numbers of `densities` belongs to \
         the first three of the six noises, and which to the last three?";
    TRANSPOSED_PROPAGATION, "transposed_propagation":
        "The covariance before the step stands between the transpose of F and F. If x becomes F x, \
         what becomes of the mean of x xᵀ?";
    REVERSED_READINGS, "reversed_readings":
        "This is the covariance of the same readings from the last to the first. From which body \
         frame are the errors seen at the end, and which reading leads to it?";
    FIRST_READING_REUSED, "first_reading_reused":
        "This is the covariance of as many steps with the first reading, over and over. Which reading \
         does each step take?";
    NOISE_AS_BIAS, "noise_as_bias":
        "These are the exponents of an error that is the same in every reading, a bias. Noise is \
         drawn anew for every reading: how does the sum of n independent errors grow with n?";
    VARIANCE_FOR_SIGMA, "variance_for_sigma":
        "These are the exponents of the variances. Which power of a variance is a standard \
         deviation?";
    ONE_EXPONENT_FOR_BOTH, "one_exponent_for_both":
        "Velocity and position are each given one exponent, although both sensors are noisy. Two \
         variances add that grow with different powers: what does the slope on logarithmic axes do \
         from short times to long ones?";
    PLAIN_AXES, "plain_axes":
        "This is the slope of σ over t on plain axes, in units of σ per second. On which axes is a \
         power of t a straight line, with the exponent for its slope?";
    MIXED_LOGARITHMS, "mixed_logarithms":
        "One axis has logarithms to the base ten and the other natural ones. What becomes of a \
         slope when only one of its axes is drawn in another unit?";
    ENDS_ONLY, "ends_only":
        "This is the slope between the first point and the last one. What do the points between \
         them say?";
    THROUGH_THE_ORIGIN, "through_the_origin":
        "This is the slope of the best line through the origin. There log t and log σ are both zero, \
         so it takes c for one: which second number does a straight line have, besides its slope?";
}

const ERRORS: [&str; 6] = ["phi x", "phi y", "phi z", "nu x", "nu y", "nu z"];
const NOISES: [&str; 6] = ["gyro x", "gyro y", "gyro z", "acc x", "acc y", "acc z"];

impl Reading {
    fn sample(&self) -> ImuSample {
        ImuSample { gyro: self.gyro, accelerometer: self.force }
    }

    /// The reading with an error, gyroscope first.
    fn off_by(&self, error: &Vector6<f64>) -> Self {
        let (gyro, force) = (error.fixed_rows::<3>(0), error.fixed_rows::<3>(3));
        Self { gyro: self.gyro + gyro, force: self.force + force }
    }

    /// A reading of sizes of the ranges given, in rad/s and m/s².
    pub fn drawn(draw: &mut Draw, gyro: [f64; 2], force: [f64; 2]) -> Self {
        Self { gyro: draw.vector(gyro[0]..gyro[1]), force: draw.vector(force[0]..force[1]) }
    }
}

impl Densities {
    /// Densities that move the attitude about as much as the velocity.
    pub fn drawn(draw: &mut Draw) -> Self {
        Self { gyro: draw.uniform(0.1..0.3), accelerometer: draw.uniform(0.2..0.6) }
    }
}

impl Spoiled for Exponents {
    fn spoiled(number: f64) -> Self {
        Self { attitude: Some(number), velocity: Some(number), position: Some(number) }
    }
}

/// Which rotation turns the force of a step.
#[derive(Clone, Copy, PartialEq)]
enum Turned {
    Before,
    After,
}

/// The sums over readings, as a walk from a state in a world without gravity.
fn walk(start: &NavState, readings: &[Reading], dt: f64, turned: Turned) -> NavState {
    readings.iter().fold(*start, |state, reading| {
        let next = state.propagate(&reading.sample(), &Vector3::zeros(), dt);
        match turned {
            Turned::Before => next,
            Turned::After => NavState {
                velocity: state.velocity + dt * (next.world_from_body * reading.force),
                ..next
            },
        }
    })
}

/// A state whose attitude and velocity are off by (φ, ν).
fn off_by(state: &NavState, error: &Vector6<f64>) -> NavState {
    let (phi, nu) = (error.fixed_rows::<3>(0).into(), error.fixed_rows::<3>(3));
    NavState {
        world_from_body: so3::retract(&state.world_from_body, &phi),
        velocity: state.velocity + state.world_from_body * nu,
        ..*state
    }
}

/// By which (φ, ν) a state is off.
fn error(truth: &NavState, state: &NavState) -> Vector6<f64> {
    let phi = so3::local(&truth.world_from_body, &state.world_from_body);
    let nu = truth.world_from_body.inverse() * (state.velocity - truth.velocity);
    Vector6::new(phi.x, phi.y, phi.z, nu.x, nu.y, nu.z)
}

/// The derivative at zero, by differences of the fourth order.
fn slope(outcome: impl Fn(f64) -> Vector6<f64>) -> Vector6<f64> {
    const H: f64 = 1e-3;
    let near = outcome(H) - outcome(-H);
    let far = outcome(2.0 * H) - outcome(-2.0 * H);
    (8.0 * near - far) / (12.0 * H)
}

/// The derivatives in six directions, side by side.
fn slopes(outcome: impl Fn(&Vector6<f64>) -> Vector6<f64>) -> Matrix6<f64> {
    Matrix6::from_columns(
        &[0, 1, 2, 3, 4, 5].map(|axis| slope(|h| outcome(&(h * Matrix6::identity().column(axis))))),
    )
}

/// One step from sums that were reached already.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// Rotation and velocity of the sums before it.
    pub rotation: Rotation3<f64>,
    /// In m/s.
    pub velocity: Vector3<f64>,
    /// What is read.
    pub reading: Reading,
    /// How long it holds, in seconds.
    pub dt: f64,
}

impl Step {
    /// A step that turns by an angle of the range, in radians.
    pub fn drawn(draw: &mut Draw, angle: [f64; 2], dt: [f64; 2]) -> Self {
        let dt = draw.uniform(dt[0]..dt[1]);
        let reading = Reading::drawn(draw, [angle[0] / dt, angle[1] / dt], [4.0, 15.0]);
        Self { rotation: draw.rotation(0.5..3.0), velocity: draw.vector(1.0..5.0), reading, dt }
    }

    /// A failure with the step.
    fn shown(&self, failure: Failure) -> Failure {
        let Reading { gyro, force } = &self.reading;
        failure.given(&[
            ("reading.gyro", &gyro.as_slice()),
            ("reading.force", &force.as_slice()),
            ("dt", &self.dt),
        ])
    }

    fn start(&self) -> NavState {
        let origin = NavState::origin();
        NavState { world_from_body: self.rotation, velocity: self.velocity, ..origin }
    }

    /// The error after the step.
    fn outcome(&self, before: &Vector6<f64>, noise: &Vector6<f64>, turned: Turned) -> Vector6<f64> {
        let truth = walk(&self.start(), &[self.reading], self.dt, turned);
        let start = off_by(&self.start(), before);
        error(&truth, &walk(&start, &[self.reading.off_by(noise)], self.dt, turned))
    }

    /// F and G.
    fn matrices(&self, turned: Turned) -> [Matrix6<f64>; 2] {
        let none = Vector6::zeros();
        [
            slopes(|before| self.outcome(before, &none, turned)),
            slopes(|noise| self.outcome(&none, noise, turned)),
        ]
    }
}

/// The instances that students have.
fn steps() -> Vec<Step> {
    let mut draw = Draw::new(4);
    (0..20).map(|_| Step::drawn(&mut draw, [0.3, 1.2], [0.1, 0.4])).collect()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("a_step_carries_the_errors_of_the_sums", |answer| {
            steps().iter().try_for_each(|step| carries(answer, step))
        }),
        Check::new("a_step_adds_the_noise_of_its_reading", |answer| {
            let mut draw = Draw::new(5);
            steps().iter().try_for_each(|step| adds(answer, step, &Before::drawn(&mut draw)))
        }),
        Check::new("the_whole_covariance_is_that_of_the_sums", |answer| {
            let mut draw = Draw::new(6);
            (0..5).try_for_each(|_| whole(answer, &Interval::drawn(&mut draw, 8, [0.3, 0.9])))
        }),
        Check::new("exponents_are_those_of_a_sensor_at_rest", |answer| {
            exponents(answer, &Rest { dt: 0.005, noise: ImuNoise::mems() })
        }),
        Check::new("the_fit_is_a_line_on_logarithmic_axes", |answer| {
            let mut draw = Draw::new(7);
            (0..10).try_for_each(|count| fit(answer, &Points::drawn(&mut draw, 2 + count)))
        }),
    ]
}

/// F and G against differences of the sums.
///
/// # Errors
///
/// A failure, which names what the blocks are instead where that is known.
pub fn carries(answer: &dyn Transport, step: &Step) -> Result<(), Failure> {
    let obtained = Answer(answer).error_step(&step.reading, &step.dt)?;
    let [f, g] = step.matrices(Turned::Before);
    let early = step.matrices(Turned::After);
    // Blocks that turn the wrong way, made from those that turn the right way.
    let turn = so3::exp(&(step.dt * step.reading.gyro));
    let [once, twice] = [turn, turn * turn].map(Rotation3::into_inner);
    let rows = |at: usize, matrix: &Matrix6<f64>, by: &Matrix3<f64>| {
        let mut matrix = *matrix;
        let turned = by * matrix.fixed_rows::<3>(at);
        matrix.fixed_rows_mut::<3>(at).copy_from(&turned);
        matrix
    };
    let (turned_f, turned_g) = (rows(3, &rows(0, &f, &twice), &twice), rows(3, &g, &twice));
    let leak = |factor: f64| {
        let mut matrix = f;
        matrix.fixed_view_mut::<3, 3>(3, 0).scale_mut(factor);
        matrix
    };
    let mut leak_alone = f;
    let unturned = once * f.fixed_view::<3, 3>(3, 0);
    leak_alone.fixed_view_mut::<3, 3>(3, 0).copy_from(&unturned);
    compare("the matrix F", &obtained.0, &f)
        .within(1e-7)
        .labelled(&ERRORS, &ERRORS)
        .or(&UNTRANSPOSED_BLOCK, &turned_f)
        .or(&UNTRANSPOSED_BLOCK, &rows(0, &f, &twice))
        .or(&UNTRANSPOSED_BLOCK, &rows(3, &f, &twice))
        .or(&VELOCITY_NOT_TURNED, &rows(3, &f, &once))
        .or(&LEAK_SIGN, &leak(-1.0))
        .or(&ROTATION_TOO_EARLY, &early[0])
        .or(&SQUARED_STEP, &leak(step.dt))
        .or(&LEAK_WITHOUT_STEP, &leak(1.0 / step.dt))
        .or(&LEAK_NOT_TURNED, &leak_alone)
        .judge()
        .map_err(|failure| step.shown(failure))?;
    let unturned = |jacobian: &Matrix3<f64>| {
        let mut matrix = g;
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(jacobian);
        matrix
    };
    let plain = Matrix3::from_diagonal_element(step.dt);
    let left = step.dt * so3::right_jacobian(&(-step.dt * step.reading.gyro));
    compare("the matrix G", &obtained.1, &g)
        .within(1e-7)
        .labelled(&ERRORS, &NOISES)
        .or(&UNTRANSPOSED_BLOCK, &turned_g)
        .or(&VELOCITY_NOT_TURNED, &rows(3, &g, &once))
        .or(&ROTATION_TOO_EARLY, &early[1])
        .or(&RIGHT_JACOBIAN_FORGOTTEN, &unturned(&plain))
        .or(&RIGHT_JACOBIAN_FORGOTTEN, &unturned(&(once.transpose() * plain)))
        .or(&LEFT_JACOBIAN, &unturned(&left))
        .judge()
        .map_err(|failure| step.shown(failure))?;
    derived(&obtained.0, &obtained.1, step)
}

/// Whether F and G were derived: what holds of a rotation, of f × f and of the axis of a turn holds then
/// to the last digits.
fn derived(f: &Matrix6<f64>, g: &Matrix6<f64>, step: &Step) -> Result<(), Failure> {
    const DIGITS: f64 = 1e-14;
    let Reading { gyro, force } = &step.reading;
    let turn = f.fixed_view::<3, 3>(0, 0);
    let by_itself = f.fixed_view::<3, 3>(3, 0) * force;
    let about_axis = g.fixed_view::<3, 3>(0, 0) * gyro - step.dt * gyro;
    let parts = [
        (turn.tr_mul(&turn) - Matrix3::identity()).amax(),
        by_itself.amax() / (step.dt * force.norm_squared()),
        about_axis.amax() / (step.dt * gyro.norm()),
    ];
    let is_exact = parts.iter().all(|part| *part <= DIGITS);
    if is_exact { Ok(()) } else { Err(Failure::known(&DIFFERENCED)) }
}

/// What is known before a step, and how noisy its reading is.
#[derive(Debug, Clone, Copy)]
pub struct Before {
    /// A factor L of the covariance L Lᵀ.
    pub factor: Matrix6<f64>,
    /// Of the noise.
    pub densities: Densities,
}

impl Before {
    /// A covariance about as large as the noise of a step.
    pub fn drawn(draw: &mut Draw) -> Self {
        Self { factor: 0.05 * draw.normals::<6, 6>(), densities: Densities::drawn(draw) }
    }
}

impl Densities {
    /// The same density for both sensors: that of the gyroscope, and that of the accelerometer.
    fn of_one(&self) -> [Self; 2] {
        [self.gyro, self.accelerometer].map(|one| Self { gyro: one, accelerometer: one })
    }
}

/// A covariance from its standard deviations in independent directions.
fn spread(directions: &Matrix6<f64>) -> Matrix6<f64> {
    directions * directions.transpose()
}

/// The columns of a matrix times the standard deviations of a reading.
fn scaled(matrix: &Matrix6<f64>, densities: &Densities, factor: f64) -> Matrix6<f64> {
    let (g, a) = (factor * densities.gyro, factor * densities.accelerometer);
    matrix * Matrix6::from_diagonal(&Vector6::new(g, g, g, a, a, a))
}

/// One step of the covariance, against what becomes of each independent direction.
///
/// # Errors
///
/// A failure, which says how the noise enters instead where that is known.
pub fn adds(answer: &dyn Transport, step: &Step, before: &Before) -> Result<(), Failure> {
    let Before { factor, densities } = before;
    let covariance = spread(factor);
    let obtained =
        Answer(answer).next_covariance(&covariance, &step.reading, &step.dt, densities)?;
    let [f, g] = step.matrices(Turned::Before);
    let carried = spread(&(f * factor));
    let noise = |factor: f64| spread(&scaled(&g, densities, factor));
    let root = step.dt.sqrt();
    let early = step.matrices(Turned::After);
    let too_early =
        spread(&(early[0] * factor)) + spread(&scaled(&early[1], densities, 1.0 / root));
    let of_one = densities.of_one().map(|one| spread(&scaled(&g, &one, 1.0 / root)));
    compare("the covariance after one step", &obtained, &(carried + noise(1.0 / root)))
        .within(1e-7)
        .labelled(&ERRORS, &ERRORS)
        .or(&DENSITY_PER_SAMPLE, &(carried + noise(1.0)))
        .or(&DENSITY_TIMES_STEP, &(carried + noise(root)))
        .or(&TRANSPOSED_PROPAGATION, &(spread(&(f.transpose() * factor)) + noise(1.0 / root)))
        .or(&ROTATION_TOO_EARLY, &too_early)
        .or(&ONE_DENSITY, &(carried + of_one[0]))
        .or(&ONE_DENSITY, &(carried + of_one[1]))
        .judge()
        .map_err(|failure| failure.unless("error_step", || carries(answer, step)))
}

/// Readings of an interval, each with a noise of its own.
#[derive(Debug, Clone)]
pub struct Interval {
    /// What is read.
    pub readings: Vec<Reading>,
    /// How long each reading holds, in seconds.
    pub dt: f64,
    /// Of the noise.
    pub densities: Densities,
}

impl Interval {
    /// Readings of steps that turn by angles of the range, in radians, each about another axis.
    pub fn drawn(draw: &mut Draw, count: usize, angle: [f64; 2]) -> Self {
        let dt = draw.uniform(0.1..0.4);
        let gyro = [angle[0] / dt, angle[1] / dt];
        let readings = (0..count).map(|_| Reading::drawn(draw, gyro, [4.0, 15.0])).collect();
        Self { readings, dt, densities: Densities::drawn(draw) }
    }

    fn reversed(&self) -> Self {
        Self { readings: self.readings.iter().rev().copied().collect(), ..self.clone() }
    }

    /// The first reading in place of every other.
    fn of_the_first(&self) -> Self {
        Self { readings: vec![self.readings[0]; self.readings.len()], ..self.clone() }
    }

    /// The first step, from nothing.
    fn step(&self) -> Step {
        let (rotation, velocity) = (Rotation3::identity(), Vector3::zeros());
        Step { rotation, velocity, reading: self.readings[0], dt: self.dt }
    }

    /// The covariance of the sums: each number of each reading is moved by itself.
    fn covariance(&self, turned: Turned, deviation: f64) -> Matrix6<f64> {
        let origin = NavState::origin();
        let truth = walk(&origin, &self.readings, self.dt, turned);
        let moved = |which: usize, noise: &Vector6<f64>| {
            let mut readings = self.readings.clone();
            readings[which] = readings[which].off_by(noise);
            error(&truth, &walk(&origin, &readings, self.dt, turned))
        };
        let one = |which| {
            spread(&scaled(&slopes(|noise| moved(which, noise)), &self.densities, deviation))
        };
        (0..self.readings.len()).map(one).sum()
    }
}

/// The covariance of many readings, against the sums with each reading moved.
///
/// # Errors
///
/// A failure when it is another one.
pub fn whole(answer: &dyn Transport, interval: &Interval) -> Result<(), Failure> {
    let Interval { readings, dt, densities } = interval;
    let obtained = Answer(answer).covariance_of(readings, dt, densities)?;
    let root = dt.sqrt();
    let expected = interval.covariance(Turned::Before, 1.0 / root);
    let of_one = densities.of_one().map(|densities| {
        Interval { densities, ..interval.clone() }.covariance(Turned::Before, 1.0 / root)
    });
    compare("the covariance of the whole interval", &obtained, &expected)
        .within(1e-7)
        .labelled(&ERRORS, &ERRORS)
        .or(&DENSITY_PER_SAMPLE, &interval.covariance(Turned::Before, 1.0))
        .or(&DENSITY_TIMES_STEP, &interval.covariance(Turned::Before, root))
        .or(&ROTATION_TOO_EARLY, &interval.covariance(Turned::After, 1.0 / root))
        .or(&REVERSED_READINGS, &interval.reversed().covariance(Turned::Before, 1.0 / root))
        .or(&FIRST_READING_REUSED, &interval.of_the_first().covariance(Turned::Before, 1.0 / root))
        .or(&ONE_DENSITY, &of_one[0])
        .or(&ONE_DENSITY, &of_one[1])
        .judge()
        .map_err(|failure| {
            let (step, before) =
                (interval.step(), Before { factor: Matrix6::identity(), densities: *densities });
            let failure = failure.unless("error_step", || carries(answer, &step));
            failure.unless("next_covariance", || adds(answer, &step, &before))
        })
}

/// A sensor at rest.
#[derive(Debug, Clone, Copy)]
pub struct Rest {
    /// Seconds between readings.
    pub dt: f64,
    /// Of which the white noise counts.
    pub noise: ImuNoise,
}

const SOURCES: [Source; 3] = [Source::Accelerometer, Source::Gyroscope, Source::Both];

impl Rest {
    /// A sensor whose two noises add equally to the velocity after about a second.
    pub fn drawn(draw: &mut Draw) -> Self {
        let gyro = draw.uniform(1e-4..5e-3);
        let accelerometer = gyro * GRAVITY.norm() * draw.uniform(0.6..1.0);
        let noise = ImuNoise { gyro, accelerometer, ..ImuNoise::mems() };
        Self { dt: draw.uniform(0.003..0.006), noise }
    }

    fn only(&self, source: Source) -> ImuNoise {
        match source {
            Source::Accelerometer => ImuNoise { gyro: 0.0, ..self.noise },
            Source::Gyroscope => ImuNoise { accelerometer: 0.0, ..self.noise },
            Source::Both => self.noise,
        }
    }

    fn sums(&self, seconds: f64, noise: &ImuNoise, bias: &ImuBias) -> Option<Preintegrated> {
        let sample = ImuSample { gyro: Vector3::zeros(), accelerometer: -GRAVITY };
        let count = (seconds / self.dt).round() as usize;
        preintegrate(&vec![sample; count], self.dt, bias, noise).ok()
    }

    /// The exponents that the library's covariance shows.
    fn of_noise(&self, source: Source) -> Option<Exponents> {
        let noise = self.only(source);
        let sigmas = |seconds| Some(self.sums(seconds, &noise, &ImuBias::default())?.sigmas());
        Some(law([sigmas(0.5)?, sigmas(2.0)?, sigmas(8.0)?]))
    }

    /// The exponents of a constant error of every reading.
    fn of_bias(&self, source: Source) -> Option<Exponents> {
        let noise = self.only(source);
        let bias = ImuBias {
            gyro: 1e-2 * noise.gyro * Vector3::new(1.0, 0.7, 0.4),
            accelerometer: 1e-2 * noise.accelerometer * Vector3::new(1.0, 0.7, 0.4),
        };
        let moved = |seconds| {
            let right = self.sums(seconds, &noise, &ImuBias::default())?.deltas;
            let Deltas { rotation, velocity, position } = self.sums(seconds, &noise, &bias)?.deltas;
            Some([
                so3::local(&right.rotation, &rotation).norm(),
                (velocity - right.velocity).norm(),
                (position - right.position).norm(),
            ])
        };
        Some(law([moved(0.5)?, moved(2.0)?, moved(8.0)?]))
    }
}

/// The exponents of sizes after times of which each is four times the one before; halves where
/// both slopes agree on one, none elsewhere.
fn law(sizes: [[f64; 3]; 3]) -> Exponents {
    let exponent = |which: usize| {
        let [a, b, c] = sizes.map(|size| size[which]);
        let slopes = [(b / a).log(4.0), (c / b).log(4.0)];
        let half = (2.0 * slopes[1]).round() / 2.0;
        (a > 0.0 && slopes.iter().all(|slope| (slope - half).abs() < 0.05)).then_some(half)
    };
    Exponents { attitude: exponent(0), velocity: exponent(1), position: exponent(2) }
}

impl Exponents {
    fn list(&self) -> [Option<f64>; 3] {
        [self.attitude, self.velocity, self.position]
    }

    fn are(&self, others: &Self) -> bool {
        self.list().iter().zip(others.list()).all(|pair| match pair {
            (Some(a), Some(b)) => (a - b).abs() < 1e-9,
            (a, b) => a.is_none() && b.is_none(),
        })
    }

    fn doubled(&self) -> Self {
        let [attitude, velocity, position] = self.list().map(|exponent| Some(2.0 * exponent?));
        Self { attitude, velocity, position }
    }

    fn told(&self) -> String {
        let one = |exponent: Option<f64>| exponent.map_or_else(|| "none".to_owned(), readable);
        let [attitude, velocity, position] = self.list().map(one);
        format!("attitude {attitude}, velocity {velocity}, position {position}")
    }
}

/// The predicted exponents against those that the library's covariance shows.
///
/// # Errors
///
/// A failure when one is another.
pub fn exponents(answer: &dyn Transport, rest: &Rest) -> Result<(), Failure> {
    for source in SOURCES {
        let obtained = Answer(answer).predicted_exponents(&source)?;
        let shown = (rest.of_noise(source), rest.of_bias(source));
        let (Some(expected), Some(of_bias)) = shown else {
            return Err(Failure::new("The sensor of this check cannot be summed up."));
        };
        let numbers = |of: &Exponents| {
            [of.attitude, of.velocity, of.position].map(|exponent| exponent.unwrap_or(0.0))
        };
        let what =
            "the list of exponents of attitude, velocity and position, zero where there is none,";
        show_list(what, &numbers(&obtained), &numbers(&expected));
        if obtained.are(&expected) {
            continue;
        }
        let name = match source {
            Source::Accelerometer => "a noisy accelerometer",
            Source::Gyroscope => "a noisy gyroscope",
            Source::Both => "two noisy sensors",
        };
        let one_for_both = source == Source::Both
            && obtained.attitude == expected.attitude
            && [obtained.velocity, obtained.position]
                .iter()
                .all(|exponent| exponent.is_some_and(f64::is_finite));
        let failure = if obtained.are(&of_bias) {
            Failure::known(&NOISE_AS_BIAS)
        } else if obtained.are(&expected.doubled()) {
            Failure::known(&VARIANCE_FOR_SIGMA)
        } else if one_for_both {
            Failure::known(&ONE_EXPONENT_FOR_BOTH)
        } else {
            Failure::new(format!(
                "With {name} the standard deviations do not grow so. Sum up readings at rest with \
                 your covariance and look; for the position, sum up velocities. Where one stays \
                 zero, or where the slope changes with the time, there is no exponent."
            ))
        };
        return Err(failure.with_numbers(format!("with {name} you say {}", obtained.told())));
    }
    Ok(())
}

/// Points of which the best line is known, because their distances from it are uncorrelated
/// with it.
#[derive(Debug, Clone)]
pub struct Points {
    /// In seconds.
    pub durations: Vec<f64>,
    /// In any unit.
    pub sigmas: Vec<f64>,
    /// The exponent of the best law.
    pub exponent: f64,
}

impl Points {
    /// Points that scatter by about a tenth.
    pub fn drawn(draw: &mut Draw, count: usize) -> Self {
        let mut seconds = draw.uniform(0.01..0.5);
        let mut durations = Vec::new();
        for _ in 0..count {
            durations.push(seconds);
            seconds *= draw.uniform(1.2..3.0);
        }
        let log = DVector::from_iterator(count, durations.iter().map(|t: &f64| t.ln()));
        let (ones, centred) = (DVector::repeat(count, 1.0), log.add_scalar(-log.mean()));
        // Two points lie on a line; more are moved off it, at right angles to all lines.
        let mut off = DVector::from_fn(count, |_, _| 0.1 * draw.normal());
        for direction in [ones, centred] {
            off -= &direction * (off.dot(&direction) / direction.norm_squared());
        }
        let (exponent, offset) = (draw.uniform(0.3..3.0), draw.uniform(-6.0..1.0));
        let sigmas = (exponent * log + off).add_scalar(offset).map(f64::exp);
        Self { durations, sigmas: sigmas.as_slice().to_vec(), exponent }
    }

    /// The slope of the line nearest to the points on plain axes.
    fn on_plain_axes(&self) -> f64 {
        let columns =
            [DVector::from_vec(self.durations.clone()), DVector::repeat(self.durations.len(), 1.0)];
        let line = DMatrix::from_columns(&columns)
            .svd(true, true)
            .solve(&DVector::from_vec(self.sigmas.clone()), 1e-12);
        line.map_or(f64::NAN, |line| line[0])
    }

    fn through_the_origin(&self) -> f64 {
        let logs = |list: &[f64]| DVector::from_iterator(list.len(), list.iter().map(|x| x.ln()));
        let (x, y) = (logs(&self.durations), logs(&self.sigmas));
        x.dot(&y) / x.norm_squared()
    }

    fn between_ends(&self) -> f64 {
        let last = self.durations.len() - 1;
        let ratio = |list: &[f64]| (list[last] / list[0]).ln();
        ratio(&self.sigmas) / ratio(&self.durations)
    }
}

/// The fitted exponent against that of the law.
///
/// # Errors
///
/// A failure when it is another.
pub fn fit(answer: &dyn Transport, points: &Points) -> Result<(), Failure> {
    let obtained = Answer(answer).fitted_exponent(&points.durations, &points.sigmas)?;
    compare_number("the fitted exponent", obtained, points.exponent)
        .within(1e-8)
        .labelled(&["exponent"], &[])
        .or_number(&PLAIN_AXES, points.on_plain_axes())
        .or_number(&MIXED_LOGARITHMS, points.exponent / LN_10)
        .or_number(&MIXED_LOGARITHMS, points.exponent * LN_10)
        .or_number(&ENDS_ONLY, points.between_ends())
        .or_number(&THROUGH_THE_ORIGIN, points.through_the_origin())
        .or_number(&VARIANCE_FOR_SIGMA, 2.0 * points.exponent)
        .judge()
        .map_err(|failure| {
            failure.given(&[("durations", &points.durations), ("sigmas", &points.sigmas)])
        })
}
