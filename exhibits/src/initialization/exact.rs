//! The linear equations of a motion that is known at all times, without a program that sums readings.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, SMatrix, SVector, Vector3};
use vislam::inertial::GRAVITY;
use vislam::initialization::LinearAlignment;
use vislam::simulation::{ScalarTrajectory, Trajectory};

use crate::random::Random;

/// Scale, velocity, the accelerometer's bias, gravity.
pub type Unknowns = SVector<f64, 10>;

/// A motion with a camera on an arm, told in the axes and the unit of a map.
#[derive(Clone)]
pub struct Told {
    pub motion: Trajectory,
    /// From the body to the camera, in its axes, in metres.
    pub lever: Vector3<f64>,
    /// Of the accelerometer, in m/s².
    pub bias: Vector3<f64>,
    pub map_from_world: Rotation3<f64>,
    /// Metres in a unit of the map.
    pub scale: f64,
    /// When the cameras took their pictures, in seconds, the first at zero.
    pub times: Vec<f64>,
}

/// One camera's part of the equations.
pub struct Row {
    pub seconds: f64,
    /// How far its centre is from that of the first, in the map's unit.
    pub moved: Vector3<f64>,
    /// What the forces that were read do to the position.
    pub forces: Vector3<f64>,
    /// What a bias adds to that.
    pub by_bias: Matrix3<f64>,
    /// By how much the arm has swung.
    pub swung: Vector3<f64>,
}

/// Steps of the sums over forces.
const STEPS: u32 = 400;

impl Told {
    /// A motion with as many pictures as there are times in the given seconds, in the world's axes and metres.
    pub fn plain(motion: Trajectory, seconds: f64, cameras: usize) -> Self {
        let step = seconds / (cameras - 1) as f64;
        Self {
            motion,
            lever: Vector3::zeros(),
            bias: Vector3::zeros(),
            map_from_world: Rotation3::identity(),
            scale: 1.0,
            times: (0..cameras).map(|camera| camera as f64 * step).collect(),
        }
    }

    /// Any motion, and any map of it.
    pub fn drawn(random: &mut Random, cameras: usize) -> Self {
        let seconds = random.uniform(1.0..3.0);
        Self {
            lever: random.direction(0.2),
            bias: random.direction(0.3),
            map_from_world: random.rotation(3.0),
            scale: random.logarithmic(0.3..3.0),
            ..Self::plain(anywhere_in(Trajectory::figure_eight(), random), seconds, cameras)
        }
    }

    fn rotation(&self, t: f64) -> Rotation3<f64> {
        self.map_from_world * self.motion.at(t).state.world_from_body
    }

    /// The camera's centre, in the map's axes and in metres.
    fn centre(&self, t: f64) -> Vector3<f64> {
        self.map_from_world * self.motion.at(t).state.position + self.rotation(t) * self.lever
    }

    /// Twice the sum over time of a vector or of several, by Simpson's rule.
    fn twice_summed<const N: usize>(
        until: f64,
        of: impl Fn(f64) -> SMatrix<f64, 3, N>,
    ) -> SMatrix<f64, 3, N> {
        let step = until / f64::from(STEPS);
        let weight = |k| match k {
            0 | STEPS => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let term = |k: u32| {
            let t = f64::from(k) * step;
            of(t) * (weight(k) * (until - t))
        };
        (0..=STEPS).map(term).sum::<SMatrix<f64, 3, N>>() * (step / 3.0)
    }

    /// What the forces do to the position until a time, as the accelerometer reads them with its bias.
    fn forces(&self, until: f64) -> Vector3<f64> {
        Self::twice_summed(until, |t| {
            let read = self.motion.at(t).sample(&GRAVITY).accelerometer + self.bias;
            self.rotation(t) * read
        })
    }

    pub fn rows(&self) -> Vec<Row> {
        let first = self.centre(0.0);
        let row = |&seconds: &f64| Row {
            seconds,
            moved: (self.centre(seconds) - first) / self.scale,
            forces: self.forces(seconds),
            // More bias in the readings is less that is taken off them.
            by_bias: -Self::twice_summed(seconds, |t| self.rotation(t).into_inner()),
            swung: self.rotation(seconds) * self.lever - self.rotation(0.0) * self.lever,
        };
        self.times[1..].iter().map(row).collect()
    }

    /// The unknowns as they are.
    pub fn truth(&self) -> Unknowns {
        let state = self.motion.at(0.0).state;
        let (velocity, gravity) =
            (self.map_from_world * state.velocity, self.map_from_world * GRAVITY);
        let mut x = Unknowns::zeros();
        x[0] = self.scale;
        x.fixed_rows_mut::<3>(1).copy_from(&velocity);
        x.fixed_rows_mut::<3>(4).copy_from(&self.bias);
        x.fixed_rows_mut::<3>(7).copy_from(&gravity);
        x
    }

    /// The equations as the library has them.
    pub fn system(&self) -> LinearAlignment {
        let rows = self.rows();
        let mut matrix = DMatrix::zeros(3 * rows.len(), 10);
        let mut right = DVector::zeros(3 * rows.len());
        for (k, row) in rows.iter().enumerate() {
            let t = row.seconds;
            matrix.fixed_view_mut::<3, 1>(3 * k, 0).copy_from(&row.moved);
            matrix.fixed_view_mut::<3, 3>(3 * k, 1).fill_diagonal(-t);
            matrix.fixed_view_mut::<3, 3>(3 * k, 4).copy_from(&-row.by_bias);
            matrix.fixed_view_mut::<3, 3>(3 * k, 7).fill_diagonal(-0.5 * t * t);
            right.fixed_rows_mut::<3>(3 * k).copy_from(&(row.forces + row.swung));
        }
        LinearAlignment { matrix, right, gravity: GRAVITY.norm() }
    }
}

/// The same motion, begun at any of its moments.
pub fn anywhere_in(motion: Trajectory, random: &mut Random) -> Trajectory {
    let moment = random.uniform(0.0..20.0);
    let later = |coordinate: ScalarTrajectory| {
        let phase = coordinate.phase + coordinate.frequency * moment;
        ScalarTrajectory { phase, ..coordinate }
    };
    let mut later_motion = motion;
    later_motion.position = motion.position.map(later);
    let angles = &mut later_motion.angles;
    for angle in [&mut angles.yaw, &mut angles.pitch, &mut angles.roll] {
        *angle = later(*angle);
    }
    later_motion
}
