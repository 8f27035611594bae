//! The example that is worked by hand: four cameras around one point, two of them on rails.

use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector2, Vector3};
use vislam::bundle_adjustment::{Camera, LinearizedPixel, Solver, TinyBa};
use vislam::least_squares::Options;
use vislam::reprojection::{Pinhole, ReprojFactor};

const CAMERA: Pinhole = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };

/// Where the cameras stand: left, right, above, below. All look along z.
pub const PLACES: [Vector3<f64>; 4] = [
    Vector3::new(-1.0, 0.0, 0.0),
    Vector3::new(1.0, 0.0, 0.0),
    Vector3::new(0.0, -1.0, 0.0),
    Vector3::new(0.0, 1.0, 0.0),
];

pub const POINT: Vector3<f64> = Vector3::new(0.0, 0.0, 4.0);

/// By how many pixels the column that each camera measured is off.
pub const OFF: [f64; 4] = [0.0, 0.0, 3.0, 1.0];

/// A camera on a rail along x. It looks along z.
#[derive(Clone)]
pub struct OnRail(pub Vector3<f64>);

impl Camera<1> for OnRail {
    fn project(&self, point_in_world: &Vector3<f64>) -> Option<Vector2<f64>> {
        CAMERA.project_cam(&(point_in_world - self.0))
    }

    fn differentiate(&self, point_in_world: &Vector3<f64>) -> Option<LinearizedPixel<1>> {
        let by_point = CAMERA.projection_jacobian(&(point_in_world - self.0))?;
        let pixel = self.project(point_in_world)?;
        // A twist moves the world, and the camera the other way.
        Some(LinearizedPixel { pixel, by_camera: by_point.column(0).into_owned(), by_point })
    }

    fn retract(&self, change: &SVector<f64, 1>) -> Self {
        Self(self.0 - change[0] * Vector3::x())
    }

    fn local(&self, to: &Self) -> SVector<f64, 1> {
        SVector::from([self.0.x - to.0.x])
    }

    fn local_jacobian(&self, _to: &Self) -> SMatrix<f64, 1, 1> {
        SMatrix::identity()
    }
}

pub fn solver() -> Solver<OnRail, 1> {
    let cameras = PLACES.map(OnRail).to_vec();
    let factors = (0..4).map(|keyframe| {
        let pixel = cameras[keyframe].project(&POINT).expect("the point lies in front");
        let pixel = pixel + OFF[keyframe] * Vector2::x();
        ReprojFactor { keyframe, point: 0, pixel, inverse_sigma: 1.0 }
    });
    let mut problem = TinyBa::new(cameras.clone(), vec![POINT], factors.collect());
    problem.fixed = vec![true, true, false, false];
    Solver::new(&problem, &Options::large_problem()).expect("a problem")
}

/// The curvature of each unknown before elimination: of a camera, and of the point along x.
pub fn curvatures() -> (f64, f64) {
    let rows = PLACES.map(|place| OnRail(place).differentiate(&POINT).expect("a pixel"));
    let camera = rows[2].by_camera.norm_squared();
    (camera, rows.iter().map(|row| row.by_point.column(0).norm_squared()).sum())
}

/// The gradient of the cost by the cameras on rails before elimination, and by the point along x.
pub fn gradient() -> ([f64; 2], f64) {
    let of = |k: usize| {
        let row = OnRail(PLACES[k]).differentiate(&POINT).expect("a pixel");
        let residual = -OFF[k];
        (row.by_camera[(0, 0)] * residual, row.by_point[(0, 0)] * residual)
    };
    ([of(2).0, of(3).0], (0..4).map(|k| of(k).1).sum())
}

/// The Schur complement and its right-hand side.
pub fn reduced() -> (DMatrix<f64>, DVector<f64>) {
    solver().schur_complement(0.0).expect("nothing is free")
}
