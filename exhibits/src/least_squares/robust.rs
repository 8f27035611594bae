//! One number, or a line, from readings of which some are wrong.

use nalgebra::{RowSVector, RowVector2, SVector, Vector1, Vector2};
use vislam::least_squares::{Factor, Kernel, Key, Options, Problem};

/// Threshold and scale at which the kernels are nearly as good as squares on normal noise.
pub const HUBER: f64 = 1.345;
pub const CAUCHY: f64 = 2.385;
pub const KERNELS: [Kernel; 3] = [Kernel::Squared, Kernel::Huber(HUBER), Kernel::Cauchy(CAUCHY)];

/// A measured number that is linear in its variable, in standard deviations.
struct Linear<const N: usize> {
    variable: Key<SVector<f64, N>>,
    row: RowSVector<f64, N>,
    measured: f64,
}

impl<const N: usize> Factor<1> for Linear<N> {
    type Variables = (SVector<f64, N>,);
    type Jacobians = (RowSVector<f64, N>,);

    fn variables(&self) -> (Key<SVector<f64, N>>,) {
        (self.variable,)
    }

    fn residual(&self, (value,): (&SVector<f64, N>,)) -> Option<Vector1<f64>> {
        Some(self.row * value - Vector1::new(self.measured))
    }

    fn linearize(
        &self,
        value: (&SVector<f64, N>,),
    ) -> Option<(Vector1<f64>, (RowSVector<f64, N>,))> {
        Some((self.residual(value)?, (self.row,)))
    }
}

/// The only variable of a problem, and the cost there, searched from a start.
fn solved<const N: usize>(
    start: SVector<f64, N>,
    measured: impl Iterator<Item = (RowSVector<f64, N>, f64)>,
    kernel: Kernel,
) -> (SVector<f64, N>, f64) {
    let mut problem = Problem::new();
    let variable = problem.add_variable(start);
    for (row, measured) in measured {
        let factor = Linear { variable, row, measured };
        problem.add_factor(factor, kernel).expect("it names the only variable");
    }
    let solved = problem.solve(&Options::default());
    let solution = solved.expect("a location or a line is determined");
    (solution.values[variable], solution.report.cost)
}

/// A number from readings of it, and the cost there, searched from a start.
pub fn location(readings: &[f64], start: f64, kernel: Kernel) -> (f64, f64) {
    let measured = readings.iter().map(|read| (Vector1::new(1.0), *read));
    let (number, cost) = solved(Vector1::new(start), measured, kernel);
    (number.x, cost)
}

/// The slope of a line y = a + b x through points, searched from a line through the origin.
pub fn slope(points: &[Vector2<f64>], start: f64, kernel: Kernel) -> f64 {
    let measured = points.iter().map(|at| (RowVector2::new(1.0, at.x), at.y));
    solved(Vector2::new(0.0, start), measured, kernel).0.y
}

/// Ten good readings, spread like a standard normal distribution around zero.
const GOOD: [f64; 10] = [-1.64, -1.04, -0.67, -0.39, -0.13, 0.13, 0.39, 0.67, 1.04, 1.64];

/// By how much an eleventh reading shifts the estimate.
pub fn shift(kernel: &Kernel, eleventh: f64) -> f64 {
    let readings: Vec<f64> = GOOD.into_iter().chain([eleventh]).collect();
    location(&readings, 0.0, *kernel).0
}

/// The variance of the average over that of the kernel's estimate of a mean, in percent, when the
/// noise is normal and the readings are many.
pub fn efficiency_percent(kernel: &Kernel) -> f64 {
    let (mut squared, mut slope) = (0.0, 0.0);
    let width = 1e-3;
    for step in 0..10_000 {
        let s = width * (f64::from(step) + 0.5);
        let density = (-0.5 * s * s).exp();
        squared += density * kernel.influence(s).powi(2);
        // The mean slope of the influence, after an integration by parts.
        slope += density * s * kernel.influence(s);
    }
    let normalizer = width * (2.0 / std::f64::consts::PI).sqrt();
    100.0 * (normalizer * slope).powi(2) / (normalizer * squared)
}
