//! The numbers that the chapter quotes.

use nalgebra::{Isometry3, Matrix3, Rotation3, Vector2, Vector3};
use vislam::bearing::bearing;
use vislam::two_views::{
    LEAST_PARALLAX, StereoPinhole, View, essential_matrix, fundamental_matrix, point_condition,
    ray_depths, ray_sigma, relative_poses, sampson_distance, scale_direction, triangulate,
    triangulate_nonlinear,
};

use super::NOWHERE;
use super::draws::{Draws, mean_error, on_the_drive, rms_error};
use super::figures::NINETY_FIVE;
use super::five_points::{self, Found, JUDGES, NOISE, SCENES, STARTS};
use super::worked::{
    BASELINE, CAMERA, POINT, approach, depth_sigma_of, point_at, second_from_first, side_by_side,
};
use crate::chapter::Chapter;
use crate::random::Random;

pub fn numbers(chapter: &mut Chapter) {
    worked_directions(chapter);
    worked_information(chapter);
    five(chapter);
    driving(chapter);
    angles(chapter);
    long_range(chapter);
    ruler(chapter);
    turning(chapter);
    wrong_matches(chapter);
}

fn worked_directions(chapter: &mut Chapter) {
    let essential = essential_matrix(&second_from_first(BASELINE));
    chapter.number("e_upper", essential.m23, "", 1);
    chapter.number("e_lower", essential.m32, "", 1);
    let first = POINT / POINT.z;
    let second = (POINT - BASELINE * Vector3::x()) / POINT.z;
    chapter.number("q0_x", first.x, "", 2);
    chapter.number("q0_y", first.y, "", 2);
    chapter.number("q1_x", second.x, "", 2);
    let normal = essential * first;
    chapter.number("normal_y", normal.y, "", 1);
    chapter.number("normal_z", normal.z, "", 2);
    chapter.number("dlt_factor", first.x - second.x, "", 1);
}

fn worked_information(chapter: &mut Chapter) {
    let views = side_by_side(&POINT, BASELINE);
    let slopes = views.map(|view| {
        let seen = CAMERA.jacobians(&view.camera_from_world, &POINT);
        seen.expect("the point is in front").1
    });
    chapter.number("j_lateral", slopes[0].m11, "px/m", 0);
    chapter.number("j0_depth", slopes[0].m13, "px/m", 1);
    chapter.number("j1_depth", slopes[1].m13, "px/m", 1);
    chapter.number("j_row_depth", slopes[0].m23, "px/m", 1);
    let information: Matrix3<f64> = slopes.iter().map(|j| j.tr_mul(j)).sum();
    chapter.number("info_xx", information.m11, "", 0);
    chapter.number("info_xz", information.m13, "", 0);
    chapter.number("info_yz", information.m23, "", 0);
    chapter.number("info_zz", information.m33, "", 1);
    let lost_to_x = information.m13.powi(2) / information.m11;
    let lost_to_y = information.m23.powi(2) / information.m22;
    chapter.number("info_lost_x", lost_to_x, "", 2);
    chapter.number("info_lost_y", lost_to_y, "", 2);
    chapter.number("info_depth", information.m33 - lost_to_x - lost_to_y, "", 0);
    let found = triangulate_nonlinear(&views, &POINT).expect("pixels without noise have a point");
    let sigma = |axis: usize| found.covariance[(axis, axis)].sqrt();
    chapter.number("sigma_x_cm", 100.0 * sigma(0), "cm", 2);
    chapter.number("sigma_y_cm", 100.0 * sigma(1), "cm", 2);
    chapter.number("sigma_z_cm", 100.0 * sigma(2), "cm", 1);
    let eigenvalues = found.covariance.symmetric_eigenvalues();
    chapter.number("axes_ratio", (eigenvalues.max() / eigenvalues.min()).sqrt(), "", 0);
    chapter.number("bias_mm", 1e3 * found.bias.z, "mm", 2);
}

/// Distance of two essential matrices of length one from which they tell of different motions.
const FAR_FROM_TRUTH: f64 = 0.2;

fn five(chapter: &mut Chapter) {
    chapter.number("five_scenes", SCENES as f64, "", 0);
    chapter.number("five_starts", STARTS as f64, "", 0);
    let (scenes, noisy) = (five_points::exact(), five_points::noisy());
    let last = scenes.iter().map(|found| found.last_start).max().unwrap_or(0);
    chapter.number("five_last_start", last as f64, "", 0);
    let [fewest, most] = ends(scenes.iter().map(|found| found.solutions.len()));
    chapter.number("five_fewest", fewest, "", 0);
    chapter.number("five_most", most, "", 0);
    let [fewest, most] = ends(scenes.iter().map(Found::in_front));
    chapter.number("five_front_fewest", fewest, "", 0);
    chapter.number("five_front_most", most, "", 0);
    let alone = scenes.iter().filter(|found| found.in_front() == 1).count();
    chapter.number("five_front_alone", alone as f64, "", 0);
    let odd = scenes.iter().filter(|found| found.solutions.len() % 2 == 1).count();
    chapter.number("five_odd", odd as f64, "", 0);

    let planes: Vec<_> = (0..SCENES as u64).map(five_points::Scene::on_plane).collect();
    let fits = planes.iter().map(|scene| {
        let solutions = scene.solutions().solutions;
        solutions.iter().filter(|s| s.in_front && s.all_others < 1e-6).count()
    });
    let [fewest, most] = ends(fits);
    chapter.number("plane_fewest", fewest, "", 0);
    chapter.number("plane_most", most, "", 0);
    let [free, _] = ends(planes.iter().map(|scene| scene.free_directions()));
    chapter.number("plane_free", free, "", 0);
    chapter.number("plane_pairs", (5 + JUDGES) as f64, "", 0);

    let nearest = scenes.iter().filter_map(Found::best_wrong).fold(f64::INFINITY, f64::min);
    chapter.number("sixth_nearest_px", nearest, "px", 2);
    chapter.number("sixth_decides", five_points::decided(scenes, |s| s.sixth) as f64, "", 0);
    chapter.number("five_noise_px", NOISE, "px", 1);
    let decided = five_points::decided(noisy, |s| s.sixth);
    chapter.number("sixth_decides_noisy", decided as f64, "", 0);
    let lost = noisy.iter().filter(|found| found.solutions[0].error > FAR_FROM_TRUTH).count();
    chapter.number("five_far", FAR_FROM_TRUTH, "", 1);
    chapter.number("five_lost_noisy", lost as f64, "", 0);
    chapter.number("judges", JUDGES as f64, "", 0);
    let decided = five_points::decided(noisy, |s| s.all_others);
    chapter.number("judges_decide_noisy", decided as f64, "", 0);
}

/// The least and the greatest.
fn ends(counts: impl Iterator<Item = usize>) -> [f64; 2] {
    let counts: Vec<_> = counts.collect();
    [counts.iter().min(), counts.iter().max()].map(|end| end.map_or(0.0, |end| *end as f64))
}

fn driving(chapter: &mut Chapter) {
    let (point, views) = approach();
    let draws = on_the_drive();
    let first = views[0].centre();
    let last = views[views.len() - 1].centre();
    chapter.number("drive_far", point.z - first.z, "m", 0);
    chapter.number("drive_near", point.z - last.z, "m", 0);
    let steps = draws.steps as f64 / draws.likely.len() as f64;
    chapter.number("drive_steps", steps, "", 1);
    let weight = ((point.z - first.z) / (point.z - last.z)).powi(2);
    chapter.number("drive_weight", weight, "", 0);
    chapter.number("drive_side_cm", 100.0 * point.x, "cm", 0);
    chapter.number("drive_views", views.len() as f64, "", 0);
    chapter.number("ellipse_percent", 100.0 * (1.0 - (-0.5 * NINETY_FIVE.powi(2)).exp()), "%", 0);
    chapter.number("drive_draws", draws.likely.len() as f64, "", 0);
    let [linear, likely] =
        [&draws.linear, &draws.likely].map(|points| rms_error(points, &point, 2));
    chapter.number("drive_linear_cm", 100.0 * linear, "cm", 1);
    chapter.number("drive_likely_cm", 100.0 * likely, "cm", 1);
    let found = triangulate_nonlinear(&views, &point).expect("pixels without noise have a point");
    chapter.number("drive_sigma_cm", 100.0 * found.covariance.m33.sqrt(), "cm", 1);
}

fn angles(chapter: &mut Chapter) {
    let pixel = 1.0 / CAMERA.fx;
    for (name, condition, ratio, error, degrees) in [
        ("parallax_1", "condition_1", "axes_1", "depth_percent_1", 1.0_f64),
        ("parallax_10", "condition_10", "axes_10", "depth_percent_10", 10.0),
    ] {
        let parallax = degrees.to_radians();
        chapter.number(name, degrees, "°", 0);
        chapter.number(condition, point_condition(parallax), "", 0);
        chapter.number(ratio, point_condition(parallax).sqrt(), "", 0);
        chapter.number(error, 100.0 * ray_sigma(1.0, 1.0, parallax, pixel), "%", 0);
    }
}

const LONG_RANGE_DRAWS: usize = 20_000;

fn long_range(chapter: &mut Chapter) {
    for (range, sigma, predicted, measured, depth, decimals) in [
        ("near_range", "near_sigma", "near_bias", "near_bias_drawn", 10.0, 3),
        ("far_range", "far_sigma", "far_bias", "far_bias_drawn", 40.0, 1),
    ] {
        let point = point_at(depth);
        let views = side_by_side(&point, BASELINE);
        let draws = Draws::of(&views, LONG_RANGE_DRAWS, 42);
        chapter.number(range, depth, "m", 0);
        let first_order = depth_sigma_of(BASELINE, depth);
        chapter.number(sigma, first_order, "m", decimals);
        chapter.number(predicted, first_order.powi(2) / depth, "m", decimals);
        chapter.number(measured, mean_error(&draws.likely, &point, 2), "m", decimals);
    }
    let pairs = (10.0 / depth_sigma_of(BASELINE, 10.0)).powi(2);
    chapter.number("bias_pairs", pairs, "", 0);
    chapter.number("range_draws", 2.0 * LONG_RANGE_DRAWS as f64, "", 0);
}

fn ruler(chapter: &mut Chapter) {
    let stereo = StereoPinhole { camera: CAMERA, baseline: BASELINE };
    let pose = Isometry3::identity();
    let percent = 1.0;
    chapter.number("ruler_percent", percent, "%", 0);
    let seen = stereo.project_with_jacobians(&pose, &POINT).expect("the point is in front");
    let change = seen.by_pose * scale_direction(&pose) + seen.by_point * POINT;
    chapter.number("ruler_px", percent / 100.0 * change.z, "px", 1);
}

const TURNED_PAIRS: usize = 1000;
/// Metres.
const TURNED_DEEPEST: f64 = 20.0;

fn turning(chapter: &mut Chapter) {
    let degrees: f64 = 10.0;
    chapter.number("turn_deg", degrees, "°", 0);
    chapter.number("turn_pairs", TURNED_PAIRS as f64, "", 0);
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), degrees.to_radians());
    let poses = [Rotation3::identity(), turn]
        .map(|turn| Isometry3::from_parts(Default::default(), turn.into()));
    let (mut random, mut points) = (Random::new(51), Random::new(52));
    chapter.number("turn_deepest", TURNED_DEEPEST, "m", 0);
    let mut pair = || {
        let point = points.point(2.0..TURNED_DEEPEST);
        poses.map(|pose| {
            let pixel = CAMERA.project(&pose, &point).unwrap_or(NOWHERE);
            pixel + Vector2::new(random.normal(1.0), random.normal(1.0))
        })
    };
    let pairs: Vec<_> = (0..TURNED_PAIRS).map(|_| pair()).collect();
    for (name, axis) in [("turn_miss_x", 0), ("turn_miss_y", 1), ("turn_miss_z", 2)] {
        let any = Isometry3::from_parts(Vector3::ith(axis, 1.0).into(), turn.into());
        let fundamental = fundamental_matrix(&CAMERA, &CAMERA, &essential_matrix(&any));
        let misses = pairs.iter().map(|[first, second]| {
            sampson_distance(&fundamental, first, second).unwrap_or(f64::NAN).powi(2)
        });
        chapter.number(name, (misses.sum::<f64>() / TURNED_PAIRS as f64).sqrt(), "px", 2);
    }
    believed(chapter, &pairs, &turn);
}

/// Triangulates the pictures of a camera that only turned with a step that it did not make.
fn believed(chapter: &mut Chapter, pairs: &[[Vector2<f64>; 2]], turn: &Rotation3<f64>) {
    let step = 0.1;
    chapter.number("believed_cm", 100.0 * step, "cm", 0);
    let second = Isometry3::from_parts((-step * Vector3::x()).into(), (*turn).into());
    let view = |pose, pixel| View { camera: CAMERA, camera_from_world: pose, pixel, sigma: 1.0 };
    let (mut depths, mut refused) = (Vec::new(), 0);
    for [first, other] in pairs {
        let views = [view(Isometry3::identity(), *first), view(second, *other)];
        if let Ok(point) = triangulate(&views, 0.0) {
            depths.push(point.z);
        }
        refused += usize::from(triangulate(&views, LEAST_PARALLAX).is_err());
    }
    let share = |count: usize| 100.0 * count as f64 / TURNED_PAIRS as f64;
    chapter.number("believed_front_percent", share(depths.len()), "%", 0);
    depths.sort_by(f64::total_cmp);
    chapter.number("believed_median", depths[depths.len() / 2], "m", 0);
    chapter.number("believed_refused_percent", share(refused), "%", 0);
}

fn wrong_matches(chapter: &mut Chapter) {
    let wrong = 10.0;
    chapter.number("wrong_px", wrong, "px", 0);
    let views = side_by_side(&POINT, BASELINE);
    let with_second_moved = |by: Vector2<f64>| {
        let mut moved = views;
        moved[1].pixel += by;
        let start = triangulate(&moved, LEAST_PARALLAX).expect("rays that meet, nearly");
        triangulate_nonlinear(&moved, &start).expect("a point in front")
    };
    let along = with_second_moved(wrong * Vector2::x());
    chapter.number("wrong_along_depth", along.point.z, "m", 2);
    chapter.number("wrong_along_miss", (2.0 * along.cost).sqrt(), "px", 0);
    let across = with_second_moved(wrong * Vector2::y());
    chapter.number("wrong_across_miss", (2.0 * across.cost).sqrt(), "px", 1);
    chapter.number("wrong_across_depth", across.point.z, "m", 2);
    // The four motions of the worked matrix, and where each of them has the worked point.
    let essential = essential_matrix(&second_from_first(BASELINE));
    let poses = relative_poses(&essential).into_iter().flatten();
    let directions = views.map(|view| bearing(&CAMERA, &view.pixel).into_inner());
    let in_front = poses.filter(|pose| {
        let (first, second) = ray_depths(pose, &directions[0], &directions[1]);
        first > 0.0 && second > 0.0
    });
    chapter.number("poses_in_front", in_front.count() as f64, "", 0);
}
