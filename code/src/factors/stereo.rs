//! A stereo observation by the pose of the left camera and the point that it shows.

use nalgebra::{Isometry3, Matrix3, Matrix3x6, Vector3};

use crate::least_squares::{Factor, Key};
use crate::two_views::{StereoFactor, StereoPinhole};

// ANCHOR: stereo_by_pose
/// What a stereo camera saw of a landmark: column on the left, row, column on the right.
#[derive(Debug, Clone, Copy)]
pub struct StereoByPose {
    /// `camera_from_world` of the left camera.
    pub pose: Key<Isometry3<f64>>,
    /// The landmark, in world coordinates.
    pub landmark: Key<Vector3<f64>>,
    /// The camera.
    pub camera: StereoPinhole,
    /// What was seen. Its indices are not used.
    pub observed: StereoFactor,
}

impl Factor<3> for StereoByPose {
    type Variables = (Isometry3<f64>, Vector3<f64>);
    type Jacobians = (Matrix3x6<f64>, Matrix3<f64>);

    fn variables(&self) -> (Key<Isometry3<f64>>, Key<Vector3<f64>>) {
        (self.pose, self.landmark)
    }

    fn residual(&self, values: (&Isometry3<f64>, &Vector3<f64>)) -> Option<Vector3<f64>> {
        self.linearize(values).map(|(residual, _)| residual)
    }

    fn linearize(
        &self,
        (pose, landmark): (&Isometry3<f64>, &Vector3<f64>),
    ) -> Option<(Vector3<f64>, Self::Jacobians)> {
        let predicted = self.camera.project_with_jacobians(pose, landmark)?;
        let linear = self.observed.linearize(&predicted);
        Some((linear.residual, (linear.by_pose, linear.by_point)))
    }
}
// ANCHOR_END: stereo_by_pose
