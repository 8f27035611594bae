//! What the theorems of the chapter assume, with cases on which they fail without it.

use nalgebra::DMatrix;

use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// Two cameras and two points on one line: how each factor changes with the place of camera 0, of
/// camera 1, of point 0 and of point 1.
type Line = &'static [[f64; 4]];

/// Each camera sees each point, and camera 0 has a prior.
const HELD: Line = &[
    [1.0, 0.0, 0.0, 0.0],
    [-1.0, 0.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0, 1.0],
    [0.0, -1.0, 1.0, 0.0],
    [0.0, -1.0, 0.0, 1.0],
];
const NOTHING_HELD: Line =
    &[[-1.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 1.0], [0.0, -1.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]];
/// Each camera sees a point of its own.
const APART: Line = &[[-1.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]];
const SHARED: Line = &[[-1.0, 0.0, 1.0, 0.0], [0.0, -1.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]];
/// As apart, and the distance between the points has been measured.
const MEASURED: Line = &[[-1.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0], [0.0, 0.0, -1.0, 1.0]];
/// Nobody sees point 1.
const UNSEEN: Line = &[[-1.0, 0.0, 1.0, 0.0], [0.0, -1.0, 1.0, 0.0]];

pub fn counterexamples(chapter: &mut Chapter) {
    chapter.counterexample("schur-step", "definite", one_solution, [HELD, NOTHING_HELD]);
    chapter.counterexample("covisibility", "no-common-point", no_block, [APART, SHARED]);
    chapter.counterexample("covisibility", "pairs", no_block, [APART, MEASURED]);
    chapter.counterexample("ba-null", "points-fixed", equally_free, [NOTHING_HELD, UNSEEN]);

    let kept = Noise { normal: true, sigma: 1.0, straight: true };
    let coin = Noise { normal: false, ..kept };
    let larger = Noise { sigma: 1.3, ..kept };
    let bent = Noise { straight: false, ..kept };
    chapter.counterexample("ba-nees", "normal", chi_squared, [kept, coin]);
    chapter.counterexample("ba-nees", "as-stated", chi_squared, [kept, larger]);
    chapter.counterexample("ba-nees", "straight", chi_squared, [kept, bent]);
}

/// The matrix of all unknowns, and the Schur complement of the points. Where their block has no
/// inverse, its pseudo-inverse stands for it.
fn matrices(line: Line) -> [DMatrix<f64>; 2] {
    let jacobian = DMatrix::from_fn(line.len(), 4, |row, column| line[row][column]);
    let whole = jacobian.tr_mul(&jacobian);
    let [cameras, coupling, points] =
        [(0, 0), (0, 2), (2, 2)].map(|start| whole.view(start, (2, 2)).into_owned());
    let inverse = points.pseudo_inverse(1e-9).unwrap_or(DMatrix::repeat(2, 2, f64::NAN));
    let reduced = cameras - &coupling * inverse * coupling.transpose();
    [whole, reduced]
}

fn free_directions(matrix: &DMatrix<f64>) -> f64 {
    (matrix.nrows() - matrix.rank(1e-9)) as f64
}

fn one_solution(line: Line) -> Comparison {
    let against = "no direction of the Schur complement in which the solution is open";
    let [_, reduced] = matrices(line);
    Comparison::absolute(against, 0.1, "directions").once(free_directions(&reduced), 0.0)
}

fn no_block(line: Line) -> Comparison {
    let [_, reduced] = matrices(line);
    Comparison::absolute("zero", 1e-12, "entries").once(reduced[(0, 1)], 0.0)
}

fn equally_free(line: Line) -> Comparison {
    let against = "the null vectors of the whole matrix";
    let [whole, reduced] = matrices(line).map(|matrix| free_directions(&matrix));
    Comparison::absolute(against, 0.1, "directions").once(reduced, whole)
}

/// One unknown, zero in truth, and one measurement of it, or of its hyperbolic sine.
#[derive(Clone, Copy)]
struct Noise {
    /// Or a coin that shows one of two values.
    normal: bool,
    /// Where one is stated.
    sigma: f64,
    straight: bool,
}

fn chi_squared(case: Noise) -> Comparison {
    let against = "mean and variance of χ² with one degree of freedom, over many draws";
    let mut random = Random::new(93);
    let mut square = || {
        let one = if case.normal { random.normal(1.0) } else { random.uniform(-1.0..1.0).signum() };
        let noise = case.sigma * one;
        // The error of the estimate, and how the prediction changes with it there.
        let (error, slope) =
            if case.straight { (noise, 1.0) } else { (noise.asinh(), noise.hypot(1.0)) };
        (slope * error).powi(2)
    };
    let squares: Vec<f64> = (0..100_000).map(|_| square()).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let middle = mean(&squares);
    let deviations: Vec<f64> = squares.iter().map(|square| (square - middle).powi(2)).collect();
    Comparison::absolute(against, 0.15, "squares").once([middle, mean(&deviations)], [1.0, 2.0])
}
