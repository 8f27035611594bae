//! The iterated update, and Gauss-Newton.

use nalgebra::{DMatrix, Matrix3, Matrix6x3, Rotation3, SMatrix, SVector, Vector3, Vector6};
use vislam::filtering::{Belief, UpdateOptions};
use vislam::least_squares::{Factor, Kernel, Key, Problem, sqrt_information};
use vislam::manifold::so3;

use super::draws;
use crate::chapter::Chapter;
use crate::comparison::{Comparison, differences, inverse};
use crate::random::Random;

const CASES: usize = 50;
/// Iterations that are compared.
const STEPS: usize = 3;
/// Until nothing moves any more.
const ALL: usize = 40;

pub fn exhibits(chapter: &mut Chapter) {
    let formula: Iterated = |turn, steps| turn.by_library(steps).0;
    let mutants: [(_, Iterated); 4] = [
        ("from the iterate", |turn, steps| {
            turn.by_hand(steps, Rule { anchored: false, ..RIGHT }).0
        }),
        ("derivative of the step dropped", |turn, steps| {
            turn.by_hand(steps, Rule { curved: false, ..RIGHT }).0
        }),
        ("derivatives taken once", |turn, steps| {
            turn.by_hand(steps, Rule { latest: false, ..RIGHT }).0
        }),
        ("step back dropped", |turn, steps| turn.by_hand(steps, Rule { back: false, ..RIGHT }).0),
    ];
    chapter.equation("iterated-step", iterated_step, formula, &mutants);

    let formula: Moved = |turn| turn.by_library(ALL).1;
    let mutants: [(_, Moved); 3] = [
        ("not moved", |turn| turn.by_hand(ALL, RIGHT).1),
        ("moved the other way", |turn| {
            let (at, covariance) = turn.by_hand(ALL, RIGHT);
            let derivative = turn.derivative(&at);
            derivative * covariance * derivative.transpose()
        }),
        ("transposed", |turn| {
            let (at, covariance) = turn.by_hand(ALL, RIGHT);
            let derivative = inverse(turn.derivative(&at));
            derivative.transpose() * covariance * derivative
        }),
    ];
    chapter.equation("moved-covariance", moved_covariance, formula, &mutants);

    for (condition, dropped) in [
        ("latest", Rule { latest: false, ..RIGHT }),
        ("from-estimate", Rule { anchored: false, ..RIGHT }),
        ("curved", Rule { curved: false, ..RIGHT }),
        ("whitened", Rule { whitened: false, ..RIGHT }),
    ] {
        chapter.counterexample("iterated-update", condition, same_steps, [RIGHT, dropped]);
    }
}

/// What an iteration does, and may leave out.
#[derive(Clone, Copy)]
struct Rule {
    /// The prior's error is measured from the belief's estimate and not from the last iterate.
    anchored: bool,
    /// The derivative of that error by a step of the iterate is used.
    curved: bool,
    /// Derivatives of measurements are taken at the last iterate.
    latest: bool,
    /// What has been gone already is taken off the step.
    back: bool,
    /// Residuals are in standard deviations.
    whitened: bool,
}

const RIGHT: Rule = Rule { anchored: true, curved: true, latest: true, back: true, whitened: true };

/// A rotation that is believed in, and two known directions that it turned.
struct Turn {
    estimate: Rotation3<f64>,
    covariance: Matrix3<f64>,
    directions: [Vector3<f64>; 2],
    measured: [Vector3<f64>; 2],
    sigma: f64,
}

impl Turn {
    fn random(random: &mut Random) -> Self {
        let truth = random.rotation(2.0);
        let covariance = draws::covariance(random, 3);
        let covariance = 0.2 * Matrix3::from_fn(|row, column| covariance[(row, column)]);
        let (directions, sigma) = ([(); 2].map(|()| random.direction(1.0)), 0.3);
        let measured = directions.map(|direction| truth * direction + random.direction(sigma));
        let estimate = so3::retract(&truth, &random.direction(0.9));
        Self { estimate, covariance, directions, measured, sigma }
    }

    fn factor(&self, variable: Key<Rotation3<f64>>, at: usize) -> Turned {
        let (direction, measured) = (self.directions[at], self.measured[at]);
        Turned { variable, direction, measured, inverse_sigma: 1.0 / self.sigma }
    }

    /// The estimate after so many iterations, and its covariance.
    fn by_library(&self, iterations: usize) -> (Rotation3<f64>, Matrix3<f64>) {
        let (mut belief, mut problem) = (Belief::new(), Problem::new());
        let covariance = DMatrix::from_column_slice(3, 3, self.covariance.as_slice());
        let own = belief.add(self.estimate, &covariance).expect("it fits");
        let variable = problem.add_variable(self.estimate);
        for at in 0..2 {
            problem.add_factor(self.factor(variable, at), Kernel::Squared).expect("it fits");
        }
        let options = UpdateOptions { iterations, tolerance: 1e-13, ..UpdateOptions::default() };
        belief.update(&problem, &options).expect("a covariance");
        let covariance = belief.of(own).expect("it is there");
        (belief.values()[own], Matrix3::from_fn(|row, column| covariance[(row, column)]))
    }

    /// Residual and Jacobian of the directions, in standard deviations.
    fn linear(&self, at: &Rotation3<f64>) -> (Vector6<f64>, Matrix6x3<f64>) {
        let (mut residual, mut jacobian) = (Vector6::zeros(), Matrix6x3::zeros());
        for index in 0..2 {
            let turned = at * self.directions[index];
            let by_step = -at.matrix() * so3::hat(&self.directions[index]);
            residual
                .fixed_rows_mut::<3>(3 * index)
                .copy_from(&((turned - self.measured[index]) / self.sigma));
            jacobian.fixed_rows_mut::<3>(3 * index).copy_from(&(by_step / self.sigma));
        }
        (residual, jacobian)
    }

    /// The derivative of the step from the estimate by a step of the iterate.
    fn derivative(&self, at: &Rotation3<f64>) -> Matrix3<f64> {
        so3::right_jacobian_inverse(&so3::local(&self.estimate, at))
    }

    /// The same written out, and the covariance of the error as it was measured.
    fn by_hand(&self, iterations: usize, rule: Rule) -> (Rotation3<f64>, Matrix3<f64>) {
        let (mut at, mut covariance) = (self.estimate, self.covariance);
        for _ in 0..iterations {
            let gone = so3::local(&self.estimate, &at);
            let anchored = if rule.anchored { gone } else { Vector3::zeros() };
            let derivative = match rule.curved && rule.anchored {
                true => self.derivative(&at),
                false => Matrix3::identity(),
            };
            let unit = if rule.whitened { 1.0 } else { self.sigma };
            let (_, jacobian) = self.linear(if rule.latest { &at } else { &self.estimate });
            let jacobian = unit * jacobian * inverse(derivative);
            let residual = unit * self.linear(&at).0 - jacobian * anchored;
            let expected = jacobian * self.covariance * jacobian.transpose()
                + SMatrix::<f64, 6, 6>::identity();
            let gain = self.covariance * jacobian.transpose() * inverse(expected);
            covariance = self.covariance - gain * jacobian * self.covariance;
            let back = if rule.back { anchored } else { Vector3::zeros() };
            at = so3::retract(&at, &(inverse(derivative) * (-gain * residual - back)));
        }
        (at, covariance)
    }

    /// All residuals, the prior's among them.
    fn all(&self, at: &Rotation3<f64>) -> SVector<f64, 9> {
        let prior = sqrt_information(&self.covariance).expect("a covariance");
        let mut all = SVector::<f64, 9>::zeros();
        all.fixed_rows_mut::<3>(0).copy_from(&(prior * so3::local(&self.estimate, at)));
        all.fixed_rows_mut::<6>(3).copy_from(&self.linear(at).0);
        all
    }

    fn slope(&self, at: &Rotation3<f64>) -> SMatrix<f64, 9, 3> {
        differences(1e-5, |step: Vector3<f64>| self.all(&so3::retract(at, &step)))
    }

    /// Gauss-Newton on all of them, with derivatives by differences.
    fn by_gauss_newton(&self, iterations: usize) -> Rotation3<f64> {
        let mut at = self.estimate;
        for _ in 0..iterations {
            let (residual, slope) = (self.all(&at), self.slope(&at));
            at = so3::retract(&at, &(-inverse(slope.tr_mul(&slope)) * slope.tr_mul(&residual)));
        }
        at
    }
}

/// A known direction as a rotation turned it.
#[derive(Clone, Copy)]
struct Turned {
    variable: Key<Rotation3<f64>>,
    direction: Vector3<f64>,
    measured: Vector3<f64>,
    inverse_sigma: f64,
}

impl Factor<3> for Turned {
    type Variables = (Rotation3<f64>,);
    type Jacobians = (Matrix3<f64>,);

    fn variables(&self) -> (Key<Rotation3<f64>>,) {
        (self.variable,)
    }

    fn residual(&self, (at,): (&Rotation3<f64>,)) -> Option<Vector3<f64>> {
        Some(self.inverse_sigma * (at * self.direction - self.measured))
    }

    fn linearize(&self, (at,): (&Rotation3<f64>,)) -> Option<(Vector3<f64>, (Matrix3<f64>,))> {
        let by_step = -self.inverse_sigma * at.matrix() * so3::hat(&self.direction);
        Some((self.residual((at,))?, (by_step,)))
    }
}

type Iterated = fn(&Turn, usize) -> Rotation3<f64>;

fn iterated_step(formula: Iterated) -> Comparison {
    let against = "Gauss-Newton with derivatives by differences";
    Comparison::absolute(against, 1e-7, "").over(CASES, 21, |random| {
        let turn = Turn::random(random);
        (formula(&turn, STEPS), turn.by_gauss_newton(STEPS))
    })
}

type Moved = fn(&Turn) -> Matrix3<f64>;

fn moved_covariance(formula: Moved) -> Comparison {
    let against = "the inverse Hessian of all residuals where the search ended";
    Comparison::relative(against, 1e-6).over(CASES, 22, |random| {
        let turn = Turn::random(random);
        let slope = turn.slope(&turn.by_gauss_newton(ALL));
        (formula(&turn), inverse(slope.tr_mul(&slope)))
    })
}

/// The iterates of a rule and those of Gauss-Newton.
fn same_steps(rule: Rule) -> Comparison {
    let turn = Turn::random(&mut Random::new(23));
    Comparison::absolute("the iterates of Gauss-Newton", 1e-7, "")
        .each(1..=STEPS, |steps| (turn.by_hand(steps, rule).0, turn.by_gauss_newton(steps)))
}
