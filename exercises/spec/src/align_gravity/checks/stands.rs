//! Bodies that stand: once, and a second time in another attitude.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{
    DMatrix, DVector, Matrix3, Matrix3x6, Matrix6, Rotation3, SMatrix, Unit, Vector3, Vector6,
};

use super::*;

/// A body that stands somehow.
#[derive(Debug, Clone)]
pub struct Stand {
    world_from_body: Rotation3<f64>,
    /// The length of the mean force.
    force: f64,
    bias_sigma: Vector3<f64>,
    noise_sigma: f64,
    gravity: f64,
}

/// How a body is turned between two stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turn {
    /// Not at all.
    None,
    /// About the vertical.
    Around,
    /// About a level axis.
    Tipped,
    /// About any axis.
    Any,
}

/// A body that stands twice.
#[derive(Debug, Clone)]
pub struct Twice {
    stand: Stand,
    known: Known,
    first_from_second: Rotation3<f64>,
    force: Vector3<f64>,
}

/// A turn about the world's third axis.
fn heading_turn(heading: f64) -> Rotation3<f64> {
    Rotation3::new(heading * Vector3::z())
}

impl Stand {
    /// A body in any attitude but with its first axis upright.
    pub fn drawn(draw: &mut Draw) -> Self {
        let gravity = draw.uniform(8.0..11.0);
        let world_from_body = loop {
            let rotation = draw.rotation(0.3..PI);
            if (rotation * Vector3::x()).z.abs() < 0.9 {
                break rotation;
            }
        };
        let sigma = |draw: &mut Draw| 10f64.powf(draw.uniform(-2.0..-0.5));
        let bias_sigma = Vector3::new(sigma(draw), sigma(draw), sigma(draw));
        let is_silent = draw.index(0..4) == 0;
        let noise_sigma = if is_silent { 0.0 } else { draw.uniform(0.2..2.0) * bias_sigma.min() };
        let force = gravity + draw.uniform(-0.3..0.3);
        Self { world_from_body, force, bias_sigma, noise_sigma, gravity }
    }

    /// The vertical in the body.
    fn up(&self) -> Vector3<f64> {
        self.world_from_body.inverse() * Vector3::z()
    }

    fn heading(&self) -> f64 {
        let ahead = self.world_from_body * Vector3::x();
        ahead.y.atan2(ahead.x)
    }

    /// Attitudes of known mistakes.
    fn wrong_attitudes(&self) -> Vec<(&'static Misconception, Matrix3<f64>)> {
        let (right, turn) = (self.world_from_body, heading_turn(self.heading()));
        let without_heading = turn.inverse() * right;
        let ahead = turn * Vector3::x();
        let upside_down = Rotation3::from_axis_angle(&Unit::new_unchecked(ahead), PI);
        let around_first = Rotation3::new(PI * Vector3::x());
        let least = Rotation3::rotation_between(&self.up(), &Vector3::z()).unwrap_or(right);
        let rolled = right * around_first;
        let is_upside_down = self.up().z < 0.0;
        let mut wrong = vec![
            (&FORCE_POINTS_DOWN, upside_down * right),
            (&TRANSPOSED, right.inverse()),
            (&TRANSPOSED, turn * without_heading.inverse()),
            (&HEADING_IN_BODY, without_heading * turn),
            (&LEAST_ROTATION, turn * least),
        ];
        if is_upside_down {
            wrong.push((&UPRIGHT_ALWAYS, rolled));
        }
        wrong.into_iter().map(|(name, rotation)| (name, rotation.into_inner())).collect()
    }

    /// What the six independent parts of bias and noise, in standard deviations, do to tilt and
    /// bias: one column each, by leveling with a little more force to one side and to the other. What would
    /// change the length of the force has been seen, and is taken out.
    fn parts(&self) -> Matrix6<f64> {
        let up = self.up();
        let (sigma, noise) = (self.bias_sigma, self.noise_sigma);
        let seen: Vector6<f64> = Vector6::new(
            sigma.x * up.x,
            sigma.y * up.y,
            sigma.z * up.z,
            noise * up.x,
            noise * up.y,
            noise * up.z,
        )
        .normalize();
        let column = |k: usize| {
            let luck = Vector6::ith(k, 1.0) - seen[k] * seen;
            let bias = sigma.component_mul(&luck.fixed_rows::<3>(0).into_owned());
            let tilt = self.tilt_by(&(bias + noise * luck.fixed_rows::<3>(3)));
            Vector6::from_iterator(tilt.iter().chain(bias.iter()).copied())
        };
        let columns: Vec<Vector6<f64>> = (0..6).map(column).collect();
        Matrix6::from_columns(&columns)
    }

    /// How a small force more tilts the body, per size of that force: differences of the fourth order.
    fn tilt_by(&self, force: &Vector3<f64>) -> Vector3<f64> {
        let up = self.up();
        let size = force.norm();
        if size == 0.0 {
            return Vector3::zeros();
        }
        let tilt = |step: f64| {
            let measured = self.gravity * (up + step / size * force);
            let axis = up.cross(&measured);
            axis * (axis.norm().atan2(up.dot(&measured)) / axis.norm().max(f64::MIN_POSITIVE))
        };
        let h = 1e-3;
        let slope = (8.0 * (tilt(h) - tilt(-h)) - (tilt(2.0 * h) - tilt(-2.0 * h))) / (12.0 * h);
        slope * size / self.gravity
    }

    fn covariance(&self) -> Matrix6<f64> {
        let parts = self.parts();
        parts * parts.transpose()
    }

    /// Covariances of known mistakes.
    fn wrong_covariances(&self) -> Vec<(&'static Misconception, Matrix6<f64>)> {
        let right = self.covariance();
        let (up, g) = (self.up(), self.gravity);
        // Tilt and bias, each in another unit or frame.
        let changed = |tilt: Matrix3<f64>, cross: f64| {
            let mut covariance = right;
            let mut put = |row, column, block: Matrix3<f64>| {
                covariance.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
            };
            let block = |row, column| right.fixed_view::<3, 3>(row, column).into_owned();
            put(0, 0, tilt * block(0, 0) * tilt.transpose());
            put(0, 3, cross * tilt * block(0, 3));
            put(3, 0, cross * block(3, 0) * tilt.transpose());
            covariance
        };
        let one = Matrix3::identity();
        let roots = Self {
            bias_sigma: self.bias_sigma.map(f64::sqrt),
            noise_sigma: self.noise_sigma.sqrt(),
            ..self.clone()
        };
        // The covariance of a bias that is spread in some way across and along the vertical.
        let with = |bias: Matrix3<f64>| {
            let slopes: Matrix3<f64> =
                Matrix3::from_columns(&[0, 1, 2].map(|k| self.tilt_by(&Vector3::ith(k, 1.0))));
            let mut covariance = Matrix6::zeros();
            let noise = self.noise_sigma.powi(2) * one;
            let mut put = |row, column, block: Matrix3<f64>| {
                covariance.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
            };
            put(0, 0, slopes * (bias + noise) * slopes.transpose());
            put(0, 3, slopes * bias);
            put(3, 0, bias * slopes.transpose());
            put(3, 3, bias);
            covariance
        };
        let prior = Matrix3::from_diagonal(&self.bias_sigma.component_mul(&self.bias_sigma));
        let along = up * up.transpose();
        let (height, noise) = (up.dot(&(prior * up)), self.noise_sigma.powi(2));
        let across = one - along;
        let left = height * noise / (height + noise) * along;
        vec![
            (&TILT_IN_WORLD, changed(self.world_from_body.into_inner(), 1.0)),
            (&INDEPENDENT, changed(one, 0.0)),
            (&NOT_OVER_GRAVITY, changed(g * one, 1.0)),
            (&NOT_OVER_GRAVITY, changed(g.sqrt() * one, 1.0 / g.sqrt())),
            (&LENGTH_IGNORED, with(prior)),
            (&ACROSS_UNTOUCHED, with(across * prior * across + left)),
            (&TURNED_THE_OTHER_WAY, changed(one, -1.0)),
            (&SIGMAS_NOT_SQUARED, roots.covariance()),
        ]
    }
}

/// The attitude of a body at rest, against the one that it was drawn with.
///
/// # Errors
///
/// A failure, which names the attitude that came back where that is known.
pub fn leveled(answer: &dyn Transport, stand: &Stand) -> Result<(), Failure> {
    let (force, heading) = (stand.force * stand.up(), stand.heading());
    let obtained = Answer(answer).level(&force, &heading)?;
    let mut comparison =
        compare("the rotation", obtained.matrix(), stand.world_from_body.matrix()).within(1e-9);
    for (misconception, rotation) in stand.wrong_attitudes() {
        comparison = comparison.or(misconception, &rotation);
    }
    comparison.judge().map_err(|failure| failure.given(&[("force", &force), ("heading", &heading)]))
}

/// A covariance whose tilts are in m/s², as biases are.
fn in_forces(covariance: &Matrix6<f64>, gravity: f64) -> Matrix6<f64> {
    let unit = Matrix6::from_diagonal(&Vector6::new(gravity, gravity, gravity, 1.0, 1.0, 1.0));
    unit * covariance * unit
}

const TILT_AND_BIAS: [&str; 6] = ["g φ x", "g φ y", "g φ z", "b x", "b y", "b z"];

/// What a stand leaves unknown, against all parts of bias and noise one by one.
///
/// # Errors
///
/// A failure, which names the covariance that came back where that is known.
pub fn resting(answer: &dyn Transport, stand: &Stand) -> Result<(), Failure> {
    let Stand { world_from_body, bias_sigma, noise_sigma, gravity, .. } = stand;
    let obtained =
        Answer(answer).rest_covariance(world_from_body, bias_sigma, noise_sigma, gravity)?;
    let mut comparison = compare(
        "the covariance of gravity times φ and of b",
        &in_forces(&obtained, *gravity),
        &in_forces(&stand.covariance(), *gravity),
    )
    .within(1e-8)
    .labelled(&TILT_AND_BIAS, &TILT_AND_BIAS);
    for (misconception, covariance) in stand.wrong_covariances() {
        comparison = comparison.or(misconception, &in_forces(&covariance, *gravity));
    }
    comparison.judge().map_err(|failure| {
        failure.given(&[
            ("world_from_body", &world_from_body.matrix()),
            ("bias_sigma", bias_sigma),
            ("noise_sigma", noise_sigma),
            ("gravity", gravity),
        ])
    })
}

impl Twice {
    /// A body that stands, is turned and stands again.
    pub fn drawn(draw: &mut Draw, turn: Turn) -> Self {
        let stand = loop {
            let stand = Stand::drawn(draw);
            if stand.noise_sigma > 0.0 {
                break stand;
            }
        };
        let up = stand.up();
        let angle = draw.uniform(0.5..PI);
        let first_from_second = match turn {
            Turn::None => Rotation3::identity(),
            Turn::Around => Rotation3::new(angle * up),
            Turn::Tipped => {
                let level = up.cross(&draw.direction()).normalize();
                Rotation3::new(angle.min(FRAC_PI_2) * level)
            }
            Turn::Any => draw.rotation(0.5..2.5),
        };
        let bias = stand.bias_sigma.component_mul(&draw.normals::<3, 1>());
        let off = stand.parts() * draw.normals::<6, 1>();
        let covariance = stand.covariance();
        let known = Known { world_from_body: stand.world_from_body, bias, covariance };
        let mut twice = Self { stand, known, first_from_second, force: Vector3::zeros() };
        let noise = twice.stand.noise_sigma * draw.normals::<3, 1>();
        twice.force = twice.read(&off, &first_from_second) + noise;
        twice
    }

    /// What the accelerometer reads in the second stand if tilt and bias are off by so much.
    fn read(&self, off: &Vector6<f64>, turn: &Rotation3<f64>) -> Vector3<f64> {
        let tilt = Rotation3::new(off.fixed_rows::<3>(0).into_owned());
        let attitude = self.known.world_from_body * tilt * turn;
        let bias = self.known.bias + off.fixed_rows::<3>(3);
        attitude.inverse() * (self.stand.gravity * Vector3::z()) + bias
    }

    /// The derivative of that by differences.
    fn slopes(&self, turn: &Rotation3<f64>) -> Matrix3x6<f64> {
        let h = 1e-3;
        let column = |k: usize| {
            let read = |step: f64| self.read(&Vector6::ith(k, step), turn);
            (8.0 * (read(h) - read(-h)) - (read(2.0 * h) - read(-2.0 * h))) / (12.0 * h)
        };
        Matrix3x6::from_columns(&[0, 1, 2, 3, 4, 5].map(column))
    }

    /// The most likely tilt and bias: the least sum of squares of the parts that make them, each in
    /// standard deviations, and of what the new force is then off.
    fn estimate(
        &self,
        parts: &DMatrix<f64>,
        turn: &Rotation3<f64>,
        slopes: &Matrix3x6<f64>,
        noise: f64,
    ) -> Option<Vector6<f64>> {
        let off = (self.force - self.read(&Vector6::zeros(), turn)) / noise;
        let seen = slopes * parts / noise;
        let count = parts.ncols();
        let normal = DMatrix::identity(count, count) + seen.tr_mul(&seen);
        let luck = normal.cholesky()?.solve(&seen.tr_mul(&off));
        let mut found: DVector<f64> = parts * luck;
        for axis in 0..3 {
            found[3 + axis] += self.known.bias[axis];
        }
        Some(found.fixed_rows::<6>(0).into_owned())
    }

    fn expected(&self) -> Vector6<f64> {
        let turn = &self.first_from_second;
        let parts = dense(&self.stand.parts());
        let found = self.estimate(&parts, turn, &self.slopes(turn), self.stand.noise_sigma);
        found.unwrap_or(Vector6::repeat(f64::NAN))
    }

    /// Estimates of known mistakes.
    fn wrong_estimates(&self) -> Vec<(&'static Misconception, Vector6<f64>)> {
        let (turn, noise) = (&self.first_from_second, self.stand.noise_sigma);
        let (right, slopes) = (self.stand.parts(), self.slopes(turn));
        let mut apart = DMatrix::zeros(6, 12);
        apart.view_mut((0, 0), (3, 6)).copy_from(&right.fixed_rows::<3>(0));
        apart.view_mut((3, 6), (3, 6)).copy_from(&right.fixed_rows::<3>(3));
        let right = dense(&right);
        let back = turn.inverse();
        let mut turned = slopes;
        turned.fixed_columns_mut::<3>(3).copy_from(back.matrix());
        let mut other_way = slopes;
        other_way.fixed_columns_mut::<3>(0).neg_mut();
        // A bias that turns along also leads to another prediction.
        let mut along = self.clone();
        along.force += self.known.bias - back * self.known.bias;
        let candidates = [
            (&INDEPENDENT, self.estimate(&apart, turn, &slopes, noise)),
            (&TURN_INVERTED, self.estimate(&right, &back, &self.slopes(&back), noise)),
            (&BIAS_TURNED_ALONG, self.estimate(&right, turn, &turned, noise)),
            (&BIAS_TURNED_ALONG, along.estimate(&right, turn, &turned, noise)),
            (&TURNED_THE_OTHER_WAY, self.estimate(&right, turn, &other_way, noise)),
            (&SIGMAS_NOT_SQUARED, self.estimate(&right, turn, &slopes, noise.sqrt())),
        ];
        candidates.into_iter().filter_map(|(name, found)| Some((name, found?))).collect()
    }
}

fn dense<const C: usize>(matrix: &SMatrix<f64, 6, C>) -> DMatrix<f64> {
    DMatrix::from_fn(6, C, |row, column| matrix[(row, column)])
}

/// Tilt and bias after a second stand, against a least sum of squares over all parts of bias and noise.
///
/// # Errors
///
/// A failure, which names the estimate that came back where that is known.
pub fn second(answer: &dyn Transport, twice: &Twice) -> Result<(), Failure> {
    let Twice { stand, known, first_from_second, force } = twice;
    let Stand { noise_sigma, gravity, .. } = stand;
    let (tilt, bias) =
        Answer(answer).second_stand(known, first_from_second, force, noise_sigma, gravity)?;
    let in_forces = |estimate: &Vector6<f64>| {
        Vector6::from_fn(|k, _| if k < 3 { gravity * estimate[k] } else { estimate[k] })
    };
    let obtained = Vector6::from_iterator(tilt.iter().chain(bias.iter()).copied());
    let mut comparison = compare(
        "the estimate of gravity times φ and of b",
        &in_forces(&obtained),
        &in_forces(&twice.expected()),
    )
    .within(1e-7)
    .labelled(&TILT_AND_BIAS, &[]);
    for (misconception, estimate) in twice.wrong_estimates() {
        comparison = comparison.or(misconception, &in_forces(&estimate));
    }
    comparison.judge().map_err(|failure| {
        failure.given(&[
            ("known", known),
            ("first_from_second", &first_from_second.matrix()),
            ("force", force),
            ("noise_sigma", noise_sigma),
            ("gravity", gravity),
        ])
    })
}
