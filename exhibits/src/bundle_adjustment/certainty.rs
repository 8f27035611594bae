//! What pixels leave open, and how sure the rest is.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Rotation3, SMatrix, Vector2, Vector3};
use vislam::bundle_adjustment::{Camera, PosedPinhole};
use vislam::simulation::Scene;

use super::gauge::{changed, seven};
use super::stereo::{right_depths, scale_information};
use super::whole::{Blocks, Whole, at_truth, solver};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;
/// Scenes, when each needs a system to be solved.
const SCENES: u64 = 24;

/// Registers what the chapter shows from the gauge on.
pub fn exhibits(chapter: &mut Chapter) {
    free_directions(chapter);
    covariances(chapter);
    counts(chapter);
}

fn free_directions(chapter: &mut Chapter) {
    let mutants: [(_, Seven); 4] = [
        ("sign of scale", |camera| {
            let mut directions = seven(camera);
            directions.column_mut(6).neg_mut();
            directions
        }),
        ("sign of the turn", |camera| {
            let mut directions = seven(camera);
            directions.fixed_columns_mut::<3>(3).neg_mut();
            directions
        }),
        ("translation for the centre", |camera| {
            let mut directions = seven(camera);
            let translation = camera.camera_from_world.translation.vector;
            directions.fixed_view_mut::<3, 1>(0, 6).copy_from(&translation);
            directions
        }),
        ("in the camera's axes", |camera| {
            let rotation = camera.camera_from_world.rotation.to_rotation_matrix();
            let mut directions = seven(camera);
            directions.fixed_view_mut::<3, 3>(0, 0).copy_from(&-rotation.matrix());
            directions.fixed_view_mut::<3, 3>(3, 3).copy_from(&-rotation.matrix());
            directions
        }),
    ];
    chapter.equation("ba-seven", ba_seven, seven, &mutants);

    let mutants: [(_, Change); 4] = [
        ("held and free exchanged", |covariance, free, held| changed(covariance, held, free)),
        ("projected on one side", |covariance, free, held| projection(free, held) * covariance),
        ("projection transposed", |covariance, free, held| {
            let projection = projection(free, held);
            projection.transpose() * covariance * projection
        }),
        ("inverse dropped", |covariance, free, held| {
            let size = covariance.nrows();
            let projection = DMatrix::identity(size, size) - free * held.transpose();
            &projection * covariance * projection.transpose()
        }),
    ];
    chapter.equation("ba-gauge-change", ba_gauge_change, changed, &mutants);

    let mutants: [(_, ScaleInformation); 4] = [
        ("depth squared", |f, b, sigma, depths| {
            depths.iter().map(|z| (f * b / (sigma * z * z)).powi(2)).sum()
        }),
        ("baseline dropped", |f, _, sigma, depths| scale_information(f, 1.0, sigma, depths)),
        ("noise multiplies", |f, b, sigma, depths| scale_information(f, b, 1.0 / sigma, depths)),
        ("squared after the sum", |f, b, sigma, depths| {
            depths.iter().map(|z| f * b / (sigma * z)).sum::<f64>().powi(2)
        }),
    ];
    chapter.equation("ba-scale-information", ba_scale_information, scale_information, &mutants);
}

fn projection(free: &DMatrix<f64>, held: &DMatrix<f64>) -> DMatrix<f64> {
    let size = free.nrows();
    let along = held.tr_mul(free).try_inverse().expect("what is held is enough");
    DMatrix::identity(size, size) - free * along * held.transpose()
}

/// Takes a camera, gives its twist in each of the seven motions of the whole scene.
type Seven = fn(&PosedPinhole) -> SMatrix<f64, 6, 7>;

fn ba_seven(formula: Seven) -> Comparison {
    let against = "what the moving points do to the pixel, by differences, with the sign turned";
    let mut comparison = Comparison::relative(against, 1e-6);
    let mut random = Random::new(1);
    for _ in 0..STATES {
        let pose = Isometry3::from_parts(random.direction(3.0).into(), random.rotation(3.0).into());
        let camera = PosedPinhole { intrinsics: random.camera(), camera_from_world: pose };
        let point =
            pose.inverse_transform_vector(&(random.point(1.0..50.0) - pose.translation.vector));
        let Some(view) = camera.differentiate(&point) else { continue };
        let by_camera = view.by_camera * formula(&camera);
        let step = 1e-5;
        let by_points =
            SMatrix::<f64, 2, 7>::from_columns(&std::array::from_fn::<_, 7, _>(|way| {
                let seen = |change: f64| {
                    let moved = match way {
                        0..3 => point + change * Vector3::ith(way, 1.0),
                        3..6 => Rotation3::new(change * Vector3::ith(way - 3, 1.0)) * point,
                        _ => (1.0 + change) * point,
                    };
                    camera.project(&moved).unwrap_or(Vector2::repeat(f64::NAN))
                };
                (seen(-step) - seen(step)) / (2.0 * step)
            }));
        comparison.add(by_camera.as_slice(), by_points.as_slice());
    }
    comparison
}

/// Takes a covariance, the free directions and what is held, as columns.
type Change = fn(&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>) -> DMatrix<f64>;

fn ba_gauge_change(formula: Change) -> Comparison {
    let against = "the inverse among the directions that leave alone what is held";
    let mut comparison = Comparison::relative(against, 1e-5);
    let mut random = Random::new(2);
    for seed in 0..SCENES {
        let mut problem = at_truth(&Scene::ring(4, 10, 1.0, seed));
        problem.fixed.fill(false);
        let shortest = solver(&problem).minimal_norm_covariance().expect("parallax").cameras;
        let columns: Vec<DVector<f64>> = problem
            .cameras
            .iter()
            .map(seven)
            .fold(vec![Vec::new(); 7], |mut columns, directions| {
                for (column, direction) in columns.iter_mut().zip(directions.column_iter()) {
                    column.extend(direction.iter());
                }
                columns
            })
            .into_iter()
            .map(DVector::from_vec)
            .collect();
        let free = DMatrix::from_columns(&columns);
        let held = DMatrix::from_fn(24, 7, |_, _| random.normal(1.0));
        let across = (&held * held.transpose()).symmetric_eigen();
        let mut order: Vec<usize> = (0..24).collect();
        order.sort_by(|a, b| across.eigenvalues[*a].total_cmp(&across.eigenvalues[*b]));
        let basis = DMatrix::from_fn(24, 17, |row, i| across.eigenvectors[(row, order[i])]);
        let reduced = Whole::new(&problem).blocks().reduced();
        let inner = (basis.transpose() * reduced * &basis).try_inverse().expect("nothing is free");
        let expected = &basis * inner * basis.transpose();
        comparison.add(formula(&shortest, &free, &held).as_slice(), expected.as_slice());
    }
    comparison
}

/// Takes a focal length, a baseline, the noise, and depths in the second cameras.
type ScaleInformation = fn(f64, f64, f64, &[f64]) -> f64;

fn ba_scale_information(formula: ScaleInformation) -> Comparison {
    let against = "the curvature of the cost while cameras and points grow, by second differences";
    let mut comparison = Comparison::relative(against, 1e-6);
    let mut random = Random::new(3);
    for seed in 0..SCENES {
        let (baseline, sigma) = (random.logarithmic(0.02..0.5), random.logarithmic(0.3..3.0));
        let mut truth = at_truth(&Scene::stereo_ring(4, 12, baseline, 0.0, seed));
        truth.factors.iter_mut().for_each(|factor| factor.inverse_sigma = 1.0 / sigma);
        let right_from_left = Isometry3::translation(-baseline, 0.0, 0.0);
        let cost = |change: f64| {
            let mut grown = truth.clone();
            for point in &mut grown.points {
                *point *= 1.0 + change;
            }
            for pair in grown.cameras.chunks_mut(2) {
                pair[0].camera_from_world.translation.vector *= 1.0 + change;
                pair[1].camera_from_world = right_from_left * pair[0].camera_from_world;
            }
            solver(&grown).cost()
        };
        let curvature = (cost(1e-4) + cost(-1e-4)) / 1e-8;
        let focal_length = truth.cameras[0].intrinsics.fx;
        let information = formula(focal_length, baseline, sigma, &right_depths(&truth));
        comparison.add(&[information], &[curvature]);
    }
    comparison
}

fn covariances(chapter: &mut Chapter) {
    let formula: Cross = |b| -b.covariance() * &b.coupling * b.points_inverse();
    let mutants: [(_, Cross); 4] = [
        ("sign", |b| b.covariance() * &b.coupling * b.points_inverse()),
        ("points held", |b| {
            let held = b.cameras.clone().try_inverse().expect("curved");
            -held * &b.coupling * b.points_inverse()
        }),
        ("block of the points not inverted", |b| -b.covariance() * &b.coupling * &b.points),
        ("information for covariance", |b| -b.reduced() * &b.coupling * b.points_inverse()),
    ];
    chapter.equation("ba-cross-covariance", ba_cross_covariance, formula, &mutants);

    let formula: OfPoint = |b, point| own(b, point) + handed_on(b, point, |_, _| true);
    let mutants: [(_, OfPoint); 4] = [
        ("cameras taken as known", own),
        ("own pixels taken as perfect", |b, point| handed_on(b, point, |_, _| true)),
        ("cameras taken as independent", |b, point| {
            own(b, point) + handed_on(b, point, |one, other| one == other)
        }),
        ("sign", |b, point| own(b, point) - handed_on(b, point, |_, _| true)),
    ];
    chapter.equation("ba-point-covariance", ba_point_covariance, formula, &mutants);

    let formula: Weigh = |b, error| error.dot(&(b.reduced() * error));
    let mutants: [(_, Weigh); 4] = [
        ("points held", |b, error| error.dot(&(&b.cameras * error))),
        ("coupling not squared away", |b, error| {
            let coupled = b.coupling.tr_mul(error);
            error.dot(&(&b.cameras * error)) - coupled.norm_squared()
        }),
        ("sign of what the points take", |b, error| {
            error.dot(&((2.0 * &b.cameras - b.reduced()) * error))
        }),
        ("blocks of single cameras only", |b, error| {
            let reduced = b.reduced();
            let blocks = DMatrix::from_fn(error.len(), error.len(), |row, column| {
                if row / 6 == column / 6 { reduced[(row, column)] } else { 0.0 }
            });
            error.dot(&(blocks * error))
        }),
    ];
    chapter.equation("ba-nees", ba_nees, formula, &mutants);
}

/// Takes the normal equations, gives what cameras and points have in common.
type Cross = fn(&Blocks) -> DMatrix<f64>;

/// The normal equations of a small stereo ring, at its truth.
fn small_stereo(seed: u64) -> Blocks {
    Whole::new(&at_truth(&Scene::stereo_ring(4, 10, 0.3, 1.0, seed))).blocks()
}

fn ba_cross_covariance(formula: Cross) -> Comparison {
    let against = "a block of the inverse of the whole matrix";
    let mut comparison = Comparison::relative(against, 1e-7);
    for seed in 0..SCENES {
        let blocks = small_stereo(seed);
        let (cameras, points) = blocks.coupling.shape();
        let inverse = blocks.whole_inverse();
        let expected = inverse.view((0, cameras), (cameras, points)).into_owned();
        comparison.add(formula(&blocks).as_slice(), expected.as_slice());
    }
    comparison
}

/// Takes the normal equations and a point, gives its covariance.
type OfPoint = fn(&Blocks, usize) -> Matrix3<f64>;

/// What a point's own pixels leave open when the cameras are known.
fn own(blocks: &Blocks, point: usize) -> Matrix3<f64> {
    let block = blocks.points.fixed_view::<3, 3>(3 * point, 3 * point).into_owned();
    block.try_inverse().expect("the point is seen from two sides")
}

/// What pairs of cameras hand on to it.
fn handed_on(blocks: &Blocks, point: usize, counts: fn(usize, usize) -> bool) -> Matrix3<f64> {
    let covariance = blocks.covariance();
    let own = own(blocks, point);
    let lever =
        |camera: usize| own * blocks.coupling.fixed_view::<6, 3>(6 * camera, 3 * point).transpose();
    let cameras = blocks.cameras.nrows() / 6;
    let mut sum = Matrix3::zeros();
    for (one, other) in (0..cameras).flat_map(|one| (0..cameras).map(move |other| (one, other))) {
        if counts(one, other) {
            let common = covariance.fixed_view::<6, 6>(6 * one, 6 * other);
            sum += lever(one) * common * lever(other).transpose();
        }
    }
    sum
}

fn ba_point_covariance(formula: OfPoint) -> Comparison {
    let against = "a block of the inverse of the whole matrix, and the library's";
    let mut comparison = Comparison::relative(against, 1e-7);
    for seed in 0..SCENES {
        let problem = at_truth(&Scene::stereo_ring(4, 10, 0.3, 1.0, seed));
        let covariance = solver(&problem).covariance().expect("nothing is free");
        let blocks = Whole::new(&problem).blocks();
        let inverse = blocks.whole_inverse();
        for point in 0..2 {
            let found = formula(&blocks, point);
            let place = blocks.cameras.nrows() + 3 * point;
            let expected = inverse.fixed_view::<3, 3>(place, place).into_owned();
            comparison.add(found.as_slice(), expected.as_slice());
            let library = covariance.point(point).unwrap_or(Matrix3::repeat(f64::NAN));
            comparison.add(found.as_slice(), library.as_slice());
        }
    }
    comparison
}

/// Takes the normal equations and errors of the cameras.
type Weigh = fn(&Blocks, &DVector<f64>) -> f64;

fn ba_nees(formula: Weigh) -> Comparison {
    let against = "the squared pixels that no motion of the points explains";
    let mut comparison = Comparison::relative(against, 1e-8);
    let mut random = Random::new(5);
    for seed in 0..SCENES {
        let whole = Whole::new(&at_truth(&Scene::ring(5, 12, 1.0, seed)));
        let blocks = whole.blocks();
        for _ in 0..4 {
            let error = DVector::from_fn(whole.cameras.ncols(), |_, _| random.normal(0.02));
            comparison.add(&[formula(&blocks, &error)], &[whole.unexplained(&error)]);
        }
    }
    comparison
}

fn counts(chapter: &mut Chapter) {
    let mutants: [(_, Expected); 4] = [
        ("scale counted as known", |m, k, l| 2.0 * m - (6.0 * (k - 1.0) + 3.0 * l)),
        ("one number an observation", |m, k, l| m - (6.0 * (k - 1.0) + 3.0 * l - 1.0)),
        ("camera 0 counted", |m, k, l| 2.0 * m - (6.0 * k + 3.0 * l - 1.0)),
        ("points not counted", |m, k, _| 2.0 * m - (6.0 * (k - 1.0) - 1.0)),
    ];
    chapter.equation("ba-expected-cost", ba_expected_cost, expected_cost, &mutants);
}

/// The sum of squared residuals that unit noise leaves on average.
pub fn expected_cost(observations: f64, cameras: f64, points: f64) -> f64 {
    2.0 * observations - 6.0 * (cameras - 1.0) - 3.0 * points + 1.0
}

/// Takes the numbers of observations, cameras and points.
type Expected = fn(f64, f64, f64) -> f64;

fn ba_expected_cost(formula: Expected) -> Comparison {
    let against = "rows of the Jacobian less its rank, counted by singular values";
    let mut comparison = Comparison::absolute(against, 1e-9, "1");
    for seed in 0..SCENES {
        let (cameras, points) = (3 + seed as usize % 4, 7 + seed as usize % 5);
        let problem = at_truth(&Scene::ring(cameras, points, 1.0, seed));
        let whole = Whole::new(&problem);
        let expected = whole.cameras.nrows() as f64 - whole.rank() as f64;
        let observations = problem.factors.len() as f64;
        comparison.add(&[formula(observations, cameras as f64, points as f64)], &[expected]);
    }
    comparison
}
