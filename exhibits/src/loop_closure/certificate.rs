//! Whether a minimum is the lowest one.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use nalgebra::{DMatrix, Isometry3, Matrix3, Vector3};
use vislam::least_squares::Kernel;
use vislam::loop_closure::{
    Certificate, PoseGraph, RelativeMeasurement, SpatialGraph, certify, pose_graph_options,
};
use vislam::manifold::se3;

use super::draws::{isotropic, measure, pose, tangled, twist};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::random::Random;

const TOLERANCE: f64 = 1e-9;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Identity =
        |m, multipliers, x| 0.5 * multipliers.trace() + form(&(m - multipliers), x);
    let mutants: [(_, Identity); 4] = [
        ("the whole trace", |m, multipliers, x| multipliers.trace() + form(&(m - multipliers), x)),
        ("multipliers added", |m, multipliers, x| {
            0.5 * multipliers.trace() + form(&(m + multipliers), x)
        }),
        ("only the bound", |_, multipliers, _| 0.5 * multipliers.trace()),
        ("only the form", |m, multipliers, x| form(&(m - multipliers), x)),
    ];
    chapter.equation("dual-bound", dual_bound, formula, &mutants);

    let formula: Smallest = |graph| match certify(graph, &graph.poses, TOLERANCE) {
        Ok(Certificate::Refused { smallest_eigenvalue, .. }) => Some(smallest_eigenvalue),
        _ => None,
    };
    let mutants: [(_, Smallest); 4] = [
        ("without multipliers", |graph| Some(smallest(&matrix(graph, 0.0)))),
        ("multipliers added", |graph| Some(smallest(&matrix(graph, -1.0)))),
        ("half of the multipliers", |graph| Some(smallest(&matrix(graph, 0.5)))),
        ("positions held", |graph| {
            let all = matrix(graph, 1.0);
            let own = rotations(graph.poses.len());
            let own = all.select_rows(&own).select_columns(&own);
            Some(own.symmetric_eigenvalues().min())
        }),
    ];
    chapter.equation("certificate-matrix", certificate_matrix, formula, &mutants);

    let mutants: [(_, OfRing); 3] = [
        ("the sine", |kappa, angle| -kappa * angle.sin()),
        ("half of it", |kappa, angle| -0.5 * kappa * (1.0 - angle.cos())),
        ("the square of the arc", |kappa, angle| -kappa * angle * angle),
    ];
    let formula: OfRing = |kappa, angle| -kappa * (1.0 - angle.cos());
    chapter.equation("ring-eigenvalue", ring_eigenvalue, formula, &mutants);

    let kept = Case::Ring { turns: 0.0, moved: 0.0 };
    let wound = Case::Ring { turns: 1.0, moved: 0.0 };
    chapter.counterexample("certificate", "semidefinite", nothing_is_lower, [kept, wound]);
    let moved = Case::Ring { turns: 0.0, moved: 1.0 };
    chapter.counterexample("certificate", "positions", nothing_is_lower, [kept, moved]);
    let cases = [Case::Flight { upright: 1.0 }, Case::Flight { upright: 1e-3 }];
    chapter.counterexample("certificate", "isotropic", nothing_is_lower, cases);
    let evenly = |poses, turns| Wound { poses, turns, uneven: 0.0, unequal: 1.0 };
    let once = evenly(RING, 1.0);
    chapter.counterexample("wound-ring", "once", comes_back, [once, evenly(RING, 2.0)]);
    chapter.counterexample("wound-ring", "more", comes_back, [once, evenly(4, 1.0)]);
    let uneven = Wound { uneven: 0.2, ..once };
    chapter.counterexample("wound-ring", "evenly", comes_back, [once, uneven]);
    let unequal = Wound { unequal: 10.0, ..once };
    chapter.counterexample("wound-ring", "equal", comes_back, [once, unequal]);
    numbers(chapter);
}

/// A ring of poses at one place, of which each was measured to stand as the one before it, turned by so many whole turns.
pub fn ring(poses: usize, turns: f64, kappa: f64) -> SpatialGraph {
    let measurement = |first: usize| RelativeMeasurement {
        first,
        second: (first + 1) % poses,
        measured: Isometry3::identity(),
        information: isotropic(1.0, kappa.sqrt().recip()),
    };
    let turned = |number: usize| {
        Isometry3::rotation(Vector3::z() * (turns * TAU * number as f64 / poses as f64))
    };
    PoseGraph {
        poses: (0..poses).map(turned).collect(),
        measurements: (0..poses).map(measurement).collect(),
    }
}

/// The same, with every pose but the first nudged.
pub fn nudged(mut graph: SpatialGraph, random: &mut Random) -> SpatialGraph {
    let others = graph.poses.iter_mut().skip(1);
    others.for_each(|pose| *pose *= se3::exp(&twist(random, 0.0, 0.05)));
    graph
}

/// The cost of the minimum below a graph that was nudged.
fn unwound(graph: SpatialGraph) -> f64 {
    let graph = nudged(graph, &mut Random::new(95));
    graph.solve_chordal(&pose_graph_options()).expect("it has a minimum").report.cost
}

/// How many poses the ring of the text has.
const RING: usize = 12;

fn cost_of(graph: &SpatialGraph) -> f64 {
    let problem = graph.chordal_problem().expect("isotropic").problem;
    problem.cost(problem.values())
}

fn numbers(chapter: &mut Chapter) {
    let wound = ring(RING, 1.0, 1.0);
    chapter.number("ring_poses", RING as f64, "", 0);
    chapter.number("ring_angle", 360.0 / RING as f64, "°", 0);
    chapter.number("ring_cost", cost_of(&wound), "", 2);
    let Ok(Certificate::Refused { smallest_eigenvalue, .. }) =
        certify(&wound, &wound.poses, TOLERANCE)
    else {
        unreachable!("a wound ring is refused")
    };
    chapter.number("ring_eigenvalue", smallest_eigenvalue, "", 3);
    chapter.number("ring_twice", cost_of(&ring(RING, 2.0, 1.0)), "", 1);
    chapter.number("ring_again", unwound(wound), "", 2);
    chapter.number("ring_unwound", unwound(ring(RING, 2.0, 1.0)), "", 2);
    let by_graph = searches();
    let certified = |ends: &&Vec<End>| ends.iter().any(|end| end.eigenvalue.is_none());
    chapter.number("graphs", GRAPHS as f64, "", 0);
    chapter.number("starts", STARTS as f64, "", 0);
    let count = by_graph.iter().filter(certified).count();
    chapter.number("graphs_certified", count as f64, "", 0);
    let ends = by_graph.concat();
    let certified = ends.iter().filter(|end| end.eigenvalue.is_none());
    chapter.number("searches", ends.len() as f64, "", 0);
    chapter.number("searches_certified", certified.clone().count() as f64, "", 0);
    let wrong = certified.filter(|end| !end.is_lowest()).count();
    chapter.number("searches_wrong", wrong as f64, "", 0);
    let refused = |end: &&End| end.eigenvalue.is_some();
    let lowest = ends.iter().filter(refused).filter(|end| end.is_lowest()).count();
    chapter.number(
        "searches_higher",
        ends.iter().filter(|end| !end.is_lowest()).count() as f64,
        "",
        0,
    );
    chapter.number("searches_modest", lowest as f64, "", 0);
}

/// The end of a search.
#[derive(Clone, Copy)]
pub struct End {
    /// Its cost over the lowest one that was found in its graph.
    pub cost: f64,
    /// The smallest eigenvalue as a part of the mean weight, if it was refused.
    pub eigenvalue: Option<f64>,
}

impl End {
    pub fn is_lowest(&self) -> bool {
        self.cost < 1.0 + 1e-6
    }
}

const GRAPHS: u64 = 50;
const STARTS: usize = 8;

/// Where searches from anywhere end, in graphs with much noise: by graph.
pub fn searches() -> &'static [Vec<End>] {
    static SEARCHES: OnceLock<Vec<Vec<End>>> = OnceLock::new();
    SEARCHES.get_or_init(|| (0..GRAPHS).map(searches_of).collect())
}

fn searches_of(seed: u64) -> Vec<End> {
    let mut random = Random::new(seed);
    let graph = tangled(&mut random);
    let weight = graph.measurements[0].information[(3, 3)];
    let search = |_| {
        let begin = (0..graph.poses.len()).map(|_| pose(&mut random)).collect();
        let solved = graph.with_poses(begin).solve_chordal(&pose_graph_options()).ok()?;
        let eigenvalue = match certify(&graph, &solved.poses, TOLERANCE) {
            Ok(Certificate::Certified { .. }) => None,
            Ok(Certificate::Refused { smallest_eigenvalue, .. }) => {
                Some(smallest_eigenvalue / weight)
            }
            _ => return None,
        };
        Some(End { cost: solved.report.cost, eigenvalue })
    };
    let ends: Vec<End> = (0..STARTS).filter_map(search).collect();
    let lowest = ends.iter().map(|end| end.cost).fold(f64::INFINITY, f64::min);
    ends.into_iter().map(|end| End { cost: end.cost / lowest, ..end }).collect()
}

// The matrix without any structure.

/// Where the rotations stand in a matrix with four columns for each pose.
fn rotations(poses: usize) -> Vec<usize> {
    (0..4 * poses).filter(|column| column % 4 < 3).collect()
}

/// M: the sum over all measurements of what the chord and the shift say of a row of all poses.
fn quadratic(graph: &SpatialGraph) -> DMatrix<f64> {
    let mut rows = DMatrix::zeros(4 * graph.measurements.len(), 4 * graph.poses.len());
    for (at, edge) in graph.measurements.iter().enumerate() {
        let (chord, along) =
            ((0.5 * edge.information[(3, 3)]).sqrt(), edge.information[(0, 0)].sqrt());
        let measured = edge.measured.to_homogeneous();
        for row in 0..4 {
            let root = if row < 3 { chord } else { along };
            rows[(4 * at + row, 4 * edge.second + row)] = root;
            for column in 0..4 {
                rows[(4 * at + row, 4 * edge.first + column)] = -root * measured[(column, row)];
            }
        }
    }
    rows.transpose() * rows
}

/// All rotations and positions side by side.
fn side_by_side(poses: &[Isometry3<f64>]) -> DMatrix<f64> {
    let blocks: Vec<_> = poses.iter().map(Isometry3::to_homogeneous).collect();
    DMatrix::from_fn(3, 4 * poses.len(), |row, column| blocks[column / 4][(row, column % 4)])
}

fn form(matrix: &DMatrix<f64>, x: &DMatrix<f64>) -> f64 {
    0.5 * (x * matrix * x.transpose()).trace()
}

/// M less a multiple of the multipliers, which at a minimum are the blocks of Xᵀ (X M).
fn matrix(graph: &SpatialGraph, factor: f64) -> DMatrix<f64> {
    let mut matrix = quadratic(graph);
    let x = side_by_side(&graph.poses);
    let products = &x * &matrix;
    for pose in 0..graph.poses.len() {
        let turned = x.fixed_view::<3, 3>(0, 4 * pose).transpose()
            * products.fixed_view::<3, 3>(0, 4 * pose);
        let mut own = matrix.fixed_view_mut::<3, 3>(4 * pose, 4 * pose);
        own -= factor * turned;
    }
    matrix
}

/// The smallest eigenvalue with the positions eliminated, the first of which is held.
fn smallest(matrix: &DMatrix<f64>) -> f64 {
    let poses = matrix.nrows() / 4;
    let own = rotations(poses);
    let places: Vec<usize> = (1..poses).map(|pose| 4 * pose + 3).collect();
    let part = |a: &[usize], b: &[usize]| matrix.select_rows(a).select_columns(b);
    let Some(inverse) = part(&places, &places).try_inverse() else { return f64::NAN };
    let left = part(&own, &own) - part(&own, &places) * inverse * part(&places, &own);
    (0.5 * (&left + left.transpose())).symmetric_eigenvalues().min()
}

/// What any poses cost, by M, the multipliers and all rotations and positions side by side.
type Identity = fn(&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>) -> f64;

fn dual_bound(formula: Identity) -> Comparison {
    let against = "the library's chordal cost of any poses, for any symmetric multipliers";
    Comparison::relative(against, 1e-9).over(100, 91, |random| {
        let graph = tangled(random);
        let graph = graph.with_poses((0..graph.poses.len()).map(|_| pose(random)).collect());
        let m = quadratic(&graph);
        let mut multipliers = DMatrix::zeros(m.nrows(), m.nrows());
        for at in 0..graph.poses.len() {
            let any = Matrix3::from_fn(|_, _| random.normal(1.0));
            let mut block = multipliers.fixed_view_mut::<3, 3>(4 * at, 4 * at);
            block.copy_from(&(any + any.transpose()));
        }
        (formula(&m, &multipliers, &side_by_side(&graph.poses)), cost_of(&graph))
    })
}

/// The smallest eigenvalue at the poses of a graph, which are a minimum.
type Smallest = fn(&SpatialGraph) -> Option<f64>;

/// A minimum that is refused.
fn refused(random: &mut Random) -> SpatialGraph {
    loop {
        let graph = tangled(random);
        let begin = (0..graph.poses.len()).map(|_| pose(random)).collect();
        let Ok(solved) = graph.with_poses(begin).solve_chordal(&pose_graph_options()) else {
            continue;
        };
        let certificate = certify(&graph, &solved.poses, TOLERANCE);
        if matches!(certificate, Ok(Certificate::Refused { .. })) {
            return graph.with_poses(solved.poses);
        }
    }
}

fn certificate_matrix(formula: Smallest) -> Comparison {
    let against =
        "all eigenvalues of the dense matrix, with multipliers that need not be symmetric";
    Comparison::relative(against, 1e-4).over(40, 92, |random| {
        let graph = refused(random);
        (formula(&graph), smallest(&matrix(&graph, 1.0)))
    })
}

/// The smallest eigenvalue of a wound ring, by its weight and the angle from pose to pose.
type OfRing = fn(f64, f64) -> f64;

fn ring_eigenvalue(formula: OfRing) -> Comparison {
    let against = "the library's certificate";
    Comparison::relative(against, 1e-6).over(40, 93, |random| {
        let poses = random.uniform(5.0..30.0) as usize;
        let kappa = random.logarithmic(0.1..10.0);
        let graph = ring(poses, 1.0, kappa);
        let found = match certify(&graph, &graph.poses, TOLERANCE) {
            Ok(Certificate::Refused { smallest_eigenvalue, .. }) => Some(smallest_eigenvalue),
            _ => None,
        };
        (formula(kappa, TAU / poses as f64), found.unwrap_or(f64::NAN))
    })
}

/// Poses that satisfy the theorem, or all of it but one condition.
#[derive(Clone, Copy)]
enum Case {
    /// A ring that is wound, and its last pose moved by so many metres.
    Ring { turns: f64, moved: f64 },
    /// A chain with a loop, and by how much less is known of the turn about one axis.
    Flight { upright: f64 },
}

/// By which part of the cost some other poses cost less.
fn nothing_is_lower(case: Case) -> Comparison {
    let (cost, lower) = match case {
        Case::Ring { turns, moved } => {
            let mut graph = ring(8, turns, 1.0);
            graph.poses[7].translation.x += moved;
            (cost_of(&graph), cost_of(&ring(8, 0.0, 1.0)))
        }
        Case::Flight { upright } => flight(upright),
    };
    let gained = (cost - lower) / cost.max(1.0);
    Comparison::absolute("the best of what was tried", 0.01, "of the cost").once(gained, 0.0)
}

/// What the minimum of the isotropic graph costs in the graph as it is, and what the graph's own minimum does.
fn flight(upright: f64) -> (f64, f64) {
    let mut random = Random::new(94);
    let mut poses = vec![Isometry3::identity()];
    for at in 0..19 {
        let turn = Vector3::new(0.1, 0.2, 0.314 + 0.01 * at as f64);
        poses.push(poses[at] * Isometry3::new(Vector3::x(), turn));
    }
    let chain = (1..20).map(|number| [number - 1, number]);
    let pairs = chain.chain([[0, 19], [3, 16], [6, 12]]);
    let measurements = pairs.map(|pair| measure(&poses, pair, [0.1, 0.02], &mut random)).collect();
    let mut graph: SpatialGraph = PoseGraph { poses, measurements };
    graph.measurements.iter_mut().for_each(|m| m.information[(5, 5)] *= upright);
    let solved = graph.isotropic().solve_chordal(&pose_graph_options()).expect("a minimum");
    let own = graph.solve(|_| Kernel::Squared, &pose_graph_options()).expect("a minimum");
    (graph.with_poses(solved.poses).cost().expect("a graph"), own.report.cost)
}

/// A ring that satisfies the theorem, or all of it but one condition.
#[derive(Clone, Copy)]
struct Wound {
    poses: usize,
    turns: f64,
    /// By how much the last pose is turned out of its place, in radians.
    uneven: f64,
    /// How many times as much the first measurement counts.
    unequal: f64,
}

/// Whether a nudged ring comes back to the cost it had.
fn comes_back(wound: Wound) -> Comparison {
    let mut graph = ring(wound.poses, wound.turns, 1.0);
    graph.poses[wound.poses - 1] *= Isometry3::rotation(Vector3::z() * wound.uneven);
    graph.measurements[0].information *= wound.unequal;
    let before = cost_of(&graph);
    let change = unwound(graph) - before;
    Comparison::absolute("the cost of the wound ring", 1e-6, "").once(change, 0.0)
}
