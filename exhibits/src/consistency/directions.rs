//! The four free directions, carried through transitions, copies and pixels.

use nalgebra::{DMatrix, SMatrix, SVector, Vector3};
use vislam::filtering::Transition;
use vislam::inertial::{BodyPose, GRAVITY, NavState};
use vislam::least_squares::Manifold;
use vislam::manifold::so3;
use vislam::msckf::{LinearizedTrack, Sight};
use vislam::preintegration::{CombinedPreintegrated, Matrix15};

use super::draws::{self, Eye, SIGMA, Shifted};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences};
use crate::random::Random;

const STATES: usize = 100;
const SIGHTS: usize = 4;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Carried = |interval| interval.by_error(&GRAVITY) * along(&interval.first);
    let mutants: [(_, Carried); 4] = [
        ("first state at two estimates", |interval| {
            let first = interval.elsewhere();
            interval.by_error(&GRAVITY) * along(&first)
        }),
        ("second state's directions", |interval| {
            interval.by_error(&GRAVITY) * along(&interval.second)
        }),
        ("gravity to the side", |interval| {
            interval.by_error(&Vector3::new(9.81, 0.0, 0.0)) * along(&interval.first)
        }),
        ("transposed", |interval| interval.by_error(&GRAVITY).transpose() * along(&interval.first)),
    ];
    chapter.equation("free-carried", free_carried, formula, &mutants);

    let formula: Copied = |track| track.by_poses(|triangle| triangle) * track.free();
    let mutants: [(_, Copied); 3] = [
        ("sign", |track| -track.by_poses(|triangle| triangle) * track.free()),
        ("triangle transposed", |track| {
            track.by_poses(|triangle| triangle.transpose()) * track.free()
        }),
        ("a pose at two estimates", |track| {
            let mut free = track.free();
            let other = track.poses[0].retract(&[0.02, -0.05, 0.03, 0.0, 0.0, 0.1, 0.2, 0.1, -0.3]);
            free.rows_mut(0, 6).copy_from(&draws::free_of_pose(&other));
            track.by_poses(|triangle| triangle) * free
        }),
    ];
    chapter.equation("free-copied", free_copied, formula, &mutants);

    let formula: Seen = |eye, state, landmark| {
        let (by_pose, by_landmark) = eye.rows(state, landmark);
        by_pose * draws::free_of_pose(state) + by_landmark * draws::free_of_point(landmark)
    };
    let mutants: [(_, Seen); 3] = [
        ("landmark stays", |eye, state, landmark| {
            eye.rows(state, landmark).0 * draws::free_of_pose(state)
        }),
        ("landmark at two estimates", |eye, state, landmark| {
            let (by_pose, by_landmark) = eye.rows(state, landmark);
            let other = landmark + Vector3::new(0.1, -0.2, 0.1);
            by_pose * draws::free_of_pose(state) + by_landmark * draws::free_of_point(&other)
        }),
        ("landmark against the body", |eye, state, landmark| {
            let (by_pose, by_landmark) = eye.rows(state, landmark);
            by_pose * draws::free_of_pose(state) - by_landmark * draws::free_of_point(landmark)
        }),
    ];
    chapter.equation("free-seen", free_seen, formula, &mutants);
}

/// Readings between two states of which neither was predicted from the other.
struct Interval {
    readings: CombinedPreintegrated,
    bias: vislam::inertial::ImuBias,
    first: NavState,
    second: NavState,
}

impl Interval {
    fn any(random: &mut Random) -> Self {
        let (readings, bias) = draws::readings(random);
        let first = draws::state(random);
        let second = readings.sums.predict(&first, &GRAVITY, &bias);
        let off: [f64; 9] = std::array::from_fn(|_| random.normal(0.1));
        Self { readings, bias, first, second: second.retract(&off) }
    }

    fn by_error(&self, gravity: &Vector3<f64>) -> Matrix15 {
        let states = (&self.first, &self.second);
        let transition = Transition::between(states, &self.readings, &self.bias, gravity);
        transition.map_or(Matrix15::repeat(f64::NAN), |transition| transition.by_error)
    }

    fn elsewhere(&self) -> NavState {
        self.first.retract(&[0.05, -0.1, 0.07, 0.1, 0.2, -0.1, 0.1, -0.2, 0.1])
    }
}

/// The free directions of a state and its biases.
fn along(state: &NavState) -> SMatrix<f64, 15, 4> {
    let mut free = SMatrix::<f64, 15, 4>::zeros();
    free.fixed_rows_mut::<9>(0).copy_from(&draws::free(state));
    free
}

type Carried = fn(&Interval) -> SMatrix<f64, 15, 4>;

fn free_carried(formula: Carried) -> Comparison {
    let against = "central differences of the second state when everything is moved";
    Comparison::relative(against, 1e-7).over(STATES, 1, |random| {
        let interval = Interval::any(random);
        let oracle = differences(1e-5, |motion: Shifted| {
            let mut step = SVector::<f64, 15>::zeros();
            let moved = draws::moved(&interval.second, &motion);
            step.fixed_rows_mut::<9>(0).copy_from(&draws::between(&interval.second, &moved));
            step
        });
        (formula(&interval), oracle)
    })
}

/// A landmark that poses have seen.
struct Track {
    poses: [NavState; SIGHTS],
    landmark: Vector3<f64>,
    linear: LinearizedTrack,
}

impl Track {
    fn any(random: &mut Random) -> Self {
        let eye = Eye::any(random);
        let first = draws::state(random);
        let landmark = eye.ahead(&first, random);
        let poses: [NavState; SIGHTS] = std::array::from_fn(|_| NavState {
            world_from_body: first.world_from_body * random.rotation(0.1),
            position: first.position + random.direction(0.5),
            ..first
        });
        let sights = poses.map(|state| {
            let pose = BodyPose::from(&state);
            let pixel = eye.seen(&state, &landmark).map(|number| number + random.normal(SIGMA));
            Sight { pose, linearized_at: pose, pixel }
        });
        let mut linear = LinearizedTrack::default();
        let camera = (&eye.camera, SIGMA);
        let ahead = linear.linearize(&sights, &landmark, &eye.body_from_camera, camera);
        ahead.expect("the landmark is ahead");
        linear.project(f64::INFINITY).expect("there are rows");
        Self { poses, landmark, linear }
    }

    /// How the landmark's error follows from those of the poses, by what is made of the triangle.
    fn by_poses(
        &self,
        triangle: impl Fn(nalgebra::Matrix3<f64>) -> nalgebra::Matrix3<f64>,
    ) -> DMatrix<f64> {
        let inverse = crate::comparison::inverse(triangle(self.linear.landmark_root()));
        let rows = self.linear.rows();
        let rows: DMatrix<f64> =
            DMatrix::from_fn(3, 6 * SIGHTS, |row, column| rows.row(row)[3 + column]);
        -DMatrix::from_column_slice(3, 3, inverse.as_slice()) * rows
    }

    fn free(&self) -> DMatrix<f64> {
        let blocks = self.poses.map(|pose| draws::free_of_pose(&pose));
        DMatrix::from_fn(6 * SIGHTS, 4, |row, column| blocks[row / 6][(row % 6, column)])
    }
}

type Copied = fn(&Track) -> DMatrix<f64>;

fn free_copied(formula: Copied) -> Comparison {
    let against = "central differences of the landmark when everything is moved";
    Comparison::relative(against, 1e-7).over(STATES, 2, |random| {
        let track = Track::any(random);
        let oracle = differences(1e-5, |motion: Shifted| {
            let turn = so3::exp(&(motion[3] * Vector3::z()));
            turn * track.landmark + motion.fixed_rows::<3>(0) - track.landmark
        });
        (formula(&track), oracle)
    })
}

type Seen = fn(&Eye, &NavState, &Vector3<f64>) -> SMatrix<f64, 2, 4>;

fn free_seen(formula: Seen) -> Comparison {
    let against = "central differences of the pixel when everything is moved";
    Comparison::absolute(against, 1e-4, "standard deviations for a metre or a radian").over(
        STATES,
        3,
        |random| {
            let (eye, state) = (Eye::any(random), draws::state(random));
            let landmark = eye.ahead(&state, random);
            let oracle = differences(1e-4, |motion: Shifted| {
                let state = draws::moved(&state, &motion);
                eye.seen(&state, &draws::moved_point(&landmark, &motion)) / SIGMA
            });
            (formula(&eye, &state, &landmark), oracle)
        },
    )
}
