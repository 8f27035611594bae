//! The most likely inertial unknowns of a shape.

use nalgebra::{Isometry3, SMatrix, SVector, Vector1, Vector3, Vector6};
use vislam::factors::PoseUpToScale;
use vislam::inertial::NavState;
use vislam::least_squares::{Factor, Manifold, Problem};

use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered, differences};
use crate::random::Random;

const STATES: usize = 200;
/// The derivatives by the state and by the logarithm of the scale, and the residual.
type Derivative = SMatrix<f64, 6, 11>;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Slopes); 5] = [
        ("scale, not its logarithm", |seen| {
            let by_scale = seen.slopes().column(9) / seen.log_scale.exp();
            altered(seen.slopes(), |m| m.set_column(9, &by_scale))
        }),
        ("sign of the scale", |seen| altered(seen.slopes(), |m| m.column_mut(9).neg_mut())),
        ("scale of the body's place alone", |seen| {
            let place = -seen.shift * (-seen.log_scale).exp() * seen.state.position;
            altered(seen.slopes(), |m| m.fixed_view_mut::<3, 1>(3, 9).copy_from(&place))
        }),
        ("the arm does not turn", |seen| {
            altered(seen.slopes(), |m| m.fixed_view_mut::<3, 3>(3, 0).fill(0.0))
        }),
        ("position in the map's unit", |seen| {
            altered(seen.slopes(), |m| {
                m.fixed_view_mut::<3, 3>(3, 6).fill_diagonal(seen.shift);
            })
        }),
    ];
    chapter.equation("pose-up-to-scale", pose_up_to_scale, Seen::slopes, &mutants);
}

/// A state, and the pose that pictures have of its camera.
struct Seen {
    state: NavState,
    log_scale: f64,
    map_from_camera: Isometry3<f64>,
    body_from_camera: Isometry3<f64>,
    turn: f64,
    shift: f64,
}

type Slopes = fn(&Seen) -> Derivative;

impl Seen {
    fn drawn(random: &mut Random) -> Self {
        let state = NavState {
            world_from_body: random.rotation(3.0),
            velocity: random.direction(1.0),
            position: random.direction(3.0),
        };
        let arm = random.uniform(0.1..0.5);
        let body_from_camera =
            Isometry3::from_parts(random.direction(arm).into(), random.rotation(3.0).into());
        let turned = state.world_from_body * random.rotation(0.5);
        let rotation = turned * body_from_camera.rotation.to_rotation_matrix();
        let map_from_camera = Isometry3::from_parts(random.direction(2.0).into(), rotation.into());
        Self {
            state,
            log_scale: random.uniform(-1.0..1.0),
            map_from_camera,
            body_from_camera,
            turn: random.uniform(1.0..3.0),
            shift: random.uniform(1.0..3.0),
        }
    }

    fn slopes(&self) -> Derivative {
        let mut problem = Problem::new();
        let (state, scale) = (self.state, Vector1::new(self.log_scale));
        let factor = PoseUpToScale {
            state: problem.add_variable(state),
            log_scale: problem.add_variable(scale),
            map_from_camera: self.map_from_camera,
            body_from_camera: self.body_from_camera,
            inverse_turn: self.turn,
            inverse_shift: self.shift,
        };
        let linear = factor.linearize((&state, &scale));
        linear.map_or(Derivative::repeat(f64::NAN), |(residual, (by_state, by_scale))| {
            let mut both = Derivative::zeros();
            both.fixed_view_mut::<6, 9>(0, 0).copy_from(&by_state);
            both.set_column(9, &by_scale);
            both.set_column(10, &residual);
            both
        })
    }

    /// The residual after a step, by homogeneous matrices.
    fn off(&self, step: &SVector<f64, 10>) -> Vector6<f64> {
        let state = self.state.retract(&step.as_slice()[..9]);
        let mut world_from_body = state.world_from_body.to_homogeneous();
        world_from_body.fixed_view_mut::<3, 1>(0, 3).copy_from(&state.position);
        let world_from_camera = world_from_body * self.body_from_camera.to_homogeneous();
        let centre = world_from_camera.fixed_view::<3, 1>(0, 3) / (self.log_scale + step[9]).exp();
        let seen = self.map_from_camera.to_homogeneous()
            * self.body_from_camera.inverse().to_homogeneous();
        let turn = seen.fixed_view::<3, 3>(0, 0).transpose() * state.world_from_body.matrix();
        let turn = nalgebra::Rotation3::from_matrix_unchecked(turn).scaled_axis();
        let shift: Vector3<f64> = centre - self.map_from_camera.translation.vector;
        let mut off = Vector6::zeros();
        off.fixed_rows_mut::<3>(0).copy_from(&(self.turn * turn));
        off.fixed_rows_mut::<3>(3).copy_from(&(self.shift * shift));
        off
    }
}

fn pose_up_to_scale(formula: Slopes) -> Comparison {
    let against = "central differences of what homogeneous matrices have for turn and centre";
    Comparison::absolute(against, 1e-6, "").over(STATES, 81, |random| {
        let seen = Seen::drawn(random);
        let slopes = differences::<6, 10>(1e-5, |step| seen.off(&step));
        let mut oracle = Derivative::zeros();
        oracle.fixed_columns_mut::<10>(0).copy_from(&slopes);
        oracle.set_column(10, &seen.off(&SVector::zeros()));
        (formula(&seen), oracle)
    })
}
