//! The equations of a point and of how sure it is.

use nalgebra::{Isometry3, Matrix2x3, Matrix3, SMatrix, Vector2, Vector3};
use vislam::bearing::depth_from_disparity;
use vislam::reprojection::Pinhole;
use vislam::two_views::{self as theory, View, refine, triangulate};

use super::oracle::{curvature, meeting_in_plane, nudged, seen, slope};
use super::worked::facing;
use super::{STATES, motion};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// Registers the equations.
pub fn equations(chapter: &mut Chapter) {
    linear(chapter);
    likely(chapter);
    two_rays(chapter);
}

fn linear(chapter: &mut Chapter) {
    let formula: Linear = |views| triangulate(views, 0.0).ok();
    let mutants: [(_, Linear); 5] = [
        ("poses inverted", |views| {
            triangulated(views, |view| View {
                camera_from_world: view.camera_from_world.inverse(),
                ..*view
            })
        }),
        ("translations negated", |views| {
            triangulated(views, |view| {
                let mut pose = view.camera_from_world;
                pose.translation.vector.neg_mut();
                View { camera_from_world: pose, ..*view }
            })
        }),
        ("rotations dropped", |views| {
            triangulated(views, |view| View {
                camera_from_world: Isometry3::from(view.camera_from_world.translation),
                ..*view
            })
        }),
        ("focal lengths exchanged", |views| {
            triangulated(views, |view| View {
                camera: Pinhole { fx: view.camera.fy, fy: view.camera.fx, ..view.camera },
                ..*view
            })
        }),
        ("principal point dropped", |views| {
            triangulated(views, |view| View {
                camera: Pinhole { cx: 0.0, cy: 0.0, ..view.camera },
                ..*view
            })
        }),
    ];
    chapter.equation("dlt-rows", dlt_rows, formula, &mutants);
}

type Linear = fn(&[View; 3]) -> Option<Vector3<f64>>;

fn dlt_rows(formula: Linear) -> Comparison {
    let against = "the point whose pixels the views hold, without noise";
    let mut comparison = Comparison::relative(against, 1e-10);
    let mut random = Random::new(31);
    for _ in 0..STATES {
        let (point, views) = three_views(&mut random);
        // A mutant's point may lie behind its cameras; then it is no point at all.
        let found = formula(&views).unwrap_or(Vector3::repeat(1e9));
        comparison.add(found.as_slice(), point.as_slice());
    }
    comparison
}

/// The linear point of views that were changed.
fn triangulated(views: &[View; 3], change: fn(&View) -> View) -> Option<Vector3<f64>> {
    triangulate(&views.each_ref().map(change), 0.0).ok()
}

/// Three views of a point by one camera, with noise of different sizes claimed and none there.
fn three_views(random: &mut Random) -> (Vector3<f64>, [View; 3]) {
    let camera = random.camera();
    let point = random.point(3.0..8.0);
    let poses = [Isometry3::identity(), motion(random), motion(random)];
    let views = poses.map(|pose| View {
        camera,
        camera_from_world: pose,
        pixel: seen(&camera, &pose, &point),
        sigma: random.uniform(0.5..2.0),
    });
    (point, views)
}

fn likely(chapter: &mut Chapter) {
    let formula: Covariance =
        |views, point| refine(views, point).map_or(Matrix3::repeat(f64::NAN), |p| p.covariance);
    let mutants: [(_, Covariance); 5] = [
        ("not inverted", |views, point| information(views, point)),
        ("sigma not squared", |views, point| {
            inverse(information(&views.map(|v| View { sigma: v.sigma.sqrt(), ..v }), point))
        }),
        ("noise dropped", |views, point| {
            inverse(information(&views.map(|v| View { sigma: 1.0, ..v }), point))
        }),
        ("one view only counted once more", |views, point| {
            inverse(information(&[views[0], views[1], views[1]], point))
        }),
        ("rotations dropped", |views, point| {
            let rows = views.map(|view| {
                let in_camera = view.camera_from_world * nalgebra::Point3::from(*point);
                let jacobian = view.camera.projection_jacobian(&in_camera.coords);
                jacobian.map_or(Matrix2x3::repeat(f64::NAN), |j| j / view.sigma)
            });
            inverse(rows.iter().map(|row| row.tr_mul(row)).sum())
        }),
    ];
    chapter.equation("point-covariance", point_covariance, formula, &mutants);

    let formula: Bias =
        |views, point| refine(views, point).map_or(Vector3::repeat(f64::NAN), |p| p.bias);
    let mutants: [(_, Bias); 4] = [
        ("sign", |views, point| -found_bias(views, point)),
        ("half dropped", |views, point| 2.0 * found_bias(views, point)),
        ("curvature of the first view only", |views, point| {
            let [first, second, third] = *views;
            let dull = |view: View| View { sigma: 1e3 * view.sigma, ..view };
            found_bias(&[first, dull(second), dull(third)], point)
        }),
        ("curvature dropped", |_, _| Vector3::zeros()),
    ];
    chapter.equation("point-bias", point_bias, formula, &mutants);
}

type Covariance = fn(&[View; 3], &Vector3<f64>) -> Matrix3<f64>;

fn point_covariance(formula: Covariance) -> Comparison {
    let against = "how the most likely point answers to each pixel, by central differences";
    let mut comparison = Comparison::relative(against, 1e-5);
    let mut random = Random::new(32);
    for _ in 0..200 {
        let (point, views) = three_views(&mut random);
        let answers: [_; 6] = std::array::from_fn(|coordinate| {
            slope(|change| most_likely(&nudged(&views, coordinate, change), &point), 1e-2)
        });
        let answers = SMatrix::<f64, 3, 6>::from_columns(&answers);
        let expected = answers * answers.transpose();
        comparison.add(formula(&views, &point).as_slice(), expected.as_slice());
    }
    comparison
}

type Bias = fn(&[View; 3], &Vector3<f64>) -> Vector3<f64>;

fn point_bias(formula: Bias) -> Comparison {
    let against = "half the second differences of the most likely point by each pixel";
    let mut comparison = Comparison::relative(against, 5e-3);
    let mut random = Random::new(33);
    for _ in 0..200 {
        let (point, views) = three_views(&mut random);
        let expected: Vector3<f64> = (0..6)
            .map(|coordinate| {
                let along = |change| most_likely(&nudged(&views, coordinate, change), &point);
                0.5 * curvature(along, 0.05)
            })
            .sum();
        comparison.add(formula(&views, &point).as_slice(), expected.as_slice());
    }
    comparison
}

fn most_likely(views: &[View; 3], start: &Vector3<f64>) -> Vector3<f64> {
    refine(views, start).map_or(Vector3::repeat(f64::NAN), |found| found.point)
}

fn found_bias(views: &[View; 3], point: &Vector3<f64>) -> Vector3<f64> {
    refine(views, point).map_or(Vector3::repeat(f64::NAN), |found| found.bias)
}

/// The information about a point, by central differences.
pub fn information<const N: usize>(views: &[View; N], point: &Vector3<f64>) -> Matrix3<f64> {
    let of_view = |view: &View| {
        let pixel = |axis: usize, step: f64| -> Vector2<f64> {
            let moved = point + step * Vector3::ith(axis, 1.0);
            seen(&view.camera, &view.camera_from_world, &moved)
        };
        let step = 1e-5 * point.norm();
        let columns = [0, 1, 2].map(|axis| (pixel(axis, step) - pixel(axis, -step)) / (2.0 * step));
        let jacobian = Matrix2x3::from_columns(&columns) / view.sigma;
        jacobian.tr_mul(&jacobian)
    };
    views.iter().map(of_view).sum()
}

fn inverse(matrix: Matrix3<f64>) -> Matrix3<f64> {
    matrix.try_inverse().unwrap_or(Matrix3::repeat(f64::NAN))
}

fn two_rays(chapter: &mut Chapter) {
    let mutants: [(_, RaySigma); 5] = [
        ("distances exchanged", |r1, r2, a, sigma| theory::ray_sigma(r2, r1, a, sigma)),
        ("cosine dropped", |r1, r2, a, sigma| sigma * r1.hypot(r2) / a.sin()),
        ("own noise dropped", |_, r2, a, sigma| sigma * r2 / a.sin()),
        ("tangent for sine", |r1, r2, a, sigma| sigma * r2.hypot(r1 * a.cos()) / a.tan()),
        ("deviations added", |r1, r2, a, sigma| sigma * (r2 + r1 * a.cos()) / a.sin()),
    ];
    chapter.equation("ray-sigma", ray_sigma, theory::ray_sigma, &mutants);

    let mutants: [(_, Condition); 3] = [
        ("whole angle", |a| a.sin().powi(-2)),
        ("not squared", |a| 1.0 / (0.5 * a).sin()),
        ("cosine for sine", |a| (0.5 * a).cos().powi(-2)),
    ];
    chapter.equation("point-condition", point_condition, theory::point_condition, &mutants);

    let mutants: [(_, DepthBias); 4] = [
        ("sign", |z, sigma| -theory::depth_bias(z, sigma)),
        ("sigma not squared", |z, sigma| sigma / z),
        ("half", |z, sigma| 0.5 * theory::depth_bias(z, sigma)),
        ("none", |_, _| 0.0),
    ];
    chapter.equation("depth-bias", depth_bias, theory::depth_bias, &mutants);
}

/// Takes the distances from both cameras, the parallax and the noise of a direction.
type RaySigma = fn(f64, f64, f64, f64) -> f64;

fn ray_sigma(formula: RaySigma) -> Comparison {
    let against = "central differences of where two rays of a plane meet, by both of their angles";
    let mut comparison = Comparison::relative(against, 1e-6);
    let mut random = Random::new(34);
    for _ in 0..STATES {
        let (first, second) = (random.logarithmic(1.0..20.0), random.logarithmic(1.0..20.0));
        let parallax = random.uniform(0.02..2.0);
        let sigma = random.logarithmic(1e-4..1e-2);
        // The first ray runs along z, the second one meets it at the point.
        let backwards = Vector2::new(parallax.sin(), parallax.cos());
        let start = Vector2::new(0.0, first) - second * backwards;
        let step = 1e-4 * parallax;
        let along = |first_turn: f64, second_turn: f64| {
            meeting_in_plane(first_turn, parallax + second_turn, start).y
        };
        let by_first = (along(step, 0.0) - along(-step, 0.0)) / (2.0 * step);
        let by_second = (along(0.0, step) - along(0.0, -step)) / (2.0 * step);
        let expected = sigma * by_first.hypot(by_second);
        comparison.add(&[formula(first, second, parallax, sigma)], &[expected]);
    }
    comparison
}

type Condition = fn(f64) -> f64;

fn point_condition(formula: Condition) -> Comparison {
    let against = "eigenvalues of the information, from central differences of both projections";
    let mut comparison = Comparison::relative(against, 1e-5);
    let mut random = Random::new(35);
    for _ in 0..STATES {
        let parallax = random.logarithmic(0.02..1.5);
        let (point, views) = facing(random.logarithmic(1.0..20.0), parallax);
        let eigenvalues = information(&views, &point).symmetric_eigenvalues();
        comparison.add(&[formula(parallax)], &[eigenvalues.max() / eigenvalues.min()]);
    }
    comparison
}

/// Takes a depth and its standard deviation.
type DepthBias = fn(f64, f64) -> f64;

fn depth_bias(formula: DepthBias) -> Comparison {
    let against = "the average depth over a normally distributed disparity, by Gauss-Hermite nodes";
    let mut comparison = Comparison::relative(against, 1e-4);
    let mut random = Random::new(36);
    for _ in 0..STATES {
        let camera = random.camera();
        let baseline = random.logarithmic(0.05..2.0);
        let depth = random.logarithmic(1.0..100.0);
        let disparity = camera.fx * baseline / depth;
        let noise = 1e-3 * disparity;
        let at = |error: f64| {
            depth_from_disparity(&camera, baseline, disparity + error).unwrap_or(f64::NAN)
        };
        let end = 3.0_f64.sqrt() * noise;
        let mean = (at(-end) + 4.0 * at(0.0) + at(end)) / 6.0;
        let sigma = ((at(-noise) - at(noise)) / 2.0).abs();
        comparison.add(&[formula(depth, sigma)], &[mean - depth]);
    }
    comparison
}
