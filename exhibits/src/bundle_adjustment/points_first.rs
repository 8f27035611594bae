//! How a problem of many points becomes one of a few cameras.
//!
//! Each part registers its equations, then checks them. In formulas `a`, `b` and `w` are the blocks
//! H_cc, H_pp and H_cp of the normal equations: of the cameras, of the points, and between them.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use nalgebra::{
    DMatrix, DVector, Matrix2, Matrix2x3, Matrix3, Matrix6, Matrix6x3, Rotation3, Vector2, Vector3,
};
use vislam::bundle_adjustment::{BalCamera, Camera};
use vislam::reprojection::ReprojFactor;
use vislam::simulation::Scene;

use super::dense::{Case, best_step, damped, inverse};
use super::progress::unsolved;
use super::whole::Ba;
use crate::chapter::Chapter;
use crate::comparison::{Comparison, Values, altered, numbers};
use crate::random::Random;

/// Random states at which an equation is compared, unless its oracle is costly.
const STATES: usize = 500;

/// Registers what the chapter shows of the elimination of points.
pub fn exhibits(chapter: &mut Chapter) {
    blocks(chapter);
    elimination(chapter);
    pairs(chapter);
    projected(chapter);
    damping(chapter);
    counting(chapter);
    cameras(chapter);
}

/// What a formula makes of a case.
type Formula<V> = fn(&Case) -> V;
type Matrix = Formula<DMatrix<f64>>;
type Vector = Formula<DVector<f64>>;
type Scalar = Formula<f64>;
/// A matrix and the right-hand side.
type System = Formula<(DMatrix<f64>, DVector<f64>)>;

/// Compares at random cases, relative to the size of the oracle's value.
fn compared<V: Values, O: Values>(
    (against, tolerance, seed): (&'static str, f64, u64),
    formula: Formula<V>,
    oracle: Formula<O>,
) -> Comparison {
    let key = (seed, oracle as usize);
    let known = ORACLES.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
    let oracles = known.unwrap_or_else(|| {
        let mut random = Random::new(seed);
        (0..STATES).map(|_| numbers(&oracle(&Case::random(&mut random)))).collect()
    });
    ORACLES.lock().unwrap_or_else(PoisonError::into_inner).insert(key, oracles.clone());
    let mut random = Random::new(seed);
    Comparison::relative(against, tolerance)
        .each(oracles, |oracle| (formula(&Case::random(&mut random)), oracle))
}

/// The numbers of every case.
type Said = Vec<Vec<f64>>;

/// What an oracle says at the cases of a seed, by both: the same to a formula and to all its mutants.
static ORACLES: Mutex<BTreeMap<(u64, usize), Said>> = Mutex::new(BTreeMap::new());

fn blocks(chapter: &mut Chapter) {
    let mutants: [(_, Matrix); 5] = [
        ("sign of the coupling", |case| arrow(&case.problem, 1.0, |w| w.neg_mut())),
        ("coupling dropped", |case| arrow(&case.problem, 1.0, |w| w.fill(0.0))),
        ("coupling in the next point", |case| arrow(&case.problem, 1.0, |w| w.swap_columns(0, 3))),
        ("points held", |case| arrow(&case.problem, 0.0, |_| ())),
        ("whitening dropped", |case| {
            let mut plain = case.problem.clone();
            plain.factors.iter_mut().for_each(|factor| factor.inverse_sigma = 1.0);
            arrow(&plain, 1.0, |_| ())
        }),
    ];
    let formula: Matrix = |case| arrow(&case.problem, 1.0, |_| ());
    chapter.equation("ba-blocks", ba_blocks, formula, &mutants);
}

fn ba_blocks(formula: Matrix) -> Comparison {
    let against = "the Jacobian of all pixels by all unknowns, by central differences";
    compared((against, 1e-6, 1), formula, |case| {
        let jacobian = case.jacobian_by_differences();
        jacobian.tr_mul(&jacobian)
    })
}

/// The whole matrix, summed block by block over the observations, with a change of what couples cameras and points.
fn arrow(problem: &Ba, points: f64, change: fn(&mut DMatrix<f64>)) -> DMatrix<f64> {
    let moving: Vec<usize> = (0..problem.cameras.len()).filter(|k| !problem.fixed[*k]).collect();
    let (cameras, size) = (6 * moving.len(), 3 * problem.points.len());
    let mut whole = DMatrix::zeros(cameras + size, cameras + size);
    let mut w = DMatrix::zeros(cameras, size);
    for factor in &problem.factors {
        let view = problem.cameras[factor.keyframe].differentiate(&problem.points[factor.point]);
        let view = view.expect("the points lie in front of all cameras");
        let (j, l) = (factor.inverse_sigma * view.by_camera, factor.inverse_sigma * view.by_point);
        let point = 3 * factor.point;
        let mut b = whole.fixed_view_mut::<3, 3>(cameras + point, cameras + point);
        b += points * l.transpose() * l;
        if let Some(k) = moving.iter().position(|k| *k == factor.keyframe) {
            let mut a = whole.fixed_view_mut::<6, 6>(6 * k, 6 * k);
            a += j.transpose() * j;
            let mut coupling = w.fixed_view_mut::<6, 3>(6 * k, point);
            coupling += j.transpose() * l;
        }
    }
    change(&mut w);
    whole.view_mut((0, cameras), (cameras, size)).copy_from(&w);
    whole.view_mut((cameras, 0), (size, cameras)).tr_copy_from(&w);
    whole
}

fn elimination(chapter: &mut Chapter) {
    let formula: Vector = |case| -inverse(&case.b) * points_gradient_after(case);
    let mutants: [(_, Vector); 5] = [
        ("sign", |case| inverse(&case.b) * points_gradient_after(case)),
        ("sign of the cameras", |case| {
            let coupled = case.w.tr_mul(&case.cameras_step);
            -inverse(&case.b) * (&case.points_gradient - coupled)
        }),
        ("cameras dropped", |case| -inverse(&case.b) * &case.points_gradient),
        ("block not inverted", |case| -&case.b * points_gradient_after(case)),
        ("diagonal of the block only", |case| {
            -points_gradient_after(case).component_div(&case.b.diagonal())
        }),
    ];
    chapter.equation("point-follows", point_follows, formula, &mutants);

    let formula: System = |case| case.solver().schur_complement(0.0).unwrap_or_default();
    let mutants: [(_, System); 6] = [
        ("sign", |case| reduced(case, 1.0, inverse(&case.b), 1.0)),
        ("sign of the right-hand side", |case| altered(eliminated(case), |(_, rhs)| rhs.neg_mut())),
        ("points held", |case| reduced(case, 0.0, inverse(&case.b), -1.0)),
        ("block not inverted", |case| reduced(case, -1.0, case.b.clone(), -1.0)),
        ("right-hand side as before", |case| reduced(case, -1.0, inverse(&case.b), 0.0)),
        ("diagonal of the block only", |case| {
            let diagonal = DMatrix::from_diagonal(&case.b.diagonal());
            reduced(case, -1.0, inverse(&diagonal), -1.0)
        }),
    ];
    chapter.equation("reduced-camera-system", reduced_camera_system, formula, &mutants);

    let formula: Scalar = |case| weighed(case, &schur(case));
    let mutants: [(_, Scalar); 3] = [
        ("points held", |case| weighed(case, &case.a)),
        ("sign", |case| weighed(case, &(2.0 * &case.a - schur(case)))),
        ("inverse", |case| weighed(case, &inverse(&schur(case)))),
    ];
    chapter.equation("stiffness-left", stiffness_left, formula, &mutants);
}

/// The cameras' step in the metric of a matrix.
fn weighed(case: &Case, matrix: &DMatrix<f64>) -> f64 {
    case.cameras_step.dot(&(matrix * &case.cameras_step))
}

/// The gradient of the linearized cost by the points once the cameras have moved.
fn points_gradient_after(case: &Case) -> DVector<f64> {
    &case.points_gradient + case.w.tr_mul(&case.cameras_step)
}

fn point_follows(formula: Vector) -> Comparison {
    let against = "the points that fit best once the cameras have moved, by singular values";
    compared((against, 1e-8, 2), formula, |case| {
        best_step(&case.by_points, &(&case.residual + &case.by_cameras * &case.cameras_step))
    })
}

/// The Schur complement with its right-hand side, with signs and the inverse of the points' blocks
/// to choose.
fn reduced(
    case: &Case,
    sign: f64,
    inverse: DMatrix<f64>,
    of_points: f64,
) -> (DMatrix<f64>, DVector<f64>) {
    let through = &case.w * inverse;
    let s = &case.a + sign * &through * case.w.transpose();
    (s, -(&case.cameras_gradient + of_points * through * &case.points_gradient))
}

fn eliminated(case: &Case) -> (DMatrix<f64>, DVector<f64>) {
    reduced(case, -1.0, inverse(&case.b), -1.0)
}

fn reduced_camera_system(formula: System) -> Comparison {
    let against = "the equations less what lies in the span of the points' columns";
    compared((against, 1e-8, 3), formula, |case| {
        let span = case.by_points.clone().qr().q();
        let rows = &case.by_cameras - &span * span.tr_mul(&case.by_cameras);
        let residual = &case.residual - &span * span.tr_mul(&case.residual);
        (rows.tr_mul(&rows), -rows.tr_mul(&residual))
    })
}

fn schur(case: &Case) -> DMatrix<f64> {
    eliminated(case).0
}

fn stiffness_left(formula: Scalar) -> Comparison {
    let against = "the pixels that still move when the points follow as well as they can";
    compared((against, 1e-7, 4), formula, |case| {
        let moved = &case.by_cameras * &case.cameras_step;
        let follow = best_step(&case.by_points, &moved);
        (moved + &case.by_points * follow).norm_squared()
    })
}

fn pairs(chapter: &mut Chapter) {
    let formula: OfPair = |case| pair(case, |left, b, right| -left * b * right.transpose());
    let mutants: [(_, OfPair); 4] = [
        ("sign", |case| pair(case, |left, b, right| left * b * right.transpose())),
        ("cameras exchanged", |case| pair(case, |left, b, right| -right * b * left.transpose())),
        ("one camera for both", |case| pair(case, |left, b, _| -left * b * left.transpose())),
        ("block not inverted", |case| {
            pair(case, |left, b, right| {
                -left * b.try_inverse().expect("a covariance") * right.transpose()
            })
        }),
    ];
    chapter.equation("covisible-pairs", covisible_pairs, formula, &mutants);
}

type OfPair = Formula<Matrix6<f64>>;

/// The block of the Schur complement that belongs to the two moving cameras: a sum over the points
/// that both of them see.
fn pair(
    case: &Case,
    term: fn(Matrix6x3<f64>, Matrix3<f64>, Matrix6x3<f64>) -> Matrix6<f64>,
) -> Matrix6<f64> {
    let (w, b) = (&case.w, &case.b);
    let sees = |camera, point| {
        case.problem.factors.iter().any(|f| (f.keyframe, f.point) == (camera, point))
    };
    let shared = (0..case.problem.points.len()).filter(|point| sees(2, *point) && sees(3, *point));
    let terms = shared.map(|point| {
        let block = b.fixed_view::<3, 3>(3 * point, 3 * point).try_inverse();
        let [left, right] = [0, 6].map(|row| w.fixed_view::<6, 3>(row, 3 * point).into_owned());
        term(left, block.expect("the point is seen from two sides"), right)
    });
    terms.sum()
}

fn covisible_pairs(formula: OfPair) -> Comparison {
    let against = "the inverse of the cameras' part of the inverse of the whole matrix";
    compared((against, 1e-6, 5), formula, |case| {
        cameras_information(case).fixed_view::<6, 6>(0, 6).into_owned()
    })
}

/// The inverse of the cameras' part of the inverse of the whole matrix.
fn cameras_information(case: &Case) -> DMatrix<f64> {
    let jacobian = case.jacobian();
    let covariance = inverse(&jacobian.tr_mul(&jacobian));
    inverse(&covariance.view((0, 0), (12, 12)).into_owned())
}

fn projected(chapter: &mut Chapter) {
    let formula: Matrix = |case| pairs_of_rows(case, |l, m| l * m.transpose(), |i, qq| i - qq);
    let mutants: [(_, Matrix); 5] = [
        ("factor not transposed", |case| pairs_of_rows(case, |l, m| l * m, |i, qq| i - qq)),
        ("point's own coordinates", |case| pairs_of_rows(case, |l, _| l, |i, qq| i - qq)),
        ("sign", |case| pairs_of_rows(case, |l, m| l * m.transpose(), |i, qq| i + qq)),
        ("what is explained", |case| pairs_of_rows(case, |l, m| l * m.transpose(), |_, qq| qq)),
        ("nothing explained", |case| pairs_of_rows(case, |l, m| l * m.transpose(), |i, _| i)),
    ];
    chapter.equation("projected-pairs", projected_pairs, formula, &mutants);
}

/// The Schur complement of the two moving cameras as a sum over points and pairs of observations.
fn pairs_of_rows(
    case: &Case,
    whiten: fn(Matrix2x3<f64>, Matrix3<f64>) -> Matrix2x3<f64>,
    middle: fn(Matrix2<f64>, Matrix2<f64>) -> Matrix2<f64>,
) -> DMatrix<f64> {
    let (problem, b) = (&case.problem, &case.b);
    let moving: Vec<usize> = (0..problem.cameras.len()).filter(|k| !problem.fixed[*k]).collect();
    let mut s = DMatrix::zeros(6 * moving.len(), 6 * moving.len());
    for (index, point) in problem.points.iter().enumerate() {
        let factor = b.fixed_view::<3, 3>(3 * index, 3 * index).into_owned().cholesky();
        let factor = factor.expect("the point is seen from two sides").l();
        let inverse_factor = factor.try_inverse().expect("a positive diagonal");
        let row = |factor: &ReprojFactor| {
            let camera = moving.iter().position(|k| *k == factor.keyframe)?;
            let view = problem.cameras[factor.keyframe].differentiate(point)?;
            let whitened = whiten(factor.inverse_sigma * view.by_point, inverse_factor);
            Some((camera, factor.inverse_sigma * view.by_camera, whitened))
        };
        let seen = problem.factors.iter().filter(|factor| factor.point == index);
        let rows: Vec<_> = seen.filter_map(row).collect();
        for ((k, left, q), (l, right, p)) in
            rows.iter().flat_map(|left| rows.iter().map(move |right| (left, right)))
        {
            let own = if k == l { Matrix2::identity() } else { Matrix2::zeros() };
            let mut pair = s.fixed_view_mut::<6, 6>(6 * k, 6 * l);
            pair += left.transpose() * middle(own, q * p.transpose()) * right;
        }
    }
    s
}

fn projected_pairs(formula: Matrix) -> Comparison {
    let against = "the inverse of the cameras' part of the inverse of the whole matrix";
    compared((against, 1e-6, 6), formula, cameras_information)
}

fn damping(chapter: &mut Chapter) {
    let formula: Vector = |case| {
        let (s, rhs) = case.solver().schur_complement(case.damping).unwrap_or_default();
        inverse(&s) * rhs
    };
    let mutants: [(_, Vector); 5] = [
        ("damped after eliminating", |case| {
            let (s, rhs) = eliminated(case);
            inverse(&damped(&s, case.damping)) * rhs
        }),
        ("sign", |case| -damped_step(case, case.damping, case.damping)),
        ("points not damped", |case| damped_step(case, case.damping, 0.0)),
        ("cameras not damped", |case| damped_step(case, 0.0, case.damping)),
        ("damping dropped", |case| damped_step(case, 0.0, 0.0)),
    ];
    chapter.equation("damped-reduction", damped_reduction, formula, &mutants);

    let formula: Scalar =
        |case| case.solver().step(case.damping).map_or(f64::NAN, |step| step.predicted_decrease);
    let mutants: [(_, Scalar); 4] = [
        ("points' own part dropped", |case| predicted(case, [1.0, 0.0, 1.0])),
        ("cameras' part dropped", |case| predicted(case, [0.0, 1.0, 1.0])),
        ("what damping holds back dropped", |case| predicted(case, [1.0, 1.0, 0.0])),
        ("sign of the damping", |case| predicted(case, [1.0, 1.0, -1.0])),
    ];
    chapter.equation("predicted-decrease-in-parts", predicted_decrease_in_parts, formula, &mutants);
}

/// The cameras' step when cameras and points are damped like this.
fn damped_step(case: &Case, cameras: f64, points: f64) -> DVector<f64> {
    let through = &case.w * inverse(&damped(&case.b, points));
    let s = damped(&case.a, cameras) - &through * case.w.transpose();
    -inverse(&s) * (&case.cameras_gradient - through * &case.points_gradient)
}

fn damped_reduction(formula: Vector) -> Comparison {
    let against = "the whole problem with one more measurement of zero for each unknown";
    compared((against, 1e-8, 7), formula, |case| {
        let (jacobian, residual) = case.with_measurements_of_zero();
        best_step(&jacobian, &residual).rows(0, case.by_cameras.ncols()).into_owned()
    })
}

/// The predicted decrease with its three parts weighted.
fn predicted(case: &Case, [cameras, points, held]: [f64; 3]) -> f64 {
    let of_points = inverse(&damped(&case.b, case.damping));
    let through = &case.w * &of_points;
    let s = damped(&case.a, case.damping) - &through * case.w.transpose();
    let (by_cameras, by_points) = (&case.cameras_gradient, &case.points_gradient);
    let reduced = by_cameras - &through * by_points;
    let cameras_step = -inverse(&s) * &reduced;
    let points_step = -&of_points * (by_points + case.w.tr_mul(&cameras_step));
    let weighted = |step: &DVector<f64>, diagonal: DVector<f64>| {
        case.damping * step.component_mul(step).dot(&diagonal)
    };
    let held_back =
        weighted(&cameras_step, case.a.diagonal()) + weighted(&points_step, case.b.diagonal());
    let cameras_part = -reduced.dot(&cameras_step);
    let points_part = by_points.dot(&(of_points * by_points));
    0.5 * (cameras * cameras_part + points * points_part + held * held_back)
}

fn predicted_decrease_in_parts(formula: Scalar) -> Comparison {
    let against = "the cost of the linearized pixels before and after the step";
    compared((against, 1e-8, 8), formula, |case| {
        let (jacobian, residual) = case.with_measurements_of_zero();
        let left = &case.residual + case.jacobian() * best_step(&jacobian, &residual);
        0.5 * (case.residual.norm_squared() - left.norm_squared())
    })
}

fn counting(chapter: &mut Chapter) {
    let formula: Count = |problem| unsolved(problem).block_products as f64;
    let mutants: [(_, Count); 4] = [
        ("a camera without itself", |problem| counted(problem, |n| n * (n - 1.0) / 2.0)),
        ("both orders", |problem| counted(problem, |n| n * n)),
        ("half dropped", |problem| counted(problem, |n| n * (n + 1.0))),
        ("one for each observation", |problem| counted(problem, |n| n)),
    ];
    chapter.equation("block-products", block_products, formula, &mutants);
}

type Count = fn(&Ba) -> f64;

/// The sum over points of what a formula makes of the number of moving cameras that see each.
fn counted(problem: &Ba, formula: fn(f64) -> f64) -> f64 {
    let mut seen = vec![0.0; problem.points.len()];
    for factor in problem.factors.iter().filter(|factor| !problem.fixed[factor.keyframe]) {
        seen[factor.point] += 1.0;
    }
    seen.into_iter().map(formula).sum()
}

fn block_products(formula: Count) -> Comparison {
    let against = "the loop over all pairs of cameras and all points";
    let mut random = Random::new(9);
    Comparison::absolute(against, 0.1, "products").each(0..30, |seed| {
        let (cameras, reach) = (random.uniform(4.0..16.0) as usize, random.uniform(1.5..4.0));
        let problem = Scene::street(cameras, reach, 1.0, seed).problem;
        let mut sees = vec![vec![false; problem.points.len()]; cameras];
        problem.factors.iter().for_each(|factor| sees[factor.keyframe][factor.point] = true);
        let mut products = 0.0;
        for (first, second) in (1..cameras).flat_map(|k| (1..=k).map(move |other| (k, other))) {
            for point in 0..problem.points.len() {
                let is_used = sees.iter().filter(|sees| sees[point]).count() > 1;
                let both = sees[first][point] && sees[second][point];
                products += f64::from(is_used && both);
            }
        }
        (formula(&problem), products)
    })
}

fn cameras(chapter: &mut Chapter) {
    let mutants: [(_, BalPixel); 4] = [
        ("looks along +z", |camera, point| Some(-bal_pixel_with(camera, point, 1.0, |r2| r2))),
        ("r for its square", |camera, point| Some(bal_pixel_with(camera, point, 1.0, f64::sqrt))),
        ("lens dropped", |camera, point| Some(bal_pixel_with(camera, point, 0.0, |r2| r2))),
        ("sign of the lens", |camera, point| Some(bal_pixel_with(camera, point, -1.0, |r2| r2))),
    ];
    chapter.equation("bal-pixel", bal_pixel, BalCamera::project, &mutants);
}

type BalPixel = fn(&BalCamera, &Vector3<f64>) -> Option<Vector2<f64>>;

fn bal_pixel_with(
    camera: &BalCamera,
    point: &Vector3<f64>,
    lens: f64,
    of_square: fn(f64) -> f64,
) -> Vector2<f64> {
    let point = camera.rotation * point + camera.translation;
    let slopes = -point.xy() / point.z;
    let r2 = of_square(slopes.norm_squared());
    let stretch = 1.0 + lens * (camera.radial[0] * r2 + camera.radial[1] * r2 * r2);
    camera.focal_length * stretch * slopes
}

fn bal_pixel(formula: BalPixel) -> Comparison {
    let against = "direction and distance from the middle of the picture, by angles";
    Comparison::absolute(against, 1e-8, "px").over(STATES, 10, |random| {
        let camera = BalCamera {
            rotation: random.rotation(3.0),
            translation: random.direction(1.0),
            focal_length: random.logarithmic(200.0..1500.0),
            radial: [random.uniform(-0.3..0.3), random.uniform(-0.1..0.1)],
        };
        // A point in front of the camera in its own axes, of which z points backwards.
        let in_camera =
            Rotation3::new(std::f64::consts::PI * Vector3::x()) * random.point(2.0..20.0);
        let in_world = camera.rotation.inverse() * (in_camera - camera.translation);
        let around = in_camera.y.atan2(in_camera.x);
        let r = in_camera.angle(&-Vector3::z()).tan();
        let [k1, k2] = camera.radial;
        let distance = camera.focal_length * (r + k1 * r.powi(3) + k2 * r.powi(5));
        (formula(&camera, &in_world), distance * Vector2::new(around.cos(), around.sin()))
    })
}
