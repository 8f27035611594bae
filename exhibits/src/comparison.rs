//! The one way in which a formula is compared with something independent of it.

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

#[cfg(test)]
mod tests {
    use super::Comparison;

    fn compared(tolerance: f64, pairs: &[(f64, f64)]) -> Comparison {
        let mut comparison = Comparison::absolute("a test", tolerance, "px");
        for (formula, oracle) in pairs {
            comparison.add(&[*formula], &[*oracle]);
        }
        comparison
    }

    #[test]
    fn a_small_error_is_accepted_and_the_largest_is_kept() {
        let comparison = compared(0.1, &[(1.0, 1.01), (2.0, 2.05), (3.0, 3.0)]);
        assert_eq!(comparison.failure(), None);
        assert_eq!(comparison.states, 3);
        assert!((comparison.worst - 0.05).abs() < 1e-12);
    }

    #[test]
    fn an_error_above_the_tolerance_fails_and_names_its_state() {
        let failure = compared(0.1, &[(1.0, 1.0), (1.0, 1.2), (1.0, 9.0)]).failure();
        assert_eq!(
            failure.as_deref(),
            Some("the error at state 1 is 2.0e-1, above the tolerance of 1.0e-1")
        );
    }

    #[test]
    fn nothing_compared_is_a_failure() {
        assert_eq!(compared(0.1, &[]).failure().as_deref(), Some("nothing was compared"));
        let mut without_values = Comparison::absolute("a test", 0.1, "px");
        without_values.add(&[], &[]);
        assert_eq!(without_values.failure().as_deref(), Some("state 0 has no values"));
    }

    #[test]
    fn nan_fails_on_either_side() {
        for pair in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::NAN, f64::NAN)] {
            let comparison = compared(0.1, &[(1.0, 1.0), pair, (1.0, 1.0)]);
            assert_eq!(comparison.failure().as_deref(), Some("the error at state 1 is NaN"));
            assert_eq!(comparison.worst, 0.0);
        }
    }

    #[test]
    fn infinity_fails_even_when_both_sides_agree_on_it() {
        let infinity = f64::INFINITY;
        for pair in [(infinity, 1.0), (1.0, -infinity), (infinity, infinity)] {
            assert!(compared(0.1, &[pair]).failure().is_some());
        }
        assert!(compared(infinity, &[(infinity, 1.0)]).failure().is_some());
    }

    #[test]
    fn a_tolerance_that_is_nan_accepts_nothing() {
        assert!(compared(f64::NAN, &[(1.0, 1.0)]).failure().is_some());
    }

    #[test]
    fn a_relative_error_is_measured_by_the_oracle() {
        let mut comparison = Comparison::relative("a test", 1e-3);
        comparison.add(&[3000.0, 4001.0], &[3000.0, 4000.0]);
        assert_eq!(comparison.failure(), None);
        assert!((comparison.worst - 1.0 / 5000.0).abs() < 1e-15);
        comparison.add(&[1e-9], &[0.0]);
        assert!(comparison.failure().is_some());
    }
}
