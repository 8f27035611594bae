//! What chapter `least_squares` shows: how measurements that contradict each other are reconciled.
//!
//! Each part registers its equations, then checks them. In formulas `j` is a Jacobian, `r` a
//! whitened residual and `lambda` a damping.

mod cloud;
mod conditions;
mod figures;
mod numbers;
mod oracle;
mod robust;
mod window;
mod worked;

use nalgebra::{
    Isometry3, Matrix2, Matrix3, Matrix6, Rotation3, SMatrix, Vector2, Vector3, Vector6,
};
use vislam::least_squares::{Kernel, sqrt_information};
use vislam::manifold::{se3, so3};

use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;
use oracle::{Fit, Rotated, random_covariance, twist};
use worked::Tape;

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

/// Registers the chapter's exhibits.
pub fn exhibits(chapter: &mut Chapter) {
    sums_of_squares(chapter);
    linear(chapter);
    gauss_newton(chapter);
    convergence(chapter);
    damping(chapter);
    certainty(chapter);
    kernels(chapter);
    conditions::counterexamples(chapter);
    numbers::numbers(chapter);
    figures::figures(chapter);
    window::exhibits(chapter);
}

fn sums_of_squares(chapter: &mut Chapter) {
    let formula: Squares = |measured, prior| 0.5 * (measured.squared() + prior.squared());
    let mutants: [(_, Squares); 4] = [
        ("covariance for its inverse", |m, p| 0.5 * (m.with_covariance() + p.with_covariance())),
        ("prior dropped", |m, _| 0.5 * m.squared()),
        ("half dropped", |m, p| m.squared() + p.squared()),
        ("sign of the prior", |m, p| 0.5 * (m.squared() - p.squared())),
    ];
    chapter.equation("posterior-squares", posterior_squares, formula, &mutants);

    let formula: Whitener = |covariance| sqrt_information(covariance).unwrap_or(NO_MATRIX);
    let mutants: [(_, Whitener); 3] = [
        ("root of the covariance", |c| c.cholesky().map_or(NO_MATRIX, |factor| factor.l())),
        ("transposed", |c| sqrt_information(c).unwrap_or(NO_MATRIX).transpose()),
        ("information without the root", |c| c.try_inverse().unwrap_or(NO_MATRIX)),
    ];
    chapter.equation("whitening", whitening, formula, &mutants);
}

const NO_MATRIX: Matrix3<f64> = Matrix3::new(
    f64::NAN,
    f64::NAN,
    f64::NAN,
    f64::NAN,
    f64::NAN,
    f64::NAN,
    f64::NAN,
    f64::NAN,
    f64::NAN,
);

/// A difference from what is expected, with its covariance.
struct Deviation {
    difference: Vector2<f64>,
    covariance: Matrix2<f64>,
}

impl Deviation {
    fn squared(&self) -> f64 {
        let whitener = sqrt_information(&self.covariance).unwrap_or(Matrix2::repeat(f64::NAN));
        (whitener * self.difference).norm_squared()
    }

    fn with_covariance(&self) -> f64 {
        self.difference.dot(&(self.covariance * self.difference))
    }
}

/// Takes the deviation from a measurement and the one from the prior.
type Squares = fn(&Deviation, &Deviation) -> f64;

fn posterior_squares(formula: Squares) -> Comparison {
    let against = "logarithms of normal densities, one coordinate given the other";
    let mut comparison = Comparison::absolute(against, 1e-9, "nat");
    let mut random = Random::new(1);
    for _ in 0..STATES {
        let covariances = [random_covariance(&mut random), random_covariance(&mut random)];
        let spots =
            [(); 2].map(|()| Vector2::new(random.uniform(1.0..5.0), random.uniform(1.0..5.0)));
        let measured = Vector2::new(random.uniform(1.0..5.0), random.uniform(1.0..5.0));
        let believed = Vector2::new(random.uniform(1.0..5.0), random.uniform(1.0..5.0));
        // The constant drops out of the difference between two spots.
        let [here, there] = spots.map(|spot| {
            let lengths = Vector2::new(spot.norm(), (spot - worked::POSTS[1]).norm());
            [
                Deviation { difference: lengths - measured, covariance: covariances[0] },
                Deviation { difference: spot - believed, covariance: covariances[1] },
            ]
        });
        let by_formula = formula(&here[0], &here[1]) - formula(&there[0], &there[1]);
        let surprise = |deviations: &[Deviation; 2]| -> f64 {
            let surprises = deviations.iter().map(|deviation| {
                -oracle::log_density(&deviation.difference, &deviation.covariance)
            });
            surprises.sum()
        };
        comparison.add(&[by_formula], &[surprise(&here) - surprise(&there)]);
    }
    comparison
}

type Whitener = fn(&Matrix3<f64>) -> Matrix3<f64>;

fn whitening(formula: Whitener) -> Comparison {
    let against = "the squared length with the covariance solved by elimination";
    let mut comparison = Comparison::relative(against, 1e-9);
    let mut random = Random::new(2);
    for _ in 0..STATES {
        let covariance: Matrix3<f64> = random_covariance(&mut random);
        let difference = random.direction(2.0);
        let solved = covariance.lu().solve(&difference).unwrap_or(Vector3::repeat(f64::NAN));
        let whitened = formula(&covariance) * difference;
        comparison.add(&[whitened.norm_squared()], &[difference.dot(&solved)]);
    }
    comparison
}

fn linear(chapter: &mut Chapter) {
    let mutants: [(_, Solved); 3] = [
        ("sign", |fit| -fit.step(0.0)),
        ("diagonal of H only", |fit| -fit.gradient().component_div(&fit.hessian().diagonal())),
        ("last measurement not in the gradient", |fit| {
            let mut shortened = fit.clone();
            shortened.r[5] = 0.0;
            shortened.step(0.0)
        }),
    ];
    chapter.equation("normal-equations", normal_equations, |fit| fit.step(0.0), &mutants);

    let formula: Left = |fit| 0.5 * (fit.r.norm_squared() - (fit.j * fit.step(0.0)).norm_squared());
    let mutants: [(_, Left); 3] = [
        ("sign", |fit| 0.5 * (fit.r.norm_squared() + (fit.j * fit.step(0.0)).norm_squared())),
        ("step for its prediction", |fit| {
            0.5 * (fit.r.norm_squared() - fit.step(0.0).norm_squared())
        }),
        ("lengths not squared", |fit| {
            0.5 * (fit.r.norm() - (fit.j * fit.step(0.0)).norm()).powi(2)
        }),
    ];
    chapter.equation("cost-left", cost_left, formula, &mutants);
}

/// Takes six whitened residuals in three unknowns.
type Solved = fn(&Fit) -> Vector3<f64>;

fn normal_equations(formula: Solved) -> Comparison {
    let against = "the singular value decomposition of J";
    let mut comparison = Comparison::relative(against, 1e-9);
    let mut random = Random::new(3);
    for _ in 0..STATES {
        let fit = Fit::random(&mut random);
        comparison.add(formula(&fit).as_slice(), fit.by_singular_values().as_slice());
    }
    comparison
}

type Left = fn(&Fit) -> f64;

fn cost_left(formula: Left) -> Comparison {
    let against = "the residual less its parts along the columns of J, one column after the other";
    let mut comparison = Comparison::relative(against, 1e-9);
    let mut random = Random::new(4);
    for _ in 0..STATES {
        let fit = Fit::random(&mut random);
        comparison.add(&[formula(&fit)], &[0.5 * fit.orthogonal_part().norm_squared()]);
    }
    comparison
}

fn gauss_newton(chapter: &mut Chapter) {
    let formula: Gradient = |problem| problem.gradient(|r, d| -r.matrix() * so3::hat(d));
    let mutants: [(_, Gradient); 4] = [
        ("sign", |problem| problem.gradient(|r, d| r.matrix() * so3::hat(d))),
        ("left for right", |problem| problem.gradient(|r, d| -so3::hat(&(r * d)))),
        ("one half dropped", |problem| 2.0 * problem.gradient(|r, d| -r.matrix() * so3::hat(d))),
        ("Jacobian not transposed", |problem| {
            problem.gradient(|r, d| (-r.matrix() * so3::hat(d)).transpose())
        }),
    ];
    chapter.equation("cost-gradient", cost_gradient, formula, &mutants);

    let formula: FullHessian =
        |tapes, spot| worked::hessian(tapes, spot) + worked::curvature(tapes, spot);
    let mutants: [(_, FullHessian); 3] = [
        ("curvature dropped", worked::hessian),
        ("sign of the curvature", |t, spot| worked::hessian(t, spot) - worked::curvature(t, spot)),
        ("curvature without the residual", |tapes, spot| {
            let curvatures = tapes.iter().map(|tape| tape.curvature_at(spot));
            worked::hessian(tapes, spot) + curvatures.sum::<Matrix2<f64>>()
        }),
    ];
    chapter.equation("full-hessian", full_hessian, formula, &mutants);
}

type Gradient = fn(&Rotated) -> Vector3<f64>;

fn cost_gradient(formula: Gradient) -> Comparison {
    let against = "central differences of the cost";
    let mut comparison = Comparison::relative(against, 1e-6);
    let mut random = Random::new(6);
    for _ in 0..STATES {
        let problem = Rotated::random(&mut random);
        let cost = |step: Vector3<f64>| {
            SMatrix::<f64, 1, 1>::new(problem.cost(&(problem.rotation * Rotation3::new(step))))
        };
        comparison.add(formula(&problem).as_slice(), oracle::jacobian(cost).as_slice());
    }
    comparison
}

type FullHessian = fn(&[Tape], &Vector2<f64>) -> Matrix2<f64>;

fn full_hessian(formula: FullHessian) -> Comparison {
    let against = "second differences of the cost";
    let mut comparison = Comparison::relative(against, 1e-4);
    let mut random = Random::new(7);
    for _ in 0..STATES {
        let (tapes, spot) = random_garden(&mut random, 1.0);
        let cost = |spot: Vector2<f64>| -> f64 {
            tapes.iter().map(|tape| 0.5 * tape.residual_at(&spot).powi(2)).sum()
        };
        let oracle = oracle::second_differences(cost, spot, 1e-3);
        comparison.add(formula(&tapes, &spot).as_slice(), oracle.as_slice());
    }
    comparison
}

/// Tapes to random posts, wrong by up to `noise` metres, and a spot among them.
fn random_garden(random: &mut Random, noise: f64) -> (Vec<Tape>, Vector2<f64>) {
    let spot = Vector2::new(random.uniform(3.0..6.0), random.uniform(3.0..6.0));
    let corners = [(0.0, 0.0), (9.0, 0.0), (0.0, 9.0), (9.0, 9.0)];
    let tapes = corners.map(|(x, y)| {
        let post = Vector2::new(x + random.uniform(-1.0..1.0), y + random.uniform(-1.0..1.0));
        let measured = (spot - post).norm() + random.uniform(-noise..noise);
        Tape { post, measured, sigma: random.uniform(0.1..0.3) }
    });
    (tapes.to_vec(), spot)
}

fn convergence(chapter: &mut Chapter) {
    let mutants: [(_, Contraction); 4] = [
        ("sign", |tapes, spot| -worked::contraction(tapes, spot)),
        ("H not inverted", |tapes, spot| {
            -worked::hessian(tapes, spot) * worked::curvature(tapes, spot)
        }),
        ("full Hessian inverted", |tapes, spot| {
            let full = worked::hessian(tapes, spot) + worked::curvature(tapes, spot);
            -full.try_inverse().unwrap_or(Matrix2::repeat(f64::NAN))
                * worked::curvature(tapes, spot)
        }),
        ("transposed", |tapes, spot| worked::contraction(tapes, spot).transpose()),
    ];
    chapter.equation("gauss-newton-rate", gauss_newton_rate, worked::contraction, &mutants);
}

/// Takes tapes and their estimate.
type Contraction = fn(&[Tape], &Vector2<f64>) -> Matrix2<f64>;

fn gauss_newton_rate(formula: Contraction) -> Comparison {
    let against = "where steps lead that begin beside the estimate";
    let mut comparison = Comparison::absolute(against, 1e-6, "");
    let mut random = Random::new(8);
    for _ in 0..STATES {
        let (tapes, _) = random_garden(&mut random, 1.0);
        let estimate = worked::estimate(&tapes);
        let led = |away: Vector2<f64>| worked::stepped(&tapes, &(estimate + away));
        let oracle: Matrix2<f64> = oracle::jacobian(led);
        comparison.add(formula(&tapes, &estimate).as_slice(), oracle.as_slice());
    }
    comparison
}

fn damping(chapter: &mut Chapter) {
    let mutants: [(_, Damped); 4] = [
        ("sign", |fit, lambda| -fit.step(lambda)),
        ("identity for the diagonal", |fit, lambda| {
            fit.solve(fit.hessian() + lambda * Matrix3::identity())
        }),
        ("damping dropped", |fit, _| fit.step(0.0)),
        ("diagonal dropped from H", |fit, lambda| {
            fit.solve(fit.hessian() + (lambda - 1.0) * fit.diagonal())
        }),
    ];
    chapter.equation("damped-step", damped_step, Fit::step, &mutants);

    let formula: Decrease = |fit, lambda| fit.predicted_decrease(lambda, -1.0, 1.0);
    let mutants: [(_, Decrease); 3] = [
        ("sign of the gradient", |fit, lambda| fit.predicted_decrease(lambda, 1.0, 1.0)),
        ("damping dropped", |fit, lambda| fit.predicted_decrease(lambda, -1.0, 0.0)),
        ("sign of the damping", |fit, lambda| fit.predicted_decrease(lambda, -1.0, -1.0)),
    ];
    chapter.equation("predicted-decrease", predicted_decrease, formula, &mutants);
}

/// Takes a fit and a damping.
type Damped = fn(&Fit, f64) -> Vector3<f64>;

fn damped_step(formula: Damped) -> Comparison {
    let against = "the undamped solution with one more measurement of zero for each unknown";
    let mut comparison = Comparison::relative(against, 1e-9);
    let mut random = Random::new(9);
    for _ in 0..STATES {
        let fit = Fit::random(&mut random);
        let lambda = random.logarithmic(0.01..10.0);
        let oracle = fit.with_measurements_of_zero(lambda);
        comparison.add(formula(&fit, lambda).as_slice(), oracle.as_slice());
    }
    comparison
}

type Decrease = fn(&Fit, f64) -> f64;

fn predicted_decrease(formula: Decrease) -> Comparison {
    let against = "the cost of the linear residuals before and after the step";
    let mut comparison = Comparison::relative(against, 1e-8);
    let mut random = Random::new(10);
    for _ in 0..STATES {
        let fit = Fit::random(&mut random);
        let lambda = random.logarithmic(0.01..10.0);
        let after = fit.r + fit.j * fit.with_measurements_of_zero(lambda);
        let decrease = 0.5 * (fit.r.norm_squared() - after.norm_squared());
        comparison.add(&[formula(&fit, lambda)], &[decrease]);
    }
    comparison
}

fn certainty(chapter: &mut Chapter) {
    let formula: Gauge = |pose, xi| se3::adjoint(&pose.inverse()) * xi;
    let mutants: [(_, Gauge); 3] = [
        ("pose for its inverse", |pose, xi| se3::adjoint(pose) * xi),
        ("the same step for every pose", |_, xi| *xi),
        ("adjoint transposed", |pose, xi| se3::adjoint(&pose.inverse()).transpose() * xi),
    ];
    chapter.equation("gauge-direction", gauge_direction, formula, &mutants);

    let formula: Certainty = |fit| fit.hessian().try_inverse().unwrap_or(NO_MATRIX);
    let mutants: [(_, Certainty); 3] = [
        ("not inverted", Fit::hessian),
        ("diagonal inverted alone", |fit| fit.diagonal().try_inverse().unwrap_or(NO_MATRIX)),
        ("inverted twice over", |fit| {
            let inverse = fit.hessian().try_inverse().unwrap_or(NO_MATRIX);
            inverse * inverse
        }),
    ];
    chapter.equation("estimate-covariance", estimate_covariance, formula, &mutants);

    let formula: Marginal = |h| schur(h, -1.0);
    let mutants: [(_, Marginal); 3] = [
        ("sign", |h| schur(h, 1.0)),
        ("other unknowns held", |h| h.fixed_view::<3, 3>(0, 0).into()),
        ("blocks exchanged", |h| {
            let mut exchanged = *h;
            exchanged.fixed_view_mut::<3, 3>(0, 0).copy_from(&h.fixed_view::<3, 3>(3, 3));
            exchanged.fixed_view_mut::<3, 3>(3, 3).copy_from(&h.fixed_view::<3, 3>(0, 0));
            schur(&exchanged, -1.0)
        }),
    ];
    chapter.equation("marginal-information", marginal_information, formula, &mutants);
}

/// Takes a pose and the twist by which the world moves.
type Gauge = fn(&Isometry3<f64>, &Vector6<f64>) -> Vector6<f64>;

fn gauge_direction(formula: Gauge) -> Comparison {
    let against = "central differences of relative poses, which may not change";
    let mut comparison = Comparison::absolute(against, 1e-8, "");
    let mut random = Random::new(11);
    for _ in 0..STATES {
        let poses = [(); 2].map(|()| se3::exp(&twist(&mut random, 1.5)));
        let xi = twist(&mut random, 1.0);
        let steps = poses.map(|pose| formula(&pose, &xi));
        let [first, second] =
            [0, 1].map(|i| move |t: f64| se3::retract(&poses[i], &(t * steps[i])));
        let relative = |t: f64| first(t).inv_mul(&second(t));
        let change = se3::local(&relative(-1e-6), &relative(1e-6)) / 2e-6;
        comparison.add(change.as_slice(), &[0.0; 6]);
    }
    comparison
}

type Certainty = fn(&Fit) -> Matrix3<f64>;

fn estimate_covariance(formula: Certainty) -> Comparison {
    let against = "the scatter of 20,000 estimates for each state";
    let mut comparison = Comparison::relative(against, 0.06);
    let mut random = Random::new(12);
    for _ in 0..25 {
        let fit = Fit::random(&mut random);
        let scatter = fit.scatter(&mut random, 20_000);
        comparison.add(formula(&fit).as_slice(), scatter.as_slice());
    }
    comparison
}

/// The block of the first three unknowns, with `sign` times what the others take from it.
fn schur(h: &Matrix6<f64>, sign: f64) -> Matrix3<f64> {
    let block = |row, column| h.fixed_view::<3, 3>(row, column).into_owned();
    let inverse = block(3, 3).try_inverse().unwrap_or(NO_MATRIX);
    block(0, 0) + sign * block(0, 3) * inverse * block(3, 0)
}

/// Takes the Hessian of six unknowns.
type Marginal = fn(&Matrix6<f64>) -> Matrix3<f64>;

fn marginal_information(formula: Marginal) -> Comparison {
    let against = "the inverse of a block of the inverse";
    let mut comparison = Comparison::relative(against, 1e-8);
    let mut random = Random::new(13);
    for _ in 0..STATES {
        let hessian: Matrix6<f64> = random_covariance(&mut random);
        let covariance = hessian.lu().try_inverse().unwrap_or(Matrix6::repeat(f64::NAN));
        let marginal = covariance.fixed_view::<3, 3>(0, 0).into_owned();
        let information = marginal.lu().try_inverse().unwrap_or(NO_MATRIX);
        comparison.add(formula(&hessian).as_slice(), information.as_slice());
    }
    comparison
}

fn kernels(chapter: &mut Chapter) {
    let formula: Weight = |kernel, norm| kernel.weight(norm);
    let mutants: [(_, Weight); 4] = [
        ("slope not divided by the norm", |kernel, norm| kernel.influence(norm)),
        ("divided by the norm twice", |kernel, norm| kernel.weight(norm) / norm),
        ("cost for its slope", |kernel, norm| kernel.cost(norm) / norm),
        ("weight at the squared norm", |kernel, norm| kernel.weight(norm * norm)),
    ];
    chapter.equation("kernel-weight", kernel_weight, formula, &mutants);

    let formula: Cost = |k, s| Kernel::Huber(k).cost(s);
    let mutants: [(_, Cost); 3] = [
        ("squared everywhere", |_, s| Kernel::Squared.cost(s)),
        ("offset of the line dropped", |k, s| if s > k { k * s } else { 0.5 * s * s }),
        ("slope of the line dropped", |k, s| if s > k { s - 0.5 * k } else { 0.5 * s * s }),
    ];
    chapter.equation("huber-shift", huber_shift, formula, &mutants);

    let formula: Cost = |c, s| Kernel::Cauchy(c).cost(s);
    let mutants: [(_, Cost); 3] = [
        ("half dropped", |c, s| 2.0 * Kernel::Cauchy(c).cost(s)),
        ("scale not squared in front", |c, s| Kernel::Cauchy(c).cost(s) / c),
        ("scale dropped inside", |c, s| 0.5 * c * c * (s * s).ln_1p()),
    ];
    chapter.equation("student-noise", student_noise, formula, &mutants);
}

type Weight = fn(Kernel, f64) -> f64;

fn kernel_weight(formula: Weight) -> Comparison {
    let against = "central differences of the robust cost";
    let mut comparison = Comparison::relative(against, 1e-5);
    let mut random = Random::new(14);
    for state in 0..STATES {
        let parameter = random.uniform(0.5..3.0);
        let kernel =
            if state % 2 == 0 { Kernel::Huber(parameter) } else { Kernel::Cauchy(parameter) };
        // One block of six numbers, far enough from the kink of Huber's cost for differences.
        let fit = Fit::random(&mut random);
        let cost = |step: Vector3<f64>| {
            SMatrix::<f64, 1, 1>::new(kernel.cost((fit.r + fit.j * step).norm()))
        };
        let gradient = formula(kernel, fit.r.norm()) * fit.gradient();
        comparison.add(gradient.as_slice(), oracle::jacobian(cost).as_slice());
    }
    comparison
}

/// Takes a kernel's parameter and a norm.
type Cost = fn(f64, f64) -> f64;

fn huber_shift(formula: Cost) -> Comparison {
    let against = "the cheapest of 100,000 corrections";
    let mut comparison = Comparison::absolute(against, 1e-8, "");
    let mut random = Random::new(15);
    for _ in 0..50 {
        let (threshold, norm) = (random.uniform(0.5..3.0), random.uniform(0.0..8.0));
        let price = |correction: f64| 0.5 * (norm - correction).powi(2) + threshold * correction;
        let corrections = (0..=100_000).map(|step| norm * f64::from(step) * 1e-5);
        let cheapest = corrections.map(price).fold(f64::INFINITY, f64::min);
        comparison.add(&[formula(threshold, norm)], &[cheapest]);
    }
    comparison
}

fn student_noise(formula: Cost) -> Comparison {
    let against = "normal densities averaged over an uncertain precision, by quadrature";
    let mut comparison = Comparison::absolute(against, 1e-6, "nat");
    let mut random = Random::new(16);
    for _ in 0..100 {
        let (scale, norm) = (random.uniform(1.6..4.0), random.uniform(0.1..20.0));
        let surprise = oracle::mixture(scale, 0.0).ln() - oracle::mixture(scale, norm).ln();
        comparison.add(&[formula(scale, norm)], &[surprise]);
    }
    comparison
}
