//! Derivatives at points that are given, and residuals.

use nalgebra::{DMatrix, DVector};

use super::*;

/// A window, and where its derivatives are to be taken.
#[derive(Debug, Clone)]
pub struct Equations {
    pub(super) window: Window,
    pub(super) points: Vec<[usize; 2]>,
    pub(super) steps: Steps,
}

impl Equations {
    /// Any points, of which some are the latest and some are not.
    pub fn drawn(draw: &mut Draw, range: &Range, steps: Steps) -> Self {
        let window = Window::drawn(draw, range).estimated(draw, range, [2, 4]);
        let poses = window.poses.len();
        let mut points = Vec::new();
        for measurement in &window.measurements {
            let variables = measurement.variables(poses);
            points.push(variables.map(|variable| draw.index(0..window.estimates(variable))));
        }
        // At least one of them is not the latest.
        points[0] = [0, 0];
        Self { window, points, steps }
    }

    /// Derivatives of a measurement by its two variables, whitened, by differences.
    fn block(&self, measurement: &Measurement, points: [usize; 2], steps: Steps) -> DMatrix<f64> {
        let ends = self.window.ends(measurement, points);
        let variables = measurement.variables(self.window.poses.len());
        let counts = variables.map(|variable| self.window.columns(variable).1);
        let mut block = DMatrix::zeros(measurement.size(), counts[0] + counts[1]);
        for side in 0..2 {
            for k in 0..counts[side] {
                let column = slope(&|by| {
                    let mut step = [0.0; 3];
                    step[3 - counts[side] + k] = by;
                    let mut moved = ends;
                    moved[side] = stepped(&ends[side], steps, step);
                    measurement.predicted(&moved)
                });
                for row in 0..measurement.size() {
                    block[(row, side * counts[0] + k)] = column[row] / measurement.sigma;
                }
            }
        }
        block
    }

    /// Predicted less measured at estimates, in units of what was measured; angles as they come.
    fn difference(&self, measurement: &Measurement, points: [usize; 2]) -> Vec<f64> {
        let predicted = measurement.predicted(&self.window.ends(measurement, points));
        let pairs = predicted.into_iter().zip(measurement.measured());
        pairs.take(measurement.size()).map(|(predicted, measured)| predicted - measured).collect()
    }
}

const ROWS: [&str; 3] = ["x", "y", "angle"];
const COLUMNS: [&str; 6] = ["heading", "x", "y", "heading", "x", "y"];
const COLUMNS_OF_SEEN: [&str; 5] = ["heading", "x", "y", "f x", "f y"];

/// An angle between −π and π.
fn wrapped(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

/// Rows and residuals of a window against differences, one measurement after the other.
///
/// # Errors
///
/// A failure, which names where the derivative was taken instead, or what, where that is known.
pub fn equations(answer: &dyn Transport, equations: &Equations) -> Result<(), Failure> {
    let Equations { window, points, steps } = equations;
    let (rows, residual) = Answer(answer).linearized(window, points, steps)?;
    let size: usize = window.measurements.iter().map(Measurement::size).sum();
    if (rows.shape(), residual.len()) != ((size, window.size()), size) {
        let (count, columns) = rows.shape();
        return Err(Failure::new(format!(
            "{count}×{columns} derivatives and {} residuals came back, and there should be {size}×{} and \
             {size}.",
            residual.len(),
            window.size()
        )));
    }
    let latest = window.points_on(&window.latest());
    let mut start = 0;
    let mut elsewhere = rows.clone();
    for (index, measurement) in window.measurements.iter().enumerate() {
        let size = measurement.size();
        let variables = measurement.variables(window.poses.len());
        let mut obtained = DMatrix::zeros(size, 0);
        for (first, count) in variables.map(|variable| window.columns(variable)) {
            let part = rows.view((start, first), (size, count));
            let before = obtained.ncols();
            obtained = obtained.resize_horizontally(before + count, 0.0);
            obtained.columns_mut(before, count).copy_from(&part);
            elsewhere.view_mut((start, first), (size, count)).fill(0.0);
        }
        let at = (index, points[index], latest[index]);
        let given = |failure: Failure| {
            failure.given(&[
                ("measurement", measurement),
                ("points", &points[index]),
                ("its variables there", &window.ends(measurement, points[index])),
                ("its variables now", &window.ends(measurement, latest[index])),
                ("steps", steps),
            ])
        };
        equations.derivatives(measurement, at, &obtained).map_err(given)?;
        let obtained = residual.rows(start, size).into_owned();
        equations.residual(measurement, at, &obtained).map_err(given)?;
        start += size;
    }
    compare(
        "the derivatives by variables that a measurement does not have",
        &elsewhere,
        &DMatrix::<f64>::zeros(rows.nrows(), rows.ncols()),
    )
    .judge()
    .map_err(|_| {
        Failure::new("A measurement has a derivative by a variable that it does not depend on.")
    })
}

impl Equations {
    fn derivatives(
        &self,
        measurement: &Measurement,
        (index, points, latest): (usize, [usize; 2], [usize; 2]),
        obtained: &DMatrix<f64>,
    ) -> Result<(), Failure> {
        let expected = self.block(measurement, points, self.steps);
        let mut opposite = expected.clone();
        opposite.view_mut((0, 0), (2, 1)).neg_mut();
        let columns = if measurement.size() == 3 { &COLUMNS[..] } else { &COLUMNS_OF_SEEN[..] };
        compare(&format!("the derivative of measurement {index}"), obtained, &expected)
            .within(1e-8)
            .labelled(&ROWS, columns)
            .or(&STEPS_IN_THE_WORLD, &self.block(measurement, points, Steps::World))
            .or(&HEADING_SLOPE, &opposite)
            .or(&POINTS_IGNORED, &self.block(measurement, latest, self.steps))
            .or(&NOT_WHITENED, &(measurement.sigma * &expected))
            .judge()
    }

    fn residual(
        &self,
        measurement: &Measurement,
        (index, points, latest): (usize, [usize; 2], [usize; 2]),
        obtained: &DVector<f64>,
    ) -> Result<(), Failure> {
        let as_it_comes =
            |points| DVector::from_vec(self.difference(measurement, points)) / measurement.sigma;
        let residual = |points| {
            let mut residual = as_it_comes(points);
            if let Some(angle) = residual.get_mut(2) {
                *angle = wrapped(*angle * measurement.sigma) / measurement.sigma;
            }
            residual
        };
        let expected = residual(latest);
        compare(&format!("the residual of measurement {index}"), obtained, &expected)
            .labelled(&ROWS, &[])
            .or(&RESIDUAL_AT_POINTS, &residual(points))
            .or(&RESIDUAL_SIGN, &-&expected)
            .or(&ANGLE_NOT_WRAPPED, &as_it_comes(latest))
            .or(&NOT_WHITENED, &(measurement.sigma * &expected))
            .judge()
    }
}
