//! The derivatives of the residual, block by block.

use std::f64::consts::PI;

use nalgebra::{Matrix3, SMatrix, Vector3};
use vislam::inertial::{GRAVITY, ImuBias, NavState};
use vislam::least_squares::Manifold;
use vislam::manifold::so3;
use vislam::preintegration::{LinearizedImu, Preintegrated, imu_residual, linearize};

use super::oracle::{Readings, bias, slopes, state};
use crate::chapter::Chapter;
use crate::comparison::Comparison;
use crate::preintegration::oracle::{parts, stack};
use crate::random::Random;

/// Random trajectories at which an equation is compared.
const STATES: usize = 500;

/// Sums, two states and a bias at which a residual is linearized.
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

    /// The residual's rotation.
    fn phi(&self) -> Vector3<f64> {
        parts(&imu_residual(&self.sums, &self.first, &self.second, &GRAVITY, &self.bias))[0]
    }
}

/// Takes a case and gives one of the three Jacobians.
type By<const N: usize> = fn(&Case) -> SMatrix<f64, 9, N>;

fn with_block<const N: usize>(
    mut jacobian: SMatrix<f64, 9, N>,
    (row, column): (usize, usize),
    change: impl Fn(Matrix3<f64>) -> Matrix3<f64>,
) -> SMatrix<f64, 9, N> {
    let block = jacobian.fixed_view::<3, 3>(row, column).into_owned();
    jacobian.fixed_view_mut::<3, 3>(row, column).copy_from(&change(block));
    jacobian
}

/// Registers the equations.
pub fn exhibits(chapter: &mut Chapter) {
    by_states(chapter);
    let formula: By<6> = |case| case.linearized().by_bias;
    let mutants: [(_, By<6>); 5] = [
        ("sign", |case| -case.linearized().by_bias),
        ("right inverse for left", |case| {
            let change = so3::right_jacobian_inverse(&case.phi()) * so3::left_jacobian(&case.phi());
            with_block(case.linearized().by_bias, (0, 0), |block| change * block)
        }),
        ("logarithm's Jacobian dropped", |case| {
            let jacobian = so3::left_jacobian(&case.phi());
            with_block(case.linearized().by_bias, (0, 0), |block| jacobian * block)
        }),
        ("Jacobian at the step dropped", |case| {
            let by_gyro = case.sums.bias_jacobian.fixed_view::<3, 3>(0, 0);
            let inverse = so3::left_jacobian_inverse(&case.phi());
            with_block(case.linearized().by_bias, (0, 0), |_| -inverse * by_gyro)
        }),
        ("as if at the bias of the sums", |case| -case.sums.bias_jacobian),
    ];
    chapter.equation("residual-by-bias", residual_by_bias, formula, &mutants);
}

fn by_states(chapter: &mut Chapter) {
    let formula: By<9> = |case| case.linearized().by_first;
    let mutants: [(_, By<9>); 6] = [
        ("sign of the turn", |case| with_block(case.linearized().by_first, (0, 0), |m| -m)),
        ("not seen from the second body", |case| {
            let inverse = so3::right_jacobian_inverse(&case.phi());
            with_block(case.linearized().by_first, (0, 0), |_| -inverse)
        }),
        ("sign of the leaning velocity", |case| {
            with_block(case.linearized().by_first, (3, 0), |m| -m)
        }),
        ("measured velocity leaning", |case| {
            let measured = so3::hat(&case.sums.deltas.velocity);
            with_block(case.linearized().by_first, (3, 0), |_| measured)
        }),
        ("first velocity not carried on", |case| {
            with_block(case.linearized().by_first, (6, 3), |_| Matrix3::zeros())
        }),
        ("rotation transposed", |case| {
            with_block(case.linearized().by_first, (6, 6), |m| m.transpose())
        }),
    ];
    chapter.equation("residual-by-first", residual_by_first, formula, &mutants);

    let formula: By<9> = |case| case.linearized().by_second;
    let mutants: [(_, By<9>); 4] = [
        ("logarithm's Jacobian dropped", |case| {
            with_block(case.linearized().by_second, (0, 0), |_| Matrix3::identity())
        }),
        ("left inverse for right", |case| {
            with_block(case.linearized().by_second, (0, 0), |m| m.transpose())
        }),
        ("velocity's rotation transposed", |case| {
            with_block(case.linearized().by_second, (3, 3), |m| m.transpose())
        }),
        ("by the second body", |case| {
            let turned = case.second.world_from_body.matrix().transpose();
            with_block(case.linearized().by_second, (6, 6), |_| turned)
        }),
    ];
    chapter.equation("residual-by-second", residual_by_second, formula, &mutants);
    chapter.counterexample("residual-jacobians", "below-pi", at_angle, [3.0, PI]);
}

/// The derivative by the second state where states and readings contradict each other by an angle.
fn at_angle(angle: f64) -> Comparison {
    Comparison::relative(AGAINST, 1e-6).over(STATES, 44, |random| {
        let mut case = Case::random(random);
        let off = stack(&random.direction(angle), &Vector3::zeros(), &Vector3::zeros());
        case.second = case.sums.predict(&case.first, &GRAVITY, &case.bias).retract(off.as_slice());
        (case.linearized().by_second, by_second(&case))
    })
}

fn by_second(case: &Case) -> SMatrix<f64, 9, 9> {
    slopes::<9>(1e-3, |step| {
        let second = case.second.retract(step.as_slice());
        imu_residual(&case.sums, &case.first, &second, &GRAVITY, &case.bias)
    })
}

const AGAINST: &str = "central differences of the residual";

fn residual_by_first(formula: By<9>) -> Comparison {
    compared(41, formula, |case| {
        slopes::<9>(1e-3, |step| {
            let first = case.first.retract(step.as_slice());
            imu_residual(&case.sums, &first, &case.second, &GRAVITY, &case.bias)
        })
    })
}

fn residual_by_second(formula: By<9>) -> Comparison {
    compared(42, formula, by_second)
}

fn residual_by_bias(formula: By<6>) -> Comparison {
    compared(43, formula, |case| {
        slopes::<6>(1e-3, |step| {
            let bias = ImuBias::from_vector(&(case.bias.vector() + step));
            imu_residual(&case.sums, &case.first, &case.second, &GRAVITY, &bias)
        })
    })
}

fn compared<const N: usize>(
    seed: u64,
    formula: By<N>,
    slopes: impl Fn(&Case) -> SMatrix<f64, 9, N>,
) -> Comparison {
    let mut random = Random::new(seed);
    Comparison::relative(AGAINST, 1e-6).each(0..STATES, |_| {
        let case = Case::random(&mut random);
        (formula(&case), slopes(&case))
    })
}
