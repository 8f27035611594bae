//! Gauss-Newton, step by step.

use nalgebra::{Isometry3, Vector3, Vector6};
use vislam::least_squares::{LandmarkElimination, LinearSystem, Point, Problem, Values};
use vislam::manifold::se3;

use super::to_side;
use crate::pixels::Camera;

/// Beyond this the optimizer is lost, in metres and radians.
const LOST: f64 = 1e3;
/// After a step that is nowhere longer than this, all others are rounding.
const SETTLED: f64 = 1e-12;

/// Where an optimizer stood before each of its steps, and where it stands.
#[derive(Default)]
pub struct Run {
    /// All variables, from the start on; fewer than were asked for when a step failed.
    pub states: Vec<Values>,
}

impl Run {
    /// So many Gauss-Newton steps from where the problem starts; fewer if one fails or leads to the end of the world.
    /// The Jacobian is derived for steps of the cameras on this side, and they are taken on the right.
    pub fn new(problem: &Problem, from: &Values, steps: usize, side: f64) -> Self {
        let mut states = vec![from.clone()];
        let Ok(mut system) = LandmarkElimination::<6>::new::<Vector3<f64>>(problem) else {
            return Self { states };
        };
        let mut step = vec![0.0_f64; from.dimension()];
        for _ in 0..steps {
            let values = &states[states.len() - 1];
            if states.len() > 1 && step.iter().all(|part| part.abs() < SETTLED) {
                states.push(values.clone());
                continue;
            }
            if system.linearize(problem, Point { values, frozen: None }).is_err()
                || system.step(0.0, &mut step).is_none()
            {
                break;
            }
            if side != 0.0 {
                mix(values, side, &mut step);
            }
            if step.iter().any(|part| part.abs() > LOST || part.is_nan()) {
                break;
            }
            states.push(values.retract(&step));
        }
        Self { states }
    }

    /// The cameras after so many steps, if the optimizer got there.
    pub fn cameras(&self, steps: usize) -> Option<&[Camera]> {
        Some(self.states.get(steps)?.of_kind())
    }

    /// Distances of all cameras together from where they belong, in metres and radians, step by step.
    pub fn errors(&self, optimum: &Values) -> impl Iterator<Item = f64> {
        self.states.iter().map(|state| distance(state, optimum))
    }
}

/// Of the step for the Jacobian of the right makes that for the Jacobian J S of a side: S⁻¹ before it, since
/// (S^T J^T J S) ξ = −S^T J^T r wherever J^T J (S ξ) = −J^T r.
fn mix(values: &Values, side: f64, step: &mut [f64]) {
    for (index, camera) in values.of_kind::<Camera>().iter().enumerate() {
        let Some(part) = values.coordinates_of(index).and_then(|at| step.get_mut(at)) else {
            return;
        };
        let mixed = to_side(&camera.0.camera_from_world, -side) * Vector6::from_column_slice(part);
        part.copy_from_slice(mixed.as_slice());
    }
}

fn distance(values: &Values, optimum: &Values) -> f64 {
    let pose = |camera: &Camera| -> Isometry3<f64> { camera.0.camera_from_world };
    let pairs = values.of_kind().iter().zip(optimum.of_kind());
    let squared = pairs.map(|(camera, best)| se3::local(&pose(best), &pose(camera)).norm_squared());
    squared.sum::<f64>().sqrt()
}
