//! A camera's pose from points that are known.

use nalgebra::{Isometry3, Matrix6, SMatrix, SVector, Vector2, Vector3};
use vislam::manifold::se3;
use vislam::reprojection::Pinhole;
use vislam::structure_from_motion::resect;

use super::STATES;
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered, differences};
use crate::random::Random;

pub fn exhibits(chapter: &mut Chapter) {
    let mutants: [(_, Side); 3] = [
        ("a right angle between the rays", |[a, b], _| a * a + b * b),
        ("the product once", |[a, b], cosine| a * a + b * b - a * b * cosine),
        ("a plus", |[a, b], cosine| a * a + b * b + 2.0 * a * b * cosine),
    ];
    chapter.equation("three-distances", three_distances, side, &mutants);

    let mutants: [(_, Rows); 3] = [
        ("the depth on the other side", |point, slopes| {
            altered(rows(point, slopes), |r| *r *= -1.0)
        }),
        ("slopes exchanged", |point, slopes| rows(point, &slopes.yx())),
        ("the translation forgotten", |point, slopes| {
            altered(rows(point, slopes), |rows| {
                for column in [3, 7, 11] {
                    rows.column_mut(column).fill(0.0);
                }
            })
        }),
    ];
    chapter.equation("pose-rows", pose_rows, rows, &mutants);

    let mutants: [(_, Covariance); 3] = [
        ("the standard deviation once", |scene| covariance(scene) / scene.sigma),
        ("the information", |scene| {
            covariance(scene).try_inverse().unwrap_or(Matrix6::repeat(f64::NAN))
        }),
        ("moved on the other side", |scene| {
            let adjoint = se3::adjoint(&scene.pose);
            adjoint * covariance(scene) * adjoint.transpose()
        }),
    ];
    chapter.equation("resection-covariance", resection_covariance, covariance, &mutants);
    let scene = Scene::new(&mut Random::new(7), 30, 1.0);
    // Written in the camera's coordinates, the twist's translation is that of the camera's centre.
    let adjoint = se3::adjoint(&scene.pose);
    let covariance = adjoint * covariance(&scene) * adjoint.transpose();
    let sigma = |first: usize| (covariance.fixed_view::<3, 3>(first, first).trace() / 3.0).sqrt();
    chapter.number("resected_place", 100.0 * sigma(0), "cm", 1);
    chapter.number("resected_turn", 1e3 * sigma(3), "mrad", 1);
}

/// Two distances and the cosine between their rays: the square of the side opposite.
type Side = fn([f64; 2], f64) -> f64;

fn side([a, b]: [f64; 2], cosine: f64) -> f64 {
    a * a + b * b - 2.0 * a * b * cosine
}

/// Points that a camera sees.
struct Scene {
    camera: Pinhole,
    pose: Isometry3<f64>,
    points: Vec<Vector3<f64>>,
    sigma: f64,
}

impl Scene {
    fn new(random: &mut Random, count: usize, sigma: f64) -> Self {
        let camera = Pinhole { fx: 400.0, fy: 400.0, cx: 320.0, cy: 240.0 };
        let pose = Isometry3::from_parts(random.direction(3.0).into(), random.rotation(1.0).into());
        let inverse = pose.inverse();
        let points = (0..count)
            .map(|_| {
                let depth = random.uniform(2.0..8.0);
                let slopes = Vector2::new(random.uniform(-0.7..0.7), random.uniform(-0.5..0.5));
                se3::transform(&inverse, &(depth * slopes.push(1.0)))
            })
            .collect();
        Self { camera, pose, points, sigma }
    }

    fn pixels(&self) -> Vec<Vector2<f64>> {
        let pixel = |point| self.camera.project(&self.pose, point).expect("in front");
        self.points.iter().map(pixel).collect()
    }
}

fn three_distances(formula: Side) -> Comparison {
    Comparison::relative("sides of a triangle of points in front of a camera", 1e-12).over(
        STATES,
        1,
        |random| {
            let points: [Vector3<f64>; 3] = std::array::from_fn(|_| random.point(1.0..9.0));
            let pairs = [[0, 1], [1, 2], [2, 0]].map(|[i, j]: [usize; 2]| [points[i], points[j]]);
            let found = pairs
                .map(|[a, b]| formula([a.norm(), b.norm()], a.normalize().dot(&b.normalize())));
            (found, pairs.map(|[a, b]| (a - b).norm_squared()))
        },
    )
}

/// A point and the slopes at which it is seen: two rows that are orthogonal to the pose's entries, row by row.
type Rows = fn(&Vector3<f64>, &Vector2<f64>) -> SMatrix<f64, 2, 12>;

fn rows(point: &Vector3<f64>, slopes: &Vector2<f64>) -> SMatrix<f64, 2, 12> {
    let homogeneous = point.push(1.0).transpose();
    let mut rows = SMatrix::<f64, 2, 12>::zeros();
    for axis in 0..2 {
        rows.view_mut((axis, 4 * axis), (1, 4)).copy_from(&homogeneous);
        rows.view_mut((axis, 8), (1, 4)).copy_from(&(-slopes[axis] * homogeneous));
    }
    rows
}

fn pose_rows(formula: Rows) -> Comparison {
    let against = "the lateral coordinates less slope times depth, of any pose";
    Comparison::absolute(against, 1e-10, "m").over(STATES, 2, |random| {
        let scene = Scene::new(random, 1, 1.0);
        let slopes = Vector2::new(random.uniform(-1.0..1.0), random.uniform(-1.0..1.0));
        let matrix = scene.pose.to_homogeneous();
        let entries = SVector::<f64, 12>::from_fn(|at, _| matrix[(at / 4, at % 4)]);
        let seen = se3::transform(&scene.pose, &scene.points[0]);
        (formula(&scene.points[0], &slopes) * entries, seen.xy() - seen.z * slopes)
    })
}

type Covariance = fn(&Scene) -> Matrix6<f64>;

/// The inverse of the sum of products of the slopes.
fn covariance(scene: &Scene) -> Matrix6<f64> {
    let Scene { camera, pose, points, sigma } = scene;
    let product = |point| {
        let (by_pose, _) = camera.jacobians(pose, point)?;
        Some(by_pose.tr_mul(&by_pose))
    };
    let sum: Matrix6<f64> = points.iter().filter_map(product).sum();
    sigma * sigma * sum.try_inverse().unwrap_or(Matrix6::repeat(f64::NAN))
}

fn resection_covariance(formula: Covariance) -> Comparison {
    let against = "how the most likely pose moves when each pixel does, by differences";
    Comparison::relative(against, 1e-3).over(20, 3, |random| {
        let sigma = random.uniform(0.3..0.6);
        let scene = Scene::new(random, 12, sigma);
        let pixels = scene.pixels();
        let Scene { camera, pose, points, sigma } = &scene;
        let by_pixels = differences::<6, 24>(1e-3, |change| {
            let moved: Vec<_> = pixels
                .iter()
                .enumerate()
                .map(|(k, pixel)| pixel + Vector2::new(change[2 * k], change[2 * k + 1]))
                .collect();
            let found = resect(camera, points, &moved, *sigma, pose).expect("determined");
            se3::local(pose, &found.camera_from_world)
        });
        (formula(&scene), sigma * sigma * by_pixels * by_pixels.transpose())
    })
}
