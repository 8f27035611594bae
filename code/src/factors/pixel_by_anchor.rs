//! A pixel of a landmark that is known by the picture that first showed it, its anchor: by the ray (x, y, 1)
//! in the camera of the anchor and the inverse depth ρ along it, so that the landmark lies at (x, y, 1)/ρ.

use nalgebra::{Isometry3, Matrix2x3, Matrix2x6, SMatrix, Vector1, Vector2, Vector3};

use super::anchored::{BySeen, Scaled, Seen};
use super::exposure::Exposure;
use crate::inertial::NavState;
use crate::least_squares::{Factor, Key};
use crate::reprojection::RigCamera;

// ANCHOR: anchored_pixel
/// A pixel of an anchored landmark by the poses that the body had when the two pictures were taken.
#[derive(Debug, Clone, Copy)]
pub struct AnchoredPixel<'a> {
    /// The camera that saw it.
    pub camera: &'a RigCamera,
    /// The measured pixel.
    pub pixel: Vector2<f64>,
    /// One over its standard deviation, in 1/pixel.
    pub inverse_sigma: f64,
}
// ANCHOR_END: anchored_pixel

impl AnchoredPixel<'_> {
    /// Prediction minus measurement, in standard deviations; `None` for a landmark that is not in
    /// front of the camera.
    pub fn residual(&self, seen: Seen) -> Option<Vector2<f64>> {
        let (pixel, ..) = self.camera.project_scaled(&Scaled::of(seen).in_camera, seen.3.z)?;
        Some(self.inverse_sigma * (pixel - self.pixel))
    }

    // ANCHOR: anchored_pixel_linearize
    /// The residual and its derivatives: 2×6 by a step (φ, p) of the body at the anchor, 2×6 by one of the
    /// body at the picture, 2×6 by the extrinsics T_bc exp(ξ), which are there at both, and 2×3 by
    /// (x, y, ρ). A shift of both bodies changes nothing, whatever the landmark is.
    pub fn linearize(&self, seen: Seen) -> Option<(Vector2<f64>, BySeen<2>)> {
        let scaled = Scaled::of(seen);
        let (pixel, by_camera, by_scale) =
            self.camera.project_scaled(&scaled.in_camera, seen.3.z)?;
        let by_camera = self.inverse_sigma * by_camera;
        let slopes = scaled.slopes(seen, &by_camera, &(self.inverse_sigma * by_scale));
        Some((self.inverse_sigma * (pixel - self.pixel), slopes))
    }
    // ANCHOR_END: anchored_pixel_linearize
}

// ANCHOR: pixel_by_anchor
/// A pixel at which a camera on a moving body saw a landmark that another picture is the anchor of.
#[derive(Debug, Clone, Copy)]
pub struct PixelByAnchor {
    /// The state of the body at the anchor, when the sensor's clock showed the time that the picture has
    /// on the camera's.
    pub anchor: Key<NavState>,
    /// The state of the body at the picture, likewise.
    pub state: Key<NavState>,
    /// The landmark (x, y, ρ) in the first camera at the anchor, without unit, and ρ in 1/m.
    pub landmark: Key<Vector3<f64>>,
    /// How the first camera sits on the body: `body_from_camera`.
    pub extrinsics: Key<Isometry3<f64>>,
    /// What to add to the cameras' time to get the sensor's, in seconds.
    pub time_offset: Key<Vector1<f64>>,
    /// The camera that saw it.
    pub camera: RigCamera,
    /// The body's angular velocity at the anchor and at the picture, in its frame, in rad/s. It enters only
    /// through the time offset.
    pub angular_velocities: [Vector3<f64>; 2],
    /// The measured pixel.
    pub pixel: Vector2<f64>,
    /// One over its standard deviation, in 1/pixel.
    pub inverse_sigma: f64,
}
// ANCHOR_END: pixel_by_anchor

/// Values of the variables of a [`PixelByAnchor`].
type Around<'a> =
    (&'a NavState, &'a NavState, &'a Vector3<f64>, &'a Isometry3<f64>, &'a Vector1<f64>);

/// Derivatives by a step of each.
type ByAnchor =
    (SMatrix<f64, 2, 9>, SMatrix<f64, 2, 9>, Matrix2x3<f64>, Matrix2x6<f64>, Vector2<f64>);

impl PixelByAnchor {
    fn measured(&self) -> AnchoredPixel<'_> {
        let Self { ref camera, pixel, inverse_sigma, .. } = *self;
        AnchoredPixel { camera, pixel, inverse_sigma }
    }

    fn exposures(&self) -> [Exposure<'_>; 2] {
        self.angular_velocities.each_ref().map(|angular_velocity| Exposure { angular_velocity })
    }
}

impl Factor<2> for PixelByAnchor {
    type Variables = (NavState, NavState, Vector3<f64>, Isometry3<f64>, Vector1<f64>);
    type Jacobians = ByAnchor;

    fn variables(
        &self,
    ) -> (Key<NavState>, Key<NavState>, Key<Vector3<f64>>, Key<Isometry3<f64>>, Key<Vector1<f64>>)
    {
        (self.anchor, self.state, self.landmark, self.extrinsics, self.time_offset)
    }

    fn residual(
        &self,
        (anchor, state, landmark, extrinsics, offset): Around,
    ) -> Option<Vector2<f64>> {
        let [at_anchor, at_picture] = self.exposures();
        let (first, second) = (at_anchor.body(anchor, offset.x), at_picture.body(state, offset.x));
        self.measured().residual((&first, &second, extrinsics, landmark))
    }

    // ANCHOR: pixel_by_anchor_linearize
    /// Both states are earlier than their pictures by the time offset.
    fn linearize(
        &self,
        (anchor, state, landmark, extrinsics, offset): Around,
    ) -> Option<(Vector2<f64>, ByAnchor)> {
        let [at_anchor, at_picture] = self.exposures();
        let (first, second) = (at_anchor.body(anchor, offset.x), at_picture.body(state, offset.x));
        let (residual, (by_first, by_second, by_extrinsics, by_landmark)) =
            self.measured().linearize((&first, &second, extrinsics, landmark))?;
        let (by_anchor, early) = at_anchor.carry(&by_first, anchor, offset.x);
        let (by_state, late) = at_picture.carry(&by_second, state, offset.x);
        Some((residual, (by_anchor, by_state, by_landmark, by_extrinsics, early + late)))
    }
    // ANCHOR_END: pixel_by_anchor_linearize
}

// ANCHOR: pixel_at_anchor
/// A pixel of a landmark in the very picture that is its anchor: of the first camera, which tells the
/// ray, or of another one, which tells the inverse depth too. Where the body was does not matter.
#[derive(Debug, Clone, Copy)]
pub struct PixelAtAnchor {
    /// The landmark (x, y, ρ) in the first camera.
    pub landmark: Key<Vector3<f64>>,
    /// The camera that saw it.
    pub camera: RigCamera,
    /// The measured pixel.
    pub pixel: Vector2<f64>,
    /// One over its standard deviation, in 1/pixel.
    pub inverse_sigma: f64,
}

impl Factor<2> for PixelAtAnchor {
    type Variables = (Vector3<f64>,);
    type Jacobians = (Matrix2x3<f64>,);

    fn variables(&self) -> (Key<Vector3<f64>>,) {
        (self.landmark,)
    }

    fn residual(&self, values: (&Vector3<f64>,)) -> Option<Vector2<f64>> {
        self.linearize(values).map(|(residual, _)| residual)
    }

    fn linearize(
        &self,
        (landmark,): (&Vector3<f64>,),
    ) -> Option<(Vector2<f64>, (Matrix2x3<f64>,))> {
        let ray = landmark.xy().push(1.0);
        let (pixel, mut by_landmark, by_scale) = self.camera.project_scaled(&ray, landmark.z)?;
        by_landmark.set_column(2, &by_scale);
        Some((self.inverse_sigma * (pixel - self.pixel), (self.inverse_sigma * by_landmark,)))
    }
}
// ANCHOR_END: pixel_at_anchor
