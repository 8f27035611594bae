//! Minima of the sum of squares, by damped Gauss-Newton steps on all unknowns from every direction of down.

use nalgebra::{DMatrix, DVector, Matrix3, Matrix3x2, Matrix6, Vector3, Vector6};

use super::super::View;

/// What one view says: a place in units of the motion, and how far forces alone have carried the camera.
struct Row {
    seconds: f64,
    centre: Vector3<f64>,
    carried: Vector3<f64>,
    sigma: f64,
}

/// In which unit a residual counts, and what is free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Free {
    /// All; residuals in units of the motion, where the noise is. One over the scale is the unknown.
    All,
    /// All but the scale.
    AtScale(f64),
    /// All; residuals in metres, as if the noise stayed what it is when the motion grows.
    InMetres,
}

/// Numbers to be found: the velocity, in the unit of the residuals over a second, gravity in m/s², and
/// one over the scale, or the scale.
#[derive(Debug, Clone, Copy)]
struct Unknowns {
    velocity: Vector3<f64>,
    gravity: Vector3<f64>,
    size: f64,
}

/// A place where the sum of squares is least among its neighbours.
#[derive(Debug, Clone, Copy)]
pub struct Minimum {
    /// Metres in a unit of the motion; may be negative.
    pub scale: f64,
    /// The standard deviation of the scale, as a part of its size. Infinite where nothing fixes it.
    pub sigma: f64,
    /// In m/s.
    pub velocity: Vector3<f64>,
    /// In m/s².
    pub gravity: Vector3<f64>,
    /// The sum of squares.
    pub squares: f64,
}

/// Which of the six coordinates of a step are which.
const VELOCITY_AND_SIZE: &[usize] = &[0, 1, 2, 5];
const ALL: &[usize] = &[0, 1, 2, 3, 4, 5];
const BUT_SIZE: &[usize] = &[0, 1, 2, 3, 4];

/// The equations of some views.
pub(super) struct Equations {
    rows: Vec<Row>,
    free: Free,
    gravity: f64,
}

impl Equations {
    pub(super) fn of(views: &[View], lever: &Vector3<f64>, gravity: f64, free: Free) -> Self {
        let first = &views[0];
        let camera = |view: &View| view.motion_from_body * lever;
        let row = |view: &View| Row {
            seconds: view.seconds - first.seconds,
            centre: view.centre - first.centre,
            carried: view.force_twice + camera(view) - camera(first),
            sigma: view.sigma,
        };
        Self { rows: views[1..].iter().map(row).collect(), free, gravity }
    }

    /// What the centre and what gravity and forces are multiplied by.
    fn factors(&self, at: &Unknowns) -> [f64; 2] {
        if self.free == Free::InMetres { [at.size, 1.0] } else { [1.0, at.size] }
    }

    fn squares(&self, at: &Unknowns) -> f64 {
        let [centre, carried] = self.factors(at);
        let square = |row: &Row| {
            let t = row.seconds;
            let moved = t * at.velocity + carried * (0.5 * t * t * at.gravity + row.carried);
            (centre * row.centre - moved).norm_squared() / (row.sigma * row.sigma)
        };
        self.rows.iter().map(square).sum()
    }

    /// JᵀJ and Jᵀr, for a step of the velocity, of gravity along two tangents of its sphere, and of the size.
    fn normal(&self, at: &Unknowns, tangents: &Matrix3x2<f64>) -> (Matrix6<f64>, Vector6<f64>) {
        let (mut normal, mut gradient) = (Matrix6::zeros(), Vector6::zeros());
        let [centre, carried] = self.factors(at);
        for row in &self.rows {
            let t = row.seconds;
            let pushed = 0.5 * t * t * at.gravity + row.carried;
            let residual = centre * row.centre - t * at.velocity - carried * pushed;
            let mut jacobian = nalgebra::Matrix3x6::zeros();
            jacobian.fixed_columns_mut::<3>(0).copy_from(&(-t * Matrix3::identity()));
            jacobian.fixed_columns_mut::<2>(3).copy_from(&(-0.5 * t * t * carried * tangents));
            let by_size = if self.free == Free::InMetres { row.centre } else { -pushed };
            jacobian.set_column(5, &by_size);
            let jacobian = jacobian / row.sigma;
            normal += jacobian.tr_mul(&jacobian);
            gradient += jacobian.tr_mul(&(residual / row.sigma));
        }
        (normal, gradient)
    }

    /// The unknowns after a step.
    fn stepped(&self, at: &Unknowns, tangents: &Matrix3x2<f64>, step: &Vector6<f64>) -> Unknowns {
        let gravity = at.gravity + tangents * step.fixed_rows::<2>(3);
        Unknowns {
            velocity: at.velocity + step.fixed_rows::<3>(0),
            gravity: gravity * (self.gravity / gravity.norm()),
            size: at.size + step[5],
        }
    }

    /// Steps from a direction of down until nothing changes; nothing if that does not come to an end.
    fn descend(&self, down: &Vector3<f64>) -> Option<Unknowns> {
        let size = if let Free::AtScale(scale) = self.free { 1.0 / scale } else { 0.0 };
        let gravity = down.normalize() * self.gravity;
        let mut at = Unknowns { velocity: Vector3::zeros(), gravity, size };
        let is_held = matches!(self.free, Free::AtScale(_));
        if !is_held {
            // With gravity held all is linear.
            let (normal, gradient) = self.normal(&at, &tangents(&gravity));
            let step = solved(&normal, &gradient, VELOCITY_AND_SIZE, 0.0)?;
            at = self.stepped(&at, &tangents(&gravity), &step);
        }
        let (mut damping, free) = (1e-4, if is_held { BUT_SIZE } else { ALL });
        let mut squares = self.squares(&at);
        for _ in 0..STEPS {
            let tangents = tangents(&at.gravity);
            let (normal, gradient) = self.normal(&at, &tangents);
            let step = solved(&normal, &gradient, free, damping)?;
            let next = self.stepped(&at, &tangents, &step);
            let found = self.squares(&next);
            if found > squares * (1.0 + 1e-13) {
                damping = (damping * 10.0).max(1e-8);
                if damping > 1e10 {
                    // No step leads farther down: all that is left is rounding.
                    return Some(at);
                }
                continue;
            }
            let turned = (next.gravity - at.gravity).norm() / self.gravity;
            let grown = (next.size - at.size).abs() / next.size.abs();
            (at, squares, damping) = (next, found, damping * 0.1);
            if damping < 1e-13 {
                damping = 0.0;
            }
            if turned < DONE && (is_held || grown < DONE) {
                return Some(at);
            }
        }
        None
    }

    fn minimum(&self, at: &Unknowns) -> Minimum {
        let (normal, _) = self.normal(at, &tangents(&at.gravity));
        let (scale, per_scale) = match self.free {
            Free::InMetres => (at.size, 1.0),
            _ => (1.0 / at.size, 1.0 / at.size),
        };
        let variance = last_variance(&normal).unwrap_or(f64::INFINITY);
        Minimum {
            scale,
            sigma: variance.sqrt() / at.size.abs(),
            velocity: per_scale * at.velocity,
            gravity: at.gravity,
            squares: self.squares(at),
        }
    }

    /// All minima, by scale.
    pub(super) fn minima(&self) -> Vec<Minimum> {
        let mut found: Vec<Minimum> = Vec::new();
        let grid = (0..27).map(|k| [k / 9, k / 3 % 3, k % 3].map(|place| place as f64 - 1.0));
        // At a held scale there is one minimum.
        let count = if matches!(self.free, Free::AtScale(_)) { 3 } else { 27 };
        for [x, y, z] in grid.take(count) {
            let down = Vector3::new(x, y + 0.1, z - 0.05);
            let Some(at) = self.descend(&down) else { continue };
            let minimum = self.minimum(&at);
            let is_new = |known: &Minimum| {
                let apart = (known.gravity - minimum.gravity).norm();
                let other = (known.scale - minimum.scale).abs() > SAME * known.scale.abs();
                apart > SAME * self.gravity || other
            };
            if found.iter().all(is_new) {
                found.push(minimum);
            }
        }
        found.sort_by(|a, b| a.scale.total_cmp(&b.scale));
        found
    }

    /// The scale, velocity and gravity with a gravity of any length, and the scale's standard deviation.
    pub(super) fn without_length(&self) -> Option<Minimum> {
        let (mut normal, mut gradient) = (DMatrix::zeros(7, 7), DVector::zeros(7));
        let held = match self.free {
            Free::AtScale(scale) => Some(1.0 / scale),
            _ => None,
        };
        for row in &self.rows {
            let t = row.seconds;
            let mut jacobian = DMatrix::zeros(3, 7);
            for axis in 0..3 {
                jacobian[(axis, axis)] = t;
                jacobian[(axis, 3 + axis)] = 0.5 * t * t;
            }
            let mut target = row.centre;
            match held {
                Some(size) => target -= size * row.carried,
                None => jacobian.set_column(6, &row.carried),
            }
            normal += jacobian.tr_mul(&jacobian) / row.sigma.powi(2);
            gradient += jacobian.tr_mul(&target) / row.sigma.powi(2);
        }
        if held.is_some() {
            normal[(6, 6)] = 1.0;
        }
        let inverse = normal.cholesky()?.inverse();
        let x = &inverse * gradient;
        let size = held.unwrap_or(x[6]);
        let part = |from| x.fixed_rows::<3>(from).into_owned() / size;
        let unknowns = Unknowns { velocity: size * part(0), gravity: part(3), size };
        Some(Minimum {
            scale: 1.0 / size,
            sigma: inverse[(6, 6)].sqrt() / size,
            velocity: part(0),
            gravity: part(3),
            squares: self.squares(&unknowns),
        })
    }

    /// The sum of squares of a velocity and gravity at the scale that is held.
    pub(super) fn squares_of(
        &self,
        scale: f64,
        velocity: &Vector3<f64>,
        gravity: &Vector3<f64>,
    ) -> f64 {
        let size = 1.0 / scale;
        self.squares(&Unknowns { velocity: size * velocity, gravity: *gravity, size })
    }
}

const STEPS: usize = 400;
/// A step that changes less than this part is the last one.
const DONE: f64 = 1e-11;
/// Minima that differ by less than this part are one.
const SAME: f64 = 1e-6;

/// Two directions across a vector.
fn tangents(vector: &Vector3<f64>) -> Matrix3x2<f64> {
    let least = Vector3::ith(vector.iamin(), 1.0);
    let first = vector.cross(&least).normalize();
    Matrix3x2::from_columns(&[first, vector.normalize().cross(&first)])
}

/// The damped step of some coordinates, each of them in a unit that makes its diagonal one.
fn solved(
    normal: &Matrix6<f64>,
    gradient: &Vector6<f64>,
    free: &[usize],
    damping: f64,
) -> Option<Vector6<f64>> {
    let unit = |k: usize| 1.0 / normal[(k, k)].sqrt().max(f64::MIN_POSITIVE.sqrt());
    let entry = |row: usize, column: usize| {
        let (a, b) = (free[row], free[column]);
        let diagonal = if row == column { damping + 1e-15 } else { 0.0 };
        normal[(a, b)] * unit(a) * unit(b) + diagonal
    };
    let matrix = DMatrix::from_fn(free.len(), free.len(), entry);
    let right = DVector::from_fn(free.len(), |row, _| -gradient[free[row]] * unit(free[row]));
    let solution = matrix.cholesky()?.solve(&right);
    let mut step = Vector6::zeros();
    for (value, at) in solution.iter().zip(free) {
        step[*at] = value * unit(*at);
    }
    step.iter().all(|value| value.is_finite()).then_some(step)
}

/// The last diagonal entry of the inverse of a positive matrix.
fn last_variance(normal: &Matrix6<f64>) -> Option<f64> {
    let unit = normal.diagonal().map(|square| 1.0 / square.sqrt());
    let scaled = Matrix6::from_diagonal(&unit) * normal * Matrix6::from_diagonal(&unit);
    let factor = scaled.cholesky()?;
    let variance = factor.inverse()[(5, 5)] * unit[5] * unit[5];
    variance.is_finite().then_some(variance)
}
