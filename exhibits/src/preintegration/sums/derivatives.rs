//! The derivatives of the residual, block by block.

use std::f64::consts::PI;

use nalgebra::{Matrix3, SMatrix, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, NavState};
use vislam::least_squares::Manifold;
use vislam::manifold::so3;
use vislam::preintegration::{LinearizedImu, Preintegrated, Vector9, imu_residual, linearize};

use super::oracle::{Readings, bias, slopes, state};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::preintegration::oracle::{STATES, parts, stack};
use crate::random::Random;

/// Sums, two states and a bias at which a residual is linearized.
#[derive(Clone, Copy)]
struct Case {
    sums: Preintegrated,
    first: NavState,
    second: NavState,
    bias: ImuBias,
}

impl Case {
    fn random(random: &mut Random) -> Self {
        let readings = Readings::random(random);
        let sums = readings.summed();
        let bias = ImuBias::from_vector(&(sums.bias.vector() + bias(random, 0.1, 0.5).vector()));
        let first = state(random);
        // Away from where the readings lead, but not by half a turn, where the logarithm jumps.
        let off: Vec<f64> = (0..9).map(|_| random.uniform(-0.9..0.9)).collect();
        let second = sums.predict(&first, &GRAVITY, &bias).retract(&off);
        Self { sums, first, second, bias }
    }

    fn linearized(&self) -> LinearizedImu {
        linearize(&self.sums, &self.first, &self.second, &GRAVITY, &self.bias)
    }

    fn residual(&self) -> Vector9 {
        imu_residual(&self.sums, &self.first, &self.second, &GRAVITY, &self.bias)
    }

    /// The residual's rotation.
    fn phi(&self) -> Vector3<f64> {
        parts(&self.residual())[0]
    }
}

/// Takes a case and gives one of the three Jacobians.
type By<const N: usize> = fn(&Case) -> SMatrix<f64, 9, N>;

/// A Jacobian with the block that begins in this row and column changed.
fn changed<const N: usize>(
    mut jacobian: SMatrix<f64, 9, N>,
    (row, column): (usize, usize),
    change: impl Fn(Matrix3<f64>) -> Matrix3<f64>,
) -> SMatrix<f64, 9, N> {
    let block = jacobian.fixed_view::<3, 3>(row, column).into_owned();
    jacobian.fixed_view_mut::<3, 3>(row, column).copy_from(&change(block));
    jacobian
}

fn by_first(case: &Case) -> SMatrix<f64, 9, 9> {
    case.linearized().by_first
}

fn by_second(case: &Case) -> SMatrix<f64, 9, 9> {
    case.linearized().by_second
}

fn by_bias(case: &Case) -> SMatrix<f64, 9, 6> {
    case.linearized().by_bias
}

pub fn exhibits(chapter: &mut Chapter) {
    by_states(chapter);
    let mutants: [(_, By<6>); 5] = [
        ("sign", |case| -by_bias(case)),
        ("right inverse for left", |case| {
            let change = so3::right_jacobian_inverse(&case.phi()) * so3::left_jacobian(&case.phi());
            changed(by_bias(case), (0, 0), |block| change * block)
        }),
        ("logarithm's Jacobian dropped", |case| {
            changed(by_bias(case), (0, 0), |block| so3::left_jacobian(&case.phi()) * block)
        }),
        ("Jacobian at the step dropped", |case| {
            let by_gyro = case.sums.bias_jacobian.fixed_view::<3, 3>(0, 0);
            changed(by_bias(case), (0, 0), |_| -so3::left_jacobian_inverse(&case.phi()) * by_gyro)
        }),
        ("as if at the bias of the sums", |case| -case.sums.bias_jacobian),
    ];
    chapter.equation("residual-by-bias", residual_by_bias, by_bias, &mutants);
}

fn by_states(chapter: &mut Chapter) {
    let mutants: [(_, By<9>); 6] = [
        ("sign of the turn", |case| changed(by_first(case), (0, 0), |m| -m)),
        ("not seen from the second body", |case| {
            changed(by_first(case), (0, 0), |_| -so3::right_jacobian_inverse(&case.phi()))
        }),
        ("sign of the leaning velocity", |case| changed(by_first(case), (3, 0), |m| -m)),
        ("measured velocity leaning", |case| {
            changed(by_first(case), (3, 0), |_| so3::hat(&case.sums.deltas.velocity))
        }),
        ("first velocity not carried on", |case| changed(by_first(case), (6, 3), |m| 0.0 * m)),
        ("rotation transposed", |case| changed(by_first(case), (6, 6), |m| m.transpose())),
    ];
    chapter.equation("residual-by-first", residual_by_first, by_first, &mutants);

    let mutants: [(_, By<9>); 4] = [
        ("logarithm's Jacobian dropped", |case| {
            changed(by_second(case), (0, 0), |_| Matrix3::identity())
        }),
        ("left inverse for right", |case| changed(by_second(case), (0, 0), |m| m.transpose())),
        ("velocity's rotation transposed", |case| {
            changed(by_second(case), (3, 3), |m| m.transpose())
        }),
        ("by the second body", |case| {
            let turned = case.second.world_from_body.matrix().transpose();
            changed(by_second(case), (6, 6), |_| turned)
        }),
    ];
    chapter.equation("residual-by-second", residual_by_second, by_second, &mutants);
    chapter.counterexample("residual-jacobians", "below-pi", at_angle, [3.0, PI]);
}

/// The derivative by the second state where states and readings contradict each other by an angle.
fn at_angle(angle: f64) -> Comparison {
    let case = |random: &mut Random| {
        let case = Case::random(random);
        let off = stack(&random.direction(angle), &Vector3::zeros(), &Vector3::zeros());
        let second = case.sums.predict(&case.first, &GRAVITY, &case.bias).retract(off.as_slice());
        Case { second, ..case }
    };
    compared(44, by_second, case, second_moved)
}

fn second_moved(case: &Case, step: &[f64]) -> Case {
    Case { second: case.second.retract(step), ..*case }
}

fn residual_by_first(formula: By<9>) -> Comparison {
    let moved = |case: &Case, step: &[f64]| Case { first: case.first.retract(step), ..*case };
    compared(41, formula, Case::random, moved)
}

fn residual_by_second(formula: By<9>) -> Comparison {
    compared(42, formula, Case::random, second_moved)
}

fn residual_by_bias(formula: By<6>) -> Comparison {
    let moved = |case: &Case, step: &[f64]| Case { bias: case.bias.retract(step), ..*case };
    compared(43, formula, Case::random, moved)
}

fn compared<const N: usize>(
    seed: u64,
    formula: By<N>,
    case: impl Fn(&mut Random) -> Case,
    moved: impl Fn(&Case, &[f64]) -> Case,
) -> Comparison {
    let against = "central differences of the residual";
    Comparison::relative(against, 1e-6).over(STATES, seed, |random| {
        let case = case(random);
        (formula(&case), slopes::<N>(1e-3, |step| moved(&case, step.as_slice()).residual()))
    })
}
