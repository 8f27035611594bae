//! The residual of a second at rest over the guess of the gyroscope's bias.

use nalgebra::Vector3;
use plotters::element::{EmptyElement, PathElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::inertial::{GRAVITY, ImuBias, NavState};
use vislam::preintegration::{Preintegrated, imu_residual};
use vislam::simulation::Trajectory;

use crate::figure::{self, Drawing, Drawn, Figure, INK, SERIES, letters_around, marker};
use crate::preintegration::sums::oracle::summed;

/// The bias that the sensor has, about the vertical, in rad/s.
pub const TRUE_BIAS: f64 = 0.05;

/// A second of a poor sensor at rest, summed without knowing of its bias.
pub fn unaware(seconds: f64) -> Preintegrated {
    let bias = about_the_vertical(TRUE_BIAS);
    let steps = (seconds / 0.005).round() as usize;
    let samples = vec![Trajectory::hover().at(0.0).sample(&GRAVITY).biased(&bias); steps];
    summed(&samples, 0.005, &ImuBias::default())
}

fn about_the_vertical(rate: f64) -> ImuBias {
    ImuBias { gyro: rate * Vector3::z(), ..ImuBias::default() }
}

/// The residual of the rotation in standard deviations, and the squared error of all nine.
pub fn at_guess(sums: &Preintegrated, guess: f64) -> [f64; 2] {
    let origin = NavState::origin();
    let residual = imu_residual(sums, &origin, &origin, &GRAVITY, &about_the_vertical(guess));
    let whitened = sums.sqrt_information().map(|whiten| whiten * residual);
    let rotation = residual[2] / sums.sigmas()[0];
    [rotation, whitened.map_or(f64::NAN, |whitened| whitened.norm_squared())]
}

pub fn guess() -> Figure {
    let sums = unaware(1.0);
    let guesses: Vec<f64> = (-4..=24).map(|step| 0.005 * f64::from(step)).collect();
    let found: Vec<[f64; 2]> = guesses.iter().map(|guess| at_guess(&sums, *guess)).collect();
    let rows = guesses.iter().zip(&found).map(|(guess, [rotation, squared])| {
        vec![format!("{guess:.3}"), format!("{rotation:.2}"), format!("{squared:.1}")]
    });
    Figure {
        columns: vec![
            "guess of the bias (rad/s)",
            "residual of the rotation (standard deviations)",
            "squared error of all nine",
        ],
        rows: rows.collect(),
        svg: figure::draw(1240, |drawing| {
            let (above, below) = drawing.split_vertically(600);
            let titles = ["rotation (\u{3c3})", "squared error"];
            panel(&above, &guesses, &found, 0, titles[0])?;
            panel(&below, &guesses, &found, 1, titles[1])
        }),
    }
}

fn panel(
    drawing: &Drawing,
    guesses: &[f64],
    found: &[[f64; 2]],
    which: usize,
    title: &str,
) -> Drawn {
    let (low, high) = [(-23.0, 23.0), (-30.0, 430.0)][which];
    let x_title = ["", "guess of the bias (rad/s)"][which];
    let x_axis = (x_title, -0.025..0.125, 7);
    let mut chart = figure::axes(drawing, x_axis, (title, low..high, 5))?;
    let levels = [vec![-3.0, 3.0], vec![0.0]];
    for level in &levels[which] {
        let line = [(-0.025, *level), (0.125, *level)];
        chart.draw_series([PathElement::new(line, figure::GRID.stroke_width(6))])?;
    }
    let truth = [(TRUE_BIAS, low), (TRUE_BIAS, high)];
    chart.draw_series([PathElement::new(truth, INK.stroke_width(3))])?;
    let places = guesses.iter().zip(found).map(|(guess, found)| (*guess, found[which]));
    let line = LineSeries::new(places.clone(), SERIES[which].stroke_width(4));
    chart.draw_series(line)?;
    let marks = places.step_by(2).map(|place| EmptyElement::at(place) + marker(which));
    chart.draw_series(marks)?;
    let place = (TRUE_BIAS + 0.02, [0.82 * high, 0.9 * high][which]);
    chart.draw_series([Text::new("the sensor's bias", place, letters_around(INK))])?;
    if which == 0 {
        let place = (-0.012, 0.0);
        chart.draw_series([Text::new("\u{b1} 3 \u{3c3}", place, letters_around(INK))])?;
    }
    Ok(())
}
