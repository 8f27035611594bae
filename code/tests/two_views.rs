//! Worked examples of two views and the points they fix.

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{
    Isometry3, Matrix3, Matrix3x6, Rotation3, SMatrix, SVector, Vector2, Vector3, Vector6,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use vislam::bearing::{bearing, depth_sigma, disparity_sigma, parallax};
use vislam::manifold::se3;
use vislam::reprojection::{Pinhole, ReprojFactor, Z_MIN};
use vislam::two_views::{
    EssentialError, LEAST_PARALLAX, StereoError, StereoFactor, StereoPinhole, TriangulationError,
    View, depth_bias, epipolar_line, epipolar_residual, essential_matrix, fundamental_matrix,
    point_condition, ray_depths, ray_sigma, relative_pose, relative_poses, sampson_distance,
    scale_direction, triangulate, triangulate_nonlinear,
};

fn camera() -> Pinhole {
    Pinhole::new(400.0, 400.0, 320.0, 240.0).expect("a valid camera")
}

fn point() -> Vector3<f64> {
    Vector3::new(0.2, -0.1, 5.0)
}

/// The views of two cameras side by side, with noise of one pixel.
fn views_of(point: &Vector3<f64>, baseline: f64) -> [View; 2] {
    [0.0, baseline].map(|x| seen_from(Isometry3::translation(-x, 0.0, 0.0), point))
}

fn seen_from(camera_from_world: Isometry3<f64>, point: &Vector3<f64>) -> View {
    let pixel = camera().project(&camera_from_world, point).expect("a point in front");
    View { camera: camera(), camera_from_world, pixel, sigma: 1.0 }
}

fn random() -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(3)
}

fn vector(random: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.random_range(-1.0..1.0))
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.random_range(0.0..1.0_f64)).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random_range(0.0..1.0)).cos()
}

fn motion(random: &mut ChaCha8Rng) -> Isometry3<f64> {
    let translation = vector(random).normalize() * random.random_range(0.3..1.0);
    Isometry3::new(translation, 0.3 * vector(random))
}

fn point_ahead(random: &mut ChaCha8Rng) -> Vector3<f64> {
    let slopes = 0.4 * vector(random);
    random.random_range(3.0..12.0) * Vector3::new(slopes.x, slopes.y, 1.0)
}

/// Three views of one point, none of them special.
fn three_views(random: &mut ChaCha8Rng) -> (Vector3<f64>, [View; 3]) {
    let point = point_ahead(random);
    let poses = [Isometry3::identity(), motion(random), motion(random)];
    (point, poses.map(|pose| seen_from(pose, &point)))
}

// ANCHOR: worked_example
#[test]
fn two_pixels_give_back_the_point_and_say_how_sure_it_is() {
    let camera = Pinhole::new(400.0, 400.0, 320.0, 240.0).unwrap();
    let poses = [Isometry3::identity(), Isometry3::translation(-0.5, 0.0, 0.0)];
    let pixels = [Vector2::new(336.0, 232.0), Vector2::new(296.0, 232.0)];
    let view =
        |k: usize| View { camera, camera_from_world: poses[k], pixel: pixels[k], sigma: 1.0 };

    let essential = essential_matrix(&poses[1]);
    let expected = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, -0.5, 0.0);
    assert_abs_diff_eq!(essential, expected, epsilon = 1e-15);
    let [first, second] = pixels.map(|pixel| bearing(&camera, &pixel).into_inner());
    assert_abs_diff_eq!(epipolar_residual(&essential, &first, &second), 0.0, epsilon = 1e-15);

    let views = [view(0), view(1)];
    let start = triangulate(&views, LEAST_PARALLAX).unwrap();
    let found = triangulate_nonlinear(&views, &start).unwrap();
    assert_abs_diff_eq!(found.point, Vector3::new(0.2, -0.1, 5.0), epsilon = 1e-12);

    // By hand: a disparity of 40 px with noise of √2 px, Z²/(f b) = 25/200 m per pixel.
    let sigma_z = found.covariance.m33.sqrt();
    assert_abs_diff_eq!(sigma_z, 0.125 * 2.0_f64.sqrt(), epsilon = 1e-12);
    assert_abs_diff_eq!(found.bias.z, sigma_z * sigma_z / 5.0, epsilon = 1e-12);
}
// ANCHOR_END: worked_example

#[test]
fn the_worked_pixels_are_those_of_the_worked_point() {
    let [first, second] = views_of(&point(), 0.5);
    assert_abs_diff_eq!(first.pixel, Vector2::new(336.0, 232.0), epsilon = 1e-12);
    assert_abs_diff_eq!(second.pixel, Vector2::new(296.0, 232.0), epsilon = 1e-12);
    assert_abs_diff_eq!(first.pixel.x - second.pixel.x, 40.0, epsilon = 1e-12);
}

#[test]
fn two_directions_of_one_point_and_the_baseline_lie_in_one_plane() {
    let mut random = random();
    for _ in 0..500 {
        let (second_from_first, point) = (motion(&mut random), point_ahead(&mut random));
        let second = second_from_first * nalgebra::Point3::from(point);
        let essential = essential_matrix(&second_from_first);
        let residual =
            epipolar_residual(&essential, &point.normalize(), &second.coords.normalize());
        assert_abs_diff_eq!(residual, 0.0, epsilon = 1e-12);
    }
}

#[test]
fn the_essential_matrix_does_not_know_how_long_the_baseline_is() {
    let mut random = random();
    let short = motion(&mut random);
    let long = Isometry3::from_parts((7.0 * short.translation.vector).into(), short.rotation);
    let ratio = essential_matrix(&long) - 7.0 * essential_matrix(&short);
    assert_abs_diff_eq!(ratio, Matrix3::zeros(), epsilon = 1e-14);
}

#[test]
fn the_essential_matrix_has_five_degrees_of_freedom() {
    let mut random = random();
    for _ in 0..100 {
        let motion = motion(&mut random);
        // Unit length, so that the length of the baseline does not count as a freedom.
        let unit = |xi: &Vector6<f64>| {
            let essential = essential_matrix(&se3::retract(&motion, xi));
            SVector::<f64, 9>::from_column_slice((essential / essential.norm()).as_slice())
        };
        let step = 1e-6;
        let mut jacobian = SMatrix::<f64, 9, 6>::zeros();
        for column in 0..6 {
            let xi = step * Vector6::ith(column, 1.0);
            jacobian.set_column(column, &((unit(&xi) - unit(&-xi)) / (2.0 * step)));
        }
        let singular = jacobian.singular_values();
        assert!(singular[4] > 1e-2, "{singular}");
        assert!(singular[5] < 1e-8, "{singular}");
    }
}

#[test]
fn an_essential_matrix_has_two_equal_singular_values_and_a_zero() {
    let mut random = random();
    for _ in 0..100 {
        let motion = motion(&mut random);
        let length = motion.translation.vector.norm();
        let values = essential_matrix(&motion).singular_values();
        assert_abs_diff_eq!(values, Vector3::new(length, length, 0.0), epsilon = 1e-14);
    }
}

#[test]
fn a_pure_rotation_has_no_essential_matrix() {
    let turn = Isometry3::rotation(Vector3::new(0.1, -0.3, 0.2));
    assert_eq!(essential_matrix(&turn), Matrix3::zeros());
    assert_eq!(relative_poses(&essential_matrix(&turn)), Err(EssentialError::Zero));
}

#[test]
fn pixels_lie_on_their_epipolar_lines() {
    let mut random = random();
    let second_camera = Pinhole::new(700.0, 650.0, 300.0, 200.0).unwrap();
    for _ in 0..100 {
        let (second_from_first, point) = (motion(&mut random), point_ahead(&mut random));
        let first = camera().project(&Isometry3::identity(), &point).unwrap();
        let second = second_camera.project(&second_from_first, &point).unwrap();
        let essential = essential_matrix(&second_from_first);
        let fundamental = fundamental_matrix(&camera(), &second_camera, &essential);
        let line = epipolar_line(&fundamental, &first).unwrap();
        let across = line.xy();
        assert_abs_diff_eq!(line.dot(&second.push(1.0)), 0.0, epsilon = 1e-9);
        let beside = second + 3.0 * across;
        assert_abs_diff_eq!(line.dot(&beside.push(1.0)), 3.0, epsilon = 1e-9);
        assert_abs_diff_eq!(
            sampson_distance(&fundamental, &first, &second).unwrap(),
            0.0,
            epsilon = 1e-9
        );
    }
}

#[test]
fn the_epipole_and_a_turning_camera_have_no_epipolar_line() {
    let forward = essential_matrix(&Isometry3::translation(0.0, 0.0, -1.0));
    let fundamental = fundamental_matrix(&camera(), &camera(), &forward);
    assert_eq!(epipolar_line(&fundamental, &Vector2::new(320.0, 240.0)), None);
    let nothing = Matrix3::zeros();
    assert_eq!(epipolar_line(&nothing, &Vector2::new(1.0, 2.0)), None);
    assert_eq!(sampson_distance(&nothing, &Vector2::new(1.0, 2.0), &Vector2::zeros()), None);
}

#[test]
fn four_poses_share_an_essential_matrix_and_one_has_the_scene_in_front() {
    let mut random = random();
    for _ in 0..100 {
        let truth = motion(&mut random);
        let essential = essential_matrix(&truth);
        let poses = relative_poses(&essential).unwrap();
        for pose in &poses {
            assert_abs_diff_eq!(pose.translation.vector.norm(), 1.0, epsilon = 1e-12);
            let rotation = pose.rotation.to_rotation_matrix().into_inner();
            assert_abs_diff_eq!(rotation.determinant(), 1.0, epsilon = 1e-12);
            let same = essential_matrix(pose) * essential.norm() / 2.0_f64.sqrt();
            let error = (same - essential).norm().min((same + essential).norm());
            assert!(error < 1e-12, "{error}");
        }
        let pairs: Vec<_> = std::iter::repeat_with(|| point_ahead(&mut random))
            .map(|point| (point, (truth * nalgebra::Point3::from(point)).coords))
            .filter(|(_, second)| second.z > 0.1)
            .take(10)
            .collect();
        let (found, in_front) = relative_pose(&essential, &pairs).unwrap();
        assert_eq!(in_front, 10);
        assert!(found.rotation.angle_to(&truth.rotation) < 1e-7);
        let direction = truth.translation.vector.normalize();
        assert_abs_diff_eq!(found.translation.vector, direction, epsilon = 1e-12);
    }
}

#[test]
fn a_matrix_that_is_only_nearly_essential_still_gives_rotations() {
    let mut random = random();
    let truth = motion(&mut random);
    let noise = Matrix3::from_fn(|_, _| 1e-3 * random.random_range(-1.0..1.0));
    let poses = relative_poses(&(essential_matrix(&truth) + noise)).unwrap();
    for pose in &poses {
        let rotation = pose.rotation.to_rotation_matrix().into_inner();
        assert_abs_diff_eq!(rotation.transpose() * rotation, Matrix3::identity(), epsilon = 1e-12);
    }
    let nearest = poses.iter().map(|pose| pose.rotation.angle_to(&truth.rotation));
    assert!(nearest.fold(1.0, f64::min) < 0.02);
}

#[test]
fn matrices_without_a_motion_in_them_are_refused() {
    let mut broken = essential_matrix(&Isometry3::translation(1.0, 0.0, 0.0));
    broken.m12 = f64::NAN;
    assert_eq!(relative_poses(&broken), Err(EssentialError::NotFinite));
    let rank_one = Vector3::x() * Vector3::y().transpose();
    assert_eq!(relative_poses(&rank_one), Err(EssentialError::RankOne { ratio: 0.0 }));
    let essential = essential_matrix(&Isometry3::translation(1.0, 0.0, 0.0));
    let error = relative_pose(&essential, &[]).unwrap_err();
    assert_eq!(error, EssentialError::Ambiguous { in_front: [0; 4] });
    assert!(error.to_string().contains("give more correct pairs"));
}

#[test]
fn rays_meet_at_the_distances_of_the_point() {
    let mut random = random();
    for _ in 0..100 {
        let (pose, point) = (motion(&mut random), point_ahead(&mut random));
        let second = (pose * nalgebra::Point3::from(point)).coords;
        let (first_depth, second_depth) =
            ray_depths(&pose, &point.normalize(), &second.normalize());
        assert_relative_eq!(first_depth, point.norm(), max_relative = 1e-9);
        assert_relative_eq!(second_depth, second.norm(), max_relative = 1e-9);
    }
}

#[test]
fn scale_moves_no_pixel_of_any_camera() {
    let mut random = random();
    for _ in 0..200 {
        let (pose, point) = (motion(&mut random), point_ahead(&mut random));
        let Some((by_pose, by_point)) = camera().jacobians(&pose, &point) else { continue };
        let [through_pose, through_point] = [by_pose * scale_direction(&pose), by_point * point];
        let size = through_pose.norm();
        assert!(size > 0.0);
        assert!((through_pose + through_point).norm() <= 1e-12 * size);
    }
}

#[test]
fn growing_the_world_moves_cameras_along_the_scale_direction() {
    let mut random = random();
    let pose = motion(&mut random);
    let grown =
        Isometry3::from_parts(((1.0 + 1e-3) * pose.translation.vector).into(), pose.rotation);
    let moved = se3::retract(&pose, &(1e-3 * scale_direction(&pose)));
    assert_abs_diff_eq!(grown.to_homogeneous(), moved.to_homogeneous(), epsilon = 1e-14);
}

#[test]
fn pixels_without_noise_give_back_their_point() {
    let mut random = random();
    for _ in 0..500 {
        let (point, views) = three_views(&mut random);
        for views in [&views[..], &views[..2]] {
            let found = triangulate(views, 1e-3).unwrap();
            assert_relative_eq!(found, point, max_relative = 1e-10);
        }
    }
}

#[test]
fn a_far_point_on_a_short_baseline_is_still_found_without_noise() {
    let point = Vector3::new(100.0, -50.0, 1000.0);
    let found = triangulate(&views_of(&point, 0.1), 1e-6).unwrap();
    assert_relative_eq!(found, point, max_relative = 1e-9);
}

#[test]
fn directions_triangulate_as_pixels_do() {
    let views = views_of(&point(), 0.5);
    let of_directions = views.map(|view| {
        let direction = bearing(&view.camera, &view.pixel);
        View::of_direction(view.camera_from_world, &direction, 1.0 / 400.0).unwrap()
    });
    let found = triangulate(&of_directions, LEAST_PARALLAX).unwrap();
    let [by_direction, by_pixel] =
        [&of_directions, &views].map(|views| triangulate_nonlinear(views, &found).unwrap());
    assert_abs_diff_eq!(by_direction.point, point(), epsilon = 1e-12);
    assert_abs_diff_eq!(by_direction.covariance, by_pixel.covariance, epsilon = 1e-12);
    let backwards = View::of_direction(Isometry3::identity(), &-Vector3::z(), 1.0);
    assert_eq!(backwards, Err(TriangulationError::Direction { z: -1.0 }));
}

#[test]
fn neither_the_origin_nor_the_unit_of_length_matters() {
    let mut random = random();
    let (_, mut views) = three_views(&mut random);
    for view in &mut views {
        view.pixel += Vector2::new(normal(&mut random), normal(&mut random));
    }
    let found = triangulate(&views, LEAST_PARALLAX).unwrap();
    let new_from_old = Isometry3::new(Vector3::new(100.0, -40.0, 7.0), Vector3::new(1.0, 2.0, 0.5));
    let scale = 30.0;
    let elsewhere = views.map(|view| {
        let mut pose = view.camera_from_world * new_from_old.inverse();
        pose.translation.vector *= scale;
        View { camera_from_world: pose, ..view }
    });
    let there = triangulate(&elsewhere, LEAST_PARALLAX).unwrap();
    let expected = scale * (new_from_old * nalgebra::Point3::from(found)).coords;
    assert_relative_eq!(there, expected, max_relative = 1e-9);
}

#[test]
fn a_point_needs_two_views() {
    let views = views_of(&point(), 0.5);
    for count in 0..2 {
        let error = triangulate(&views[..count], LEAST_PARALLAX).unwrap_err();
        assert_eq!(error, TriangulationError::TooFewViews { count });
        assert_eq!(triangulate_nonlinear(&views[..count], &point()), Err(error));
    }
}

#[test]
fn numbers_that_are_none_are_refused_with_their_view() {
    for value in [f64::NAN, f64::INFINITY] {
        let mut views = views_of(&point(), 0.5);
        views[1].pixel.y = value;
        let error = triangulate(&views, LEAST_PARALLAX).unwrap_err();
        assert!(matches!(error, TriangulationError::Pixel { view: 1, .. }));
        assert!(error.to_string().starts_with("view 1: the pixel is (296, "));
    }
    for sigma in [0.0, -1.0, 1e-320, f64::NAN, f64::INFINITY] {
        let mut views = views_of(&point(), 0.5);
        views[0].sigma = sigma;
        let error = triangulate(&views, LEAST_PARALLAX).unwrap_err();
        assert!(matches!(error, TriangulationError::Sigma { view: 0, .. }));
    }
    let mut views = views_of(&point(), 0.5);
    views[1].camera.fx = 0.0;
    assert_eq!(
        triangulate_nonlinear(&views, &point()),
        Err(TriangulationError::Camera { view: 1 })
    );
    let mut views = views_of(&point(), 0.5);
    views[1].camera_from_world.translation.x = f64::NAN;
    let error = triangulate(&views, LEAST_PARALLAX).unwrap_err();
    assert_eq!(error, TriangulationError::Camera { view: 1 });
}

#[test]
fn a_camera_that_only_turned_is_refused() {
    let turn = Rotation3::new(Vector3::new(0.0, 0.1, 0.0));
    let centre = Vector3::new(3.0, -2.0, 1.0);
    let around = |rotation: Rotation3<f64>| {
        Isometry3::from_parts((-(rotation * centre)).into(), rotation.into())
    };
    let point = centre + point();
    let views = [Rotation3::identity(), turn].map(|rotation| seen_from(around(rotation), &point));
    let error = triangulate(&views, 0.0).unwrap_err();
    assert!(matches!(error, TriangulationError::NoBaseline { length } if length < 1e-12));
    let error = triangulate_nonlinear(&views, &point).unwrap_err();
    assert!(matches!(error, TriangulationError::Undetermined { .. }), "{error}");
}

#[test]
fn the_unit_of_noise_makes_no_difference() {
    for sigma in [1e-152, 1e152] {
        let views = views_of(&point(), 0.5).map(|view| View { sigma, ..view });
        let found = triangulate(&views, LEAST_PARALLAX).unwrap();
        assert_abs_diff_eq!(found, point(), epsilon = 1e-9);
    }
}

#[test]
fn rays_that_hardly_differ_are_refused_with_their_angle() {
    let far = Vector3::new(0.0, 0.0, 100.0);
    let views = views_of(&far, 0.5);
    let angle = parallax(&far, &Vector3::zeros(), &Vector3::new(0.5, 0.0, 0.0));
    match triangulate(&views, LEAST_PARALLAX) {
        Err(TriangulationError::Parallax { angle: reported, least }) => {
            assert_abs_diff_eq!(reported, angle, epsilon = 1e-12);
            assert_eq!(least, LEAST_PARALLAX);
        }
        other => panic!("{other:?}"),
    }
    let parallel = [0.0, 0.5].map(|x| View {
        pixel: Vector2::new(320.0, 240.0),
        ..seen_from(Isometry3::translation(-x, 0.0, 0.0), &far)
    });
    let error = triangulate(&parallel, 0.0).unwrap_err();
    assert!(matches!(error, TriangulationError::AtInfinity { angle } if angle == 0.0));
}

#[test]
fn rays_that_meet_behind_a_camera_are_refused_with_it() {
    let mut views = views_of(&point(), 0.5);
    let [first, second] = [views[0].pixel, views[1].pixel];
    (views[0].pixel, views[1].pixel) = (second, first);
    match triangulate(&views, LEAST_PARALLAX) {
        Err(TriangulationError::Behind { view: 0, depth }) => {
            assert_abs_diff_eq!(depth, -5.0, epsilon = 1e-9);
        }
        other => panic!("{other:?}"),
    }
    let near = Vector3::new(0.0, 0.0, Z_MIN);
    let error = triangulate_nonlinear(&views, &near).unwrap_err();
    assert_eq!(error, TriangulationError::Behind { view: 0, depth: Z_MIN });
}

#[test]
fn a_view_from_the_other_side_is_named_when_the_point_is_behind_it() {
    let mut views = views_of(&point(), 0.5).to_vec();
    let turned = Isometry3::rotation(Vector3::y() * std::f64::consts::PI);
    let mirrored = View { camera_from_world: turned, ..views[0] };
    let in_camera = turned * nalgebra::Point3::from(point());
    let pixel = Vector2::new(
        400.0 * in_camera.x / in_camera.z + 320.0,
        400.0 * in_camera.y / in_camera.z + 240.0,
    );
    views.push(View { pixel, ..mirrored });
    let error = triangulate(&views, LEAST_PARALLAX).unwrap_err();
    assert!(matches!(error, TriangulationError::Behind { view: 2, depth } if depth < -4.9));
    assert!(error.to_string().contains("do not show one point"));
}

#[test]
fn numbers_at_the_end_of_their_range_are_refused_and_nothing_hangs() {
    let extremes = [1e200, -1e200, 1e308, 1e-320, f64::MIN_POSITIVE];
    for extreme in extremes {
        for change in [
            |view: &mut View, value: f64| view.pixel.x = value,
            |view: &mut View, value: f64| view.sigma = value.abs(),
            |view: &mut View, value: f64| view.camera_from_world.translation.y = value,
            |view: &mut View, value: f64| view.camera.fx = value.abs(),
        ] {
            let mut views = views_of(&point(), 0.5);
            change(&mut views[1], extreme);
            let points = [
                triangulate(&views, LEAST_PARALLAX),
                triangulate(&views, 0.0),
                triangulate_nonlinear(&views, &point()).map(|found| found.point),
            ];
            for found in points.into_iter().flatten() {
                assert!(found.iter().all(|coordinate| coordinate.is_finite()), "{extreme}");
            }
        }
    }
}

#[test]
fn rays_that_diverge_lead_to_a_point_without_depth() {
    let mut views = views_of(&point(), 0.5);
    views[1].pixel.x = views[0].pixel.x + 1.0;
    let error = triangulate_nonlinear(&views, &point()).unwrap_err();
    assert!(matches!(error, TriangulationError::Undetermined { condition } if condition > 1e12));
}

#[test]
fn pixels_that_contradict_each_other_are_given_up_on_in_time() {
    let mut random = random();
    let mut given_up = 0;
    for _ in 0..1000 {
        let (point, mut views) = three_views(&mut random);
        for view in &mut views {
            view.pixel += 300.0 * Vector2::new(normal(&mut random), normal(&mut random));
        }
        match triangulate_nonlinear(&views, &point) {
            Ok(found) => assert!(found.iterations <= 50),
            Err(TriangulationError::NotConverged { iterations, step }) => {
                assert!(iterations == 50 && step > 1e-9);
                given_up += 1;
            }
            Err(error) => assert!(matches!(error, TriangulationError::Undetermined { .. })),
        }
    }
    assert!(given_up > 0);
}

/// Half the sum of squared whitened residuals, computed apart from the library.
fn cost(views: &[View], point: &Vector3<f64>) -> f64 {
    let squares = views.iter().map(|view| {
        let seen = view.camera.project(&view.camera_from_world, point).unwrap();
        (view.pixel - seen).norm_squared() / view.sigma.powi(2)
    });
    0.5 * squares.sum::<f64>()
}

#[test]
fn refinement_lowers_the_cost_to_where_its_gradient_vanishes() {
    let mut random = random();
    for _ in 0..200 {
        let (_, mut views) = three_views(&mut random);
        for view in &mut views {
            view.sigma = random.random_range(0.5..2.0);
            view.pixel += view.sigma * Vector2::new(normal(&mut random), normal(&mut random));
        }
        let Ok(start) = triangulate(&views, 0.02) else { continue };
        let found = triangulate_nonlinear(&views, &start).unwrap();
        assert!(found.cost < cost(&views, &start));
        assert_relative_eq!(found.cost, cost(&views, &found.point), max_relative = 1e-9);
        assert!((1..20).contains(&found.iterations), "{}", found.iterations);
        // Along each axis of the covariance, one standard deviation costs a half.
        let axes = found.covariance.symmetric_eigen();
        for (axis, variance) in axes.eigenvectors.column_iter().zip(axes.eigenvalues.iter()) {
            let step = 1e-4 * variance.sqrt() * axis;
            let ahead = cost(&views, &(found.point + step));
            let behind = cost(&views, &(found.point - step));
            assert_abs_diff_eq!((ahead - behind) / 2e-4, 0.0, epsilon = 1e-6);
        }
    }
}

#[test]
fn views_with_nothing_to_disagree_about_are_fitted_at_once() {
    let found = triangulate_nonlinear(&views_of(&point(), 0.5), &point()).unwrap();
    assert_eq!(found.iterations, 0);
    assert_eq!(found.cost, 0.0);
    assert_eq!(found.point, point());
}

#[test]
fn the_covariance_is_what_repeated_measurements_show() {
    let mut random = random();
    let point = Vector3::new(0.4, -0.3, 5.0);
    let second = Isometry3::new(Vector3::new(-0.8, 0.1, 0.2), Vector3::new(0.02, -0.15, 0.05));
    let third = Isometry3::new(Vector3::new(0.5, -0.4, 0.1), Vector3::new(-0.05, 0.1, 0.0));
    let views = [Isometry3::identity(), second, third].map(|pose| seen_from(pose, &point));
    let predicted = triangulate_nonlinear(&views, &point).unwrap();
    let whiten = predicted.covariance.cholesky().unwrap().l().try_inverse().unwrap();

    let draws = 20_000;
    let (mut sum, mut squares) = (Vector3::zeros(), Matrix3::zeros());
    for _ in 0..draws {
        let noisy = views.map(|view| View {
            pixel: view.pixel + Vector2::new(normal(&mut random), normal(&mut random)),
            ..view
        });
        let start = triangulate(&noisy, LEAST_PARALLAX).unwrap();
        let error = whiten * (triangulate_nonlinear(&noisy, &start).unwrap().point - point);
        sum += error;
        squares += error * error.transpose();
    }
    // A sample covariance of this many draws lies within 1 ± 0.03 in every direction: three
    // standard deviations of a variance are 3 √(2/20000), and the largest of all directions
    // takes as much again.
    let eigenvalues = (squares / f64::from(draws)).symmetric_eigenvalues();
    assert!(eigenvalues.min() > 0.94 && eigenvalues.max() < 1.06, "{eigenvalues}");
    let mean_error = sum / f64::from(draws) - whiten * predicted.bias;
    assert!(mean_error.norm() < 4.0 * (3.0 / f64::from(draws)).sqrt(), "{mean_error}");
}

#[test]
fn for_cameras_side_by_side_the_covariance_is_the_disparity_formula() {
    for (depth, baseline) in [(5.0, 0.5), (10.0, 0.5), (5.0, 0.1), (30.0, 1.0)] {
        let point = Vector3::new(0.3, -0.2, depth);
        let found = triangulate_nonlinear(&views_of(&point, baseline), &point).unwrap();
        let expected = depth_sigma(&camera(), baseline, depth, disparity_sigma(1.0, 1.0));
        assert_relative_eq!(found.covariance.m33.sqrt(), expected, max_relative = 1e-9);
        let bias = depth_bias(depth, expected);
        assert_relative_eq!(found.bias.z, bias, max_relative = 1e-9);
    }
}

#[test]
fn two_distances_and_an_angle_say_how_sure_a_ray_is() {
    // Near the axis an angle is a pixel over the focal length.
    let point = Vector3::new(0.0, 0.0, 6.0);
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.4);
    let second = Isometry3::from_parts(Vector3::new(0.0, 0.0, 4.0).into(), turn.into())
        * Isometry3::translation(0.0, 0.0, -6.0);
    let views = [Isometry3::identity(), second].map(|pose| seen_from(pose, &point));
    let found = triangulate_nonlinear(&views, &point).unwrap();
    let expected = ray_sigma(6.0, 4.0, 0.4, 1.0 / 400.0);
    assert_relative_eq!(found.covariance.m33.sqrt(), expected, max_relative = 1e-9);

    let equal = Isometry3::from_parts(Vector3::new(0.0, 0.0, 6.0).into(), turn.into())
        * Isometry3::translation(0.0, 0.0, -6.0);
    let views = [Isometry3::identity(), equal].map(|pose| seen_from(pose, &point));
    let eigenvalues =
        triangulate_nonlinear(&views, &point).unwrap().covariance.symmetric_eigenvalues();
    let condition = eigenvalues.max() / eigenvalues.min();
    assert_relative_eq!(condition, point_condition(0.4), max_relative = 1e-9);
}

#[test]
fn a_wrong_match_along_the_epipolar_line_leaves_no_residual() {
    let mut views = views_of(&point(), 0.5);
    views[1].pixel.x += 10.0;
    let found =
        triangulate_nonlinear(&views, &triangulate(&views, LEAST_PARALLAX).unwrap()).unwrap();
    assert_abs_diff_eq!(found.cost, 0.0, epsilon = 1e-18);
    assert_abs_diff_eq!(found.point.z, 200.0 / 30.0, epsilon = 1e-9);
    views[1].pixel = Vector2::new(296.0, 242.0);
    let found =
        triangulate_nonlinear(&views, &triangulate(&views, LEAST_PARALLAX).unwrap()).unwrap();
    assert_abs_diff_eq!(found.cost, 25.0, epsilon = 0.1);
}

fn stereo() -> StereoPinhole {
    StereoPinhole::new(camera(), 0.5).unwrap()
}

#[test]
fn a_stereo_camera_sees_two_columns_and_a_row() {
    let seen = stereo().project_with_jacobians(&Isometry3::identity(), &point()).unwrap();
    assert_abs_diff_eq!(seen.observation, Vector3::new(336.0, 232.0, 296.0), epsilon = 1e-12);
    assert_abs_diff_eq!(stereo().point(&seen.observation).unwrap(), point(), epsilon = 1e-12);
    assert_eq!(stereo().point(&Vector3::new(300.0, 200.0, 300.0)), None);
    let behind = Vector3::new(0.0, 0.0, -5.0);
    assert_eq!(stereo().project_with_jacobians(&Isometry3::identity(), &behind), None);
}

#[test]
fn stereo_blocks_are_the_derivatives_of_the_residual() {
    let mut random = random();
    for _ in 0..100 {
        let (pose, point) = (motion(&mut random), point_ahead(&mut random));
        let Some(predicted) = stereo().project_with_jacobians(&pose, &point) else { continue };
        let factor = StereoFactor::new(0, 0, Vector3::new(300.0, 200.0, 250.0), 0.5).unwrap();
        let linearized = factor.linearize(&predicted);
        let residual = |xi: Vector6<f64>, step: Vector3<f64>| {
            let pose = se3::retract(&pose, &xi);
            let seen = stereo().project_with_jacobians(&pose, &(point + step)).unwrap();
            factor.linearize(&seen).residual
        };
        let step = 1e-6;
        let mut by_pose = Matrix3x6::zeros();
        for column in 0..6 {
            let xi = step * Vector6::ith(column, 1.0);
            let ahead = residual(xi, Vector3::zeros());
            by_pose.set_column(column, &((ahead - residual(-xi, Vector3::zeros())) / (2.0 * step)));
        }
        let mut by_point = Matrix3::zeros();
        for column in 0..3 {
            let along = step * Vector3::ith(column, 1.0);
            let ahead = residual(Vector6::zeros(), along);
            by_point
                .set_column(column, &((ahead - residual(Vector6::zeros(), -along)) / (2.0 * step)));
        }
        assert_relative_eq!(linearized.by_pose, by_pose, max_relative = 1e-6, epsilon = 1e-3);
        assert_relative_eq!(linearized.by_point, by_point, max_relative = 1e-6, epsilon = 1e-3);
    }
}

#[test]
fn a_stereo_factor_is_two_factors_of_one_camera_without_the_second_row() {
    let pose = Isometry3::new(Vector3::new(0.1, -0.2, 0.3), Vector3::new(0.05, -0.1, 0.02));
    let stereo = stereo();
    let predicted = stereo.project_with_jacobians(&pose, &point()).unwrap();
    let observed = Vector3::new(330.0, 230.0, 290.0);
    let factor = StereoFactor::new(2, 7, observed, 0.5).unwrap().linearize(&predicted);
    let right_pose = stereo.right_from_left() * pose;
    let mono = |pose: &Isometry3<f64>, pixel: Vector2<f64>| {
        let predicted = camera().project_with_jacobians(pose, &point()).unwrap();
        ReprojFactor::new(2, 7, pixel, 0.5).unwrap().linearize(&predicted)
    };
    let left = mono(&pose, Vector2::new(330.0, 230.0));
    let right = mono(&right_pose, Vector2::new(290.0, 230.0));
    for (row, (one, of_one)) in [(&left, 0), (&left, 1), (&right, 0)].into_iter().enumerate() {
        assert_abs_diff_eq!(factor.residual[row], one.residual[of_one], epsilon = 1e-12);
        assert_eq!(factor.by_pose.row(row), one.by_pose.row(of_one));
        assert_eq!(factor.by_point.row(row), one.by_point.row(of_one));
    }
    // The row that is left out is the left one once more.
    assert_abs_diff_eq!(left.residual[1], right.residual[1], epsilon = 1e-12);
}

#[test]
fn stereo_notices_a_change_of_scale() {
    let pose = Isometry3::translation(0.3, -0.2, 0.5);
    let seen = stereo().project_with_jacobians(&pose, &point()).unwrap();
    let change = seen.by_pose * scale_direction(&pose) + seen.by_point * point();
    // Only the column of the right image changes: the disparity 36.36 px shrinks by its own
    // share, as the whole scene recedes and the baseline does not grow.
    assert_abs_diff_eq!(change.xy(), Vector2::zeros(), epsilon = 1e-9);
    let disparity = seen.observation.x - seen.observation.z;
    assert_relative_eq!(change.z, disparity, max_relative = 1e-9);
}

#[test]
fn stereo_measurements_that_cannot_be_are_refused() {
    for baseline in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let error = StereoPinhole::new(camera(), baseline).unwrap_err();
        assert!(matches!(error, StereoError::Baseline { .. }));
    }
    let error = StereoFactor::new(1, 2, Vector3::new(1.0, f64::NAN, 3.0), 1.0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "keyframe 1, point 2: the observation is (1, NaN, 3); leave it out"
    );
    for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320] {
        let error = StereoFactor::new(1, 2, Vector3::zeros(), sigma).unwrap_err();
        assert!(matches!(error, StereoError::Sigma { .. }));
    }
}
