//! What an optimizer does whose Jacobian was derived for one convention and whose retraction
//! belongs to the other.

use std::sync::LazyLock;

use nalgebra::{Isometry3, Matrix2x3, Matrix2x6, Rotation3, Vector2, Vector3};
use vislam::least_squares::{Factor, Kernel, Key, Options, Problem, Solution, Values};
use vislam::manifold::{se3, so3};
use vislam::reprojection::{LinearizedReproj, Pinhole, ReprojFactor};

use crate::least_squares::worked::unstopped;
use crate::manifold::oracle::twist_of;
use crate::random::Random;
use crate::scene::Ring;

/// Cameras that stay where they are: two, so that the scale is fixed as well.
const PINNED: [usize; 2] = [0, 4];

/// For which perturbation the pose block was derived. The step is always taken on the right.
#[derive(Clone, Copy, PartialEq)]
pub enum Convention {
    /// The right one.
    Consistent,
    /// The left one.
    Mixed,
    /// The right one with the left one's skew matrix.
    SkewOnly,
}

struct Observation {
    pose: Key<Isometry3<f64>>,
    point: Key<Vector3<f64>>,
    camera: Pinhole,
    factor: ReprojFactor,
    convention: Convention,
}

impl Factor<2> for Observation {
    type Variables = (Isometry3<f64>, Vector3<f64>);
    type Jacobians = (Matrix2x6<f64>, Matrix2x3<f64>);

    fn variables(&self) -> (Key<Isometry3<f64>>, Key<Vector3<f64>>) {
        (self.pose, self.point)
    }

    fn residual(&self, values: (&Isometry3<f64>, &Vector3<f64>)) -> Option<Vector2<f64>> {
        self.linearize(values).map(|(residual, _)| residual)
    }

    fn linearize(
        &self,
        (pose, point): (&Isometry3<f64>, &Vector3<f64>),
    ) -> Option<(Vector2<f64>, Self::Jacobians)> {
        let predicted = self.camera.project_with_jacobians(pose, point)?;
        let linearized = self.factor.linearize(&predicted);
        let by_pose = self.convention.pose_block(&linearized, pose, point);
        Some((linearized.residual, (by_pose, linearized.by_point)))
    }
}

impl Convention {
    // ANCHOR: mixed_block
    /// The pose block that an optimizer of this convention works with.
    fn pose_block(
        self,
        factor: &LinearizedReproj,
        pose: &Isometry3<f64>,
        point: &Vector3<f64>,
    ) -> Matrix2x6<f64> {
        match self {
            Self::Consistent => factor.by_pose,
            Self::Mixed => factor.by_pose * se3::adjoint(&pose.inverse()),
            Self::SkewOnly => with_skew_of_point_in_camera(factor, pose, point),
        }
    }
    // ANCHOR_END: mixed_block
}

/// The pose block whose skew matrix is that of the point in the camera, all else as it was.
fn with_skew_of_point_in_camera(
    factor: &LinearizedReproj,
    pose: &Isometry3<f64>,
    point: &Vector3<f64>,
) -> Matrix2x6<f64> {
    let in_camera = pose.transform_point(&(*point).into()).coords;
    let mut block = factor.by_pose;
    let turn = -factor.by_point * so3::hat(&in_camera);
    block.fixed_columns_mut::<3>(3).copy_from(&turn);
    block
}

/// A ring with a place to begin.
pub struct Experiment {
    pub ring: Ring,
    start: Values,
}

impl Experiment {
    /// The ring with this noise in pixels, in a world frame from which a free camera is turned by
    /// `largest_angle` degrees and none by more. It begins `off` metres and radians from the
    /// truth.
    pub fn new(noise: f64, largest_angle: f64, off: f64) -> Self {
        let ring = turned_by(&Ring::new(noise), largest_angle.to_radians());
        let mut random = Random::new(42);
        let poses = ring.poses.iter().enumerate().map(|(index, pose)| {
            let xi = twist_of(&random.direction(off), &random.direction(0.3 * off));
            if PINNED.contains(&index) { *pose } else { se3::retract(pose, &xi) }
        });
        let mut random = Random::new(43);
        let points = ring.points.iter().map(|point| point + random.direction(off));
        let start = values(poses, points);
        Self { ring, start }
    }

    /// The values without any error.
    pub fn truth(&self) -> Values {
        values(self.ring.poses.iter().copied(), self.ring.points.iter().copied())
    }

    fn problem(&self, convention: Convention) -> Problem {
        let mut problem = Problem::new();
        let poses = self.start.of_kind::<Isometry3<f64>>().iter();
        let poses: Vec<_> = poses.map(|pose| problem.add_variable(*pose)).collect();
        let points = self.start.of_kind::<Vector3<f64>>().iter();
        let points: Vec<_> = points.map(|point| problem.add_variable(*point)).collect();
        for pinned in PINNED {
            problem.hold(poses[pinned]).expect("it was added");
        }
        for factor in &self.ring.factors {
            let (pose, point) = (poses[factor.keyframe], points[factor.point]);
            let camera = self.ring.camera;
            let observation = Observation { pose, point, camera, factor: *factor, convention };
            problem.add_factor(observation, Kernel::Squared).expect("its variables were added");
        }
        problem
    }

    /// What the library's solver makes of it.
    pub fn solve(&self, convention: Convention, options: &Options) -> Solution {
        let solved = self.problem(convention).solve(options);
        solved.expect("the start is sound and two cameras are pinned")
    }

    /// So many Gauss-Newton steps.
    pub fn run(&self, convention: Convention, steps: usize) -> Solution {
        self.solve(convention, &unstopped(steps))
    }

    /// The minimum of the cost, to rounding.
    pub fn optimum(&self) -> Values {
        self.run(Convention::Consistent, 20).values
    }

    /// Distances from `reference` of the free cameras together, in metres and radians, before
    /// every one of so many Gauss-Newton steps and after the last; fewer when one has failed.
    pub fn errors(&self, convention: Convention, reference: &Values, steps: usize) -> Vec<f64> {
        let problem = self.problem(convention);
        let columns = problem.columns();
        let mut values = self.start.clone();
        let mut step = vec![0.0; values.dimension()];
        let mut errors = vec![distance(&values, reference)];
        for _ in 0..steps {
            let system = problem.linearize(&values).ok();
            let Some(solved) = system.and_then(|system| system.step(0.0)) else { break };
            columns.spread(solved.step.as_slice(), &mut step);
            values = values.retract(&step);
            errors.push(distance(&values, reference));
        }
        errors
    }

    /// Root of the mean squared distance between a measured pixel and the predicted one.
    fn rmse(&self, solution: &Solution) -> f64 {
        (2.0 * solution.report.cost / self.ring.factors.len() as f64).sqrt()
    }
}

/// Poses, and then points.
fn values(
    poses: impl Iterator<Item = Isometry3<f64>>,
    points: impl Iterator<Item = Vector3<f64>>,
) -> Values {
    let mut values = Values::new();
    for pose in poses {
        values.add(pose);
    }
    for point in points {
        values.add(point);
    }
    values
}

/// The poses of both, camera by camera.
fn pairs<'a>(
    values: &'a Values,
    reference: &'a Values,
) -> impl Iterator<Item = (&'a Isometry3<f64>, &'a Isometry3<f64>)> {
    values.of_kind().iter().zip(reference.of_kind())
}

/// Metres between the centre of a camera and its centre in `reference`, the largest.
pub fn largest_shift(values: &Values, reference: &Values) -> f64 {
    let centre = |pose: &Isometry3<f64>| pose.inverse().translation.vector;
    let shift = |(pose, other)| (centre(pose) - centre(other)).norm();
    pairs(values, reference).map(shift).fold(0.0, f64::max)
}

/// Distance of all cameras together from those of `reference`, in metres and radians.
fn distance(values: &Values, reference: &Values) -> f64 {
    let squared = |(pose, other)| se3::local(other, pose).norm_squared();
    pairs(values, reference).map(squared).sum::<f64>().sqrt()
}

/// The largest angle by which a camera that is not pinned is turned from the world.
pub fn largest_angle(ring: &Ring) -> f64 {
    let free = ring.poses.iter().enumerate().filter(|(index, _)| !PINNED.contains(index));
    free.map(|(_, pose)| pose.rotation.angle()).fold(0.0, f64::max)
}

/// The ring in a world frame that is turned about its x axis so far that the largest angle of a
/// free camera is `angle`.
fn turned_by(ring: &Ring, angle: f64) -> Ring {
    let turned = |by: f64| ring.in_world(&Rotation3::new(by * Vector3::x()));
    let (mut low, mut high) = (0.0, std::f64::consts::PI - largest_angle(ring));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if largest_angle(&turned(middle)) < angle {
            low = middle;
        } else {
            high = middle;
        }
    }
    turned(high)
}

/// The factor by which the error of the mixed optimizer shrinks in a Gauss-Newton step, the mean
/// over the second half of a run that begins close to the optimum of noiseless data.
pub fn measured_rate(largest_angle: f64) -> f64 {
    let experiment = Experiment::new(0.0, largest_angle, 1e-6);
    let errors = experiment.errors(Convention::Mixed, &experiment.truth(), 28);
    // Below this the error is made of rounding.
    let last = errors.iter().rposition(|error| *error > 1e-12).unwrap_or(0);
    let middle = last / 2;
    (errors[last] / errors[middle]).powf(1.0 / (last - middle) as f64)
}

/// What Levenberg-Marquardt made of the ring with a pixel of noise.
pub struct Outcome {
    pub iterations: usize,
    pub rmse: f64,
    /// The length of the true gradient in units of its own noise, whatever convention led there.
    pub gradient_norm: f64,
    /// Metres between a camera's centre and its centre at the optimum, the largest.
    pub distance: f64,
}

/// Runs Levenberg-Marquardt from a tenth of a metre away.
pub fn outcome(noise: f64, largest_angle: f64, convention: Convention) -> Outcome {
    let experiment = Experiment::new(noise, largest_angle, FAR_START);
    let options = Options { max_iterations: 600, ..Options::default() };
    let solution = experiment.solve(convention, &options);
    let truly = experiment.problem(Convention::Consistent).linearize(&solution.values);
    Outcome {
        iterations: solution.report.iterations.len(),
        rmse: experiment.rmse(&solution),
        gradient_norm: truly.map_or(f64::NAN, |system| system.gradient_norm()),
        distance: largest_shift(&solution.values, &experiment.optimum()),
    }
}

/// How far from the truth the runs that a reader sees begin, in metres; a third of it in radians.
pub const FAR_START: f64 = 0.1;

/// Angles at which the rate is measured, in degrees.
pub const RATE_ANGLES: [f64; 8] = [14.1, 25.0, 40.0, 50.0, 55.0, 65.0, 70.0, 80.0];

/// Angles at which Levenberg-Marquardt is tried, in degrees.
pub const OUTCOME_ANGLES: [f64; 8] = [14.1, 30.0, 50.0, 75.0, 80.0, 90.0, 100.0, 120.0];

/// The measured rates.
pub static RATES: LazyLock<[f64; 8]> = LazyLock::new(|| RATE_ANGLES.map(measured_rate));

/// What the mixed Levenberg-Marquardt made of a pixel of noise at each angle.
pub static OUTCOMES: LazyLock<[Outcome; 8]> =
    LazyLock::new(|| OUTCOME_ANGLES.map(|angle| outcome(1.0, angle, Convention::Mixed)));

/// What one convention makes of a pixel of noise at the angle of the stall.
pub static CONSISTENT: LazyLock<Outcome> =
    LazyLock::new(|| outcome(1.0, OUTCOME_ANGLES[4], Convention::Consistent));

/// What mixed conventions make of data without noise.
pub static NOISELESS: LazyLock<Outcome> =
    LazyLock::new(|| outcome(0.0, OUTCOME_ANGLES[4], Convention::Mixed));

/// Where the wrong skew matrix leads at the first and the last of [`RATE_ANGLES`] below the stall:
/// the largest shift of a camera from the optimum in metres, and the RMSE in pixels.
pub static SKEWED: LazyLock<[(f64, f64); 2]> = LazyLock::new(|| {
    [RATE_ANGLES[0], RATE_ANGLES[6]].map(|angle| {
        let experiment = Experiment::new(1.0, angle, FAR_START);
        let end = experiment.run(Convention::SkewOnly, 60);
        (largest_shift(&end.values, &experiment.optimum()), experiment.rmse(&end))
    })
});

/// The rate that the theory predicts for an angle in degrees.
pub fn predicted_rate(angle: f64) -> f64 {
    2.0 * (angle.to_radians() / 2.0).sin()
}
