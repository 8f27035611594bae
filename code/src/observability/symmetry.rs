//! What a motion of the whole world does to the coordinates of a variable.

use nalgebra::{SMatrix, Vector3};

use crate::inertial::NavState;

// ANCHOR: world_motion
/// A motion of everything at once, to first order: the world is turned by a rotation vector, in rad,
/// and shifted, in m. No picture and no reading notices a shift, or a turn about the vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldMotion {
    /// The shift, in metres.
    pub shift: Vector3<f64>,
    /// The rotation vector of the turn about the origin of the world, in radians.
    pub turn: Vector3<f64>,
}

impl WorldMotion {
    /// How a point moves, in metres.
    pub fn of_point(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.shift + self.turn.cross(point)
    }

    /// The step (φ, v, p) of a state. φ stands in the body.
    pub fn of_state(&self, state: &NavState) -> [Vector3<f64>; 3] {
        let phi = state.world_from_body.inverse() * self.turn;
        [phi, self.turn.cross(&state.velocity), self.of_point(&state.position)]
    }
}
// ANCHOR_END: world_motion

/// The unit vector upwards, against free fall. Without gravity it is z.
pub fn vertical(gravity: &Vector3<f64>) -> Vector3<f64> {
    (-gravity).try_normalize(0.0).unwrap_or_else(Vector3::z)
}

// ANCHOR: four_motions
/// The four motions that gravity and pixels leave free: shifts by a metre along the axes of the
/// world, then a turn by a radian about the vertical. `up` has length one.
pub fn four_motions(up: &Vector3<f64>) -> [WorldMotion; 4] {
    let zero = Vector3::zeros();
    let shifted = |axis| WorldMotion { shift: Vector3::ith(axis, 1.0), turn: zero };
    [shifted(0), shifted(1), shifted(2), WorldMotion { shift: zero, turn: *up }]
}
// ANCHOR_END: four_motions

/// The 9×4 matrix of the steps of a state under four motions.
pub fn steps_of_state(motions: &[WorldMotion; 4], state: &NavState) -> SMatrix<f64, 9, 4> {
    let steps = motions.map(|motion| motion.of_state(state));
    SMatrix::from_fn(|row, column| steps[column][row / 3][row % 3])
}
