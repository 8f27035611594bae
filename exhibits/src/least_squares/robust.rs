//! One number, or a line, from readings of which some are wrong.

use nalgebra::{Matrix1, RowVector2, Vector1, Vector2};
use vislam::least_squares::{Factor, Kernel, Key, Manifold, Options, Problem};

/// Thresholds and scales at which the kernels are nearly as good as squares on normal noise.
pub const KERNELS: [Kernel; 3] = [Kernel::Squared, Kernel::Huber(1.345), Kernel::Cauchy(2.385)];

/// One reading of a number, in standard deviations.
struct Reading {
    number: Key<Vector1<f64>>,
    read: f64,
}

impl Factor<1> for Reading {
    type Variables = (Vector1<f64>,);
    type Jacobians = (Matrix1<f64>,);

    fn variables(&self) -> (Key<Vector1<f64>>,) {
        (self.number,)
    }

    fn residual(&self, (number,): (&Vector1<f64>,)) -> Option<Vector1<f64>> {
        Some(Vector1::new(number.x - self.read))
    }

    fn linearize(&self, number: (&Vector1<f64>,)) -> Option<(Vector1<f64>, (Matrix1<f64>,))> {
        Some((self.residual(number)?, (Matrix1::identity(),)))
    }
}

/// A point to which a line y = a + b x is fitted, with unit noise in y.
struct Dot {
    line: Key<Vector2<f64>>,
    at: Vector2<f64>,
}

impl Factor<1> for Dot {
    type Variables = (Vector2<f64>,);
    type Jacobians = (RowVector2<f64>,);

    fn variables(&self) -> (Key<Vector2<f64>>,) {
        (self.line,)
    }

    fn residual(&self, line: (&Vector2<f64>,)) -> Option<Vector1<f64>> {
        self.linearize(line).map(|(residual, _)| residual)
    }

    fn linearize(&self, (line,): (&Vector2<f64>,)) -> Option<(Vector1<f64>, (RowVector2<f64>,))> {
        let by_line = RowVector2::new(1.0, self.at.x);
        Some((by_line * line - Vector1::new(self.at.y), (by_line,)))
    }
}

/// The only variable of a problem, and the cost there, searched from a start.
fn solved<V: Manifold, F: Factor<1>>(
    start: V,
    factors: impl Fn(Key<V>) -> Vec<F>,
    kernel: Kernel,
) -> (V, f64) {
    let mut problem = Problem::new();
    let variable = problem.add_variable(start);
    for factor in factors(variable) {
        problem.add_factor(factor, kernel).expect("it names the only variable");
    }
    let solved = problem.solve(&Options::default());
    let solution = solved.expect("a location or a line is determined");
    (solution.values[variable].clone(), solution.report.cost)
}

/// A number from readings of it, and the cost there, searched from a start.
pub fn location(readings: &[f64], start: f64, kernel: Kernel) -> (f64, f64) {
    let factors = |number| readings.iter().map(|&read| Reading { number, read }).collect();
    let (number, cost) = solved(Vector1::new(start), factors, kernel);
    (number.x, cost)
}

/// The slope of a line through points, searched from a line through the origin.
pub fn slope(points: &[Vector2<f64>], start: f64, kernel: Kernel) -> f64 {
    let factors = |line| points.iter().map(|&at| Dot { line, at }).collect();
    solved(Vector2::new(0.0, start), factors, kernel).0.y
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
