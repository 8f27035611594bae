//! What pixels leave open, and how sure the rest is.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Rotation3, SMatrix, SVector};
use vislam::bundle_adjustment::{Camera, PosedPinhole};
use vislam::simulation::Scene;

use super::gauge::{changed, projection, seven};
use super::stereo::{right_depths, scale_information};
use super::whole::{Blocks, Whole, at_truth, solver};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered, differences};
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
        ("sign of scale", |camera| altered(seven(camera), |ways| ways.column_mut(6).neg_mut())),
        ("sign of the turn", |camera| {
            altered(seven(camera), |ways| ways.fixed_columns_mut::<3>(3).neg_mut())
        }),
        ("translation for the centre", |camera| {
            let translation = camera.camera_from_world.translation.vector;
            altered(seven(camera), |ways| ways.fixed_view_mut::<3, 1>(0, 6).copy_from(&translation))
        }),
        ("in the camera's axes", |camera| {
            let rotation = camera.camera_from_world.rotation.to_rotation_matrix();
            altered(seven(camera), |ways| {
                ways.fixed_view_mut::<3, 3>(0, 0).copy_from(&-rotation.matrix());
                ways.fixed_view_mut::<3, 3>(3, 3).copy_from(&-rotation.matrix());
            })
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

/// Takes a camera, gives its twist in each of the seven motions of the whole scene.
type Seven = fn(&PosedPinhole) -> SMatrix<f64, 6, 7>;

fn ba_seven(formula: Seven) -> Comparison {
    let against = "what the moving points do to the pixel, by differences, with the sign turned";
    Comparison::relative(against, 1e-6).over(STATES, 1, |random| {
        let pose = Isometry3::from_parts(random.direction(3.0).into(), random.rotation(3.0).into());
        let camera = PosedPinhole { intrinsics: random.camera(), camera_from_world: pose };
        let point =
            pose.inverse_transform_vector(&(random.point(1.0..50.0) - pose.translation.vector));
        let view = camera.differentiate(&point).expect("the point is in front");
        let by_points = differences(1e-5, |ways: SVector<f64, 7>| {
            let turn = Rotation3::new(ways.fixed_rows::<3>(3).into_owned());
            let moved = (1.0 + ways[6]) * (turn * point) + ways.fixed_rows::<3>(0);
            camera.project(&moved).expect("the point stays in front")
        });
        (view.by_camera * formula(&camera), -by_points)
    })
}

/// Takes a covariance, the free directions and what is held, as columns.
type Change = fn(&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>) -> DMatrix<f64>;

fn ba_gauge_change(formula: Change) -> Comparison {
    let against = "the inverse among the directions that leave alone what is held";
    let mut random = Random::new(2);
    Comparison::relative(against, 1e-5).each(0..SCENES, |seed| {
        let mut problem = at_truth(&Scene::ring(4, 10, 1.0, seed));
        problem.fixed.fill(false);
        let shortest = solver(&problem).minimal_norm_covariance().expect("parallax").cameras;
        let ways: Vec<_> = problem.cameras.iter().map(seven).collect();
        let free = DMatrix::from_fn(24, 7, |row, way| ways[row / 6][(row % 6, way)]);
        let held = DMatrix::from_fn(24, 7, |_, _| random.normal(1.0));
        let across = (&held * held.transpose()).symmetric_eigen();
        let mut order: Vec<usize> = (0..24).collect();
        order.sort_by(|a, b| across.eigenvalues[*a].total_cmp(&across.eigenvalues[*b]));
        let basis = across.eigenvectors.select_columns(&order[..17]);
        let reduced = Whole::new(&problem).blocks().reduced();
        let inner = (basis.transpose() * reduced * &basis).try_inverse().expect("nothing is free");
        (formula(&shortest, &free, &held), &basis * inner * basis.transpose())
    })
}

/// Takes a focal length, a baseline, the noise, and depths in the second cameras.
type ScaleInformation = fn(f64, f64, f64, &[f64]) -> f64;

fn ba_scale_information(formula: ScaleInformation) -> Comparison {
    let against = "the curvature of the cost while cameras and points grow, by second differences";
    let mut random = Random::new(3);
    Comparison::relative(against, 1e-6).each(0..SCENES, |seed| {
        let (baseline, sigma) = (random.logarithmic(0.02..0.5), random.logarithmic(0.3..3.0));
        let mut truth = at_truth(&Scene::stereo_ring(4, 12, baseline, 0.0, seed));
        truth.factors.iter_mut().for_each(|factor| factor.inverse_sigma = 1.0 / sigma);
        let right_from_left = Isometry3::translation(-baseline, 0.0, 0.0);
        let cost = |change: f64| {
            let mut grown = truth.clone();
            grown.points.iter_mut().for_each(|point| *point *= 1.0 + change);
            for pair in grown.cameras.chunks_mut(2) {
                pair[0].camera_from_world.translation.vector *= 1.0 + change;
                pair[1].camera_from_world = right_from_left * pair[0].camera_from_world;
            }
            solver(&grown).cost()
        };
        let curvature = (cost(1e-4) + cost(-1e-4)) / 1e-8;
        let focal_length = truth.cameras[0].intrinsics.fx;
        (formula(focal_length, baseline, sigma, &right_depths(&truth)), curvature)
    })
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

/// A small stereo ring at its truth.
struct SmallStereo {
    blocks: Blocks,
    /// Of the whole matrix.
    inverse: DMatrix<f64>,
    /// Of the first two points, by the library.
    covariances: [Matrix3<f64>; 2],
}

fn small_stereo() -> &'static [SmallStereo] {
    static RINGS: OnceLock<Vec<SmallStereo>> = OnceLock::new();
    let ring = |seed| {
        let problem = at_truth(&Scene::stereo_ring(4, 10, 0.3, 1.0, seed));
        let covariance = solver(&problem).covariance().expect("nothing is free");
        let covariances = [0, 1].map(|point| covariance.point(point).expect("the point is seen"));
        let blocks = Whole::new(&problem).blocks();
        SmallStereo { inverse: blocks.whole_inverse(), blocks, covariances }
    };
    RINGS.get_or_init(|| (0..SCENES).map(ring).collect())
}

fn ba_cross_covariance(formula: Cross) -> Comparison {
    let against = "a block of the inverse of the whole matrix";
    Comparison::relative(against, 1e-7).each(
        small_stereo(),
        |SmallStereo { blocks, inverse, .. }| {
            let (cameras, points) = blocks.coupling.shape();
            (formula(blocks), inverse.view((0, cameras), (cameras, points)).into_owned())
        },
    )
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
    let states = small_stereo().iter().flat_map(|SmallStereo { blocks, inverse, covariances }| {
        [0, 1].map(|point| {
            let place = blocks.cameras.nrows() + 3 * point;
            let expected = inverse.fixed_view::<3, 3>(place, place).into_owned();
            [expected, covariances[point]].map(|oracle| (formula(blocks, point), oracle))
        })
    });
    Comparison::relative(against, 1e-7).each(states.flatten(), |both| both)
}

/// Takes the normal equations and errors of the cameras.
type Weigh = fn(&Blocks, &DVector<f64>) -> f64;

fn ba_nees(formula: Weigh) -> Comparison {
    let against = "the squared pixels that no motion of the points explains";
    let mut random = Random::new(5);
    let states = (0..SCENES).flat_map(|seed| {
        let whole = Whole::new(&at_truth(&Scene::ring(5, 12, 1.0, seed)));
        let blocks = whole.blocks();
        [(); 4].map(|()| {
            let error = DVector::from_fn(whole.cameras.ncols(), |_, _| random.normal(0.02));
            (formula(&blocks, &error), whole.unexplained(&error))
        })
    });
    Comparison::relative(against, 1e-8).each(states, |both| both)
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
    static LEFT: OnceLock<Vec<f64>> = OnceLock::new();
    let size = |seed: u64| (3 + seed as usize % 4, 7 + seed as usize % 5);
    let ring = |seed| Scene::ring(size(seed).0, size(seed).1, 1.0, seed);
    let left = LEFT.get_or_init(|| {
        let whole = (0..SCENES).map(|seed| Whole::new(&at_truth(&ring(seed))));
        whole.map(|whole| (whole.cameras.nrows() - whole.rank()) as f64).collect()
    });
    Comparison::absolute(against, 1e-9, "1").each((0..SCENES).zip(left), |(seed, left)| {
        let (observations, (cameras, points)) = (ring(seed).problem.factors.len(), size(seed));
        (formula(observations as f64, cameras as f64, points as f64), *left)
    })
}
