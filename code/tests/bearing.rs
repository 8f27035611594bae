//! Worked examples of what one view says and what a second one adds.

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{Isometry3, Matrix2x3, Rotation3, Vector2, Vector3};
use vislam::bearing::{
    InverseDepth, back_project, bearing, depth_from_disparity, depth_sigma, disparity,
    disparity_sigma, inverse_depth_sigma, parallax, pixel_of_direction, stretch_shift,
    transfer_by_infinite_homography,
};
use vislam::reprojection::{Pinhole, Z_MIN};

fn camera() -> Pinhole {
    Pinhole::new(400.0, 400.0, 320.0, 240.0).expect("a valid camera")
}

fn point() -> Vector3<f64> {
    Vector3::new(0.2, -0.1, 5.0)
}

// ANCHOR: worked_example
#[test]
fn two_views_fix_the_depth_that_one_view_leaves_open() {
    let camera = Pinhole::new(400.0, 400.0, 320.0, 240.0).unwrap();
    let first = Isometry3::identity();
    let second = Isometry3::translation(-0.5, 0.0, 0.0); // its centre is at x = +0.5 m
    let point = Vector3::new(0.2, -0.1, 5.0);

    let in_first = camera.project(&first, &point).unwrap();
    let in_second = camera.project(&second, &point).unwrap();
    assert_abs_diff_eq!(in_first, Vector2::new(336.0, 232.0), epsilon = 1e-12);
    assert_abs_diff_eq!(in_second, Vector2::new(296.0, 232.0), epsilon = 1e-12);

    let disparity = in_first.x - in_second.x;
    assert_abs_diff_eq!(disparity, 40.0, epsilon = 1e-12);
    let depth = depth_from_disparity(&camera, 0.5, disparity).unwrap();
    assert_abs_diff_eq!(depth, 5.0, epsilon = 1e-12);

    let stretched = 1.1 * point;
    let first_move = camera.project(&first, &stretched).unwrap() - in_first;
    let second_move = camera.project(&second, &stretched).unwrap() - in_second;
    assert_abs_diff_eq!(first_move, Vector2::zeros(), epsilon = 1e-12);
    assert_abs_diff_eq!(second_move, Vector2::new(40.0 / 11.0, 0.0), epsilon = 1e-12);
}
// ANCHOR_END: worked_example

#[test]
fn a_pixel_of_disparity_noise_costs_more_depth_far_away_and_on_a_short_baseline() {
    assert_abs_diff_eq!(depth_sigma(&camera(), 0.5, 5.0, 1.0), 0.125, epsilon = 1e-15);
    assert_abs_diff_eq!(depth_sigma(&camera(), 0.5, 10.0, 1.0), 0.5, epsilon = 1e-15);
    assert_abs_diff_eq!(depth_sigma(&camera(), 0.1, 5.0, 1.0), 0.625, epsilon = 1e-15);
}

#[test]
fn a_pixel_of_noise_in_each_image_is_more_than_a_pixel_of_disparity_noise() {
    let both = disparity_sigma(1.0, 1.0);
    assert_abs_diff_eq!(both, std::f64::consts::SQRT_2, epsilon = 1e-15);
    assert_abs_diff_eq!(depth_sigma(&camera(), 0.5, 5.0, both), 0.177, epsilon = 5e-4);
}

#[test]
fn a_metre_of_depth_error_shows_less_on_a_short_baseline_and_less_when_too_far() {
    let shift =
        |baseline, assumed_depth| stretch_shift(&camera(), baseline, 5.0, assumed_depth / 5.0);
    assert_abs_diff_eq!(shift(0.5, 4.0), -10.0, epsilon = 1e-12);
    assert_abs_diff_eq!(shift(0.5, 6.0), 20.0 / 3.0, epsilon = 1e-12);
    assert_abs_diff_eq!(shift(0.1, 4.0), -2.0, epsilon = 1e-12);
    assert_abs_diff_eq!(shift(0.1, 6.0), 4.0 / 3.0, epsilon = 1e-12);
}

#[test]
fn the_whole_ray_of_a_pixel_has_that_pixel() {
    let pixel = Vector2::new(336.0, 232.0);
    let direction = bearing(&camera(), &pixel);
    for distance in [0.1, 1.0, 5.0, 1e6] {
        let seen = camera().project_cam(&(direction.into_inner() * distance)).unwrap();
        assert_abs_diff_eq!(seen, pixel, epsilon = 1e-10);
    }
    assert_abs_diff_eq!(back_project(&camera(), &pixel, 5.0), point(), epsilon = 1e-12);
}

#[test]
fn a_direction_has_a_pixel_only_when_it_points_forward() {
    assert_eq!(pixel_of_direction(&camera(), &Vector3::z()), Some(Vector2::new(320.0, 240.0)));
    assert_eq!(pixel_of_direction(&camera(), &(1e-6 * Vector3::z())).unwrap().x, 320.0);
    assert_eq!(pixel_of_direction(&camera(), &Vector3::x()), None);
    assert_eq!(pixel_of_direction(&camera(), &-Vector3::z()), None);
    assert_eq!(pixel_of_direction(&camera(), &Vector3::repeat(f64::NAN)), None);
}

#[test]
fn a_world_of_twice_the_size_makes_the_same_pictures() {
    let rotation = Rotation3::from_euler_angles(0.1, -0.2, 0.3);
    let centre = Vector3::new(0.4, -0.3, 0.2);
    let picture = |scale: f64| {
        let translation = -(rotation * (scale * centre));
        let camera_from_world = Isometry3::from_parts(translation.into(), rotation.into());
        camera().project(&camera_from_world, &(scale * point())).unwrap()
    };
    assert_abs_diff_eq!(picture(2.0), picture(1.0), epsilon = 1e-10);
}

#[test]
fn a_turn_on_the_spot_leaves_no_trace_of_depth() {
    let second_from_first = Rotation3::from_euler_angles(0.05, -0.1, 0.2);
    let pixel = Vector2::new(336.0, 232.0);
    let expected = transfer_by_infinite_homography(&camera(), &second_from_first, &pixel).unwrap();
    for depth in [0.5, 5.0, 500.0] {
        let turned = second_from_first * back_project(&camera(), &pixel, depth);
        let seen = camera().project_cam(&turned).unwrap();
        assert_abs_diff_eq!(seen, expected, epsilon = 1e-10);
    }
}

#[test]
fn a_pixel_can_turn_out_of_sight() {
    let half_turn = Rotation3::from_axis_angle(&Vector3::y_axis(), std::f64::consts::PI);
    assert_eq!(
        transfer_by_infinite_homography(&camera(), &half_turn, &Vector2::new(336.0, 232.0)),
        None
    );
}

#[test]
fn parallax_is_the_angle_at_the_point() {
    let origin = Vector3::zeros();
    let right = Vector3::new(0.5, 0.0, 0.0);
    let ahead = Vector3::new(0.0, 0.0, 5.0);
    assert_abs_diff_eq!(parallax(&ahead, &origin, &right), 0.1_f64.atan(), epsilon = 1e-15);
    assert_eq!(parallax(&ahead, &origin, &origin), 0.0);
    assert_eq!(parallax(&origin, &origin, &right), 0.0);
    assert_eq!(parallax(&origin, &origin, &Vector3::new(1.0, 1.0, 1.0)), 0.0);
}

#[test]
fn tiny_parallax_is_not_rounded_away() {
    let far = Vector3::new(0.0, 0.0, 1e9);
    let angle = parallax(&far, &Vector3::zeros(), &Vector3::new(0.5, 0.0, 0.0));
    assert_relative_eq!(angle, 0.5e-9, max_relative = 1e-12);
}

#[test]
fn a_disparity_that_is_not_positive_has_no_depth() {
    assert_abs_diff_eq!(disparity(&camera(), 0.5, 5.0), 40.0, epsilon = 1e-12);
    assert_eq!(depth_from_disparity(&camera(), 0.5, 40.0), Some(5.0));
    for disparity in [0.0, -1.0, f64::NAN] {
        assert_eq!(depth_from_disparity(&camera(), 0.5, disparity), None);
    }
}

#[test]
fn inverse_depth_and_depth_are_the_same_point() {
    let landmark = InverseDepth::from_pixel(&camera(), &Vector2::new(336.0, 232.0), 0.2);
    assert_abs_diff_eq!(landmark.point().unwrap(), point(), epsilon = 1e-12);
    let second_from_first = Isometry3::translation(-0.5, 0.0, 0.0);
    let pixel = landmark.project_into(&camera(), &second_from_first).unwrap();
    assert_abs_diff_eq!(pixel, Vector2::new(296.0, 232.0), epsilon = 1e-12);
}

#[test]
fn a_point_at_infinity_has_pixels_but_no_place() {
    let pixel = Vector2::new(336.0, 232.0);
    let landmark = InverseDepth::from_pixel(&camera(), &pixel, 0.0);
    assert_eq!(landmark.point(), None);
    let sideways = Isometry3::translation(-0.5, 0.0, 0.0);
    assert_abs_diff_eq!(
        landmark.project_into(&camera(), &sideways).unwrap(),
        pixel,
        epsilon = 1e-12
    );
}

#[test]
fn noise_may_push_inverse_depth_beyond_infinity() {
    let landmark = InverseDepth::from_pixel(&camera(), &Vector2::new(336.0, 232.0), -0.01);
    assert_eq!(landmark.point(), None);
    let sideways = Isometry3::translation(-0.5, 0.0, 0.0);
    let pixel = landmark.project_into(&camera(), &sideways).unwrap();
    assert_abs_diff_eq!(pixel, Vector2::new(338.0, 232.0), epsilon = 1e-12);
}

#[test]
fn a_point_the_second_camera_has_passed_has_no_pixel() {
    let landmark = InverseDepth { x: 0.0, y: 0.0, inverse_depth: 0.5 };
    let ahead = |metres: f64| Isometry3::translation(0.0, 0.0, -metres);
    assert!(landmark.project_into(&camera(), &ahead(1.9)).is_some());
    assert!(landmark.project_into(&camera(), &ahead(2.0 - 0.9 * Z_MIN)).is_none());
    assert!(landmark.project_into(&camera(), &ahead(3.0)).is_none());
    assert!(landmark.project_with_jacobian(&camera(), &ahead(3.0)).is_none());
    let lost = InverseDepth { inverse_depth: f64::NAN, ..landmark };
    assert!(lost.project_into(&camera(), &ahead(1.0)).is_none());
}

#[test]
fn the_inverse_depth_jacobian_agrees_with_differences_even_at_infinity() {
    let rotation = Vector3::new(0.05, -0.1, 0.2);
    let second_from_first = Isometry3::new(Vector3::new(-0.5, 0.1, 0.3), rotation);
    for inverse_depth in [0.0, 0.2, 1.5] {
        let parameters = Vector3::new(0.04, -0.02, inverse_depth);
        let pixel = |p: Vector3<f64>| {
            let landmark = InverseDepth { x: p.x, y: p.y, inverse_depth: p.z };
            landmark.project_into(&camera(), &second_from_first).unwrap()
        };
        let step = 1e-5;
        let column = |i| {
            let change = step * Vector3::ith(i, 1.0);
            (pixel(parameters + change) - pixel(parameters - change)) / (2.0 * step)
        };
        let differences = Matrix2x3::from_columns(&[column(0), column(1), column(2)]);
        let landmark = InverseDepth { x: 0.04, y: -0.02, inverse_depth };
        let (_, jacobian) = landmark.project_with_jacobian(&camera(), &second_from_first).unwrap();
        assert_relative_eq!(jacobian, differences, max_relative = 1e-7);
    }
}

#[test]
fn inverse_depth_is_equally_certain_at_every_range() {
    let sigma = inverse_depth_sigma(&camera(), 0.5, 1.0);
    for depth in [1.0, 5.0, 100.0] {
        let one_pixel_nearer =
            depth_from_disparity(&camera(), 0.5, disparity(&camera(), 0.5, depth) + 1.0).unwrap();
        assert_relative_eq!(1.0 / one_pixel_nearer - 1.0 / depth, sigma, max_relative = 1e-12);
    }
}
