//! Where a robot with a doubtful heading ends, and two descriptions of it.

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector6};
use plotters::element::{EmptyElement, Polygon};
use plotters::series::DashedLineSeries;
use plotters::style::Color;
use vislam::filtering::chi_square_quantile;
use vislam::manifold::se3;

use crate::figure::{self, Draw, ESTIMATED, Figure, INK, SERIES, decimals, letters_right_of};
use crate::manifold::uncertainty::{Drive, plane_of};

const DRAWS: usize = 700;
const SEED: u64 = 41;
const CORNERS: i32 = 90;

pub fn banana() -> Figure {
    let (flat, curved) = outlines();
    let ends = Drive::WORKED.ends(SEED).take(DRAWS).map(|end| end.translation.vector);
    let draws: Vec<_> = ends.map(|end| (end.x, end.y)).collect();
    let x = |places: &[(f64, f64)], every| decimals(2, places.iter().step_by(every).map(|at| at.0));
    let y = |places: &[(f64, f64)], every| decimals(2, places.iter().step_by(every).map(|at| at.1));
    let columns = vec![
        ("ellipse x (m)", x(&flat[..90], 2)),
        ("ellipse y (m)", y(&flat[..90], 2)),
        ("carried over x (m)", x(&curved[..90], 2)),
        ("carried over y (m)", y(&curved[..90], 2)),
        ("a draw x (m)", x(&draws[..45], 1)),
        ("a draw y (m)", y(&draws[..45], 1)),
    ];
    Figure::new(1000, columns, |drawing| {
        let x_axis = ("forward (m)", -1.5..17.5, 6);
        let mut chart = figure::axes(drawing, x_axis, ("to the left (m)", -9.5..9.5, 6))?;
        chart.dots(draws, 4, ESTIMATED.mix(0.55))?;
        let dashed = SERIES[0].stroke_width(6);
        chart.draw_series(DashedLineSeries::new(flat.iter().copied(), 16, 12, dashed))?;
        chart.line(curved, INK, 6)?;
        let robot = Polygon::new(vec![(-22, -20), (-22, 20), (26, 0)], INK.filled());
        chart.draw_series([EmptyElement::at((0.0, 0.0)) + robot])?;
        chart.write("start", (-0.5, -1.3), letters_right_of(INK))?;
        chart.write("ends of the drive", (0.9, 7.6), letters_right_of(ESTIMATED))?;
        chart.write("ellipse of positions", (11.2, 7.6), letters_right_of(SERIES[0]))?;
        chart.write("ellipse of twists", (1.2, -7.6), letters_right_of(INK))
    })
}

type Outline = Vec<(f64, f64)>;

/// The ellipse that should hold 95 % of all positions, once in the plane and once in the tangent
/// space, from where exp carries it to the plane. A twist on it has the heading that is likeliest
/// for its translation.
fn outlines() -> (Outline, Outline) {
    let covariance = plane_of(&Drive::WORKED.covariance());
    let position = covariance.fixed_view::<2, 2>(0, 0).into_owned();
    let with_heading = covariance.fixed_view::<2, 1>(0, 2).into_owned();
    let factor = position.cholesky().expect("it is positive definite");
    let expected = Drive::WORKED.expected();
    let radius = chi_square_quantile(0.95, 2).expect("a probability").sqrt();
    let corner = |k: i32| {
        let angle = TAU * f64::from(k) / f64::from(CORNERS);
        let rho = radius * factor.l() * Vector2::new(angle.cos(), angle.sin());
        let heading = with_heading.dot(&factor.solve(&rho));
        let twist = Vector6::new(rho.x, rho.y, 0.0, 0.0, 0.0, heading);
        let end = se3::retract(&expected, &twist).translation.vector;
        ((expected.translation.vector.x + rho.x, rho.y), (end.x, end.y))
    };
    (0..=CORNERS).map(corner).unzip()
}
