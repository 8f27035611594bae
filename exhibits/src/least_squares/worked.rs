//! The worked examples of the chapter: a spot in a garden found with three tapes, and one that lies
//! almost on a fence.

use nalgebra::{Matrix2, RowVector2, Vector1, Vector2};
use vislam::least_squares::{Factor, Kernel, Key, NormalEquations, Options, Problem, Report};

use crate::comparison::inverse;

/// A tape from a known post to an unknown spot, in metres.
#[derive(Clone, Copy)]
pub struct Tape {
    pub post: Vector2<f64>,
    pub measured: f64,
    pub sigma: f64,
}

impl Tape {
    pub fn length_at(&self, spot: &Vector2<f64>) -> f64 {
        (spot - self.post).norm()
    }

    /// The whitened residual.
    pub fn residual_at(&self, spot: &Vector2<f64>) -> f64 {
        (self.length_at(spot) - self.measured) / self.sigma
    }

    /// The second derivative of the whitened residual: a length bends across its direction.
    pub fn curvature_at(&self, spot: &Vector2<f64>) -> Matrix2<f64> {
        let direction = (spot - self.post).normalize();
        let across = Matrix2::identity() - direction * direction.transpose();
        across / (self.length_at(spot) * self.sigma)
    }
}

/// A tape to the spot that a problem looks for.
pub struct ToSpot {
    pub spot: Key<Vector2<f64>>,
    pub tape: Tape,
    /// Of the Jacobian; one where it is right.
    pub sign: f64,
}

impl Factor<1> for ToSpot {
    type Variables = (Vector2<f64>,);
    type Jacobians = (RowVector2<f64>,);

    fn variables(&self) -> (Key<Vector2<f64>>,) {
        (self.spot,)
    }

    fn residual(&self, spot: (&Vector2<f64>,)) -> Option<Vector1<f64>> {
        self.linearize(spot).map(|(residual, _)| residual)
    }

    fn linearize(&self, (spot,): (&Vector2<f64>,)) -> Option<(Vector1<f64>, (RowVector2<f64>,))> {
        let direction = (spot - self.tape.post).try_normalize(0.0)?;
        let residual = Vector1::new(self.tape.residual_at(spot));
        Some((residual, (self.sign * direction.transpose() / self.tape.sigma,)))
    }
}

pub const POSTS: [Vector2<f64>; 3] =
    [Vector2::new(0.0, 0.0), Vector2::new(6.0, 0.0), Vector2::new(3.0, 9.0)];

/// Standard deviation of a tape, in metres.
pub const SIGMA: f64 = 0.05;

/// Where the search begins when it begins near.
pub const GUESS: Vector2<f64> = Vector2::new(3.0, 4.0);

fn tapes(measured: [f64; 3], sigma: [f64; 3]) -> [Tape; 3] {
    [0, 1, 2].map(|i| Tape { post: POSTS[i], measured: measured[i], sigma: sigma[i] })
}

/// Three tapes to a spot in the middle of the garden.
pub fn garden() -> [Tape; 3] {
    tapes([5.18, 4.94, 4.87], [SIGMA; 3])
}

/// A spot almost on the line between the first two posts, whose tapes are together shorter than
/// the fence; the third distance was paced.
pub fn fence() -> [Tape; 3] {
    tapes([2.95, 2.96, 8.0], [SIGMA, SIGMA, 10.0 * SIGMA])
}

/// The first two tapes alone.
pub fn two_tapes() -> [Tape; 2] {
    let [first, second, _] = garden();
    [first, second]
}

/// Starts for a search with two tapes: good, and near the line between the posts on either side.
pub const TWO_TAPE_STARTS: [Vector2<f64>; 3] =
    [Vector2::new(2.0, -2.0), Vector2::new(5.0, 0.3), Vector2::new(8.0, -0.5)];

/// The garden with its contradictions multiplied and its estimate left where it is.
pub fn contradicting(factor: f64) -> [Tape; 3] {
    let spot = estimate(&garden());
    garden().map(|tape| {
        let length = tape.length_at(&spot);
        Tape { measured: length + factor * (tape.measured - length), ..tape }
    })
}

pub fn problem(
    tapes: &[Tape],
    start: Vector2<f64>,
    kernel: Kernel,
) -> (Problem, Key<Vector2<f64>>) {
    let mut problem = Problem::new();
    let spot = problem.add_variable(start);
    for tape in tapes {
        let factor = ToSpot { spot, tape: *tape, sign: 1.0 };
        problem.add_factor(factor, kernel).expect("the spot is a variable");
    }
    (problem, spot)
}

/// Where a search ends, and what it did.
pub fn solve(tapes: &[Tape], start: Vector2<f64>, options: &Options) -> (Vector2<f64>, Report) {
    let (problem, spot) = problem(tapes, start, Kernel::Squared);
    let solved = problem.solve(options);
    let solution = solved.expect("three posts that are not in line determine a spot");
    (solution.values[spot], solution.report)
}

/// Where a search is and the norm of its scaled gradient, after every iteration.
pub fn path(tapes: &[Tape], start: Vector2<f64>, options: &Options) -> Vec<(Vector2<f64>, f64)> {
    let mut path = Vec::new();
    for max_iterations in 0..=options.max_iterations {
        let options = Options { max_iterations, ..*options };
        let (spot, report) = solve(tapes, start, &options);
        path.push((spot, report.gradient_norm));
        if report.iterations.len() < max_iterations {
            break;
        }
    }
    path
}

/// Gauss-Newton that is stopped by nothing but its count.
pub fn unstopped(max_iterations: usize) -> Options {
    Options {
        max_iterations,
        gradient_tolerance: 0.0,
        step_tolerance: 0.0,
        decrease_tolerance: 0.0,
        ..Options::gauss_newton()
    }
}

/// The spot that explains the tapes best, from a start near the first guess.
pub fn estimate(tapes: &[Tape]) -> Vector2<f64> {
    let (mut spot, _) = solve(tapes, GUESS, &Options::default());
    // Newton's method brings what the stopping rule has left.
    for _ in 0..3 {
        let gradient = system(tapes, &spot).gradient.fixed_rows::<2>(0).into_owned();
        spot -= inverse(hessian(tapes, &spot) + curvature(tapes, &spot)) * gradient;
    }
    spot
}

pub fn system(tapes: &[Tape], spot: &Vector2<f64>) -> NormalEquations {
    let (problem, _) = problem(tapes, *spot, Kernel::Squared);
    problem.linearize(problem.values()).expect("the spot is at no post")
}

/// The Gauss-Newton Hessian at a spot.
pub fn hessian(tapes: &[Tape], spot: &Vector2<f64>) -> Matrix2<f64> {
    system(tapes, spot).hessian.fixed_view::<2, 2>(0, 0).into()
}

/// The residuals times their curvatures: what the Gauss-Newton Hessian leaves out.
pub fn curvature(tapes: &[Tape], spot: &Vector2<f64>) -> Matrix2<f64> {
    tapes.iter().map(|tape| tape.residual_at(spot) * tape.curvature_at(spot)).sum()
}

/// Where one Gauss-Newton step leads.
pub fn stepped(tapes: &[Tape], spot: &Vector2<f64>) -> Vector2<f64> {
    let step = system(tapes, spot).step(0.0);
    step.map_or(Vector2::repeat(f64::NAN), |step| spot + step.step.fixed_rows::<2>(0))
}

/// The derivative of a Gauss-Newton step by its start, at the estimate.
pub fn contraction(tapes: &[Tape], spot: &Vector2<f64>) -> Matrix2<f64> {
    -inverse(hessian(tapes, spot)) * curvature(tapes, spot)
}

/// The factor by which the distance to the estimate changes in the long run.
pub fn rate(tapes: &[Tape], spot: &Vector2<f64>) -> f64 {
    let eigenvalues = contraction(tapes, spot).complex_eigenvalues();
    eigenvalues.map(|value| value.norm()).max()
}

/// A start that is far from the minimum beside the fence.
pub const FAR_FROM_FENCE: Vector2<f64> = Vector2::new(2.0, 0.7);
