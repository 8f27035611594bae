//! Directions in which a whole window might move.

use std::fmt;

use nalgebra::{DVector, Vector3};

use super::{Window, WorldMotion, vertical};
use crate::least_squares::Columns;

// ANCHOR: direction
/// A direction that measurements may leave free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Everything is shifted along an axis of the world, 0 for x, 1 for y, 2 for z.
    Translation(usize),
    /// Everything is turned about the vertical.
    Yaw,
    /// Everything is tilted about a horizontal axis, 0 or 1: the axes x and y of a world whose z
    /// axis is vertical.
    Tilt(usize),
    /// The distance of one landmark, from where it was first seen.
    Depth(usize),
    /// Everything grows.
    Scale,
    /// The camera moves on the body along an axis of the body, 0 for x, 1 for y, 2 for z, and the
    /// body the other way, so that the camera stays where it is. Only where extrinsics are unknown.
    LeverArm(usize),
}
// ANCHOR_END: direction

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = |axis: usize| ["x", "y", "z"].get(axis).copied().unwrap_or("?");
        match self {
            Self::Translation(along) => write!(f, "translation {}", axis(*along)),
            Self::Yaw => write!(f, "yaw"),
            Self::Tilt(about) => write!(f, "tilt {}", axis(*about)),
            Self::Depth(landmark) => write!(f, "depth of landmark {landmark}"),
            Self::Scale => write!(f, "scale"),
            Self::LeverArm(along) => write!(f, "lever arm {}", axis(*along)),
        }
    }
}

impl Window {
    /// The vertical, upward, and two horizontal axes. Without gravity they are z, x and y.
    pub(super) fn axes(&self) -> [Vector3<f64>; 3] {
        let up = vertical(&self.gravity);
        // The x axis of the world, or y where x is nearly vertical, made horizontal.
        let forward = if up.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
        let forward = (forward - forward.dot(&up) * up).normalize();
        [up, forward, up.cross(&forward)]
    }

    /// A direction as a vector over all that is unknown, in the order of the window's steps. With
    /// an unknown accelerometer bias it has the change of the bias that hides it best.
    ///
    /// Implements {eq:four-null-vectors}, {eq:seven-null-vectors} and {eq:null-condition}. Zero for a landmark
    /// that does not exist or was not seen.
    pub fn direction(&self, direction: Direction) -> DVector<f64> {
        self.direction_in(direction, &self.columns())
    }

    /// The same, by columns that are known.
    pub(super) fn direction_in(&self, direction: Direction, columns: &Columns) -> DVector<f64> {
        let [up, forward, left] = self.axes();
        let (mut shift, mut turn, mut scale) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        match direction {
            Direction::Translation(axis) => shift = Vector3::ith(axis.min(2), 1.0),
            Direction::Yaw => turn = up,
            Direction::Tilt(axis) => turn = if axis == 0 { forward } else { left },
            Direction::Scale => scale = 1.0,
            Direction::Depth(landmark) => return self.depth_direction(landmark, columns),
            Direction::LeverArm(axis) => return self.lever_direction(axis.min(2), columns),
        }
        self.whole_motion(&shift, &turn, scale, columns)
    }

    // ANCHOR: null_vector
    /// How every coordinate that is unknown changes when the world is shifted in m, turned in rad
    /// and grows, each per unit of the step.
    fn whole_motion(
        &self,
        shift: &Vector3<f64>,
        turn: &Vector3<f64>,
        scale: f64,
        columns: &Columns,
    ) -> DVector<f64> {
        let mut whole = Vec::new();
        let motion = WorldMotion { shift: *shift, turn: *turn };
        for (k, state) in self.states.iter().enumerate() {
            let [phi, v, p] = motion.of_state(state);
            let centre = self.rig.world_from_camera(state).translation.vector;
            whole.extend([phi, v + scale * self.camera_velocity(k), p + scale * centre]);
        }
        let hiding = self.hiding_bias(scale, &turn.cross(&self.gravity));
        whole.extend(self.biases.iter().flat_map(|_| [Vector3::zeros(), hiding]));
        whole.extend(self.landmarks.iter().map(|f| motion.of_point(f) + scale * f));
        unknown(columns, &whole, &Vector3::zeros())
    }
    // ANCHOR_END: null_vector

    // ANCHOR: depth_direction
    /// The direction from the camera that first saw a landmark to the landmark, in its rows.
    fn depth_direction(&self, landmark: usize, columns: &Columns) -> DVector<f64> {
        let vectors = 3 * self.states.len() + 2 * self.biases.len();
        let mut whole = vec![Vector3::zeros(); vectors + self.landmarks.len()];
        let first = self.observations.iter().find(|factor| factor.point == landmark);
        let state = first.and_then(|factor| self.states.get(factor.keyframe));
        if let (Some(state), Some(point)) = (state, self.landmarks.get(landmark)) {
            let centre = self.rig.world_from_camera(state).translation.vector;
            whole[vectors + landmark] = point - centre;
        }
        unknown(columns, &whole, &Vector3::zeros())
    }
    // ANCHOR_END: depth_direction

    // ANCHOR: lever_direction
    /// How the body moves when the camera moves on it by a unit along an axis and stays where it
    /// is in the world.
    fn lever_direction(&self, axis: usize, columns: &Columns) -> DVector<f64> {
        let along = Vector3::ith(axis, 1.0);
        let mut whole = Vec::new();
        for (state, rate) in self.states.iter().zip(self.rates()) {
            let turned = |vector: Vector3<f64>| -(state.world_from_body * vector);
            whole.extend([Vector3::zeros(), turned(rate.cross(&along)), turned(along)]);
        }
        whole.resize(whole.len() + 2 * self.biases.len() + self.landmarks.len(), Vector3::zeros());
        let lever = self.rig.body_from_camera.rotation.inverse_transform_vector(&along);
        unknown(columns, &whole, &lever)
    }
    // ANCHOR_END: lever_direction
}

/// What of these vectors, over states, biases and landmarks, is unknown, with a shift of the
/// camera on the body in its own frame. The camera keeps its orientation on the body, and its
/// clock its offset.
fn unknown(columns: &Columns, whole: &[Vector3<f64>], lever: &Vector3<f64>) -> DVector<f64> {
    let vectors = whole.iter().chain([lever, &const { Vector3::new(0.0, 0.0, 0.0) }]);
    let changes = vectors.flat_map(|vector| vector.iter()).chain(&[0.0]);
    let unknown = columns.of.iter().zip(changes).filter(|(column, _)| column.is_some());
    DVector::from_iterator(columns.count, unknown.map(|(_, change)| *change))
}
