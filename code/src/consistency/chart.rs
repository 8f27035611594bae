//! Coordinates of the errors of a body, its former poses and its landmarks, together.

use nalgebra::{DMatrix, Dyn, OMatrix, SMatrix, U9, Vector3};

use crate::inertial::{BodyPose, NavState};
use crate::least_squares::{Key, Values};
use crate::manifold::so3;

// ANCHOR: chart
/// In which coordinates the error of an estimate stays the same when the estimate moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Chart {
    /// Those of each variable by itself: R̂ exp(φ), and differences.
    #[default]
    Separate,
    /// The body's rotation, velocity and position and all landmarks are one element of a group, and
    /// each former pose is one: X = exp(ξ) X̂.
    RightInvariant,
    /// The same, but a landmark's error is its own difference. It is here to be tried: yaw is lost.
    RightInvariantPoses,
    /// The body's pose as in [`Chart::RightInvariant`]; its velocity, its former poses and the
    /// landmarks as the body sees them.
    Robocentric,
}
// ANCHOR_END: chart

// ANCHOR: frame
/// How the coordinates of a variable in a chart follow from its own error e and that of the body's
/// state: ξ = own e + by_body e_body.
struct Frame<const D: usize> {
    own: SMatrix<f64, D, D>,
    by_body: SMatrix<f64, D, 9>,
}
// ANCHOR_END: frame

fn put<const R: usize, const C: usize>(
    matrix: &mut SMatrix<f64, R, C>,
    (row, column): (usize, usize),
    block: &SMatrix<f64, 3, 3>,
) {
    matrix.fixed_view_mut::<3, 3>(row, column).copy_from(block);
}

impl Chart {
    // ANCHOR: frame_of_body
    /// The 9×9 matrix from the step (φ, v, p) of the body to its coordinates in the chart.
    fn frame_of_body(self, body: &NavState) -> SMatrix<f64, 9, 9> {
        let mut by_step = SMatrix::identity();
        let rotation = body.world_from_body.matrix();
        let turned = |vector: &Vector3<f64>| so3::hat(vector) * rotation;
        if self != Self::Separate {
            put(&mut by_step, (0, 0), rotation);
            put(&mut by_step, (3, 0), &turned(&body.velocity));
            put(&mut by_step, (6, 0), &turned(&body.position));
        }
        if self == Self::Robocentric {
            let seen = body.world_from_body.inverse() * body.velocity;
            put(&mut by_step, (3, 0), &so3::hat(&seen));
            put(&mut by_step, (3, 3), &rotation.transpose());
        }
        by_step
    }
    // ANCHOR_END: frame_of_body

    // ANCHOR: frame_of_pose
    /// The coordinates of a former pose.
    fn frame_of_pose(self, body: &NavState, pose: &BodyPose) -> Frame<6> {
        let (mut own, mut by_body) = (SMatrix::identity(), SMatrix::zeros());
        match self {
            Self::Separate => {}
            Self::RightInvariant | Self::RightInvariantPoses => {
                let rotation = pose.world_from_body.matrix();
                put(&mut own, (0, 0), rotation);
                put(&mut own, (3, 0), &(so3::hat(&pose.position) * rotation));
            }
            Self::Robocentric => {
                let body_from_world = body.world_from_body.inverse();
                let pose_from_body = pose.world_from_body.inverse() * body.world_from_body;
                let seen = body_from_world * (pose.position - body.position);
                put(&mut own, (3, 3), body_from_world.matrix());
                put(&mut by_body, (0, 0), &-pose_from_body.matrix());
                put(&mut by_body, (3, 0), &so3::hat(&seen));
                put(&mut by_body, (3, 6), &-body_from_world.matrix());
            }
        }
        Frame { own, by_body }
    }
    // ANCHOR_END: frame_of_pose

    // ANCHOR: frame_of_landmark
    /// The coordinates of a landmark, which shares the body's rotation.
    fn frame_of_landmark(self, body: &NavState, landmark: &Vector3<f64>) -> Frame<3> {
        let (mut own, mut by_body) = (SMatrix::identity(), SMatrix::zeros());
        match self {
            Self::Separate | Self::RightInvariantPoses => {}
            Self::RightInvariant => {
                put(&mut by_body, (0, 0), &(so3::hat(landmark) * body.world_from_body.matrix()));
            }
            Self::Robocentric => {
                let body_from_world = body.world_from_body.inverse();
                let seen = body_from_world * (landmark - body.position);
                own = *body_from_world.matrix();
                put(&mut by_body, (0, 0), &so3::hat(&seen));
                put(&mut by_body, (0, 6), &-body_from_world.matrix());
            }
        }
        Frame { own, by_body }
    }
    // ANCHOR_END: frame_of_landmark

    // ANCHOR: frames
    /// The frames of all variables.
    fn frames(self, values: &Values, body: Key<NavState>) -> Tied {
        let state = &values[body];
        let start = |index| values.coordinates_of(index).map_or(0, |own| own.start);
        let own = (start(body.index()), self.frame_of_body(state));
        let mut frames = Tied { body: own, poses: Vec::new(), landmarks: Vec::new() };
        for index in 0..values.len() {
            if let Some(key) = values.key(index) {
                frames.poses.push((start(index), self.frame_of_pose(state, &values[key])));
            } else if let Some(key) = values.key(index) {
                frames.landmarks.push((start(index), self.frame_of_landmark(state, &values[key])));
            }
        }
        frames
    }
    // ANCHOR_END: frames

    // ANCHOR: by_step
    /// The square matrix from a step whose numbers are the errors of each variable, in the order of
    /// the values, to the error in the chart. Implements {eq:invariant-error} and
    /// {eq:robocentric-error}.
    ///
    /// `body` is the state to which the others belong. Biases and calibration are their own errors.
    pub fn by_step(self, values: &Values, body: Key<NavState>) -> DMatrix<f64> {
        let mut matrix = DMatrix::identity(values.dimension(), values.dimension());
        self.frames(values, body).apply(&mut matrix);
        matrix
    }
    // ANCHOR_END: by_step

    // ANCHOR: retract
    /// The values after a step whose numbers are the errors of each variable, as the chart retracts
    /// them: the whole state as one. Implements {eq:invariant-retraction}.
    ///
    /// `body` is the state to which the others belong. Biases and calibration move by themselves.
    pub fn retract(self, values: &Values, body: Key<NavState>, step: &[f64]) -> Values {
        let mut moved = values.retract(step);
        if self == Self::Separate {
            return moved;
        }
        let frames = self.frames(values, body);
        let mut xi = DMatrix::from_column_slice(step.len(), 1, step);
        frames.apply(&mut xi);
        let part = |at: usize| xi.fixed_view::<3, 1>(at, 0).into_owned();
        let (old, at) = (values[body], frames.body.0);
        let [phi, rho, shift] = [0, 3, 6].map(|from| part(at + from));
        let pose = left(&BodyPose::from(&old), &phi, &shift);
        let velocity = match self {
            Self::Robocentric => {
                pose.world_from_body * (old.world_from_body.inverse() * old.velocity + rho)
            }
            _ => left_point(&old.velocity, &phi, &rho),
        };
        let state = NavState { velocity, ..pose.at_rest() };
        moved.set(body, state);
        for index in 0..values.len() {
            let at = values.coordinates_of(index).map_or(0, |own| own.start);
            if let Some(key) = values.key::<BodyPose>(index) {
                let xi = (&part(at), &part(at + 3));
                moved.set(key, self.moved_pose((&old, &state), &values[key], xi));
            } else if let Some(key) = values.key::<Vector3<f64>>(index) {
                moved.set(key, self.moved_point((&old, &state), &values[key], &phi, &part(at)));
            }
        }
        moved
    }
    // ANCHOR_END: retract

    /// A former pose after a step of the chart, when the body went from one state to another.
    fn moved_pose(
        self,
        (old, new): (&NavState, &NavState),
        pose: &BodyPose,
        (phi, shift): (&Vector3<f64>, &Vector3<f64>),
    ) -> BodyPose {
        if self != Self::Robocentric {
            return left(pose, phi, shift);
        }
        let body_from_world = old.world_from_body.inverse();
        let seen = body_from_world * (pose.position - old.position) + shift;
        let body_from_pose = so3::retract(&(body_from_world * pose.world_from_body), phi);
        BodyPose {
            world_from_body: new.world_from_body * body_from_pose,
            position: new.position + new.world_from_body * seen,
        }
    }

    /// A landmark after a step of the chart; `phi` is the turn of the body.
    fn moved_point(
        self,
        (old, new): (&NavState, &NavState),
        point: &Vector3<f64>,
        phi: &Vector3<f64>,
        xi: &Vector3<f64>,
    ) -> Vector3<f64> {
        match self {
            Self::Robocentric => {
                let seen = old.world_from_body.inverse() * (point - old.position) + xi;
                new.position + new.world_from_body * seen
            }
            Self::RightInvariant => left_point(point, phi, xi),
            Self::Separate | Self::RightInvariantPoses => point + xi,
        }
    }

    /// What takes errors at one estimate to those at another that are the same in the chart: the
    /// frame there, undone, after the frame here. Implements {eq:chart-transport}. `None` when an
    /// estimate is not finite.
    // ANCHOR: transport
    pub fn transport(
        self,
        (before, after): (&Values, &Values),
        body: Key<NavState>,
    ) -> Option<Transport> {
        let tied = self.frames(after, body).undone_after(&self.frames(before, body))?;
        tied.is_finite().then_some(Transport(tied))
    }
    // ANCHOR_END: transport
}

impl<const D: usize> Frame<D> {
    // ANCHOR: undone_after
    /// From errors before to errors after: own₊⁻¹ (own e + by_body e_body − by_body₊ T e_body), for the
    /// body's T.
    fn undone_after(&self, before: &Self, of_body: &SMatrix<f64, 9, 9>) -> Option<Self> {
        let inverse = self.own.try_inverse()?;
        let by_body = before.by_body - self.by_body * of_body;
        Some(Self { own: inverse * before.own, by_body: inverse * by_body })
    }
    // ANCHOR_END: undone_after
}

/// A matrix that ties each variable to itself and to the body's state alone: blocks with the places
/// where their rows begin.
struct Tied {
    body: (usize, SMatrix<f64, 9, 9>),
    poses: Vec<(usize, Frame<6>)>,
    landmarks: Vec<(usize, Frame<3>)>,
}

impl Tied {
    fn is_finite(&self) -> bool {
        fn all<const D: usize>(frames: &[(usize, Frame<D>)]) -> bool {
            let entries = |frame: &Frame<D>| frame.own.sum() + frame.by_body.sum();
            frames.iter().all(|(_, frame)| entries(frame).is_finite())
        }
        self.body.1.sum().is_finite() && all(&self.poses) && all(&self.landmarks)
    }

    // ANCHOR: tied_undone
    /// This matrix, undone, after another one of the same variables.
    fn undone_after(&self, before: &Self) -> Option<Self> {
        let of_body = self.body.1.try_inverse()? * before.body.1;
        let poses = undone_after(&self.poses, &before.poses, &of_body)?;
        let landmarks = undone_after(&self.landmarks, &before.landmarks, &of_body)?;
        Some(Self { body: (self.body.0, of_body), poses, landmarks })
    }
    // ANCHOR_END: tied_undone

    /// Multiplies a matrix with a row for each coordinate.
    fn apply(&self, errors: &mut DMatrix<f64>) {
        let (start, of_body) = &self.body;
        let body = errors.fixed_rows::<9>(*start).into_owned();
        errors.fixed_rows_mut::<9>(*start).copy_from(&(of_body * &body));
        self.poses.iter().for_each(|(start, frame)| frame.apply(*start, &body, errors));
        self.landmarks.iter().for_each(|(start, frame)| frame.apply(*start, &body, errors));
    }
}

/// The same block by block, for variables of one kind.
fn undone_after<const D: usize>(
    after: &[(usize, Frame<D>)],
    before: &[(usize, Frame<D>)],
    of_body: &SMatrix<f64, 9, 9>,
) -> Option<Vec<(usize, Frame<D>)>> {
    let pairs = after.iter().zip(before);
    let undone = |((start, after), (_, before)): (&(usize, Frame<D>), &(usize, Frame<D>))| {
        Some((*start, after.undone_after(before, of_body)?))
    };
    pairs.map(undone).collect()
}

/// What takes errors at one estimate to those at another.
pub struct Transport(Tied);

impl Transport {
    // ANCHOR: apply
    /// Takes each column of a matrix with a row for each coordinate there.
    pub fn apply(&self, errors: &mut DMatrix<f64>) {
        self.0.apply(errors);
    }

    /// Takes a covariance there, T P Tᵀ.
    pub fn carry(&self, covariance: &mut DMatrix<f64>) {
        self.apply(covariance);
        covariance.transpose_mut();
        self.apply(covariance);
    }
    // ANCHOR_END: apply
}

impl<const D: usize> Frame<D> {
    fn apply(&self, start: usize, body: &OMatrix<f64, U9, Dyn>, errors: &mut DMatrix<f64>) {
        let own = self.own * errors.fixed_rows::<D>(start);
        errors.fixed_rows_mut::<D>(start).copy_from(&(own + self.by_body * body));
    }
}

/// exp(φ, ρ) times a pose, in the group of motions.
fn left(pose: &BodyPose, phi: &Vector3<f64>, rho: &Vector3<f64>) -> BodyPose {
    BodyPose {
        world_from_body: so3::exp(phi) * pose.world_from_body,
        position: left_point(&pose.position, phi, rho),
    }
}

/// What exp(φ, ρ) does to a point.
fn left_point(point: &Vector3<f64>, phi: &Vector3<f64>, rho: &Vector3<f64>) -> Vector3<f64> {
    so3::exp(phi) * point + so3::left_jacobian(phi) * rho
}
