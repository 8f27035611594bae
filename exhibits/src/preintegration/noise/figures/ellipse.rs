//! Errors of velocity and position along a level axis, and what two covariances say of them.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix2, SymmetricEigen, Vector2};
use plotters::element::Circle;
use plotters::style::Color;
use vislam::inertial::ImuNoise;

use crate::figure::{self, Draw, Figure, INK, SERIES, decimals, letters_around, letters_right_of};
use crate::preintegration::noise::runs::{DT, SECOND, at_rest, errors_at_rest};

const RUNS: usize = 2000;
const DOTS: usize = 400;
/// Standard deviations at which an ellipse holds 95 % of a plane normal distribution.
const NINETY_FIVE: f64 = 2.4477;

pub fn ellipse() -> Figure {
    let covariance = at_rest(&ImuNoise::mems(), DT, SECOND).covariance;
    let at = |row, column| 1e4 * covariance[(row, column)];
    let whole = Matrix2::new(at(3, 3), at(3, 6), at(6, 3), at(6, 6));
    let apart = Matrix2::from_diagonal(&whole.diagonal());
    let errors: Vec<Vector2<f64>> =
        errors_at_rest(RUNS).iter().map(|error| 1e2 * Vector2::new(error[3], error[6])).collect();
    let area = |of: &Matrix2<f64>| PI * NINETY_FIVE.powi(2) * of.determinant().sqrt();
    let share = |of: &Matrix2<f64>| {
        let inverse = of.try_inverse().unwrap_or(Matrix2::repeat(f64::NAN));
        let inside = errors.iter().filter(|e| e.dot(&(inverse * **e)) < NINETY_FIVE * NINETY_FIVE);
        100.0 * inside.count() as f64 / RUNS as f64
    };
    let both = [whole, apart];
    let columns = vec![
        ("covariance", ["whole", "blocks kept apart"].map(str::to_owned).to_vec()),
        ("area of its ellipse (cm²/s)", decimals(1, both.each_ref().map(area))),
        ("share of runs inside (%)", decimals(1, both.each_ref().map(share))),
    ];
    Figure::new(760, columns, |drawing| {
        let x_axis = ("error of velocity (cm/s)", -9.5..9.5, 5);
        let y_axis = ("error of position (cm)", -4.8..4.8, 5);
        let mut chart = figure::axes(drawing, x_axis, y_axis)?;
        let dot = |e: &Vector2<f64>| Circle::new((e.x, e.y), 5, SERIES[0].mix(0.45).filled());
        chart.draw_series(errors.iter().take(DOTS).map(dot))?;
        chart.line(outline(&whole), INK, 6)?;
        // Dashes, of which there are as many as gaps.
        for dash in outline(&apart).chunks(4).step_by(2) {
            chart.line(dash.to_vec(), SERIES[1], 6)?;
        }
        chart.write("whole", (5.6, 4.2), letters_right_of(INK))?;
        chart.write("kept apart", (-5.6, 4.2), letters_around(SERIES[1]))
    })
}

fn outline(covariance: &Matrix2<f64>) -> Vec<(f64, f64)> {
    let SymmetricEigen { eigenvectors, eigenvalues } = covariance.symmetric_eigen();
    let around = (0..=160).map(|step| {
        let angle = TAU * f64::from(step) / 160.0;
        let circle = Vector2::new(angle.cos(), angle.sin());
        let place = eigenvectors * eigenvalues.map(f64::sqrt).component_mul(&circle);
        (NINETY_FIVE * place.x, NINETY_FIVE * place.y)
    });
    around.collect()
}
