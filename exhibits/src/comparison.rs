//! The one way in which a formula is compared with something independent of it.

use nalgebra::{Dim, Isometry3, Matrix, RawStorage, Rotation3, SMatrix, SVector};

use crate::random::Random;

/// What a formula or an oracle gives: numbers, in an order that both share.
pub trait Values {
    /// Adds the numbers.
    fn append_to(&self, numbers: &mut Vec<f64>);
}

impl Values for f64 {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        numbers.push(*self);
    }
}

impl<R: Dim, C: Dim, S: RawStorage<f64, R, C>> Values for Matrix<f64, R, C, S> {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        numbers.extend(self.iter());
    }
}

/// Yes is one and no is zero.
impl Values for bool {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        numbers.push(f64::from(*self));
    }
}

impl Values for Isometry3<f64> {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        self.to_homogeneous().append_to(numbers);
    }
}

impl Values for Rotation3<f64> {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        self.matrix().append_to(numbers);
    }
}

/// A formula that gives nothing where the oracle gives something has failed.
impl<V: Values> Values for Option<V> {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        match self {
            Some(values) => values.append_to(numbers),
            None => numbers.push(f64::NAN),
        }
    }
}

impl<V: Values> Values for [V] {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        self.iter().for_each(|values| values.append_to(numbers));
    }
}

impl<V: Values, const N: usize> Values for [V; N] {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        self.as_slice().append_to(numbers);
    }
}

impl<V: Values> Values for Vec<V> {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        self.as_slice().append_to(numbers);
    }
}

impl<A: Values, B: Values> Values for (A, B) {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        self.0.append_to(numbers);
        self.1.append_to(numbers);
    }
}

impl<A: Values, B: Values, C: Values> Values for (A, B, C) {
    fn append_to(&self, numbers: &mut Vec<f64>) {
        self.0.append_to(numbers);
        self.1.append_to(numbers);
        self.2.append_to(numbers);
    }
}

/// All numbers of some values.
pub fn numbers(values: &impl Values) -> Vec<f64> {
    let mut numbers = Vec::new();
    values.append_to(&mut numbers);
    numbers
}

/// The largest error of a formula against an oracle, over many states.
///
/// A comparison of nothing has failed, and so has one that met a value that is not finite.
pub struct Comparison {
    /// What the formula is compared with, to be read after "against".
    pub against: &'static str,
    /// The largest error that is still accepted.
    pub tolerance: f64,
    /// Unit of error and tolerance, or `relative`.
    pub unit: &'static str,
    /// How many states were compared.
    pub states: usize,
    /// The largest finite error.
    pub worst: f64,
    is_relative: bool,
    first_failure: Option<String>,
}

impl Comparison {
    /// Errors are distances in `unit`.
    pub fn absolute(against: &'static str, tolerance: f64, unit: &'static str) -> Self {
        Self {
            against,
            tolerance,
            unit,
            states: 0,
            worst: 0.0,
            is_relative: false,
            first_failure: None,
        }
    }

    /// Errors are distances divided by the length of the oracle's value.
    pub fn relative(against: &'static str, tolerance: f64) -> Self {
        Self { is_relative: true, ..Self::absolute(against, tolerance, "relative") }
    }

    /// Compares what formula and oracle give at so many random states, which begin with a seed.
    pub fn over<F: Values, O: Values>(
        self,
        states: usize,
        seed: u64,
        mut both: impl FnMut(&mut Random) -> (F, O),
    ) -> Self {
        let mut random = Random::new(seed);
        self.each(0..states, |_| both(&mut random))
    }

    /// Compares what formula and oracle give at each of these states.
    pub fn each<S, F: Values, O: Values>(
        mut self,
        states: impl IntoIterator<Item = S>,
        mut both: impl FnMut(S) -> (F, O),
    ) -> Self {
        for state in states {
            let (formula, oracle) = both(state);
            let (mut formula, oracle) = (numbers(&formula), numbers(&oracle));
            if formula.iter().any(|number| number.is_nan()) {
                formula = vec![f64::NAN; oracle.len()];
            }
            self.add(&formula, &oracle);
        }
        self
    }

    /// Compares a formula with its oracle at the only state there is.
    pub fn once(self, formula: impl Values, oracle: impl Values) -> Self {
        self.each([(formula, oracle)], |both| both)
    }

    /// Compares one state. The values are all components of a scalar, vector or matrix.
    pub fn add(&mut self, formula: &[f64], oracle: &[f64]) {
        assert_eq!(formula.len(), oracle.len(), "a check compares values of the same shape");
        let difference = length(formula.iter().zip(oracle).map(|(a, b)| a - b));
        let error =
            if self.is_relative { difference / length(oracle.iter().copied()) } else { difference };
        let state = self.states;
        self.states += 1;
        if formula.is_empty() {
            self.fail(format!("state {state} has no values"));
        }
        if error.is_finite() {
            self.worst = self.worst.max(error);
        } else {
            self.fail(format!("the error at state {state} is {error}"));
        }
        // Written so that a tolerance of NaN accepts nothing.
        let accepted = error <= self.tolerance;
        if !accepted {
            self.fail(format!(
                "the error at state {state} is {error:.1e}, above the tolerance of {:.1e}",
                self.tolerance
            ));
        }
    }

    /// Why the formula is not accepted, as a sentence, or `None` when it is.
    pub fn failure(&self) -> Option<String> {
        if self.states == 0 {
            return Some("nothing was compared".to_owned());
        }
        self.first_failure.clone()
    }

    fn fail(&mut self, sentence: String) {
        self.first_failure.get_or_insert(sentence);
    }
}

fn length(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|value| value * value).sum::<f64>().sqrt()
}

/// The inverse of a matrix; NaN, which no comparison accepts, where it has none.
pub fn inverse<const N: usize>(matrix: SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    matrix.try_inverse().unwrap_or(SMatrix::repeat(f64::NAN))
}

/// A value after a change, for mutants that spoil one part of what is right.
pub fn altered<T>(mut value: T, change: impl FnOnce(&mut T)) -> T {
    change(&mut value);
    value
}

/// How far a condition holds on the way from a number where it does to one where it does not, by halves.
pub fn as_far_as(mut holds: f64, mut fails: f64, condition: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (holds + fails);
        if condition(middle) { holds = middle } else { fails = middle }
    }
    0.5 * (holds + fails)
}

/// The derivative at zero of a function of `C` numbers, column by column, by central differences.
pub fn differences<const R: usize, const C: usize>(
    step: f64,
    function: impl Fn(SVector<f64, C>) -> SVector<f64, R>,
) -> SMatrix<f64, R, C> {
    let columns = std::array::from_fn::<_, C, _>(|axis| {
        let along = |change: f64| {
            function(SVector::from_fn(|row, _| if row == axis { change } else { 0.0 }))
        };
        (along(step) - along(-step)) / (2.0 * step)
    });
    SMatrix::from_columns(&columns)
}
