//! Where a robot with a doubtful heading ends, and two descriptions of it.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Matrix3, Vector2, Vector6};
use plotters::element::{Circle, EmptyElement, Polygon, Text};
use plotters::series::{DashedLineSeries, LineSeries};
use plotters::style::Color;
use vislam::manifold::se3;

use crate::figure::{self, ESTIMATED, Figure, INK, SERIES, letters_right_of};
use crate::manifold::numbers::CHI_SQUARED_2;
use crate::manifold::uncertainty::{Drive, plane_of};

const DRAWS: usize = 700;
const SEED: u64 = 41;
const CORNERS: i32 = 90;

pub fn banana() -> Figure {
    let (flat, curved) = outlines();
    let draws: Vec<(f64, f64)> = Drive::WORKED
        .ends(SEED)
        .take(DRAWS)
        .map(|end| (end.translation.vector.x, end.translation.vector.y))
        .collect();
    let rows = (0..45).map(|k| {
        let places = [flat[2 * k], curved[2 * k], draws[k]];
        places.iter().flat_map(|(x, y)| [format!("{x:.2}"), format!("{y:.2}")]).collect()
    });
    Figure {
        columns: vec![
            "ellipse x (m)",
            "ellipse y (m)",
            "carried over x (m)",
            "carried over y (m)",
            "a draw x (m)",
            "a draw y (m)",
        ],
        rows: rows.collect(),
        svg: draw(&flat, &curved, &draws),
    }
}

type Outline = Vec<(f64, f64)>;

/// The ellipse that should hold 95 % of all positions, once in the plane and once in the tangent
/// space, from where exp carries it to the plane. A twist on it has the heading that is likeliest
/// for its translation.
fn outlines() -> (Outline, Outline) {
    let covariance: Matrix3<f64> = plane_of(&Drive::WORKED.covariance());
    let position: Matrix2<f64> = covariance.fixed_view::<2, 2>(0, 0).into();
    let with_heading: Vector2<f64> = covariance.fixed_view::<2, 1>(0, 2).into();
    let nan = || Matrix2::repeat(f64::NAN);
    let root = position.cholesky().map_or_else(nan, |cholesky| cholesky.l());
    let information = position.try_inverse().unwrap_or_else(nan);
    let expected = Drive::WORKED.expected();
    let corner = |k: i32| {
        let angle = TAU * f64::from(k) / f64::from(CORNERS);
        let rho = CHI_SQUARED_2.sqrt() * root * Vector2::new(angle.cos(), angle.sin());
        let heading = with_heading.dot(&(information * rho));
        let twist = Vector6::new(rho.x, rho.y, 0.0, 0.0, 0.0, heading);
        let end = se3::retract(&expected, &twist).translation.vector;
        ((expected.translation.vector.x + rho.x, rho.y), (end.x, end.y))
    };
    (0..=CORNERS).map(corner).unzip()
}

fn draw(flat: &[(f64, f64)], curved: &[(f64, f64)], draws: &[(f64, f64)]) -> String {
    figure::draw(1000, |drawing| {
        let x_axis = ("forward (m)", -1.5..17.5, 6);
        let mut chart = figure::axes(drawing, x_axis, ("to the left (m)", -9.5..9.5, 6))?;
        let dots = draws.iter().map(|place| Circle::new(*place, 4, ESTIMATED.mix(0.55).filled()));
        chart.draw_series(dots)?;
        chart.draw_series(DashedLineSeries::new(
            flat.to_vec(),
            16,
            12,
            SERIES[0].stroke_width(6),
        ))?;
        chart.draw_series(LineSeries::new(curved.to_vec(), INK.stroke_width(6)))?;
        let robot = Polygon::new(vec![(-22, -20), (-22, 20), (26, 0)], INK.filled());
        chart.draw_series([EmptyElement::at((0.0, 0.0)) + robot])?;
        let names = [
            ("start", (-0.5, -1.3), INK),
            ("ends of the drive", (0.9, 7.6), ESTIMATED),
            ("ellipse of positions", (11.2, 7.6), SERIES[0]),
            ("ellipse of twists", (1.2, -7.6), INK),
        ];
        for (name, place, colour) in names {
            chart.draw_series([Text::new(name, place, letters_right_of(colour))])?;
        }
        Ok(())
    })
}
