//! The residual of a second at rest over the guess of the gyroscope's bias.

use nalgebra::Vector3;
use vislam::inertial::{GRAVITY, ImuBias, NavState};
use vislam::preintegration::{Preintegrated, imu_residual};
use vislam::simulation::Trajectory;

use crate::figure::{
    self, Draw, Drawing, Drawn, Figure, GRID, INK, SERIES, decimals, letters_around,
};
use crate::preintegration::sums::oracle::{gyro_bias, summed};

/// The bias that the sensor has, about the vertical, in rad/s.
pub const TRUE_BIAS: f64 = 0.05;

/// A second of a poor sensor at rest, summed without knowing of its bias.
pub fn unaware(seconds: f64) -> Preintegrated {
    let bias = gyro_bias(TRUE_BIAS * Vector3::z());
    let steps = (seconds / 0.005).round() as usize;
    let samples = vec![Trajectory::hover().at(0.0).sample(&GRAVITY).biased(&bias); steps];
    summed(&samples, 0.005, &ImuBias::default())
}

/// The residual of the rotation in standard deviations, and the squared error of all nine.
pub fn at_guess(sums: &Preintegrated, guess: f64) -> [f64; 2] {
    let origin = NavState::origin();
    let bias = gyro_bias(guess * Vector3::z());
    let residual = imu_residual(sums, &origin, &origin, &GRAVITY, &bias);
    let whitened = sums.sqrt_information().map(|whiten| whiten * residual);
    let rotation = residual[2] / sums.sigmas()[0];
    [rotation, whitened.map_or(f64::NAN, |whitened| whitened.norm_squared())]
}

pub fn guess() -> Figure {
    let sums = unaware(1.0);
    let guesses: Vec<f64> = (-4..=24).map(|step| 0.005 * f64::from(step)).collect();
    let found: Vec<[f64; 2]> = guesses.iter().map(|guess| at_guess(&sums, *guess)).collect();
    let columns = vec![
        ("guess of the bias (rad/s)", decimals(3, guesses.clone())),
        (
            "residual of the rotation (standard deviations)",
            decimals(2, found.iter().map(|[rotation, _]| *rotation)),
        ),
        ("squared error of all nine", decimals(1, found.iter().map(|[_, squared]| *squared))),
    ];
    Figure::new(1240, columns, |drawing| {
        let (above, below) = drawing.split_vertically(600);
        panel(&above, &guesses, &found, 0)?;
        panel(&below, &guesses, &found, 1)
    })
}

fn panel(drawing: &Drawing, guesses: &[f64], found: &[[f64; 2]], which: usize) -> Drawn {
    let (low, high) = [(-23.0, 23.0), (-30.0, 430.0)][which];
    let x_title = ["", "guess of the bias (rad/s)"][which];
    let y_title = ["rotation (\u{3c3})", "squared error"][which];
    let x_axis = (x_title, -0.025..0.125, 7);
    let mut chart = figure::axes(drawing, x_axis, (y_title, low..high, 5))?;
    let levels: &[f64] = if which == 0 { &[-3.0, 3.0] } else { &[0.0] };
    for level in levels {
        chart.line([(-0.025, *level), (0.125, *level)], GRID, 6)?;
    }
    chart.line([(TRUE_BIAS, low), (TRUE_BIAS, high)], INK, 3)?;
    let places = guesses.iter().zip(found).map(|(guess, found)| (*guess, found[which]));
    chart.line(places.clone(), SERIES[which], 4)?;
    chart.marks(places.step_by(2), which)?;
    let place = (TRUE_BIAS + 0.02, [0.82 * high, 0.9 * high][which]);
    chart.write("the sensor's bias", place, letters_around(INK))?;
    if which == 0 {
        chart.write("\u{b1} 3 \u{3c3}", (-0.012, 0.0), letters_around(INK))?;
    }
    Ok(())
}
