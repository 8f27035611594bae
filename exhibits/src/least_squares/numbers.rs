//! The numbers that the chapter quotes.

use nalgebra::{Isometry3, Matrix6, Vector2, Vector6};
use vislam::least_squares::{
    Factor, Kernel, Key, Options, Problem, RANK_TOLERANCE, SolveError, Stop,
};
use vislam::manifold::se3;

use super::cloud::Cloud;
use super::oracle::twist;
use super::robust::{self, KERNELS};
use super::worked::{self, GUESS, POSTS, SIGMA, ToSpot, estimate, fence, garden, rate, stepped};
use crate::chapter::Chapter;
use crate::random::Random;

pub const CLOUD_DRAWS: usize = 400;
pub const CLOUD_SEED: u64 = 40;
const FENCE_DRAWS: usize = 4000;

/// Registers the numbers.
pub fn numbers(chapter: &mut Chapter) {
    tapes(chapter);
    by_hand(chapter);
    converged(chapter);
    beside_the_fence(chapter);
    free_directions(chapter);
    scatter(chapter);
    misread_tape(chapter);
    kernels(chapter);
    majority(chapter);
    leverage(chapter);
    mistakes(chapter);
}

fn tapes(chapter: &mut Chapter) {
    for (name, tape) in ["tape_0", "tape_1", "tape_2"].into_iter().zip(garden()) {
        chapter.number(name, tape.measured, "m", 2);
    }
    chapter.number("sigma_cm", 100.0 * SIGMA, "cm", 0);
    chapter.number("post_1_x", POSTS[1].x, "m", 0);
    chapter.number("post_2_x", POSTS[2].x, "m", 0);
    chapter.number("post_2_y", POSTS[2].y, "m", 0);
    let miss = garden()[2].measured - garden()[2].length_at(&crossing());
    chapter.number("miss_cm", 100.0 * miss.abs(), "cm", 0);
}

/// Where the first two circles cross, on the side of the third post.
fn crossing() -> Vector2<f64> {
    let [first, second, _] = garden().map(|tape| tape.measured);
    let width = POSTS[1].x;
    let x = (first * first - second * second + width * width) / (2.0 * width);
    Vector2::new(x, (first * first - x * x).sqrt())
}

fn by_hand(chapter: &mut Chapter) {
    chapter.number("guess_x", GUESS.x, "m", 0);
    chapter.number("guess_y", GUESS.y, "m", 0);
    chapter.number("guess_length", garden()[0].length_at(&GUESS), "m", 0);
    for (name, tape) in ["r_0", "r_1", "r_2"].into_iter().zip(garden()) {
        chapter.number(name, SIGMA * tape.residual_at(&GUESS), "m", 2);
    }
    let direction = (GUESS - POSTS[0]).normalize();
    chapter.number("cosine", direction.x, "", 1);
    chapter.number("sine", direction.y, "", 1);
    let system = worked::system(&garden(), &GUESS);
    let variance = SIGMA * SIGMA;
    chapter.number("h_xx", variance * system.hessian[(0, 0)], "", 2);
    chapter.number("h_yy", variance * system.hessian[(1, 1)], "", 2);
    chapter.number("minus_g_x", -variance * system.gradient[0], "m", 3);
    chapter.number("minus_g_y", -variance * system.gradient[1], "m", 3);
    let first = stepped(&garden(), &GUESS);
    chapter.number("step_x", first.x - GUESS.x, "m", 3);
    chapter.number("step_y", first.y - GUESS.y, "m", 3);
    chapter.number("first_x", first.x, "m", 4);
    chapter.number("first_y", first.y, "m", 4);
    chapter.number("guess_off_cm", 100.0 * (GUESS - estimate(&garden())).norm(), "cm", 0);
    chapter.number("first_off_mm", 1000.0 * (first - estimate(&garden())).norm(), "mm", 1);
}

fn converged(chapter: &mut Chapter) {
    let spot = estimate(&garden());
    chapter.number("estimate_x", spot.x, "m", 4);
    chapter.number("estimate_y", spot.y, "m", 4);
    for (name, tape) in ["left_0_cm", "left_1_cm", "left_2_cm"].into_iter().zip(garden()) {
        chapter.number(name, 100.0 * SIGMA * tape.residual_at(&spot), "cm", 1);
    }
    let (_, report) = worked::solve(&garden(), GUESS, &Options::default());
    chapter.number("cost_left", report.cost, "", 2);
    chapter.number("cost_expected", 0.5 * (garden().len() as f64 - 2.0), "", 1);
    chapter.number("rate_garden", rate(&garden(), &spot), "", 3);
    let exponent = Options::default().gradient_tolerance.log10();
    chapter.number("tolerance_exponent", exponent, "", 0);
}

/// One centimetre across the fence from the minimum.
pub fn fence_start() -> Vector2<f64> {
    estimate(&fence()) + Vector2::new(0.0, 0.01)
}

fn beside_the_fence(chapter: &mut Chapter) {
    let minimum = estimate(&fence());
    chapter.number("fence_0", fence()[0].measured, "m", 2);
    chapter.number("fence_1", fence()[1].measured, "m", 2);
    chapter.number("fence_sigma_2", fence()[2].sigma, "m", 1);
    chapter.number("fence_start_cm", 100.0 * (fence_start() - minimum).norm(), "cm", 0);
    chapter.number("rate_fence", rate(&fence(), &minimum), "", 1);
    let path = worked::path(&fence(), fence_start(), &worked::unstopped(5));
    let distance = |step: usize| 100.0 * (path[step].0.y - minimum.y).abs();
    chapter.number("fence_after_1_cm", distance(1), "cm", 1);
    chapter.number("fence_after_5_cm", distance(5), "cm", 0);
    let leap = stepped(&worked::two_tapes(), &worked::TWO_TAPE_STARTS[1]);
    chapter.number("leap", (leap - worked::TWO_TAPE_STARTS[1]).norm(), "m", 0);
    let (_, report) = worked::solve(&fence(), fence_start(), &Options::default());
    let refused = report.iterations.iter().filter(|iteration| !iteration.accepted).count();
    chapter.number("fence_lm_iterations", report.iterations.len() as f64, "", 0);
    chapter.number("fence_lm_refused", refused as f64, "", 0);
}

/// A pose measured against another one.
struct Between {
    poses: [Key<Isometry3<f64>>; 2],
    measured: Isometry3<f64>,
}

type TwoPoses<'a> = (&'a Isometry3<f64>, &'a Isometry3<f64>);

impl Factor<6> for Between {
    type Variables = (Isometry3<f64>, Isometry3<f64>);
    type Jacobians = (Matrix6<f64>, Matrix6<f64>);

    fn variables(&self) -> (Key<Isometry3<f64>>, Key<Isometry3<f64>>) {
        self.poses.into()
    }

    fn residual(&self, (first, second): TwoPoses) -> Option<Vector6<f64>> {
        Some(se3::local(&self.measured, &first.inv_mul(second)))
    }

    fn linearize(&self, (first, second): TwoPoses) -> Option<(Vector6<f64>, Self::Jacobians)> {
        let residual = self.residual((first, second))?;
        let by_second = se3::right_jacobian_inverse(&residual);
        let by_first = -by_second * se3::adjoint(&second.inv_mul(first));
        Some((residual, (by_first, by_second)))
    }
}

fn free_directions(chapter: &mut Chapter) {
    const POSES: usize = 5;
    let mut random = Random::new(41);
    let mut problem = Problem::new();
    let start = [(); POSES].map(|()| se3::exp(&twist(&mut random, 1.0)));
    let poses = start.map(|pose| problem.add_variable(pose));
    for first in 0..POSES {
        let second = (first + 1) % POSES;
        let relative = start[first].inv_mul(&start[second]);
        let measured = se3::retract(&relative, &twist(&mut random, 0.1));
        let between = Between { poses: [poses[first], poses[second]], measured };
        problem.add_factor(between, Kernel::Squared).expect("both poses are variables");
    }
    let (free, dimension) = match problem.solve(&Options::gauss_newton()) {
        Err(SolveError::Singular(singular)) => (singular.free as f64, singular.dimension as f64),
        _ => (f64::NAN, f64::NAN),
    };
    chapter.number("loop_poses", POSES as f64, "", 0);
    chapter.number("loop_free", free, "", 0);
    chapter.number("loop_directions", dimension, "", 0);
    chapter.number("rank_exponent", RANK_TOLERANCE.log10(), "", 0);
}

fn scatter(chapter: &mut Chapter) {
    let cloud = Cloud::of(&garden(), CLOUD_DRAWS, CLOUD_SEED);
    chapter.number("cloud", CLOUD_DRAWS as f64, "", 0);
    chapter.number("ellipse_percent", 95.0, "%", 0);
    chapter.number("sigma_x_cm", 100.0 * cloud.covariance.m11.sqrt(), "cm", 1);
    chapter.number("sigma_y_cm", 100.0 * cloud.covariance.m22.sqrt(), "cm", 1);
    chapter.number("cloud_sigma_x_cm", 100.0 * cloud.deviation(0), "cm", 1);
    chapter.number("cloud_sigma_y_cm", 100.0 * cloud.deviation(1), "cm", 1);
    chapter.number("cloud_inside_percent", cloud.inside_percent(), "%", 1);
    let cloud = Cloud::of(&fence(), FENCE_DRAWS, CLOUD_SEED);
    let errors = cloud.estimates.iter().map(|spot| spot.y - cloud.centre.y);
    let bias = errors.sum::<f64>() / FENCE_DRAWS as f64;
    chapter.number("fence_bias_cm", 100.0 * bias.abs(), "cm", 0);
    chapter.number("fence_sigma_y_cm", 100.0 * cloud.covariance.m22.sqrt(), "cm", 0);
    chapter.number("fence_scatter_y_cm", 100.0 * cloud.deviation(1), "cm", 0);
}

/// The garden with a tape read on the wrong side: the cost, and by how much the estimate shifts.
fn misread_tape(chapter: &mut Chapter) {
    let mut tapes = garden();
    tapes[1].measured += 1.0;
    let [squared, huber, cauchy] = KERNELS.map(|kernel| {
        let (problem, spot) = worked::problem(&tapes, GUESS, kernel);
        let solved = problem.solve(&Options::default());
        let solution = solved.expect("the tapes are defined at the guess");
        let shift = solution.values[spot] - estimate(&garden());
        (solution.report.cost, 100.0 * shift.norm())
    });
    chapter.number("outlier_cost", squared.0, "", 0);
    chapter.number("outlier_tape", tapes[1].measured, "m", 2);
    chapter.number("outlier_shift_cm", squared.1, "cm", 0);
    chapter.number("outlier_huber_cm", huber.1, "cm", 0);
    chapter.number("outlier_cauchy_cm", cauchy.1, "cm", 0);
}

fn kernels(chapter: &mut Chapter) {
    chapter.number("huber_k", robust::HUBER, "", 3);
    chapter.number("cauchy_c", robust::CAUCHY, "", 3);
    chapter.number("huber_efficiency_percent", robust::efficiency_percent(&KERNELS[1]), "%", 1);
    chapter.number("cauchy_efficiency_percent", robust::efficiency_percent(&KERNELS[2]), "%", 1);
}

fn majority(chapter: &mut Chapter) {
    let readings = [-0.5, -0.3, -0.1, 0.1, 0.3, 0.5, 9.7, 9.9, 10.1, 10.3];
    let (from_zero, cost_zero) = robust::location(&readings, 0.0, KERNELS[2]);
    let (from_ten, cost_ten) = robust::location(&readings, 10.0, KERNELS[2]);
    let (huber, _) = robust::location(&readings, 10.0, KERNELS[1]);
    chapter.number("majority_from_zero", from_zero, "", 2);
    chapter.number("majority_from_ten", from_ten, "", 2);
    chapter.number("majority_cost_zero", cost_zero, "", 1);
    chapter.number("majority_cost_ten", cost_ten, "", 1);
    chapter.number("majority_huber", huber, "", 2);
}

fn leverage(chapter: &mut Chapter) {
    const SLOPE: f64 = 0.5;
    const COUNT: usize = 10;
    let mut random = Random::new(42);
    let mut point = |x: f64| Vector2::new(x, SLOPE * x + random.normal(1.0));
    let mut points: Vec<_> = (0..COUNT).map(|index| point(index as f64)).collect();
    points.push(Vector2::new(100.0, 0.0));
    chapter.number("line_points", COUNT as f64, "", 0);
    chapter.number("line_slope", SLOPE, "", 1);
    chapter.number("line_squared", robust::slope(&points, 0.0, KERNELS[0]), "", 2);
    chapter.number("line_huber", robust::slope(&points, 0.0, KERNELS[1]), "", 2);
    chapter.number("line_cauchy_from_truth", robust::slope(&points, SLOPE, KERNELS[2]), "", 2);
    chapter.number("line_cauchy", robust::slope(&points, 0.0, KERNELS[2]), "", 2);
}

fn mistakes(chapter: &mut Chapter) {
    let mut problem = Problem::new();
    let spot = problem.add_variable(GUESS);
    for (tape, sign) in garden().into_iter().zip([-1.0, 1.0, 1.0]) {
        let factor = ToSpot { spot, tape, sign };
        problem.add_factor(factor, Kernel::Squared).expect("the spot is a variable");
    }
    let stalled = problem.solve(&Options::default()).expect("the tapes are defined at the guess");
    assert_eq!(stalled.report.stop, Stop::Stalled, "the chapter says so");
    chapter.number("wrong_sign_cost", stalled.report.cost, "", 1);
    const STEPS: usize = 30;
    let gauss_newton = problem.solve(&worked::unstopped(STEPS)).expect("the step is determined");
    chapter.number("wrong_sign_steps", STEPS as f64, "", 0);
    let away = gauss_newton.values[spot] - estimate(&garden());
    chapter.number("wrong_sign_away", away.norm(), "m", 1);

    let mut unwhitened = fence();
    unwhitened[2].sigma = SIGMA;
    let shift = estimate(&unwhitened) - estimate(&fence());
    chapter.number("unwhitened_shift_cm", 100.0 * shift.norm(), "cm", 0);
}
