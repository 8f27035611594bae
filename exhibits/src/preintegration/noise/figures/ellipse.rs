//! Errors of velocity and position along a level axis, and what two covariances say of them.

use nalgebra::{Matrix2, SymmetricEigen, Vector2};
use plotters::element::{Circle, PathElement, Text};
use plotters::style::Color;
use vislam::inertial::ImuNoise;

use crate::figure::{self, Figure, INK, SERIES, letters_around, letters_right_of};
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
    let rows = [("whole", &whole), ("blocks kept apart", &apart)].map(|(name, of)| {
        let inverse = of.try_inverse().unwrap_or(Matrix2::repeat(f64::NAN));
        let inside = errors.iter().filter(|e| e.dot(&(inverse * **e)) < NINETY_FIVE * NINETY_FIVE);
        let area = std::f64::consts::PI * NINETY_FIVE.powi(2) * of.determinant().sqrt();
        let share = 100.0 * inside.count() as f64 / RUNS as f64;
        vec![name.to_owned(), format!("{area:.1}"), format!("{share:.1}")]
    });
    Figure {
        columns: vec!["covariance", "area of its ellipse (cm²/s)", "share of runs inside (%)"],
        rows: rows.to_vec(),
        svg: figure::draw(760, |drawing| {
            let x_axis = ("error of velocity (cm/s)", -9.5..9.5, 5);
            let y_axis = ("error of position (cm)", -4.8..4.8, 5);
            let mut chart = figure::axes(drawing, x_axis, y_axis)?;
            chart.draw_series(
                errors
                    .iter()
                    .take(DOTS)
                    .map(|error| Circle::new((error.x, error.y), 5, SERIES[0].mix(0.45).filled())),
            )?;
            let line = |of: &Matrix2<f64>| outline(of);
            chart.draw_series([PathElement::new(line(&whole), INK.stroke_width(6))])?;
            // Dashes, of which there are as many as gaps.
            for dash in line(&apart).chunks(4).step_by(2) {
                let dash = dash.to_vec();
                chart.draw_series([PathElement::new(dash, SERIES[1].stroke_width(6))])?;
            }
            let whole = Text::new("whole", (5.6, 4.2), letters_right_of(INK));
            let apart = Text::new("kept apart", (-5.6, 4.2), letters_around(SERIES[1]));
            chart.draw_series([whole, apart])?;
            Ok(())
        }),
    }
}

fn outline(covariance: &Matrix2<f64>) -> Vec<(f64, f64)> {
    let SymmetricEigen { eigenvectors, eigenvalues } = covariance.symmetric_eigen();
    let around = (0..=160).map(|step| {
        let angle = std::f64::consts::TAU * f64::from(step) / 160.0;
        let circle = Vector2::new(angle.cos(), angle.sin());
        let place = eigenvectors * eigenvalues.map(f64::sqrt).component_mul(&circle);
        (NINETY_FIVE * place.x, NINETY_FIVE * place.y)
    });
    around.collect()
}
