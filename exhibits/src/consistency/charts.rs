//! Errors in which the free directions are the same at every estimate.

use nalgebra::{SMatrix, SVector, Vector3};
use vislam::consistency::Chart;
use vislam::least_squares::Values;
use vislam::manifold::so3;

use super::draws::{SIZE, Scene, Shifted};
use crate::chapter::Chapter;
use crate::comparison::{Comparison, altered, differences, inverse};

const STATES: usize = 100;

type Vector = SVector<f64, SIZE>;
type Square = SMatrix<f64, SIZE, SIZE>;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: ByStep = |scene| scene.by_step(Chart::RightInvariant);
    let mutants: [(_, ByStep); 4] = [
        ("turn in the body's axes", |scene| {
            altered(scene.by_step(Chart::RightInvariant), |by| {
                by.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
            })
        }),
        ("sign of the arms", |scene| {
            altered(scene.by_step(Chart::RightInvariant), |by| {
                by.fixed_view_mut::<6, 3>(3, 0).neg_mut();
            })
        }),
        ("landmark alone", |scene| scene.by_step(Chart::RightInvariantPoses)),
        ("each by itself", |scene| scene.by_step(Chart::Separate)),
    ];
    chapter.equation("invariant-error", invariant_error, formula, &mutants);

    let formula: Moved = |scene, xi| {
        let step = inverse(scene.by_step(Chart::RightInvariant)) * xi;
        numbers(&scene.retracted(Chart::RightInvariant, &step))
    };
    let mutants: [(_, Moved); 3] = [
        ("each by itself", |scene, xi| {
            let step = inverse(scene.by_step(Chart::RightInvariant)) * xi;
            numbers(&scene.stepped(&step))
        }),
        ("landmark alone", |scene, xi| {
            let step = inverse(scene.by_step(Chart::RightInvariantPoses)) * xi;
            numbers(&scene.retracted(Chart::RightInvariantPoses, &step))
        }),
        ("on the right", |scene, xi| {
            let (body, former) = scene.matrices();
            let (by_body, by_former) = algebra(xi);
            (body * exponential(by_body), former * exponential(by_former))
        }),
    ];
    chapter.equation("invariant-retraction", invariant_retraction, formula, &mutants);

    let formula: Free = |_| constant_free();
    let mutants: [(_, Free); 3] = [
        ("those of each variable", Scene::free),
        ("landmark alone", |scene| scene.by_step(Chart::RightInvariantPoses) * scene.free()),
        ("turn in the body's axes", |scene| {
            let turn = scene.values[scene.body].world_from_body.inverse() * Vector3::z();
            altered(constant_free(), |free| free.fixed_view_mut::<3, 1>(0, 3).copy_from(&turn))
        }),
    ];
    chapter.equation("invariant-free", invariant_free, formula, &mutants);

    let formula: ByStep = |scene| scene.by_step(Chart::Robocentric);
    let mutants: [(_, ByStep); 3] = [
        ("landmark not turned with the body", |scene| {
            altered(scene.by_step(Chart::Robocentric), |by| {
                by.fixed_view_mut::<3, 3>(15, 0).fill(0.0);
            })
        }),
        ("body's position held", |scene| {
            altered(scene.by_step(Chart::Robocentric), |by| {
                by.fixed_view_mut::<3, 3>(15, 6).fill(0.0);
                by.fixed_view_mut::<3, 3>(12, 6).fill(0.0);
            })
        }),
        ("right-invariant", |scene| scene.by_step(Chart::RightInvariant)),
    ];
    chapter.equation("robocentric-error", robocentric_error, formula, &mutants);

    let formula: Carried = |before, after| transport(Chart::RightInvariant, before, after);
    let mutants: [(_, Carried); 4] = [
        ("from new to old", |before, after| transport(Chart::RightInvariant, after, before)),
        ("transposed", |before, after| transport(Chart::RightInvariant, before, after).transpose()),
        ("landmark alone", |before, after| transport(Chart::RightInvariantPoses, before, after)),
        ("left as it is", |_, _| Square::identity()),
    ];
    chapter.equation("chart-transport", chart_transport, formula, &mutants);
}

type Matrices = (SMatrix<f64, 6, 6>, SMatrix<f64, 4, 4>);

/// The matrices of the algebra of an error: turn, velocity, position of the body, turn and position
/// of the former pose, landmark.
fn algebra(xi: &Vector) -> Matrices {
    let (mut body, mut former) = (SMatrix::<f64, 6, 6>::zeros(), SMatrix::<f64, 4, 4>::zeros());
    body.fixed_view_mut::<3, 3>(0, 0).copy_from(&so3::hat(&xi.fixed_rows::<3>(0).into()));
    former.fixed_view_mut::<3, 3>(0, 0).copy_from(&so3::hat(&xi.fixed_rows::<3>(9).into()));
    for (column, from) in [3, 6, 15].into_iter().enumerate() {
        body.fixed_view_mut::<3, 1>(0, 3 + column).copy_from(&xi.fixed_rows::<3>(from));
    }
    former.fixed_view_mut::<3, 1>(0, 3).copy_from(&xi.fixed_rows::<3>(12));
    (body, former)
}

/// The error whose matrices these are.
fn coordinates((body, former): &Matrices) -> Vector {
    let turn = |rows: SMatrix<f64, 3, 3>| so3::vee(&rows);
    let blocks = [
        turn(body.fixed_view::<3, 3>(0, 0).into()),
        body.fixed_view::<3, 1>(0, 3).into(),
        body.fixed_view::<3, 1>(0, 4).into(),
        turn(former.fixed_view::<3, 3>(0, 0).into()),
        former.fixed_view::<3, 1>(0, 3).into(),
        body.fixed_view::<3, 1>(0, 5).into(),
    ];
    Vector::from_fn(|row, _| blocks[row / 3][row % 3])
}

/// The exponential series of a matrix.
fn exponential<const N: usize>(matrix: SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    let mut sum = SMatrix::identity();
    let mut term: SMatrix<f64, N, N> = SMatrix::identity();
    for order in 1..40 {
        term = term * matrix / f64::from(order);
        sum += term;
    }
    sum
}

/// X X̂⁻¹, less one.
fn relative(at: &Scene, moved: &Scene) -> Matrices {
    let ((body, former), (moved_body, moved_former)) = (at.matrices(), moved.matrices());
    (
        moved_body * inverse(body) - SMatrix::identity(),
        moved_former * inverse(former) - SMatrix::identity(),
    )
}

fn numbers(scene: &Scene) -> Matrices {
    scene.matrices()
}

type ByStep = fn(&Scene) -> Square;

fn invariant_error(formula: ByStep) -> Comparison {
    let against = "central differences of the true matrix times the inverse of the estimated one";
    Comparison::relative(against, 1e-8).over(STATES, 9, |random| {
        let scene = Scene::any(random);
        let oracle =
            differences(1e-5, |step: Vector| coordinates(&relative(&scene, &scene.stepped(&step))));
        (formula(&scene), oracle)
    })
}

type Moved = fn(&Scene, &Vector) -> Matrices;

fn invariant_retraction(formula: Moved) -> Comparison {
    let against = "the exponential series of matrices, times the matrices of the estimate";
    Comparison::relative(against, 1e-9).over(STATES, 10, |random| {
        let scene = Scene::any(random);
        let xi = Vector::from_fn(|_, _| random.normal(0.4));
        let (by_body, by_former) = algebra(&xi);
        let (body, former) = scene.matrices();
        let oracle = (exponential(by_body) * body, exponential(by_former) * former);
        (formula(&scene, &xi), oracle)
    })
}

/// The free directions in right-invariant errors: shifts in all positions, and the turn in both
/// rotations.
fn constant_free() -> SMatrix<f64, SIZE, 4> {
    let mut free = SMatrix::<f64, SIZE, 4>::zeros();
    for row in [6, 12, 15] {
        free.fixed_view_mut::<3, 3>(row, 0).fill_with_identity();
    }
    free[(2, 3)] = 1.0;
    free[(11, 3)] = 1.0;
    free
}

type Free = fn(&Scene) -> SMatrix<f64, SIZE, 4>;

fn invariant_free(formula: Free) -> Comparison {
    let against = "central differences of the moved matrix times the inverse of the one before";
    Comparison::relative(against, 1e-8).over(STATES, 12, |random| {
        let scene = Scene::any(random);
        let oracle = differences(1e-5, |motion: Shifted| {
            coordinates(&relative(&scene, &scene.moved(&motion)))
        });
        (formula(&scene), oracle)
    })
}

/// A scene as its body has it: rotation, velocity in the body and position of the body; the former
/// pose and the landmark in the body's axes.
fn seen_by_body(at: &Scene, moved: &Scene) -> Vector {
    let of = |values: &Values| {
        let (state, pose) = (values[at.body], values[at.pose]);
        let back = state.world_from_body.inverse();
        let former = (back * pose.world_from_body, back * (pose.position - state.position));
        let landmark = back * (values[at.landmark] - state.position);
        (state, back * state.velocity, former, landmark)
    };
    let (before, after) = (of(&at.values), of(&moved.values));
    let (whole, _) = relative(at, moved);
    let blocks = [
        so3::vee(&whole.fixed_view::<3, 3>(0, 0).into()),
        after.1 - before.1,
        whole.fixed_view::<3, 1>(0, 4).into(),
        so3::local(&before.2.0, &after.2.0),
        after.2.1 - before.2.1,
        after.3 - before.3,
    ];
    Vector::from_fn(|row, _| blocks[row / 3][row % 3])
}

fn robocentric_error(formula: ByStep) -> Comparison {
    let against = "central differences of what the body sees";
    Comparison::relative(against, 1e-8).over(STATES, 13, |random| {
        let scene = Scene::any(random);
        let oracle = differences(1e-5, |step: Vector| seen_by_body(&scene, &scene.stepped(&step)));
        (formula(&scene), oracle)
    })
}

fn transport(chart: Chart, before: &Scene, after: &Scene) -> Square {
    let mut whole = nalgebra::DMatrix::identity(SIZE, SIZE);
    match chart.transport((&before.values, &after.values), before.body) {
        Some(transport) => transport.apply(&mut whole),
        None => whole.fill(f64::NAN),
    }
    Square::from_column_slice(whole.as_slice())
}

type Carried = fn(&Scene, &Scene) -> Square;

fn chart_transport(formula: Carried) -> Comparison {
    let against = "small left multiplications of the new estimate, as its variables step";
    Comparison::relative(against, 1e-7).over(STATES, 14, |random| {
        let before = Scene::any(random);
        let step = Vector::from_fn(|_, _| random.normal(0.2));
        let after = before.retracted(Chart::RightInvariant, &step);
        let oracle = differences(1e-5, |error: Vector| {
            // The same error in the chart, at the new estimate.
            let xi = coordinates(&relative(&before, &before.stepped(&error)));
            let (by_body, by_former) = algebra(&xi);
            let (body, former) = after.matrices();
            let moved = (exponential(by_body) * body, exponential(by_former) * former);
            own_step(&after, &moved)
        });
        (formula(&before, &after), oracle)
    })
}

/// The step of each variable from a scene to matrices.
fn own_step(from: &Scene, (body, former): &Matrices) -> Vector {
    let (old, old_former) = from.matrices();
    let turn = |old: SMatrix<f64, 3, 3>, new: SMatrix<f64, 3, 3>| {
        so3::vee(&(0.5 * (old.transpose() * new - new.transpose() * old)))
    };
    let column = |at: usize| -> Vector3<f64> {
        (body.fixed_view::<3, 1>(0, at) - old.fixed_view::<3, 1>(0, at)).into_owned()
    };
    let blocks = [
        turn(old.fixed_view::<3, 3>(0, 0).into(), body.fixed_view::<3, 3>(0, 0).into()),
        column(3),
        column(4),
        turn(old_former.fixed_view::<3, 3>(0, 0).into(), former.fixed_view::<3, 3>(0, 0).into()),
        (former.fixed_view::<3, 1>(0, 3) - old_former.fixed_view::<3, 1>(0, 3)).into_owned(),
        column(5),
    ];
    Vector::from_fn(|row, _| blocks[row / 3][row % 3])
}
