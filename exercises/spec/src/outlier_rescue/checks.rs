//! What is asked about an answer, and on which instances.

use nalgebra::{
    Isometry3, Matrix2, Matrix2x6, Matrix6, Point3, Rotation2, Vector2, Vector3, Vector6,
};
use vislam::least_squares::{Factor, Kernel, Key, Options, Problem};
use vislam::manifold::se3;

use super::*;
use crate::Exercise;
use crate::answer::{Fault, Transport};
use crate::camera::point_in_view;
use crate::check::{
    Check, Comparison, Failure, Misconception, compare, compare_list, compare_number, readable,
};
use crate::draw::Draw;
use crate::picture::{Dots, Picture};

/// The exercise.
pub const EXERCISE: Exercise = Exercise {
    slug: "outlier_rescue",
    title: "Robust camera pose with outliers",
    chapter: "bundle_adjustment",
    functions: FUNCTIONS,
    misconceptions: MISCONCEPTIONS,
    types: &["Camera", "Match"],
    forbidden: &[
        "Kernel",
        "Problem",
        "ReprojFactor",
        "bal",
        "bundle_adjustment",
        "factors",
        "observability",
        "simulation",
    ],
    hints: include_str!("hints.md"),
    checks,
};

crate::misconceptions! {
    UNWHITENED, "unwhitened":
        "These weights compare a length in pixels with the threshold. The threshold counts \
         standard deviations, and here they differ from match to match: how many of its own is a \
         residual long?";
    SQUARED_NORM, "squared_norm":
        "The weight falls with the square of the length. Huber's cost is a straight line outside: \
         what is the slope of a line, and by what is it divided, once or twice?";
    INFLUENCE, "influence":
        "This is ρ'(s), the pull of a residual. The weight multiplies a residual that has its \
         length already: what must it be so that the product pulls with ρ'(s)?";
    AXES_IGNORED, "axes_ignored":
        "Each coordinate was divided by the root of its own variance. The ellipse of the noise lies \
         askew here: what do the entries beside the diagonal say?";
    DEVIATIONS_MULTIPLIED, "deviations_multiplied":
        "The residuals were multiplied by their standard deviations. The less a pixel is trusted, the \
         longer its residual becomes: which way round should it be?";
    HARD_REJECTION, "hard_rejection":
        "Every weight is one or zero: what lies beyond the threshold is thrown away. Huber's cost \
         goes on rising there; can its weight be zero?";
    ROOT_OF_WEIGHT, "root_of_weight":
        "This is the root of the weight. The weight stands before a square, half of w times s²; \
         where would its root stand?";
    WEIGHT_TWICE, "weight_twice":
        "Each weight is in there twice, as w². When the residual and its Jacobian are both \
         multiplied by something, what happens to their product in the normal equations?";
    RESIDUAL_ALONE, "residual_alone":
        "The gradient is weighted and the matrix is not. The weight stands before the whole \
         square of e + J ξ: which of its terms can do without?";
    MATRIX_ALONE, "matrix_alone":
        "The matrix is weighted and the gradient is not. With how much force does a wrong match pull \
         at this pose?";
    ROWS_IN_PIXELS, "rows_in_pixels":
        "The weights are right, and what they multiply are squares of pixels. Two matches of \
         weight one with different covariances: should they count alike?";
    UPHILL, "uphill":
        "The step is right and points the wrong way. To first order it adds J ξ to the residual e, \
         the predicted pixel less the measured one: should J ξ be e or its negative?";
    LEFT_TWIST, "left_twist":
        "This twist would stand on the left of the pose. On which side does T exp(ξ) have it?";
    ONE_STEP, "one_step":
        "This is the pose after a single step. At its end the residuals are others than at the \
         start, and so are their weights: what follows?";
    FROZEN_WEIGHTS, "frozen_weights":
        "The weights are those of the start, to the very end. A match that looked bad from there \
         may be right: when should the weights be asked for again?";
    RMSE_OVER_ALL, "rmse_over_all":
        "The wrong matches are in this number. An estimate that is not drawn towards them fits \
         them worse: what would be praised by a small number?";
    RMSE_PER_MATCH, "rmse_per_match":
        "The sum of squares is right and what it was divided by is not. How many numbers were \
         squared?";
    MEAN_SQUARE, "mean_square":
        "This is the mean of the squares. In which unit is it, and in which is it asked for?";
    RMSE_WHITENED, "rmse_whitened":
        "These squares are of standard deviations. In which unit is the root asked for?";
}

/// A camera among known points, some of whose matches are wrong.
#[derive(Debug, Clone)]
pub struct Case {
    /// The camera.
    pub camera: Camera,
    /// Where it is.
    pub camera_from_world: Isometry3<f64>,
    /// Where the search begins.
    pub start: Isometry3<f64>,
    /// The matches.
    pub matches: Vec<Match>,
    /// Which of them are right.
    pub right: Vec<bool>,
    /// Huber's threshold in standard deviations.
    pub threshold: f64,
}

/// Of what cases are drawn.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// How many matches.
    pub matches: usize,
    /// Depths of the points in metres.
    pub depth: [f64; 2],
    /// Standard deviations of the pixels.
    pub sigma: [f64; 2],
    /// How far off wrong matches are, in pixels.
    pub off: f64,
    /// Thresholds in standard deviations.
    pub threshold: [f64; 2],
    /// Angle of the pose in radians.
    pub angle: f64,
}

/// The range of the public instances.
const PUBLIC: Range = Range {
    matches: 60,
    depth: [2.0, 8.0],
    sigma: [0.4, 2.5],
    off: 30.0,
    threshold: [1.2, 2.0],
    angle: 2.6,
};

impl Case {
    /// A case in which a tenth of the matches is wrong.
    pub fn drawn(draw: &mut Draw, range: Range) -> Self {
        let camera = Camera::drawn(draw);
        let camera_from_world = draw.pose(0.3 * range.angle..range.angle, 0.5..2.0);
        let mut right = Vec::new();
        let matches = (0..range.matches).map(|index| {
            let point_in_camera = point_in_view(draw, range.depth[0], range.depth[1]);
            let turn = Rotation2::new(draw.uniform(0.0..3.0)).into_inner();
            let sigmas = Vector2::from_fn(|_, _| draw.uniform(range.sigma[0]..range.sigma[1]));
            let factor = turn * Matrix2::from_diagonal(&sigmas);
            let mut pixel = pixel_of(&camera, &point_in_camera) + factor * draw.normals::<2, 1>();
            right.push(index % 10 != 7);
            if index % 10 == 7 {
                // All in one half of the directions, so that they agree in something wrong.
                let angle = draw.uniform(0.0..3.0);
                pixel += range.off * Vector2::new(angle.cos(), angle.sin());
            }
            Match {
                point_in_world: (camera_from_world.inverse() * Point3::from(point_in_camera))
                    .coords,
                pixel,
                covariance: factor * factor.transpose(),
            }
        });
        let matches = matches.collect();
        let threshold = draw.uniform(range.threshold[0]..range.threshold[1]);
        let mut case =
            Self { camera, camera_from_world, start: camera_from_world, matches, right, threshold };
        // So far off that the pixels move by one or two standard deviations: the weights at the
        // start are of all sizes.
        let away = case.deviations_per(&draw.normals::<6, 1>(), draw.uniform(1.0..2.0));
        case.start = se3::retract(&camera_from_world, &away);
        case
    }

    /// A twist along `direction` that moves the pixels by `deviations` in the root mean square.
    fn deviations_per(&self, direction: &Vector6<f64>, deviations: f64) -> Vector6<f64> {
        const SMALL: f64 = 1e-5;
        let moved = se3::retract(&self.camera_from_world, &(SMALL * direction));
        let (before, after) = (self.residuals(&self.camera_from_world), self.residuals(&moved));
        let moves = before.iter().zip(&after).zip(self.whiteners());
        let sum: f64 = moves.map(|((a, b), whitener)| (whitener * (b - a)).norm_squared()).sum();
        let rms = (sum / self.matches.len() as f64).sqrt() / SMALL;
        deviations / rms * direction
    }

    /// Residuals at a pose, predicted less measured, in pixels.
    fn residuals(&self, camera_from_world: &Isometry3<f64>) -> Vec<Vector2<f64>> {
        self.matches
            .iter()
            .map(|seen| {
                let point = camera_from_world * Point3::from(seen.point_in_world);
                pixel_of(&self.camera, &point.coords) - seen.pixel
            })
            .collect()
    }

    /// Weights at the start, by a function of the residual's length in standard deviations.
    fn weights(&self, weight: impl Fn(f64) -> f64) -> Vec<f64> {
        self.weights_of(|covariance, e| weight((whitener(covariance) * e).norm()))
    }

    /// Weights at the start, by a function of covariance and residual.
    fn weights_of(&self, weight: impl Fn(&Matrix2<f64>, &Vector2<f64>) -> f64) -> Vec<f64> {
        let residuals = self.residuals(&self.start);
        let pairs = self.matches.iter().zip(&residuals);
        pairs.map(|(seen, e)| weight(&seen.covariance, e)).collect()
    }

    /// What the weights would be under each wrong idea.
    fn wrong_weights(&self) -> Vec<(&'static Misconception, Vec<f64>)> {
        let k = self.threshold;
        let huber = Kernel::Huber(k);
        let beyond = move |s: f64, weight: f64| if s > k { weight } else { 1.0 };
        vec![
            (&UNWHITENED, self.weights_of(|_, e| huber.weight(e.norm()))),
            (
                &AXES_IGNORED,
                self.weights_of(|covariance, e| {
                    huber.weight(e.component_div(&covariance.diagonal().map(f64::sqrt)).norm())
                }),
            ),
            (&SQUARED_NORM, self.weights(|s| huber.weight(s * s))),
            (&SQUARED_NORM, self.weights(|s| beyond(s, k / (s * s)))),
            (&SQUARED_NORM, self.weights(|s| beyond(s, (k / s).powi(2)))),
            (
                &DEVIATIONS_MULTIPLIED,
                self.weights_of(|covariance, e| huber.weight((lower(covariance) * e).norm())),
            ),
            (
                &DEVIATIONS_MULTIPLIED,
                self.weights_of(|covariance, e| huber.weight(e.dot(&(covariance * e)).sqrt())),
            ),
            (&INFLUENCE, self.weights(|s| huber.influence(s))),
            (&HARD_REJECTION, self.weights(|s| beyond(s, 0.0))),
            (&ROOT_OF_WEIGHT, self.weights(|s| huber.weight(s).sqrt())),
        ]
    }

    /// The library's problem with this kernel; each match is whitened by a matrix of its own.
    fn problem(&self, whiteners: impl Iterator<Item = Matrix2<f64>>, kernel: Kernel) -> Posed {
        let mut problem = Problem::new();
        let pose = problem.add_variable(self.start);
        for (seen, whitener) in self.matches.iter().zip(whiteners) {
            let observation = Observation { pose, camera: self.camera, seen: *seen, whitener };
            // The kernels of the cases are valid and every observation is of the one variable.
            let _ = problem.add_factor(observation, kernel);
        }
        Posed { problem, pose }
    }

    fn whiteners(&self) -> impl Iterator<Item = Matrix2<f64>> {
        self.matches.iter().map(|seen| whitener(&seen.covariance))
    }

    /// Hessian and gradient at the start. Points of cases are in front of the camera, so they
    /// exist.
    fn system(&self, posed: &Posed) -> (Matrix6<f64>, Vector6<f64>) {
        posed.system_at(&self.start)
    }

    /// Hessian and gradient at the start with weights of any kind.
    fn weighted(&self, weights: &[f64]) -> (Matrix6<f64>, Vector6<f64>) {
        let rooted = self.whiteners().zip(weights).map(|(whitener, w)| w.sqrt() * whitener);
        self.system(&self.problem(rooted, Kernel::Squared))
    }

    /// The pose of least robust cost, or of least squares.
    fn best(&self, threshold: f64) -> Isometry3<f64> {
        let kernel = if threshold.is_finite() { Kernel::Huber(threshold) } else { Kernel::Squared };
        self.problem(self.whiteners(), kernel).solved()
    }
}

/// The library's problem of one pose.
struct Posed {
    problem: Problem,
    pose: Key<Isometry3<f64>>,
}

impl Posed {
    /// Hessian and gradient at a pose; zero where a point is behind the camera.
    fn system_at(&self, pose: &Isometry3<f64>) -> (Matrix6<f64>, Vector6<f64>) {
        let mut values = self.problem.values().clone();
        values.set(self.pose, *pose);
        match self.problem.linearize(&values) {
            Ok(system) => (
                Matrix6::from_iterator(system.hessian.iter().copied()),
                Vector6::from_iterator(system.gradient.iter().copied()),
            ),
            Err(_) => (Matrix6::zeros(), Vector6::zeros()),
        }
    }

    /// Where the library's solver ends.
    fn solved(&self) -> Isometry3<f64> {
        let options = Options {
            max_iterations: 500,
            gradient_tolerance: 1e-9,
            step_tolerance: 1e-9,
            decrease_tolerance: 0.0,
            ..Options::gauss_newton()
        };
        let nowhere = || Isometry3::translation(f64::NAN, f64::NAN, f64::NAN);
        let solution = self.problem.solve(&options);
        solution.map_or_else(|_| nowhere(), |solution| solution.values[self.pose])
    }
}

/// The solution ξ of H ξ = −g, and no number where there is none.
fn solution((hessian, gradient): (Matrix6<f64>, Vector6<f64>)) -> Vector6<f64> {
    hessian.lu().solve(&-gradient).unwrap_or_else(|| Vector6::repeat(f64::NAN))
}

/// The pixel of a point that is in front of the camera, as those of all cases are.
fn pixel_of(camera: &Camera, point_in_camera: &Vector3<f64>) -> Vector2<f64> {
    let pixel = camera.pinhole().project_cam(point_in_camera);
    pixel.unwrap_or_else(|| Vector2::repeat(f64::NAN))
}

/// What makes a residual of this covariance one of variance one: along each axis of the ellipse
/// its standard deviation is the unit.
fn whitener(covariance: &Matrix2<f64>) -> Matrix2<f64> {
    let axes = covariance.symmetric_eigen();
    let unit = axes.eigenvalues.map(|variance| 1.0 / variance.sqrt());
    Matrix2::from_diagonal(&unit) * axes.eigenvectors.transpose()
}

/// The lower triangular L of Σ = L Lᵀ.
fn lower(covariance: &Matrix2<f64>) -> Matrix2<f64> {
    covariance.cholesky().map_or_else(Matrix2::zeros, |factor| factor.l())
}

/// A match as a factor of the library, its derivative found by differences.
struct Observation {
    pose: Key<Isometry3<f64>>,
    camera: Camera,
    seen: Match,
    whitener: Matrix2<f64>,
}

impl Observation {
    fn error(&self, camera_from_world: &Isometry3<f64>) -> Option<Vector2<f64>> {
        let pixel = self.camera.pinhole().project(camera_from_world, &self.seen.point_in_world)?;
        Some(self.whitener * (pixel - self.seen.pixel))
    }

    fn slope(&self, camera_from_world: &Isometry3<f64>) -> Option<Matrix2x6<f64>> {
        const H: f64 = 1e-3;
        let mut slope = Matrix2x6::zeros();
        for axis in 0..6 {
            let moved = |step: f64| {
                let mut xi = Vector6::zeros();
                xi[axis] = step;
                self.error(&se3::retract(camera_from_world, &xi))
            };
            let (near, far) = (moved(H)? - moved(-H)?, moved(2.0 * H)? - moved(-2.0 * H)?);
            slope.set_column(axis, &((8.0 * near - far) / (12.0 * H)));
        }
        Some(slope)
    }
}

impl Factor<2> for Observation {
    type Variables = (Isometry3<f64>,);
    type Jacobians = (Matrix2x6<f64>,);

    fn variables(&self) -> (Key<Isometry3<f64>>,) {
        (self.pose,)
    }

    fn residual(&self, (pose,): (&Isometry3<f64>,)) -> Option<Vector2<f64>> {
        self.error(pose)
    }

    fn linearize(&self, (pose,): (&Isometry3<f64>,)) -> Option<(Vector2<f64>, (Matrix2x6<f64>,))> {
        Some((self.error(pose)?, (self.slope(pose)?,)))
    }
}

const TWIST: [&str; 6] = ["rho x", "rho y", "rho z", "phi x", "phi y", "phi z"];

/// The instances that students have.
fn cases() -> Vec<Case> {
    let mut draw = Draw::new(9);
    (0..5).map(|_| Case::drawn(&mut draw, PUBLIC)).collect()
}

fn checks() -> Vec<Check> {
    vec![
        Check::new("weights_count_standard_deviations_and_not_pixels", |answer| {
            cases().iter().try_for_each(|case| weights(answer, case))
        }),
        Check::new("a_step_makes_the_weighted_squares_least", |answer| {
            cases().iter().try_for_each(|case| step(answer, case))
        }),
        Check::new("the_search_ends_where_the_robust_cost_is_least", |answer| {
            cases().iter().try_for_each(|case| pose(answer, case))
        }),
        Check::new("the_rmse_is_of_coordinates_of_right_matches", |answer| {
            cases().iter().try_for_each(|case| rmse(answer, case))
        }),
        Check::new("the_rescue_brings_right_matches_nearer", |answer| {
            cases().iter().try_for_each(|case| rescue(answer, case))
        }),
    ]
}

/// The weights of all residuals at the start, and of none at all.
///
/// # Errors
///
/// A failure, which names what the weights are instead where that is known.
pub fn weights(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let residuals = case.residuals(&case.start);
    let ask = |threshold: f64| -> Result<Vec<f64>, Failure> {
        let pairs = case.matches.iter().zip(&residuals);
        let weight = |(seen, residual): (&Match, &Vector2<f64>)| {
            Ok(Answer(answer).huber_weight(residual, &seen.covariance, &threshold)?)
        };
        pairs.map(weight).collect()
    };
    let obtained = ask(case.threshold)?;
    let kernel = Kernel::Huber(case.threshold);
    let expected = case.weights(|s| kernel.weight(s));
    let wrong = case.wrong_weights();
    let lengths = case.weights(|s| s);
    let labels: Vec<String> = lengths.iter().map(|s| format!("s = {s:.2}")).collect();
    let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
    let comparison =
        compare_list("the list of weights", &obtained, &expected).labelled(&labels, &["weight"]);
    let judge = |comparison: Comparison| comparison.within(1e-7).judge();
    judge(wrong.iter().fold(comparison, |comparison, (misconception, weights)| {
        comparison.or_list(misconception, weights)
    }))?;
    let ones = vec![1.0; obtained.len()];
    judge(compare_list(
        "the list of weights with an infinite threshold",
        &ask(f64::INFINITY)?,
        &ones,
    ))?;
    let covariance = Matrix2::identity();
    let still = Answer(answer).huber_weight(&Vector2::zeros(), &covariance, &case.threshold)?;
    judge(compare_number("the weight of a residual of zero", still, 1.0))
}

/// One step from the start.
///
/// # Errors
///
/// A failure, which names what the step is instead where that is known.
pub fn step(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { camera, start, matches, threshold, .. } = case;
    let obtained = Answer(answer).robust_step(camera, start, matches, threshold)?;
    let kernel = Kernel::Huber(*threshold);
    let system = case.system(&case.problem(case.whiteners(), kernel));
    let expected = solution(system);
    let weights = case.weights(|s| kernel.weight(s));
    let changed = |change: fn(f64) -> f64| -> Vec<f64> {
        weights.iter().map(|weight| change(*weight)).collect()
    };
    let (plain, unweighted) = case.weighted(&changed(|_| 1.0));
    let (_, rooted) = case.weighted(&changed(f64::sqrt));
    let in_pixels = weights.iter().map(|weight| weight.sqrt() * Matrix2::identity());
    let in_pixels = case.system(&case.problem(in_pixels, Kernel::Squared));
    let multiplied = |by: fn(&Matrix2<f64>) -> Matrix2<f64>| {
        let factors = matches.iter().map(|seen| by(&seen.covariance));
        solution(case.system(&case.problem(factors, kernel)))
    };
    let mut comparison = compare("the step", &obtained, &expected)
        .within(1e-6)
        .labelled(&TWIST, &[])
        .or(&WEIGHT_TWICE, &solution(case.weighted(&changed(|weight| weight * weight))))
        .or(&RESIDUAL_ALONE, &solution((plain, system.1)))
        .or(&RESIDUAL_ALONE, &solution((plain, rooted)))
        .or(&MATRIX_ALONE, &solution((system.0, unweighted)))
        .or(&DEVIATIONS_MULTIPLIED, &multiplied(lower))
        .or(&DEVIATIONS_MULTIPLIED, &multiplied(|covariance| lower(covariance).transpose()))
        .or(&ROWS_IN_PIXELS, &solution(in_pixels))
        .or(&UPHILL, &-expected)
        .or(&LEFT_TWIST, &(se3::adjoint(start) * expected));
    for (misconception, weights) in case.wrong_weights() {
        comparison = comparison.or(misconception, &solution(case.weighted(&weights)));
    }
    comparison
        .judge()
        .map_err(|failure| failure.unless("huber_weight", || self::weights(answer, case)))
}

/// The pose that the search finds. Steps that lead astray end where points lie behind the camera,
/// and there many an answer panics.
fn search(answer: &dyn Transport, case: &Case, threshold: f64) -> Result<Isometry3<f64>, Failure> {
    let Case { camera, start, matches, .. } = case;
    Answer(answer).robust_pose(camera, start, matches, &threshold).map_err(|fault| {
        let said = fault.to_string();
        match fault {
            Fault::Panicked { .. } if step(answer, case).is_ok() => Failure::new(
                "The search panicked, and one step from the start is right. Steps that are applied \
                 wrongly lead to where points lie behind the camera: on which side of the pose, and \
                 with which sign, does your search apply them?",
            )
            .with_numbers(said),
            Fault::Panicked { .. } => Failure::new(
                "The search panicked, and one step from the start is wrong already: see to \
                 `robust_step` first.",
            )
            .with_numbers(said),
            fault => fault.into(),
        }
    })
}

/// Where the search ends, with the threshold and without one.
///
/// # Errors
///
/// A failure, which names where it ended instead where that is known.
pub fn pose(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { start, threshold, .. } = case;
    let rows = |pose: &Isometry3<f64>| pose.to_homogeneous().fixed_rows::<3>(0).into_owned();
    let kernel = Kernel::Huber(*threshold);
    let first = solution(case.system(&case.problem(case.whiteners(), kernel)));
    let weights = case.weights(|s| kernel.weight(s));
    let frozen = case.whiteners().zip(&weights).map(|(whitener, w)| w.sqrt() * whitener);
    let frozen = case.problem(frozen, Kernel::Squared).solved();
    let expected = case.best(*threshold);
    let obtained = search(answer, case, *threshold)?;
    compare("the pose", &rows(&obtained), &rows(&expected))
        .within(1e-7)
        .labelled(&["x", "y", "z"], &["R", "", "", "t"])
        .or(&ONE_STEP, &rows(&se3::retract(start, &first)))
        .or(&FROZEN_WEIGHTS, &rows(&frozen))
        .judge()
        .map_err(|failure| {
            case.told(failure, &obtained).unless("robust_step", || step(answer, case))
        })?;
    let plain = search(answer, case, f64::INFINITY)?;
    compare("the pose of least squares", &rows(&plain), &rows(&case.best(f64::INFINITY)))
        .within(1e-7)
        .labelled(&["x", "y", "z"], &["R", "", "", "t"])
        .judge()
}

impl Case {
    /// A failure with a picture of the pose, and how far from its end the search is, where nothing
    /// else is known of it.
    fn told(&self, failure: Failure, obtained: &Isometry3<f64>) -> Failure {
        let failure = failure.with_picture(self.picture(&self.best(self.threshold), obtained));
        let problem = self.problem(self.whiteners(), Kernel::Huber(self.threshold));
        let next = solution(problem.system_at(obtained)).norm();
        let finite = obtained.to_homogeneous().iter().all(|entry| entry.is_finite());
        if failure.misconception.is_some() || !finite {
            return failure;
        }
        let next = match next {
            _ if next.is_finite() => format!("a twist of length {}", readable(next)),
            _ => "no number at all, since points lie behind the camera".to_owned(),
        };
        let sentence = format!(
            "The sum of Huber's costs is not least at this pose: one more step from it would be \
             {next}. When does your search end, and on which side of the pose does it \
             apply each step?"
        );
        Failure { sentence, ..failure }
    }

    /// Where two poses predict the right matches.
    fn picture(&self, expected: &Isometry3<f64>, obtained: &Isometry3<f64>) -> Picture {
        let seen = |name: &str, pose: &Isometry3<f64>| {
            let residuals = self.residuals(pose);
            let pairs = residuals.iter().zip(&self.matches).zip(&self.right);
            let right = pairs.filter(|(_, right)| **right);
            Dots::new(name, right.map(|((residual, seen), _)| (residual + seen.pixel).into()))
        };
        Picture {
            title: "Where the pose predicts the right matches".to_owned(),
            axes: ["u, px".to_owned(), "v, px".to_owned()],
            expected: seen("expected", expected),
            obtained: seen("obtained", obtained),
            downward: true,
        }
    }

    /// Squares of the residuals at a pose, by match: in pixels and in standard deviations.
    fn squares(&self, pose: &Isometry3<f64>) -> Vec<[f64; 2]> {
        let pairs = self.residuals(pose).into_iter().zip(self.whiteners());
        pairs.map(|(e, whitener)| [e.norm_squared(), (whitener * e).norm_squared()]).collect()
    }

    /// The root of the mean square of coordinates of the right matches, in pixels.
    fn rmse(&self, pose: &Isometry3<f64>) -> f64 {
        let squares = self.squares(pose);
        let right = squares.iter().zip(&self.right).filter(|(_, right)| **right);
        let (sum, count) =
            right.fold((0.0, 0.0), |(sum, n), (square, _)| (sum + square[0], n + 2.0));
        f64::sqrt(sum / count)
    }
}

/// The RMSE at the start.
///
/// # Errors
///
/// A failure, which names what was averaged instead where that is known.
pub fn rmse(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { camera, start, matches, right, .. } = case;
    let obtained = Answer(answer).rmse_of_right(camera, start, matches, right)?;
    let (squares, expected) = (case.squares(start), case.rmse(start));
    let mean = |kind: usize, keep: &dyn Fn(bool) -> bool| {
        let kept = squares.iter().zip(right).filter(|(_, right)| keep(**right));
        let squares: Vec<f64> = kept.map(|(square, _)| square[kind]).collect();
        (squares.iter().sum::<f64>() / (2 * squares.len()) as f64).sqrt()
    };
    let all = mean(0, &|_| true);
    compare_number("the RMSE", obtained, expected)
        .within(1e-9)
        .labelled(&["px"], &[])
        .or_number(&RMSE_OVER_ALL, all)
        .or_number(&RMSE_OVER_ALL, 2.0_f64.sqrt() * all)
        .or_number(&RMSE_PER_MATCH, 2.0_f64.sqrt() * expected)
        .or_number(&MEAN_SQUARE, expected * expected)
        .or_number(&RMSE_WHITENED, mean(1, &|right| right))
        .judge()
}

/// The RMSE of right matches before the rescue, with least squares, and after it.
///
/// # Errors
///
/// A failure when one of them is not what it should be.
pub fn rescue(answer: &dyn Transport, case: &Case) -> Result<(), Failure> {
    let Case { camera, matches, right, threshold, .. } = case;
    let ask = |threshold: f64| -> Result<f64, Failure> {
        let pose = search(answer, case, threshold)?;
        Ok(Answer(answer).rmse_of_right(camera, &pose, matches, right)?)
    };
    let obtained = [ask(f64::INFINITY)?, ask(*threshold)?];
    let expected = [f64::INFINITY, *threshold].map(|k| case.rmse(&case.best(k)));
    compare_list("the RMSE of right matches", &obtained, &expected)
        .within(1e-7)
        .labelled(&["squares", "Huber"], &["px"])
        .judge()
        .map_err(|failure| {
            let failure = failure.unless("rmse_of_right", || rmse(answer, case));
            failure.unless("robust_pose", || pose(answer, case))
        })?;
    if obtained[1] < obtained[0] {
        return Ok(());
    }
    Err(Failure::new("With the threshold the right matches should fit better than without one."))
}
