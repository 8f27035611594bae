//! Random tracks, and their rows as matrices.

use nalgebra::{DMatrix, DVector, Isometry3, Vector2, Vector3};
use vislam::inertial::BodyPose;
use vislam::least_squares::Manifold;
use vislam::msckf::{LinearizedTrack, Sight};
use vislam::reprojection::Pinhole;

use crate::random::Random;

/// The standard deviation of a pixel.
pub const SIGMA: f64 = 1.5;

/// How a track is drawn.
#[derive(Clone, Copy)]
pub struct Plan {
    pub sights: usize,
    /// How far apart the first and the last camera are, in metres; the landmark is five away.
    pub spread: f64,
    /// The standard deviation by which believed poses are off, in metres; in radians a tenth of it.
    pub off: f64,
    /// By how much the place of the landmark is off at which it is linearized, in metres.
    pub landmark_off: f64,
}

impl Plan {
    pub fn new(sights: usize) -> Self {
        Self { sights, spread: 2.0, off: 0.01, landmark_off: 0.05 }
    }

    /// Three to ten sights.
    pub fn any(random: &mut Random) -> Self {
        Self::new(3 + random.uniform(0.0..8.0) as usize)
    }
}

/// A track that was seen from poses that are not quite known.
pub struct Track {
    pub camera: Pinhole,
    pub rig: Isometry3<f64>,
    pub sights: Vec<Sight>,
    /// Where it is linearized.
    pub landmark: Vector3<f64>,
    pub true_poses: Vec<BodyPose>,
    pub true_landmark: Vector3<f64>,
}

impl Track {
    pub fn drawn(random: &mut Random, plan: Plan) -> Self {
        let camera = random.camera();
        let rig = Isometry3::from_parts(random.direction(0.1).into(), random.rotation(3.0).into());
        let base = Isometry3::from_parts(random.direction(3.0).into(), random.rotation(3.0).into());
        let true_landmark = base * nalgebra::Point3::new(0.4, -0.3, 5.0);
        let mut track = Self {
            camera,
            rig,
            sights: Vec::new(),
            landmark: true_landmark.coords + random.direction(plan.landmark_off),
            true_poses: Vec::new(),
            true_landmark: true_landmark.coords,
        };
        for k in 0..plan.sights {
            let along = k as f64 / (plan.sights - 1) as f64 - 0.5;
            let place = plan.spread * Vector3::new(along, 0.3 * along * along, 0.2 * along);
            let jitter = Isometry3::from_parts(place.into(), random.rotation(0.1).into());
            let world_from_camera = base * jitter;
            let body = world_from_camera * rig.inverse();
            let truth = BodyPose {
                world_from_body: body.rotation.to_rotation_matrix(),
                position: body.translation.vector,
            };
            let seen = camera.project(&world_from_camera.inverse(), &track.true_landmark);
            let noise = Vector2::from_fn(|_, _| random.normal(SIGMA));
            let pixel = seen.expect("the landmark is ahead") + noise;
            let off: [f64; 6] =
                std::array::from_fn(|axis| random.normal(if axis < 3 { 0.1 } else { 1.0 }));
            let pose = truth.retract(&off.map(|off| plan.off * off));
            track.sights.push(Sight { pose, linearized_at: pose, pixel });
            track.true_poses.push(truth);
        }
        track
    }

    /// Any track.
    pub fn any(random: &mut Random) -> Self {
        let plan = Plan::any(random);
        Self::drawn(random, plan)
    }

    /// Its rows as the library has them.
    pub fn linearized(&self) -> LinearizedTrack {
        let mut linearized = LinearizedTrack::default();
        let camera = (&self.camera, SIGMA);
        linearized
            .linearize(&self.sights, &self.landmark, &self.rig, camera)
            .expect("the landmark is ahead");
        linearized
    }

    /// The steps from believed poses to true ones.
    pub fn pose_errors(&self) -> DVector<f64> {
        let mut errors = DVector::zeros(6 * self.sights.len());
        for (k, (sight, truth)) in self.sights.iter().zip(&self.true_poses).enumerate() {
            sight.pose.local(truth, &mut errors.as_mut_slice()[6 * k..6 * k + 6]);
        }
        errors
    }
}

/// Rows of a track, without those of the camera's place on the body.
#[derive(Clone)]
pub struct Linear {
    pub by_landmark: DMatrix<f64>,
    pub by_poses: DMatrix<f64>,
    pub residual: DVector<f64>,
}

impl Linear {
    /// From one row on.
    pub fn of(track: &LinearizedTrack, from: usize) -> Self {
        let rows: Vec<&[f64]> = track.rows().from(from).collect();
        let width = track.rows().width();
        let part = |start: usize, end: usize| {
            DMatrix::from_fn(rows.len(), end - start, |row, column| rows[row][start + column])
        };
        let residual = DVector::from_fn(rows.len(), |row, _| rows[row][width - 1]);
        Self { by_landmark: part(0, 3), by_poses: part(3, width - 7), residual }
    }

    /// What the library leaves of a track when the landmark has gone, whatever its rank.
    pub fn projected(track: &LinearizedTrack) -> Self {
        let mut track = track.clone();
        // The refusal comes after the rotations.
        let _ = track.project(f64::INFINITY);
        Self::of(&track, 3)
    }
}

/// The covariance of poses that have some uncertainty of their own and more in common.
pub fn covariance(random: &mut Random, dimension: usize, sigma: f64) -> DMatrix<f64> {
    let root = DMatrix::from_fn(dimension + 4, dimension, |_, _| random.normal(sigma));
    root.tr_mul(&root)
}

/// The x for which ‖A x + b‖ is smallest, and the square of what is left.
pub fn least(a: &DMatrix<f64>, b: &DVector<f64>) -> (DVector<f64>, f64) {
    let qr = a.clone().qr();
    let mut turned = -b;
    qr.q_tr_mul(&mut turned);
    let columns = a.ncols();
    let mut x = turned.rows(0, columns).into_owned();
    let solved = qr.r().solve_upper_triangular_mut(&mut x);
    if !solved {
        x.fill(f64::NAN);
    }
    let left = turned.rows_range(columns..).norm_squared();
    (x, left)
}

/// The rows of a belief in poses, of a track, and of what is known of its landmark, to be made as
/// small as possible: first the poses' columns, then those of the landmark. One over the standard
/// deviation of the landmark is `prior`, and its mean lies `mean` from where it is linearized.
pub fn stacked(
    covariance: &DMatrix<f64>,
    linear: &Linear,
    (prior, mean): (f64, Vector3<f64>),
) -> (DMatrix<f64>, DVector<f64>) {
    let (poses, rows) = (covariance.nrows(), linear.residual.len());
    let root = covariance.clone().cholesky().expect("a covariance").l();
    let inverse = root.try_inverse().expect("a triangle");
    let mut a = DMatrix::zeros(poses + rows + 3, poses + 3);
    a.view_mut((0, 0), (poses, poses)).copy_from(&inverse);
    a.view_mut((poses, 0), (rows, poses)).copy_from(&linear.by_poses);
    a.view_mut((poses, poses), (rows, 3)).copy_from(&linear.by_landmark);
    a.view_mut((poses + rows, poses), (3, 3)).fill_diagonal(prior);
    let mut b = DVector::zeros(poses + rows + 3);
    b.rows_mut(poses, rows).copy_from(&linear.residual);
    b.rows_mut(poses + rows, 3).copy_from(&(-prior * mean));
    (a, b)
}

/// What is known of a landmark of which nothing is known: it is within a thousand kilometres.
pub fn nothing() -> (f64, Vector3<f64>) {
    (1e-6, Vector3::zeros())
}
