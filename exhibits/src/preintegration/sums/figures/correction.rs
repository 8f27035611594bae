//! What a first-order correction leaves, over how far the bias has moved.

use nalgebra::Vector3;
use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, Text};
use plotters::series::LineSeries;
use plotters::style::Color;
use vislam::inertial::{GRAVITY, ImuBias};
use vislam::simulation::Trajectory;

use crate::figure::{self, Figure, INK, SERIES, letters_right_of, marker};
use crate::preintegration::sums::bias::after_correction;
use crate::preintegration::sums::oracle::Readings;

/// Sizes of the move of the gyroscope's bias, in rad/s.
const SIZES: [f64; 9] = [0.003, 0.005, 0.009, 0.015, 0.025, 0.04, 0.07, 0.12, 0.2];

/// The error of the position in metres, for a second of readings at 200 Hz.
pub fn left_by(motion: &Trajectory, axis: &Vector3<f64>, size: f64) -> f64 {
    let samples = motion.samples(&GRAVITY, 0.005, 200);
    let readings = Readings { samples, dt: 0.005, bias: ImuBias::default() };
    let [_, _, position] =
        after_correction(&readings, &ImuBias { gyro: size * axis, ..ImuBias::default() });
    position
}

/// The motions of the figure, each about the vertical and about the axis ahead.
fn series() -> [(Trajectory, Vector3<f64>); 6] {
    let motions = [
        Trajectory::figure_eight(),
        Trajectory::level_turn(1.0, 0.5),
        Trajectory::turn_on_the_spot(0.5),
    ];
    let [eight, level, spot] = motions;
    let (ahead, up) = (Vector3::x(), Vector3::z());
    [(eight, ahead), (level, ahead), (spot, ahead), (eight, up), (level, up), (spot, up)]
}

const NAMES: [&str; 5] = [
    "figure-eight, about ahead",
    "level turn, about ahead",
    "on the spot, about ahead",
    "figure-eight, about up",
    "level turn, about up",
];

pub fn correction() -> Figure {
    let errors = series().map(|(motion, axis)| SIZES.map(|size| left_by(&motion, &axis, size)));
    let rows = SIZES.iter().enumerate().map(|(index, size)| {
        let mut row = vec![format!("{size}")];
        row.extend(errors.iter().map(|errors| {
            let error = errors[index];
            if error < 1e-13 { "below 1e-13".to_owned() } else { format!("{error:.2e}") }
        }));
        row
    });
    Figure {
        columns: vec![
            "move of the bias (rad/s)",
            "figure-eight about ahead (m)",
            "level turn about ahead (m)",
            "on the spot about ahead (m)",
            "figure-eight about up (m)",
            "level turn about up (m)",
            "on the spot about up (m)",
        ],
        rows: rows.collect(),
        svg: figure::draw(1060, |drawing| {
            let x_axis = ("move of the gyroscope's bias (rad/s)", (2e-3..0.3).log_scale(), 4);
            let y_axis = ("position error (µm)", (0.03..3e6).log_scale(), 5);
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            let slope = [(0.02, 0.15), (0.2, 15.0)];
            chart.draw_series(LineSeries::new(slope, INK.stroke_width(3)))?;
            chart.draw_series([Text::new("slope 2", (0.08, 0.9), letters_right_of(INK))])?;
            for (index, errors) in errors.iter().take(5).enumerate() {
                let places = SIZES.iter().zip(errors).map(|(size, error)| (*size, 1e6 * error));
                let line = LineSeries::new(places.clone(), SERIES[index].stroke_width(4));
                chart.draw_series(line)?;
                // Three of the lines lie close together: their marks take turns.
                let (skip, every) = if index < 3 { (index, 3) } else { (0, 1) };
                let marks = places.skip(skip).step_by(every);
                chart.draw_series(marks.map(|place| EmptyElement::at(place) + marker(index)))?;
                let height = 1e6 / 3.2_f64.powi(index as i32);
                chart.draw_series([EmptyElement::at((2.4e-3, height)) + marker(index)])?;
                let beside = (2.7e-3, height);
                let name = Text::new(NAMES[index], beside, letters_right_of(SERIES[index]));
                chart.draw_series([name])?;
            }
            Ok(())
        }),
    }
}
