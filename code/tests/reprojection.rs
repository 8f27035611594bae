//! Worked examples of the pinhole camera.

use approx::assert_abs_diff_eq;
use nalgebra::{Isometry3, Vector2, Vector3};
use vislam::reprojection::{Pinhole, PinholeError, Z_MIN};

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
