//! What a comparison accepts.

use nalgebra::{Matrix2x3, Vector2};

use exhibits::comparison::Comparison;

#[test]
fn random_states_and_given_ones_are_compared_alike() {
    let absolute = || Comparison::absolute("a test", 1e-12, "px");
    let random = absolute().over(3, 1, |random| {
        let number = random.uniform(0.0..1.0);
        ([Vector2::new(number, 1.0)], (number, 1.0))
    });
    assert_eq!((random.states, random.failure()), (3, None));
    let given = absolute().each([1.0, 2.0], |number| (Some(number), 1.0));
    assert_eq!((given.states, given.worst), (2, 1.0));
    let single = absolute().once(2.0, 2.5);
    assert_eq!((single.states, single.worst), (1, 0.5));
}

#[test]
fn a_formula_that_gives_nothing_fails() {
    let nothing: Option<Matrix2x3<f64>> = None;
    let comparison = Comparison::absolute("a test", 1e-12, "px")
        .each([nothing], |formula| (formula, Matrix2x3::<f64>::zeros()));
    assert!(comparison.failure().unwrap().contains("NaN"));
}

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
