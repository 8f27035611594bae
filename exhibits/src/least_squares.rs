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
pub mod window;
pub mod worked;

use std::f64::consts::TAU;

use nalgebra::{
    Isometry3, Matrix2, Matrix3, Matrix6, Rotation3, Vector1, Vector2, Vector3, Vector6,
};
use vislam::least_squares::{Kernel, sqrt_information};
use vislam::manifold::{se3, so3};

use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences, inverse};
use crate::one_flight;
use crate::random::Random;
use oracle::{Fit, Rotated, random_covariance, twist};
use worked::{Tape, contraction, curvature, hessian};

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

/// Step of the central differences.
const STEP: f64 = 1e-5;

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
    window::numbers(chapter);
    one_flight::one_picture::from_far_off(chapter);
}

/// Registers the chapter's records.
pub fn records(chapter: &mut Chapter) {
    window::records(chapter);
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

    let formula: Whitener = |covariance| sqrt_information(covariance).ok();
    let mutants: [(_, Whitener); 3] = [
        ("root of the covariance", |covariance| Some(covariance.cholesky()?.l())),
        ("transposed", |covariance| Some(sqrt_information(covariance).ok()?.transpose())),
        ("information without the root", |covariance| covariance.try_inverse()),
    ];
    chapter.equation("whitening", whitening, formula, &mutants);
}

/// A difference from what is expected, with its covariance.
struct Deviation {
    difference: Vector2<f64>,
    covariance: Matrix2<f64>,
}

impl Deviation {
    fn squared(&self) -> f64 {
        let whitener = sqrt_information(&self.covariance);
        whitener.map_or(f64::NAN, |whitener| (whitener * self.difference).norm_squared())
    }

    fn with_covariance(&self) -> f64 {
        self.difference.dot(&(self.covariance * self.difference))
    }

    /// Logarithm of its normal density: that of the first coordinate, and that of the second when
    /// the first is known.
    fn log_density(&self) -> f64 {
        let scalar = |x: f64, variance: f64| -0.5 * (x * x / variance + (TAU * variance).ln());
        let (first, second) = (self.difference.x, self.difference.y);
        let slope = self.covariance.m21 / self.covariance.m11;
        let given_first = self.covariance.m22 - slope * self.covariance.m12;
        scalar(first, self.covariance.m11) + scalar(second - slope * first, given_first)
    }
}

/// Takes the deviation from a measurement and the one from the prior.
type Squares = fn(&Deviation, &Deviation) -> f64;

fn posterior_squares(formula: Squares) -> Comparison {
    let against = "logarithms of normal densities, one coordinate given the other";
    Comparison::absolute(against, 1e-9, "nat").over(STATES, 1, |random| {
        let covariances = [(); 2].map(|()| random_covariance(random));
        let [here, there, measured, believed] =
            [(); 4].map(|()| Vector2::from_fn(|_, _| random.uniform(1.0..5.0)));
        let [here, there] = [here, there].map(|spot| {
            let lengths = Vector2::new(spot.norm(), (spot - worked::POSTS[1]).norm());
            let from_measured =
                Deviation { difference: lengths - measured, covariance: covariances[0] };
            let from_prior = Deviation { difference: spot - believed, covariance: covariances[1] };
            let surprise = -from_measured.log_density() - from_prior.log_density();
            [formula(&from_measured, &from_prior), surprise]
        });
        // The constant drops out of the difference between two spots.
        (here[0] - there[0], here[1] - there[1])
    })
}

type Whitener = fn(&Matrix3<f64>) -> Option<Matrix3<f64>>;

fn whitening(formula: Whitener) -> Comparison {
    let against = "the squared length with the covariance solved by elimination";
    Comparison::relative(against, 1e-9).over(STATES, 2, |random| {
        let covariance: Matrix3<f64> = random_covariance(random);
        let difference = random.direction(2.0);
        let solved = covariance.lu().solve(&difference).unwrap_or(Vector3::repeat(f64::NAN));
        let squared = |whitener: Matrix3<f64>| (whitener * difference).norm_squared();
        (formula(&covariance).map(squared), difference.dot(&solved))
    })
}

fn linear(chapter: &mut Chapter) {
    let mutants: [(_, OfFit<Vector3<f64>>); 3] = [
        ("sign", |fit| -fit.step(0.0)),
        ("diagonal of H only", |fit| -fit.gradient().component_div(&fit.hessian().diagonal())),
        ("last measurement not in the gradient", |fit| {
            let mut shortened = fit.clone();
            shortened.r[5] = 0.0;
            shortened.step(0.0)
        }),
    ];
    chapter.equation("normal-equations", normal_equations, |fit| fit.step(0.0), &mutants);

    let formula: OfFit<f64> =
        |fit| 0.5 * (fit.r.norm_squared() - (fit.j * fit.step(0.0)).norm_squared());
    let mutants: [(_, OfFit<f64>); 3] = [
        ("sign", |fit| 0.5 * (fit.r.norm_squared() + (fit.j * fit.step(0.0)).norm_squared())),
        ("step for its prediction", |f| 0.5 * (f.r.norm_squared() - f.step(0.0).norm_squared())),
        ("lengths not squared", |f| 0.5 * (f.r.norm() - (f.j * f.step(0.0)).norm()).powi(2)),
    ];
    chapter.equation("cost-left", cost_left, formula, &mutants);
}

/// Takes six whitened residuals in three unknowns.
type OfFit<T> = fn(&Fit) -> T;

fn normal_equations(formula: OfFit<Vector3<f64>>) -> Comparison {
    let against = "the singular value decomposition of J";
    Comparison::relative(against, 1e-9).over(STATES, 3, |random| {
        let fit = Fit::random(random);
        (formula(&fit), fit.by_singular_values())
    })
}

fn cost_left(formula: OfFit<f64>) -> Comparison {
    let against = "the residual less its parts along the columns of J, one column after the other";
    Comparison::relative(against, 1e-9).over(STATES, 4, |random| {
        let fit = Fit::random(random);
        (formula(&fit), 0.5 * fit.orthogonal_part().norm_squared())
    })
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

    let formula: AtSpot = |tapes, spot| hessian(tapes, spot) + curvature(tapes, spot);
    let mutants: [(_, AtSpot); 3] = [
        ("curvature dropped", hessian),
        ("sign of the curvature", |t, spot| hessian(t, spot) - curvature(t, spot)),
        ("curvature without the residual", |tapes, spot| {
            let curvatures = tapes.iter().map(|tape| tape.curvature_at(spot));
            hessian(tapes, spot) + curvatures.sum::<Matrix2<f64>>()
        }),
    ];
    chapter.equation("full-hessian", full_hessian, formula, &mutants);
}

type Gradient = fn(&Rotated) -> Vector3<f64>;

fn cost_gradient(formula: Gradient) -> Comparison {
    let against = "central differences of the cost";
    Comparison::relative(against, 1e-6).over(STATES, 6, |random| {
        let problem = Rotated::random(random);
        let moved = |step: Vector3<f64>| problem.rotation * Rotation3::new(step);
        (formula(&problem), differences(STEP, |step| Vector1::new(problem.cost(&moved(step)))))
    })
}

/// Takes tapes and a spot.
type AtSpot = fn(&[Tape], &Vector2<f64>) -> Matrix2<f64>;

fn full_hessian(formula: AtSpot) -> Comparison {
    let against = "second differences of the cost";
    Comparison::relative(against, 1e-4).over(STATES, 7, |random| {
        let (tapes, spot) = random_garden(random);
        let cost = |spot: Vector2<f64>| {
            tapes.iter().map(|tape| 0.5 * tape.residual_at(&spot).powi(2)).sum()
        };
        (formula(&tapes, &spot), oracle::second_differences(cost, spot, 1e-3))
    })
}

/// Tapes to random posts, wrong by up to a metre, and a spot among them.
fn random_garden(random: &mut Random) -> (Vec<Tape>, Vector2<f64>) {
    let spot = Vector2::new(random.uniform(3.0..6.0), random.uniform(3.0..6.0));
    let corners = [(0.0, 0.0), (9.0, 0.0), (0.0, 9.0), (9.0, 9.0)];
    let tapes = corners.map(|(x, y)| {
        let post = Vector2::new(x + random.uniform(-1.0..1.0), y + random.uniform(-1.0..1.0));
        let measured = (spot - post).norm() + random.uniform(-1.0..1.0);
        Tape { post, measured, sigma: random.uniform(0.1..0.3) }
    });
    (tapes.to_vec(), spot)
}

fn convergence(chapter: &mut Chapter) {
    let mutants: [(_, AtSpot); 4] = [
        ("sign", |tapes, spot| -contraction(tapes, spot)),
        ("H not inverted", |tapes, spot| -hessian(tapes, spot) * curvature(tapes, spot)),
        ("full Hessian inverted", |tapes, spot| {
            -inverse(hessian(tapes, spot) + curvature(tapes, spot)) * curvature(tapes, spot)
        }),
        ("transposed", |tapes, spot| contraction(tapes, spot).transpose()),
    ];
    chapter.equation("gauss-newton-rate", gauss_newton_rate, contraction, &mutants);
}

fn gauss_newton_rate(formula: AtSpot) -> Comparison {
    let against = "where steps lead that begin beside the estimate";
    Comparison::absolute(against, 1e-6, "").over(STATES, 8, |random| {
        let (tapes, _) = random_garden(random);
        let estimate = worked::estimate(&tapes);
        let led = |away: Vector2<f64>| worked::stepped(&tapes, &(estimate + away));
        (formula(&tapes, &estimate), differences(STEP, led))
    })
}

fn damping(chapter: &mut Chapter) {
    let mutants: [(_, Damped<Vector3<f64>>); 4] = [
        ("sign", |fit, lambda| -fit.step(lambda)),
        ("identity for the diagonal", |fit, lambda| fit.damped_by(lambda * Matrix3::identity())),
        ("damping dropped", |fit, _| fit.step(0.0)),
        ("diagonal dropped from H", |fit, lambda| fit.damped_by((lambda - 1.0) * fit.diagonal())),
    ];
    chapter.equation("damped-step", damped_step, Fit::step, &mutants);

    let formula: Damped<f64> = |fit, lambda| fit.predicted_decrease(lambda, -1.0, 1.0);
    let mutants: [(_, Damped<f64>); 3] = [
        ("sign of the gradient", |fit, lambda| fit.predicted_decrease(lambda, 1.0, 1.0)),
        ("damping dropped", |fit, lambda| fit.predicted_decrease(lambda, -1.0, 0.0)),
        ("sign of the damping", |fit, lambda| fit.predicted_decrease(lambda, -1.0, -1.0)),
    ];
    chapter.equation("predicted-decrease", predicted_decrease, formula, &mutants);
}

/// Takes a fit and a damping.
type Damped<T> = fn(&Fit, f64) -> T;

fn damped_step(formula: Damped<Vector3<f64>>) -> Comparison {
    let against = "the undamped solution with one more measurement of zero for each unknown";
    Comparison::relative(against, 1e-9).over(STATES, 9, |random| {
        let (fit, lambda) = (Fit::random(random), random.logarithmic(0.01..10.0));
        (formula(&fit, lambda), fit.with_measurements_of_zero(lambda))
    })
}

fn predicted_decrease(formula: Damped<f64>) -> Comparison {
    let against = "the cost of the linear residuals before and after the step";
    Comparison::relative(against, 1e-8).over(STATES, 10, |random| {
        let (fit, lambda) = (Fit::random(random), random.logarithmic(0.01..10.0));
        let after = fit.r + fit.j * fit.with_measurements_of_zero(lambda);
        (formula(&fit, lambda), 0.5 * (fit.r.norm_squared() - after.norm_squared()))
    })
}

fn certainty(chapter: &mut Chapter) {
    let formula: Gauge = |pose, xi| se3::adjoint(&pose.inverse()) * xi;
    let mutants: [(_, Gauge); 3] = [
        ("pose for its inverse", |pose, xi| se3::adjoint(pose) * xi),
        ("the same step for every pose", |_, xi| *xi),
        ("adjoint transposed", |pose, xi| se3::adjoint(&pose.inverse()).transpose() * xi),
    ];
    chapter.equation("gauge-direction", gauge_direction, formula, &mutants);

    let formula: OfFit<Matrix3<f64>> = |fit| inverse(fit.hessian());
    let mutants: [(_, OfFit<Matrix3<f64>>); 3] = [
        ("not inverted", Fit::hessian),
        ("diagonal inverted alone", |fit| inverse(fit.diagonal())),
        ("inverted twice over", |fit| inverse(fit.hessian() * fit.hessian())),
    ];
    chapter.equation("estimate-covariance", estimate_covariance, formula, &mutants);

    let formula: Marginal = |h| schur(h, -1.0);
    let mutants: [(_, Marginal); 3] = [
        ("sign", |h| schur(h, 1.0)),
        ("other unknowns held", |h| h.fixed_view::<3, 3>(0, 0).into()),
        ("blocks exchanged", |h| {
            let block = |row, column| h.fixed_view::<3, 3>(row, column).into_owned();
            block(3, 3) - block(0, 3) * inverse(block(0, 0)) * block(3, 0)
        }),
    ];
    chapter.equation("marginal-information", marginal_information, formula, &mutants);
}

/// Takes a pose and the twist by which the world moves.
type Gauge = fn(&Isometry3<f64>, &Vector6<f64>) -> Vector6<f64>;

fn gauge_direction(formula: Gauge) -> Comparison {
    let against = "central differences of relative poses, which may not change";
    Comparison::absolute(against, 1e-8, "").over(STATES, 11, |random| {
        let poses = [(); 2].map(|()| se3::exp(&twist(random, 1.5)));
        let xi = twist(random, 1.0);
        let steps = poses.map(|pose| formula(&pose, &xi));
        let relative = |t: f64| {
            let [first, second] = [0, 1].map(|i| se3::retract(&poses[i], &(t * steps[i])));
            first.inv_mul(&second)
        };
        (se3::local(&relative(-1e-6), &relative(1e-6)) / 2e-6, [0.0; 6])
    })
}

fn estimate_covariance(formula: OfFit<Matrix3<f64>>) -> Comparison {
    let against = "the scatter of 20,000 estimates for each state";
    Comparison::relative(against, 0.06).over(25, 12, |random| {
        let fit = Fit::random(random);
        (formula(&fit), fit.scatter(random, 20_000))
    })
}

/// The block of the first three unknowns, with `sign` times what the others take from it.
fn schur(h: &Matrix6<f64>, sign: f64) -> Matrix3<f64> {
    let block = |row, column| h.fixed_view::<3, 3>(row, column).into_owned();
    block(0, 0) + sign * block(0, 3) * inverse(block(3, 3)) * block(3, 0)
}

/// Takes the Hessian of six unknowns.
type Marginal = fn(&Matrix6<f64>) -> Matrix3<f64>;

fn marginal_information(formula: Marginal) -> Comparison {
    let against = "the inverse of a block of the inverse";
    Comparison::relative(against, 1e-8).over(STATES, 13, |random| {
        let hessian: Matrix6<f64> = random_covariance(random);
        let covariance = hessian.lu().try_inverse().unwrap_or(Matrix6::repeat(f64::NAN));
        let marginal = covariance.fixed_view::<3, 3>(0, 0).into_owned();
        (formula(&hessian), marginal.lu().try_inverse())
    })
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
    let mut random = Random::new(14);
    let kinds = [Kernel::Huber, Kernel::Cauchy].into_iter().cycle();
    Comparison::relative(against, 1e-5).each(kinds.take(STATES), |kind| {
        // One block of six numbers, far enough from the kink of Huber's cost for differences.
        let (kernel, fit) = (kind(random.uniform(0.5..3.0)), Fit::random(&mut random));
        let norm = |step: Vector3<f64>| (fit.r + fit.j * step).norm();
        let slope = differences(STEP, |step| Vector1::new(kernel.cost(norm(step))));
        (formula(kernel, fit.r.norm()) * fit.gradient(), slope)
    })
}

/// Takes a kernel's parameter and a norm.
type Cost = fn(f64, f64) -> f64;

fn huber_shift(formula: Cost) -> Comparison {
    let against = "the cheapest of 100,000 corrections";
    Comparison::absolute(against, 1e-8, "").over(50, 15, |random| {
        let (threshold, norm) = (random.uniform(0.5..3.0), random.uniform(0.0..8.0));
        let price = |correction: f64| 0.5 * (norm - correction).powi(2) + threshold * correction;
        let corrections = (0..=100_000).map(|step| norm * f64::from(step) * 1e-5);
        let cheapest = corrections.map(price).fold(f64::INFINITY, f64::min);
        (formula(threshold, norm), cheapest)
    })
}

fn student_noise(formula: Cost) -> Comparison {
    let against = "normal densities averaged over an uncertain precision, by quadrature";
    Comparison::absolute(against, 1e-6, "nat").over(100, 16, |random| {
        let (scale, norm) = (random.uniform(1.6..4.0), random.uniform(0.1..20.0));
        let surprise = oracle::mixture(scale, 0.0).ln() - oracle::mixture(scale, norm).ln();
        (formula(scale, norm), surprise)
    })
}
