//! Stands whose tilt is wrong because of a bias.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Vector2, Vector3};
use vislam::inertial::{ImuBias, ImuNoise};
use vislam::initialization::{RestOptions, Sensors, at_rest};
use vislam::simulation::{Flight, Trajectory};

use crate::chapter::Chapter;
use crate::figure::{self, Draw, ESTIMATED, Figure, MEASURED, decimals, letters_right_of};
use crate::initialization::judged::Tilt;
use crate::random::Random;

const STANDS: u64 = 300;
/// The ellipse is drawn at this many standard deviations.
const SIGMAS: f64 = 3.0;

/// The error of the tilt about the axis y, in radians, and of the bias along x, in m/s²; and their
/// covariance as it is reported.
struct Stand {
    error: Vector2<f64>,
    covariance: Matrix2<f64>,
}

impl Stand {
    /// A level stand of a second, with a poor sensor whose biases are drawn.
    fn drawn(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let options = RestOptions::default();
        let accelerometer = Vector3::from_fn(|_, _| random.normal(options.accelerometer_bias));
        let initial_bias = ImuBias { accelerometer, ..ImuBias::default() };
        let flight = Flight {
            seconds: 1.0,
            picture_rate: 2.0,
            tracks: 20,
            ..Flight::new(Trajectory::hover())
        };
        let flight = Flight { initial_bias, noise: ImuNoise::mems(), ..flight };
        let landmarks = flight.room(3.0, 200, seed).expect("a room");
        let recording = flight.record(&landmarks, seed).expect("it can be flown");
        let sensors = Sensors::of_flight(&flight);
        let start = at_rest(&sensors, &recording.readings, &recording.pictures, &options)
            .expect("the body stands");
        let last = recording.truth.states.len() - 1;
        let turns = start.covariance.fixed_view::<3, 3>(0, 0).into_owned();
        let tilt = Tilt::of(&start.state, &recording.truth.states[last], &turns);
        let bias = recording.truth.biases[last].accelerometer - start.bias.accelerometer;
        let places = [1, 12];
        Self {
            error: Vector2::new(tilt.error.y, bias.x),
            covariance: Matrix2::from_fn(|r, c| start.covariance[(places[r], places[c])]),
        }
    }

    fn is_inside(&self) -> bool {
        let spread = self.covariance.cholesky().expect("a covariance");
        self.error.dot(&spread.solve(&self.error)) < SIGMAS * SIGMAS
    }
}

fn stands() -> Vec<Stand> {
    (0..STANDS).map(Stand::drawn).collect()
}

pub fn numbers(chapter: &mut Chapter) {
    let stands = stands();
    let inside = stands.iter().filter(|stand| stand.is_inside()).count();
    let sum =
        |of: fn(&Vector2<f64>) -> f64| stands.iter().map(|stand| of(&stand.error)).sum::<f64>();
    let correlation = sum(|e| e.x * e.y) / (sum(|e| e.x * e.x) * sum(|e| e.y * e.y)).sqrt();
    let expected = 1.0 - (-0.5 * SIGMAS * SIGMAS).exp();
    chapter.number("live_stands", STANDS as f64, "", 0);
    chapter.number("live_stands_inside", 100.0 * inside as f64 / STANDS as f64, "%", 1);
    chapter.number("live_stands_expected", 100.0 * expected, "%", 1);
    chapter.number("live_stands_correlation", correlation, "", 3);
}

pub fn confused() -> Figure {
    let stands = stands();
    // Tilt in mrad, bias in cm/s².
    let shown = |place: Vector2<f64>| (1e2 * place.y, 1e3 * place.x);
    let errors: Vec<(f64, f64)> = stands.iter().map(|stand| shown(stand.error)).collect();
    let root = stands[0].covariance.cholesky().expect("a covariance").l();
    let ellipse = (0..=100).map(|step| {
        let (sine, cosine) = (TAU * f64::from(step) / 100.0).sin_cos();
        shown(SIGMAS * (root * Vector2::new(cosine, sine)))
    });
    let ellipse: Vec<(f64, f64)> = ellipse.collect();
    // The table has some of the stands.
    let some = || errors.iter().take(60);
    let columns = vec![
        ("error of the bias along x (cm/s²)", decimals(2, some().map(|error| error.0))),
        ("error of the tilt about y (mrad)", decimals(2, some().map(|error| error.1))),
    ];
    Figure::new(860, columns, |drawing| {
        let x_axis = ("error of the accelerometer's bias along x (cm/s²)", -40.0..40.0, 7);
        let y_axis = ("error of tilt about y (mrad)", -40.0..40.0, 7);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        chart.dots(errors.iter().copied(), 5, MEASURED)?;
        chart.line(ellipse, ESTIMATED, 5)?;
        chart.line([(-38.0, 36.0), (-35.0, 36.0)], ESTIMATED, 5)?;
        chart.write("reported, three σ", (-34.0, 36.0), letters_right_of(ESTIMATED))?;
        chart.dots([(-36.5, 31.0)], 5, MEASURED)?;
        chart.write("stands", (-34.0, 31.0), letters_right_of(MEASURED))?;
        Ok(())
    })
}
