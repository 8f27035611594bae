//! A pixel by the pose of the body and a landmark.

use factrs::linalg::{Const, ForwardProp, Numeric, VectorX};
use factrs::residuals::Residual2;
use factrs::traits::Variable;
use factrs::variables::{MatrixLieGroup, SE3, VectorVar3};
use vislam::reprojection::Pinhole;

// ANCHOR: reprojection
/// Where a landmark should be seen, less where it was, in pixels.
#[derive(Clone, Debug)]
pub struct Reprojection {
    pub camera: Pinhole,
    pub camera_from_body: SE3,
    pub pixel: [f64; 2],
}

// ANCHOR: seen
#[factrs::mark]
impl Residual2 for Reprojection {
    type V1 = SE3;
    type V2 = VectorVar3;
    type DimIn = Const<9>;
    type DimOut = Const<2>;
    type Differ = ForwardProp<Const<9>>;

    fn residual2<T: Numeric>(&self, body: SE3<T>, landmark: VectorVar3<T>) -> VectorX<T> {
        let in_body = body.inverse().apply(landmark.0.as_view());
        let p = self.camera_from_body.cast::<T>().apply(in_body.as_view());
        let (Pinhole { fx, fy, cx, cy }, [u, v]) = (self.camera, self.pixel);
        VectorX::from_vec(vec![
            p.x / p.z * T::from(fx) + T::from(cx - u),
            p.y / p.z * T::from(fy) + T::from(cy - v),
        ])
    }
}
// ANCHOR_END: seen
// ANCHOR_END: reprojection
