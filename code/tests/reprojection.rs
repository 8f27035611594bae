//! Worked examples of cameras, of what moves a pixel, and of a lens that bends the image.

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{Isometry3, Matrix2x3, Matrix2x6, SMatrix, Vector2, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::manifold::se3;
use vislam::reprojection::{
    DistortedPinhole, Pinhole, PinholeError, RadialTangential, ReprojFactor, ReprojFactorError,
    UndistortError, Z_MIN,
};

fn camera() -> Pinhole {
    Pinhole::new(400.0, 400.0, 320.0, 240.0).expect("a valid camera")
}

#[test]
fn a_point_lands_at_its_slope_times_the_focal_length() {
    let pixel = camera().project_cam(&Vector3::new(0.2, -0.1, 5.0)).unwrap();
    assert_abs_diff_eq!(pixel, Vector2::new(336.0, 232.0), epsilon = 1e-12);
}

#[test]
fn each_axis_has_its_own_focal_length_and_principal_point() {
    let camera = Pinhole::new(100.0, 200.0, 30.0, 40.0).unwrap();
    let pixel = camera.project_cam(&Vector3::new(1.0, 1.0, 2.0)).unwrap();
    assert_abs_diff_eq!(pixel, Vector2::new(80.0, 140.0), epsilon = 1e-12);
}

#[test]
fn a_turned_and_moved_camera_sees_the_point_in_its_own_coordinates() {
    let quarter_turn_about_y = Vector3::y() * std::f64::consts::FRAC_PI_2;
    let camera_from_world = Isometry3::new(Vector3::new(0.0, 0.0, 1.0), quarter_turn_about_y);
    // The turn takes the world's -x axis to the camera's +z axis, and z to x.
    let pixel = camera().project(&camera_from_world, &Vector3::new(-4.0, 0.0, 0.5)).unwrap();
    assert_abs_diff_eq!(pixel, Vector2::new(400.0 * 0.5 / 5.0 + 320.0, 240.0), epsilon = 1e-12);
}

#[test]
fn a_point_has_a_pixel_only_beyond_the_nearest_depth() {
    let at_depth = |depth| camera().project_cam(&Vector3::new(0.0, 0.0, depth));
    assert_eq!(at_depth(-5.0), None);
    assert_eq!(at_depth(0.0), None);
    assert_eq!(at_depth(Z_MIN), None);
    assert_eq!(at_depth(Z_MIN + 1e-9), Some(Vector2::new(320.0, 240.0)));
}

#[test]
fn a_point_that_is_not_a_number_has_no_pixel() {
    for coordinate in 0..3 {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut point = Vector3::new(0.2, -0.1, 5.0);
            point[coordinate] = value;
            if let Some(pixel) = camera().project_cam(&point) {
                assert_eq!((coordinate, value), (2, f64::INFINITY));
                assert_eq!(pixel, Vector2::new(320.0, 240.0));
            }
        }
    }
}

#[test]
fn a_pixel_too_large_for_a_number_is_no_pixel() {
    assert_eq!(camera().project_cam(&Vector3::new(1e308, 0.0, 1.0)), None);
}

#[test]
fn a_camera_needs_positive_finite_focal_lengths() {
    for value in [0.0, -400.0, f64::NAN, f64::INFINITY] {
        assert!(Pinhole::new(value, 400.0, 320.0, 240.0).is_err());
        assert!(Pinhole::new(400.0, value, 320.0, 240.0).is_err());
    }
    let error = Pinhole::new(400.0, -400.0, 320.0, 240.0).unwrap_err();
    assert_eq!(error, PinholeError::FocalLength { name: "fy", value: -400.0 });
    assert_eq!(
        error.to_string(),
        "focal length fy is -400; give a positive, finite number of pixels"
    );
}

#[test]
fn a_principal_point_may_lie_anywhere_but_must_be_finite() {
    assert!(Pinhole::new(400.0, 400.0, -10.0, 0.0).is_ok());
    let error = Pinhole::new(400.0, 400.0, f64::NAN, 240.0).unwrap_err();
    assert_eq!(error.to_string(), "principal point cx is NaN; give a finite number of pixels");
}

// ANCHOR: worked_example
#[test]
fn a_milliradian_moves_the_pixel_and_a_centimetre_hardly() {
    let camera = Pinhole::new(400.0, 400.0, 320.0, 240.0).unwrap();
    let point = Vector3::new(0.2, -0.1, 5.0);
    let by_point_in_camera = camera.projection_jacobian(&point).unwrap();
    let expected = Matrix2x3::new(80.0, 0.0, -3.2, 0.0, 80.0, 1.6);
    assert_abs_diff_eq!(by_point_in_camera, expected, epsilon = 1e-12);

    let (by_pose, by_point) = camera.jacobians(&Isometry3::identity(), &point).unwrap();
    #[rustfmt::skip]
    let expected = Matrix2x6::new(
        80.0,  0.0, -3.2,    0.32, 400.64,  8.0,
         0.0, 80.0,  1.6, -400.16,  -0.32, 16.0,
    );
    assert_abs_diff_eq!(by_pose, expected, epsilon = 1e-12);
    assert_abs_diff_eq!(by_point, by_point_in_camera, epsilon = 1e-12);

    let milliradian_about_y = 1e-3 * by_pose.column(4);
    let centimetre_along_axis = 1e-2 * by_pose.column(2);
    assert_abs_diff_eq!(milliradian_about_y.x, 0.40064, epsilon = 1e-12);
    assert_abs_diff_eq!(centimetre_along_axis.x, -0.032, epsilon = 1e-12);
    assert_abs_diff_eq!(centimetre_along_axis.norm(), 0.036, epsilon = 5e-4);
}
// ANCHOR_END: worked_example

#[test]
fn the_ratio_of_turning_to_moving_depends_on_the_units() {
    let (by_pose, _) = camera().jacobians(&Isometry3::identity(), &worked_point()).unwrap();
    let pixels_per_radian = by_pose[(0, 4)].abs();
    let pixels_per_metre = by_pose[(0, 2)].abs();
    assert_abs_diff_eq!(pixels_per_radian / pixels_per_metre, 125.2, epsilon = 1e-12);
    let milliradian_to_centimetre = (1e-3 * pixels_per_radian) / (1e-2 * pixels_per_metre);
    assert_abs_diff_eq!(milliradian_to_centimetre, 12.52, epsilon = 1e-12);
}

#[test]
fn on_the_optical_axis_moving_forward_moves_nothing() {
    let jacobian = camera().projection_jacobian(&Vector3::new(0.0, 0.0, 5.0)).unwrap();
    assert_eq!(jacobian.column(2).norm(), 0.0);
}

#[test]
fn all_three_parts_come_from_one_call_or_one_by_one() {
    let mut random = Random::new(1);
    for _ in 0..100 {
        let (pinhole, pose, point) = random.state();
        let whole = pinhole.project_with_jacobians(&pose, &point).unwrap();
        let pixel = pinhole.project(&pose, &point).unwrap();
        assert_abs_diff_eq!(whole.pixel, pixel, epsilon = 1e-10);
        assert_eq!(pinhole.jacobians(&pose, &point), Some((whole.by_pose, whole.by_point)));
    }
}

#[test]
fn the_blocks_agree_with_central_differences() {
    let mut random = Random::new(2);
    for _ in 0..1000 {
        let (pinhole, pose, point) = random.state();
        let (by_pose, by_point) = pinhole.jacobians(&pose, &point).unwrap();
        let pixel_of_pose = |pose: &Isometry3<f64>| pinhole.project(pose, &point).unwrap();
        let differences = differences(|xi: Vector6<f64>| pixel_of_pose(&se3::retract(&pose, &xi)));
        assert_relative_eq!(by_pose, differences, max_relative = 1e-8, epsilon = 1e-5);
        let differences = self::differences(|step: Vector3<f64>| {
            pinhole.project(&pose, &(point + step)).unwrap()
        });
        assert_relative_eq!(by_point, differences, max_relative = 1e-8, epsilon = 1e-5);
    }
}

#[test]
fn the_jacobian_of_the_projection_agrees_with_central_differences() {
    let mut random = Random::new(3);
    for _ in 0..1000 {
        let (pinhole, pose, point) = random.state();
        let point_in_camera = pose.transform_point(&point.into()).coords;
        let jacobian = pinhole.projection_jacobian(&point_in_camera).unwrap();
        let pixel = |step: Vector3<f64>| pinhole.project_cam(&(point_in_camera + step)).unwrap();
        assert_relative_eq!(jacobian, differences(pixel), max_relative = 1e-8, epsilon = 1e-5);
    }
}

#[test]
fn a_step_on_the_left_becomes_one_on_the_right_by_the_adjoint() {
    let mut random = Random::new(4);
    for _ in 0..1000 {
        let (pinhole, pose, point) = random.state();
        let (by_pose, _) = pinhole.jacobians(&pose, &point).unwrap();
        let pixel = |xi| pinhole.project(&(se3::exp(&xi) * pose), &point).unwrap();
        let on_the_left: Matrix2x6<f64> = differences(pixel);
        let expected = on_the_left * se3::adjoint(&pose);
        assert_relative_eq!(by_pose, expected, max_relative = 1e-7, epsilon = 1e-4);
    }
}

#[test]
fn a_point_without_a_pixel_has_no_jacobians() {
    let identity = Isometry3::identity();
    for depth in [-5.0, 0.0, Z_MIN, f64::NAN, f64::NEG_INFINITY] {
        let point = Vector3::new(0.2, -0.1, depth);
        assert_eq!(camera().projection_jacobian(&point), None);
        assert_eq!(camera().jacobians(&identity, &point), None);
        assert_eq!(camera().project_with_jacobians(&identity, &point), None);
        assert_eq!(euroc().jacobians(&identity, &point), None);
    }
    // An infinite point may have a pixel, but nothing moves it by a finite amount.
    let infinitely_far = Vector3::new(0.0, 0.0, f64::INFINITY);
    assert_eq!(camera().jacobians(&identity, &infinitely_far), None);
    let lost = Isometry3::translation(0.0, f64::NAN, 0.0);
    assert_eq!(camera().jacobians(&lost, &worked_point()), None);
}

#[test]
fn a_factor_and_its_blocks_are_whitened() {
    let factor = ReprojFactor::new(3, 7, Vector2::new(337.0, 231.0), 2.0).unwrap();
    assert_eq!((factor.keyframe, factor.point), (3, 7));
    let predicted =
        camera().project_with_jacobians(&Isometry3::identity(), &worked_point()).unwrap();
    let linearized = factor.linearize(&predicted);
    assert_abs_diff_eq!(linearized.residual, Vector2::new(-0.5, 0.5), epsilon = 1e-12);
    assert_eq!(linearized.by_pose, 0.5 * predicted.by_pose);
    assert_eq!(linearized.by_point, 0.5 * predicted.by_point);
}

#[test]
fn one_undamped_step_with_a_factors_blocks_lowers_its_cost() {
    let mut random = Random::new(5);
    for _ in 0..100 {
        let (pinhole, pose, point) = random.state();
        let seen = pinhole.project(&pose, &point).unwrap() + random.vector::<2>(3.0);
        let factor = ReprojFactor::new(0, 0, seen, 1.5).unwrap();
        let at = |point| factor.linearize(&pinhole.project_with_jacobians(&pose, point).unwrap());
        let before = at(&point);
        // H d = -g with g = Jᵀ e; the smallest of the steps that solve it.
        let inverse = before.by_point.pseudo_inverse(1e-12).unwrap();
        let after = at(&(point - inverse * before.residual));
        assert!(after.residual.norm() < 0.1 * before.residual.norm());
    }
}

#[test]
fn an_observation_must_be_a_number_and_have_noise() {
    let error = ReprojFactor::new(3, 7, Vector2::new(f64::NAN, 1.0), 1.0).unwrap_err();
    let sentence = "keyframe 3, point 7: the pixel is (NaN, 1); leave the observation out";
    assert_eq!(error.to_string(), sentence);
    for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-310] {
        let error = ReprojFactor::new(3, 7, Vector2::zeros(), sigma).unwrap_err();
        assert!(matches!(error, ReprojFactorError::Sigma { keyframe: 3, point: 7, .. }));
    }
}

#[test]
fn the_order_of_the_coefficients_is_that_of_opencv() {
    let lens = |values: [f64; 5]| {
        let [k1, k2, p1, p2, k3] = values;
        RadialTangential::new(k1, k2, p1, p2, k3).unwrap().distort(&Vector2::new(0.5, 0.25))
    };
    let s: f64 = 0.3125;
    let ideal = Vector2::new(0.5, 0.25);
    assert_abs_diff_eq!(lens([1.0, 0.0, 0.0, 0.0, 0.0]), (1.0 + s) * ideal, epsilon = 1e-15);
    assert_abs_diff_eq!(lens([0.0, 1.0, 0.0, 0.0, 0.0]), (1.0 + s * s) * ideal, epsilon = 1e-15);
    assert_abs_diff_eq!(
        lens([0.0, 0.0, 0.0, 0.0, 1.0]),
        (1.0 + s.powi(3)) * ideal,
        epsilon = 1e-15
    );
    let by_p1 = Vector2::new(2.0 * 0.5 * 0.25, s + 2.0 * 0.0625);
    assert_abs_diff_eq!(lens([0.0, 0.0, 1.0, 0.0, 0.0]), ideal + by_p1, epsilon = 1e-15);
    let by_p2 = Vector2::new(s + 2.0 * 0.25, 2.0 * 0.5 * 0.25);
    assert_abs_diff_eq!(lens([0.0, 0.0, 0.0, 1.0, 0.0]), ideal + by_p2, epsilon = 1e-15);
}

#[test]
fn a_lens_without_coefficients_changes_nothing() {
    let lens = RadialTangential::new(0.0, 0.0, 0.0, 0.0, 0.0).unwrap();
    assert_eq!(lens.monotonic_radius(), f64::INFINITY);
    let camera = DistortedPinhole { pinhole: camera(), lens };
    let mut random = Random::new(6);
    for _ in 0..100 {
        let (_, pose, point) = random.state();
        let Some(expected) = camera.pinhole.project_with_jacobians(&pose, &point) else { continue };
        let projection = camera.project_with_jacobians(&pose, &point).unwrap();
        assert_abs_diff_eq!(projection.pixel, expected.pixel, epsilon = 1e-10);
        assert_relative_eq!(projection.by_pose, expected.by_pose, epsilon = 1e-9);
        assert_eq!(lens.undistort(&point.xy()), Ok(point.xy()));
    }
}

#[test]
fn the_jacobians_of_the_lens_agree_with_central_differences() {
    let mut random = Random::new(7);
    for _ in 0..1000 {
        let values = random.vector::<5>(0.2);
        let lens = lens_of(&values);
        let ideal = random.vector::<2>(1.0);
        let by_point = differences(|step: Vector2<f64>| lens.distort(&(ideal + step)));
        assert_abs_diff_eq!(lens.jacobian(&ideal), by_point, epsilon = 1e-8);
        let by_coefficients =
            differences(|step: SMatrix<f64, 5, 1>| lens_of(&(values + step)).distort(&ideal));
        let jacobian = RadialTangential::coefficient_jacobian(&ideal);
        assert_abs_diff_eq!(jacobian, by_coefficients, epsilon = 1e-8);
        assert_eq!(lens.coefficients().as_slice(), values.as_slice());
    }
}

#[test]
fn a_bent_projection_agrees_with_central_differences() {
    let mut random = Random::new(8);
    for _ in 0..1000 {
        let (_, pose, point) = random.state();
        let (by_pose, by_point) = euroc().jacobians(&pose, &point).unwrap();
        let moved = |xi: Vector6<f64>| euroc().project(&se3::retract(&pose, &xi), &point).unwrap();
        assert_relative_eq!(by_pose, differences(moved), max_relative = 1e-7, epsilon = 1e-5);
        let moved = |step: Vector3<f64>| euroc().project(&pose, &(point + step)).unwrap();
        assert_relative_eq!(by_point, differences(moved), max_relative = 1e-7, epsilon = 1e-5);
    }
}

// ANCHOR: euroc_round_trip
#[test]
fn every_pixel_of_a_real_camera_comes_back_from_its_bearing() {
    let pinhole = Pinhole::new(458.654, 457.296, 367.215, 248.375).unwrap();
    let [k1, k2, p1, p2] = [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05];
    let lens = RadialTangential::new(k1, k2, p1, p2, 0.0).unwrap();
    let camera = DistortedPinhole { pinhole, lens };
    for row in (0..=480).step_by(4) {
        for column in (0..=752).step_by(4) {
            let pixel = Vector2::new(f64::from(column), f64::from(row));
            let far_away = 100.0 * camera.bearing(&pixel).unwrap().into_inner();
            let seen = camera.project_cam(&far_away).unwrap();
            assert_abs_diff_eq!(seen, pixel, epsilon = 1e-11);
        }
    }
}
// ANCHOR_END: euroc_round_trip

#[test]
fn the_lens_and_its_inverse_cancel() {
    let mut random = Random::new(9);
    for _ in 0..1000 {
        let scale = SMatrix::<f64, 5, 1>::new(0.3, 0.1, 0.005, 0.005, 0.05);
        let lens = lens_of(&random.vector::<5>(1.0).component_mul(&scale));
        let radius = 0.8 * lens.monotonic_radius().min(1.2);
        let ideal = radius * random.vector::<2>(0.7);
        let found = lens.undistort(&lens.distort(&ideal)).unwrap();
        assert_abs_diff_eq!(found, ideal, epsilon = 1e-12);
    }
}

#[test]
fn beyond_a_fold_by_the_tangential_part_the_lens_shows_nothing_either() {
    let lens = RadialTangential::new(0.0, 0.0, -0.3, 0.0, 0.0).unwrap();
    assert_eq!(lens.monotonic_radius(), f64::INFINITY);
    let camera = DistortedPinhole { pinhole: camera(), lens };
    // Along y the lens shows y - 0.9 y², which grows up to 5/9.
    assert!(camera.project_cam(&Vector3::new(0.0, 0.55, 1.0)).is_some());
    assert_eq!(camera.project_cam(&Vector3::new(0.0, 0.56, 1.0)), None);
}

#[test]
fn beyond_the_fold_the_lens_shows_nothing() {
    // r - r³/3 grows up to r = 1, where it is 2/3.
    let lens = RadialTangential::new(-1.0 / 3.0, 0.0, 0.0, 0.0, 0.0).unwrap();
    assert_abs_diff_eq!(lens.monotonic_radius(), 1.0, epsilon = 1e-15);
    let inside = lens.undistort(&Vector2::new(0.666, 0.0)).unwrap();
    assert_abs_diff_eq!(lens.distort(&inside).x, 0.666, epsilon = 1e-12);
    assert!(inside.x < 1.0);
    let error = lens.undistort(&Vector2::new(0.0, 0.667)).unwrap_err();
    assert!(matches!(error, UndistortError::NoIdealPoint { reached, .. } if reached > 0.9));
    assert!(error.to_string().starts_with("the lens model shows nothing at (0, 0.667)"));

    let camera = DistortedPinhole { pinhole: camera(), lens };
    assert!(camera.project_cam(&Vector3::new(4.99, 0.0, 5.0)).is_some());
    // The polynomial alone would show this point right in the middle of the image.
    assert_eq!(camera.project_cam(&Vector3::new(8.66, 0.0, 5.0)), None);
}

#[test]
fn the_fold_is_the_first_root_of_the_slope_whatever_the_degree() {
    let radius =
        |k1, k2, k3| RadialTangential::new(k1, k2, 0.0, 0.0, k3).unwrap().monotonic_radius();
    assert_eq!(radius(0.3, 0.1, 0.05), f64::INFINITY);
    assert_abs_diff_eq!(radius(0.0, -0.2, 0.0), 1.0, epsilon = 1e-15);
    assert_abs_diff_eq!(radius(0.0, 0.0, -1.0 / 7.0), 1.0, epsilon = 1e-15);
    // 1 - 3 s + 2 s² has the roots 1/2 and 1, 1 - 2 s + s² a double one at 1.
    assert_abs_diff_eq!(radius(-1.0, 0.4, 0.0), 0.5_f64.sqrt(), epsilon = 1e-14);
    assert_abs_diff_eq!(radius(-2.0 / 3.0, 0.2, 0.0), 1.0, epsilon = 1e-7);
    // A tiny last coefficient moves the fold out, not to infinity.
    assert_relative_eq!(radius(0.0, 0.0, -1e-60 / 7.0), 1e10, max_relative = 1e-12);
    // The slope of EuRoC's lens never falls to zero.
    assert_eq!(euroc().lens.monotonic_radius(), f64::INFINITY);
}

#[test]
fn no_lens_has_a_coefficient_that_is_not_a_number() {
    for index in 0..5 {
        for value in [f64::NAN, f64::INFINITY] {
            let mut values = SMatrix::<f64, 5, 1>::zeros();
            values[index] = value;
            let [[k1, k2, p1, p2, k3]] = values.data.0;
            let error = RadialTangential::new(k1, k2, p1, p2, k3).unwrap_err();
            assert_eq!(error.name, ["k1", "k2", "p1", "p2", "k3"][index]);
        }
    }
    let error = RadialTangential::new(0.0, 0.0, f64::NAN, 0.0, 0.0).unwrap_err();
    assert_eq!(error.to_string(), "distortion coefficient p1 is NaN; give a finite number");
}

#[test]
fn a_pixel_that_is_not_a_number_has_no_bearing() {
    let error = euroc().bearing(&Vector2::new(f64::NAN, 0.0)).unwrap_err();
    assert!(matches!(error, UndistortError::NotFinite { .. }));
    let error = euroc().unproject(&Vector2::new(0.0, f64::INFINITY)).unwrap_err();
    assert!(matches!(error, UndistortError::NotFinite { .. }));
    let error = euroc().unproject(&Vector2::new(0.0, 1e300)).unwrap_err();
    assert!(matches!(error, UndistortError::NoIdealPoint { .. }));
}

fn worked_point() -> Vector3<f64> {
    Vector3::new(0.2, -0.1, 5.0)
}

fn euroc() -> DistortedPinhole {
    DistortedPinhole {
        pinhole: Pinhole::new(458.654, 457.296, 367.215, 248.375).unwrap(),
        lens: RadialTangential::new(-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0)
            .unwrap(),
    }
}

fn lens_of(values: &SMatrix<f64, 5, 1>) -> RadialTangential {
    let [[k1, k2, p1, p2, k3]] = values.data.0;
    RadialTangential::new(k1, k2, p1, p2, k3).unwrap()
}

/// The Jacobian at zero, by central differences of fourth order.
fn differences<const N: usize>(
    function: impl Fn(SMatrix<f64, N, 1>) -> Vector2<f64>,
) -> SMatrix<f64, 2, N> {
    let step = 1e-3;
    let columns = std::array::from_fn::<_, N, _>(|index| {
        let mut change = SMatrix::<f64, N, 1>::zeros();
        change[index] = step;
        let difference = |times: f64| function(times * change) - function(-times * change);
        (8.0 * difference(1.0) - difference(2.0)) / (12.0 * step)
    });
    SMatrix::from_columns(&columns)
}

/// Cameras, poses and points in front of them.
struct Random(ChaCha8Rng);

impl Random {
    fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Components between minus and plus `size`.
    fn vector<const N: usize>(&mut self, size: f64) -> SMatrix<f64, N, 1> {
        SMatrix::from_fn(|_, _| self.0.random_range(-size..size))
    }

    fn state(&mut self) -> (Pinhole, Isometry3<f64>, Vector3<f64>) {
        let fx = self.0.random_range(200.0..900.0);
        let fy = fx * self.0.random_range(0.8..1.3);
        let pinhole = Pinhole::new(fx, fy, 320.0, 240.0).unwrap();
        let pose = Isometry3::new(self.vector::<3>(2.0), self.vector::<3>(1.5));
        let slope = self.vector::<2>(0.6);
        let depth = self.0.random_range(1.0..20.0);
        let in_camera = depth * slope.push(1.0);
        (pinhole, pose, pose.inverse_transform_point(&in_camera.into()).coords)
    }
}
