//! Random states, readings and scenes, and what a motion of everything does to them.

use nalgebra::{Isometry3, Rotation3, SMatrix, SVector, Vector2, Vector3};
use vislam::consistency::Chart;
use vislam::factors::BodyPixel;
use vislam::inertial::{BodyPose, GRAVITY, ImuBias, ImuNoise, ImuSample, NavState};
use vislam::least_squares::{Key, Values};
use vislam::manifold::so3;
use vislam::observability::{four_motions, steps_of_state};
use vislam::preintegration::{CombinedPreintegrated, CombinedPreintegrator};
use vislam::reprojection::Pinhole;

use crate::random::Random;

/// The standard deviation of a pixel.
pub const SIGMA: f64 = 1.0;
const NOISE: ImuNoise =
    ImuNoise { gyro: 3e-3, accelerometer: 2e-2, gyro_walk: 2e-2, accelerometer_walk: 0.1 };

pub fn state(random: &mut Random) -> NavState {
    NavState {
        world_from_body: random.rotation(3.0),
        velocity: random.direction(2.0),
        position: random.direction(4.0),
    }
}

/// Readings of a fifth of a second, and the bias at which they are summed.
pub fn readings(random: &mut Random) -> (CombinedPreintegrated, ImuBias) {
    let bias = ImuBias { gyro: random.direction(0.05), accelerometer: random.direction(0.2) };
    (summed(&bias, random), bias)
}

/// Readings of a fifth of a second, summed at a bias.
pub fn summed(bias: &ImuBias, random: &mut Random) -> CombinedPreintegrated {
    let mut sums = CombinedPreintegrator::new(bias, &NOISE).expect("the bias is finite");
    for _ in 0..10 {
        let gyro = random.direction(1.5);
        let accelerometer = random.direction(3.0) - GRAVITY;
        sums.integrate(&ImuSample { gyro, accelerometer }, 0.02).expect("the reading is finite");
    }
    sums.finish().expect("there are readings")
}

/// A camera on a body, and the pixel that it has of a landmark.
#[derive(Clone, Copy)]
pub struct Eye {
    pub camera: Pinhole,
    pub body_from_camera: Isometry3<f64>,
}

impl Eye {
    pub fn any(random: &mut Random) -> Self {
        let (arm, turn) = (random.direction(0.2), random.rotation(3.0));
        let body_from_camera = Isometry3::from_parts(arm.into(), turn.into());
        Self { camera: random.camera(), body_from_camera }
    }

    /// A point ahead of the camera of a body, in the world.
    pub fn ahead(&self, state: &NavState, random: &mut Random) -> Vector3<f64> {
        let in_body = self.body_from_camera * nalgebra::Point3::from(random.point(3.0..8.0));
        state.position + state.world_from_body * in_body.coords
    }

    /// Where it sees a point; NaN behind it.
    pub fn seen(&self, state: &NavState, landmark: &Vector3<f64>) -> Vector2<f64> {
        let body = Isometry3::from_parts(state.position.into(), state.world_from_body.into());
        let point = (body * self.body_from_camera).inverse() * nalgebra::Point3::from(*landmark);
        let pixel = Vector2::new(
            self.camera.fx * point.x / point.z + self.camera.cx,
            self.camera.fy * point.y / point.z + self.camera.cy,
        );
        if point.z > 0.0 { pixel } else { Vector2::repeat(f64::NAN) }
    }

    /// The derivatives of a whitened pixel by a step (φ, p) of the body and by the landmark.
    pub fn rows(
        &self,
        state: &NavState,
        landmark: &Vector3<f64>,
    ) -> (SMatrix<f64, 2, 6>, SMatrix<f64, 2, 3>) {
        let pixel = Vector2::zeros();
        let seen = BodyPixel { camera: &self.camera, pixel, inverse_sigma: 1.0 / SIGMA };
        let pose = BodyPose::from(state);
        let linear = seen.linearize((&pose, landmark, &self.body_from_camera));
        linear
            .map_or((SMatrix::repeat(f64::NAN), SMatrix::repeat(f64::NAN)), |(_, by)| (by.0, by.1))
    }
}

/// A motion of everything: a shift in m, and a turn about the vertical in rad.
pub type Shifted = SVector<f64, 4>;

/// A state after everything was moved.
pub fn moved(state: &NavState, motion: &Shifted) -> NavState {
    let turn = so3::exp(&Vector3::new(0.0, 0.0, motion[3]));
    NavState {
        world_from_body: turn * state.world_from_body,
        velocity: turn * state.velocity,
        position: moved_point(&state.position, motion),
    }
}

pub fn moved_point(point: &Vector3<f64>, motion: &Shifted) -> Vector3<f64> {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), motion[3]);
    turn * point + motion.fixed_rows::<3>(0)
}

/// The free directions of a state, of its pose and of a landmark, as the library has them.
pub fn free(state: &NavState) -> SMatrix<f64, 9, 4> {
    steps_of_state(&four_motions(&Vector3::z()), state)
}

pub fn free_of_pose(state: &NavState) -> SMatrix<f64, 6, 4> {
    let all = free(state);
    SMatrix::from_fn(|row, column| all[(if row < 3 { row } else { row + 3 }, column)])
}

pub fn free_of_point(point: &Vector3<f64>) -> SMatrix<f64, 3, 4> {
    let columns = four_motions(&Vector3::z()).map(|motion| motion.of_point(point));
    SMatrix::from_columns(&columns)
}

/// The step (φ, v, p) from one state to another.
pub fn between(from: &NavState, to: &NavState) -> SVector<f64, 9> {
    let phi = so3::local(&from.world_from_body, &to.world_from_body);
    let blocks = [phi, to.velocity - from.velocity, to.position - from.position];
    SVector::from_fn(|row, _| blocks[row / 3][row % 3])
}

/// A body, a former pose of it and a landmark.
#[derive(Clone)]
pub struct Scene {
    pub values: Values,
    pub body: Key<NavState>,
    pub pose: Key<BodyPose>,
    pub landmark: Key<Vector3<f64>>,
}

/// How many coordinates a scene has.
pub const SIZE: usize = 18;

impl Scene {
    pub fn any(random: &mut Random) -> Self {
        let mut values = Values::new();
        let body = values.add(state(random));
        let pose = values.add(BodyPose::from(&state(random)));
        let landmark = values.add(random.direction(6.0));
        Self { values, body, pose, landmark }
    }

    /// After a step of each variable.
    pub fn stepped(&self, step: &SVector<f64, SIZE>) -> Self {
        Self { values: self.values.retract(step.as_slice()), ..self.clone() }
    }

    /// After a step of everything in a chart.
    pub fn retracted(&self, chart: Chart, step: &SVector<f64, SIZE>) -> Self {
        Self { values: chart.retract(&self.values, self.body, step.as_slice()), ..self.clone() }
    }

    /// After everything was moved.
    pub fn moved(&self, motion: &Shifted) -> Self {
        let mut scene = self.clone();
        let pose = &self.values[self.pose];
        let state = moved(&pose.at_rest(), motion);
        scene.values.set(self.body, moved(&self.values[self.body], motion));
        scene.values.set(self.pose, BodyPose::from(&state));
        scene.values.set(self.landmark, moved_point(&self.values[self.landmark], motion));
        scene
    }

    /// The matrix of the library from steps to errors in a chart.
    pub fn by_step(&self, chart: Chart) -> SMatrix<f64, SIZE, SIZE> {
        SMatrix::from_column_slice(chart.by_step(&self.values, self.body).as_slice())
    }

    /// The free directions, in the variables' own errors.
    pub fn free(&self) -> SMatrix<f64, SIZE, 4> {
        let mut all = SMatrix::<f64, SIZE, 4>::zeros();
        let pose = self.values[self.pose].at_rest();
        all.fixed_rows_mut::<9>(0).copy_from(&free(&self.values[self.body]));
        all.fixed_rows_mut::<6>(9).copy_from(&free_of_pose(&pose));
        all.fixed_rows_mut::<3>(15).copy_from(&free_of_point(&self.values[self.landmark]));
        all
    }

    /// Rotation, velocity, position and landmark as one 6×6 matrix of the group, and the former pose
    /// as one of 4×4.
    pub fn matrices(&self) -> (SMatrix<f64, 6, 6>, SMatrix<f64, 4, 4>) {
        let (state, pose) = (&self.values[self.body], &self.values[self.pose]);
        let mut body = SMatrix::<f64, 6, 6>::identity();
        body.fixed_view_mut::<3, 3>(0, 0).copy_from(state.world_from_body.matrix());
        let columns = [state.velocity, state.position, self.values[self.landmark]];
        for (column, vector) in columns.iter().enumerate() {
            body.fixed_view_mut::<3, 1>(0, 3 + column).copy_from(vector);
        }
        let mut former = SMatrix::<f64, 4, 4>::identity();
        former.fixed_view_mut::<3, 3>(0, 0).copy_from(pose.world_from_body.matrix());
        former.fixed_view_mut::<3, 1>(0, 3).copy_from(&pose.position);
        (body, former)
    }
}
