//! A body at rest: what tilt and bias say about each other.

use nalgebra::{Matrix3, Matrix6, Rotation3, SMatrix, Vector3, Vector5};
use vislam::datasets::tracks::{Feature, Picture};
use vislam::inertial::{ImuNoise, ImuSample, StampedSample};
use vislam::initialization::{RestOptions, Sensors, at_rest};
use vislam::manifold::so3;
use vislam::msckf::Start;
use vislam::simulation::{Flight, Trajectory};

use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences, inverse};
use crate::random::Random;

const STATES: usize = 200;
/// Gravity's size, in m/s².
const GRAVITY: f64 = 9.81;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Tilt); 4] = [
        ("sign", |up, error| -tilt(up, error)),
        ("not divided by gravity", |up, error| GRAVITY * tilt(up, error)),
        ("the error itself", |_, error| error / GRAVITY),
        ("with its vertical part", |up, error| tilt(up, error) + up * up.dot(error) / GRAVITY),
    ];
    chapter.equation("rest-tilt", rest_tilt, tilt, &mutants);

    let formula: Spread =
        |stand| stand.start().map_or(Matrix6::repeat(f64::NAN), |s| spread_of(&s));
    let mutants: [(_, Spread); 5] = [
        ("tilt and bias independent", |stand| changed(stand, |m| both_cross(m, |b| 0.0 * b))),
        ("sign of what they share", |stand| changed(stand, |m| both_cross(m, |b| -b))),
        ("noise alone tilts", |stand| {
            let part = stand.noise.powi(2) / (stand.noise.powi(2) + stand.bias.powi(2));
            changed(stand, |m| set(m, 0, 0, |block| part * block))
        }),
        ("bias known along as little as across", |stand| {
            let same = Matrix3::from_diagonal_element(stand.bias.powi(2));
            changed(stand, |m| set(m, 3, 3, |_| same))
        }),
        ("in the world", |stand| {
            let start = stand.start();
            start.map_or(Matrix6::repeat(f64::NAN), |start| {
                let turn = *start.state.world_from_body.matrix();
                let mut both = Matrix6::zeros();
                both.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
                both.fixed_view_mut::<3, 3>(3, 3).copy_from(&turn);
                both * spread_of(&start) * both.transpose()
            })
        }),
    ];
    chapter.equation("rest-covariance", rest_covariance, formula, &mutants);

    let formula: Vertical =
        |stand| stand.start().map_or(Vector3::repeat(f64::NAN), |start| start.bias.accelerometer);
    let mutants: [(_, Vertical); 4] = [
        ("all of it is bias", |stand| stand.vertical(1.0)),
        ("all of it is noise", |stand| stand.vertical(0.0)),
        ("standard deviations, not variances", |stand| {
            stand.vertical(stand.bias / (stand.bias + stand.noise))
        }),
        ("sign", |stand| -stand.vertical(stand.share())),
    ];
    chapter.equation("rest-vertical", rest_vertical, formula, &mutants);
    numbers(chapter);
}

type Tilt = fn(&Vector3<f64>, &Vector3<f64>) -> Vector3<f64>;

/// By which vector a body is turned, seen from where a mean force has it upright; the error is bias and noise.
fn tilt(up: &Vector3<f64>, error: &Vector3<f64>) -> Vector3<f64> {
    up.cross(error) / GRAVITY
}

fn rest_tilt(formula: Tilt) -> Comparison {
    let against = "the smallest turn between the two verticals; what is left is cubic";
    Comparison::absolute(against, 1e-8, "rad").over(STATES, 41, |random| {
        let (up, error) = (random.direction(1.0), random.direction(0.02));
        let seen = (GRAVITY * up + error).normalize();
        // The body's turn takes the vertical that it seems to have to the one that it has the other way.
        let turn = Rotation3::rotation_between(&up, &seen).expect("a small angle");
        (formula(&seen, &error), so3::log(&turn))
    })
}

/// A stand: a mean force, in m/s², and the standard deviations of the accelerometer's bias and of the mean's noise.
#[derive(Clone, Copy)]
struct Stand {
    force: Vector3<f64>,
    bias: f64,
    noise: f64,
}

impl Stand {
    fn drawn(random: &mut Random) -> Self {
        let size = GRAVITY + random.uniform(-0.3..0.3);
        let (force, bias) = (random.direction(size), random.logarithmic(0.02..0.5));
        Self { force, bias, noise: bias * random.logarithmic(0.1..3.0) }
    }

    /// What the library makes of it, from readings that are all the same for a second.
    fn start(&self) -> Option<Start> {
        let quiet =
            ImuNoise { accelerometer: self.noise, accelerometer_walk: 0.0, ..ImuNoise::euroc() };
        let sensors =
            Sensors { noise: quiet, ..Sensors::of_flight(&Flight::new(Trajectory::hover())) };
        let sample = ImuSample { gyro: Vector3::zeros(), accelerometer: self.force };
        let reading = |k: i64| StampedSample { nanoseconds: 10_000_000 * k, sample };
        let readings: Vec<StampedSample> = (0..=100).map(reading).collect();
        let feature = |track| {
            let pixel = nalgebra::Vector2::new(track as f64, 0.0);
            Feature { track, pixel, right: None }
        };
        let features: Vec<Feature> = (0..20).map(feature).collect();
        let picture = |nanoseconds| Picture { nanoseconds, features: features.clone() };
        let pictures = [picture(0), picture(1_000_000_000)];
        let options =
            RestOptions { accelerometer_bias: self.bias, force: 1e9, ..RestOptions::default() };
        at_rest(&sensors, &readings, &pictures, &options).ok()
    }

    fn up(&self) -> Vector3<f64> {
        self.force.normalize()
    }

    /// A part of what the force is too long.
    fn vertical(&self, part: f64) -> Vector3<f64> {
        (self.force.norm() - GRAVITY) * part * self.up()
    }

    fn share(&self) -> f64 {
        self.bias.powi(2) / (self.bias.powi(2) + self.noise.powi(2))
    }

    /// Twice the negative logarithm of the probability of a turn about two level axes and a bias.
    fn cost(&self, axes: &SMatrix<f64, 3, 2>, x: &Vector5<f64>) -> f64 {
        let turn = Rotation3::new(axes * x.fixed_rows::<2>(0));
        let bias = x.fixed_rows::<3>(2).into_owned();
        let noise = self.force - GRAVITY * (turn.inverse() * self.up()) - bias;
        (noise.norm() / self.noise).powi(2) + (bias.norm() / self.bias).powi(2)
    }

    fn slope(&self, axes: &SMatrix<f64, 3, 2>, x: &Vector5<f64>) -> Vector5<f64> {
        let step = 1e-4;
        let along = |d: Vector5<f64>| nalgebra::Vector1::new(self.cost(axes, &(x + d)));
        differences::<1, 5>(step, along).transpose()
    }

    fn curvature(&self, axes: &SMatrix<f64, 3, 2>, x: &Vector5<f64>) -> SMatrix<f64, 5, 5> {
        differences(1e-3, |d: Vector5<f64>| self.slope(axes, &(x + d)))
    }

    /// Two level axes of the body.
    fn axes(&self) -> SMatrix<f64, 3, 2> {
        let up = self.up();
        let first = up.cross(&Vector3::new(up.y, up.z, up.x + 2.0)).normalize();
        SMatrix::<f64, 3, 2>::from_columns(&[first, up.cross(&first)])
    }

    /// The most likely turn and bias.
    fn best(&self) -> Vector5<f64> {
        let axes = self.axes();
        let mut x = Vector5::zeros();
        for _ in 0..8 {
            x -= inverse(self.curvature(&axes, &x)) * self.slope(&axes, &x);
        }
        x
    }
}

type Spread = fn(&Stand) -> Matrix6<f64>;

/// The covariance of tilt and accelerometer bias, without the turn about the vertical.
fn spread_of(start: &Start) -> Matrix6<f64> {
    let up = start.state.world_from_body.inverse() * Vector3::z();
    let across = Matrix3::identity() - up * up.transpose();
    let block = |row, column| start.covariance.fixed_view::<3, 3>(row, column).into_owned();
    let mut spread = Matrix6::zeros();
    let mut put = |row, column, block: Matrix3<f64>| {
        spread.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
    };
    put(0, 0, across * block(0, 0) * across);
    put(0, 3, across * block(0, 12));
    put(3, 0, block(12, 0) * across);
    put(3, 3, block(12, 12));
    spread
}

fn changed(stand: &Stand, change: impl FnOnce(&mut Matrix6<f64>)) -> Matrix6<f64> {
    let mut spread = stand.start().map_or(Matrix6::repeat(f64::NAN), |start| spread_of(&start));
    change(&mut spread);
    spread
}

fn set(
    spread: &mut Matrix6<f64>,
    row: usize,
    column: usize,
    to: impl FnOnce(Matrix3<f64>) -> Matrix3<f64>,
) {
    let block = to(spread.fixed_view::<3, 3>(row, column).into_owned());
    spread.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
}

fn both_cross(spread: &mut Matrix6<f64>, to: impl Fn(Matrix3<f64>) -> Matrix3<f64>) {
    set(spread, 0, 3, &to);
    set(spread, 3, 0, &to);
}

/// A unit of the covariance in which tilts and biases have about the same size.
fn scaled(spread: &Matrix6<f64>, stand: &Stand) -> Matrix6<f64> {
    let (tilt, bias) = (GRAVITY / stand.bias, 1.0 / stand.bias);
    let scale = Matrix6::from_diagonal(&[tilt, tilt, tilt, bias, bias, bias].into());
    scale * spread * scale
}

fn rest_covariance(formula: Spread) -> Comparison {
    let against = "half of the inverse curvature of the cost of tilt and bias, by differences";
    Comparison::relative(against, 1e-5).over(STATES, 42, |random| {
        // As long as gravity, as far as the noise of its mean allows.
        let mut stand = Stand::drawn(random);
        stand.force *= GRAVITY / stand.force.norm();
        let axes = stand.axes();
        let covariance = 2.0 * inverse(stand.curvature(&axes, &Vector5::zeros()));
        let mut wide = SMatrix::<f64, 6, 5>::zeros();
        wide.fixed_view_mut::<3, 2>(0, 0).copy_from(&axes);
        wide.fixed_view_mut::<3, 3>(3, 2).fill_with_identity();
        let oracle = wide * covariance * wide.transpose();
        (scaled(&formula(&stand), &stand), scaled(&oracle, &stand))
    })
}

type Vertical = fn(&Stand) -> Vector3<f64>;

fn rest_vertical(formula: Vertical) -> Comparison {
    let against = "the most likely turn and bias, searched for";
    Comparison::absolute(against, 1e-6, "m/s²").over(STATES, 43, |random| {
        let stand = Stand::drawn(random);
        (formula(&stand), stand.best().fixed_rows::<3>(2).into_owned())
    })
}

/// How long the camera watches, in seconds; how fast it may glide, in m/s; and how far off everything is, in metres.
const GLIDE: (f64, f64, f64) = (1.0, 1.0, 1000.0);

fn numbers(chapter: &mut Chapter) {
    let bias = RestOptions::default().accelerometer_bias;
    chapter.number("rest_bias", bias, "m/s²", 1);
    chapter.number("bias_tilt_deg", (bias / GRAVITY).to_degrees(), "°", 2);
    let noise = ImuNoise::euroc().accelerometer;
    chapter.number("turned_tilt_deg", turned_tilt(bias, noise).to_degrees(), "°", 3);
    let (seconds, speed, distance) = GLIDE;
    let fx = Flight::new(Trajectory::hover()).camera.fx;
    chapter.number("glide_speed", speed, "m/s", 0);
    chapter.number("glide_distance", distance, "m", 0);
    chapter.number("glide_focal", fx, "px", 0);
    chapter.number("glide_px", fx * speed * seconds / distance, "px", 2);
    let options = RestOptions::default();
    chapter.number("rest_motion_sigmas", options.motion, "", 0);
    chapter.number("rest_force_sigmas", options.force, "", 0);
}

/// The standard deviation of a tilt when the body has stood for a second, has turned by half a turn about the vertical,
/// and has stood for another.
fn turned_tilt(bias: f64, noise: f64) -> f64 {
    // Seen in the plane: a tilt φ pushes the force by g φ to one side, before and after, and the bias changes its side.
    let rows = SMatrix::<f64, 3, 2>::new(
        GRAVITY / noise,
        1.0 / noise,
        GRAVITY / noise,
        -1.0 / noise,
        0.0,
        1.0 / bias,
    );
    inverse(rows.transpose() * rows)[(0, 0)].sqrt()
}
