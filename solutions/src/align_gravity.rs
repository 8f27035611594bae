//! Which way is down, at rest and in motion, and what stays unknown with it: the bias, the scale.

use exercise_spec::align_gravity::{Fit, Known, Solution, View};
use nalgebra::{
    DMatrix, Matrix2, Matrix2x3, Matrix3, Matrix3x6, Matrix6, MatrixXx3, Rotation3, Vector2,
    Vector3,
};
use vislam::manifold::so3;

/// The rotation that takes body coordinates to world coordinates, for a body at rest. The world's
/// third axis points up. `force` is the mean that the accelerometer reads, in the body and in
/// m/s²; its bias is not known and counts as zero. Seen from above, the body's first axis points
/// `heading` radians away from the world's first axis, towards the second one. The body's first axis
/// is never vertical. Otherwise the body may stand as it likes, upside down too.
pub fn level(force: Vector3<f64>, heading: f64) -> Rotation3<f64> {
    let up = force.normalize();
    let ahead = (Vector3::x() - up.x * up).normalize();
    let level_from_body =
        Matrix3::from_rows(&[ahead.transpose(), up.cross(&ahead).transpose(), up.transpose()]);
    Rotation3::new(heading * Vector3::z()) * Rotation3::from_matrix_unchecked(level_from_body)
}

/// The joint covariance of tilt and bias that a stand leaves, as in `Known`, to first order.
///
/// The body was leveled. Before the stand, the bias was zero on average and had on each axis of
/// the body a standard deviation of its own, `bias_sigma`, in m/s² and none of them zero; nothing
/// was known of the tilt. The mean force has noise of standard deviation `noise_sigma` on each
/// axis, in m/s², which may be zero. All of these are independent. The heading was chosen and
/// counts as exact, so φ has no part about the vertical. Gravity has a known size, in m/s²: the
/// direction of the mean force says something, and so does its length.
pub fn rest_covariance(
    world_from_body: Rotation3<f64>,
    bias_sigma: Vector3<f64>,
    noise_sigma: f64,
    gravity: f64,
) -> Matrix6<f64> {
    let up = world_from_body.inverse() * Vector3::z();
    let noise = noise_sigma * noise_sigma;
    let prior = Matrix3::from_diagonal(&bias_sigma.component_mul(&bias_sigma));
    // The length of the force says one number of the bias.
    let seen = prior * up;
    let bias = prior - seen * seen.transpose() / (up.dot(&seen) + noise);
    let tilt = so3::hat(&up) / gravity;
    let mut covariance = Matrix6::zeros();
    let mut put = |row, column, block: Matrix3<f64>| {
        covariance.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
    };
    put(0, 0, tilt * (bias + noise * Matrix3::identity()) * tilt.transpose());
    put(0, 3, tilt * bias);
    put(3, 0, bias * tilt.transpose());
    put(3, 3, bias);
    covariance
}

/// The most likely φ of the first stand, and the most likely bias, once the body has stood
/// a second time, to first order in what was not known. In between it was turned by a rotation
/// that is known exactly; `first_from_second` takes coordinates of the body as it stands now to
/// those of the body as it stood before. The bias belongs to the sensor and has stayed the
/// same. `force` is the new mean, in the body as it stands now, with new noise of standard
/// deviation `noise_sigma` on each axis, which is not zero.
pub fn second_stand(
    known: Known,
    first_from_second: Rotation3<f64>,
    force: Vector3<f64>,
    noise_sigma: f64,
    gravity: f64,
) -> (Vector3<f64>, Vector3<f64>) {
    let second_from_first = first_from_second.inverse();
    let up = known.world_from_body.inverse() * Vector3::z();
    let predicted = gravity * (second_from_first * up) + known.bias;
    let mut slopes = Matrix3x6::zeros();
    let by_tilt = gravity * second_from_first.matrix() * so3::hat(&up);
    slopes.fixed_view_mut::<3, 3>(0, 0).copy_from(&by_tilt);
    slopes.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
    let noise = noise_sigma * noise_sigma * Matrix3::identity();
    let spread = slopes * known.covariance * slopes.transpose() + noise;
    let off =
        spread.cholesky().map_or(Vector3::zeros(), |spread| spread.solve(&(force - predicted)));
    let step = known.covariance * slopes.transpose() * off;
    (step.fixed_rows::<3>(0).into_owned(), known.bias + step.fixed_rows::<3>(3))
}

/// Velocity and gravity that fit best when a unit of the motion is `scale` metres. The residual of
/// each view but the first is the left side of the book's equation less its right side,
///
/// scale (c − c₀) − t v − ½ t² g − A − (R − R₀) l,
///
/// where t, c₀ and R₀ are counted from and taken at the first view, A is the force integrated
/// twice, and l is the camera's place in the body, in metres (`lever`). What is noisy are the
/// centres alone, so each coordinate of it has a standard deviation of `scale` times the view's
/// `sigma`. The length of g is `gravity`, in m/s². There are five views or more, in the order of
/// time, and the scale is positive.
pub fn at_scale(views: Vec<View>, lever: Vector3<f64>, gravity: f64, scale: f64) -> Fit {
    Motion::of(&views, &lever, gravity).at(scale)
}

/// All scales that the views allow, the smallest first; none when the views do not say how large
/// the motion is.
///
/// A scale is a candidate where `squares` of `at_scale` is less than at all other scales near
/// it. The least of these squares is the best. A candidate is allowed when its squares are more
/// than that by `gate` at most. There are two allowed scales at the most.
///
/// The `sigma` of a solution is the standard deviation of its scale over the scale, to first
/// order: from the inverse of JᵀJ, where J holds the derivatives of the quotients, residual over
/// standard deviation (the scale is in both), by scale, velocity and two directions in which
/// gravity moves on its sphere. When that is more than `most` for any allowed scale, all are refused.
pub fn scales(
    views: Vec<View>,
    lever: Vector3<f64>,
    gravity: f64,
    most: f64,
    gate: f64,
) -> Vec<Solution> {
    let motion = Motion::of(&views, &lever, gravity);
    let valleys = motion.valleys();
    let best = valleys.iter().map(|scale| motion.at(*scale).squares).fold(f64::INFINITY, f64::min);
    let solution = |scale: f64| {
        let Fit { velocity, gravity, squares } = motion.at(scale);
        let sigma = motion.sigma(scale);
        (squares <= best + gate).then_some(Solution { scale, sigma, velocity, gravity })
    };
    let allowed: Vec<Solution> = valleys.into_iter().filter_map(solution).collect();
    let is_known = allowed.iter().all(|solution| solution.sigma <= most);
    if is_known { allowed } else { Vec::new() }
}

/// What pictures say of a motion, in its unit, and what forces and the lever say, in metres. Each is taken
/// apart into a velocity and an acceleration, in rows, and what these leave over, in standard deviations.
struct Motion {
    pictures: (Matrix2x3<f64>, MatrixXx3<f64>),
    forces: (Matrix2x3<f64>, MatrixXx3<f64>),
    /// How much the best velocity changes with the acceleration.
    trade: f64,
    /// What a unit of acceleration more costs while the velocity follows.
    stiffness: f64,
    gravity: f64,
}

impl Motion {
    fn of(views: &[View], lever: &Vector3<f64>, gravity: f64) -> Self {
        let (first, others) = (&views[0], &views[1..]);
        let times = |row: usize| {
            let t = others[row].seconds - first.seconds;
            Vector2::new(t, 0.5 * t * t) / others[row].sigma
        };
        let times = DMatrix::from_fn(others.len(), 2, |row, column| times(row)[column]);
        let normal: Matrix2<f64> = times.tr_mul(&times).fixed_view::<2, 2>(0, 0).into_owned();
        let inverse = normal.try_inverse().unwrap_or_default();
        let apart = |place: &dyn Fn(&View) -> Vector3<f64>| {
            let whitened = |row: usize, axis: usize| place(&others[row])[axis] / others[row].sigma;
            let places = DMatrix::from_fn(others.len(), 3, whitened);
            let fit = inverse * times.tr_mul(&places).fixed_view::<2, 3>(0, 0);
            let left = places - &times * fit;
            (fit, left)
        };
        let camera = |view: &View| view.motion_from_body * lever;
        let pictures = apart(&|view| view.centre - first.centre);
        let forces = apart(&|view| view.force_twice + camera(view) - camera(first));
        let trade = -normal[(0, 1)] / normal[(0, 0)];
        let stiffness = normal[(1, 1)] + trade * normal[(0, 1)];
        Self { pictures, forces, trade, stiffness, gravity }
    }

    fn at(&self, scale: f64) -> Fit {
        let fit = scale * self.pictures.0 - self.forces.0;
        let free = fit.row(1).transpose();
        let gravity = free * (self.gravity / free.norm());
        let velocity = fit.row(0).transpose() + self.trade * (gravity - free);
        let left = (scale * &self.pictures.1 - &self.forces.1).norm_squared();
        let squares = (self.stiffness * (gravity - free).norm_squared() + left) / (scale * scale);
        Fit { velocity, gravity, squares }
    }

    /// Half of the derivative of the squares by one over the scale.
    fn slope(&self, inverse: f64) -> f64 {
        let (felt, left) = (self.forces.0.row(1), &self.pictures.1 - inverse * &self.forces.1);
        let free = self.pictures.0.row(1) - inverse * felt;
        let longer = -free.dot(&felt) / free.norm() - self.gravity;
        self.stiffness * (free.norm() - inverse * self.gravity) * longer - left.dot(&self.forces.1)
    }

    /// Scales at which the squares are less than beside them, the smallest first.
    fn valleys(&self) -> Vec<f64> {
        let [seen, felt] = [&self.pictures, &self.forces].map(|(fit, _)| fit.row(1).norm());
        let inverse = |step: i32| seen / (felt + self.gravity) * 1.01f64.powi(step);
        let is_valley =
            |step: &i32| self.slope(inverse(*step)) < 0.0 && self.slope(inverse(*step + 1)) >= 0.0;
        let valley = |step: i32| {
            let (mut low, mut high) = (inverse(step), inverse(step + 1));
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                *(if self.slope(middle) < 0.0 { &mut low } else { &mut high }) = middle;
            }
            1.0 / high
        };
        (-1000..2000).rev().filter(is_valley).map(valley).collect()
    }

    /// The standard deviation of a scale, as a part of it.
    fn sigma(&self, scale: f64) -> f64 {
        let down = self.at(scale).gravity / self.gravity;
        let longer = self.forces.0.row(1).transpose().dot(&down) + self.gravity;
        scale / (self.stiffness * longer * longer + self.forces.1.norm_squared()).sqrt()
    }
}
