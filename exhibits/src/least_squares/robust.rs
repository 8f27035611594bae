//! One number, or a line, from readings of which some are wrong.

use nalgebra::{Vector1, Vector2};
use vislam::least_squares::{
    Evaluation, Kernel, Manifold, Options, Problem, Residual, Solution, Undefined,
};

/// Thresholds and scales at which the kernels are nearly as good as squares on normal noise.
pub const KERNELS: [Kernel; 3] = [Kernel::Squared, Kernel::Huber(1.345), Kernel::Cauchy(2.385)];

/// One reading of a number, in standard deviations.
struct Reading(f64);

impl Residual<Vector1<f64>> for Reading {
    fn variables(&self) -> &[usize] {
        &[0]
    }

    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&self, values: &[Vector1<f64>], into: &mut Evaluation) -> Result<(), Undefined> {
        into.residual(&Vector1::new(values[0].x - self.0));
        into.jacobian(0, &Vector1::new(1.0));
        Ok(())
    }
}

/// A point to which a line y = a + b x is fitted, with unit noise in y.
struct Dot(Vector2<f64>);

impl Residual<Vector2<f64>> for Dot {
    fn variables(&self) -> &[usize] {
        &[0]
    }

    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&self, values: &[Vector2<f64>], into: &mut Evaluation) -> Result<(), Undefined> {
        let by_line = Vector2::new(1.0, self.0.x);
        into.residual(&Vector1::new(by_line.dot(&values[0]) - self.0.y));
        into.jacobian(0, &by_line.transpose());
        Ok(())
    }
}

fn solved<V: Manifold>(
    start: V,
    residuals: Vec<impl Residual<V> + 'static>,
    kernel: Kernel,
) -> Solution<V> {
    let mut problem = Problem::new();
    problem.add_variable(start);
    for residual in residuals {
        problem.add_residual(residual, kernel).expect("the only variable is variable 0");
    }
    problem.solve(&Options::default()).expect("a location or a line is determined")
}

/// A number from readings of it, and the cost there, searched from a start.
pub fn location(readings: &[f64], start: f64, kernel: Kernel) -> (f64, f64) {
    let residuals = readings.iter().map(|reading| Reading(*reading)).collect();
    let solution = solved(Vector1::new(start), residuals, kernel);
    (solution.values[0].x, solution.report.cost)
}

/// The slope of a line through points, searched from a line through the origin.
pub fn slope(points: &[Vector2<f64>], start: f64, kernel: Kernel) -> f64 {
    let residuals = points.iter().map(|point| Dot(*point)).collect();
    solved(Vector2::new(0.0, start), residuals, kernel).values[0].y
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
