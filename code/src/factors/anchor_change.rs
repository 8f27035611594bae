//! A landmark that is handed from one anchor to another.

use nalgebra::{Isometry3, Matrix3, Matrix3x6, SMatrix, Vector1, Vector3};

use super::anchored::{Scaled, Seen};
use super::exposure::Exposure;
use crate::inertial::NavState;
use crate::least_squares::{Factor, Key};
use crate::reprojection::Z_MIN;

// ANCHOR: anchor_change
/// That two landmarks, each by ray and inverse depth (x, y, ρ) in its own anchor, are one place. It is no
/// measurement, and its standard deviation is there to be far below that of any.
#[derive(Debug, Clone, Copy)]
pub struct AnchorChange {
    /// The state of the body at the two anchors, when the sensor's clock showed the time that the picture
    /// has on the camera's.
    pub anchors: [Key<NavState>; 2],
    /// The landmark by each of them.
    pub landmarks: [Key<Vector3<f64>>; 2],
    /// How the camera sits on the body: `body_from_camera`.
    pub extrinsics: Key<Isometry3<f64>>,
    /// What to add to the camera's time to get the sensor's, in seconds.
    pub time_offset: Key<Vector1<f64>>,
    /// The body's angular velocity at the two anchors, in its frame, in rad/s.
    pub angular_velocities: [Vector3<f64>; 2],
    /// One over the standard deviation of each of the three: of x and y, and of ρ in m.
    pub inverse_sigma: f64,
}
// ANCHOR_END: anchor_change

/// Values of the variables of an [`AnchorChange`], the anchors first.
type Around<'a> = (
    &'a NavState,
    &'a NavState,
    &'a Vector3<f64>,
    &'a Vector3<f64>,
    &'a Isometry3<f64>,
    &'a Vector1<f64>,
);

/// Derivatives by a step of each.
type ByChange = (
    SMatrix<f64, 3, 9>,
    SMatrix<f64, 3, 9>,
    Matrix3<f64>,
    Matrix3<f64>,
    Matrix3x6<f64>,
    Vector3<f64>,
);

// ANCHOR: carried
/// A landmark (x, y, ρ) of one anchor by another one, seen as a picture there sees it; `None` when it is not
/// in front of the camera.
pub(crate) fn carried(seen: Seen) -> Option<Vector3<f64>> {
    over_depth(&Scaled::of(seen), seen.3.z)
}

fn over_depth(scaled: &Scaled, inverse_depth: f64) -> Option<Vector3<f64>> {
    let depth = scaled.in_camera.z;
    let carried = scaled.in_camera.xy().push(inverse_depth) / depth;
    (depth > Z_MIN * inverse_depth.max(0.0)).then_some(carried)
}
// ANCHOR_END: carried

impl AnchorChange {
    fn exposures(&self) -> [Exposure<'_>; 2] {
        self.angular_velocities.each_ref().map(|angular_velocity| Exposure { angular_velocity })
    }
}

impl Factor<3> for AnchorChange {
    type Variables = (NavState, NavState, Vector3<f64>, Vector3<f64>, Isometry3<f64>, Vector1<f64>);
    type Jacobians = ByChange;

    fn variables(
        &self,
    ) -> (
        Key<NavState>,
        Key<NavState>,
        Key<Vector3<f64>>,
        Key<Vector3<f64>>,
        Key<Isometry3<f64>>,
        Key<Vector1<f64>>,
    ) {
        let ([from, to], [known, landmark]) = (self.anchors, self.landmarks);
        (from, to, known, landmark, self.extrinsics, self.time_offset)
    }

    fn residual(&self, around: Around) -> Option<Vector3<f64>> {
        let (from, to, known, landmark, extrinsics, offset) = around;
        let [first, second] = self.exposures();
        let (first, second) = (first.body(from, offset.x), second.body(to, offset.x));
        let carried = carried((&first, &second, extrinsics, known))?;
        Some(self.inverse_sigma * (carried - landmark))
    }

    // ANCHOR: anchor_change_linearize
    /// All three numbers are over the depth in the other anchor.
    fn linearize(&self, around: Around) -> Option<(Vector3<f64>, ByChange)> {
        let (from, to, known, landmark, extrinsics, offset) = around;
        let [at_first, at_second] = self.exposures();
        let (first, second) = (at_first.body(from, offset.x), at_second.body(to, offset.x));
        let seen: Seen = (&first, &second, extrinsics, known);
        let scaled = Scaled::of(seen);
        let carried = over_depth(&scaled, known.z)?;
        let mut by_camera = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0));
        by_camera.set_column(2, &(by_camera.column(2) - carried));
        let per_depth = self.inverse_sigma / scaled.in_camera.z;
        let (by_first, by_second, by_extrinsics, by_known) =
            scaled.slopes(seen, &(per_depth * by_camera), &(per_depth * Vector3::z()));
        let (by_from, early) = at_first.carry(&by_first, from, offset.x);
        let (by_to, late) = at_second.carry(&by_second, to, offset.x);
        let by_landmark = Matrix3::from_diagonal_element(-self.inverse_sigma);
        let slopes = (by_from, by_to, by_known, by_landmark, by_extrinsics, early + late);
        Some((self.inverse_sigma * (carried - landmark), slopes))
    }
    // ANCHOR_END: anchor_change_linearize
}
